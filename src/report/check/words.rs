//! Names and units of parameters.

use proofmass_base::units::{DEGREE, STANDARD_GRAVITY_M_S2};
use proofmass_diagnosis::repeatability::parameter::{AtRest, Element, Parameter, Role};
use proofmass_numerics::numerics::allan::law::Term;
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

/// Name of the parameters of a role, or of a noise.
pub(super) fn kind(parameter: &Parameter) -> String {
    match parameter {
        Parameter::Element(Element { sensor, role, .. }) => format!("{} {}", sensor.name(), self::role(*role)),
        Parameter::AtRest(AtRest { term: None, .. }) => "mean".to_owned(),
        Parameter::AtRest(AtRest { term: Some(term), .. }) => noise(*term),
        Parameter::Named(named) => named.name.clone(),
    }
}

/// "white noise N".
pub(super) fn noise(term: Term) -> String {
    let name = match term {
        Term::Quantisation => "quantisation",
        Term::White => "white noise",
        Term::Flicker => "flicker",
        Term::Walk => "random walk",
        Term::Ramp => "ramp",
    };
    format!("{name} {}", term.symbol())
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Bias => "bias",
        Role::Scale => "scale",
        Role::Misalignment => "misalignment",
        Role::GSensitivity => "g-sensitivity",
    }
}

/// Its axis, or axes, or channel: "z", "yz", "gx".
pub(super) fn place(parameter: &Parameter) -> String {
    match parameter {
        Parameter::Element(element) => format!("{}{}", axis(element.axis), element.of.map_or("", axis)),
        Parameter::AtRest(at) => at.channel.clone(),
        Parameter::Named(_) => String::new(),
    }
}

/// "gyro scale z", "gx white noise N".
pub(super) fn name(parameter: &Parameter) -> String {
    match parameter {
        Parameter::Element(_) => format!("{} {}", kind(parameter), place(parameter)),
        Parameter::AtRest(_) => format!("{} {}", place(parameter), kind(parameter)),
        Parameter::Named(_) => kind(parameter),
    }
}

/// The unit it is stated in, and the factor from what it is held in.
pub(super) fn unit(parameter: &Parameter) -> (&str, f64) {
    match parameter {
        Parameter::Element(element) => unit_of_element(element),
        Parameter::AtRest(AtRest { unit, term: None, .. }) => unit.signal(),
        Parameter::AtRest(AtRest { unit, term: Some(term), .. }) => unit.coefficient(*term),
        Parameter::Named(named) => (&named.unit, named.factor),
    }
}

fn unit_of_element(element: &Element) -> (&'static str, f64) {
    let is_gyro = element.sensor == Sense::Gyro;
    match (element.role, element.is_si) {
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
