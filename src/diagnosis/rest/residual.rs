//! Whether a model leaves noise: in frequency by bands, in time by the whitened residual; and where it does not.

use std::f64::consts::PI;

use super::channel::{Channel, Fitted};
use super::jump;
use super::telegraph::Telegraph;
use crate::diagnosis::remainder::REAL;
use crate::diagnosis::verdict::Stretch;
use crate::numerics::cosine;
use crate::numerics::special::{chi_squared_above, discoveries, normal_cdf};

/// Power may differ from the model's by this share before a real sensor counts as misdescribed; no datasheet is better.
pub(super) const TOLERANCE: f64 = 0.15;
/// False discoveries among the stretches named.
const RATE: f64 = 0.01;

/// What is left of a channel when its model is taken off.
#[derive(Debug, Clone, Default)]
pub(super) struct Residual {
    /// Smallest corrected probability that bands, stretches of time and single samples are noise as modelled.
    pub(super) p_value: f64,
    /// The same of stretches of time and single samples alone.
    pub(super) p_value_in_time: f64,
    /// Angles θ = πk/(2N) of the bands whose corrected probability is below the level of a verdict.
    pub(super) failing: Vec<f64>,
    pub(super) time_s: Vec<Stretch>,
    pub(super) frequency_hz: Vec<Stretch>,
    /// Least and most power over that modelled among the stretches of time.
    pub(super) power: [f64; 2],
    /// Time and size (in standard deviations) of a single reading that no noise of this law would bring.
    pub(super) outlier: Option<(f64, f64)>,
    /// Time of a step that no noise of this law would take.
    pub(super) jump: Option<f64>,
    /// Hops between two levels that a Gaussian drift does not make.
    pub(super) telegraph: Option<Telegraph>,
    /// Frequency below which the model has more power than there is, and the share of it that there is.
    pub(super) fading: Option<[f64; 2]>,
    /// Change of the noise's power from end to end over its mean, where it creeps.
    pub(super) creep: Option<f64>,
    /// Whether outside the stretches named, which are the smaller part of the log, nothing is amiss.
    pub(super) only_there: bool,
}

