//! The loop closed: the fitted model as a sensor that a study can run.

use std::f64::consts::{SQRT_2, TAU};

use crate::driven::base::{GAIN, OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::{Data, Followed};
use crate::model::Output;
use crate::motion::temperature::Temperature;
use crate::number::rounded;
use crate::numerics::moments::mean_sd;
use crate::numerics::spectrum;
use crate::physics::bias_drift::{BiasDrift, Course};
use crate::physics::coefficients::{Coefficients, StudyLaw, laws};
use crate::physics::creeping_friction::CreepingFriction;
use crate::physics::dimension::Units;
use crate::physics::hysteresis::{Hysteresis, Sharpness};
use crate::physics::law::Noise;
use crate::physics::library::Term;
use crate::physics::one_sided_stop::OneSidedStop;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::warm_stiffness::WarmStiffness;
use crate::recording::roles::{self, Stated};
use crate::recording::unit::Quantity;
use crate::repair::{Repair, Vibration};
use crate::sensor::{Accelerometer, ProofMass, Sensor};
use crate::units::key::Sign;
use crate::warm_profile::{is_in_celsius, is_possible, profile};

use super::asked::Asked;
use super::effects::unit_of;

/// Sensors with and without the terms of the final model. The input's unit is the file's where that
/// is one of specific force, else taken as 1 m/s²; without an input, one unit of output is taken as
/// 1 m. Readout noise with a memory is written as the white noise of the same density at low
/// frequencies, which is `low_frequency` times that of its innovations, from which drift comes.
pub(in crate::driven) fn repair(
    asked: &Asked<'_>,
    data: &Data,
    [before, after]: [&Fit; 2],
    low_frequency: f64,
) -> Repair {
    let input = data.input.as_ref().and(asked.columns.input.as_deref());
    let own = input.and_then(|name| match roles::stated(name, asked.recording.stated(name)) {
        Some(Stated::Inertial(unit)) if unit.quantity == Quantity::Accelerometer => Some(unit),
        _ => None,
    });
    let per_input = own.as_ref().map_or(1.0, |unit| unit.si);
    let warmth = warmth(asked, data, &after.structure.terms);
    let mut not_expressible = Vec::new();
    let with_noise = |mut sensor: Sensor| {
        sensor.accelerometer.velocity_random_walk_m_s_rts *= low_frequency;
        sensor
    };
    let repaired = with_noise(sensor(data, after, per_input, warmth.is_some(), Some(&mut not_expressible)));
    let vibration = match &data.input {
        Some(values) => {
            let u = &values.samples()[data.hull.clone()];
            let density = spectrum::welch(u, data.rate_hz, 1024);
            let total: f64 = density.density.iter().sum();
            let mean =
                density.frequency_hz.iter().zip(&density.density).map(|(f, d)| f * d).sum::<f64>() / total.max(1e-300);
            Vibration { amplitude_m_s2: SQRT_2 * mean_sd(u).1 * per_input, frequency_hz: mean.max(1e-9) }
        }
        None => {
            let omega = after.point[OMEGA];
            let amplitude = SQRT_2 * mean_sd(&data.reading[data.hull.clone()]).1 * omega * omega;
            Vibration { amplitude_m_s2: amplitude, frequency_hz: 0.1 * omega / std::f64::consts::TAU }
        }
    };
    let si = match data.observed.output {
        Output::Displacement => "m",
        Output::Velocity => "m/s",
        Output::Acceleration => "m/s^2",
    };
    let relation = match (input, &own) {
        (Some(name), Some(unit)) => {
            format!(
                "one unit of {name} is {} m/s² of specific force; displacement follows from the gain",
                rounded(unit.si, 6)
            )
        }
        (Some(name), None) => {
            format!("one unit of {name} is taken as 1 m/s² of specific force; displacement follows from the gain")
        }
        (None, _) => format!("one unit of the output is taken as 1 {si} of the mass"),
    };
    let far_above =
        if data.observed.at_once { "; no resonance showed, so that one far above the rate is written" } else { "" };
    // Without an input the reading itself gives the displacement.
    let is_metric = input.is_none() && unit_of(asked.recording, &asked.columns.output, "") == si;
    Repair {
        is_inertial: own.is_some() || is_metric,
        before: with_noise(sensor(data, before, per_input, false, None)),
        after: repaired,
        by_axis: Vec::new(),
        relation: relation
            + far_above
            + &warmth.as_ref().map_or_else(String::new, |(name, _)| format!("; {name} is taken as °C")),
        temperature: warmth.map(|(_, temperature)| temperature).unwrap_or_default(),
        not_expressible,
        vibration,
        own_cost: Vec::new(),
    }
}

/// The temperature that the spring follows, as it was recorded, with the mean about which the model was
/// fitted as reference, and its heading; `None` where it follows none, or a study cannot take it.
fn warmth<'a>(asked: &Asked<'_>, data: &'a Data, terms: &[Term]) -> Option<(&'a str, Temperature)> {
    let [place] = terms.iter().filter_map(|term| term.environment()).collect::<Vec<_>>()[..] else { return None };
    let Followed { heading, mean } = data.followed.get(place)?;
    if asked.pieces.len() != 1 || !is_in_celsius(heading) {
        return None;
    }
    let points = profile(asked.recording.column(heading)?, asked.recording.rate_hz, |deg_c| deg_c);
    is_possible(&points).then(|| (heading.as_str(), Temperature::new(points, *mean)))
}

