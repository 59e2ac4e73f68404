//! The figures of a study in motion: envelopes over time, the spread on a map of the track, who
//! owns the mean square.

use crate::figure::{Axis, Chart, Ink, Mark};
use crate::study::moment::moment;
use proofmass_base::units::DEGREE;
use proofmass_numerics::numerics::order;
use proofmass_numerics::statistics::Summary;
use proofmass_simulate::backend::flight::Quantity;
use proofmass_simulate::strapdown::answer::{Answer, LINEAR};
use proofmass_simulate::strapdown::covariance::Part;

/// Sources shown by name; the rest is one band.
const NAMED: usize = 6;
/// Radius of a circle that holds 95 % of a standard normal in two dimensions: √(−2 ln 0.05).
const RADIUS_95: f64 = 2.447_746_8;
/// Points of an ellipse.
const POINTS: usize = 72;

fn series(answer: &Answer, quantity: Quantity, pick: impl Fn(&Summary) -> f64) -> Vec<(f64, f64)> {
    let ensemble = &answer.ensemble;
    (0..ensemble.time_s.len()).map(|k| (ensemble.time_s[k], pick(ensemble.summary(k, quantity)))).collect()
}

/// Distance from the truth over time, from the start of the run.
pub(crate) fn distance(answer: &Answer) -> Chart {
    let curve = |quantity, place: usize| {
        let mut points = series(answer, quantity, |s| s.percentiles[place]);
        points.insert(0, (0.0, 0.0));
        points
    };
    Chart::new("Distance from the truth", Axis::linear("time / s"), Axis::linear("distance / m"))
        .with("3-D, 95 %", Ink::Red, Mark::Dashed, curve(Quantity::Spherical, 3))
        .with("3-D, 50 %", Ink::Orange, Mark::Dashed, curve(Quantity::Spherical, 2))
        .with("horizontal, 95 %", Ink::Blue, Mark::Line, curve(Quantity::Horizontal, 3))
        .with("horizontal, 50 %", Ink::Sky, Mark::Line, curve(Quantity::Horizontal, 2))
}

/// Standard deviations of three of the linear quantities on log axes, with the linear model's;
/// `unit` is what one unit of the axis is in SI.
pub(crate) fn spreads(answer: &Answer, title: &str, label: &str, first: usize, names: [&str; 3], unit: f64) -> Chart {
    let mut chart = Chart::new(title, Axis::log("time / s"), Axis::log(label));
    for (n, name) in names.into_iter().enumerate() {
        chart.add(name, Ink::nth(n), Mark::Line, series(answer, LINEAR[first + n], |s| s.sd / unit));
    }
    for n in 0..3 {
        let time_s = answer.ensemble.time_s.iter().enumerate();
        let linear = time_s.map(|(k, t)| (*t, answer.covariance.variance(k, first + n).sqrt() / unit)).collect();
        chart.add(if n == 0 { "linear model" } else { "" }, Ink::Black, Mark::Dashed, linear);
    }
    chart
}

/// Attitude errors over time.
pub(crate) fn attitude(answer: &Answer) -> Chart {
    spreads(answer, "Attitude error", "attitude error, sd / °", 6, ["roll", "pitch", "heading"], DEGREE)
}

/// The ellipse that holds 95 % of normal errors in the plane, north and east, m.
fn ellipse(answer: &Answer, report: usize) -> Vec<(f64, f64)> {
    let at = |axis| answer.ensemble.summary(report, Quantity::Position(axis));
    let (north, east) = (at(0), at(1));
    // Cholesky's root of the covariance.
    let first = north.sd;
    let cross = if first > 0.0 { answer.ensemble.north_east_m2(report) / first } else { 0.0 };
    let second = (east.sd * east.sd - cross * cross).max(0.0).sqrt();
    let point = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / POINTS as f64).sin_cos();
        (north.mean + RADIUS_95 * first * cos, east.mean + RADIUS_95 * (cross * cos + second * sin))
    };
    (0..=POINTS).map(point).collect()
}

