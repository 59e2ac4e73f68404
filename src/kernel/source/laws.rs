//! The laws of `physics` that a study uses, as WGSL: their own functions, where their coefficients
//! stand, and the sum of them.
//!
//! A law that no member follows is not in the text.

use crate::kernel::member::COLUMNS;
use crate::physics::coefficients::StudyLaw;

/// Name of a law's function.
pub(crate) fn function(law: &StudyLaw) -> String {
    law.term.id().replace('-', "_")
}

/// The names of a law's coefficients in `Laws`.
fn coefficients(law: &StudyLaw) -> Vec<String> {
    (0..law.given().len()).map(|parameter| format!("{}_{parameter}", function(law))).collect()
}

/// What the general integrator needs: `Laws`, `laws_of` a member, and `act`. The coefficients stand
/// in the columns after the last, in the order of the laws given.
pub fn text(laws: &[StudyLaw]) -> String {
    let fields: Vec<String> = laws.iter().flat_map(coefficients).collect();
    let mut text = String::new();
    for law in laws {
        text += law.term.wgsl();
        text += "\n";
    }
    // A struct may not be empty.
    let (declared, loaded) = if fields.is_empty() {
        ("    none: f32,\n".to_owned(), "0.0".to_owned())
    } else {
        let column = |place: usize| format!("column(i, {}u)", COLUMNS + place);
        let loaded: Vec<String> = (0..fields.len()).map(column).collect();
        (fields.iter().map(|field| format!("    {field}: f32,\n")).collect(), loaded.join(", "))
    };
    text += &format!("struct Laws {{\n{declared}}}\nfn laws_of(i: u32) -> Laws {{\n    return Laws({loaded});\n}}\n");
    text += "fn act(at: Instant, laws: Laws, linear: f32) -> f32 {\n    var sum = linear;\n";
    for law in laws {
        let own: Vec<String> = coefficients(law).iter().map(|field| format!("laws.{field}")).collect();
        text += &format!("    sum = {}(at, {}, sum);\n", function(law), own.join(", "));
    }
    text + "    return sum;\n}\n"
}
