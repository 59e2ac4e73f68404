//! Decides whether a model leaves noise: in frequency by bands, in time by the whitened residual;
//! and where it does not.

use std::f64::consts::PI;

use super::cause::Cause;
use super::channel::{Channel, Fitted};
use super::hump;
use super::jump;
pub(super) use super::jump::TOLERANCE;
use super::laws::SLOW;
use super::spectrum::Bin;
use super::telegraph::Telegraph;
use crate::numerics::cosine;
use crate::numerics::special::{chi_squared_survival, discoveries, normal_cdf};
use crate::remainder::REAL;
use crate::verdict::Stretch;

/// False discoveries among the stretches named.
const RATE: f64 = 0.01;

/// Holds what is left of a channel when its model is taken off.
#[derive(Debug, Clone, Default)]
pub(super) struct Residual {
    /// Smallest corrected probability that bands, stretches of time and single samples are noise as
    /// modelled.
    pub(super) p_value: f64,
    /// The same of stretches of time and single samples alone.
    pub(super) p_value_in_time: f64,
    /// Angles θ = πk/(2N) of the bands whose corrected probability is below the level of a verdict.
    pub(super) failing: Vec<f64>,
    /// The same of humps too narrow for a band.
    pub(super) humps: Vec<f64>,
    pub(super) time_s: Vec<Stretch>,
    pub(super) frequency_hz: Vec<Stretch>,
    /// Least and most power over that modelled among the stretches of time.
    pub(super) power: [f64; 2],
    /// States whether its power changes from one stretch of time to another, beyond chance and the
    /// tolerance.
    pub(super) uneven: bool,
    /// States whether it changes at once and by so much that something disturbs the sensor for a
    /// while.
    pub(super) disturbed: bool,
    /// Fourth moment over the squared second one; 3 for normal noise.
    pub(super) kurtosis: f64,
    /// Time of a step that no noise of this law would take.
    pub(super) jump: Option<f64>,
    /// Hops between levels that a Gaussian drift does not make.
    pub(super) telegraph: Option<Telegraph>,
    /// Frequency below which the model has more power than there is, and the share of it that there
    /// is.
    pub(super) fading: Option<[f64; 2]>,
    /// Change of the noise's power from end to end over its mean, where it creeps.
    pub(super) creep: Option<f64>,
    /// States whether outside the stretches named, which are the smaller part of the log, nothing
    /// is amiss.
    pub(super) only_there: bool,
}

impl Residual {
    /// Returns whether a cause stands though the channel leaps: a course that it hops about.
    pub(super) fn keeps(&self, cause: Cause) -> bool {
        self.telegraph.as_ref().is_some_and(|t| t.about_course) && !SLOW.contains(&cause)
    }
}

/// Judges a fitted model. With `tolerance` zero even the smallest deviation counts.
pub(super) fn residual(channel: &Channel, fitted: &Fitted, tolerance: f64) -> Residual {
    let (mut of_bands, mut centres, mut frequency_hz) = bands(channel, fitted, tolerance);
    let slowest = from_below(fitted, tolerance);
    of_bands.extend(slowest.iter().map(|s| s.p_value));
    centres.extend(slowest.iter().map(|s| 0.5 * s.below));
    let mut white = fitted.residual.to_vec();
    white[0] = 0.0;
    for (bin, variance) in fitted.bins.iter().zip(&fitted.safe_variances()) {
        white[bin.from..bin.to].iter_mut().for_each(|c| *c /= variance.sqrt());
    }
    let innovations = cosine::invert(&white);
    let squares = Squares::of(&innovations);
    let Stretches { p_values: of_time, powers, shown: time_s, abrupt } = stretches(channel, &squares, tolerance);
    let humps = hump::find(channel, fitted, squares.spread(), tolerance);
    let p_hump = QUESTIONS * humps.p_value;
    if p_hump < REAL && frequency_hz.is_empty() {
        frequency_hz = humps.at_hz;
    }
    // A step in standard deviations: coarse readings leap by whole steps anyway.
    let unaveraged = channel.step.filter(|_| channel.together == 1);
    let step = unaveraged.map_or(0.0, |q| q / fitted.white().0.max(f64::MIN_POSITIVE).sqrt());
    let jump = (step < 1.0 && channel.values.len() >= 1024).then(|| jump::strongest(channel, fitted, tolerance));
    let p_jump = QUESTIONS * jump.map_or(1.0, |j| j.p_value);
    // Each question is corrected for its own number of tests.
    let most = |p_values: &[f64]| QUESTIONS * p_values.len() as f64 * p_values.iter().copied().fold(1.0, f64::min);
    let creeping = creep(&squares, tolerance);
    let p_creep = QUESTIONS * creeping.1;
    let p_uneven = most(&of_time).min(p_creep);
    let uneven = p_uneven < REAL;
    // Uneven noise is a statement about the noise; what sets in at once is a disturbance, and no
    // noise at all.
    let disturbed = uneven && abrupt && step <= 1.0;
    let in_time = if disturbed { p_uneven.min(p_jump) } else { p_jump };
    let smallest = most(&of_bands).min(in_time).min(p_hump);
    let tests = QUESTIONS * of_bands.len() as f64;
    let failing: Vec<f64> =
        centres.iter().zip(&of_bands).filter(|(_, p)| **p * tests < REAL).map(|(c, _)| *c).collect();
    let least = slowest.iter().filter(|s| s.power_ratio < 1.0).min_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let fading = least.filter(|s| s.p_value * tests < REAL);
    let mismatched = of_time.iter().filter(|p| **p * QUESTIONS * (of_time.len() as f64) < REAL).count();
    Residual {
        p_value: smallest.min(1.0),
        p_value_in_time: in_time.min(1.0),
        jump: jump.filter(|_| p_jump < REAL).map(|j| j.at as f64 / channel.rate_hz),
        telegraph: None,
        fading: fading.map(|s| [s.below * channel.rate_hz / PI, s.power_ratio]),
        creep: (p_creep < REAL).then_some(creeping.0),
        humps: if p_hump < REAL { humps.centres } else { Vec::new() },
        only_there: failing.is_empty()
            && p_hump >= REAL
            && p_jump.min(p_creep) >= REAL
            && 4 * mismatched <= of_time.len(),
        failing,
        time_s,
        frequency_hz,
        power: powers.iter().fold([f64::INFINITY, 0.0], |[low, high], m| [low.min(*m), high.max(*m)]),
        uneven,
        disturbed,
        kurtosis: squares.kurtosis,
    }
}