/// The fitted model, with `per_input` m/s² in one unit of input; `warm`: with the temperature that its spring follows, if it follows one.
fn sensor(data: &Data, fit: &Fit, per_input: f64, warm: bool, mut not_expressible: Option<&mut Vec<String>>) -> Sensor {
    // Displacement for 1 m/s², whatever the input's unit.
    let gain = if data.input.is_some() { fit.point[GAIN] / per_input } else { 1.0 };
    let (omega, zeta) = (fit.point[OMEGA], fit.point[ZETA]);
    let mut mass = ProofMass { natural_frequency_rad_s: omega, damping_ratio: zeta, ..ProofMass::default() };
    let readout = fit.variance.sqrt() / fit.structure.gain(&fit.point, data.interval_s()).innovation_variance.sqrt();
    // A white sequence with deviation σ at rate f has N = σ/√f; displacement becomes acceleration
    // by ω₀²/G.
    let to_acceleration = omega * omega / gain.abs();
    let mut accelerometer = Accelerometer {
        velocity_random_walk_m_s_rts: readout * to_acceleration * data.interval_s().sqrt(),
        ..Accelerometer::default()
    };
    for (i, term) in fit.structure.terms.iter().enumerate() {
        let p = fit.structure.of(i, &fit.point);
        let (term, p) = &as_a_study_has_it(term, p, warm);
        let law = laws().iter().find(|law| law.term == *term);
        if let Some(law) = law {
            if is_refused(law, p) {
                if let Some(list) = not_expressible.as_deref_mut() {
                    list.push(format!("{}, which came out negative: {}", term.id(), term.candidate().equation));
                }
            } else {
                mass.laws = metric(mass.laws, law, p, [gain, per_input]);
            }
            continue;
        }
        match term.noise() {
            // Stationary displacement variance of white force with two-sided intensity N²:
            // N²/(4ζω³).
            Some(Noise::Force) => {
                mass.force_noise_m_s_rts = p[0] * readout * (4.0 * zeta * omega.powi(3)).sqrt() / gain.abs();
            }
            Some(Noise::Walk) => {
                accelerometer.acceleration_random_walk_m_s2_rts =
                    p[0] * readout * to_acceleration / data.interval_s().sqrt();
            }
            None if at_the_readout(&mut accelerometer, term, p, [omega * omega / gain, per_input]) => {}
            None => {
                if let Some(list) = not_expressible.as_deref_mut() {
                    list.push(format!("{} ({}): {}", term.id(), term.candidate().equation, why_not(term)));
                }
            }
        }
    }
    Sensor { proof_mass: Some(mass), accelerometer, ..Sensor::default() }
}

/// Returns the form in which a study has this term, with its values: a stop on one side stands at a
/// place, a friction of any shape but the sharp one is one law, a spring with memory has an exponent, and one next to a temperature follows it.
fn as_a_study_has_it(term: &Term, p: &[f64], warm: bool) -> (Term, Vec<f64>) {
    match term {
        Term::EndStop(stop) => OneSidedStop::values_of(*stop, p)
            .map_or((*term, p.to_vec()), |values| (Term::OneSidedStop(OneSidedStop), values.to_vec())),
        Term::ShapedFriction(friction) => {
            (Term::CreepingFriction(CreepingFriction), CreepingFriction::values_of(*friction, p).to_vec())
        }
        Term::Hysteresis(Hysteresis(Sharpness::One)) => {
            (Term::Hysteresis(Hysteresis(Sharpness::Own)), [&p[..3], &[1.0]].concat())
        }
        Term::StiffnessDrift(_) if warm && term.environment().is_some() => {
            (Term::WarmStiffness(WarmStiffness), p.to_vec())
        }
        _ => (*term, p.to_vec()),
    }
}

