//! The one rule by which a column gets its unit: the unit that the file states holds unless a scale
//! is given, and the two must not contradict each other. Where neither says anything, the usual unit
//! is taken and the size of the readings is checked.

use super::finding::{Finding, Size};
use super::roles::{self, Stated};
use super::unit::{self, Quantity, Unit};
use crate::error::Error;
use crate::units::{DEGREE, MILLI_G, STANDARD_GRAVITY_M_S2};

/// Two scales are one where they differ by no more than gravity does between the equator and the
/// poles (9.780 to 9.832 m/s²): 9.81 m/s² and g are no contradiction.
const SAME: f64 = 5.4e-3;

/// Gravity's length may be off by this share: the bias and the scale error of a low-cost sensor.
const NEAR: f64 = 0.1;

/// Angle random walk that no gyro at rest exceeds, rad/√s: twice that of the noisiest one in the
/// catalogues, 0.05 °/s/√Hz (ADXRS150, Analog Devices, data sheet rev. B), over √2.
const NOISIEST_RAD_RTS: f64 = 0.1 * DEGREE / std::f64::consts::SQRT_2;

/// A scale that a person gives, and where: an option or a key.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// One unit of the column.
    pub unit: &'a Unit,
    /// The option or key, as it is written.
    pub option: &'a str,
}

/// A column that is known to measure a quantity.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// Heading of the column.
    pub name: &'a str,
    /// Unit in a row of units, in brackets or by the format.
    pub stated: Option<&'a str>,
    /// Quantity that it measures.
    pub quantity: Quantity,
    /// The option or key that states a scale.
    pub option: &'a str,
}

impl Named<'_> {
    /// The unit of this column; `None` where neither the file nor a scale states one.
    ///
    /// # Errors
    /// A scale that contradicts the file, a file that states another quantity, or counts without a
    /// scale.
    pub fn unit(&self, given: Option<&Unit>) -> Result<Option<Unit>, Error> {
        let Self { name, quantity, option, .. } = *self;
        let words = || roles::unit_words(name, self.stated).unwrap_or_default();
        let stated = roles::stated(name, self.stated);
        let refuse =
            |cause: String, hint: String| Err(Error::new(format!("could not use the column `{name}`"), cause, hint));
        match (stated, given) {
            (None, given) => Ok(given.cloned()),
            (Some(Stated::Counts | Stated::Other(_)), Some(given)) => Ok(Some(given.clone())),
            (Some(Stated::Inertial(unit)), Some(given))
                if unit.quantity == given.quantity && (given.si / unit.si - 1.0).abs() <= SAME =>
            {
                Ok(Some(given.clone()))
            }
            (Some(Stated::Inertial(unit)), None) if unit.quantity == quantity => Ok(Some(unit)),
            (Some(Stated::Inertial(_)), Some(given)) => refuse(
                format!("the file states {} for it, and {option} says {}", words(), given.name),
                format!("leave {option} out and the file's unit is used, or correct the heading"),
            ),
            (Some(Stated::Inertial(unit)), None) => refuse(
                format!(
                    "the file states {} for it, {}, and it is named as {}",
                    words(),
                    unit.quantity.name(),
                    quantity.name()
                ),
                "exchange the columns, or correct the heading".to_owned(),
            ),
            (Some(Stated::Counts), None) => refuse(
                "the file states counts for it, and no scale is given".to_owned(),
                format!("give what one count is, as the datasheet states it: {option}"),
            ),
            (Some(Stated::Other(text)), None) => refuse(
                format!("the file states `{text}` for it, which is no known unit of {}", quantity.name()),
                format!("give what one of its units is: {option}"),
            ),
        }
    }

    /// Refuses a scale, or a quantity, that contradicts the file; columns in counts or of no stated
    /// unit pass.
    ///
    /// # Errors
    /// As [`Named::unit`], but for counts and other units without a scale.
    pub fn check(&self, given: Option<&Unit>) -> Result<(), Error> {
        match roles::stated(self.name, self.stated) {
            Some(Stated::Inertial(_)) => self.unit(given).map(drop),
            _ => Ok(()),
        }
    }

    /// Refuses a unit in words that contradicts the file: another quantity or size, or counts where
    /// the file states a unit. A scale of counts or volts is no contradiction.
    ///
    /// # Errors
    /// Such a contradiction, with both.
    pub fn check_words(&self, words: &str) -> Result<(), Error> {
        let Some(own) = roles::unit_words(self.name, self.stated) else { return Ok(()) };
        let given = Unit::of_file(words);
        let differs = match (Unit::of_file(&own), &given) {
            (Some(own), Some(given)) => own.quantity != given.quantity || (given.si / own.si - 1.0).abs() > SAME,
            (None, Some(_)) => false,
            (_, None) => unit::is_known(words) && unit::is_known(&own) && !unit::is_same(&own, words),
        };
        if !differs {
            return Ok(());
        }
        Err(Error::new(
            format!("could not use the column `{}`", self.name),
            format!("the file states {own} for it, and {} says {words}", self.option),
            format!("leave {} out and the file's unit is used, or correct the heading", self.option),
        ))
    }
}

