//! The linear resonator alone, fitted to all sweeps, and the sizes by which laws next to it are
//! measured.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::Complex;

use crate::engine::fit::{Fitted, MOST_STEPS, fit};
use crate::engine::kind::Point;
use crate::numerics::order;
use crate::physics::scales::Scales;

use super::intake::Sweeps;
use super::space;
use super::system::{OWN, System};
use super::values::Sizes;

/// Widths at which a fit begins, in that of the band.
const WIDTHS: [f64; 4] = [0.01, 0.04, 0.15, 0.5];
/// Steps of a first fit.
const FIRST_STEPS: usize = 12;

/// The base model, with the laws whose sizes it sets.
pub(super) fn base(sweeps: &Sweeps) -> Option<(System<'_>, Fitted)> {
    let counted = || (0..sweeps.len()).filter(|k| sweeps.counts[*k]);
    let of_drive = |k: &usize| sweeps.reading[*k].norm() / sweeps.drive[*k];
    let peak = counted().max_by(|a, b| of_drive(a).total_cmp(&of_drive(b)))?;
    let reading = counted().map(|k| sweeps.reading[k].norm()).fold(0.0, f64::max);
    if reading <= 0.0 {
        return None;
    }
    let omega_rad_s = TAU * sweeps.frequency_hz[peak];
    let band_hz = sweeps.span_hz();
    let amplitude = reading / omega_rad_s.powi(sweeps.derivatives);
    let drive = counted().map(|k| sweeps.drive[k]).fold(0.0, f64::max);
    let sizes = |damping_per_s: f64, omega_rad_s: f64| Sizes {
        laws: scales(sweeps, omega_rad_s, damping_per_s, amplitude),
        damping_per_s,
        reading,
        amplitude,
        drive,
        band_hz,
    };
    let begin = |part: &f64| {
        let damping_per_s = TAU * part * (band_hz[1] - band_hz[0]);
        let mut system = System::new(sweeps, sizes(damping_per_s, omega_rad_s));
        let readout = Complex::new(0.0, omega_rad_s).powi(sweeps.derivatives);
        // At its resonance a displacement lags the drive by a quarter of a turn.
        let angle = (sweeps.reading[peak] / (readout * Complex::new(0.0, -1.0))).arg();
        let mut shared = vec![0.0; system.own()];
        (shared[2], shared[3]) = ((of_drive(&peak) * drive / reading).max(1e-6).ln(), angle);
        let first = fit(&system, &[], &Point { shared, starts: empty(sweeps) }, FIRST_STEPS)?;
        // Coordinates are measured by what was found.
        let values = system.values(&[], &first.point);
        let mut point = first.point.clone();
        (point.shared[0], point.shared[1]) = (0.0, 0.0);
        point.shared[2] -= (values.mass.damping_per_s * values.mass.omega_rad_s / damping_per_s / omega_rad_s).ln();
        system.sizes = sizes(values.mass.damping_per_s, values.mass.omega_rad_s);
        let again = fit(&system, &[], &point, MOST_STEPS)?;
        Some((system, again))
    };
    let mut all: Vec<_> = WIDTHS.iter().filter_map(begin).collect();
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
        lines_hz: Vec::new(),
        environment: Vec::new(),
        centre: 0.0,
        fineness: 1.0,
        lag_samples: 0.0,
    }
}
