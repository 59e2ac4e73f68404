//! The sensor as its datasheet would print it.

use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::{rounded, significant};
use proofmass_base::units::key::Key;
use proofmass_base::units::number::Number;
use proofmass_kernel::flicker;
use proofmass_scenario::sensor::SensorTerm;
use proofmass_scenario::sensor::error_law::ErrorLaw;
use proofmass_study::Study;
use proofmass_study::tolerances::keys;

/// Which noise is meant, said once.
const CONVENTION: &str = "Noise densities n are one-sided, as datasheets print them; random walks N are two-sided coefficients as in IEEE 952 and \
     1293, N = n/√2, and a white sequence at rate f has σ = N√f. Bias instability B is the minimum Allan deviation divided by \
     0.664. A number with ± is drawn per sensor (mean ± standard deviation), one with … uniformly between its ends.";

/// Adds the sensor to a page.
pub(crate) fn section(page: &mut Page, study: &Study) {
    page.section("The sensor");
    page.paragraph(CONVENTION);
    lowest_frequency(study).iter().for_each(|words| page.paragraph(words));
    page.table(&table(study));
}

/// States down to which frequency bias instability is simulated, where the study has any.
fn lowest_frequency(study: &Study) -> Option<String> {
    let flickers = SensorTerm::ALL.into_iter().filter(|term| matches!(term.law(), ErrorLaw::Flicker(_)));
    let mut keys = flickers.flat_map(|term| term.row().keys);
    keys.any(|key| study.axes().iter().any(|axis| axis[key].is_some())).then(|| {
        let samples = study.alignment.still_samples() + study.clock.samples;
        format!(
            "Bias instability is 1/f noise down to {} Hz, below which its spectrum is flat. Each decade lower would add to every \
             sensor a constant bias of {} B (standard deviation), which a still start removes.",
            significant(flicker::lowest_frequency_hz(samples, study.sample_s()), 2),
            significant(flicker::PER_DECADE, 2)
        )
    })
}

/// Tabulates the sensor of the study, in datasheet units.
fn table(study: &Study) -> Table {
    let mut table = Table::new(&["parameter", "value", "unit", "also"]);
    table.row(["sampling rate", &format!("{}", rounded(1.0 / study.sample_s(), 4)), "Hz", ""]);
    for key in keys() {
        let numbers = || study.axes().iter().map(|axis| axis[key]);
        let Some(number) = numbers().flatten().next() else { continue };
        let (value, also) = match numbers().all(|other| other == Some(number)) {
            true => (number.to_string(), by_its_other_key(key, number)),
            false => (by_axis(numbers()), String::new()),
        };
        table.row([key.name.to_owned(), value, key.unit.to_owned(), also]);
    }
    table
}

/// The number of each axis, by its name.
fn by_axis(numbers: impl Iterator<Item = Option<Number>>) -> String {
    let one =
        |(axis, number): (&str, Option<Number>)| format!("{axis} {}", number.map_or("–".into(), |n| n.to_string()));
    ["x", "y", "z"].into_iter().zip(numbers).map(one).collect::<Vec<_>>().join(", ")
}

/// The number as another key of the same term would give it: a density as a random walk and the
/// other way round.
fn by_its_other_key(key: &Key, number: Number) -> String {
    let Some(term) = SensorTerm::ALL.into_iter().find(|term| term.row().keys.contains(key)) else {
        return String::new();
    };
    let other = term.row().keys.iter().find(|other| *other != key);
    other.map_or(String::new(), |other| {
        // Only white noise has two conventions; the others differ by their unit alone.
        let symbol = match term.law() {
            ErrorLaw::White(_) if other.one_sided => "n = ",
            ErrorLaw::White(_) => "N = ",
            _ => "",
        };
        format!("{symbol}{} {}", to_four_digits(number.scaled(key.factor / other.factor)), other.unit)
    })
}

/// To four significant digits.
fn to_four_digits(number: Number) -> Number {
    number.map(|value| rounded(value, 4))
}
