//! States what one unit of a column is, and the datasheet's unit of each noise coefficient that
//! follows from it.

use crate::error::{Error, Result};
use crate::numerics::allan::law::Term;
use crate::units::{
    DEGREE, DEGREE_PER_HOUR, DEGREE_PER_HOUR_PER_ROOT_HOUR, DEGREE_PER_ROOT_HOUR, MICRO_G, MILLI_G,
    STANDARD_GRAVITY_M_S2,
};

/// The quantity that a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Specific force.
    Accelerometer,
    /// Angular rate.
    Gyro,
    /// Quantity not stated.
    Unknown,
}

impl Quantity {
    /// Name of the quantity for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accelerometer => "specific force",
            Self::Gyro => "angular rate",
            Self::Unknown => "an unknown quantity",
        }
    }
}

/// Unit of a column: its factor to SI and the name that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Quantity that the column measures.
    pub quantity: Quantity,
    /// m/s² or rad/s per unit of the file; 1 where unknown.
    pub si: f64,
    /// The unit as the user wrote it, or "unit".
    pub name: String,
}

const SCALES: [(&str, Quantity, f64); 12] = [
    ("g", Quantity::Accelerometer, STANDARD_GRAVITY_M_S2),
    ("mg", Quantity::Accelerometer, MILLI_G),
    ("ug", Quantity::Accelerometer, MICRO_G),
    ("m/s2", Quantity::Accelerometer, 1.0),
    ("cm/s2", Quantity::Accelerometer, 1e-2),
    ("mm/s2", Quantity::Accelerometer, 1e-3),
    ("rad/s", Quantity::Gyro, 1.0),
    ("mrad/s", Quantity::Gyro, 1e-3),
    ("deg/s", Quantity::Gyro, DEGREE),
    ("mdeg/s", Quantity::Gyro, 1e-3 * DEGREE),
    ("deg/min", Quantity::Gyro, DEGREE / 60.0),
    ("deg/h", Quantity::Gyro, DEGREE_PER_HOUR),
];

/// Names of what a converter counts in.
const COUNTS: [&str; 8] = ["lsb", "count", "counts", "cnt", "cnts", "digit", "digits", "raw"];

/// Other units that stand below headings or at their end.
const OTHERS: [&str; 49] = [
    "s", "ms", "us", "ns", "sec", "seconds", "m", "cm", "mm", "um", "nm", "pm", "km", "m/s", "mm/s", "km/h", "deg",
    "rad", "mrad", "c", "degc", "k", "ut", "mt", "t", "gauss", "mgauss", "pa", "hpa", "kpa", "mbar", "bar", "v", "mv",
    "uv", "a", "ma", "ua", "pf", "ff", "hz", "khz", "n", "mn", "un", "kn", "%", "1", "-",
];

/// Returns what stands in brackets, if anything does.
pub(super) fn without_brackets(text: &str) -> &str {
    let text = text.trim();
    let within = |open, close| text.strip_prefix(open)?.strip_suffix(close);
    within('[', ']').or_else(|| within('(', ')')).unwrap_or(text).trim()
}

/// Returns whether these cells are a row of units: none is a number, and one at least is a unit or
/// stands in brackets.
pub(super) fn are_units(cells: &[String]) -> bool {
    let is_unit = |cell: &String| {
        let word = normal(without_brackets(cell));
        without_brackets(cell).len() < cell.len()
            || (COUNTS.contains(&word.as_str()) && word != "raw")
            || OTHERS.contains(&word.as_str())
            || SCALES.iter().any(|s| s.0 == word)
    };
    let filled = || cells.iter().filter(|c| !c.is_empty());
    filled().count() > 0
        && filled().all(|c| is_unit(c) && (c == "1" || c.parse::<f64>().is_err()))
        && filled().any(|c| c != "1")
}

/// Text that says that a column holds counts of a converter.
pub(super) fn is_count(text: &str) -> bool {
    COUNTS.contains(&normal(without_brackets(text)).as_str())
}

