//! A number of study.toml: fixed, or drawn per member from a normal or a uniform distribution.
//!
//! A normal tolerance of a quantity that cannot be negative is cut at zero (drawn from the
//! truncated normal), which is harmless while the mean lies two standard deviations or more above
//! zero and refused by `check` when it does not.

#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::fmt;

#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{self, Deserialize, Deserializer, MapAccess, Visitor};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// A number, or the distribution its members are drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// The same value for every member.
    Fixed(f64),
    /// Drawn from a normal distribution.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Drawn uniformly between two ends.
    Uniform {
        /// Lower end.
        min: f64,
        /// Upper end.
        max: f64,
    },
}

impl Number {
    /// The number with `change` made to each of its values: a factor, a rounding.
    pub fn map(self, change: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Fixed(value) => Self::Fixed(change(value)),
            Self::Normal { mean, sd } => Self::Normal { mean: change(mean), sd: change(sd) },
            Self::Uniform { min, max } => Self::Uniform { min: change(min), max: change(max) },
        }
    }

    /// The number in another unit.
    pub fn scaled(self, factor: f64) -> Self {
        self.map(|value| value * factor)
    }

    /// The value, if all members share it.
    pub fn fixed(self) -> Option<f64> {
        match self {
            Self::Fixed(value) => Some(value),
            _ => None,
        }
    }

    /// Returns whether every member is exactly zero.
    pub fn is_zero(self) -> bool {
        self.fixed() == Some(0.0)
    }

    /// Mean and variance of what is drawn; `cut` if the quantity cannot be negative.
    pub fn moments(self, cut: bool) -> (f64, f64) {
        match self {
            Self::Fixed(value) => (value, 0.0),
            Self::Uniform { min, max } => (0.5 * (min + max), (max - min).powi(2) / 12.0),
            Self::Normal { mean, sd } if cut && sd > 0.0 => {
                // Truncation at zero: Johnson, Kotz & Balakrishnan, Continuous Univariate
                // Distributions 1, §13.10.1.
                let standard = Normal::standard();
                let edge = -mean / sd;
                let hazard = standard.pdf(edge) / standard.sf(edge);
                (mean + sd * hazard, sd * sd * (1.0 + edge * hazard - hazard * hazard))
            }
            Self::Normal { mean, sd } => (mean, sd * sd),
        }
    }

    /// The value at `probability` in (0, 1) of its distribution; `cut` if the quantity cannot be
    /// negative.
    pub fn quantile(self, probability: f64, cut: bool) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Uniform { min, max } => min + (max - min) * probability,
            Self::Normal { mean, sd } if sd > 0.0 => {
                let standard = Normal::standard();
                let below = if cut { standard.cdf(-mean / sd) } else { 0.0 };
                let value = mean + sd * standard.inverse_cdf(below + (1.0 - below) * probability);
                if cut { value.max(0.0) } else { value }
            }
            Self::Normal { mean, .. } => mean,
        }
    }
}

/// Writes it as one would: "60", "1200 ± 12 (sd)", "0 … 3".
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(value) => write!(f, "{value}"),
            Self::Normal { mean, sd } => write!(f, "{mean} ± {sd} (sd)"),
            Self::Uniform { min, max } => write!(f, "{min} … {max}"),
        }
    }
}

const KEYS: &[&str] = &["mean", "sd", "min", "max"];

