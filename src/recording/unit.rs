//! What one unit of a column is, and the datasheet's unit of each noise coefficient that follows from it.

use crate::error::{Error, Result};
use crate::numerics::allan::law::Term;
use crate::units::{
    DEGREE, DEGREE_PER_HOUR, DEGREE_PER_HOUR_PER_ROOT_HOUR, DEGREE_PER_ROOT_HOUR, MICRO_G, MILLI_G,
    STANDARD_GRAVITY_M_S2,
};

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Specific force.
    Accelerometer,
    /// Angular rate.
    Gyro,
    /// Not said.
    Unknown,
}

/// A column's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub quantity: Quantity,
    /// m/s² or rad/s per unit of the file; 1 where unknown.
    pub si: f64,
    /// As the user wrote it, or "unit".
    pub name: String,
}

const SCALES: [(&str, Quantity, f64); 10] = [
    ("g", Quantity::Accelerometer, STANDARD_GRAVITY_M_S2),
    ("mg", Quantity::Accelerometer, MILLI_G),
    ("ug", Quantity::Accelerometer, MICRO_G),
    ("m/s2", Quantity::Accelerometer, 1.0),
    ("mm/s2", Quantity::Accelerometer, 1e-3),
    ("rad/s", Quantity::Gyro, 1.0),
    ("mrad/s", Quantity::Gyro, 1e-3),
    ("deg/s", Quantity::Gyro, DEGREE),
    ("mdeg/s", Quantity::Gyro, 1e-3 * DEGREE),
    ("deg/h", Quantity::Gyro, DEGREE_PER_HOUR),
];

impl Unit {
    /// A column of which nothing is said.
    pub fn unknown() -> Self {
        Self { quantity: Quantity::Unknown, si: 1.0, name: "unit".into() }
    }

    /// A scale as a person writes it: "3.33mg", "g", "0.05deg/s".
    ///
    /// # Errors
    /// Anything but an optional positive number and a known unit of this quantity.
    pub fn parse(text: &str, quantity: Quantity) -> Result<Self> {
        let known: Vec<&str> = SCALES.iter().filter(|s| s.1 == quantity).map(|s| s.0).collect();
        let fail = |cause: String| {
            let hint = format!("write an optional number and one of {}, e.g. 3.33{}", known.join(", "), known[1]);
            Error::new(format!("could not read the scale `{text}`"), cause, hint)
        };
        let plain = text.trim().replace('µ', "u").replace('°', "deg").replace('²', "2").replace('^', "");
        let split = plain.find(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E').unwrap_or(plain.len());
        let (number, word) = (plain[..split].trim(), plain[split..].trim());
        let factor = match number {
            "" => 1.0,
            _ => number.parse::<f64>().map_err(|_| fail(format!("`{number}` is no number")))?,
        };
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(fail(format!("a scale of {factor}")));
        }
        match SCALES.iter().find(|s| s.1 == quantity && s.0 == word) {
            // What follows multiplies it again: with numbers that large or small, a coefficient would be infinite or 0.
            Some((_, _, si)) if !(1e-100..1e100).contains(&(factor * si)) => {
                Err(fail(format!("a scale of {factor:e}")))
            }
            Some((_, _, si)) => Ok(Self { quantity, si: factor * si, name: text.trim().into() }),
            None => Err(fail(format!("`{word}` is no unit known here"))),
        }
    }

    /// Unit of the signal for people, and how many of it one unit of the file is.
    pub fn signal(&self) -> (&'static str, f64) {
        match self.quantity {
            Quantity::Accelerometer => ("m/s²", self.si),
            Quantity::Gyro => ("°/s", self.si / DEGREE),
            Quantity::Unknown => ("unit", 1.0),
        }
    }

    /// Datasheet unit of a coefficient, and how many of it one of the file's is.
    pub fn coefficient(&self, term: Term) -> (&'static str, f64) {
        let (name, si) = match (self.quantity, term) {
            (Quantity::Accelerometer, Term::Quantisation) => ("m/s", 1.0),
            (Quantity::Accelerometer, Term::White) => ("m/s/√h", 1.0 / 60.0),
            (Quantity::Accelerometer, Term::Flicker) => ("mg", MILLI_G),
            (Quantity::Accelerometer, Term::Walk) => ("µg/√s", MICRO_G),
            (Quantity::Accelerometer, Term::Ramp) => ("mg/h", MILLI_G / 3600.0),
            (Quantity::Gyro, Term::Quantisation) => ("″", DEGREE / 3600.0),
            (Quantity::Gyro, Term::White) => ("°/√h", DEGREE_PER_ROOT_HOUR),
            (Quantity::Gyro, Term::Flicker) => ("°/h", DEGREE_PER_HOUR),
            (Quantity::Gyro, Term::Walk) => ("°/h/√h", DEGREE_PER_HOUR_PER_ROOT_HOUR),
            (Quantity::Gyro, Term::Ramp) => ("°/h/h", DEGREE_PER_HOUR / 3600.0),
            (Quantity::Unknown, Term::Quantisation) => ("unit·s", 1.0),
            (Quantity::Unknown, Term::White) => ("unit·√s", 1.0),
            (Quantity::Unknown, Term::Flicker) => ("unit", 1.0),
            (Quantity::Unknown, Term::Walk) => ("unit/√s", 1.0),
            (Quantity::Unknown, Term::Ramp) => ("unit/s", 1.0),
        };
        (name, self.si / si)
    }

    /// Datasheet unit of a one-sided noise density, and how many of it one of the file's is.
    pub fn density(&self) -> (&'static str, f64) {
        match self.quantity {
            Quantity::Accelerometer => ("µg/√Hz", self.si / MICRO_G),
            Quantity::Gyro => ("°/s/√Hz", self.si / DEGREE),
            Quantity::Unknown => ("unit/√Hz", 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_read_as_people_write_them() {
        let parse = |text| Unit::parse(text, Quantity::Accelerometer).map(|u| u.si);
        assert_eq!(parse("g"), Ok(STANDARD_GRAVITY_M_S2));
        assert_eq!(parse("3.33 mg"), Ok(3.33 * MILLI_G));
        assert_eq!(parse("2e-3m/s²"), Ok(2e-3));
        assert!(Unit::parse("0.05°/s", Quantity::Gyro).is_ok_and(|u| u.signal().1 == 0.05));
        for wrong in ["", "3.33", "deg/s", "-1g", "1e999g", "x.5g"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
