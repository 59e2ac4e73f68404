//! Draws how errors are distributed over the members at the report times, with percentiles and the
//! normal of the same mean and sd.

use super::moment::moment;
use crate::figure::{Axis, Chart, Ink, Mark, labelled};
use proofmass_numerics::statistics::{Summary, quantity};
use proofmass_simulate::drift::Drift;

/// Bars of a shown histogram.
const BARS: usize = 50;
/// Position is shown at this many report times.
const SHOWN_TIMES: usize = 4;

/// Rows of figures, each with the words that introduce it.
pub(super) fn rows(drift: &Drift) -> Vec<(Vec<Chart>, &'static str)> {
    let times_s = drift.report_times_s();
    let count = times_s.len();
    let shown = (0..SHOWN_TIMES.min(count)).map(|k| match SHOWN_TIMES.min(count) {
        1 => count - 1,
        n => k * (count - 1) / (n - 1),
    });
    let position = drift.at_report(quantity::POSITION);
    let charts: Vec<Chart> = shown.map(|k| histogram("position error", "m", times_s[k], position[k])).collect();
    let mut all = vec![(
        charts,
        "Density of the position error over the members, the normal with the same mean and standard deviation, and the 1, 5, 50, 95 and 99 % percentiles.",
    )];
    let others = [
        (quantity::VELOCITY, "velocity error", "m/s"),
        (quantity::TILT, "tilt error", "rad"),
        (quantity::ACCELERATION, "acceleration error", "m/s²"),
    ];
    let last: Vec<Chart> = others
        .iter()
        .filter_map(|(q, name, unit)| {
            let summary = *drift.at_report(*q).last()?;
            (summary.sd > 0.0).then(|| histogram(name, unit, *times_s.last().unwrap_or(&0.0), summary))
        })
        .collect();
    if !last.is_empty() {
        all.push((last, "The same at the last report time for the other errors."));
    }
    all
}

fn histogram(name: &str, unit: &str, time_s: f64, summary: &Summary) -> Chart {
    let title = format!("{} after {}", capitalised(name), moment(time_s));
    let density = match unit.split_once('/') {
        Some((above, below)) => format!("density / ({below}/{above})"),
        None => format!("density / (1/{unit})"),
    };
    let mut chart = Chart::new(&title, Axis::linear(&labelled(name, unit)), Axis::linear(&density));
    chart.size = (560, 330);
    let (low, high) = (summary.mean - 4.0 * summary.sd, summary.mean + 4.0 * summary.sd);
    let width = (high - low) / BARS as f64;
    if !(width > 0.0 && width.is_finite()) || summary.count == 0 {
        chart.note((0.0, 0.5), "all members alike");
        return chart;
    }
    let mut bars = vec![0.0; BARS];
    let bins = &summary.histogram.bins;
    for (i, count) in
        summary.histogram.counts.iter().enumerate().skip(1).take(proofmass_numerics::statistics::histogram::BINS)
    {
        let middle = 0.5 * (bins.edge(i - 1) + bins.edge(i));
        let bar = ((middle - low) / width).floor();
        if (0.0..BARS as f64).contains(&bar) {
            bars[bar as usize] += *count as f64 / (summary.count as f64 * width);
        }
    }
    let top = bars.iter().copied().fold(0.0, f64::max);
    let centre = |k: usize| low + (k as f64 + 0.5) * width;
    chart.add("members", Ink::Blue, Mark::Bars(width), bars.iter().enumerate().map(|(k, b)| (centre(k), *b)).collect());
    let normal = |x: f64| {
        let z = (x - summary.mean) / summary.sd;
        (-0.5 * z * z).exp() / (summary.sd * (2.0 * std::f64::consts::PI).sqrt())
    };
    let curve = (0..=200).map(|k| low + (high - low) * f64::from(k) / 200.0).map(|x| (x, normal(x))).collect();
    chart.add("normal", Ink::Red, Mark::Line, curve);
    for (k, value) in summary.percentiles.iter().enumerate() {
        let label = if k == 0 { "1, 5, 50, 95, 99 %" } else { "" };
        chart.add(label, Ink::Soft, Mark::Dashed, vec![(*value, 0.0), (*value, 1.05 * top)]);
    }
    chart
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
