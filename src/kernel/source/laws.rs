//! The laws of `physics` that a study uses, as WGSL: their own functions, where their coefficients
//! stand, and the sum of them.
//!
//! A law that no member follows is not in the text. States of a law's own: `staged`.

use crate::member::Column;
use crate::physics::coefficients::StudyLaw;

/// Name of a law's function.
pub(crate) fn function(law: &StudyLaw) -> String {
    law.term.id().replace('-', "_")
}

/// The names of a law's coefficients in `Laws`.
pub(super) fn coefficients(law: &StudyLaw) -> Vec<String> {
    (0..law.given().len()).map(|parameter| format!("{}_{parameter}", function(law))).collect()
}

/// Numbers of a member's laws, in the order of their columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number<'a> {
    /// A coefficient, by its place.
    Coefficient(usize),
    /// First state of a law at rest under a unit of force.
    AtRest(&'a StudyLaw),
}

impl Number<'_> {
    /// Returns its value for one member.
    pub fn of(self, column: &Column) -> f64 {
        match self {
            Self::Coefficient(place) => column.laws[place],
            Self::AtRest(law) => law.at_rest(&column.laws[law.places()]),
        }
    }
}

/// The columns of the laws given, behind the last of the others.
pub fn columns(laws: &[StudyLaw]) -> Vec<Number<'_>> {
    let coefficients = laws.iter().flat_map(StudyLaw::places).map(Number::Coefficient);
    coefficients.chain(laws.iter().filter(|law| law.has_states()).map(Number::AtRest)).collect()
}

/// Writes what the general integrator needs: `Laws`, `laws_of` a member, and `act`. The
/// coefficients stand from column `first` on, in the order of the laws given.
pub(super) fn text(laws: &[StudyLaw], first: usize) -> String {
    let mut fields: Vec<String> = laws.iter().flat_map(coefficients).collect();
    fields.extend(laws.iter().filter(|law| law.has_states()).map(|law| format!("{}_rest", function(law))));
    let mut text = String::new();
    for law in laws {
        text += law.term.wgsl();
        text += "\n";
    }
    // A struct may not be empty.
    let (declared, loaded) = if fields.is_empty() {
        ("    none: f32,\n".to_owned(), "0.0".to_owned())
    } else {
        let column = |place: usize| format!("column(i, {}u)", first + place);
        let loaded: Vec<String> = (0..fields.len()).map(column).collect();
        (fields.iter().map(|field| format!("    {field}: f32,\n")).collect(), loaded.join(", "))
    };
    text += &format!("struct Laws {{\n{declared}}}\nfn laws_of(i: u32) -> Laws {{\n    return Laws({loaded});\n}}\n");
    text += "fn act(at: Instant, laws: Laws, linear: f32) -> f32 {\n    var sum = linear;\n";
    for law in laws {
        let name = function(law);
        let mut arguments: Vec<String> = coefficients(law).iter().map(|field| format!("laws.{field}")).collect();
        if law.has_states() {
            arguments.push(format!("here.{name}"));
            text += &format!("    rates.{name} = {name}_rates(at, {});\n", arguments.join(", "));
        }
        text += &format!("    sum = {name}(at, {}, sum);\n", arguments.join(", "));
    }
    text + "    return sum;\n}\n"
}
