//! Columns of what was given to a sensor, as by a turntable or a shaker, and is no reading of it.

/// Words of a heading that name what a machine was told to do, or measured of it: no reading of the
/// sensor on it.
const GIVEN: [&str; 12] = [
    "table",
    "turntable",
    "stage",
    "shaker",
    "encoder",
    "commanded",
    "command",
    "cmd",
    "setpoint",
    "reference",
    "ref",
    "true",
];

/// Tells a motion that a turntable, a shaker or a reference sensor gave from a sensor's reading.
pub(super) fn is_given(name: &str) -> bool {
    let lower = name.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| GIVEN.contains(&word))
}