/// Text that is a unit of some other quantity, or none: `V`, `degC`, `%`.
pub(super) fn is_other(text: &str) -> bool {
    OTHERS.contains(&normal(without_brackets(text)).as_str())
}

/// Text that is a unit of any quantity.
pub(super) fn is_known(text: &str) -> bool {
    is_count(text) || is_other(text) || Unit::of_file(text).is_some()
}

/// One unit written in two ways; all names of counts are one.
pub(super) fn is_same(one: &str, other: &str) -> bool {
    (is_count(one) && is_count(other)) || normal(without_brackets(one)) == normal(without_brackets(other))
}

/// A unit as it is written in `SCALES`, however people write it: `rad s^-1`, `m/s/s`, `deg/sec`,
/// `dps`.
fn normal(text: &str) -> String {
    let mut plain = text.trim().to_lowercase().replace("g's", "g");
    for (theirs, ours) in [
        ("µ", "u"),
        ("μ", "u"),
        ("°", "deg"),
        ("º", "deg"),
        ("²", "2"),
        ("^", ""),
        ("**", ""),
        ("⁻", "-"),
        ("¹", "1"),
        ("·", " "),
        ("⋅", " "),
        (".s", " s"),
    ] {
        plain = plain.replace(theirs, ours);
    }
    let mut unit = String::new();
    for word in plain.replace(" per ", "/").replace(" / ", "/").split_whitespace() {
        match word.strip_suffix("-1").map(|w| (w, "")).or_else(|| word.strip_suffix("-2").map(|w| (w, "2"))) {
            Some((below, power)) => unit += &format!("/{below}{power}"),
            None => unit += word,
        }
    }
    for (theirs, ours) in [
        ("degrees", "deg"),
        ("degree", "deg"),
        ("radians", "rad"),
        ("radian", "rad"),
        ("seconds", "s"),
        ("second", "s"),
        ("sec", "s"),
        ("ssquared", "s2"),
        ("minute", "min"),
        ("hours", "h"),
        ("hour", "h"),
        ("/hr", "/h"),
        ("meters", "m"),
        ("meter", "m"),
        ("metres", "m"),
        ("metre", "m"),
        ("/s/s", "/s2"),
        ("milli-g", "mg"),
        ("micro-g", "ug"),
    ] {
        unit = unit.replace(theirs, ours);
    }
    match unit.as_str() {
        "dps" => "deg/s".into(),
        "mdps" => "mdeg/s".into(),
        "dph" | "degh" | "degph" => "deg/h".into(),
        "degps" => "deg/s".into(),
        "gn" | "g0" | "g_0" | "gs" => "g".into(),
        "mps2" | "ms2" | "mss" => "m/s2".into(),
        "gal" => "cm/s2".into(),
        "rads" | "rps" => "rad/s".into(),
        _ => match unit.split_once('/') {
            Some(("dps", below)) => format!("deg/s/{below}"),
            Some((above, "dps")) => format!("{above}/deg/s"),
            _ => unit,
        },
    }
}

