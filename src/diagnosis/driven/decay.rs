//! A free decay: a recording of one proof mass without an input, from where it is let go until it
//! rests.
//!
//! Intake finds the motion ([`swings`]) and its rows ([`rows`]); the engine searches the laws
//! ([`space`], [`system`]) by free simulation; [`answer`] says what was found.

mod answer;
mod effects;
mod findings;
mod form;
mod rows;
mod space;
mod swings;
mod system;

pub(crate) use answer::answer;
pub(crate) use swings::Motion;

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use crate::engine::fit::{Fitted, MOST_STEPS, fit};
use crate::engine::kind::Point;
use crate::engine::levels::FOLLOWED;
use crate::engine::names::{self, Found};
use crate::engine::search::Search;
use crate::numerics::moments::{mean_sd, rms};

use super::identification::refined_scales::lines;
use super::identification::start::first_scales;
use super::intake::data::Data;
use super::intake::reading_noise::{ReadingNoise, Sample, reading_noise};
use super::simulation::filter::States;

use rows::Rows;
use system::{System, z};

/// Damping ratios at which a base model begins.
const ZETAS: [f64; 4] = [0.003, 0.03, 0.15, 0.5];

/// A decay that was searched.
pub(crate) struct Decay {
    motion: Motion,
    system: System,
    /// Noise of the reading, and its variance in a row that is fitted.
    noise: ReadingNoise,
    variance: f64,
    found: Found,
    numbers: Numbers,
}

/// The final model over segments as long as it follows the motion through: its numbers are those of
/// the whole decay, and not of its loudest part.
struct Numbers {
    /// The decay in those segments.
    system: System,
    /// The base model with the named laws.
    model: Arc<Fitted>,
    /// For each named law the laws that do as well in its place.
    rivals: Vec<Vec<(usize, Arc<Fitted>)>>,
}

/// Searches a recording without an input; `None` where nothing swings in it, or no oscillator
/// follows it. `filled` were not recorded.
pub(crate) fn decay(data: &Data, filled: &[Range<usize>]) -> Option<Decay> {
    let noise = reading_noise(&Sample::of(data))?;
    let motion = swings::motion(&data.reading, data.hull.clone(), noise.deviation)?;
    let rows = rows::rows(data, &motion, filled);
    if rows.layout.segments.is_empty() {
        return None;
    }
    let (system, base) = base(rows, &motion)?;
    // What rounding adds is not smoothed away below a thousandth of the motion.
    let least = 1e-6 * system.scales.output;
    let variance = (noise.deviation * system.rows.noise_gain).max(least).powi(2);
    let (search, base) = Search::begin(&system, variance, &base.point)?;
    let found = names::names(&search, base);
    drop(search);
    let numbers = numbers(&system, &found, variance);
    Some(Decay { motion, system, noise, variance, found, numbers })
}

/// Joins segments as long as the model follows the motion through the longer ones.
fn numbers(system: &System, found: &Found, noise: f64) -> Numbers {
    let copy =
        |rows: &Rows| System { rows: rows.clone(), scales: system.scales.clone(), members: system.members.clone() };
    let mut numbers = Numbers {
        system: copy(&system.rows),
        model: found.model.clone(),
        rivals: found.named.iter().map(|n| n.rivals.clone()).collect(),
    };
    let most = FOLLOWED * found.model.variance.max(noise);
    while let Some(rows) = numbers.system.rows.joined() {
        let before = &numbers.system.rows.layout.segments;
        let is_first = |s: &Range<usize>| before.iter().position(|own| own.start == s.start);
        let firsts: Vec<usize> = rows.layout.segments.iter().filter_map(is_first).collect();
        let joined = copy(&rows);
        let again = |fitted: &Fitted| {
            let starts = firsts.iter().map(|s| fitted.point.starts[*s].clone()).collect();
            let point = Point { starts, ..fitted.point.clone() };
            fit(&joined, &fitted.set, &point, MOST_STEPS).map(Arc::new)
        };
        let Some(model) = again(&numbers.model).filter(|m| m.variance <= most) else { break };
        let all = numbers.rivals.iter().map(|r| r.iter().map(|(law, f)| Some((*law, again(f)?))).collect());
        let Some(rivals) = all.collect() else { break };
        numbers = Numbers { system: joined, model, rivals };
    }
    numbers
}

impl Decay {
    /// States that a model passes through, row by row.
    fn passed(&self, model: &Fitted) -> States {
        let mut states = States::default();
        self.system.traced(&model.set, &model.point, &mut states);
        states
    }
}

/// The base model, with the laws whose sizes it sets.
fn base(rows: Rows, motion: &Motion) -> Option<(System, Fitted)> {
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
    system.members = space::members(system.rows.data.environments, &system.scales);
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
    let half = ((std::f64::consts::PI / (s.omega_rad_s * s.interval_s)).ceil() as usize).max(4);
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
