//! Popcorn noise: a bias that hops between a few levels has the spectrum of a memory of finite
//! length, but not its law.
//!
//! Both have a Lorentzian spectrum, so nothing of second order tells them apart. Their likelihoods
//! do: a chain of two, three or four levels in white noise (levels, dwells and white noise by
//! expectation–maximisation, Rabiner 1989) against the Gaussian laws and slow curves fitted to the
//! same values. Where the Gaussian model is true, any other fixed model gains more than ln c over
//! it with probability below 1/c (the mean of a likelihood ratio is one), and the Gaussian one is
//! fitted too; for its own fitted numbers the chain pays ½ ln n each (Schwarz 1978). Not for
//! readings rounded coarser than their noise: those hop between counts anyway.

use rand::RngExt;

use super::block_means;
use super::cause::Cause;
use super::chain::{Chain, climb};
use super::channel::{Addition, Channel, Fitted, Term};
use super::slow::{is_slow, slow_part};
use super::spectrum::Law;
use crate::numerics::order;
use crate::rng::{Philox, Stream};

/// Fewer blocks hold too few dwells.
const FEWEST: usize = 256;
/// Chains that are tried: of two, three and four levels.
const TRIED: f64 = 3.0;
/// Simulated recordings that a power is read off, and the most blocks in each.
pub(super) const REPLICAS: u64 = 20;
const LONGEST: usize = 1 << 13;

/// A bias that hops between levels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Telegraph {
    /// Levels above the lowest, from it up, in the channel's scale.
    pub(super) levels: Vec<f64>,
    /// Mean time at each, in samples.
    pub(super) dwell: Vec<f64>,
    /// States how often it hops.
    pub(super) hops: usize,
    /// That a Gaussian drift as fitted looks so much like hops, at most.
    pub(super) p_value: f64,
    /// States whether it hops about the slow course that a column or time gives it, which stands.
    pub(super) about_course: bool,
}

/// Samples averaged into one value: a quarter of the time over which white noise must be averaged
/// to show the drift.
fn together(fitted: &Fitted, count: usize) -> usize {
    let white = fitted.white().0;
    let drifts = fitted.bins.iter().zip(&fitted.variances).filter(|(_, v)| **v > 2.0 * white);
    let theta = drifts.map(|(b, _)| b.theta).fold(0.0, f64::max).max(fitted.bins[0].theta);
    ((0.125 / theta) as usize).clamp(1, (count / (4 * FEWEST)).max(1))
}

/// Fits a drift to blocks of a recording, and chains to the same values; the best chain, its dwells
/// in blocks. `None` where the values have no two sides.
fn contest(own: &Channel, terms: Vec<Term>) -> Option<Telegraph> {
    contest_about(own, terms, 0)
}

/// The same of values from which as many curves were taken before, at the strengths that suit the
/// Gaussian model best: the chain pays for each as for a number of its own.
fn contest_about(own: &Channel, terms: Vec<Term>, curves: usize) -> Option<Telegraph> {
    let gaussian = own.fit(terms);
    // The mean, which the cosine coefficients leave out, has the variance of the slowest of them.
    let known = gaussian.log_likelihood() - 0.5 * gaussian.variances.first()?.ln();
    let mut course = slow_part(&gaussian);
    course.iter_mut().zip(gaussian.mean_curve(own.values.len())).for_each(|(s, c)| *s += c);
    let white = gaussian.white().0;
    let rivals = [
        hopping::<2>(&own.values, &course, white),
        hopping::<3>(&own.values, &course, white),
        hopping::<4>(&own.values, &course, white),
    ];
    let (gain, best) = rivals.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let gain = gain - 0.5 * curves as f64 * (own.values.len() as f64).ln();
    Some(Telegraph { p_value: (TRIED * (known - gain).exp()).min(1.0), ..best })
}

