//! Power against size, and the detection limit of each effect.

use crate::report::figure::{Axis, Chart, Figure, Ink, Mark};
use crate::trial::interval::{Curve, Share};
use crate::trial::outcome::Outcome;

/// Edges of the size bins, visible rms over noise rms.
const EDGES: [f64; 9] = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 40.0];

/// Share noticed against size, all effects together, with the fitted curve.
pub fn power(outcome: &Outcome) -> Figure {
    let all: Vec<(f64, bool)> = outcome.detection_limit.iter().flat_map(|l| l.cases.iter().copied()).collect();
    let x = Axis::log("visible size of the effect / noise (rms)").within(EDGES[0], EDGES[EDGES.len() - 1]);
    let mut chart = Chart::new("How small an effect is noticed", x, Axis::linear("share noticed").within(0.0, 1.05));
    let mut middles = Vec::new();
    let mut lows = Vec::new();
    let mut highs = Vec::new();
    for edge in EDGES.windows(2) {
        let share = Share::over(all.iter().filter(|c| (edge[0]..edge[1]).contains(&c.0)).map(|c| c.1));
        if share.cases > 0 {
            let at = (edge[0] * edge[1]).sqrt();
            middles.push((at, share.value));
            lows.push((at, share.ci95[0]));
            highs.push(share.ci95[1]);
        }
    }
    if let Some(curve) = Curve::fit(&all) {
        let points = (0..=120).map(|k| EDGES[0] * (EDGES[8] / EDGES[0]).powf(f64::from(k) / 120.0));
        chart.add("curve", Ink::Blue, Mark::Line, points.map(|s| (s, curve.power_at(s))).collect());
        let limit = curve.size_at(0.9);
        chart.add("nine of ten", Ink::Soft, Mark::Dashed, vec![(EDGES[0], 0.9), (limit, 0.9), (limit, 0.0)]);
    }
    chart.add("", Ink::Red, Mark::Whiskers(highs), lows);
    chart.add("cases, exact 95 %", Ink::Red, Mark::Dots(4), middles);
    chart.draw()
}

/// The size that is noticed in nine of ten recordings, per effect, smallest at the bottom.
pub fn limits(outcome: &Outcome) -> Figure {
    let mut found: Vec<(&str, f64)> =
        outcome.detection_limit.iter().filter_map(|l| Some((l.id.as_str(), l.effect_over_noise?))).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let x = Axis::log("size noticed in 9 of 10 / noise (rms)").within(0.003, 300.0);
    let y = Axis::linear("rank, most visible first").within(0.0, found.len() as f64 + 1.0);
    let mut chart = Chart::new("Detection limit of each effect", x, y);
    let points: Vec<(f64, f64)> = found.iter().enumerate().map(|(n, (_, s))| (*s, n as f64 + 1.0)).collect();
    for ((id, _), (x, y)) in found.iter().zip(&points) {
        chart.note((x * 1.25, y - 0.25), id);
    }
    chart.add("", Ink::Blue, Mark::Dots(4), points);
    chart.size = (560, 120 + 16 * found.len() as u32);
    chart.draw()
}
