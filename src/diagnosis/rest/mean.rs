//! The mean of every channel, and how far it may be from the bias that the noise was added to.
//!
//! White noise and a memory average out; a walk and 1/f noise do not, and a longer recording only
//! leads them further away. They have no mean of their own, so the bias is taken to be what they
//! were added to from the first sample on, as a walk begins at zero. Not for a bias that jumps: the
//! mean of the recording lies between its levels.

use statrs::function::gamma::gamma;

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::course::is_course;
use super::describe;
use super::intake::Columns;
use super::laws::{SLOW, minus_aic};
use super::spectrum::Law;
use super::standing::CLOSE;
use super::statement::{Follows, Statement};
use crate::model::Noise;
use crate::numerics::moments::mean;
use crate::numerics::special::normal_quantile;
use crate::verdict::Estimate;

/// Variance over that by white noise alone from which the mean of a recording and the bias are told
/// apart: the interval is then half as wide again.
const APART: f64 = 2.25;

/// A channel's mean and the variances of what separates it from the truth, in its unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mean {
    pub(super) channel: String,
    pub(super) unit: String,
    pub(super) value: f64,
    /// By noise that averages out: how well the recording's own mean is known.
    pub(super) of_recording: f64,
    /// By all noise: how well the bias is known.
    pub(super) of_bias: f64,
    /// Things that the bias follows.
    pub(super) follows: Vec<Follows>,
}

impl Mean {
    /// Of a channel, under the laws that were fitted, or indistinguishable from them, and those
    /// that are promised: the largest variance counts.
    pub(super) fn of(channel: &Channel, fitted: &Fitted, noise: Option<&Noise>, columns: &Columns<'_>) -> Self {
        let own = Self::under(channel, fitted, noise);
        let tied = tied(channel, fitted).into_iter().map(|f| Self::under(channel, &f, noise).of_bias);
        let follows = fitted.terms.iter().filter_map(|term| follows(term, channel.together, columns)).collect();
        Self { of_bias: tied.fold(own.of_bias, f64::max), follows, ..own }
    }

    fn under(channel: &Channel, fitted: &Fitted, noise: Option<&Noise>) -> Self {
        let samples = channel.values.len() as f64;
        let laws =
            fitted.terms.iter().filter_map(|t| if let Addition::Law(law) = t.addition { Some(law) } else { None });
        let strengths = fitted.strengths.values.iter().copied();
        let promised = noise.map(|noise| describe::promised_laws(channel, noise)).into_iter().flatten();
        let all = std::iter::once(Law::White).chain(laws).zip(strengths).chain(promised);
        let [mut passing, mut lasting] = [0.0; 2];
        for (law, strength) in all {
            let variance = strength * variance_of_mean(law, samples);
            *(if lasts(law) { &mut lasting } else { &mut passing }) += variance;
        }
        let scale = channel.scale * channel.scale;
        let of_recording = passing * scale;
        Self {
            channel: channel.name.clone(),
            unit: channel.unit.clone(),
            value: channel.mean,
            of_recording,
            of_bias: of_recording + lasting * scale,
            follows: Vec::new(),
        }
    }

    /// Returns it as a base model's number.
    pub(super) fn estimate(&self) -> Estimate {
        let half = half_width(self.of_bias);
        Estimate {
            name: format!("mean of {}", self.channel),
            value: self.value,
            unit: self.unit.clone(),
            ci95: [self.value - half, self.value + half],
        }
    }

    /// Names channels whose drift makes the bias less certain than the mean of the recording.
    pub(super) fn statement(&self) -> Option<Statement> {
        (self.of_bias > APART * self.of_recording).then(|| Statement::Mean {
            channel: self.channel.clone(),
            value: self.value,
            of_recording: half_width(self.of_recording),
            of_bias: half_width(self.of_bias),
            follows: self.follows.clone(),
        })
    }
}

/// Returns what a term makes the bias follow.
fn follows(term: &Term, together: usize, columns: &Columns<'_>) -> Option<Follows> {
    if is_course(term.cause) {
        return Some(Follows::Time);
    }
    let followed = term.column.as_ref()?;
    let values = columns.values(&followed.column).ok()?;
    let acting = followed.delay.in_samples(together).of(values);
    Some(Follows::Column { name: followed.column.clone(), mean: mean(&acting) })
}