/// Specific force at rest is below this in every unit but counts and mg, m/s².
const MOST_M_S2: f64 = 25.0;

/// The unit of counts of an accelerometer, by how many of them gravity is long, with what is to be reported.
pub fn counted(columns: Vec<String>, per_g: f64) -> (Unit, Finding) {
    let (quantity, si) = (Quantity::Accelerometer, STANDARD_GRAVITY_M_S2 / per_g);
    (Unit { quantity, si, name: "count".to_owned() }, Finding::CountsScaled { columns, per_g })
}

/// The unit taken for columns that measure a quantity and state none, with what is to be reported.
pub fn assumed(columns: Vec<String>, quantity: Quantity, option: &'static str, size: &Measured) -> (Unit, Finding) {
    let is_counted =
        |length: f64| matches!(of_force(Some(length)), ("m/s2", Size::NotGravity { .. }) if length > MOST_M_S2);
    if let Some(length) = size.length.filter(|l| quantity == Quantity::Accelerometer && is_counted(*l)) {
        return counted(columns, length);
    }
    let (word, size) = match quantity {
        Quantity::Gyro => ("rad/s", of_rate(size.walk)),
        _ => of_force(size.length),
    };
    let unit = Unit { quantity, ..Unit::parse(word, quantity).unwrap_or_else(|_| Unit::unknown()) };
    (unit, Finding::UnitAssumed { columns, unit: word, option, size })
}

/// The size of readings whose unit is not stated, in their own unit.
#[derive(Debug, Clone, Copy, Default)]
pub struct Measured {
    /// Length of the mean of three axes.
    pub length: Option<f64>,
    /// White noise at rest: the Allan deviation at 1 s, unit·√s.
    pub walk: Option<f64>,
}

/// Of specific force at rest: the unit in which the length of its mean is gravity's.
fn of_force(length: Option<f64>) -> (&'static str, Size) {
    let Some(length) = length else { return ("m/s2", Size::Unknown) };
    let units = [("m/s2", 1.0), ("g", STANDARD_GRAVITY_M_S2), ("mg", MILLI_G)];
    match units.into_iter().find(|(_, si)| (length * si / STANDARD_GRAVITY_M_S2 - 1.0).abs() <= NEAR) {
        Some((word, _)) => (word, Size::Gravity { length }),
        None => ("m/s2", Size::NotGravity { length }),
    }
}

/// Of a rate at rest: radians that would be noisier than any gyro are questionable.
fn of_rate(walk: Option<f64>) -> Size {
    match walk {
        Some(walk) if walk > NOISIEST_RAD_RTS => Size::Noisy { ratio: walk / NOISIEST_RAD_RTS },
        Some(_) => Size::Plausible,
        None => Size::Unknown,
    }
}

/// The length of three means.
pub fn length(means: [f64; 3]) -> f64 {
    means.iter().map(|m| m * m).sum::<f64>().sqrt()
}