/// The track from above with the errors' ellipses at the report times, and what they are magnified
/// by.
pub(crate) fn map(answer: &Answer) -> (Chart, f64) {
    let truth = &answer.flight.course.truth;
    let last = answer.flight.clock().samples - answer.flight.clock().still_samples;
    let samples = &truth.samples[..truth.samples.len().min(last as usize + 1)];
    let stride = samples.len().div_ceil(1500).max(1);
    let track: Vec<(f64, f64)> = samples.iter().step_by(stride).map(|s| (s.position_m.y, s.position_m.x)).collect();
    let ellipses: Vec<_> = answer.report.iter().map(|k| (*k, ellipse(answer, *k))).collect();
    let extent = |points: &mut dyn Iterator<Item = f64>| points.fold(0.0, |most: f64, v| most.max(v.abs()));
    let size = |axis: usize| {
        let all = || samples.iter().map(|s| s.position_m[axis]);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    let reach = size(0).max(size(1));
    let largest = extent(&mut ellipses.iter().flat_map(|(_, points)| points).flat_map(|p| [p.0, p.1]));
    // So that the last is a fifth of the track at least, by a round factor.
    let magnified = match largest > 0.0 && reach > 10.0 * largest {
        true => 10f64.powf((reach / (5.0 * largest)).log10().floor()),
        false => 1.0,
    };
    let mut drawn: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for (k, points) in &ellipses {
        let time_s = answer.ensemble.time_s[*k];
        let n = ((time_s / truth.interval_s).round() as usize).min(samples.len() - 1);
        let at = samples[n].position_m;
        let moved = points.iter().map(|(north, east)| (at.y + magnified * east, at.x + magnified * north));
        drawn.push((moment(time_s), moved.collect()));
    }
    let every = || track.iter().chain(drawn.iter().flat_map(|(_, points)| points));
    let range = |pick: fn(&(f64, f64)) -> f64| {
        let low = every().map(pick).fold(f64::MAX, f64::min);
        (low, every().map(pick).fold(f64::MIN, f64::max))
    };
    let (east, north) = (range(|p| p.0), range(|p| p.1));
    let half = 0.55 * (east.1 - east.0).max(north.1 - north.0).max(1e-9);
    let axis = |label, (low, high): (f64, f64)| {
        let middle = 0.5 * (low + high);
        Axis::linear(label).within(middle - half, middle + half)
    };
    let mut chart = Chart::new("Track and 95 % error ellipses", axis("east / m", east), axis("north / m", north));
    chart.size = (520, 520);
    chart.add("track", Ink::Black, Mark::Line, track);
    for (n, (name, points)) in drawn.into_iter().enumerate() {
        chart.add(if n < NAMED { &name } else { "" }, Ink::nth(n), Mark::Line, points);
    }
    (chart, magnified)
}

/// Fractions of the horizontal mean square, stacked to 100 %.
pub(crate) fn shares(answer: &Answer) -> Chart {
    let time_s = &answer.ensemble.time_s;
    let mut chart = Chart::new(
        "Contributions to the mean square",
        Axis::log("time / s"),
        Axis::linear("fraction of horizontal mean square / %").within(0.0, 100.0),
    );
    let peak = |p: &Part| (0..time_s.len()).map(|k| answer.fraction(p, k)).fold(0.0, f64::max);
    let mut parts: Vec<(&Part, f64)> = answer.parts().map(|p| (p, peak(p))).filter(|p| p.1 > 0.005).collect();
    order::sort_by_key(&mut parts, |p| -p.1);
    let mut floor = vec![0.0; time_s.len()];
    let mut stack = |name: &str, ink: Ink, floor: &[f64], top: &[f64]| {
        let points = |values: &[f64]| time_s.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
        chart.add(name, ink, Mark::Band(top.to_vec()), points(floor));
        chart.add("", ink, Mark::Line, points(top));
    };
    for (n, (part, _)) in parts.into_iter().take(NAMED).enumerate() {
        let top: Vec<f64> = floor.iter().enumerate().map(|(k, f)| f + 100.0 * answer.fraction(part, k)).collect();
        stack(part.cause.name(), Ink::nth(n), &floor, &top);
        floor = top;
    }
    if floor.iter().any(|f| *f < 99.5) {
        let top = vec![100.0; floor.len()];
        stack("all others", Ink::Soft, &floor, &top);
    }
    chart
}
