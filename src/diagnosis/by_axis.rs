//! Numbers of three axes as a study of six axes writes them.

use crate::numerics::moments::mean_sd;
use crate::units::key::Key;

/// A number as a study draws it, SI: one that was fitted with its standard error, or the mean of
/// several elements with their spread.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drawn {
    /// The value.
    pub mean: f64,
    /// Its standard error, or the spread of the elements.
    pub sd: f64,
}

/// Mean and spread of elements that a study draws apart.
pub(super) fn over(elements: &[f64]) -> Drawn {
    let (mean, sd) = mean_sd(elements);
    Drawn { mean, sd }
}

/// An SI number in the unit of its key.
pub(super) fn number(key: &Key, value: f64) -> String {
    format!("{:?}", value / key.factor)
}

/// A draw in the unit of its key; a number where nothing is drawn.
pub(super) fn drawn(key: &Key, Drawn { mean, sd }: Drawn) -> String {
    match sd == 0.0 {
        true => number(key, mean),
        false => format!("{{ mean = {}, sd = {} }}", number(key, mean), number(key, sd)),
    }
}

/// A line of a section.
pub(super) fn line(key: &Key, value: &str) -> String {
    format!("{} = {value}\n", key.key())
}

/// A number for each axis; nothing where all are zero.
pub(super) fn three(key: &Key, axes: [Drawn; 3]) -> String {
    if axes.iter().all(|axis| *axis == Drawn::default()) {
        return String::new();
    }
    line(key, &format!("[\n    {},\n]", axes.map(|axis| drawn(key, axis)).join(",\n    ")))
}