/// States why no study runs a term that has none of its keys.
fn why_not(term: &Term) -> &'static str {
    match term {
        Term::StiffnessDrift(_) => {
            "a study's spring follows time (sensor.stiffness_drift_per_s) or one temperature in °C from a single \
             recording (sensor.stiffness_per_k)"
        }
        Term::ReadoutSaturation(_) => "a study's range is the same on both sides of zero",
        Term::ReadoutLowpass(_) => "a study's low-pass has one pole",
        Term::BiasDrift(_) => "a study's ramp is a straight line",
        Term::ParasiticMode(_) => "a study has one further mode",
        Term::RingingMode(_) => "how an input moves it shows under an input alone",
        Term::InputLag(_) | Term::InputHighpass(_) => "it belongs to what recorded the input, not to the sensor",
        _ => "a study has no key for it",
    }
}

/// Ends of a range that differ by more than this fraction of it are no one range.
const LOPSIDED: f64 = 0.05;

/// Gives the accelerometer what was added at the readout of the displacement, one unit of which is
/// so much acceleration with its sign, as is one unit of input; `false` where no term of a study is that.
fn at_the_readout(accelerometer: &mut Accelerometer, term: &Term, p: &[f64], [per_unit, per_input]: [f64; 2]) -> bool {
    match term {
        Term::BiasDrift(BiasDrift(Course::Line)) => accelerometer.ramp_m_s3 = p[0] * per_unit,
        Term::WarmUp(_) => {
            (accelerometer.warm_up_m_s2, accelerometer.warm_up_time_s) = (p[0] * per_unit, p[1]);
        }
        // Its phase belongs to the recording.
        Term::PeriodicDisturbance(_) => {
            accelerometer.sinusoid_m_s2 = p[0].hypot(p[1]) * per_unit.abs();
            accelerometer.sinusoid_frequency_rad_s = TAU * p[2];
        }
        // a + K₂a² + K₃a³ of a = c·x is c·(x + cK₂x² + c²K₃x³).
        Term::ReadoutNonlinearity(_) => {
            (accelerometer.k2_per_m_s2, accelerometer.k3_per_m2_s4) = (p[0] / per_unit, p[1] / per_unit.powi(2));
        }
        Term::Feedthrough(_) => accelerometer.feedthrough = p[0] * per_unit / per_input,
        Term::ReadoutDelay(_) => accelerometer.readout_delay_s = p[0],
        Term::ReadoutLowpass(ReadoutLowpass(Poles::One)) => accelerometer.readout_lowpass_s = p[0],
        Term::ReadoutQuantisation(_) => accelerometer.quantisation_m_s2 = p[0] * per_unit.abs(),
        Term::ReadoutSaturation(_) if (p[0] + p[1]).abs() < LOPSIDED * (p[1] - p[0]) => {
            accelerometer.range_m_s2 = 0.5 * (p[1] - p[0]) * per_unit.abs();
        }
        _ => return false,
    }
    true
}

/// Within its interval a damping may come out below zero; a study takes none that drives.
fn is_refused(law: &StudyLaw, p: &[f64]) -> bool {
    law.given().iter().zip(p).any(|(given, value)| given.key.sign != Sign::Any && *value < 0.0)
}

