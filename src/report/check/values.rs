//! Values, differences and spreads of parameters in the units that they are stated in: of those that are held
//! as logarithms the sizes themselves, and ratios of them.

use super::words::unit;
use proofmass_base::number::{short, significant, with_uncertainty};
use proofmass_diagnosis::repeatability::agreement::Line;
use proofmass_diagnosis::repeatability::parameter::{Element, Estimate, Parameter, Role};
use proofmass_diagnosis::repeatability::spread::Spread;

/// Relative uncertainty up to which a size is written with ±; beyond, its interval is lopsided.
const EVEN: f64 = 0.2;

/// A number with its 95 % interval, in the unit of its parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Valued {
    pub value: f64,
    pub ci95: [f64; 2],
}

impl Valued {
    fn of(is_logarithmic: bool, (value, half): (f64, f64), factor: f64) -> Self {
        let ends = [value - half, value + half];
        match is_logarithmic {
            true => Self { value: value.exp() * factor, ci95: ends.map(|e| e.exp() * factor) },
            false => Self { value: value * factor, ci95: ends.map(|e| e * factor) },
        }
    }

    /// "2.10 ± 0.03", or "0.8 (0.4 to 1.7)" where it is lopsided.
    pub(super) fn words(self) -> String {
        let [low, high] = self.ci95;
        let half = 0.5 * (high - low);
        let is_lopsided = (high + low - 2.0 * self.value).abs() > EVEN * half;
        if is_lopsided && self.value != 0.0 {
            let [value, low, high] = [self.value, low, high].map(|v| significant(v, 2));
            return format!("{value} ({low} to {high})");
        }
        with_uncertainty(self.value, half)
    }
}

/// Value of a parameter with its interval.
pub(super) fn estimated(estimate: &Estimate, p: usize) -> Valued {
    let parameter = &estimate.parameters[p];
    Valued::of(parameter.is_logarithmic(), (estimate.value[p], estimate.half_width(p)), unit(parameter).1)
}

/// The largest difference of a line: of what is held as a logarithm the ratio.
pub(super) fn difference(parameter: &Parameter, line: &Line) -> Valued {
    let told = (line.difference, line.half_width);
    match parameter.is_logarithmic() {
        true => Valued::of(true, told, 1.0),
        false => Valued::of(false, told, unit(parameter).1),
    }
}

/// "0.03 ± 0.01 °/s"; of a scale "0.3 ± 0.1 %" of it; of a noise "a factor of 1.30 ± 0.06".
pub(super) fn difference_in_words(parameter: &Parameter, line: &Line) -> String {
    let middle = line.runs.iter().map(|r| r.0).sum::<f64>() / line.runs.len().max(1) as f64;
    match parameter {
        _ if parameter.is_logarithmic() => format!("a factor of {}", difference(parameter, line).words()),
        Parameter::Element(Element { role: Role::Scale, .. }) if middle != 0.0 => {
            let percent = 100.0 / middle.abs();
            format!("{} %", with_uncertainty(line.difference * percent, line.half_width * percent))
        }
        _ => format!("{} {}", difference(parameter, line).words(), unit(parameter).0),
    }
}

/// Mean, its error, the spread and its interval over the runs.
pub(super) fn spread(parameter: &Parameter, spread: &Spread) -> [f64; 5] {
    let factor = unit(parameter).1;
    let (mean, each) = match parameter.is_logarithmic() {
        true => (spread.mean.exp() * factor, spread.mean.exp() * factor),
        false => (spread.mean * factor, factor),
    };
    let [low, high] = spread.between_ci95;
    [mean, spread.mean_error * each, spread.between * each, low * each, high * each]
}

/// "0.4 (0.2 to 1.1)".
pub(super) fn spread_in_words(parameter: &Parameter, of: &Spread) -> String {
    let [_, _, between, low, high] = spread(parameter, of).map(short);
    format!("{between} ({low} to {high})")
}
