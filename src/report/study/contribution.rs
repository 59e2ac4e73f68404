//! The error budget over time: fractions of the variance, stacked, and each source's own envelope.

use crate::figure::{Axis, Chart, Ink, Mark};
use proofmass_numerics::numerics::order;
use proofmass_simulate::drift::Drift;
use proofmass_simulate::drift::budget::Contribution;

/// Sources shown by name; the rest is one band.
const NAMED: usize = 6;

/// The sources that matter at some time, largest peak fraction first, at most `NAMED`.
fn named(drift: &Drift) -> Vec<&Contribution> {
    let budget = &drift.budget;
    let peak = |s: &Contribution| (0..budget.time_s.len()).map(|k| budget.fraction(s, k)).fold(0.0, f64::max);
    let mut contributions: Vec<(&Contribution, f64)> =
        budget.contributions.iter().map(|s| (s, peak(s))).filter(|s| s.1 > 0.005).collect();
    order::sort_by_key(&mut contributions, |s| -s.1);
    contributions.into_iter().take(NAMED).map(|s| s.0).collect()
}

/// Shares of the variance, stacked to 100 %.
pub(crate) fn stacked(drift: &Drift) -> Chart {
    let budget = &drift.budget;
    let mut chart = Chart::new(
        "Contributions to the variance",
        Axis::log("time / s"),
        Axis::linear("fraction of position variance / %").within(0.0, 100.0),
    );
    let mut floor = vec![0.0; budget.time_s.len()];
    for (n, contribution) in named(drift).into_iter().enumerate() {
        let top: Vec<f64> =
            floor.iter().enumerate().map(|(k, f)| f + 100.0 * budget.fraction(contribution, k)).collect();
        stack(&mut chart, contribution.source.name(), Ink::nth(n), &budget.time_s, &floor, &top);
        inside(&mut chart, contribution.source.name(), &budget.time_s, &floor, &top);
        floor = top;
    }
    if floor.iter().any(|f| *f < 99.5) {
        stack(&mut chart, "all others", Ink::Soft, &budget.time_s, &floor, &vec![100.0; floor.len()]);
    }
    chart
}

/// A band with a line on its top, so that neighbours stay apart in any colour vision.
fn stack(chart: &mut Chart, name: &str, ink: Ink, time_s: &[f64], floor: &[f64], top: &[f64]) {
    let points = |values: &[f64]| time_s.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
    chart.add(name, ink, Mark::Band(top.to_vec()), points(floor));
    chart.add("", ink, Mark::Line, points(top));
}

/// Width of a plot on a desktop and on a phone, its height, and a letter's advance and line; px.
const WIDE_PX: f64 = 380.0;
const NARROW_PX: f64 = 285.0;
const HEIGHT_PX: f64 = 280.0;
const LETTER_PX: f64 = 6.8;
const LINE_PX: f64 = 17.0;

/// The name in its area, where there is most room above and below it along the whole name; none
/// where it has none.
fn inside(chart: &mut Chart, name: &str, time_s: &[f64], floor: &[f64], top: &[f64]) {
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return };
    let along = |k: usize| (time_s[k] / first).ln() / (last / first).ln();
    // The part of the height, in per cent, that is the area's own under a name centred at a time.
    let own = |k: usize, width_px: f64| {
        let half = 0.5 * LETTER_PX * name.chars().count() as f64 / width_px;
        let fits = along(k) >= half && along(k) + half <= 1.0;
        let under = (0..time_s.len()).filter(|j| fits && (along(*j) - along(k)).abs() <= half);
        under.fold((0.0f64, if fits { 100.0f64 } else { 0.0 }), |(low, high), j| (low.max(floor[j]), high.min(top[j])))
    };
    let room_px = |(low, high): (f64, f64)| 0.01 * HEIGHT_PX * (high - low);
    for (width_px, narrow) in [(NARROW_PX, true), (WIDE_PX, false)] {
        let places = (0..time_s.len()).map(|k| (time_s[k], own(k, width_px)));
        let best = places.max_by(|a, b| room_px(a.1).total_cmp(&room_px(b.1)));
        if let Some((time_s, (low, high))) = best.filter(|(_, own)| room_px(*own) >= LINE_PX) {
            chart.label((time_s, 0.5 * (low + high)), name, narrow);
            return;
        }
    }
}

/// Each source's own standard deviation.
pub(crate) fn alone(drift: &Drift) -> Chart {
    let budget = &drift.budget;
    let mut chart = Chart::new("Each source alone", Axis::log("time / s"), Axis::log("position error, sd / m"));
    let whole: Vec<(f64, f64)> = budget
        .time_s
        .iter()
        .enumerate()
        .map(|(k, t)| (*t, budget.contributions.iter().map(|s| s.variance_m2[k]).sum::<f64>().sqrt()))
        .collect();
    let floor = whole.first().map_or(0.0, |p| p.1 * 1e-3);
    for (n, contribution) in named(drift).into_iter().enumerate() {
        let points =
            budget.time_s.iter().zip(&contribution.variance_m2).map(|(t, v)| (*t, v.sqrt())).filter(|p| p.1 > floor);
        chart.add(contribution.source.name(), Ink::nth(n), Mark::Line, points.collect());
    }
    chart.add("all together", Ink::Black, Mark::Dashed, whole);
    chart
}