/// With the law's parameters in SI: a unit of input is `per_input` m/s², and displacement becomes
/// metres by the gain for 1 m/s².
fn metric(mut all: Coefficients, law: &StudyLaw, p: &[f64], [gain, per_input]: [f64; 2]) -> Coefficients {
    let units = Units { y: 1.0 / gain.abs(), u: per_input, s: 1.0 };
    for (parameter, (given, value)) in law.given().iter().zip(p).enumerate() {
        let turned = if given.turns && gain < 0.0 { -1.0 } else { 1.0 };
        all = all.with(&given.key, turned * value * law.factor(parameter, &units));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(id: &str) -> &'static StudyLaw {
        laws().iter().find(|law| law.term.id() == id).expect("it is listed")
    }

    #[test]
    fn friction_below_zero_drives_and_a_softening_spring_does_not() {
        assert!(is_refused(law("coulomb-friction"), &[-1.0]) && !is_refused(law("coulomb-friction"), &[1.0]));
        assert!(!is_refused(law("cubic-stiffness"), &[-1.0]));
    }

    // A unit of displacement is −3 m/s²: what is added keeps its sign where it has one.
    #[test]
    fn what_is_added_at_the_readout_is_acceleration() {
        let given = |id: &str, p: &[f64]| {
            let mut accelerometer = Accelerometer::default();
            let term = *Term::all().iter().find(|term| term.id() == id).expect("it is listed");
            let taken = at_the_readout(&mut accelerometer, &term, p, [-3.0, 1.0]);
            (taken, accelerometer)
        };
        let bare = Accelerometer::default();
        let warm = Accelerometer { warm_up_m_s2: -6.0, warm_up_time_s: 5.0, ..bare };
        assert_eq!(given("warm-up", &[2.0, 5.0]), (true, warm));
        let sine = Accelerometer { sinusoid_m_s2: 15.0, sinusoid_frequency_rad_s: TAU * 7.0, ..bare };
        assert_eq!(given("periodic-disturbance", &[3.0, -4.0, 7.0]), (true, sine));
        let bent = Accelerometer { k2_per_m_s2: -2.0, k3_per_m2_s4: 0.5, ..bare };
        assert_eq!(given("readout-nonlinearity", &[6.0, 4.5]), (true, bent));
        assert_eq!(given("feedthrough", &[0.5]), (true, Accelerometer { feedthrough: -1.5, ..bare }));
        // Times are no displacement.
        assert_eq!(given("readout-delay", &[0.5]), (true, Accelerometer { readout_delay_s: 0.5, ..bare }));
        assert_eq!(given("readout-lowpass", &[0.5]), (true, Accelerometer { readout_lowpass_s: 0.5, ..bare }));
        assert_eq!(given("readout-quantisation", &[0.5]), (true, Accelerometer { quantisation_m_s2: 1.5, ..bare }));
        assert_eq!(given("readout-saturation", &[-2.0, 2.0]), (true, Accelerometer { range_m_s2: 6.0, ..bare }));
        // Control: a range that lies on one side of zero is no range of a study.
        assert_eq!(given("readout-saturation", &[-1.0, 2.0]), (false, bare));
    }

    // y = G·x with G = −2: β in 1/(y² s²) is 4β in 1/(m² s²), α in 1/(y s²) is −2α, friction in
    // y/s² is half in m/s².
    #[test]
    fn parameters_become_metric_by_the_gain_and_its_sign() {
        for (id, expected) in [("cubic-stiffness", 12.0), ("quadratic-stiffness", -6.0), ("coulomb-friction", 1.5)] {
            let got = metric(Coefficients::default(), law(id), &[3.0], [-2.0, 1.0]).of(&law(id).given()[0].key);
            assert!((got - expected).abs() < 1e-12, "{id}: {got}");
        }
    }

    // y = x + x₂ in units of which −2 m/s² drive one: g₂ follows the gain and its sign, what is a
    // ratio or a rate stays; 1/y of a memory is 2/m.
    #[test]
    fn states_of_their_own_become_metric_too() {
        for (id, given, expected) in [
            ("parasitic-mode", [3.0, 40.0, 0.1], [-1.5, 40.0, 0.1]),
            ("coupled-mode", [0.3, 40.0, 0.1], [0.3, 40.0, 0.1]),
            ("hysteresis", [3.0, 5.0, -1.0], [3.0, 10.0, -2.0]),
        ] {
            // Unknown beginnings stand behind the parameters.
            let fitted = [given[0], given[1], given[2], 7.0, 8.0];
            let got = metric(Coefficients::default(), law(id), &fitted, [-2.0, 1.0]);
            for (key, expected) in law(id).given().iter().zip(expected) {
                assert!((got.of(&key.key) - expected).abs() < 1e-12, "{id}: {got:?}");
            }
        }
        assert!(
            is_refused(law("coupled-mode"), &[-0.1, 1.0, 0.1]) && !is_refused(law("parasitic-mode"), &[-0.1, 1.0, 0.1])
        );
    }
}
