//! A statistic of an ensemble of which only moments and histograms are kept, with its interval.

use super::statistic::{Statistic, Z95};
use crate::statistics::Estimate;
use crate::statistics::Summary;
use crate::statistics::histogram::BINS;

impl Statistic {
    /// The statistic of a summary, to a bin of its histogram (1/256 of a standard deviation), with
    /// its 95 % interval.
    pub fn summarised(self, summary: &Summary) -> Estimate {
        let n = summary.count as f64;
        let quantile = |p: f64| summary.histogram.quantile(p.clamp(0.0, 1.0), summary.min, summary.max);
        let shifted = |shift: f64| match self {
            Self::Mean => summary.mean + shift * summary.sd / n.sqrt(),
            Self::Sd if summary.sd > 0.0 => {
                let squared = summary.sd * summary.sd;
                let of_variance = ((fourth_moment(summary) - squared * squared).max(0.0) / n).sqrt();
                summary.sd + shift * of_variance / (2.0 * summary.sd)
            }
            Self::Sd => summary.sd,
            Self::Quantile(p) | Self::Circular(p) => quantile(p + shift * (p * (1.0 - p) / n).sqrt()),
            Self::Absolute(p) => absolute(summary, p + shift * (p * (1.0 - p) / n).sqrt()),
        };
        Estimate { value: shifted(0.0), ci95: [shifted(-Z95), shifted(Z95)] }
    }
}

/// Returns each slot of the histogram with its count.
fn slots(summary: &Summary) -> impl Iterator<Item = (f64, f64, u64)> + '_ {
    let bins = &summary.histogram.bins;
    summary.histogram.counts.iter().enumerate().filter(|(_, count)| **count > 0).map(move |(slot, count)| {
        let low = if slot == 0 { summary.min } else { bins.edge(slot - 1).max(summary.min) };
        let high = if slot == BINS + 1 { summary.max } else { bins.edge(slot).min(summary.max) };
        (low, high, *count)
    })
}

fn fourth_moment(summary: &Summary) -> f64 {
    let sum: f64 = slots(summary).map(|(low, high, n)| n as f64 * (0.5 * (low + high) - summary.mean).powi(4)).sum();
    sum / summary.count.max(1) as f64
}

/// The quantile of the absolute value, by bisection on the share that lies between −x and x.
fn absolute(summary: &Summary, p: f64) -> f64 {
    let below = |x: f64| -> f64 {
        let part = |(low, high, n): (f64, f64, u64)| match high > low {
            true => n as f64 * ((x - low) / (high - low)).clamp(0.0, 1.0),
            false if low <= x => n as f64,
            false => 0.0,
        };
        slots(summary).map(part).sum()
    };
    let wanted = p.clamp(0.0, 1.0) * summary.count as f64;
    let (mut low, mut high) = (0.0, summary.min.abs().max(summary.max.abs()));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if below(middle) - below(-middle) < wanted { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use crate::statistics::{Bins, Histogram, Moments};

    /// Sums say what the values themselves say, to two bins.
    #[test]
    fn a_summary_gives_the_statistics_of_its_values() {
        let mut rng = Philox::new(5, 0, Stream::Host);
        let values: Vec<f64> = (0..20_000).map(|_| 0.7 + 2.0 * rng.normal()).collect();
        let moments = Moments::of(values.iter().copied());
        let mut histogram = Histogram::new(Bins::around(&moments));
        values.iter().for_each(|v| histogram.add(*v));
        let summary = Summary::of(&moments, histogram);
        for statistic in [
            Statistic::Mean,
            Statistic::Sd,
            Statistic::Quantile(0.05),
            Statistic::Quantile(0.99),
            Statistic::Absolute(0.95),
        ] {
            let (got, want) = (statistic.summarised(&summary), statistic.estimate(&values));
            for (got, want) in [(got.value, want.value), (got.ci95[0], want.ci95[0]), (got.ci95[1], want.ci95[1])] {
                assert!((got - want).abs() < 2.0 * 2.0 / 256.0, "{}: {got} {want}", statistic.name());
            }
            // Control: the statistic of other values is further away.
            let other: Vec<f64> = values.iter().map(|v| 1.1 * v).collect();
            assert!((got.value - statistic.estimate(&other).value).abs() > 0.02);
        }
    }
}
