//! States what the omission costs in metres: position error after 10 s and 60 s of a navigator with
//! the original model and of one with the named physics.
//!
//! Constant and random errors by their closed forms, the proof mass under the stated vibration by
//! `rectification`. One axis, flat earth. Not an ensemble: `proofmass study` runs DIR/repaired.toml
//! for distributions. Left out: what follows temperature (the sensor stays at its reference), what
//! is in proportion to an input, rounding and full scale. Laws with states of their own have no
//! row: only a study integrates them.

use super::rectification::{self, repeats};
use super::repair::{Cost, Repair, Row, Vibration};
use crate::control::{Control, Stopped};
use crate::navigation::closed_form::Process;
use crate::navigation::slow;
use crate::number::short;
use crate::sensor::error_law::{ErrorLaw, Growth};
use crate::sensor::{Sense, Sensor, SensorTerm};
use crate::units::STANDARD_GRAVITY_M_S2;

/// Times that the cost is stated for, s.
pub(crate) const TIMES_S: [f64; 2] = [10.0, 60.0];
/// Position error of one sensor at the stated times, m.
struct Drift {
    /// Variance of everything but the mechanics.
    random: [f64; 2],
    /// Of the proof mass.
    mechanical: [f64; 2],
}

/// Returns the cost table: a navigator with the model as it was, one with the named physics, then
/// the kind's own rows. It is empty where the recording is of no inertial sensor, and where only a
/// study integrates the named physics.
///
/// # Errors
/// Stopped.
pub fn costs(repair: Option<&Repair>, control: &Control) -> Result<Vec<Cost>, Stopped> {
    let Some(repair) = repair.filter(|repair| repair.is_inertial) else { return Ok(Vec::new()) };
    let mut rows = Vec::new();
    if is_integrated(&repair.after) {
        let after = Drift::of(&repair.after, &repair.vibration, control)?;
        if repair.after != repair.before {
            let before = Drift::of(&repair.before, &repair.vibration, control)?;
            let metres = match repair.before.proof_mass {
                Some(_) => after.read_as(&before),
                None => before.total(),
            };
            rows.push(row(Row::Before, metres, repair));
        }
        let metres = if repair.after.proof_mass.is_some() { after.read_as(&after) } else { after.total() };
        rows.push(row(Row::After, metres, repair));
    }
    rows.extend(repair.own_cost.iter().cloned());
    Ok(rows)
}

/// Returns whether all laws of the sensor repeat with the vibration; those with states of their own
/// do not.
fn is_integrated(sensor: &Sensor) -> bool {
    sensor.proof_mass.iter().flat_map(|mass| mass.laws.acting()).all(repeats)
}

fn row(row: Row, metres: [f64; 2], repair: &Repair) -> Cost {
    let of = match row {
        Row::Before | Row::Own => "with the original model",
        Row::After => "with the named physics",
    };
    let vibration = &repair.vibration;
    let (under, basis) = match repair.before.proof_mass {
        Some(_) => (
            format!("shaken at {} m/s² and {} Hz", short(vibration.amplitude_m_s2), short(vibration.frequency_hz)),
            "integrated in f64; noise by closed forms",
        ),
        None => ("at rest".to_owned(), "closed forms"),
    };
    let [ten, sixty] = metres;
    Cost { row, of: of.into(), under, position_10_s_m: ten, position_60_s_m: sixty, basis: basis.into() }
}

impl Drift {
    fn of(sensor: &Sensor, vibration: &Vibration, control: &Control) -> Result<Self, Stopped> {
        let random = TIMES_S.map(|t| random_variance(sensor, t));
        let mechanical = match &sensor.proof_mass {
            Some(mass) => rectification::position_error_m(mass, vibration, TIMES_S, control)?,
            None => [0.0; 2],
        };
        Ok(Self { random, mechanical })
    }

    fn total(&self) -> [f64; 2] {
        std::array::from_fn(|n| (self.random[n] + self.mechanical[n].powi(2)).sqrt())
    }

    /// Position error of a navigator who takes the readings of this sensor for those of `model`: its
    /// noise, and the mechanics that the model does not have. The noise of the model does not
    /// count: a driven base model takes its whole mismatch for noise.
    fn read_as(&self, model: &Self) -> [f64; 2] {
        std::array::from_fn(|n| (self.random[n] + (self.mechanical[n] - model.mechanical[n]).powi(2)).sqrt())
    }
}

