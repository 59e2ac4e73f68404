//! The still sensor as a study runs it: the noise of the channel with most to gain, as its
//! datasheet promised it (without one, as white noise) and as it was found.

use std::f64::consts::TAU;

use super::candidate::row;
use super::cause::Cause;
use super::channel::{Channel, Fitted};
use super::describe;
use super::effects::{Basis, Found};
use super::temperature_profile::{self, Unfit};
use crate::model;
use crate::motion::temperature::Temperature;
use crate::number::short;
use crate::recording::Recording;
use crate::recording::unit::{Quantity, Unit};
use crate::repair::{Cost, Repair, Row, Vibration};
use crate::sensor::{Sensor, SensorTerm};
use crate::units::DENSITY_TO_RANDOM_WALK;

/// Returns what a study can run of the first channel, where its unit is one of acceleration or
/// rate.
pub(super) fn repair(
    recording: &Recording,
    channels: &[Channel],
    finals: &[Fitted],
    effects: &[Found],
    model: &model::Static,
) -> Option<Repair> {
    let unit = &model.unit;
    let unit = Unit::parse(unit, Quantity::Accelerometer).or_else(|_| Unit::parse(unit, Quantity::Gyro)).ok()?;
    // The channel with most to gain stands for the sensor.
    let worst = (0..channels.len()).find(|i| effects.iter().any(|e| e.channels.contains(i))).unwrap_or(0);
    let (channel, fitted) = (&channels[worst], &finals[worst]);
    let near = near_law(effects, worst);
    let strength = |cause: Cause| {
        // One law of free exponent stands for the whole sum that was fitted.
        if let Some(near) = near {
            return near.effect.is(cause, worst).then_some(near.coefficient * unit.si);
        }
        let index = fitted.terms.iter().position(|t| t.cause == cause)?;
        let per_step = if cause == Cause::RandomWalk { channel.rate_hz.sqrt() } else { 1.0 };
        let strength = || fitted.strength_of(index).0.sqrt() * channel.scale * per_step * unit.si;
        effects.iter().any(|e| e.cause == cause).then(strength)
    };
    let white = describe::density_of_white(channel, fitted.white().0) * DENSITY_TO_RANDOM_WALK * unit.si;
    let promised = model.noise.map_or([white, 0.0, 0.0], |n| {
        [n.density * DENSITY_TO_RANDOM_WALK * unit.si, n.bias_instability * unit.si, n.random_walk * unit.si]
    });
    // What was not found to be otherwise stays as promised.
    let flicker = strength(Cause::FlickerNoise).unwrap_or(promised[1]);
    let walk = strength(Cause::RandomWalk).unwrap_or(promised[2]);
    let rate_of = |e: &Found| e.parameters[0].value * unit.si;
    let ramps = || effects.iter().filter(|e| e.cause == Cause::RateRamp);
    let found_ramp = ramps().find(|e| e.channels.contains(&worst)).map_or(0.0, rate_of);
    let sensor = |[white, flicker, walk]: [f64; 3], ramp: f64| {
        let mut sensor = Sensor::default();
        if unit.quantity == Quantity::Accelerometer {
            sensor.accelerometer.velocity_random_walk_m_s_rts = white;
            sensor.accelerometer.bias_instability_m_s2 = flicker;
            sensor.accelerometer.acceleration_random_walk_m_s2_rts = walk;
            sensor.accelerometer.ramp_m_s3 = ramp;
        } else {
            sensor.gyro.angle_random_walk_rad_rts = white;
            sensor.gyro.bias_instability_rad_s = flicker;
            sensor.gyro.rate_random_walk_rad_s_rts = walk;
            sensor.gyro.ramp_rad_s2 = ramp;
        }
        sensor
    };
    let entries = effects.iter().filter_map(|e| Some((e, row(e.cause).entry?)));
    // Of a channel that does not stand for the sensor: the study has the other's.
    let elsewhere = entries.clone().filter(|(e, _)| e.cause == Cause::RateRamp && !e.channels.contains(&worst));
    let own_cost = elsewhere.filter(|_| unit.quantity == Quantity::Accelerometer).map(|(e, entry)| {
        let rate = rate_of(e).abs();
        let names: Vec<&str> = e.channels.iter().map(|i| channels[*i].name.as_str()).collect();
        Cost {
            row: Row::Own,
            of: format!("{} ({})", entry.id, names.join(", ")),
            under: "at rest".into(),
            position_10_s_m: rate * 1e3 / 6.0,
            position_60_s_m: rate * 216e3 / 6.0,
            basis: "R t³/6".into(),
        }
    });
    let mut after = sensor([white, flicker, walk], found_ramp);
    for effect in effects.iter().filter(|e| is_first(e, effects, worst)) {
        after = with_slow(after, effect, unit.quantity, unit.si);
    }
    let is_warm = effects.iter().any(|e| e.is(Cause::TemperatureSensitivity, worst));
    let warmth = if is_warm { temperature_profile::of(channel, fitted, recording) } else { Err(Unfit::Elsewhere) };
    let mut relation = format!("one {} of {} is {} in SI", unit.name, channel.name, unit.si);
    if let Ok(warmth) = &warmth {
        for (term, change) in over_temperature(unit.quantity).into_iter().zip(warmth.by_power) {
            after = after.with_error(term, change * unit.si);
        }
        let late = if warmth.is_late { ", as late as the reading follows it" } else { "" };
        relation += &format!("; [temperature] is the column `{}`, one of its units taken as 1 °C{late}", warmth.column);
    }
    let is_held = |e: &Found| match e.cause {
        cause if is_slow(cause) => is_first(e, effects, worst),
        Cause::TemperatureSensitivity => warmth.is_ok() && e.channels.contains(&worst),
        Cause::FlickerNoise | Cause::RandomWalk => strength(e.cause).is_some(),
        cause => matches!(cause, Cause::WhiteNoise | Cause::RateRamp),
    };
    let unfit = |e: &Found| match e.cause {
        _ if !e.channels.contains(&worst) => Some(Unfit::Elsewhere),
        Cause::TemperatureSensitivity => warmth.as_ref().err().copied(),
        _ => None,
    };
    let exponent = near.and_then(|near| {
        let (id, found, whole) = (row(near.effect.cause).entry?.id, short(near.exponent), near.whole);
        Some(format!("the exponent {found} of {id}; the study has exponent {whole}"))
    });
    Some(Repair {
        before: sensor(promised, 0.0),
        after,
        by_axis: Vec::new(),
        temperature: warmth.as_ref().map_or_else(|_| Temperature::default(), |warmth| warmth.temperature.clone()),
        is_inertial: true,
        relation,
        own_cost: own_cost.collect(),
        not_expressible: entries
            .filter(|(e, _)| !is_held(e))
            .map(|(e, entry)| format!("{}: {}{}", entry.id, entry.statement, instead(e.cause, unfit(e))))
            .chain(exponent)
            .collect(),
        vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 },
    })
}

