//! Tells what a log at rest can know of each channel, what it finds, and the same of its halves.
//!
//! Of a channel: the mean of its readings, and the coefficients of its noise as `allan` states them. A
//! mean is known to the Allan deviation at the length of the log, under the noise that fits its curve: that
//! is by how much it differs from the mean of the stretch that follows. A coefficient is known where the data
//! support it, and well where its 95 % interval is narrow against the factor of two that data sheets leave
//! between typical and largest noise.

use std::f64::consts::LN_2;

use nalgebra::DMatrix;

use crate::numerics::allan::fit::expected_errors;
use crate::numerics::allan::fitted::Fit;
use crate::numerics::allan::law::{self, TERMS, Term};
use crate::numerics::special::t_quantile;
use crate::parallel;
use crate::recording::noise;
use crate::recording::unit::Unit;
use crate::repeatability::information::{Information, Known, WEAKLY};
use crate::repeatability::parameter::{AtRest, Estimate, Parameter};
use crate::repeatability::run::{Halves, Remedy, Run, Split};

/// Terms that are compared. A ramp is none: in a second log the same slow cause has another slope.
const COMPARED: [Term; 4] = [Term::Quantisation, Term::White, Term::Flicker, Term::Walk];
/// Standard deviations from the middle to the end of a 95 % interval.
const TO_THE_END: f64 = 1.96;
/// Degrees of freedom that stand for a known variance.
const MANY: f64 = 1e6;
/// Lengths that are looked at for a remedy: the log's own, doubled so often.
const DOUBLED: u32 = 8;

/// A channel at rest.
#[derive(Debug, Clone)]
pub(super) struct Readings {
    pub name: String,
    pub unit: Unit,
    pub values: Vec<f64>,
}

/// Means and noise of some channels over a part of the log.
struct Told {
    /// A channel each; `None` where too few values were left to fit anything.
    fits: Vec<Option<Fit>>,
    means: Vec<f64>,
    samples: usize,
}

/// Checks channels on one clock.
pub(super) fn check(channels: &[Readings], rate_hz: f64, findings: Vec<String>) -> Run {
    let samples = channels.first().map_or(0, |c| c.values.len());
    let parts = [0..samples, 0..samples / 2, samples - samples / 2..samples];
    // Each channel of each part is fitted by itself.
    let fitted = parallel::map_indices(parts.len() * channels.len(), |n| {
        let (part, channel) = (n / channels.len(), &channels[n % channels.len()]);
        let values = &channel.values[parts[part].clone()];
        let told = noise::describe(&channel.name, channel.unit.clone(), (values, rate_hz), n as u64);
        told.map_or((None, f64::NAN), |channel| (channel.fit, channel.mean))
    });
    let told = |part: usize| {
        let (fits, means) = fitted[part * channels.len()..(part + 1) * channels.len()].iter().cloned().unzip();
        Told { fits, means, samples: parts[part].len() }
    };
    let [whole, first, second] = [0, 1, 2].map(told);
    let estimate = |part: &Told| part.estimate(&whole, channels, rate_hz);
    let each = [estimate(&first), estimate(&second)];
    let is_told = each.iter().all(|half| (0..half.parameters.len()).any(|p| half.determines(p)));
    let estimate = estimate(&whole);
    Run {
        information: Information { known: estimate.known.clone(), undetermined: Vec::new() },
        remedies: remedies(&whole, rate_hz),
        estimate,
        halves: is_told.then_some(Halves { split: Split::FirstAndSecond, each }),
        motion: None,
        findings,
        besides: Vec::new(),
    }
}