/// Questions that are asked of what is left.
const QUESTIONS: f64 = 5.0;

/// Squares of innovations, clipped where noise of heavy tails would decide by a few readings, over
/// their mean.
struct Squares {
    clipped: Vec<f64>,
    /// Variance of one of them; 2 for the squares of normal noise that nothing clips.
    variance: f64,
    /// Of the innovations themselves, not clipped.
    kurtosis: f64,
}

/// Standard deviations, as the larger part of the values shows them, at which innovations are
/// clipped.
const CLIPPED_AT: f64 = 3.0;

impl Squares {
    fn of(innovations: &[f64]) -> Self {
        let mut sizes: Vec<f64> = innovations.iter().map(|v| v.abs()).collect();
        let count = sizes.len().max(1) as f64;
        let mut at = |part: f64| match ((sizes.len().max(1) - 1) as f64 * part) as usize {
            place if place < sizes.len() => *sizes.select_nth_unstable_by(place, f64::total_cmp).1,
            _ => 0.0,
        };
        let limit = (CLIPPED_AT * (1.4826 * at(0.5)).max(at(0.95) / 1.96)).powi(2);
        let limit = if limit > 0.0 { limit } else { f64::INFINITY };
        let (second_moment, fourth_moment) =
            innovations.iter().fold((0.0, 0.0), |(s, f), v| (s + v * v, f + v.powi(4)));
        let mut clipped: Vec<f64> = innovations.iter().map(|v| (v * v).min(limit)).collect();
        let mean = (clipped.iter().sum::<f64>() / count).max(f64::MIN_POSITIVE);
        clipped.iter_mut().for_each(|c| *c /= mean);
        let variance = clipped.iter().map(|c| (c - 1.0).powi(2)).sum::<f64>() / count;
        Self {
            clipped,
            variance: variance.max(0.05),
            kurtosis: count * fourth_moment / (second_moment * second_moment).max(f64::MIN_POSITIVE),
        }
    }

    /// Mean square of the power of 64 stretches over their squared mean: noise that grows makes
    /// neighbouring coefficients alike, so that fewer of them are independent.
    fn spread(&self) -> f64 {
        let length = self.clipped.len().div_ceil(64).max(1);
        let powers: Vec<f64> = self.clipped.chunks(length).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect();
        let (sum, squares) = powers.iter().fold((0.0, 0.0), |(s, q), p| (s + p, q + p * p));
        (powers.len() as f64 * squares / (sum * sum).max(f64::MIN_POSITIVE)).max(1.0)
    }
}

/// Change of power from end to end along a straight line, over its mean, and the probability of as
/// much by chance beyond a `tolerance` at either end.
fn creep(squares: &Squares, tolerance: f64) -> (f64, f64) {
    let count = squares.clipped.len() as f64;
    let sum: f64 = squares.clipped.iter().enumerate().map(|(n, c)| ((n as f64 + 0.5) / count - 0.5) * c).sum();
    let change = 12.0 * sum / count;
    let deviation = (12.0 * squares.variance / count).sqrt();
    let beyond = (change.abs() - 2.0 * tolerance).max(0.0) / deviation;
    (change, 2.0 * normal_cdf(-beyond))
}