/// Returns what a bias follows of the temperature, its square and its cube.
fn over_temperature(quantity: Quantity) -> [SensorTerm; 3] {
    use SensorTerm::*;
    match quantity {
        Quantity::Gyro => [GyroBiasPerKelvin, GyroBiasPerKelvinSquared, GyroBiasPerKelvinCubed],
        _ => [AccelerometerBiasPerKelvin, AccelerometerBiasPerKelvinSquared, AccelerometerBiasPerKelvinCubed],
    }
}

/// One law of free exponent, as a study takes it: the library's, with the coefficient that fits.
#[derive(Clone, Copy)]
struct NearLaw<'a> {
    effect: &'a Found,
    /// File units.
    coefficient: f64,
    exponent: f64,
    /// The library law's.
    whole: u8,
}

/// The one that stands for all slow laws of a channel, where one does.
fn near_law(effects: &[Found], channel: usize) -> Option<NearLaw<'_>> {
    let effect = effects.iter().find(|e| e.basis == Basis::Exponent && e.channels.contains(&channel))?;
    let whole = if effect.cause == Cause::RandomWalk { 2 } else { 1 };
    let [coefficient, exponent] = [effect.parameters.first()?.value, effect.parameters.get(1)?.value];
    Some(NearLaw { effect, coefficient, exponent, whole })
}

