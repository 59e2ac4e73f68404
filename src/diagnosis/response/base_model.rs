//! The linear resonator alone, fitted to all sweeps, and the sizes by which laws next to it are
//! measured.

use std::f64::consts::{SQRT_2, TAU};

use crate::engine::fit::{Fitted, fit};
use crate::engine::kind::Point;
use crate::numerics::order;
use crate::physics::scales::Scales;

use super::beginnings::{Beginning, beginnings};
use super::intake::Sweeps;
use super::predicted::shapes;
use super::space;
use super::system::{OWN, System};
use super::values::Sizes;

/// Steps of a fit at most: along a ridge of settling, width and background it may take many, and without a
/// base model there is no answer.
const STEPS: usize = 100;

/// The base model, with the laws whose sizes it sets.
pub(super) fn base(sweeps: &Sweeps) -> Option<(System<'_>, Fitted)> {
    let counted = || (0..sweeps.len()).filter(|k| sweeps.counts[*k]);
    let reading = counted().map(|k| sweeps.reading[k].norm()).fold(0.0, f64::max);
    if reading <= 0.0 {
        return None;
    }
    let band_hz = sweeps.span_hz();
    let drive = counted().map(|k| sweeps.drive[k]).fold(0.0, f64::max);
    let sizes = |damping_per_s: f64, omega_rad_s: f64| {
        let amplitude = reading / omega_rad_s.powi(sweeps.derivatives);
        let laws = scales(sweeps, omega_rad_s, damping_per_s, amplitude);
        Sizes { laws, damping_per_s, reading, amplitude, drive, band_hz }
    };
    let [low, high] = band_hz.map(|f| TAU * f);
    let one = System::new(sweeps, sizes(high - low, 0.5 * (low + high)));
    let shapes: Vec<Vec<f64>> =
        (0..one.backgrounds).map(|i| (0..sweeps.len()).map(|k| shapes(sweeps, &one.sizes, k)[i]).collect()).collect();
    let begin = |from: Beginning| {
        let mut system = System::new(sweeps, sizes(from.damping_per_s, from.omega_rad_s));
        let mut shared = vec![0.0; system.own()];
        (shared[2], shared[3]) = ((from.gain.norm() * drive / reading).max(1e-9).ln(), from.gain.arg());
        let background = from.background.iter().flat_map(|b| [b.re, b.im]);
        shared[OWN..].iter_mut().zip(background).for_each(|(z, b)| *z = b / (0.1 * reading));
        let first = fit(&system, &[], &Point { shared, starts: empty(sweeps) }, STEPS)?;
        // Coordinates are measured by what was found.
        let values = system.values(&[], &first.point);
        let mass = values.mass;
        system.sizes = sizes(mass.damping_per_s, mass.omega_rad_s);
        let mut point = first.point.clone();
        let unit = system.sizes.amplitude * mass.omega_rad_s * mass.damping_per_s / drive;
        (point.shared[0], point.shared[1], point.shared[2]) = (0.0, 0.0, (values.gain / unit).ln());
        let again = fit(&system, &[], &point, STEPS)?;
        Some((system, again))
    };
    let mut all: Vec<_> = beginnings(sweeps, &shapes).into_iter().filter_map(begin).collect();
    order::sort_by_key(&mut all, |(_, f)| f.variance);
    let (mut system, fitted) = all.into_iter().next()?;
    system.members = space::members(&system.sizes.laws, sweeps.time_s.is_some());
    debug_assert!(fitted.point.shared.len() >= OWN);
    Some((system, fitted))
}

/// No sweep has a start of its own.
fn empty(sweeps: &Sweeps) -> Vec<Vec<f64>> {
    vec![Vec::new(); sweeps.sweeps.len()]
}

fn scales(sweeps: &Sweeps, omega_rad_s: f64, damping_per_s: f64, amplitude: f64) -> Scales {
    let output = amplitude / SQRT_2;
    let duration_s = sweeps.time_s.as_ref().and_then(|t| t.last().copied()).unwrap_or(0.0);
    let [low, high] = sweeps.span_hz();
    Scales {
        output,
        output_range: (-amplitude, amplitude),
        velocity: output * omega_rad_s,
        input: 1.0,
        omega_rad_s,
        zeta: 0.5 * damping_per_s / omega_rad_s,
        gain: 1.0,
        // A delay by this turns the phase by a radian over the band.
        interval_s: 1.0 / (TAU * (high - low)),
        duration_s: duration_s.max(1.0),
        residual: 0.0,
        highest_hz: high,
        lines_hz: Vec::new(),
        environment: Vec::new(),
        centre: 0.0,
        fineness: 1.0,
        lag_samples: 0.0,
        at_once: false,
    }
}