impl Told {
    /// Parameters as it tells them; how well a mean is known is judged by the noise of the whole log.
    fn estimate(&self, whole: &Self, channels: &[Readings], rate_hz: f64) -> Estimate {
        let per_channel = COMPARED.len() + 1;
        let count = per_channel * channels.len();
        let mut out = Estimate {
            parameters: Vec::with_capacity(count),
            tolerance: Vec::with_capacity(count),
            value: Vec::with_capacity(count),
            covariance: DMatrix::zeros(count, count),
            freedom: vec![MANY; count],
            known: Vec::with_capacity(count),
        };
        for (n, channel) in channels.iter().enumerate() {
            let at = |term: Option<Term>| {
                Parameter::AtRest(AtRest { channel: channel.name.clone(), unit: channel.unit.clone(), term })
            };
            let first = n * per_channel;
            let duration_s = self.samples as f64 / rate_hz;
            let repeats = whole.fits[n].as_ref().map(|fit| repeats(fit, duration_s));
            out.parameters.push(at(None));
            out.tolerance.push(f64::INFINITY);
            out.value.push(self.means[n]);
            out.known.push(if repeats.is_some() { Known::Determined } else { Known::Not });
            out.covariance[(first, first)] = repeats.unwrap_or_default();
            let fit = self.fits[n].as_ref();
            for (i, term) in COMPARED.into_iter().enumerate() {
                let told = fit.map(|fit| fit.coefficients[term as usize]);
                let error = fit.map_or(f64::INFINITY, |fit| error(fit, term));
                out.parameters.push(at(Some(term)));
                out.tolerance.push(LN_2);
                out.value.push(told.map_or(f64::NEG_INFINITY, |c| c.value.ln()));
                out.known.push(match error {
                    error if !error.is_finite() => Known::Not,
                    error if error > WEAKLY * LN_2 => Known::Weakly,
                    _ => Known::Determined,
                });
                let Some(fit) = fit.filter(|_| error.is_finite()) else { continue };
                for (j, other) in COMPARED.into_iter().enumerate().take(i + 1) {
                    let covariance = error * self::error(fit, other) * correlation(fit, term, other);
                    if covariance.is_finite() {
                        out.covariance[(first + 1 + i, first + 1 + j)] = covariance;
                        out.covariance[(first + 1 + j, first + 1 + i)] = covariance;
                    }
                }
            }
        }
        out
    }
}

/// Standard error of a coefficient's logarithm, from the ends of its interval; infinite where it is not
/// supported.
fn error(fit: &Fit, term: Term) -> f64 {
    let coefficient = fit.coefficients[term as usize];
    match coefficient.supported() {
        true => (fit.covariance[term as usize][term as usize]).sqrt() / (2.0 * coefficient.value.powi(2)),
        false => f64::INFINITY,
    }
}

fn correlation(fit: &Fit, a: Term, b: Term) -> f64 {
    let [a, b] = [a as usize, b as usize];
    let deviations = (fit.covariance[a][a] * fit.covariance[b][b]).sqrt();
    if a == b { 1.0 } else { (fit.covariance[a][b] / deviations).clamp(-0.99, 0.99) }
}

/// Variance of a mean over some time about the next: the Allan variance at that time, raised so that ±1.96
/// of its root hold 95 % although its laws are estimates themselves. A flicker or walk too faint to be
/// told counts as much as the curve makes of it: the mean of a log shows it before its curve does. What
/// drifts in a straight line does not repeat: it is no part of it.
fn repeats(fit: &Fit, duration_s: f64) -> f64 {
    let is_in_it = |term: Term| term != Term::Ramp && fit.coefficients[term as usize].supported();
    let laws = TERMS.map(|term| if is_in_it(term) { term.variance(duration_s) } else { 0.0 });
    let mut squares = fit.squares();
    squares[Term::Ramp as usize] = 0.0;
    let variance = law::variance(&squares, duration_s);
    let pairs = (0..5).flat_map(|i| (0..5).map(move |j| (i, j)));
    let of_variance: f64 = pairs.map(|(i, j)| laws[i] * fit.covariance[i][j] * laws[j]).sum();
    let freedom = 2.0 * variance * variance / of_variance;
    let freedom = if freedom.is_finite() { freedom.clamp(1.0, MANY) } else { 1.0 };
    variance * (t_quantile(0.975, freedom) / TO_THE_END).powi(2)
}

/// Lengths of a log that would know well each law that this one shows and does not know; of a law that none of its
/// channels shows, one as large as it leaves open.
fn remedies(whole: &Told, rate_hz: f64) -> Vec<Remedy> {
    let length = |fit: &Fit, term: Term, shows: bool| {
        let mut squares = fit.squares();
        if !shows {
            squares[term as usize] = fit.coefficients[term as usize].ci95[1].powi(2);
        }
        let lengths = (1..=DOUBLED).map(|power| whole.samples << power);
        let mut known = lengths.map(|samples| (samples, expected_errors(&squares, rate_hz, samples)));
        known.find(|(_, errors)| errors[term as usize] <= WEAKLY * LN_2).map(|(samples, _)| samples)
    };
    let needed = |term: &Term| {
        let term = *term;
        let is_unknown = |fit: &&Fit| error(fit, term) > WEAKLY * LN_2;
        let of = |shows: bool| {
            let unknown = whole.fits.iter().flatten().filter(is_unknown);
            let alike = unknown.filter(|fit| fit.coefficients[term as usize].supported() == shows);
            Some((alike.filter_map(|fit| length(fit, term, shows)).max()?, shows))
        };
        let (samples, shows) = of(true).or_else(|| of(false))?;
        Some(Remedy::Longer { term, shows, duration_s: samples as f64 / rate_hz, to: TO_THE_END * WEAKLY * LN_2 })
    };
    [Term::White, Term::Flicker, Term::Walk].iter().filter_map(needed).collect()
}