/// Returns whether it has a law of time that a study has a term for.
fn is_slow(cause: Cause) -> bool {
    matches!(cause, Cause::GaussMarkov | Cause::WarmUp | Cause::Sinusoid)
}

/// Returns whether it is the strongest of its cause in the channel that stands for the sensor: a
/// study has one term of each law.
fn is_first(effect: &Found, effects: &[Found], worst: usize) -> bool {
    let first = effects.iter().find(|e| e.is(effect.cause, worst));
    first.is_some_and(|first| std::ptr::eq(first, effect))
}

/// With a law of time: its strength, and the time or the frequency that belongs to it. The phase of
/// a sine belongs to the recording and is drawn.
fn with_slow(sensor: Sensor, effect: &Found, quantity: Quantity, si: f64) -> Sensor {
    use SensorTerm::*;
    let gyro = quantity == Quantity::Gyro;
    let (term, per_shape) = match effect.cause {
        Cause::GaussMarkov => (if gyro { GyroMarkov } else { AccelerometerMarkov }, 1.0),
        Cause::WarmUp => (if gyro { GyroWarmUp } else { AccelerometerWarmUp }, 1.0),
        Cause::Sinusoid => (if gyro { GyroSinusoid } else { AccelerometerSinusoid }, TAU),
        _ => return sensor,
    };
    let [strength, shape] = [0, 1].map(|i| effect.parameters.get(i).map_or(0.0, |p| p.value));
    let sensor = sensor.with_error(term, strength * si);
    term.shapes().next().map_or(sensor, |place| sensor.with_error(place, shape * per_shape))
}