/// A scale per count, or counts per unit, as datasheets state sensitivities: `3.33 mg/LSB`,
/// `16384 LSB/g`.
fn per_count(factor: f64, unit: &str) -> (f64, String) {
    if let Some((above, below)) = unit.rsplit_once('/')
        && COUNTS.contains(&below)
    {
        return (factor, above.to_owned());
    }
    match unit.split_once('/') {
        Some((count, below)) if COUNTS.contains(&count) => (1.0 / factor, below.to_owned()),
        _ => (factor, unit.to_owned()),
    }
}

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
        let plain = text.trim().replace('µ', "u").replace('°', "deg");
        let split = plain.find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E').unwrap_or(plain.len());
        let (number, word) = (plain[..split].trim(), plain[split..].trim());
        let factor = match number {
            "" => 1.0,
            _ => number.parse::<f64>().map_err(|_| fail(format!("`{number}` is not a number")))?,
        };
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(fail(format!("a scale of {factor}")));
        }
        let (factor, unit) = per_count(factor, &normal(word));
        if COUNTS.contains(&unit.as_str()) {
            return Err(fail(format!("`{word}` is a count: the sensor's datasheet states its size")));
        }
        match SCALES.iter().find(|s| s.1 == quantity && s.0 == unit) {
            // What follows multiplies it again: with numbers that large or small, a coefficient
            // would be infinite or 0.
            Some((_, _, si)) if !(1e-100..1e100).contains(&(factor * si)) => {
                Err(fail(format!("a scale of {factor:e}")))
            }
            Some((_, _, si)) => Ok(Self { quantity, si: factor * si, name: text.trim().into() }),
            None => Err(fail(format!("`{word}` is not a known unit"))),
        }
    }

    /// A unit as a file states it, if it is one of an inertial sensor.
    pub fn of_file(text: &str) -> Option<Self> {
        [Quantity::Accelerometer, Quantity::Gyro].into_iter().find_map(|q| Self::parse(without_brackets(text), q).ok())
    }

    /// A unit as it is written at the end of a heading, where nothing but `_` stands between its
    /// parts: `m_s2`, `deg_per_s`, `dps`.
    pub(super) fn of_heading(text: &str) -> Option<Self> {
        if !text.starts_with(|c: char| c.is_alphabetic() || c == '°') {
            return None;
        }
        let divided = text.replace("_per_", "/").replacen('_', "/", 1).replace('_', "");
        [Quantity::Accelerometer, Quantity::Gyro].into_iter().find_map(|q| Self::parse(&divided, q).ok())
    }

    /// Name of the unit itself for people, where it is one without a factor of its own: `m/s²`,
    /// `°/s`, `g`.
    pub fn symbol(&self) -> Option<String> {
        let (word, ..) = SCALES.iter().find(|s| s.1 == self.quantity && (s.2 / self.si - 1.0).abs() < 1e-12)?;
        Some(word.replace("deg", "°").replace("s2", "s²").replace("ug", "µg"))
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
        for wrong in ["", "3.33", "deg/s", "-1g", "1e999g", "x.5g", "LSB"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn units_are_known_in_every_spelling() {
        for (text, quantity, si) in [
            ("rad s^-1", Quantity::Gyro, 1.0),
            ("rad/sec", Quantity::Gyro, 1.0),
            ("dps", Quantity::Gyro, DEGREE),
            ("deg/sec", Quantity::Gyro, DEGREE),
            ("[°/s]", Quantity::Gyro, DEGREE),
            ("deg/hr", Quantity::Gyro, DEGREE_PER_HOUR),
            ("m s^-2", Quantity::Accelerometer, 1.0),
            ("m s⁻²", Quantity::Accelerometer, 1.0),
            ("m/s/s", Quantity::Accelerometer, 1.0),
            ("(m/s^2)", Quantity::Accelerometer, 1.0),
            ("m/sec2", Quantity::Accelerometer, 1.0),
            ("G", Quantity::Accelerometer, STANDARD_GRAVITY_M_S2),
            ("16384 LSB/g", Quantity::Accelerometer, STANDARD_GRAVITY_M_S2 / 16384.0),
            ("3.33 mg/LSB", Quantity::Accelerometer, 3.33 * MILLI_G),
            ("131 LSB/dps", Quantity::Gyro, DEGREE / 131.0),
        ] {
            let unit = Unit::of_file(text).unwrap_or_else(|| unreachable!("{text} is not known"));
            assert!(unit.quantity == quantity && (unit.si / si - 1.0).abs() < 1e-12, "{text}: {unit:?}");
        }
        assert!(["LSB", "kg", "", "m", "rad"].iter().all(|t| Unit::of_file(t).is_none()));
    }

    #[test]
    fn a_row_of_units_is_none_of_numbers_or_names() {
        let row = |cells: &[&str]| are_units(&cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>());
        assert!(row(&["[s]", "[rad/s]"]) && row(&["s", "LSB"]) && row(&["", "g"]) && row(&["ns", "m s^-2"]));
        assert!(!row(&["1", "2"]) && !row(&["", ""]) && !row(&["ok", "g"]) && !row(&["1", "1"]));
    }
}
