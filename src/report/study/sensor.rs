//! The sensor as its datasheet would print it.

use crate::table::Table;
use proofmass_base::number::rounded;
use proofmass_base::units::key::Key;
use proofmass_base::units::number::Number;
use proofmass_scenario::sensor::SensorTerm;
use proofmass_study::Study;
use proofmass_study::tolerances::keys;

/// Which noise is meant, said once.
pub(super) const CONVENTION: &str = "Noise densities n are one-sided, as datasheets print them; random walks N are two-sided coefficients as in IEEE 952 and \
     1293, N = n/√2, and a white sequence at rate f has σ = N√f. Bias instability B is the minimum Allan deviation divided by \
     0.664. A number with ± is drawn per sensor (mean ± standard deviation), one with … uniformly between its ends.";

/// What the study says of the sensor, in datasheet units.
pub(super) fn table(study: &Study) -> Table {
    let mut table = Table::new(&["parameter", "value", "unit", "also"]);
    table.row(["sampling rate", &format!("{}", rounded(1.0 / study.sample_s(), 4)), "Hz", ""]);
    for key in keys() {
        let Some(number) = study.tolerances[key] else { continue };
        table.row([key.name.to_owned(), number.to_string(), key.unit.to_owned(), by_its_other_key(key, number)]);
    }
    table
}

/// The number as another key of the same term would give it: a density as a random walk and the
/// other way round.
fn by_its_other_key(key: &Key, number: Number) -> String {
    let keys = SensorTerm::ALL.into_iter().map(|term| term.row().keys).find(|keys| keys.contains(key));
    let other = keys.unwrap_or_default().iter().find(|other| *other != key);
    other.map_or(String::new(), |other| {
        let symbol = if other.one_sided { "n" } else { "N" };
        format!("{symbol} = {} {}", to_four_digits(number.scaled(key.factor / other.factor)), other.unit)
    })
}

/// To four significant digits.
fn to_four_digits(number: Number) -> Number {
    number.map(|value| rounded(value, 4))
}