/// Returns what a study takes in its place: a sentence behind another one, empty for nothing.
fn instead(cause: Cause, unfit: Option<Unfit>) -> String {
    match (cause, unfit) {
        (_, Some(unfit)) => format!(" {}", unfit.words()),
        (Cause::Sinusoid | Cause::WarmUp | Cause::GaussMarkov, None) => {
            " The study has the strongest of its kind, in the channel that stands for the sensor.".into()
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::channel::{Addition, Term};
    use crate::rest::spectrum::Law;
    use crate::rng::{Philox, Stream};
    use crate::verdict::{Estimate, Evidence};

    fn found(cause: Cause, values: [f64; 2]) -> Found {
        let estimate = |value: f64| Estimate { name: String::new(), value, unit: String::new(), ci95: [value; 2] };
        Found {
            cause,
            channels: vec![0],
            parameters: values.map(estimate).to_vec(),
            evidence: Evidence { held_out_gain: 0.5, p_value: 1e-9 },
            rivals: Vec::new(),
            basis: Basis::Shape,
        }
    }

    #[test]
    fn laws_of_time_become_terms_and_the_strongest_of_each_stands_for_it() {
        let effects = [
            found(Cause::Sinusoid, [3.0, 0.5]),
            found(Cause::Sinusoid, [2.0, 4.0]),
            found(Cause::GaussMarkov, [5.0, 60.0]),
            found(Cause::WarmUp, [-7.0, 20.0]),
        ];
        let firsts: Vec<bool> = effects.iter().map(|e| is_first(e, &effects, 0)).collect();
        assert_eq!(firsts, [true, false, true, true]);
        assert!(!is_first(&effects[0], &effects, 1), "another channel has none");
        let kept = effects.iter().filter(|e| is_first(e, &effects, 0));
        let sensor = kept.fold(Sensor::default(), |s, e| with_slow(s, e, Quantity::Gyro, 0.1));
        let g = sensor.gyro;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(g.sinusoid_rate_rad_s, 0.3) && near(g.sinusoid_frequency_rad_s, TAU * 0.5));
        assert!(near(g.markov_rad_s, 0.5) && near(g.markov_time_s, 60.0));
        assert!(near(g.warm_up_rad_s, -0.7) && near(g.warm_up_time_s, 20.0));
        assert_eq!(sensor.accelerometer, Sensor::default().accelerometer);
    }

    /// Returns what a study takes of a channel fitted with these laws, in which this alone was
    /// found.
    fn repaired(laws: &[(Cause, Law)], effect: Found) -> Repair {
        let mut rng = Philox::new(61, 0, Stream::Host);
        let mut sum = 0.0;
        let values: Vec<f64> = (0..4000)
            .map(|_| {
                sum += 0.05 * rng.normal();
                sum + rng.normal()
            })
            .collect();
        let channel = Channel::new("x", &values, 1.0);
        let term = |(cause, law): &(Cause, Law)| Term {
            cause: *cause,
            addition: Addition::Law(*law),
            searched: 0.0,
            column: None,
        };
        let fitted = channel.fit(laws.iter().map(term).collect());
        let model = model::Static {
            topic: None,
            rate_hz: Some(1.0),
            force_rate: false,
            rows: Vec::new(),
            unit: "m/s2".into(),
            latitude_deg: None,
            height_m: None,
            columns: model::StaticColumns { time: None, channels: vec!["x".into()], environment: Vec::new() },
            noise: None,
            split: model::Split::default(),
        };
        repair(&Recording::default(), &[channel], &[fitted], &[effect], &model).expect("a unit of acceleration")
    }

    #[test]
    fn a_law_of_free_exponent_reaches_the_study_in_place_of_the_sum_it_stands_for() {
        let markov = [(Cause::RandomWalk, Law::Walk), (Cause::GaussMarkov, Law::Markov(30.0))];
        let flicker = [(Cause::FlickerNoise, Law::Flicker), (Cause::RandomWalk, Law::Walk)];
        let near = |cause| Found { basis: Basis::Exponent, ..found(cause, [0.25, 1.4]) };
        for laws in [markov, flicker] {
            let repair = repaired(&laws, near(Cause::FlickerNoise));
            let after = repair.after.accelerometer;
            assert_eq!((after.bias_instability_m_s2, after.acceleration_random_walk_m_s2_rts), (0.25, 0.0));
            let said = "the exponent 1.40 of flicker-noise; the study has exponent 1";
            assert_eq!(repair.not_expressible, [said]);
            let walk = repaired(&laws, near(Cause::RandomWalk));
            let after = walk.after.accelerometer;
            assert_eq!((after.bias_instability_m_s2, after.acceleration_random_walk_m_s2_rts), (0.0, 0.25));
            assert!(walk.not_expressible[0].ends_with("the study has exponent 2"), "{:?}", walk.not_expressible);
        }
        // Controls: a whole law has the strength that was fitted, and one that was not fitted is
        // not in the study.
        let whole = repaired(&flicker, found(Cause::RandomWalk, [0.25, 1.4]));
        let walk = whole.after.accelerometer.acceleration_random_walk_m_s2_rts;
        assert!(walk > 0.0 && walk != 0.25 && whole.not_expressible.is_empty(), "{walk}");
        let lost = repaired(&markov, found(Cause::FlickerNoise, [0.25, 1.4]));
        assert_eq!(lost.after.accelerometer.bias_instability_m_s2, 0.0);
        assert!(lost.not_expressible[0].starts_with("flicker-noise: "), "{:?}", lost.not_expressible);
    }
}
