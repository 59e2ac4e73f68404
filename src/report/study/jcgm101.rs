//! The result as JCGM 101 states one: estimate, standard uncertainty and coverage intervals with
//! the digits that are stable.

use crate::html::Page;
use crate::table::Table;
use proofmass_numerics::statistics::jcgm101::{Linear, Stated};
use proofmass_simulate::drift::Drift;

/// A number to the last digit that the tolerance leaves: JCGM 101 §7.9.2, GUM 7.2.6.
fn stated(value: f64, tolerance: f64) -> String {
    let unit = 2.0 * tolerance;
    if unit <= 0.0 {
        return proofmass_base::number::significant(value, 6);
    }
    let decimals = (-unit.log10().round()).max(0.0) as usize;
    let rounded = (value / unit).round() * unit;
    // What rounds to nothing has no sign.
    let rounded = if rounded == 0.0 { 0.0 } else { rounded };
    format!("{rounded:.decimals$}").replacen('-', "−", 1)
}

/// The result in a sentence; `error` is its first word, such as "Position".
pub fn sentence(error: &str, of: &Stated) -> String {
    let number = |value: f64| stated(value, of.tolerance);
    let [low, high] = of.interval95.symmetric;
    format!(
        "{error} error at the last report time: {} m, standard uncertainty {} m, 95 % coverage interval {} m to {} m; stable \
         to {} significant digits of the uncertainty ({} trials).",
        number(of.estimate),
        number(of.standard_uncertainty),
        number(low),
        number(high),
        of.digits,
        of.trials
    )
}

/// A sentence on whether the linear result is valid.
pub fn validation(linear: &Linear, left_out: &[String]) -> String {
    let besides = match left_out {
        [] => String::new(),
        left_out => format!(" It leaves out: {}.", left_out.join("; ")),
    };
    let verdict = match linear.validated {
        Some(true) => "is valid here: both ends of its interval agree with the simulation within the tolerance",
        Some(false) => {
            "is not valid here: the ends of its interval differ from the simulation by more than the tolerance"
        }
        None => "is not decided: its ends differ from the simulation by about the tolerance; ask for one more digit",
    };
    format!("The linear answer (GUM, JCGM 101 §8) {verdict}.{besides}")
}

/// Title of the section.
pub const TITLE: &str = "The result as JCGM 101 states it";

/// The section of the page.
pub fn section(page: &mut Page, of: &Stated, linear: &Linear, drift: &Drift) {
    page.section(TITLE);
    page.paragraph(&sentence("Position", of));
    let number = |value: f64| stated(value, of.tolerance);
    let mut table = Table::new(&["how", "estimate / m", "standard uncertainty / m", "95 % from / m", "to / m"]);
    let mut row = |how: &str, estimate: f64, u: f64, [low, high]: [f64; 2]| {
        table.row([how.to_owned(), number(estimate), number(u), number(low), number(high)]);
    };
    row("simulated, symmetric", of.estimate, of.standard_uncertainty, of.interval95.symmetric);
    row("simulated, shortest", of.estimate, of.standard_uncertainty, of.interval95.shortest);
    row("linear (GUM)", linear.estimate, linear.standard_uncertainty, linear.interval95);
    page.table(&table);
    page.paragraph(&format!(
        "Numerical tolerance {} m, half a unit of the last digit, for estimate, standard uncertainty and both ends of \
        the \
         symmetric interval together with a confidence of 95 %. The first ten blocks of 10240 members determine how \
         many trials that takes (Stein's two-stage method).",
        of.tolerance
    ));
    page.paragraph(&validation(linear, &drift.expected.left_out));
}

#[cfg(test)]
mod tests {
    use super::stated;

    // GUM 7.2.6: y = 10.057 62 Ω with u = 27 mΩ is stated as 10.058 Ω.
    #[test]
    fn numbers_are_rounded_to_the_place_of_the_uncertainty() {
        assert_eq!(stated(10.05762, 0.0005), "10.058");
        assert_eq!([stated(-1234.0, 5.0), stated(-0.2, 0.5), stated(42.63, 0.5)], ["−1230", "0", "43"]);
    }
}
