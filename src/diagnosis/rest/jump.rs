//! Drift that comes in jumps: a bias that leaps once, or between two levels, has the spectrum of a
//! walk or of a memory.
//!
//! A law of noise is Gaussian at every time, a jump is not: the best-placed step is far larger than
//! the law allows, or one step alone describes what a law was named for. Nothing here has an entry
//! in the library; it keeps laws from being named for what they are not.

use std::f64::consts::PI;

use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Fitted, Term};
use super::slow::is_slow;
use super::spectrum::Law;
use super::standing::CLOSE;
use crate::numerics::cosine;
use crate::numerics::special::normal_cdf;
use crate::remainder::REAL;

/// Places at which the variance of a step's size is worked out; between them it is smooth.
const PLACES: usize = 512;
/// Coefficients that are summed one by one; beyond, a step's ripples average out.
const EXACT: usize = 1024;

/// Twice the log-likelihood, less what the numbers cost, by which a step must describe a channel better than a drift.
/// In a simulation of walks and flickers from faint to strong (4096 samples, 2000 draws of each size), the worst size
/// reached it about once in a thousand draws, and half of the steps of ten standard errors did.
const SURE: f64 = 18.0;

/// Power may differ from the model's by this share before a real sensor counts as misdescribed; no
/// datasheet is better.
pub(super) const TOLERANCE: f64 = 0.15;

/// The step that stands out most from a fitted model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jump {
    /// First sample after it.
    pub(super) at: usize,
    /// That steps so large, or so many large ones, come by chance under the model.
    pub(super) p_value: f64,
}

/// Sizes of steps at every place over their standard errors, by generalised least squares under the
/// model.
fn sizes(channel: &Channel, fitted: &Fitted) -> Vec<f64> {
    let count = channel.values.len();
    let mut weighted = fitted.residual.to_vec();
    weighted[0] = 0.0;
    let variances = fitted.safe_variances();
    for (bin, variance) in fitted.bins.iter().zip(&variances) {
        weighted[bin.from..bin.to].iter_mut().for_each(|c| *c /= variance);
    }
    let weighted = cosine::invert(&weighted);
    // Squared cosine coefficients of a step at n: sin²(πkn/N)/(2N sin²θ), θ = πk/2N.
    let information = |place: usize| -> f64 {
        let mut sum = 0.0;
        for (bin, variance) in fitted.bins.iter().zip(&variances) {
            let ripple = |k: usize| (PI * (k * place) as f64 / count as f64).sin().powi(2);
            let each = |theta: f64| 1.0 / (2.0 * count as f64 * theta.sin().powi(2) * variance);
            let theta_of = |k: usize| PI * k as f64 / (2 * count) as f64;
            sum += if bin.to <= EXACT {
                (bin.from..bin.to).map(|k| ripple(k) * each(theta_of(k))).sum::<f64>()
            } else {
                0.5 * (bin.to - bin.from) as f64 * each(bin.theta)
            };
        }
        sum
    };
    let margin = count / 64;
    let places: Vec<usize> = (0..=PLACES).map(|i| margin + i * (count - 2 * margin) / PLACES).collect();
    let known: Vec<f64> = places.iter().map(|p| information(*p)).collect();
    let mut after: f64 = weighted[margin..].iter().sum();
    let mut out = Vec::with_capacity(count - 2 * margin);
    for (span, ends) in places.windows(2).zip(known.windows(2)) {
        for (n, gone) in weighted[span[0]..span[1]].iter().enumerate() {
            let fraction = n as f64 / (span[1] - span[0]) as f64;
            let information = ends[0] + fraction * (ends[1] - ends[0]);
            out.push(after / information.max(f64::MIN_POSITIVE).sqrt());
            after -= gone;
        }
    }
    out
}

/// Looks for the step that stands out most, from a noise that wanders, too, where the model has none: one too faint
/// to be named is there in every sensor, and its largest step is no jump. Power may exceed the model's by `tolerance`.
pub(super) fn strongest(channel: &Channel, fitted: &Fitted, tolerance: f64) -> Jump {
    let jump = farthest(channel, fitted, tolerance);
    if jump.p_value >= REAL || fitted.terms.iter().any(|t| is_slow(t, channel)) {
        return jump;
    }
    let with = |term: Term| channel.fit(fitted.terms.iter().cloned().chain([term]).collect());
    let step = with(term(channel, jump.at)).log_likelihood();
    let wandering = [(Cause::FlickerNoise, Law::Flicker), (Cause::RandomWalk, Law::Walk)];
    let next_to = |(cause, law): (Cause, Law)| {
        let wanders = with(Term { cause, addition: Addition::Law(law), searched: 0.0, column: None });
        // A step has a size and a place, either law a size alone.
        let is_step = 2.0 * (step - wanders.log_likelihood()) - 2.0 > SURE;
        if is_step { jump.p_value } else { farthest(channel, &wanders, tolerance).p_value }
    };
    Jump { p_value: wandering.into_iter().map(next_to).fold(jump.p_value, f64::max), ..jump }
}

