//! A statistic of an ensemble and the requirement that limits it: `p95(position_error_m, 60) < 10`.
//!
//! Intervals: a quantile's from the ranks that the binomial distribution puts around its own
//! (normal approximation; David & Nagaraja, *Order Statistics*, 3rd ed., §7.1), free of any
//! distribution; a mean's from the standard error; a standard deviation's from the fourth moment,
//! so that it holds for any law that has one.

use std::fmt;
use std::str::FromStr;

use super::watched::Watched;
use crate::error::nearest;
use crate::statistics::Estimate;

/// The 97.5 % quantile of the standard normal.
pub const Z95: f64 = 1.959_963_985;

/// A number that sums up an ensemble.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Statistic {
    /// Mean over the members.
    Mean,
    /// Standard deviation over the members.
    Sd,
    /// Quantile of the signed error at this probability.
    Quantile(f64),
    /// Quantile of its absolute value.
    Absolute(f64),
    /// Circular error probable: radius of the circle about the truth that holds this fraction of
    /// the members.
    Circular(f64),
}

/// The names and what they mean.
const NAMES: [(&str, Statistic); 10] = [
    ("mean", Statistic::Mean),
    ("sd", Statistic::Sd),
    ("p01", Statistic::Quantile(0.01)),
    ("p05", Statistic::Quantile(0.05)),
    ("p50", Statistic::Quantile(0.50)),
    ("p95", Statistic::Quantile(0.95)),
    ("p99", Statistic::Quantile(0.99)),
    ("abs95", Statistic::Absolute(0.95)),
    ("cep50", Statistic::Circular(0.50)),
    ("cep95", Statistic::Circular(0.95)),
];

impl Statistic {
    /// Name as in an expression of a limit.
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(_, statistic)| *statistic == self).map_or("quantile", |(name, _)| name)
    }

    /// The statistic of some values, `shift` standard errors higher: 0 for itself, ±[`Z95`] for the
    /// ends of its 95 % interval. NaN of none. The values are put in another order.
    pub fn shifted(self, values: &mut [f64], shift: f64) -> f64 {
        let n = values.len() as f64;
        match self {
            Self::Mean => {
                let (mean, variance, _) = central(values);
                mean + shift * (variance / n).sqrt()
            }
            Self::Sd => {
                let (_, variance, fourth_moment) = central(values);
                // Cramér, Mathematical Methods of Statistics, §27.4: var s² ≈ (μ₄ − σ⁴)/n; s by the
                // delta method.
                let of_variance = ((fourth_moment - variance * variance).max(0.0) / n).sqrt();
                let sd = variance.sqrt();
                if sd > 0.0 { sd + shift * of_variance / (2.0 * sd) } else { 0.0 }
            }
            Self::Quantile(p) | Self::Circular(p) => quantile(values, p + shift * (p * (1.0 - p) / n).sqrt()),
            Self::Absolute(p) => {
                values.iter_mut().for_each(|v| *v = v.abs());
                Self::Quantile(p).shifted(values, shift)
            }
        }
    }

    /// Itself with its 95 % interval.
    pub fn estimate(self, values: &[f64]) -> Estimate {
        let at = |shift: f64| self.shifted(&mut values.to_vec(), shift);
        Estimate { value: at(0.0), ci95: [at(-Z95), at(Z95)] }
    }
}

/// Mean, variance (n − 1) and fourth central moment.
fn central(values: &[f64]) -> (f64, f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let (second, fourth_moment) = values.iter().fold((0.0, 0.0), |(second, fourth_moment), v| {
        let square = (v - mean) * (v - mean);
        (second + square, fourth_moment + square * square)
    });
    (mean, second / (n - 1.0).max(1.0), fourth_moment / n)
}

/// The quantile at `p`, linear between ranks, without sorting all of them.
fn quantile(values: &mut [f64], p: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    let rank = p.clamp(0.0, 1.0) * last as f64;
    let below = (rank as usize).min(last);
    let (_, low, rest) = values.select_nth_unstable_by(below, f64::total_cmp);
    let low = *low;
    let high = rest.iter().copied().reduce(f64::min).unwrap_or(low);
    low + (rank - below as f64) * (high - low)
}

/// A requirement: a statistic of a quantity at a time stays below a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Statistic that is limited.
    pub statistic: Statistic,
    /// The error whose statistic is limited.
    pub quantity: Watched,
    /// Time of the statistic, s from the end of the still start.
    pub time_s: f64,
    /// Below what, in the quantity's unit.
    pub below: f64,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { statistic, quantity, time_s, below } = self;
        write!(f, "{}({}, {time_s}) < {below}", statistic.name(), quantity)
    }
}

const FORM: &str = "need STAT(QUANTITY, TIME_S) < NUMBER, e.g. \"p95(position_error_m, 60) < 10\"";

/// A comparison in words: `NAME(QUANTITY, TIME_S) < NUMBER`, or with another sign.
pub(super) struct Compared<'a> {
    pub name: &'a str,
    pub quantity: &'a str,
    pub time_s: f64,
    pub number: f64,
}

