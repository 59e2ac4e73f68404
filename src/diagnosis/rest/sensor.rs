//! The still sensor as a study runs it: the noise of the channel with most to gain, as its datasheet promised it (without
//! one, as white noise) and as it was found.

use super::channel::{Channel, Fitted};
use super::describe;
use crate::diagnosis::model;
use crate::diagnosis::repair::{Cost, Repair, Vibration};
use crate::diagnosis::verdict::{Effect, Verdict};
use crate::recording::unit::{Quantity, Unit};
use crate::sensor::Sensor;
use crate::units::DENSITY_TO_RANDOM_WALK;

/// What a study can run of the first channel, where its unit is one of acceleration or rate.
pub(super) fn repair(
    channels: &[Channel],
    finals: &[Fitted],
    verdict: &Verdict,
    model: &model::Static,
) -> Option<Repair> {
    let unit = &model.unit;
    let unit = Unit::parse(unit, Quantity::Accelerometer).or_else(|_| Unit::parse(unit, Quantity::Gyro)).ok()?;
    // The channel with most to gain stands for the sensor.
    let worst = channels.iter().position(|c| verdict.effects.iter().any(|e| e.channels.contains(&c.name))).unwrap_or(0);
    let (channel, fitted) = (&channels[worst], &finals[worst]);
    let strength = |id: &str| {
        let index = fitted.terms.iter().position(|t| t.id == id)?;
        verdict.effects.iter().any(|e| e.id == id).then(|| fitted.strength_of(index).0.sqrt() * channel.scale * unit.si)
    };
    let white = describe::density_of_white(channel, fitted.white().0) * DENSITY_TO_RANDOM_WALK * unit.si;
    let promised = model.noise.map_or([white, 0.0, 0.0], |n| {
        [n.density * DENSITY_TO_RANDOM_WALK * unit.si, n.bias_instability * unit.si, n.random_walk * unit.si]
    });
    // What was not found to be otherwise stays as promised.
    let flicker = strength("flicker-noise").unwrap_or(promised[1]);
    let walk = strength("random-walk").map_or(promised[2], |k| k * channel.rate_hz.sqrt());
    let sensor = |[white, flicker, walk]: [f64; 3]| {
        let mut sensor = Sensor::default();
        if unit.quantity == Quantity::Accelerometer {
            sensor.accelerometer.velocity_random_walk_m_s_rts = white;
            sensor.accelerometer.bias_instability_m_s2 = flicker;
            sensor.accelerometer.acceleration_random_walk_m_s2_rts = walk;
        } else {
            sensor.gyro.angle_random_walk_rad_rts = white;
            sensor.gyro.bias_instability_rad_s = flicker;
            sensor.gyro.rate_random_walk_rad_s_rts = walk;
        }
        sensor
    };
    let outside = |e: &&Effect| !matches!(e.id.as_str(), "flicker-noise" | "random-walk" | "white-noise");
    let own_cost = verdict.effects.iter().filter(|e| e.id == "rate-ramp" && unit.quantity == Quantity::Accelerometer);
    Some(Repair {
        before: sensor(promised),
        after: sensor([white, flicker, walk]),
        relation: format!("one {} of {} is {} in SI", unit.name, channel.name, unit.si),
        not_expressible: verdict.effects.iter().filter(outside).map(|e| format!("{}: {}", e.id, e.statement)).collect(),
        vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 },
        own_cost: own_cost
            .map(|e| {
                let rate = e.parameters[0].value.abs() * unit.si;
                Cost {
                    of: format!("{} ({})", e.id, e.channels.join(", ")),
                    under: "at rest".into(),
                    position_10_s_m: rate * 1e3 / 6.0,
                    position_60_s_m: rate * 216e3 / 6.0,
                    basis: "R t³/6".into(),
                }
            })
            .collect(),
    })
}
