//! What the omission costs in metres: position error after 10 s and 60 s, with and without the named physics.
//!
//! Constant and random errors by their closed forms, the proof mass by integrating it (f64, Runge–Kutta) under the stated
//! vibration and comparing what a user would integrate, a = ω₀²x, with the true acceleration. One axis, flat earth. Not an
//! ensemble: `proofmass study` runs DIR/model.toml for distributions.

use super::Diagnosis;
use super::repair::{Cost, Repair, Vibration};
use crate::error::{Error, Result};
use crate::navigation::closed_form::Process;
use crate::progress;
use crate::sensor::{ProofMass, Sensor};
use crate::units::STANDARD_GRAVITY_M_S2;

/// Times that the cost is stated for, s.
pub const TIMES_S: [f64; 2] = [10.0, 60.0];
/// Integration steps per radian of the fastest motion: RK4 then errs by less than 1e-6 of the amplitude per period.
const STEPS_PER_RADIAN: f64 = 12.0;
/// Beyond this many steps the mechanics are taken to follow at once; no user waits longer for one number.
const MOST_STEPS: f64 = 3e7;

/// Position error of one sensor at the stated times, m.
struct Drift {
    /// Variance of everything but the mechanics.
    random: [f64; 2],
    /// Of the proof mass.
    mechanical: [f64; 2],
}

/// The cost table: with the model as it was, with the named physics, the difference between the two, then the kind's rows.
///
/// # Errors
/// When stopped by Ctrl-C.
pub fn costs(diagnosis: &Diagnosis) -> Result<Vec<Cost>> {
    let Some(repair) = &diagnosis.repair else { return Ok(Vec::new()) };
    let before = Drift::of(&repair.before, &repair.vibration)?;
    let mut rows = vec![row("with the model as it was", before.total(), repair)];
    if repair.after != repair.before {
        let after = Drift::of(&repair.after, &repair.vibration)?;
        rows.push(row("with the named physics", after.total(), repair));
        rows.push(row(DIFFERENCE, after.beyond(&before, repair.before.proof_mass.is_some()), repair));
    }
    rows.extend(repair.own_cost.iter().cloned());
    Ok(rows)
}

/// What the row is called that says what leaving the physics out costs.
pub const DIFFERENCE: &str = "difference: what leaving it out costs";

fn row(of: &str, metres: [f64; 2], repair: &Repair) -> Cost {
    let vibration = &repair.vibration;
    let (under, basis) = match repair.before.proof_mass {
        Some(_) => (
            format!("{:.3} m/s² at {:.3} Hz", vibration.amplitude_m_s2, vibration.frequency_hz),
            "integrated in f64; noise by closed forms",
        ),
        None => ("at rest".to_owned(), "closed forms"),
    };
    let [ten, sixty] = metres;
    Cost { of: of.into(), under, position_10_s_m: ten, position_60_s_m: sixty, basis: basis.into() }
}

impl Drift {
    fn of(sensor: &Sensor, vibration: &Vibration) -> Result<Self> {
        let random = TIMES_S.map(|t| random_variance(sensor, t));
        Ok(Self { random, mechanical: mechanical(sensor, vibration)? })
    }

    fn total(&self) -> [f64; 2] {
        std::array::from_fn(|n| (self.random[n] + self.mechanical[n].powi(2)).sqrt())
    }

    /// What the two do not share. A driven base model counts its whole mismatch as noise; that is no drift that it missed,
    /// so with a proof mass only noise that was added counts.
    fn beyond(&self, before: &Self, has_proof_mass: bool) -> [f64; 2] {
        std::array::from_fn(|n| {
            let random = self.random[n] - before.random[n];
            let random = if has_proof_mass { random.max(0.0) } else { random.abs() };
            (random + (self.mechanical[n] - before.mechanical[n]).powi(2)).sqrt()
        })
    }
}

/// Position variance of everything but the mechanics. Bias instability counts as a constant: over a minute it is one.
fn random_variance(sensor: &Sensor, time_s: f64) -> f64 {
    let (a, g) = (&sensor.accelerometer, &sensor.gyro);
    let force_noise = sensor.proof_mass.map_or(0.0, |p| p.force_noise_m_s_rts);
    let accelerometer = [
        Process::Constant(a.bias_m_s2),
        Process::Constant(a.bias_instability_m_s2),
        Process::White(a.velocity_random_walk_m_s_rts),
        Process::White(force_noise),
        Process::Walk(a.acceleration_random_walk_m_s2_rts),
    ];
    let gyro = [
        Process::Constant(g.bias_rad_s),
        Process::Constant(g.bias_instability_rad_s),
        Process::White(g.angle_random_walk_rad_rts),
        Process::Walk(g.rate_random_walk_rad_s_rts),
    ];
    accelerometer.iter().map(|p| p.variance(2, time_s)).sum::<f64>()
        + gyro.iter().map(|p| p.variance(3, time_s)).sum::<f64>() * STANDARD_GRAVITY_M_S2.powi(2)
}

