//! Thermomechanical noise of a resonator: what its own temperature does to the reading, by the
//! fluctuation-dissipation theorem (Callen & Welton, Phys. Rev. 83, 1951).
//!
//! Densities are one-sided. A lock-in is taken to state root mean squares, as its X and Y are in V rms.

use std::f64::consts::TAU;
use std::path::Path;

use crate::error::{Error, Result};
use crate::model;
use crate::verdict::Thermal;

use super::force::Oscillator;

/// Boltzmann's constant, J/K (exact in the SI of 2019).
const BOLTZMANN_J_K: f64 = 1.380_649e-23;

/// Checks what a model states.
///
/// # Errors
/// A number that is not above zero.
pub(super) fn check(stated: &model::Thermal, path: &Path) -> Result<()> {
    let bandwidth = stated.bandwidth_hz.unwrap_or(1.0);
    for (key, value) in [
        ("mass_kg", stated.mass_kg),
        ("temperature_k", stated.temperature_k),
        ("si_per_unit", stated.si_per_unit),
        ("bandwidth_hz", bandwidth),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::new(
                format!("could not diagnose {}", path.display()),
                format!("[thermal] needs {key} above zero, got {value}"),
                "correct it, or leave [thermal] out",
            ));
        }
    }
    Ok(())
}

/// One-sided density of the thermomechanical force, N²/Hz: 4 k_B T m ω₀/Q, and ω₀/Q is Γ.
fn force_psd_n2_hz(mass_kg: f64, temperature_k: f64, mass: Oscillator) -> f64 {
    4.0 * BOLTZMANN_J_K * temperature_k * mass_kg * mass.damping_per_s
}

/// One-sided density of the displacement that it makes, m²/Hz; at resonance 4 k_B T Q/(m ω₀³).
fn displacement_psd_m2_hz(mass_kg: f64, temperature_k: f64, mass: Oscillator, omega_rad_s: f64) -> f64 {
    let stiffness = mass.omega_rad_s.powi(2) - omega_rad_s.powi(2);
    let size = mass_kg.powi(2) * (stiffness.powi(2) + (omega_rad_s * mass.damping_per_s).powi(2));
    force_psd_n2_hz(mass_kg, temperature_k, mass) / size
}

/// The noise of a resonance, next to the root mean square of what the final model leaves of X and of Y.
pub(super) fn noise(stated: model::Thermal, mass: Oscillator, derivatives: i32, residual_rms: f64) -> Thermal {
    let model::Thermal { mass_kg, temperature_k, si_per_unit, bandwidth_hz } = stated;
    let omega_rad_s = mass.omega_rad_s;
    let density = displacement_psd_m2_hz(mass_kg, temperature_k, mass, omega_rad_s);
    // A low-pass of the filter's bandwidth passes as much on both sides of the resonance, to X and to Y by
    // halves. Where it is no longer narrow against the width, the density falls to its sides: X and Y
    // together hold no more than equipartition.
    let width_hz = mass.damping_per_s / TAU;
    let reading = |bandwidth_hz: f64| {
        let displacement_m = (density * 0.5 * width_hz * (2.0 * bandwidth_hz / width_hz).atan()).sqrt();
        displacement_m * omega_rad_s.powi(derivatives) / si_per_unit
    };
    let reading_rms = bandwidth_hz.map(reading);
    Thermal {
        temperature_k,
        force_psd_n2_hz: force_psd_n2_hz(mass_kg, temperature_k, mass),
        displacement_psd_m2_hz: density,
        displacement_rms_m: (BOLTZMANN_J_K * temperature_k / (mass_kg * omega_rad_s.powi(2))).sqrt(),
        bandwidth_hz,
        reading_rms,
        residual_ratio: reading_rms.map(|rms| residual_rms / rms),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATED: model::Thermal =
        model::Thermal { mass_kg: 1e-12, temperature_k: 300.0, si_per_unit: 1e-9, bandwidth_hz: Some(1e-3) };

    fn resonator() -> Oscillator {
        Oscillator { omega_rad_s: TAU * 1e5, damping_per_s: TAU * 10.0 }
    }

    // By hand: k_B T is 4.141947e-21 J, Q is 10⁴ and ω₀ 6.283185e5 rad/s.
    #[test]
    fn densities_are_those_of_the_closed_form() {
        let found = noise(STATED, resonator(), 0, 1.0);
        let (thermal_j, q, omega) = (4.141_947e-21, 1e4, 6.283_185_307e5);
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        near(found.force_psd_n2_hz, 4.0 * thermal_j * 1e-12 * omega / q);
        near(found.displacement_psd_m2_hz, 4.0 * thermal_j * q / (1e-12 * f64::powi(omega, 3)));
        // A narrow band holds the density times its width; read in nm, and as a velocity ω₀ times it.
        let narrow_m = (found.displacement_psd_m2_hz * 1e-3).sqrt();
        near(found.reading_rms.unwrap_or_default(), narrow_m / 1e-9);
        let velocity = noise(STATED, resonator(), 1, 1.0);
        near(velocity.reading_rms.unwrap_or_default(), omega * narrow_m / 1e-9);
        near(velocity.residual_ratio.unwrap_or_default(), 1e-9 / (omega * narrow_m));
        let without = noise(model::Thermal { bandwidth_hz: None, ..STATED }, resonator(), 0, 1.0);
        assert_eq!((without.reading_rms, without.residual_ratio), (None, None));
    }

    // Equipartition: ½ m ω₀² ⟨x²⟩ = ½ k_B T, for a sharp and for a broad resonance. Midpoint rule in u with
    // f = f₀ + width/2 · tan u, in which the density of a sharp one is even.
    #[test]
    fn the_density_holds_over_all_frequencies_what_equipartition_gives() {
        for q in [1e4, 3.0] {
            let own = Oscillator { damping_per_s: TAU * 1e5 / q, ..resonator() };
            let (f0, half) = (1e5, 0.5e5 / q);
            let (from, to) = ((-f0 / half).atan(), TAU / 4.0);
            let steps = 2_000_000;
            let step = (to - from) / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|k| {
                    let u = from + (f64::from(k) + 0.5) * step;
                    let omega = TAU * (f0 + half * u.tan());
                    displacement_psd_m2_hz(1e-12, 300.0, own, omega) * half / u.cos().powi(2) * step
                })
                .sum();
            let whole = noise(STATED, own, 0, 1.0).displacement_rms_m.powi(2);
            assert!((sum / whole - 1.0).abs() < 1e-4, "{q}: {sum} {whole}");
            let wide = model::Thermal { bandwidth_hz: Some(1e12), ..STATED };
            let read_m = noise(wide, own, 0, 1.0).reading_rms.unwrap_or_default() * 1e-9;
            assert!((2.0 * read_m.powi(2) / whole - 1.0).abs() < 1e-4, "{q}: X and Y hold {read_m} m");
        }
    }

    #[test]
    fn what_is_not_above_zero_is_refused_by_its_key() {
        let refused = |stated: model::Thermal| check(&stated, Path::new("a.csv")).expect_err("refused").cause;
        assert!(refused(model::Thermal { mass_kg: 0.0, ..STATED }).contains("mass_kg"));
        assert!(refused(model::Thermal { bandwidth_hz: Some(f64::NAN), ..STATED }).contains("bandwidth_hz"));
        assert!(check(&STATED, Path::new("a.csv")).is_ok());
    }
}