/// The step that stands out most from a model as it is.
fn farthest(channel: &Channel, fitted: &Fitted, tolerance: f64) -> Jump {
    let sizes = sizes(channel, fitted);
    let margin = channel.values.len() / 64;
    let (at, largest) =
        sizes.iter().enumerate().fold((0, 0.0f64), |m, (n, z)| if z.abs() > m.1 { (n, z.abs()) } else { m });
    let Some(apart) = independence(&sizes) else { return Jump { at: at + margin, p_value: 1.0 } };
    // Between two independent places the largest of a smooth curve has a few more chances.
    let places = 4.0 * sizes.len() as f64 / apart as f64;
    let single = 2.0 * places * normal_cdf(-largest / (1.0 + tolerance).sqrt());
    Jump { at: at + margin, p_value: (2.0 * single.min(many(&sizes, apart))).min(1.0) }
}

/// Returns how far apart two steps' sizes hardly depend on one another; `None` where the recording
/// holds too few such lengths.
fn independence(sizes: &[f64]) -> Option<usize> {
    let power = |lag: usize| sizes.iter().zip(&sizes[lag..]).map(|(a, b)| a * b).sum::<f64>();
    let total = power(0).max(f64::MIN_POSITIVE);
    (0..31).map(|j| 1usize << j).take_while(|l| 30 * l < sizes.len()).find(|l| power(*l) < 0.1 * total)
}

/// Probability of tails so heavy among steps; only those `apart` count as independent.
fn many(sizes: &[f64], apart: usize) -> f64 {
    let n = sizes.len() as f64;
    let (second_moment, fourth_moment) = sizes.iter().fold((0.0, 0.0), |(s, f), z| (s + z * z, f + z.powi(4)));
    heavy_tails(n * fourth_moment / (second_moment * second_moment).max(f64::MIN_POSITIVE), n / apart as f64)
}

/// Probability of a kurtosis at least this large among `n` normal values: Anscombe & Glynn,
/// Biometrika 70, 1983.
fn heavy_tails(kurtosis: f64, n: f64) -> f64 {
    let mean = 3.0 * (n - 1.0) / (n + 1.0);
    let variance = 24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0).powi(2) * (n + 3.0) * (n + 5.0));
    let x = (kurtosis - mean) / variance.sqrt();
    let skewness = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0))
        * (6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0))).sqrt();
    let a = 6.0 + 8.0 / skewness * (2.0 / skewness + (1.0 + 4.0 / (skewness * skewness)).sqrt());
    let root = ((1.0 - 2.0 / a) / (1.0 + x * (2.0 / (a - 4.0)).sqrt()).max(f64::MIN_POSITIVE)).cbrt();
    let z = (1.0 - 2.0 / (9.0 * a) - root) / (2.0 / (9.0 * a)).sqrt();
    normal_cdf(-z)
}

/// A step at a place.
fn term(channel: &Channel, at: usize) -> Term {
    let step = (0..channel.values.len()).map(|n| if n < at { 0.0 } else { 1.0 }).collect();
    Term { cause: Cause::Jump, addition: Addition::Curves(vec![Curve::new(step)]), searched: at as f64, column: None }
}

/// A step that a model of a channel lacks, as a term: one that stands out from it (`correction` for
/// all that is tested), or describes the channel better than its slow terms.
pub(super) fn missing(channel: &Channel, fitted: &Fitted, correction: f64) -> Option<Term> {
    let coarse = channel.together == 1 && channel.step.is_some_and(|q| q * q > fitted.white().0);
    if channel.values.len() < 1024 || coarse {
        return None;
    }
    let outstanding = Some(strongest(channel, fitted, TOLERANCE)).filter(|j| j.p_value * correction < REAL);
    let better = || alone(channel, fitted).filter(|a| a.is_sure).map(|a| a.jump);
    let jump = outstanding.or_else(better)?;
    Some(term(channel, jump.at))
}

