//! The sensor as its datasheet would print it.

use crate::report::table::Table;
use crate::study::Study;
use crate::study::parameter::{PARAMETERS, Parameter};
use crate::units::DENSITY_TO_RANDOM_WALK;

/// Which noise is meant, said once.
pub const CONVENTION: &str = "Noise densities n are one-sided, as datasheets print them; random walks N are two-sided coefficients as in IEEE 952 and \
     1293, N = n/√2, and a white sequence at rate f has σ = N√f. Bias instability B is the minimum Allan deviation divided by \
     0.664. A number with ± is drawn per sensor (mean ± standard deviation), one with … uniformly between its ends.";

/// What the study says of the sensor, in datasheet units.
pub fn table(study: &Study) -> Table {
    let mut table = Table::new(&["parameter", "value", "unit", "also"]);
    table.row(["sampling rate", &format!("{}", round(1.0 / study.sample_s())), "Hz", ""]);
    for row in &PARAMETERS {
        let Some(number) = study.tolerances[row.parameter] else { continue };
        let also = match row.parameter {
            Parameter::NoiseDensity => {
                let walk = number.scaled(row.factor * 60.0);
                format!("N = {} m/s/√h", rounded(walk))
            }
            Parameter::GyroNoiseDensity => {
                format!("N = {} °/√h", rounded(number.scaled(DENSITY_TO_RANDOM_WALK * 60.0)))
            }
            Parameter::VelocityRandomWalk => {
                let density = Parameter::NoiseDensity.description().factor;
                format!("n = {} µg/√Hz", rounded(number.scaled(row.factor / density)))
            }
            Parameter::AngleRandomWalk => {
                let density = Parameter::GyroNoiseDensity.description().factor;
                format!("n = {} °/s/√Hz", rounded(number.scaled(row.factor / density)))
            }
            _ => String::new(),
        };
        table.row([row.name.to_owned(), number.to_string(), row.unit.to_owned(), also]);
    }
    table
}

fn rounded(number: crate::study::number::Number) -> String {
    use crate::study::number::Number;
    match number {
        Number::Fixed(v) => Number::Fixed(round(v)),
        Number::Normal { mean, sd } => Number::Normal { mean: round(mean), sd: round(sd) },
        Number::Uniform { min, max } => Number::Uniform { min: round(min), max: round(max) },
    }
    .to_string()
}

/// To four significant digits.
fn round(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10f64.powf(3.0 - value.abs().log10().floor());
    (value * scale).round() / scale
}
