//! The loop closed: the fitted model as a sensor that a study can run.

use std::f64::consts::SQRT_2;

use crate::diagnosis::driven::base::{GAIN, OMEGA, ZETA};
use crate::diagnosis::driven::identification::fit::Fit;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::repair::{Repair, Vibration};
use crate::numerics::moments::mean_sd;
use crate::numerics::spectrum;
use crate::physics::law::Noise;
use crate::physics::library::Term;
use crate::sensor::{Accelerometer, ProofMass, Sensor};

/// Sensors with and without the terms of `after`. One unit of input is taken as 1 m/s²; without an input, one unit of
/// output as 1 m.
pub fn repair(data: &Data, before: &Fit, after: &Fit, input: Option<&str>) -> Repair {
    let mut not_expressible = Vec::new();
    let repaired = sensor(data, after, Some(&mut not_expressible));
    let vibration = match &data.input {
        Some(values) => {
            let u = &values.samples()[data.hull.clone()];
            let density = spectrum::welch(u, data.rate_hz, 1024);
            let total: f64 = density.density.iter().sum();
            let mean =
                density.frequency_hz.iter().zip(&density.density).map(|(f, d)| f * d).sum::<f64>() / total.max(1e-300);
            Vibration { amplitude_m_s2: SQRT_2 * mean_sd(u).1, frequency_hz: mean.max(1e-9) }
        }
        None => {
            let omega = after.point[OMEGA];
            let amplitude = SQRT_2 * mean_sd(&data.reading[data.hull.clone()]).1 * omega * omega;
            Vibration { amplitude_m_s2: amplitude, frequency_hz: 0.1 * omega / std::f64::consts::TAU }
        }
    };
    let relation = match input {
        Some(name) => {
            format!("one unit of {name} is taken as 1 m/s² of specific force; displacement follows from the gain")
        }
        None => "one unit of the output is taken as 1 m of displacement".to_owned(),
    };
    Repair {
        before: sensor(data, before, None),
        after: repaired,
        relation,
        not_expressible,
        vibration,
        own_cost: Vec::new(),
    }
}

fn sensor(data: &Data, fit: &Fit, mut not_expressible: Option<&mut Vec<String>>) -> Sensor {
    let gain = if data.input.is_some() { fit.point[GAIN] } else { 1.0 };
    let (omega, zeta) = (fit.point[OMEGA], fit.point[ZETA]);
    let mut mass = ProofMass {
        natural_frequency_rad_s: omega,
        damping_ratio: zeta,
        cubic_per_m2_s2: 0.0,
        quadratic_per_m_s2: 0.0,
        quadratic_damping_per_m: 0.0,
        squeeze_film_per_m2_s: 0.0,
        coulomb_m_s2: 0.0,
        force_noise_m_s_rts: 0.0,
    };
    let readout = fit.variance.sqrt() / fit.shape.gain(&fit.point, data.interval_s()).innovation_variance.sqrt();
    // A white sequence with deviation σ at rate f has N = σ/√f; displacement becomes acceleration by ω₀²/G.
    let to_acceleration = omega * omega / gain.abs();
    let mut accelerometer = Accelerometer {
        velocity_random_walk_m_s_rts: readout * to_acceleration * data.interval_s().sqrt(),
        ..Accelerometer::default()
    };
    for (i, term) in fit.shape.terms.iter().enumerate() {
        let p = fit.shape.of(i, &fit.point);
        match term {
            _ if drives(term, p[0]) => {
                if let Some(list) = not_expressible.as_deref_mut() {
                    list.push(format!("{}, which came out negative: {}", term.id(), term.candidate().equation));
                }
            }
            Term::CubicStiffness(_) => mass.cubic_per_m2_s2 = p[0] * gain * gain,
            Term::QuadraticStiffness(_) => mass.quadratic_per_m_s2 = p[0] * gain,
            Term::QuadraticDamping(_) => mass.quadratic_damping_per_m = p[0] * gain.abs(),
            Term::SqueezeFilmDamping(_) => mass.squeeze_film_per_m2_s = p[0] * gain * gain,
            Term::CoulombFriction(_) => mass.coulomb_m_s2 = p[0] / gain.abs(),
            _ => match term.noise() {
                // Stationary displacement variance of white force with two-sided intensity N²: N²/(4ζω³).
                Some(Noise::Force) => {
                    mass.force_noise_m_s_rts = p[0] * readout * (4.0 * zeta * omega.powi(3)).sqrt() / gain.abs();
                }
                Some(Noise::Walk) => {
                    accelerometer.acceleration_random_walk_m_s2_rts =
                        p[0] * readout * to_acceleration / data.interval_s().sqrt();
                }
                None => {
                    if let Some(list) = not_expressible.as_deref_mut() {
                        list.push(format!("{}: {}", term.id(), term.candidate().equation));
                    }
                }
            },
        }
    }
    Sensor { proof_mass: Some(mass), accelerometer, ..Sensor::default() }
}

/// Within its interval a damping may come out below zero; a study takes none that drives.
fn drives(term: &Term, size: f64) -> bool {
    size < 0.0 && matches!(term, Term::QuadraticDamping(_) | Term::SqueezeFilmDamping(_) | Term::CoulombFriction(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::coulomb_friction::CoulombFriction;
    use crate::physics::cubic_stiffness::CubicStiffness;

    #[test]
    fn friction_below_zero_drives_and_a_softening_spring_does_not() {
        assert!(
            drives(&Term::CoulombFriction(CoulombFriction), -1.0)
                && !drives(&Term::CoulombFriction(CoulombFriction), 1.0)
        );
        assert!(!drives(&Term::CubicStiffness(CubicStiffness), -1.0));
    }
}