#[cfg(feature = "schema")]
impl JsonSchema for Number {
    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let of = |a: &str, b: &str| {
            schemars::json_schema!({
                "type": "object",
                "properties": { a: { "type": "number" }, b: { "type": "number" } },
                "required": [a, b],
                "additionalProperties": false,
            })
        };
        schemars::json_schema!({ "anyOf": [{ "type": "number" }, of("mean", "sd"), of("min", "max")] })
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Form;
        impl<'de> Visitor<'de> for Form {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, { mean = …, sd = … } or { min = …, max = … }")
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Number, E> {
                Ok(Number::Fixed(value as f64))
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Number, E> {
                finite(value).map(Number::Fixed)
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Number, M::Error> {
                let mut values = [None; 4];
                while let Some(key) = map.next_key_seed(Key)? {
                    values[key] = Some(finite(map.next_value_seed(Plain)?)?);
                }
                match values {
                    [Some(mean), Some(sd), None, None] if sd >= 0.0 => Ok(Number::Normal { mean, sd }),
                    [Some(_), Some(sd), None, None] => {
                        Err(de::Error::custom(format!("sd = {sd} is negative; a standard deviation is zero or more")))
                    }
                    [None, None, Some(min), Some(max)] if min <= max => Ok(Number::Uniform { min, max }),
                    [None, None, Some(min), Some(max)] => {
                        Err(de::Error::custom(format!("min = {min} lies above max = {max}")))
                    }
                    _ => Err(de::Error::custom("a drawn number needs both `mean` and `sd`, or both `min` and `max`")),
                }
            }
        }
        deserializer.deserialize_any(Form)
    }
}

fn finite<E: de::Error>(value: f64) -> Result<f64, E> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(de::Error::custom(format!("{value} is not a finite number; leave the key out to switch it off"))),
    }
}

/// The index in `KEYS`, read as a key so that a misspelt one is placed.
struct Key;

impl<'de> de::DeserializeSeed<'de> for Key {
    type Value = usize;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<usize, D::Error> {
        let key = String::deserialize(deserializer)?;
        KEYS.iter().position(|k| *k == key).ok_or_else(|| de::Error::unknown_field(&key, KEYS))
    }
}

/// A float that may be written as an integer.
struct Plain;

impl<'de> de::DeserializeSeed<'de> for Plain {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<f64, D::Error> {
        f64::deserialize(deserializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::parse_toml;

    #[derive(Debug, serde::Deserialize)]
    struct Holder {
        x: Number,
    }

    fn read(text: &str) -> Result<Number, crate::error::Error> {
        parse_toml::<Holder>("study.toml", text).map(|h| h.x)
    }

    #[test]
    fn it_is_read_in_its_three_forms() {
        assert_eq!(read("x = 3"), Ok(Number::Fixed(3.0)));
        assert_eq!(read("x = { mean = 1, sd = 0.5 }"), Ok(Number::Normal { mean: 1.0, sd: 0.5 }));
        assert_eq!(read("x = { min = -1.0, max = 2 }"), Ok(Number::Uniform { min: -1.0, max: 2.0 }));
    }

    #[test]
    fn what_is_no_number_is_placed_and_explained() {
        for (text, place, words) in [
            ("\nx = \"3\"", ":2:5:", "{ mean"),
            ("x = { meen = 1, sd = 2 }", ":1:7:", "unknown field `meen`"),
            ("x = { mean = 1 }", ":1:5:", "needs both"),
            ("x = { mean = 1, sd = -2 }", ":1:5:", "negative"),
            ("x = { min = 1, max = 0 }", ":1:5:", "above"),
            ("x = nan", ":1:5:", "finite"),
            ("x = { mean = 1, sd = \"2\" }", ":1:22:", "expected"),
        ] {
            let error = read(text).expect_err(text);
            assert!(error.cause.contains(place) && error.cause.contains(words), "{text}: {error}");
        }
        assert_eq!(read("x = { meen = 1, sd = 2 }").expect_err("misspelt").hint, "did you mean `mean`?");
    }

    #[test]
    fn quantiles_integrate_to_the_stated_moments() {
        let n = 200_000;
        let cases = [
            (Number::Normal { mean: 3.0, sd: 0.5 }, false),
            (Number::Normal { mean: 1.0, sd: 0.5 }, true),
            (Number::Uniform { min: -1.0, max: 3.0 }, false),
        ];
        for (number, cut) in cases {
            let draws: Vec<f64> = (0..n).map(|k| number.quantile((k as f64 + 0.5) / n as f64, cut)).collect();
            let mean = draws.iter().sum::<f64>() / n as f64;
            let variance = draws.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n as f64;
            let (want_mean, want_variance) = number.moments(cut);
            assert!((mean - want_mean).abs() < 1e-4 && (variance - want_variance).abs() < 1e-3, "{number:?}");
            assert!(!cut || draws.iter().all(|d| *d >= 0.0));
        }
    }
}