/// Returns equally good models in which the drift is persistent: a walk looks like a long memory or
/// like a trend that settles.
fn tied(channel: &Channel, fitted: &Fitted) -> Vec<Fitted> {
    let is_slow = |t: &&Term| SLOW.contains(&t.cause) || is_course(t.cause);
    if !fitted.terms.iter().any(|t| is_slow(&t)) {
        return Vec::new();
    }
    let rest: Vec<Term> = fitted.terms.iter().filter(|t| !is_slow(t)).cloned().collect();
    let with = |laws: &[(Cause, Law)]| {
        let term = |(cause, law): &(Cause, Law)| Term {
            cause: *cause,
            addition: Addition::Law(*law),
            searched: 0.0,
            column: None,
        };
        channel.fit(rest.iter().cloned().chain(laws.iter().map(term)).collect())
    };
    let [flicker, walk] = [(Cause::FlickerNoise, Law::Flicker), (Cause::RandomWalk, Law::Walk)];
    let all = [vec![flicker], vec![walk], vec![flicker, walk]].map(|laws| with(&laws));
    let least = minus_aic(fitted) - CLOSE;
    all.into_iter().filter(|f| minus_aic(f) > least).collect()
}

/// Half the 95 % interval at this variance.
fn half_width(variance: f64) -> f64 {
    normal_quantile(0.975) * variance.max(0.0).sqrt()
}

/// Returns whether a longer recording does not average it out.
fn lasts(law: Law) -> bool {
    match law {
        Law::Flicker | Law::Walk => true,
        Law::Power(exponent) => exponent >= 1.0,
        Law::White | Law::Differenced | Law::Markov(_) | Law::Filtered(_) => false,
    }
}

/// Variance of the mean of `samples` samples of a law of unit strength; a walk and 1/f noise start
/// from zero at the first of them.
fn variance_of_mean(law: Law, samples: f64) -> f64 {
    match law {
        Law::White | Law::Filtered(_) => 1.0 / samples,
        // (e_N − e_0)/N.
        Law::Differenced => 2.0 / (samples * samples),
        Law::Flicker => of_power(1.0, samples),
        Law::Walk => of_power(2.0, samples),
        Law::Power(exponent) => of_power(exponent, samples),
        Law::Markov(memory) => {
            let keep = (-1.0 / memory).exp();
            let left = 1.0 - keep;
            (1.0 + keep) / left / samples - 2.0 * keep * (1.0 - keep.powf(samples)) / (left * samples).powi(2)
        }
    }
}

/// Of white noise summed α/2 times (Kasdin, Proceedings of the IEEE 83, 1995): the impulse response
/// grows as m^(α/2−1)/Γ(α/2), its sum as m^(α/2)/Γ(1+α/2), and the squares of N of these add up to
/// N^(α+1)/((α+1) Γ(1+α/2)²).
fn of_power(exponent: f64, samples: f64) -> f64 {
    samples.powf(exponent - 1.0) / ((exponent + 1.0) * gamma(1.0 + 0.5 * exponent).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of squares that `of_power` is the limit of, from the recursion of the impulse
    /// response, h₀ = 1, hₖ = hₖ₋₁ (k − 1 + α/2)/k.
    fn summed(exponent: f64, samples: usize) -> f64 {
        let (mut response, mut sum, mut squares) = (1.0, 0.0, 0.0);
        for k in 0..samples {
            if k > 0 {
                response *= (k as f64 - 1.0 + 0.5 * exponent) / k as f64;
            }
            sum += response;
            squares += sum * sum;
        }
        squares / (samples as f64).powi(2)
    }

    #[test]
    fn the_variance_of_a_mean_is_that_of_the_sums() {
        for exponent in [0.0, 0.7, 1.0, 1.5, 2.0] {
            let ratio = of_power(exponent, 5000.0) / summed(exponent, 5000);
            assert!((ratio - 1.0).abs() < 2e-3, "{exponent}: {ratio}");
        }
        // A memory: Σ over lags of (N − |k|) ρ^|k| / N².
        let (memory, samples) = (40.0, 300);
        let lag = |k: i32| f64::from(samples - k) * (-f64::from(k) / memory).exp();
        let sum = (f64::from(samples) + 2.0 * (1..samples).map(lag).sum::<f64>()) / f64::from(samples).powi(2);
        assert!((variance_of_mean(Law::Markov(memory), f64::from(samples)) / sum - 1.0).abs() < 1e-9);
        // Control: the walk is not the memory's limit, which is stationary.
        assert!(variance_of_mean(Law::Markov(1e9), 300.0) < 1.001 && variance_of_mean(Law::Walk, 300.0) > 99.0);
    }
}