/// Fits a chain with this number of levels; returns it with its log-likelihood, less the penalty for its parameters.
fn hopping<const LEVELS: usize>(values: &[f64], course: &[f64], white: f64) -> Option<(f64, Telegraph)> {
    let mut sorted = course.to_vec();
    order::sort(&mut sorted);
    let (least, most) = (*sorted.first()?, *sorted.last()?);
    // As many values in each part, or parts as wide as one another.
    let shares = || (1..LEVELS).map(|k| k as f64 / LEVELS as f64);
    let bounds = [
        shares().map(|s| sorted[(s * sorted.len() as f64) as usize]).collect::<Vec<f64>>(),
        shares().map(|s| least + s * (most - least)).collect(),
    ];
    let starts = bounds.iter().filter_map(|b| Chain::<LEVELS>::divided(values, course, b, white));
    let climbed = starts.map(|start| climb(start, values, 0.5 * white));
    let (chain, expected) = climbed.max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))?;
    // Levels, what leaves them, white noise.
    let numbers = (2 * LEVELS + 1) as f64;
    let mut upward: Vec<usize> = (0..LEVELS).collect();
    order::sort_by_key(&mut upward, |k| chain.level[*k]);
    let found = Telegraph {
        levels: upward.iter().map(|k| chain.level[*k] - chain.level[upward[0]]).collect(),
        dwell: upward.iter().map(|k| 1.0 / chain.leave[*k]).collect(),
        hops: expected.changes(),
        p_value: 1.0,
        about_course: false,
    };
    Some((expected.log_likelihood - 0.5 * numbers * (values.len() as f64).ln(), found))
}

/// Returns whether readings are too coarse for a law of the values between the steps.
fn coarse(channel: &Channel, fitted: &Fitted) -> bool {
    channel.together == 1 && channel.step.is_some_and(|q| q * q > fitted.white().0)
}

/// The hops that describe a channel better than its drift as fitted does; `None` where it has no
/// drift or is coarse.
pub(super) fn hops(channel: &Channel, fitted: &Fitted) -> Option<Telegraph> {
    let count = channel.values.len();
    let drifts = |t: &Term| match &t.addition {
        Addition::Law(Law::Markov(_) | Law::Walk | Law::Flicker) => true,
        Addition::Law(_) => false,
        Addition::Curves(_) => is_slow(t, channel),
    };
    if coarse(channel, fitted) || count < FEWEST || !fitted.terms.iter().any(drifts) {
        return None;
    }
    let asked = Asked { channel, fitted, block: together(fitted, count) };
    let is_course = |t: &Term| is_slow(t, channel) && matches!(t.addition, Addition::Curves(_));
    let is_step = |t: &Term| t.cause == Cause::Jump;
    // What stays under either model, such as a pickup, is taken off; a step is a hop.
    let whole = asked.hops(|t| drifts(t) || is_step(t));
    // Hops about a temperature or a warm-up are no levels until that is taken off, too.
    let law_drifts = |t: &Term| drifts(t) && !is_course(t);
    let has_both = fitted.terms.iter().any(law_drifts) && fitted.terms.iter().any(is_course);
    let about = has_both.then(|| asked.hops(|t| law_drifts(t) || is_step(t))).flatten();
    let about = about.map(|t| Telegraph { about_course: true, ..t });
    let tried = if has_both { 2.0 } else { 1.0 };
    let best = whole.into_iter().chain(about).min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    Some(Telegraph { p_value: (tried * best.p_value).min(1.0), ..best })
}

/// A channel that is asked for hops, on means of blocks.
struct Asked<'a> {
    channel: &'a Channel,
    fitted: &'a Fitted,
    block: usize,
}

impl Asked<'_> {
    /// The hops in place of the terms that `moves` holds for; other curves are taken off before.
    fn hops(&self, moves: impl Fn(&Term) -> bool) -> Option<Telegraph> {
        let Self { channel, fitted, block } = *self;
        let mut rest = channel.values.clone();
        let mut slow = 0;
        for (index, term) in fitted.terms.iter().enumerate().filter(|(_, t)| !moves(t)) {
            if let Addition::Curves(curves) = &term.addition {
                for (curve, (amplitude, _)) in curves.iter().zip(fitted.amplitudes_of(index)) {
                    rest.iter_mut().zip(curve.values.iter()).for_each(|(r, v)| *r -= amplitude * v);
                }
                slow += if is_slow(term, channel) { curves.len() } else { 0 };
            }
        }
        let own = block_means::channel(channel, &rest, block);
        let kept = fitted.terms.iter().filter(|t| moves(t) || matches!(t.addition, Addition::Law(_)));
        let terms = kept.filter_map(|t| block_means::term(t, block));
        let found = contest_about(&own, terms.collect(), slow)?;
        Some(Telegraph {
            levels: found.levels.iter().map(|l| l * own.scale).collect(),
            dwell: found.dwell.iter().map(|d| d * block as f64).collect(),
            ..found
        })
    }
}

