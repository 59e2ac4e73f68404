//! The still sensor as a study runs it: the noise of the channel with most to gain, as its
//! datasheet promised it (without one, as white noise) and as it was found.

use super::candidate::row;
use super::cause::Cause;
use super::channel::{Channel, Fitted};
use super::describe;
use super::effects::Found;
use crate::diagnosis::model;
use crate::diagnosis::repair::{Cost, Repair, Row, Vibration};
use crate::recording::unit::{Quantity, Unit};
use crate::sensor::Sensor;
use crate::units::DENSITY_TO_RANDOM_WALK;

/// What a study can run of the first channel, where its unit is one of acceleration or rate.
pub(super) fn repair(
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
    let strength = |cause: Cause| {
        let index = fitted.terms.iter().position(|t| t.cause == cause)?;
        effects.iter().any(|e| e.cause == cause).then(|| fitted.strength_of(index).0.sqrt() * channel.scale * unit.si)
    };
    let white = describe::density_of_white(channel, fitted.white().0) * DENSITY_TO_RANDOM_WALK * unit.si;
    let promised = model.noise.map_or([white, 0.0, 0.0], |n| {
        [n.density * DENSITY_TO_RANDOM_WALK * unit.si, n.bias_instability * unit.si, n.random_walk * unit.si]
    });
    // What was not found to be otherwise stays as promised.
    let flicker = strength(Cause::FlickerNoise).unwrap_or(promised[1]);
    let walk = strength(Cause::RandomWalk).map_or(promised[2], |k| k * channel.rate_hz.sqrt());
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
    let expressible =
        |cause| matches!(cause, Cause::FlickerNoise | Cause::RandomWalk | Cause::WhiteNoise | Cause::RateRamp);
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
    Some(Repair {
        before: sensor(promised, 0.0),
        after: sensor([white, flicker, walk], found_ramp),
        relation: format!("one {} of {} is {} in SI", unit.name, channel.name, unit.si),
        own_cost: own_cost.collect(),
        not_expressible: entries
            .filter(|(e, _)| !expressible(e.cause))
            .map(|(_, entry)| format!("{}: {}", entry.id, entry.statement))
            .collect(),
        vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 },
    })
}
