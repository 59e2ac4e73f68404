//! An axis: label with unit, linear or logarithmic, range and ticks.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use proofmass_base::number::{rounded, significant, superscript};

/// Spacing of values along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly spaced values.
    Linear,
    /// Logarithmic spacing; values must be above zero.
    Log,
}

/// An axis of a chart: label, spacing and limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit, e.g. "position error / m".
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Limits; from the data where absent.
    pub range: Option<(f64, f64)>,
    /// Entries in place of numbers, each with its position and its name.
    pub names: Vec<(f64, String)>,
}

/// "quantity / unit", the unit in brackets where it is a quotient itself.
pub fn labelled(quantity: &str, unit: &str) -> String {
    if unit.contains('/') { format!("{quantity} / ({unit})") } else { format!("{quantity} / {unit}") }
}

impl Axis {
    /// A linear axis with this label, its range from the data.
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None, names: Vec::new() }
    }

    /// A logarithmic axis with this label, its range from the data.
    pub fn log(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Log, range: None, names: Vec::new() }
    }

    /// The same axis as a list: places and what stands there.
    pub fn named(mut self, names: Vec<(f64, String)>) -> Self {
        self.names = names;
        self
    }

    /// The same axis with fixed limits, in its unit.
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// Limits that hold all `values`, with a little air on a linear axis.
    pub(super) fn fitted(&self, values: impl Iterator<Item = f64>) -> Span {
        let usable = values.filter(|v| v.is_finite() && (self.scale == Scale::Linear || *v > 0.0));
        // A logarithmic axis has no zero: limits that it cannot show give way to those of the data.
        let shown = |(low, high): &(f64, f64)| {
            self.scale == Scale::Linear || (low.is_normal() && high.is_finite() && 0.0 < *low && low < high)
        };
        let (low, high) = self.range.filter(shown).unwrap_or_else(|| {
            let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            match self.scale {
                _ if low > high => {
                    if self.scale == Scale::Log {
                        (0.1, 1.0)
                    } else {
                        (0.0, 1.0)
                    }
                }
                Scale::Log if high / low < 1.5 => (low / 2.0, high * 2.0),
                Scale::Log => (low / 1.15, high * 1.15),
                Scale::Linear if high - low <= 1e-12 * high.abs() => {
                    (low - low.abs().max(1.0) * 0.1, high + high.abs().max(1.0) * 0.1)
                }
                Scale::Linear => (low - 0.04 * (high - low), high + 0.04 * (high - low)),
            }
        });
        Span { scale: self.scale, low, high }
    }
}

/// An axis with its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Span {
    /// 0 at the low end, 1 at the high end.
    ///
    /// What lies far outside stops a hundred lengths of the axis beyond it, a logarithm of zero
    /// included.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let fraction = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln(),
        };
        fraction.clamp(-100.0, 101.0)
    }

    /// A point is drawable when it lies on the axis at all (log axes have no zero).
    pub(super) fn holds(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    fn step(&self) -> f64 {
        let raw = (self.high - self.low) / 6.0;
        let power = 10f64.powf(raw.log10().floor());
        let nice = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|n| n * power >= raw * 0.999).unwrap_or(10.0);
        nice * power
    }

    pub(super) fn ticks(&self) -> Vec<f64> {
        let evenly = || {
            let step = self.step();
            let first = (self.low / step).ceil() as i64;
            let last = (self.high / step).floor() as i64;
            (first..=last.min(first + 50)).map(|k| k as f64 * step).collect()
        };
        if self.scale == Scale::Linear {
            return evenly();
        }
        let (first, last) = (self.low.log10().ceil() as i32, self.high.log10().floor() as i32);
        let every = ((last - first) / 8 + 1).max(1);
        let decades = (self.high / self.low).log10();
        let within: &[f64] = if decades < 1.2 {
            &[1.0, 2.0, 3.0, 5.0, 7.0]
        } else if decades < 2.6 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let by_decade: Vec<f64> = (first - 1..=last)
            .filter(|e| (e - first).rem_euclid(every) == 0)
            .flat_map(|e| within.iter().map(move |m| m * 10f64.powi(e)))
            .filter(|v| *v >= self.low * 0.999 && *v <= self.high * 1.001)
            .collect();
        // A part of a decade is nearly even, and one tick alone says no scale.
        if by_decade.len() < 3 && decades < 1.0 { evenly() } else { by_decade }
    }

    /// The text of a tick.
    pub(super) fn tick_label(&self, value: f64) -> String {
        match self.scale {
            Scale::Log => {
                let exponent = value.log10().floor() as i32;
                let mantissa = value / 10f64.powi(exponent);
                // As many digits as the tick has.
                let digits = (1..6).find(|d| (rounded(value, *d) / value - 1.0).abs() < 1e-9).unwrap_or(6);
                match (-2..4).contains(&exponent) {
                    true => significant(value, digits),
                    false if (mantissa - 1.0).abs() < 1e-6 => format!("10{}", superscript(exponent)),
                    false => format!("{}·10{}", significant(mantissa, digits), superscript(exponent)),
                }
            }
            Scale::Linear => {
                let step = self.step();
                let largest = self.low.abs().max(self.high.abs());
                if value.abs() < step * 1e-6 {
                    return "0".into();
                }
                let power = largest.log10().floor() as i32;
                let shrink = if (-3..6).contains(&power) { 1.0 } else { 10f64.powi(power) };
                let decimals = (-((step / shrink).log10() + 1e-9).floor()).max(0.0) as usize;
                let extra = usize::from((step / shrink * 10f64.powi(decimals as i32)).fract() > 0.01);
                let body = format!("{:.*}", decimals + extra, value / shrink).replacen('-', "−", 1);
                if shrink == 1.0 { body } else { format!("{body}·10{}", superscript(power)) }
            }
        }
    }
}

impl Ranged for Span {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        limit.0 + (self.fraction(*value) * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Span {
    fn format_ext(&self, value: &f64) -> String {
        self.tick_label(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let span = Span { scale: Scale::Linear, low: -0.3, high: 10.4 };
        assert_eq!(span.ticks(), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(span.tick_label(4.0), "4");
        let log = Span { scale: Scale::Log, low: 0.5, high: 2e4 };
        assert_eq!(log.ticks(), [1.0, 10.0, 100.0, 1000.0, 10000.0]);
        assert_eq!(log.tick_label(1e4), "10⁴");
        let from_zero = Axis::log("").within(0.0, 2.0).fitted([0.0, 0.1, 1.0].into_iter());
        assert_eq!((from_zero.ticks().len(), from_zero.ticks()[5]), (6, 1.0));
        let part = Span { scale: Scale::Log, low: 80.0, high: 170.0 };
        assert_eq!(
            part.ticks().iter().map(|t| part.tick_label(*t)).collect::<Vec<_>>(),
            ["80", "100", "120", "140", "160"]
        );
        let quarter = Span { scale: Scale::Linear, low: 0.0, high: 1.4 };
        assert_eq!(quarter.tick_label(0.25), "0.25");
    }
}