/// In how many of [`REPLICAS`] recordings hops of the strength and memory of a fitted Gauss–Markov
/// process would have been told from it at this probability; `None` where another drift acts too.
/// Of a long recording a part is simulated: then it is at least as many.
pub(super) fn power(channel: &Channel, fitted: &Fitted, p_value: f64) -> Option<usize> {
    let index = fitted.terms.iter().position(|t| matches!(t.addition, Addition::Law(Law::Markov(_))))?;
    let others = fitted.terms.iter().enumerate().filter(|(i, t)| *i != index && t.cause != Cause::BandLimit);
    if coarse(channel, fitted) || others.count() > 0 {
        return None;
    }
    let block = together(fitted, channel.values.len());
    let memory = fitted.terms[index].searched / block as f64;
    let size = fitted.strength_of(index).0.sqrt();
    let noise = (fitted.white().0 / block as f64).sqrt();
    let count = (channel.values.len() / block).min(LONGEST);
    let detected = (0..REPLICAS).filter(|replica| {
        let mut rng = Philox::new(1, *replica, Stream::Host);
        let mut level = size;
        let values: Vec<f64> = (0..count)
            .map(|_| {
                // Hops at a rate of 1/2T between levels ±σ: correlation e^(−t/T).
                if rng.random::<f64>() < 0.5 * (1.0 - (-1.0 / memory).exp()) {
                    level = -level;
                }
                level + noise * rng.normal()
            })
            .collect();
        let own = Channel::new(&channel.name, &values, channel.rate_hz / block as f64);
        let law = Term { addition: Addition::Law(Law::Markov(memory)), ..fitted.terms[index].clone() };
        contest(&own, vec![law]).is_some_and(|c| c.p_value < p_value)
    });
    Some(detected.count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel;

    fn p_value(values: &[f64], terms: Vec<Term>) -> f64 {
        let channel = Channel::new("x", values, 1.0);
        let fitted = channel.fit(terms);
        hops(&channel, &fitted).map_or(1.0, |t| t.p_value)
    }

    fn law(cause: Cause, law: Law) -> Term {
        let searched = if let Law::Markov(memory) = law { memory } else { 0.0 };
        Term { cause, addition: Addition::Law(law), searched, column: None }
    }

    fn relaxation(count: usize, memory: f64, rng: &mut Philox) -> Vec<f64> {
        let keep = (-1.0 / memory).exp();
        let mut state = rng.normal();
        (0..count)
            .map(|_| {
                state = keep * state + (1.0 - keep * keep).sqrt() * rng.normal();
                state
            })
            .collect()
    }

    /// Equal and unequal dwells, mean zero and variance one where equal.
    fn telegraph(count: usize, dwell: [f64; 2], rng: &mut Philox) -> Vec<f64> {
        let mut side = 0;
        (0..count)
            .map(|_| {
                if rng.random::<f64>() < 1.0 / dwell[side] {
                    side = 1 - side;
                }
                2.0 * side as f64 - 1.0
            })
            .collect()
    }

    #[test]
    fn a_gaussian_drift_is_not_taken_for_hops() {
        // Memories of 4 to 2000 samples, a fifth to five times the noise; walks and sums of
        // relaxations (flicker).
        let all: Vec<(u64, f64)> = parallel::map_members(0..500, |seed| {
            let mut rng = Philox::new(41, seed, Stream::Host);
            let size = 0.2 * 25f64.powf(rng.random::<f64>());
            let memory = 4.0 * 500f64.powf(rng.random::<f64>());
            let count = 4000;
            let (drift, term) = match seed % 5 {
                0 => {
                    let mut sum = 0.0;
                    let step = size / (count as f64 / 6.0).sqrt();
                    let walk = (0..count)
                        .map(|_| {
                            sum += step * rng.normal();
                            sum
                        })
                        .collect();
                    (walk, law(Cause::RandomWalk, Law::Walk))
                }
                1 => {
                    let mut sum = vec![0.0; count];
                    for octave in 0..14 {
                        let part = relaxation(count, 2f64.powi(octave), &mut rng);
                        sum.iter_mut().zip(part).for_each(|(s, p)| *s += size / 14f64.sqrt() * p);
                    }
                    (sum, law(Cause::FlickerNoise, Law::Flicker))
                }
                _ => {
                    let mut drift = relaxation(count, memory, &mut rng);
                    drift.iter_mut().for_each(|d| *d *= size);
                    (drift, law(Cause::GaussMarkov, Law::Markov(memory)))
                }
            };
            let values: Vec<f64> = drift.into_iter().map(|d| d + rng.normal()).collect();
            (seed, p_value(&values, vec![term]))
        });
        let alarms: Vec<(u64, f64)> = all.into_iter().filter(|(_, p)| *p < 0.01).collect();
        // The bound holds for every recording, so 500 · 0.01 at most are expected; in fact the
        // penalty keeps it far below.
        assert!(alarms.len() <= 1, "{alarms:?}");
    }

    #[test]
    fn hops_among_three_levels_are_found_with_their_levels() {
        let found = parallel::map_members(0..20, |seed| {
            let mut rng = Philox::new(45, seed, Stream::Host);
            let mut side = 0;
            let values: Vec<f64> = (0..6000)
                .map(|_| {
                    if rng.random::<f64>() < 0.01 {
                        side = (side + 1 + usize::from(rng.random::<bool>())) % 3;
                    }
                    [-1.0, 0.2, 1.0][side] + rng.normal()
                })
                .collect();
            let channel = Channel::new("x", &values, 1.0);
            let fitted = channel.fit(vec![law(Cause::GaussMarkov, Law::Markov(66.0))]);
            let found = hops(&channel, &fitted).filter(|t| t.p_value < 1e-3)?;
            // A level rests on a third of the values: it has a standard error of 0.02, and the step
            // from one to the next takes a block or two.
            let near = |level: f64, planted: f64| (level * channel.scale - planted).abs() < 0.15;
            matches!(found.levels[..], [_, middle, highest] if near(middle, 1.2) && near(highest, 2.0)).then_some(())
        });
        let found = found.iter().flatten().count();
        assert!(found >= 19, "{found} of 20");
    }

    #[test]
    fn hops_are_found_at_half_the_noise_and_their_power_is_predicted() {
        let found = |size: f64, dwell: [f64; 2], count: usize| -> usize {
            let found = parallel::map_members(0..20, |seed| {
                let mut rng = Philox::new(42, seed, Stream::Host);
                let hops = telegraph(count, dwell, &mut rng);
                let values: Vec<f64> = hops.into_iter().map(|h| size * h + rng.normal()).collect();
                let memory = 1.0 / (1.0 / dwell[0] + 1.0 / dwell[1]);
                p_value(&values, vec![law(Cause::GaussMarkov, Law::Markov(memory))]) < 1e-3
            });
            found.iter().filter(|found| **found).count()
        };
        for (size, dwell) in [(0.5, [100.0; 2]), (1.0, [10.0; 2]), (1.0, [1000.0, 100.0]), (3.0, [300.0; 2])] {
            let found = found(size, dwell, 4000);
            assert!(found >= 19, "{size} {dwell:?}: {found} of 20");
        }
        // Negative control: a tenth of the noise in dwells of ten shows to nobody, and the power
        // says so.
        for (size, dwell) in [(0.1, 10.0), (0.35, 100.0), (1.0, 100.0)] {
            let mut rng = Philox::new(43, 0, Stream::Host);
            let drift = relaxation(4000, dwell / 2.0, &mut rng);
            let values: Vec<f64> = drift.into_iter().map(|d| size * d + rng.normal()).collect();
            let channel = Channel::new("x", &values, 1.0);
            let mut fitted = channel.fit(vec![law(Cause::GaussMarkov, Law::Markov(dwell / 2.0))]);
            // As planted, not as estimated.
            fitted.strengths.values = [1.0, size * size].map(|v| v / channel.scale.powi(2)).to_vec();
            let (expected, found) = (power(&channel, &fitted, 1e-3).unwrap_or(0), found(size, [dwell; 2], 4000));
            // Two counts of twenty differ by seven or more by chance in one of a hundred.
            assert!(expected.abs_diff(found) <= 7, "{size}: predicted {expected}, found {found}");
        }
        assert!(found(0.1, [10.0; 2], 4000) == 0);
    }
}
