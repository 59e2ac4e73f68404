//! Signs of a wrong unit in a still recording: gravity of the wrong length, noise far from what was
//! promised.
//!
//! Only findings: a sensor may be odd, and a person decides. Not for channels whose unit is
//! unknown.

use super::channel::{Channel, Fitted};
use super::describe;
use crate::error::{Error, Result};
use crate::model::Noise;
use crate::number::short;
use crate::recording::inspection::leaps;
use crate::recording::unit::{Quantity, Unit};
use crate::units::STANDARD_GRAVITY_M_S2;

/// White noise this many times the promised one, or less by as much, is no spread of manufacture.
const FAR: f64 = 20.0;

/// Three accelerometer channels at rest read 1 g together; by a factor that units differ in they do
/// not. Of each channel its mean and the unit that model or file states.
pub(super) fn gravity(channels: &[(f64, Unit)]) -> Option<String> {
    let forces: Vec<&(f64, Unit)> = channels.iter().filter(|c| c.1.quantity == Quantity::Accelerometer).collect();
    let [x, y, z] = forces[..] else { return None };
    let length = [x, y, z].iter().map(|(mean, unit)| (mean * unit.si).powi(2)).sum::<f64>().sqrt();
    let ratio = length / STANDARD_GRAVITY_M_S2;
    let near = |factor: f64| (ratio / factor - 1.0).abs() < 0.1;
    let wrong = [1e3, 1e-3, STANDARD_GRAVITY_M_S2, 1.0 / STANDARD_GRAVITY_M_S2, 1e6, 1e-6];
    wrong.into_iter().any(near).then(|| {
        format!(
            "the three channels of acceleration read {} {unit} together, {} times gravity: is `{unit}` right?",
            short(length / z.1.si),
            short(ratio),
            unit = z.1.name
        )
    })
}

/// Leaps from rest to rest that no knock makes: a sensor that was picked up and turned once leaps less often.
const TURNTABLE: usize = 3;

/// Refuses a gyro that is turned at steady rates, as on a turntable.
///
/// # Errors
/// One whose rate leaps from rest to rest, by more than any bias does.
pub(super) fn turns(name: &str, readings: &[f64], rate_hz: f64, unit: &Unit) -> Result<()> {
    if unit.quantity != Quantity::Gyro {
        return Ok(());
    }
    let found = leaps(readings, rate_hz, unit.si);
    if found.count < TURNTABLE {
        return Ok(());
    }
    Err(Error::new(
        "could not diagnose the recording as one at rest",
        format!(
            "`{name}` is turned at steady rates: from one quiet stretch to the next it leaps {} times, by up to {} {}",
            found.count,
            short(found.largest),
            unit.symbol().unwrap_or(unit.name.clone())
        ),
        "on a turntable, hold it against the table's rate: --input TABLE_RATE --output READING, without a model; or cut out \
         a rest: --from-s, --to-s",
    ))
}

/// The white level against the promise.
pub(super) fn level(channel: &Channel, fitted: &Fitted, noise: Option<&Noise>) -> Option<String> {
    let promised = noise?.density;
    let found = describe::density_of_white(channel, fitted.white().0);
    let ratio = found / promised;
    (promised > 0.0 && found > 0.0 && !(1.0 / FAR..FAR).contains(&ratio)).then(|| {
        format!(
            "`{}`: its white noise is {} times what [noise] promises: no sensor deviates that much, so check the \
            units of the column and of the datasheet",
            channel.name,
            short(ratio)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_of_the_wrong_length_is_asked_about_and_the_right_one_is_not() {
        let of = |means: &[f64], words: &str| {
            let unit = Unit::of_file(words).unwrap_or_else(Unit::unknown);
            gravity(&means.iter().map(|mean| (*mean, unit.clone())).collect::<Vec<_>>())
        };
        assert!(of(&[0.1, 0.2, 9.79], "g").is_some_and(|f| f.contains("9.79")));
        assert!(of(&[600.0, 0.0, 800.0], "g").is_some());
        assert!(of(&[0.6, 0.0, 0.8], "g").is_none());
        assert!(of(&[6.0, 0.0, 7.7], "m/s2").is_none());
        assert!(of(&[600.0, 800.0], "g").is_none(), "two axes need not see all of it");
        assert!(of(&[0.001, 0.002, 0.003], "g").is_none(), "a log less its mean");
        assert!(of(&[600.0, 0.0, 800.0], "counts").is_none());
        // Next to a gyro, whose rates are no part of it.
        let [rate, force] = ["rad/s", "m/s2"].map(|words| Unit::of_file(words).expect("a unit"));
        let imu = |z: f64| [(0.3, rate.clone()), (0.1, force.clone()), (0.2, force.clone()), (z, force.clone())];
        assert!(gravity(&imu(0.99)).is_some() && gravity(&imu(9.8)).is_none());
    }
}
