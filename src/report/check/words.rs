//! Names and units of a calibration's parameters.

use proofmass_base::units::{DEGREE, STANDARD_GRAVITY_M_S2};
use proofmass_diagnosis::repeatability::parameter::{Parameter, Role};
use proofmass_scenario::sensor::Sense;

const AXES: [&str; 3] = ["x", "y", "z"];

/// "x", "y" or "z".
pub(super) fn axis(axis: usize) -> &'static str {
    AXES.get(axis).copied().unwrap_or("?")
}

/// "x", "x and y", "x, y and z".
pub(super) fn list(items: &[String]) -> String {
    match items {
        [] => "none".to_owned(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Name of the parameters of a role.
pub(super) fn role(role: Role) -> &'static str {
    match role {
        Role::Bias => "bias",
        Role::Scale => "scale",
        Role::Misalignment => "misalignment",
        Role::GSensitivity => "g-sensitivity",
    }
}

/// Its axis, or axes: "z", "yz".
pub(super) fn place(parameter: &Parameter) -> String {
    format!("{}{}", axis(parameter.axis), parameter.of.map_or("", axis))
}

/// "gyro scale z".
pub(super) fn name(parameter: &Parameter) -> String {
    format!("{} {} {}", parameter.sensor.name(), role(parameter.role), place(parameter))
}

/// The unit it is stated in, and the factor from what it is held in.
pub(super) fn unit(parameter: &Parameter) -> (&'static str, f64) {
    let is_gyro = parameter.sensor == Sense::Gyro;
    match (parameter.role, parameter.is_si) {
        (Role::Bias, true) if is_gyro => ("°/s", 1.0 / DEGREE),
        (Role::Bias, true) => ("m/s²", 1.0),
        (Role::Bias, false) => ("unit of the file", 1.0),
        (Role::Scale, true) => ("1", 1.0),
        (Role::Scale, false) if is_gyro => ("unit of the file per rad/s", 1.0),
        (Role::Scale, false) => ("unit of the file per m/s²", 1.0),
        (Role::Misalignment, _) => ("mrad", 1e3),
        (Role::GSensitivity, _) => ("°/s/g", STANDARD_GRAVITY_M_S2 / DEGREE),
    }
}

/// The same of a difference, which a scale has as a share of itself.
pub(super) fn unit_of_difference(parameter: &Parameter, value: f64) -> (&'static str, f64) {
    match parameter.role {
        Role::Scale if value != 0.0 => ("%", 100.0 / value.abs()),
        _ => unit(parameter),
    }
}