/// Two-sided probability that a mean of `count` squares of unit variance is this far from one,
/// beyond the tolerance.
fn off(mean: f64, count: f64, tolerance: f64) -> f64 {
    let high = chi_squared_survival(count * mean / (1.0 + tolerance), count);
    let low = 1.0 - chi_squared_survival(count * mean * (1.0 + tolerance), count);
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

/// Bins with the variance modelled, without those where a filter leaves so little that leakage
/// decides: it comes from a few readings at either end of the log, so that neighbouring
/// coefficients are large or small together, and a mean of them scatters as one.
fn in_band(fitted: &Fitted) -> impl Iterator<Item = (&Bin, &f64)> {
    let safe = fitted.safe_variances();
    fitted.bins.iter().zip(&fitted.variances).zip(safe).filter(|((_, v), safe)| **v >= *safe).map(|(of, _)| of)
}

/// All coefficients below an angle together.
struct FromBelow {
    /// Of the first one that is not in.
    below: f64,
    p_value: f64,
    /// Power over that modelled.
    power_ratio: f64,
}

/// From the slowest coefficient up to every octave: what a law has too much of, or too little, over
/// decades shows in none of the narrow bands, of which each holds few coefficients there.
fn from_below(fitted: &Fitted, tolerance: f64) -> Vec<FromBelow> {
    let (mut sum, mut count, mut next) = (0.0, 0.0, 16.0);
    let mut out = Vec::new();
    for (bin, variance) in in_band(fitted) {
        sum += (bin.sum[0] + bin.sum[1]) / variance;
        count += bin.count[0] + bin.count[1];
        if count >= next {
            // The middle of a bin lies half its width below its end.
            let below = bin.theta * bin.to as f64 / (0.5 * (bin.from + bin.to - 1) as f64);
            out.push(FromBelow { below, p_value: off(sum / count, count, tolerance), power_ratio: sum / count });
            next = 2.0 * count;
        }
    }
    out
}

/// Probability, angle of the centre, and the bands named.
fn bands(channel: &Channel, fitted: &Fitted, tolerance: f64) -> (Vec<f64>, Vec<f64>, Vec<Stretch>) {
    // Bands of at least eight coefficients, a third wide.
    let mut bands: Vec<(usize, usize, f64, f64)> = Vec::new();
    for (bin, variance) in in_band(fitted) {
        let power = (bin.sum[0] + bin.sum[1]) / variance;
        match bands.last_mut() {
            Some((from, to, sum, count))
                if bin.from == *to && (*count < 8.0 || (bin.to as f64) < 1.33 * *from as f64) =>
            {
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

/// Holds what the power of stretches of time says.
struct Stretches {
    p_values: Vec<f64>,
    /// Of the stretches shown, over that modelled.
    powers: Vec<f64>,
    shown: Vec<Stretch>,
    /// States whether it changes by [`ABRUPT`] at once.
    abrupt: bool,
}

/// Stretches whose power differs by this factor, next to one another or on either side of one in
/// which it changes: no noise grows so fast.
const ABRUPT: f64 = 4.0;

fn stretches(channel: &Channel, squares: &Squares, tolerance: f64) -> Stretches {
    // A mean of n clipped squares scatters as that of fewer or more squares of normal values.
    let worth = 2.0 / squares.variance;
    let mut out = Stretches { p_values: Vec::new(), powers: Vec::new(), shown: Vec::new(), abrupt: false };
    let count = squares.clipped.len();
    // Short stretches show a burst, long ones a level that creeps.
    for parts in [64, 16, 4] {
        let parts = (count / 64).clamp(1, parts);
        let edges: Vec<usize> = (0..=parts).map(|i| i * count / parts).collect();
        let mean = |w: &[usize]| {
            let part = &squares.clipped[w[0]..w[1]];
            (part.iter().sum::<f64>() / part.len() as f64, part.len() as f64 * worth)
        };
        let means: Vec<(f64, f64)> = edges.windows(2).map(mean).collect();
        let p_values: Vec<f64> = means.iter().map(|(mean, n)| off(*mean, *n, tolerance)).collect();
        let differs = |a: f64, b: f64| a > ABRUPT * b || b > ABRUPT * a;
        out.abrupt |= parts > 4
            && means.windows(3).any(|w| differs(w[0].0, w[1].0) || differs(w[0].0, w[2].0) || differs(w[1].0, w[2].0));
        let silent = out.shown.is_empty();
        if silent {
            out.shown = named(&p_values, |i| Stretch {
                from: edges[i] as f64 / channel.rate_hz,
                to: edges[i + 1] as f64 / channel.rate_hz,
                excess: means[i].0,
            });
        }
        out.p_values.extend(p_values);
        if out.powers.is_empty() || silent && !out.shown.is_empty() {
            out.powers = means.into_iter().map(|m| m.0).collect();
        }
    }
    out
}