impl<'a> Compared<'a> {
    /// Reads one; `form` says how one is written.
    pub(super) fn read(text: &'a str, sign: char, form: &str) -> Result<Self, String> {
        let (name, rest) = text.split_once('(').ok_or(form)?;
        let (inside, rest) = rest.split_once(')').ok_or(form)?;
        let (quantity, time) = inside.split_once(',').ok_or(form)?;
        let number = rest.trim().strip_prefix(sign).ok_or(form)?;
        let finite = |text: &str, what: &str| match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("{what} is `{}`, not a number; {form}", text.trim())),
        };
        let time_s = finite(time, "the time")?;
        if time_s <= 0.0 {
            return Err(format!("the time is {time_s} s: need more than zero"));
        }
        Ok(Self { name: name.trim(), quantity: quantity.trim(), time_s, number: finite(number, "the limit")? })
    }
}

impl FromStr for Limit {
    type Err = String;

    /// `STAT(QUANTITY, TIME_S) < NUMBER`.
    fn from_str(text: &str) -> Result<Self, String> {
        let Compared { name, quantity, time_s, number } = Compared::read(text, '<', FORM)?;
        let statistic = statistic(name)?;
        let quantity = Watched::named(quantity)?;
        if matches!(statistic, Statistic::Circular(_)) && quantity != Watched::HORIZONTAL {
            return Err(format!(
                "{} is a radius of the horizontal error: need {0}(horizontal_error_m, TIME_S), of a study with a \
                 [trajectory]; abs95 is the 95 % of an absolute error",
                statistic.name()
            ));
        }
        Ok(Self { statistic, quantity, time_s, below: number })
    }
}

/// The percentile whose number is nearest to that of `p90`.
fn nearest_percentile(name: &str) -> Option<&'static str> {
    let number = |name: &str| name.strip_prefix('p')?.parse::<f64>().ok();
    let wanted = number(name)?;
    let off = |known: &str| number(known).map_or(f64::INFINITY, |own| (own - wanted).abs());
    NAMES.iter().map(|(known, _)| *known).min_by(|a, b| off(a).total_cmp(&off(b)))
}

fn statistic(name: &str) -> Result<Statistic, String> {
    let known: Vec<&str> = NAMES.iter().map(|(known, _)| *known).collect();
    match NAMES.iter().find(|(known, _)| *known == name) {
        Some((_, statistic)) => Ok(*statistic),
        None => Err(match nearest_percentile(name).or_else(|| nearest(name, known.iter().copied())) {
            Some(near) => format!("`{name}` is not a statistic: did you mean `{near}`?"),
            None => format!("`{name}` is not a statistic; known: {}", known.join(", ")),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::special::{exact_interval, normal_quantile};
    use crate::rng::{Philox, Stream};

    #[test]
    fn a_requirement_is_read_as_it_is_written_and_refused_in_words() {
        let limit: Limit = "p95(position_error_m, 60) < 10".parse().expect("read");
        let expected =
            Limit { statistic: Statistic::Quantile(0.95), quantity: Watched::OneAxis(0), time_s: 60.0, below: 10.0 };
        assert_eq!(limit, expected);
        assert_eq!(limit.to_string().parse(), Ok(expected));
        let radius = "cep95(horizontal_error_m, 60) < 10";
        assert_eq!(radius.parse::<Limit>().map(|limit| limit.to_string()), Ok(radius.to_owned()));
        for (wrong, word) in [
            ("p95 < 10", "STAT(QUANTITY, TIME_S)"),
            ("p90(position_error_m, 60) < 10", "did you mean `p95`"),
            ("p96(position_error_m, 60) < 10", "did you mean `p95`"),
            ("p95(position_eror_m, 60) < 10", "did you mean `position_error_m`"),
            ("p95(position_error_m, soon) < 10", "`soon`"),
            ("p95(position_error_m, -1) < 10", "more than zero"),
            ("p95(position_error_m, 60) > 10", "< NUMBER"),
            ("cep95(position_error_m, 60) < 10", "horizontal"),
        ] {
            assert!(wrong.parse::<Limit>().is_err_and(|e| e.contains(word)), "{wrong}");
        }
    }

    /// The 95 % intervals of 400 samples of 2000 exponentials, whose mean, deviation and quantiles
    /// are known, hold the truth as often as they say; those of another number do not.
    #[test]
    fn intervals_hold_what_they_say_for_a_skewed_law() {
        let (repeats, members) = (400, 2000);
        // Half the sum of two squared normal numbers.
        let exponential = |rng: &mut Philox| 0.5 * (rng.normal().powi(2) + rng.normal().powi(2));
        let cases = [
            (Statistic::Mean, 1.0),
            (Statistic::Sd, 1.0),
            (Statistic::Quantile(0.05), -(0.95f64.ln())),
            (Statistic::Quantile(0.95), -(0.05f64.ln())),
            (Statistic::Absolute(0.95), -(0.05f64.ln())),
        ];
        for (statistic, truth) in cases {
            let holds = |truth: f64| {
                let inside = |repeat: u64| {
                    let mut rng = Philox::new(3, repeat, Stream::Host);
                    let values: Vec<f64> = (0..members).map(|_| exponential(&mut rng)).collect();
                    let [low, high] = statistic.estimate(&values).ci95;
                    (low..=high).contains(&truth)
                };
                (0..repeats).filter(|r| inside(*r)).count() as u64
            };
            let hits = holds(truth);
            // 95 % lies in the 99.9 % interval of this many hits.
            let [low, high] = exact_interval(hits, repeats, 0.999);
            assert!(low < 0.95 && 0.95 < high, "{} holds {hits} of {repeats}", statistic.name());
            assert!(holds(truth * 1.5) < repeats / 2, "{} holds what is wrong", statistic.name());
        }
        assert!((normal_quantile(0.975) - Z95).abs() < 1e-8);
    }
}
