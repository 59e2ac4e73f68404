//! The sensor as its datasheet would print it.

use crate::number::rounded;
use crate::report::table::Table;
use crate::study::Study;
use crate::study::number::Number;
use crate::study::parameter::{PARAMETERS, Parameter};
use crate::units::DENSITY_TO_RANDOM_WALK;

/// Which noise is meant, said once.
pub const CONVENTION: &str = "Noise densities n are one-sided, as datasheets print them; random walks N are two-sided coefficients as in IEEE 952 and \
     1293, N = n/√2, and a white sequence at rate f has σ = N√f. Bias instability B is the minimum Allan deviation divided by \
     0.664. A number with ± is drawn per sensor (mean ± standard deviation), one with … uniformly between its ends.";

/// What the study says of the sensor, in datasheet units.
pub fn table(study: &Study) -> Table {
    let mut table = Table::new(&["parameter", "value", "unit", "also"]);
    table.row(["sampling rate", &format!("{}", rounded(1.0 / study.sample_s(), 4)), "Hz", ""]);
    for row in &PARAMETERS {
        let Some(number) = study.tolerances[row.parameter] else { continue };
        let also = match row.parameter {
            Parameter::NoiseDensity => {
                let walk = number.scaled(row.factor * 60.0);
                format!("N = {} m/s/√h", four(walk))
            }
            Parameter::GyroNoiseDensity => {
                format!("N = {} °/√h", four(number.scaled(DENSITY_TO_RANDOM_WALK * 60.0)))
            }
            Parameter::VelocityRandomWalk => {
                let density = Parameter::NoiseDensity.description().factor;
                format!("n = {} µg/√Hz", four(number.scaled(row.factor / density)))
            }
            Parameter::AngleRandomWalk => {
                let density = Parameter::GyroNoiseDensity.description().factor;
                format!("n = {} °/s/√Hz", four(number.scaled(row.factor / density)))
            }
            _ => String::new(),
        };
        table.row([row.name.to_owned(), number.to_string(), row.unit.to_owned(), also]);
    }
    table
}

/// To four significant digits.
fn four(number: Number) -> Number {
    number.map(|value| rounded(value, 4))
}