/// Position variance of everything but the mechanics. Bias instability counts as a constant: over a
/// minute it is one.
fn random_variance(sensor: &Sensor, time_s: f64) -> f64 {
    let force_noise = sensor.proof_mass.map_or(0.0, |p| p.force_noise_m_s_rts);
    let shape = |term: SensorTerm| term.shapes().next().map_or(0.0, |shape| sensor.error(shape));
    let variance = |term: SensorTerm| {
        let coefficient = sensor.error(term);
        if coefficient == term.law().neutral() {
            return 0.0;
        }
        let (process, integrals) = match (term.law(), term.law().growth()) {
            (ErrorLaw::Flicker(_), _) => (Process::Constant(coefficient), 0),
            (ErrorLaw::Markov(_), _) => (Process::Markov { sigma: coefficient, tau_s: shape(term) }, 0),
            (ErrorLaw::Sine, _) => (Process::Sine { amplitude: coefficient, omega_rad_s: shape(term) }, 0),
            (ErrorLaw::Settling, _) => {
                let integrals = if term.sense() == Sense::Gyro { 3 } else { 2 };
                let grown = |time_s: f64| slow::settled(shape(term), integrals, time_s);
                let unit = Process::Constant(1.0).variance(integrals, time_s).sqrt();
                (Process::Constant(coefficient * grown(time_s) / unit), 0)
            }
            (_, Growth::OfAConstant(integrals)) => (Process::Constant(coefficient), integrals),
            (_, Growth::OfWhiteNoise(integrals)) => (Process::White(coefficient), integrals),
            // Temperature, proportion to an input, rounding, full scale: nothing at rest and at the
            // reference temperature.
            (_, Growth::Other) => return 0.0,
        };
        match term.sense() {
            Sense::Accelerometer => process.variance(2 + integrals, time_s),
            Sense::Gyro => process.variance(3 + integrals, time_s) * STANDARD_GRAVITY_M_S2.powi(2),
        }
    };
    Process::White(force_noise).variance(2, time_s) + SensorTerm::ALL.into_iter().map(variance).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::temperature::Temperature;
    use crate::physics::{hysteresis, quadratic_stiffness};
    use crate::sensor::ProofMass;
    use crate::units::key::Key;

    /// The textbook's closed forms, written out: bias ½bt², velocity random walk N t^1.5/√3, gyro
    /// bias g b t³/6, angle random walk g N t^2.5/√20; the paper's 0.034 m/s² makes 1.7 m after 10
    /// s.
    #[test]
    fn each_error_alone_costs_its_closed_form() {
        type Set = fn(&mut Sensor);
        let g = STANDARD_GRAVITY_M_S2;
        let cases: [(Set, [f64; 2]); 4] = [
            (|s| s.accelerometer.bias_m_s2 = 0.034, [1.7, 61.2]),
            (
                |s| s.accelerometer.velocity_random_walk_m_s_rts = 1e-3,
                TIMES_S.map(|t| 1e-3 * t.powf(1.5) / 3f64.sqrt()),
            ),
            (|s| s.gyro.bias_rad_s = 1e-4, TIMES_S.map(|t| g * 1e-4 * t.powi(3) / 6.0)),
            (|s| s.gyro.angle_random_walk_rad_rts = 1e-4, TIMES_S.map(|t| g * 1e-4 * t.powf(2.5) / 20f64.sqrt())),
        ];
        for (set, expected) in cases {
            let mut sensor = Sensor::default();
            set(&mut sensor);
            let vibration = Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 };
            let got = Drift::of(&sensor, &vibration, &Control::silent()).expect("nothing to interrupt").total();
            for (got, expected) in got.into_iter().zip(expected) {
                assert!((got / expected - 1.0).abs() < 1e-9, "{got} {expected}");
            }
        }
    }

    /// With a spring with memory, which is not integrated here, and of a recording in volts,
    /// nothing is claimed; with a quadratic spring, which a vibration rectifies, both navigators
    /// have a row (control). The one with the named physics errs by the noise alone, N t^1.5/√3;
    /// the other by what the spring rectifies as well, in quadrature.
    #[test]
    fn both_navigators_err_by_the_same_sensor() {
        let noise = 1e-3;
        let mass = ProofMass { natural_frequency_rad_s: 60.0, damping_ratio: 0.3, ..ProofMass::default() };
        let with = |mass: ProofMass| {
            let mut sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
            sensor.accelerometer.velocity_random_walk_m_s_rts = noise;
            sensor
        };
        let vibration = Vibration { amplitude_m_s2: 1.0, frequency_hz: 5.0 };
        let costs_with = |key: &Key, is_inertial: bool| {
            let repair = Repair {
                before: with(mass),
                after: with(mass.with(key, 1e5)),
                is_inertial,
                temperature: Temperature::default(),
                by_axis: Vec::new(),
                relation: String::new(),
                not_expressible: Vec::new(),
                vibration,
                own_cost: Vec::new(),
            };
            costs(Some(&repair), &Control::silent()).expect("nothing to interrupt")
        };
        let quadratic = &quadratic_stiffness::GIVEN[0].key;
        assert!(costs_with(&hysteresis::GIVEN[0].key, true).is_empty() && costs_with(quadratic, false).is_empty());
        let rows = costs_with(quadratic, true);
        let [before, after] = rows.as_slice() else { panic!("two rows: {rows:?}") };
        let by_noise = noise * 10f64.powf(1.5) / 3f64.sqrt();
        assert!((after.position_10_s_m / by_noise - 1.0).abs() < 1e-9, "{after:?}");
        let silent = Control::silent();
        let mechanics = |mass: ProofMass| rectification::position_error_m(&mass, &vibration, TIMES_S, &silent);
        let [bent, straight] =
            [mass.with(quadratic, 1e5), mass].map(|m| mechanics(m).expect("nothing to interrupt")[0]);
        let expected = by_noise.hypot(bent - straight);
        assert!(expected > 2.0 * by_noise && (before.position_10_s_m / expected - 1.0).abs() < 1e-9, "{before:?}");
    }

    /// Slow errors of an accelerometer by their double integrals, written out: Gauss–Markov
    /// σ²(2τt³/3 − τ²t² + 2τ⁴ − 2τ³(t + τ)e^(−t/τ)) (the integral of (t−u)(t−v) e^(−|u−v|/τ)), a
    /// sine of any phase A²/2 |∫(t−u)e^(iωu)du|², a warm-up b(τt − τ²(1 − e^(−t/τ))). Another shape
    /// costs something else.
    #[test]
    fn each_slow_error_alone_costs_its_closed_form() {
        type Set = fn(&mut Sensor, f64);
        type Metres = fn(f64, f64) -> f64;
        let cases: [(f64, Set, Metres); 3] = [
            (
                20.0,
                |s, shape| (s.accelerometer.markov_m_s2, s.accelerometer.markov_time_s) = (1e-3, shape),
                |tau, t| {
                    let forgets = 2.0 * tau.powi(3) * (t + tau) * (-t / tau).exp();
                    1e-3 * (2.0 / 3.0 * tau * t.powi(3) - tau * tau * t * t + 2.0 * tau.powi(4) - forgets).sqrt()
                },
            ),
            (
                0.3,
                |s, shape| {
                    (s.accelerometer.sinusoid_m_s2, s.accelerometer.sinusoid_frequency_rad_s) = (1e-3, shape);
                },
                |omega, t| {
                    let x = omega * t;
                    1e-3 / (omega * omega) * (0.5 * ((1.0 - x.cos()).powi(2) + (x - x.sin()).powi(2))).sqrt()
                },
            ),
            (
                15.0,
                |s, shape| (s.accelerometer.warm_up_m_s2, s.accelerometer.warm_up_time_s) = (1e-3, shape),
                |tau, t| 1e-3 * (tau * t - tau * tau * (1.0 - (-t / tau).exp())),
            ),
        ];
        for (shape, set, metres) in cases {
            let mut sensor = Sensor::default();
            set(&mut sensor, shape);
            let vibration = Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 };
            let got = Drift::of(&sensor, &vibration, &Control::silent()).expect("nothing to interrupt").total();
            for (got, time_s) in got.into_iter().zip(TIMES_S) {
                let off = |shape: f64| (got / metres(shape, time_s) - 1.0).abs();
                assert!(off(shape) < 1e-8, "{got} {}", metres(shape, time_s));
                assert!(off(1.5 * shape) > 1e-2, "{got} {}", metres(1.5 * shape, time_s));
            }
        }
    }
}
