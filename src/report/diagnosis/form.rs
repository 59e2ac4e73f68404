//! The form of a law as the recording has it, next to the one that its name states.

use proofmass_diagnosis::verdict::Form;
use proofmass_physics::free_form::{Argument, Freed};

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark};

/// Rms departure, as a part of the stated form's, from which a law is no longer called close to the
/// stated one.
const FAR: f64 = 0.3;

/// One figure per law whose form was freed; each with the id of its effect.
pub(crate) fn exhibits(forms: &[(&'static str, Form)]) -> Vec<Exhibit> {
    forms.iter().map(|(id, form)| exhibit(id, form)).collect()
}

fn exhibit(id: &str, form: &Form) -> Exhibit {
    let points = |curve: &[[f64; 2]]| curve.iter().map(|[a, f]| (*a, *f)).collect::<Vec<_>>();
    let stated = form.stated.replace("^2", "²").replace("^3", "³");
    let argument = match form.law.argument() {
        Argument::Displacement => "displacement",
        Argument::Velocity => "velocity",
        Argument::Input => "input",
        Argument::Time => "time",
    };
    let value = if form.law == Freed::Readout { "added to the reading" } else { "law, per unit mass" };
    let mut chart = Chart::new(
        &format!("Form of {}", id),
        Axis::linear(&format!("{argument} (range visited)")),
        Axis::linear(value),
    );
    chart.add(&format!("as stated: {stated}"), Ink::Black, Mark::Dashed, points(&form.stated_curve));
    chart.add("with a free form", Ink::Red, Mark::Line, points(&form.curve));
    let percent = |v: f64| proofmass_base::number::short(100.0 * v);
    let how = if form.departure < FAR { "close to, but not identical to," } else { "not" };
    let said = if form.departs {
        format!(
            "The free form predicts held-out samples better: the law is {how} {stated}. \
             Rms difference, weighted by how often each value is visited: {} % of the stated form (95 % interval {} \
             to {} %).",
            percent(form.departure),
            percent(form.ci95[0]),
            percent(form.ci95[1])
        )
    } else {
        format!(
            "With its form left free, the law stays within {} % of the stated one (95 %), weighted by how often \
             each value is visited.",
            percent(form.ci95[1])
        )
    };
    Exhibit { part: Part::Identification, name: format!("form-{}", id), figure: chart.draw(), caption: said }
}