/// Judges a fitted model. With `tolerance` zero even the smallest deviation counts.
pub(super) fn residual(channel: &Channel, fitted: &Fitted, tolerance: f64) -> Residual {
    let (mut of_bands, mut centres, frequency_hz) = bands(channel, fitted, tolerance);
    let slowest = from_below(fitted, tolerance);
    of_bands.extend(slowest.iter().map(|s| s.p_value));
    centres.extend(slowest.iter().map(|s| 0.5 * s.below));
    let mut white = fitted.residual.to_vec();
    white[0] = 0.0;
    for (bin, variance) in fitted.bins.iter().zip(&fitted.variances) {
        white[bin.from..bin.to].iter_mut().for_each(|c| *c /= variance.sqrt());
    }
    let innovations = cosine::invert(&white);
    let count = innovations.len() as f64;
    // A step in standard deviations: readings coarser than their noise are not normal, and may lie half a step off.
    let unaveraged = channel.step.filter(|_| channel.together == 1);
    let step = unaveraged.map_or(0.0, |q| q / fitted.white().0.max(f64::MIN_POSITIVE).sqrt());
    let fourth = if step > 1.0 { innovations.iter().map(|v| v.powi(4)).sum::<f64>() / count } else { 3.0 };
    let (of_time, means, time_s) = stretches(channel, &innovations, fourth, tolerance);
    let (at, largest) =
        innovations.iter().enumerate().fold((0, 0.0f64), |m, (n, v)| if v.abs() > m.1 { (n, v.abs()) } else { m });
    // Coarse readings leap by whole steps anyway.
    let jump = (step < 1.0 && channel.values.len() >= 1024).then(|| jump::strongest(channel, fitted, tolerance));
    let p_jump = jump.map_or(1.0, |j| j.p_value);
    // Rounding and the ends of the record make tails a little heavier than normal: a tenth of the largest is allowed.
    let excursion = (largest - 0.5 * step) / (1.0 + tolerance);
    // A reading that is seldom one step off is rounded, not foreign.
    let one_step = step > 1.0 && largest < 1.5 * step;
    let p_outlier = if one_step { 1.0 } else { (count * 2.0 * normal_cdf(-excursion)).min(1.0) };
    // Five questions, each corrected for its own number of tests: bands, stretches, a creeping level, a jump, one reading.
    let most = |p_values: &[f64]| QUESTIONS * p_values.len() as f64 * p_values.iter().copied().fold(1.0, f64::min);
    let creeping = creep(&innovations, fourth, tolerance);
    let [p_outlier, p_jump, p_creep] = [p_outlier, p_jump, creeping.1].map(|p| QUESTIONS * p);
    let in_time = most(&of_time).min(p_outlier).min(p_jump).min(p_creep);
    let smallest = most(&of_bands).min(in_time);
    let tests = QUESTIONS * of_bands.len() as f64;
    let failing: Vec<f64> =
        centres.iter().zip(&of_bands).filter(|(_, p)| **p * tests < REAL).map(|(c, _)| *c).collect();
    let least = slowest.iter().filter(|s| s.share < 1.0).min_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let fading = least.filter(|s| s.p_value * tests < REAL);
    let amiss = of_time.iter().filter(|p| **p * QUESTIONS * (of_time.len() as f64) < REAL).count();
    Residual {
        p_value: smallest.min(1.0),
        p_value_in_time: in_time.min(1.0),
        jump: jump.filter(|_| p_jump < REAL).map(|j| j.at as f64 / channel.rate_hz),
        telegraph: None,
        fading: fading.map(|s| [s.below * channel.rate_hz / PI, s.share]),
        creep: (p_creep < REAL).then_some(creeping.0),
        only_there: failing.is_empty() && p_outlier.min(p_jump).min(p_creep) >= REAL && 4 * amiss <= of_time.len(),
        failing,
        time_s,
        frequency_hz,
        power: means.iter().fold([f64::INFINITY, 0.0], |[low, high], m| [low.min(*m), high.max(*m)]),
        outlier: (p_outlier < REAL).then_some((at as f64 / channel.rate_hz, largest)),
    }
}

/// Questions that are asked of what is left.
const QUESTIONS: f64 = 5.0;

/// Change of power from end to end along a straight line, over its mean, and the probability of as much by chance beyond a
/// `tolerance` at either end.
fn creep(innovations: &[f64], fourth: f64, tolerance: f64) -> (f64, f64) {
    let count = innovations.len() as f64;
    let sum: f64 = innovations.iter().enumerate().map(|(n, v)| ((n as f64 + 0.5) / count - 0.5) * v * v).sum();
    let change = 12.0 * sum / count;
    let deviation = (12.0 * (fourth - 1.0).max(0.05) / count).sqrt();
    let beyond = (change.abs() - 2.0 * tolerance).max(0.0) / deviation;
    (change, 2.0 * normal_cdf(-beyond))
}

/// Two-sided probability that a mean of `count` squares of unit variance is this far from one, beyond the tolerance.
fn off(mean: f64, count: f64, tolerance: f64) -> f64 {
    let high = chi_squared_above(count * mean / (1.0 + tolerance), count);
    let low = 1.0 - chi_squared_above(count * mean * (1.0 + tolerance), count);
    (2.0 * high.min(low)).min(1.0)
}

fn named(p_values: &[f64], at: impl Fn(usize) -> Stretch) -> Vec<Stretch> {
    let found = discoveries(p_values, RATE);
    let mut out: Vec<Stretch> = Vec::new();
    for stretch in (0..p_values.len()).filter(|i| found[*i]).map(at).filter(|s| s.excess > 1.0) {
        match out.last_mut() {
            Some(last) if (last.to - stretch.from).abs() <= 1e-9 * stretch.to.abs() => {
                last.to = stretch.to;
                last.excess = last.excess.max(stretch.excess);
            }
            _ => out.push(stretch),
        }
    }
    out
}

/// All coefficients below an angle together.
struct FromBelow {
    /// Of the first one that is not in.
    below: f64,
    p_value: f64,
    /// Power over that modelled.
    share: f64,
}

