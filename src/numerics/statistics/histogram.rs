//! A histogram on fixed bins and its quantiles. The bins are set once, before anything is counted,
//! by a pilot; counts are integers, so any order of counting gives the same histogram.

use serde::{Deserialize, Serialize};

use super::Moments;

/// Bins of one histogram.
pub const BINS: usize = 4096;
/// Half the range of the bins around a pilot, in its standard deviations.
const HALF_RANGE_SD: f64 = 8.0;
/// Width of a bin in standard deviations of the pilot.
pub const BIN_SD: f64 = 2.0 * HALF_RANGE_SD / BINS as f64;

/// Range of one histogram: `BINS` equal ones between two values, rounded to f32 so that every
/// backend sorts into the same ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bins {
    /// Lower end of the first.
    pub from: f32,
    /// Bins per unit of the quantity.
    pub per_unit: f32,
}

impl Bins {
    /// Mean ± 8 sd of a pilot; around a constant, a narrow range that still holds it.
    pub fn around(pilot: &Moments) -> Self {
        let spread = (HALF_RANGE_SD * pilot.sd()).max(pilot.mean.abs() * 1e-5).max(1e-30);
        Self { from: (pilot.mean - spread) as f32, per_unit: (BINS as f64 / (2.0 * spread)) as f32 }
    }

    /// Edge `i`, 0 ≤ i ≤ `BINS`.
    pub fn edge(&self, i: usize) -> f64 {
        f64::from(self.from) + i as f64 / f64::from(self.per_unit)
    }
}

/// Counts per bin, below and above.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Range of the bins.
    pub bins: Bins,
    /// Counts: below the first bin, `BINS` bins, above the last.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// An empty histogram on these bins.
    pub fn new(bins: Bins) -> Self {
        Self { bins, counts: vec![0; BINS + 2] }
    }

    /// Counts one value, below or above the bins too.
    pub fn add(&mut self, value: f64) {
        let place = (value - f64::from(self.bins.from)) * f64::from(self.bins.per_unit);
        let slot = if place < 0.0 { 0 } else { (place as usize).min(BINS) + 1 };
        self.counts[slot] += 1;
    }

    /// Adds the counts of another histogram on the same bins.
    pub fn merge(&mut self, counts: &[u64]) {
        for (mine, theirs) in self.counts.iter_mut().zip(counts) {
            *mine += theirs;
        }
    }

    /// The quantile p of the counted values, linear within a bin, between their known extremes. NaN
    /// of none.
    pub fn quantile(&self, p: f64, min: f64, max: f64) -> f64 {
        let total: u64 = self.counts.iter().sum();
        if total == 0 {
            return f64::NAN;
        }
        // Rank among n values spread evenly over their bins.
        let rank = p.clamp(0.0, 1.0) * total as f64;
        let mut seen = 0.0;
        for (slot, &count) in self.counts.iter().enumerate() {
            let count = count as f64;
            if count > 0.0 && seen + count >= rank {
                let low = if slot == 0 { min } else { self.bins.edge(slot - 1) };
                let high = if slot == BINS + 1 { max } else { self.bins.edge(slot) };
                return (low + (high - low) * ((rank - seen) / count)).clamp(min, max);
            }
            seen += count;
        }
        max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_known_set_lie_within_a_bin() {
        let values: Vec<f64> = (0..10_000).map(|i| f64::from(i) / 10_000.0).collect();
        let m = Moments::of(values.iter().copied());
        let mut h = Histogram::new(Bins::around(&m));
        values.iter().for_each(|v| h.add(*v));
        for p in [0.01, 0.05, 0.5, 0.95, 0.99] {
            assert!((h.quantile(p, m.min, m.max) - p).abs() < 16.0 * m.sd() / BINS as f64);
        }
        assert_eq!((h.quantile(0.0, m.min, m.max), h.quantile(1.0, m.min, m.max)), (m.min, m.max));
    }

    #[test]
    fn values_outside_the_pilots_range_are_kept_and_a_constant_is_exact() {
        let mut h = Histogram::new(Bins { from: 0.0, per_unit: BINS as f32 });
        [-5.0, 0.5, 7.0].iter().for_each(|v| h.add(*v));
        assert_eq!((h.counts[0], h.counts[BINS + 1], h.counts.iter().sum::<u64>()), (1, 1, 3));
        let constant = Moments::of([3.0; 20].into_iter());
        let mut h = Histogram::new(Bins::around(&constant));
        (0..20).for_each(|_| h.add(3.0));
        assert_eq!(h.quantile(0.5, 3.0, 3.0), 3.0);
        assert!(Histogram::new(h.bins).quantile(0.5, 0.0, 0.0).is_nan());
    }
}
