//! The oscillator alone, fitted to a decay, and the sizes by which laws added to it are measured.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use crate::driven::base::{GAIN, OMEGA, ZETA};
use crate::driven::identification::start::first_scales;
use crate::driven::simulated::coordinates::z;
use crate::driven::simulated::rows::Rows;
use crate::driven::simulated::space;
use crate::driven::simulated::system::System;
use crate::engine::fit::{Fitted, MOST_STEPS, fit, nearer};
use crate::engine::kind::Point;
use crate::model::Output;
use crate::numerics::moments::{mean_sd, rms};

/// Damping ratios at which the base model of a free motion begins.
const ZETAS: [f64; 4] = [0.003, 0.03, 0.15, 0.5];
/// A fit from a point: what it leaves, and where.
type Begun = dyn Fn(&System, &Point) -> Option<(f64, Point)>;

/// Steps of a fit that tells where the base model begins.
const SOON: usize = 6;
/// Rows of a cycle below which the rows between two passes through zero say little of it.
const FEW_ROWS: f64 = 8.0;

/// Starting values of the base model of a free motion: gain, ω₀ in rad/s and ζ. `cycle` in samples.
pub(super) fn free(rate_hz: f64, cycle: f64) -> Vec<[f64; 3]> {
    ZETAS.map(|zeta| [1.0, TAU * rate_hz / cycle, zeta]).to_vec()
}

/// The base model, with the laws whose sizes it sets.
pub(super) fn base(rows: Rows, cycle: f64, begins: &[[f64; 3]]) -> Option<(System, Fitted)> {
    let mut scales = first_scales(&rows.data);
    let readings = rows.readings();
    let seen: Vec<f64> = rows.layout.segments.iter().flat_map(|s| readings[s.clone()].to_vec()).collect();
    scales.output = mean_sd(&seen).1.max(1e-300);
    let is_driven = rows.data.input.is_some();
    if !is_driven {
        scales.fineness = 1.0;
        // A decay ends about the place of rest.
        let end = rows.layout.segments.last()?.end;
        let tail = (cycle / rows.step as f64).ceil() as usize;
        scales.centre = mean_sd(&readings[end.saturating_sub(2 * tail).max(rows.layout.segments[0].start)..end]).0;
    }
    scales.output_range = seen.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    scales.duration_s = rows.data.clock_s.last().map_or(scales.duration_s, |last| last.max(scales.interval_s));
    scales.highest_hz *= rows.step as f64;
    let mut system = System { rows, scales, members: Vec::new() };
    // Of a motion of few rows to a cycle the spectrum knows the frequency better than the passes through zero.
    let peak = (!is_driven && cycle < FEW_ROWS)
        .then(|| system.peaks_hz().first().map(|hz| [1.0, TAU * hz, ZETAS[0]]))
        .flatten();
    let begins: Vec<[f64; 3]> = begins.iter().copied().chain(peak).collect();
    let mut best = |fits: &Begun| {
        let all = begins.iter().filter_map(|begin| {
            system.scales.begun(begin);
            fits(&system, &beginning(&system)).map(|(left, point)| (left, begin, point))
        });
        all.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    // Next to a motion of another frequency none comes to rest soon.
    let at_rest = best(&|s, start| fit(s, &[], start, SOON).map(|f| (f.variance, f.point)));
    let nearest = || best(&|s, start| nearer(s, &[], start, SOON).map(|(point, left)| (left, point)));
    let (_, begin, point) = at_rest.or_else(nearest)?;
    system.scales.begun(begin);
    let fitted = fit(&system, &[], &point, MOST_STEPS)?;
    let values = system.shared_values(&[], &fitted.point);
    let [gain, omega, zeta] = [GAIN, OMEGA, ZETA].map(|place| system.own(place, &values));
    let lines_hz = system.lines_hz(&[], &fitted.point);
    let (starts, scales) = (fitted.point.starts.clone(), &mut system.scales);
    scales.begun(&[if is_driven { gain } else { 1.0 }, omega, zeta.max(1e-4)]);
    scales.residual = rms(fitted.model.residual.iter().copied());
    scales.lines_hz = lines_hz;
    system.members = space::members(system.rows.data.environments, is_driven, &system.scales);
    // Coordinates are measured by the sizes, which have moved.
    let turn = |s: &Vec<f64>, before: f64| vec![s[0], s[1] * before / system.scales.omega_rad_s];
    let before = begin[1];
    let shared = system.shared_coordinates(&[]).iter().zip(&values).map(|(c, v)| z(*c, *v)).collect();
    let point = Point { shared, starts: starts.iter().map(|s| turn(s, before)).collect() };
    let fitted = fit(&system, &[], &point, MOST_STEPS)?;
    Some((system, fitted))
}

/// Returns the point where the base model begins.
fn beginning(system: &System) -> Point {
    let s = &system.scales;
    let coordinates = system.shared_coordinates(&[]);
    let of = |place: &usize| match *place {
        GAIN => s.gain,
        OMEGA => s.omega_rad_s,
        ZETA => s.zeta,
        _ => s.centre,
    };
    let shared = coordinates.iter().zip(system.oscillator().iter().map(of)).map(|(c, v)| z(*c, v)).collect();
    Point { shared, starts: starts(system) }
}

/// Returns where each segment begins: as the sine through its first half cycle does.
pub(super) fn starts(system: &System) -> Vec<Vec<f64>> {
    let (s, rows) = (&system.scales, &system.rows);
    let half = ((PI / (s.omega_rad_s * s.interval_s)).ceil() as usize).max(4);
    let start = |segment: &Range<usize>| {
        // Normal equations of a cosine and a sine.
        let [mut cc, mut cs, mut ss, mut cy, mut sy] = [0.0; 5];
        for k in segment.clone().take(half) {
            let (sin, cos) = (s.omega_rad_s * (k - segment.start) as f64 * s.interval_s).sin_cos();
            let y = rows.readings()[k] - s.centre;
            (cc, cs, ss, cy, sy) = (cc + cos * cos, cs + cos * sin, ss + sin * sin, cy + cos * y, sy + sin * y);
        }
        let det = (cc * ss - cs * cs).max(1e-300);
        let (a, b) = ((cy * ss - sy * cs) / det, (sy * cc - cy * cs) / det);
        // A velocity is a quarter of a cycle ahead.
        let (a, b) = if rows.data.observed.output == Output::Velocity { (-b, a) } else { (a, b) };
        vec![a / (0.1 * s.output), b / (0.1 * s.output)]
    };
    rows.layout.segments.iter().map(start).collect()
}