/// One step that would replace all slow terms of a channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Alone {
    pub(super) jump: Jump,
    /// States whether it is better than noise that wanders gives it by chance.
    pub(super) is_sure: bool,
}

/// The single step that describes a channel better than its own slow terms do; `None` where none
/// does.
pub(super) fn alone(channel: &Channel, fitted: &Fitted) -> Option<Alone> {
    let (slow, mut terms): (Vec<Term>, Vec<Term>) = fitted.terms.iter().cloned().partition(|t| is_slow(t, channel));
    if slow.is_empty() || channel.values.len() < 1024 {
        return None;
    }
    let jump = farthest(channel, &channel.fit(terms.clone()), 0.0);
    terms.push(term(channel, jump.at));
    // A step has a size and a place; a slow term has one or two numbers of its own.
    let numbers = |t: &Term| if matches!(t.cause, Cause::GaussMarkov | Cause::WarmUp) { 2.0 } else { 1.0 };
    let penalty = 2.0 * (2.0 - slow.iter().map(numbers).sum::<f64>());
    let gain = 2.0 * (channel.fit(terms).log_likelihood() - fitted.log_likelihood());
    (gain - penalty > CLOSE).then_some(Alone { jump, is_sure: gain - penalty > SURE })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    fn walk_fit(values: &[f64]) -> (Channel, Fitted) {
        let channel = Channel::new("x", values, 1.0);
        let walk = Term { cause: Cause::RandomWalk, addition: Addition::Law(Law::Walk), searched: 0.0, column: None };
        let fitted = channel.fit(vec![walk]);
        (channel, fitted)
    }

    #[test]
    fn a_jump_stands_out_from_a_walk_fitted_to_it_and_a_walk_does_not() {
        // Of two sizes, in standard deviations of the white noise.
        let sizes = [1.4, 3.0];
        let (mut found, mut preferred, mut alarms) = ([0; 2], [0; 2], 0);
        for member in 0..20 {
            let mut rng = Philox::new(9, member, Stream::Host);
            let after = 2001 + 100 * member as usize;
            for (s, size) in sizes.into_iter().enumerate() {
                let jump: Vec<f64> = (0..6000).map(|n| rng.normal() + if n >= after { size } else { 0.0 }).collect();
                let (channel, fitted) = walk_fit(&jump);
                found[s] += usize::from(strongest(&channel, &fitted, 0.0).p_value < 1e-3);
                preferred[s] +=
                    usize::from(alone(&channel, &fitted).is_some_and(|a| a.is_sure && a.jump.at.abs_diff(after) < 20));
            }
            let mut state = 0.0;
            let walk: Vec<f64> = (0..6000)
                .map(|_| {
                    state += 0.02 * rng.normal();
                    state + rng.normal()
                })
                .collect();
            let (channel, fitted) = walk_fit(&walk);
            alarms += usize::from(strongest(&channel, &fitted, 0.0).p_value < 0.01);
            alarms += usize::from(alone(&channel, &fitted).is_some_and(|a| a.is_sure));
        }
        // A walk fitted to a small jump takes most of it: three of twenty at this level come by
        // chance once in a million.
        assert!(found[0] >= 3 && found[1] >= 18, "{found:?} of 20 jumps stand out");
        assert!(preferred.iter().all(|p| *p >= 18), "{preferred:?} of 20 are better described by a step");
        assert!(alarms <= 1, "{alarms} alarms");
    }

    // Steps of 0.003 to 0.01 of the white noise: a walk at the edge of being seen, where a step does better by more
    // than CLOSE in two of ten.
    #[test]
    fn a_walk_at_the_edge_of_being_seen_does_not_jump() {
        let (mut better, mut alarms) = (0, 0);
        for member in 0..120 {
            let mut rng = Philox::new(10, member, Stream::Host);
            let size = [0.003, 0.005, 0.01][member as usize % 3];
            let mut state = 0.0;
            let walk: Vec<f64> = (0..4096)
                .map(|_| {
                    state += size * rng.normal();
                    state + rng.normal()
                })
                .collect();
            let (channel, fitted) = walk_fit(&walk);
            let found = alone(&channel, &fitted);
            better += usize::from(found.is_some());
            alarms += usize::from(found.is_some_and(|a| a.is_sure));
            alarms += usize::from(strongest(&channel, &channel.fit(Vec::new()), TOLERANCE).p_value < 1e-3);
        }
        assert!(better >= 12, "{better}: the control has no force");
        assert!(alarms <= 1, "{alarms} alarms");
    }
}
