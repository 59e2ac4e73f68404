//! The oscillator alone, fitted to a decay, and the sizes by which laws beside it are measured.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use crate::driven::identification::refined_scales::lines;
use crate::driven::identification::start::first_scales;
use crate::driven::simulated::rows::Rows;
use crate::driven::simulated::space;
use crate::driven::simulated::system::{System, z};
use crate::engine::fit::{Fitted, MOST_STEPS, fit};
use crate::engine::kind::Point;
use crate::numerics::moments::{mean_sd, rms};

use super::swings::Motion;

/// Damping ratios at which a base model begins.
const ZETAS: [f64; 4] = [0.003, 0.03, 0.15, 0.5];

/// The base model, with the laws whose sizes it sets.
pub(super) fn base(rows: Rows, motion: &Motion) -> Option<(System, Fitted)> {
    let mut scales = first_scales(&rows.data);
    let seen: Vec<f64> = rows.layout.segments.iter().flat_map(|s| rows.data.reading[s.clone()].to_vec()).collect();
    let end = rows.layout.segments.last()?.end;
    let tail = (motion.cycle / rows.step as f64).ceil() as usize;
    let centre = mean_sd(&rows.data.reading[end.saturating_sub(2 * tail).max(rows.layout.segments[0].start)..end]).0;
    scales.output = mean_sd(&seen).1.max(1e-300);
    scales.centre = centre;
    scales.output_range = seen.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    scales.omega_rad_s = TAU * rows.data.rate_hz * rows.step as f64 / motion.cycle;
    scales.velocity = scales.output * scales.omega_rad_s;
    scales.duration_s = rows.data.clock_s.last().copied().unwrap_or(0.0).max(scales.interval_s);
    scales.fineness = 1.0;
    let mut system = System { rows, scales, members: Vec::new() };
    let fits = ZETAS.iter().filter_map(|zeta| {
        system.scales.zeta = *zeta;
        let start = beginning(&system, *zeta);
        fit(&system, &[], &start, 6).map(|fitted| (fitted.variance, *zeta, fitted))
    });
    let (_, zeta, fitted) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    system.scales.zeta = zeta;
    let fitted = fit(&system, &[], &fitted.point, MOST_STEPS)?;
    let values = system.shared_values(&[], &fitted.point);
    let (starts, scales) = (fitted.point.starts.clone(), &mut system.scales);
    (scales.omega_rad_s, scales.zeta) = (values[0], values[1].max(1e-4));
    scales.velocity = scales.output * values[0];
    scales.residual = rms(fitted.model.residual.iter().copied());
    scales.lines_hz = lines(&fitted.model.residual, system.rows.data.rate_hz);
    system.members = space::members(system.rows.data.environments, false, &system.scales);
    // Coordinates are measured by the sizes, which have moved.
    let turn = |s: &Vec<f64>, before: f64| vec![s[0], s[1] * before / system.scales.omega_rad_s];
    let before = TAU / motion.cycle * system.rows.data.rate_hz * system.rows.step as f64;
    let shared = system.shared_coordinates(&[]).iter().zip(&values).map(|(c, v)| z(*c, *v)).collect();
    let point = Point { shared, starts: starts.iter().map(|s| turn(s, before)).collect() };
    let fitted = fit(&system, &[], &point, MOST_STEPS)?;
    Some((system, fitted))
}

/// Where the base model begins: each segment from the sine through its first half cycle.
fn beginning(system: &System, zeta: f64) -> Point {
    let (s, rows) = (&system.scales, &system.rows);
    let coordinates = system.shared_coordinates(&[]);
    let shared = coordinates.iter().zip([s.omega_rad_s, zeta, s.centre]).map(|(c, v)| z(*c, v)).collect();
    let half = ((PI / (s.omega_rad_s * s.interval_s)).ceil() as usize).max(4);
    let start = |segment: &Range<usize>| {
        // Normal equations of a cosine and a sine.
        let [mut cc, mut cs, mut ss, mut cy, mut sy] = [0.0; 5];
        for k in segment.clone().take(half) {
            let (sin, cos) = (s.omega_rad_s * (k - segment.start) as f64 * s.interval_s).sin_cos();
            let y = rows.data.reading[k] - s.centre;
            (cc, cs, ss, cy, sy) = (cc + cos * cos, cs + cos * sin, ss + sin * sin, cy + cos * y, sy + sin * y);
        }
        let det = (cc * ss - cs * cs).max(1e-300);
        let (a, b) = ((cy * ss - sy * cs) / det, (sy * cc - cy * cs) / det);
        vec![a / (0.1 * s.output), b / (0.1 * s.output)]
    };
    Point { shared, starts: rows.layout.segments.iter().map(start).collect() }
}