/// Position error at the stated times by the proof mass alone, with its sign.
fn mechanical(sensor: &Sensor, vibration: &Vibration) -> Result<[f64; 2]> {
    let Some(mass) = sensor.proof_mass else { return Ok([0.0; 2]) };
    let omega = 2.0 * std::f64::consts::PI * vibration.frequency_hz;
    let fastest = mass.natural_frequency_rad_s.max(omega);
    let steps = (TIMES_S[1] * fastest * STEPS_PER_RADIAN).ceil();
    if !steps.is_finite() || !(1.0..=MOST_STEPS).contains(&steps) {
        return Ok([0.0; 2]);
    }
    let steps = steps as usize;
    let h = TIMES_S[1] / steps as f64;
    let force = |t: f64| vibration.amplitude_m_s2 * (omega * t).sin();
    // x, x', then velocity and position error.
    let mut state = [0.0_f64; 4];
    let mut out = [0.0; 2];
    let bar = progress::bar("cost in metres", steps as u64);
    let early = (TIMES_S[0] / h).round() as usize;
    for n in 0..steps {
        let t = n as f64 * h;
        let slope = |t: f64, s: [f64; 4]| {
            let f = force(t);
            let error = mass.natural_frequency_rad_s.powi(2) * s[0] - f;
            [s[1], acceleration(&mass, s[0], s[1], f), error, s[2]]
        };
        let add = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
        let k1 = slope(t, state);
        let k2 = slope(t + h / 2.0, add(state, k1, h / 2.0));
        let k3 = slope(t + h / 2.0, add(state, k2, h / 2.0));
        let k4 = slope(t + h, add(state, k3, h));
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if n + 1 == early {
            out[0] = state[3];
        }
        if n % 100_000 == 0 {
            bar.set_position(n as u64);
            if progress::interrupted() {
                return Err(Error::interrupted("could not state the cost in metres", "start it again"));
            }
        }
    }
    bar.finish_and_clear();
    out[1] = state[3];
    // A sensor driven past its softening spring's hill leaves no number to state.
    Ok(if out.iter().all(|v| v.is_finite()) { out } else { [f64::INFINITY; 2] })
}

fn acceleration(mass: &ProofMass, x: f64, v: f64, force: f64) -> f64 {
    let omega = mass.natural_frequency_rad_s;
    let friction = if v == 0.0 { 0.0 } else { mass.coulomb_m_s2 * v.signum() };
    force
        - 2.0 * mass.damping_ratio * omega * v
        - omega * omega * x
        - mass.quadratic_per_m_s2 * x * x
        - mass.cubic_per_m2_s2 * x.powi(3)
        - mass.quadratic_damping_per_m * v.abs() * v
        - mass.squeeze_film_per_m2_s * x * x * v
        - friction
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mass(quadratic_per_m_s2: f64) -> ProofMass {
        ProofMass {
            natural_frequency_rad_s: 400.0,
            damping_ratio: 0.5,
            cubic_per_m2_s2: 0.0,
            quadratic_per_m_s2,
            quadratic_damping_per_m: 0.0,
            squeeze_film_per_m2_s: 0.0,
            coulomb_m_s2: 0.0,
            force_noise_m_s_rts: 0.0,
        }
    }

    /// A quadratic spring rectifies: the mean of αx² is α A²/(2ω₀⁴), a bias that drifts as ½ b t².
    #[test]
    fn a_quadratic_spring_drifts_as_the_bias_that_it_rectifies() {
        let mut sensor = Sensor::ideal();
        let (amplitude, alpha) = (5.0, 1e6);
        let vibration = Vibration { amplitude_m_s2: amplitude, frequency_hz: 5.0 };
        let drift = |quadratic: f64, sensor: &mut Sensor| {
            sensor.proof_mass = Some(mass(quadratic));
            mechanical(sensor, &vibration).expect("not interrupted")
        };
        let (with, without) = (drift(alpha, &mut sensor), drift(0.0, &mut sensor));
        let bias = alpha * amplitude * amplitude / 2.0 / 400f64.powi(4);
        let expected = 0.5 * bias * 3600.0;
        // The linear sensor's own start-up error is a velocity step; it is not part of the law.
        assert!(
            (with[1].abs() - expected).abs() < 0.05 * expected + without[1].abs(),
            "{with:?} {without:?} {expected}"
        );
        assert!(without[1].abs() < 0.2 * expected, "{without:?}");
    }
}
