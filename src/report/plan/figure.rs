//! The input of an experiment over time.

use crate::figure::{Axis, Chart, Ink, Mark};
use proofmass_diagnosis::plan::experiment::Experiment;

/// Number of stretches of the time axis, each about a pixel wide.
const STRETCHES: usize = 400;

/// The input; where samples are closer than pixels, the range that it covers.
pub(super) fn input(experiment: &Experiment, file: &str) -> Chart {
    let values = experiment.input();
    let time_s = |k: usize| k as f64 / experiment.rate_hz;
    let mut chart =
        Chart::new(&format!("Input of {file}"), Axis::linear("time / s"), Axis::linear("acceleration / (m/s²)"));
    let each = values.len().div_ceil(STRETCHES).max(1);
    if each < 4 {
        let points = values.iter().enumerate().map(|(k, u)| (time_s(k), *u)).collect();
        chart.add("", Ink::Blue, Mark::Line, points);
    } else {
        let stretches = || values.chunks(each).enumerate().map(|(n, part)| (time_s(n * each), part));
        let low = stretches().map(|(t, part)| (t, part.iter().copied().fold(f64::INFINITY, f64::min))).collect();
        let high = stretches().map(|(_, part)| part.iter().copied().fold(f64::NEG_INFINITY, f64::max)).collect();
        chart.add("", Ink::Blue, Mark::Band(high), low);
    }
    chart.size = (720, 260);
    chart
}
