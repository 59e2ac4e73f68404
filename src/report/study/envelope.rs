//! Position error over time: percentile bands on linear axes, standard deviation over closed form
//! and guides on log axes.

use crate::figure::{Axis, Chart, Ink, Mark};
use proofmass_numerics::statistics::{Summary, quantity};
use proofmass_simulate::drift::Drift;

/// 95 % quantile of the standard normal.
const EDGE: f64 = 1.644_853_6;

fn series(drift: &Drift, pick: impl Fn(&Summary) -> f64) -> Vec<(f64, f64)> {
    let statistics = &drift.statistics;
    statistics.time_s.iter().copied().zip(statistics.series(quantity::POSITION, pick)).collect()
}

/// Percentile bands from the start of the run.
pub(crate) fn linear(drift: &Drift) -> Chart {
    let from_zero = |mut points: Vec<(f64, f64)>| {
        points.insert(0, (0.0, 0.0));
        points
    };
    let band = |low: usize, high: usize| {
        let lower = from_zero(series(drift, |s| s.percentiles[low]));
        let upper: Vec<f64> = from_zero(series(drift, |s| s.percentiles[high])).iter().map(|p| p.1).collect();
        (lower, upper)
    };
    let (outer, outer_top) = band(0, 4);
    let (inner, inner_top) = band(1, 3);
    let expected = drift.expected.total(quantity::POSITION);
    let edge = |sign: f64| {
        let at = drift.expected.time_s.iter().zip(&expected);
        from_zero(at.map(|(t, m)| (*t, m.mean + sign * EDGE * m.variance.sqrt())).collect())
    };
    Chart::new("Position error", Axis::linear("time / s"), Axis::linear("position error / m"))
        .with("1–99 %", Ink::Sky, Mark::Band(outer_top), outer)
        .with("5–95 %", Ink::Blue, Mark::Band(inner_top), inner)
        .with("median", Ink::Black, Mark::Line, from_zero(series(drift, |s| s.percentiles[2])))
        .with("closed form, 5 and 95 %", Ink::Red, Mark::Dashed, edge(1.0))
        .with("", Ink::Red, Mark::Dashed, edge(-1.0))
}

/// Standard deviation over time on log axes, with guides through its middle.
pub fn log_log(drift: &Drift) -> Chart {
    let sd = series(drift, |s| s.sd);
    let expected = drift.expected.total(quantity::POSITION);
    let closed: Vec<(f64, f64)> =
        drift.expected.time_s.iter().zip(&expected).map(|(t, m)| (*t, m.variance.sqrt())).collect();
    // Guides pass a little above the last point, so that they are seen next to the curve and not
    // under it.
    let guide = |power: f64| -> Vec<(f64, f64)> {
        let (end_s, end_m) = sd.last().copied().unwrap_or((1.0, 1.0));
        let lowest = sd.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let through = |t: f64| 2.0 * end_m * (t / end_s).powf(power);
        sd.iter().map(|p| (p.0, through(p.0))).filter(|p| p.1 >= lowest).collect()
    };
    let mut chart = Chart::new("How it grows", Axis::log("time / s"), Axis::log("position error, sd / m"))
        .with("t²", Ink::Green, Mark::Dashed, guide(2.0))
        .with("t³", Ink::Purple, Mark::Dashed, guide(3.0))
        .with("simulated", Ink::Blue, Mark::Line, sd.clone())
        .with("closed form", Ink::Red, Mark::Dashed, closed);
    let points = drift.report.iter().map(|k| sd[*k]).collect();
    chart.add("report times", Ink::Blue, Mark::Dots(4), points);
    chart
}
