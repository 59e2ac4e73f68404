//! Parameters of the laws in sweeps: how a fit moves each, and where it begins.

use std::f64::consts::TAU;

use crate::physics::library::Term;
use crate::physics::scales::Coordinate;

use super::values::Sizes;

/// Part of the spring's force at which an even one begins.
const EVEN: f64 = 0.3;
/// Damping ratios of a second mode, in that of the first.
const SHARPNESS: [f64; 2] = [0.01, 100.0];
/// Part of the lowest frequency at which a high-pass may have its corner: it still turns the phase there by a tenth.
const LOWEST: f64 = 0.1;
/// Corners of a high-pass at which a fit begins, along the logarithm of the band.
const CORNERS: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// Peak of a second mode over that of the first, where a fit begins that looks for the opposite sign: from −0.3
/// fits reached a mode of −0.1 from all of five places, from ±0.05 from two and three.
const OPPOSED: f64 = -0.3;

/// Gain of a second mode that is as large as the first, and as sharp.
fn unit_of_mode(s: &Sizes) -> f64 {
    s.amplitude * s.laws.omega_rad_s * s.damping_per_s / s.drive
}

/// Coordinates of a law's parameters; unknown beginnings have none, as every step is a steady state.
pub(super) fn coordinates(s: &Sizes, term: &Term) -> Vec<Coordinate> {
    let mut own = term.coordinates(&s.laws);
    own.truncate(own.len() - term.unknown_beginnings());
    match term {
        // A second mode is as sharp as the first, within a factor.
        Term::CoupledMode(_) | Term::ParasiticMode(_) => {
            own[2] = Coordinate::Log(SHARPNESS[0] * s.laws.zeta, (SHARPNESS[1] * s.laws.zeta).min(0.6));
            // Its gain is measured by the first mode's, and no rate of samples bounds its frequency.
            if let Term::ParasiticMode(_) = term {
                own[1] = Coordinate::Log(0.05 * s.laws.omega_rad_s, 20.0 * s.laws.omega_rad_s);
                own[0] = Coordinate::Linear(0.1 * unit_of_mode(s));
            }
        }
        Term::ReadoutHighpass(_) => {
            let Coordinate::Log(shortest, _) = own[0] else { return own };
            own[0] = Coordinate::Log(shortest, (1.0 / (LOWEST * TAU * s.band_hz[0])).max(2.0 * shortest));
        }
        _ => {}
    }
    own
}

/// Exponent n at which a power law, strength (|s|/size)ⁿ⁻¹ s, equals a stated law, strength |s|ⁿ⁻¹ s; `None` where
/// it never does.
pub(super) fn exponent(stated: &Term, wide: &Term) -> Option<f64> {
    match (stated, wide) {
        (Term::CubicStiffness(_), Term::PowerLawStiffness(_)) => Some(3.0),
        (Term::QuadraticDamping(_), Term::PowerLawDamping(_)) => Some(2.0),
        _ => None,
    }
}

/// Values from which a law may begin.
pub(super) fn starts(sizes: &Sizes, term: &Term) -> Vec<Vec<f64>> {
    let s = &sizes.laws;
    match term {
        Term::FreeForm(_) => vec![vec![0.0; term.values()]],
        // An even force shows by its square: next to nothing it has no slope.
        Term::QuadraticStiffness(_) => vec![vec![EVEN * s.omega_rad_s.powi(2) / s.output]],
        // In radians over the band.
        Term::ReadoutDelay(_) => [0.05, 0.5, 1.5, 3.0].map(|turn| vec![turn * s.interval_s]).to_vec(),
        Term::ReadoutHighpass(_) => {
            let [low, high] = sizes.band_hz;
            let corner_hz = |part: f64| low * (high / low).powf(part);
            CORNERS.map(|part| vec![1.0 / (TAU * corner_hz(part)), 0.0]).to_vec()
        }
        // Nearby alone does a second mode show.
        Term::CoupledMode(_) | Term::ParasiticMode(_) => {
            let strength = if matches!(term, Term::CoupledMode(_)) { 1e-5 } else { 0.0 };
            let at = |widths: f64| s.omega_rad_s + widths * sizes.damping_per_s;
            let own = |strength: f64, widths: f64| vec![strength, at(widths), s.zeta, 0.0, 0.0];
            let mut all = [-2.0, -0.7, 0.0, 0.7, 2.0].map(|widths| own(strength, widths)).to_vec();
            // A fit that begins with no strength keeps to one sign of it: a mode read against the first needs a
            // beginning of its own.
            if matches!(term, Term::ParasiticMode(_)) {
                all.extend([-0.7, 0.7].map(|widths| own(OPPOSED * unit_of_mode(sizes), widths)));
            }
            all
        }
        _ => term.starts(s),
    }
}
