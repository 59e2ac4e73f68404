//! Signs of a wrong unit in a still recording: gravity of the wrong length, noise far from what was
//! promised.
//!
//! Only findings: a sensor may be odd, and a person decides. Not for channels whose unit is
//! unknown.

use super::channel::{Channel, Fitted};
use super::describe;
use crate::model::Noise;
use crate::number::short;
use crate::recording::unit::{Quantity, Unit};
use crate::units::STANDARD_GRAVITY_M_S2;

/// White noise this many times the promised one, or less by as much, is no spread of manufacture.
const FAR: f64 = 20.0;

/// Three accelerometer channels at rest read 1 g together; by a factor that units differ in they do
/// not.
pub(super) fn gravity(means: &[f64], unit: &str) -> Option<String> {
    let [x, y, z] = means else { return None };
    let unit = Unit::parse(unit, Quantity::Accelerometer).ok()?;
    let length = (x * x + y * y + z * z).sqrt();
    let ratio = length * unit.si / STANDARD_GRAVITY_M_S2;
    let near = |factor: f64| (ratio / factor - 1.0).abs() < 0.1;
    let wrong = [1e3, 1e-3, STANDARD_GRAVITY_M_S2, 1.0 / STANDARD_GRAVITY_M_S2, 1e6, 1e-6];
    wrong.into_iter().any(near).then(|| {
        format!(
            "the three channels read {} {} together, {} times gravity: is `unit = \"{}\"` right?",
            short(length),
            unit.name,
            short(ratio),
            unit.name
        )
    })
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
        assert!(gravity(&[0.1, 0.2, 9.79], "g").is_some_and(|f| f.contains("9.79")));
        assert!(gravity(&[600.0, 0.0, 800.0], "g").is_some());
        assert!(gravity(&[0.6, 0.0, 0.8], "g").is_none());
        assert!(gravity(&[6.0, 0.0, 7.7], "m/s2").is_none());
        assert!(gravity(&[600.0, 800.0], "g").is_none(), "two axes need not see all of it");
        assert!(gravity(&[0.001, 0.002, 0.003], "g").is_none(), "a log less its mean");
        assert!(gravity(&[600.0, 0.0, 800.0], "counts").is_none());
    }
}