/// From the slowest coefficient up to every octave: what a law has too much of, or too little, over decades shows in none
/// of the narrow bands, of which each holds few coefficients there.
fn from_below(fitted: &Fitted, tolerance: f64) -> Vec<FromBelow> {
    let (mut sum, mut count, mut next) = (0.0, 0.0, 16.0);
    let mut out = Vec::new();
    for (bin, variance) in fitted.bins.iter().zip(&fitted.variances) {
        sum += (bin.sum[0] + bin.sum[1]) / variance;
        count += bin.count[0] + bin.count[1];
        if count >= next {
            // The middle of a bin lies half its width below its end.
            let below = bin.theta * bin.to as f64 / (0.5 * (bin.from + bin.to - 1) as f64);
            out.push(FromBelow { below, p_value: off(sum / count, count, tolerance), share: sum / count });
            next = 2.0 * count;
        }
    }
    out
}

/// Probability, angle of the centre, and the bands named.
fn bands(channel: &Channel, fitted: &Fitted, tolerance: f64) -> (Vec<f64>, Vec<f64>, Vec<Stretch>) {
    // Bands of at least eight coefficients, a third wide.
    let mut bands: Vec<(usize, usize, f64, f64)> = Vec::new();
    for (bin, variance) in fitted.bins.iter().zip(&fitted.variances) {
        let power = (bin.sum[0] + bin.sum[1]) / variance;
        match bands.last_mut() {
            Some((from, to, sum, count)) if *count < 8.0 || (bin.to as f64) < 1.33 * *from as f64 => {
                *to = bin.to;
                *sum += power;
                *count += bin.count[0] + bin.count[1];
            }
            _ => bands.push((bin.from, bin.to, power, bin.count[0] + bin.count[1])),
        }
    }
    let p_values: Vec<f64> = bands.iter().map(|b| off(b.2 / b.3, b.3, tolerance)).collect();
    let to_hz = channel.rate_hz / (2 * channel.values.len()) as f64;
    let named = named(&p_values, |i| Stretch {
        from: bands[i].0 as f64 * to_hz,
        to: bands[i].1 as f64 * to_hz,
        excess: bands[i].2 / bands[i].3,
    });
    let per_coefficient = std::f64::consts::PI / (2 * channel.values.len()) as f64;
    let centres = bands.iter().map(|b| (b.0 + b.1 - 1) as f64 / 2.0 * per_coefficient).collect();
    (p_values, centres, named)
}

/// Probability, mean square and the stretches named; `fourth` is the fourth moment of the innovations.
fn stretches(
    channel: &Channel,
    innovations: &[f64],
    fourth: f64,
    tolerance: f64,
) -> (Vec<f64>, Vec<f64>, Vec<Stretch>) {
    // A mean square of n values scatters as that of fewer normal ones where tails are heavy.
    let worth = 2.0 / (fourth - 1.0).max(0.05);
    let (mut all, mut powers, mut shown) = (Vec::new(), Vec::new(), Vec::new());
    // Short stretches show a burst, long ones a level that creeps.
    for parts in [64, 16, 4] {
        let count = innovations.len();
        let parts = (count / 64).clamp(1, parts);
        let edges: Vec<usize> = (0..=parts).map(|i| i * count / parts).collect();
        let means: Vec<(f64, f64)> = edges
            .windows(2)
            .map(|w| {
                let part = &innovations[w[0]..w[1]];
                (part.iter().map(|v| v * v).sum::<f64>() / part.len() as f64, part.len() as f64 * worth)
            })
            .collect();
        let p_values: Vec<f64> = means.iter().map(|(mean, n)| off(*mean, *n, tolerance)).collect();
        let silent = shown.is_empty();
        if silent {
            shown = named(&p_values, |i| Stretch {
                from: edges[i] as f64 / channel.rate_hz,
                to: edges[i + 1] as f64 / channel.rate_hz,
                excess: means[i].0,
            });
        }
        all.extend(p_values);
        if powers.is_empty() || silent && !shown.is_empty() {
            powers = means.into_iter().map(|m| m.0).collect();
        }
    }
    (all, powers, shown)
}
