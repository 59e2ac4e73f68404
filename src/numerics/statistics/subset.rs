//! Probabilities too small to count: subset simulation.
//!
//! The event that a response exceeds a limit is the last of a row of events, each a tenth of the
//! one before; of each, chains of states that stay inside it give a sample, and the product of the
//! parts is the probability (Au & Beck, *Probabilistic Engineering Mechanics* 16 (2001) 263). A
//! chain's next state keeps most of the random numbers of the last one; how much is set so that 44
//! of 100 moves stay inside (Papaioannou, Betz, Zwirglmaier & Straub, *Probabilistic Engineering
//! Mechanics* 41 (2015) 89). The interval is that of independent repeats.

use super::Estimate;
use crate::numerics::order;
use crate::numerics::special::t_quantile;

/// One state in this many of a sample lies inside the next event.
const ONE_IN: usize = 10;
/// Most events in a row: nothing below one in 10¹⁰ is looked for.
pub const MOST_LEVELS: usize = 10;
/// Part of the moves that should stay inside.
const ACCEPTED: f64 = 0.44;
/// Independent repeats.
pub const REPEATS: usize = 8;

/// States of which a response is computed.
pub trait Space {
    /// Random numbers of one state.
    type State: Clone;
    /// Why a response cannot be computed.
    type Error;

    /// The state of this index, independent of those of other indices.
    fn independent(&self, index: u32) -> Self::State;

    /// A state whose standard normal numbers are `kept` times those of another plus √(1 − kept²)
    /// times new ones of this index, or keep each of them with that probability: either leaves
    /// their law as it is.
    fn moved(&self, from: &Self::State, kept: f64, index: u32) -> Self::State;

    /// The response of each state; NaN where there is none.
    ///
    /// # Errors
    /// They cannot be computed.
    fn responses(&mut self, states: &[Self::State]) -> Result<Vec<f64>, Self::Error>;
}

/// The mean over repeats with Student's interval.
fn mean(values: &[f64]) -> Estimate {
    let n = values.len() as f64;
    let value = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (n - 1.0);
    let reach = t_quantile(0.975, n - 1.0) * (variance / n).sqrt();
    Estimate { value, ci95: [value - reach, value + reach] }
}

/// The same of positive numbers, with the interval carried over to the logarithm, so that it stays
/// positive.
fn positive_mean(values: &[f64]) -> Estimate {
    let Estimate { value, ci95: [low, _] } = mean(values);
    let reach = (value - low) / value;
    Estimate { value, ci95: [value * (-reach).exp(), value * reach.exp()] }
}

/// A small probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Exceedance {
    /// Probability that a response exceeds the limit; `None` where it lies below that of the last
    /// of what is exceeded: one in 10¹⁰, or more where responses have a ceiling below the limit.
    pub probability: Option<Estimate>,
    /// Responses that one state in 10, 100, … exceeds, up to the limit.
    pub exceeded: Vec<Estimate>,
    /// States whose response was computed.
    pub states: u64,
    /// States of the first samples.
    pub first: u64,
    /// Of these, those without a response.
    pub without: u64,
}

/// Finds the probability that a response exceeds a limit, from samples of `size` states.
///
/// # Errors
/// As [`Space::responses`].
pub fn exceedance<S: Space>(space: &mut S, limit: f64, size: usize) -> Result<Exceedance, S::Error> {
    let size = size.next_multiple_of(ONE_IN);
    let mut index = 0;
    let mut run = |_| Chains { space: &mut *space, limit, size, index: &mut index }.run();
    let runs: Vec<Run> = (0..REPEATS).map(&mut run).collect::<Result<_, _>>()?;
    let levels = runs.iter().map(|run| run.thresholds.len()).min().unwrap_or(0);
    let at = |level: usize| mean(&runs.iter().map(|run| run.thresholds[level]).collect::<Vec<f64>>());
    let found: Option<Vec<f64>> = runs.iter().map(|run| run.probability).collect();
    Ok(Exceedance {
        probability: found.map(|found| positive_mean(&found)),
        exceeded: (0..levels).map(at).collect(),
        states: u64::from(index),
        first: (REPEATS * size) as u64,
        without: runs.iter().map(|run| run.without).sum(),
    })
}

/// One of the repeats.
struct Run {
    probability: Option<f64>,
    thresholds: Vec<f64>,
    without: u64,
}

/// The chains of a repeat.
struct Chains<'a, S: Space> {
    space: &'a mut S,
    limit: f64,
    size: usize,
    /// Index of the next state.
    index: &'a mut u32,
}

/// States with their responses.
type Sample<S> = Vec<(<S as Space>::State, f64)>;

impl<S: Space> Chains<'_, S> {
    fn run(mut self) -> Result<Run, S::Error> {
        let mut sample = self.first()?;
        let without = sample.iter().filter(|(_, response)| response.is_nan()).count() as u64;
        let (mut inside, mut thresholds, mut new) = (1.0, Vec::new(), 0.5);
        loop {
            let beyond = sample.iter().filter(|(_, response)| *response > self.limit).count();
            if beyond * ONE_IN >= self.size {
                let probability = Some(inside * beyond as f64 / self.size as f64);
                return Ok(Run { probability, thresholds, without });
            }
            if thresholds.len() == MOST_LEVELS {
                return Ok(Run { probability: None, thresholds, without });
            }
            let Some(threshold) = self.narrow(&mut sample) else {
                return Ok(Run { probability: None, thresholds, without });
            };
            thresholds.push(threshold);
            inside /= ONE_IN as f64;
            sample = self.within(sample, threshold, &mut new)?;
        }
    }

    fn first(&mut self) -> Result<Sample<S>, S::Error> {
        let states: Vec<S::State> = (0..self.size).map(|_| self.space.independent(next(self.index))).collect();
        let responses = self.space.responses(&states)?;
        Ok(states.into_iter().zip(responses).collect())
    }

    /// Leaves the states with the largest responses and returns what these exceed; `None` where they
    /// are all the same, which is then as far as responses go.
    fn narrow(&self, sample: &mut Sample<S>) -> Option<f64> {
        let rank = |response: f64| if response.is_nan() { f64::INFINITY } else { -response };
        order::sort_by_key(sample, |(_, response)| rank(*response));
        let kept = self.size / ONE_IN;
        let [first, last, next] = [0, kept - 1, kept].map(|i| sample[i].1);
        sample.truncate(kept);
        (first > next).then_some(0.5 * (last + next))
    }

    /// A sample of the states whose response is not below a threshold, by chains from some that
    /// are; `new` is the part of new numbers in a move, √(1 − kept²).
    fn within(&mut self, starts: Sample<S>, threshold: f64, new: &mut f64) -> Result<Sample<S>, S::Error> {
        let (mut chains, mut sample) = (starts.clone(), starts);
        for _ in 1..ONE_IN {
            let kept = (1.0 - *new * *new).sqrt();
            let moved = |(from, _): &(S::State, f64)| self.space.moved(from, kept, next(self.index));
            let proposed: Vec<S::State> = chains.iter().map(moved).collect();
            let responses = self.space.responses(&proposed)?;
            let mut accepted = 0;
            for (chain, (state, response)) in chains.iter_mut().zip(proposed.into_iter().zip(responses)) {
                if response >= threshold {
                    *chain = (state, response);
                    accepted += 1;
                }
            }
            let rate = f64::from(accepted) / chains.len() as f64;
            *new = (*new * (rate - ACCEPTED).exp()).clamp(0.01, 1.0);
            sample.extend_from_slice(&chains);
        }
        Ok(sample)
    }
}

fn next(index: &mut u32) -> u32 {
    *index += 1;
    *index - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::special::{chi_squared_survival, normal_cdf};
    use crate::rng::{Philox, Stream};
    use std::convert::Infallible;

    type Response = fn(&[f64]) -> f64;

    /// Responses that are functions of some standard normal numbers.
    struct Normals {
        count: usize,
        response: Response,
        seed: u64,
    }

    impl Space for Normals {
        type State = Vec<f64>;
        type Error = Infallible;

        fn independent(&self, index: u32) -> Vec<f64> {
            let mut draw = Philox::new(self.seed, u64::from(index), Stream::Host);
            (0..self.count).map(|_| draw.normal()).collect()
        }

        fn moved(&self, from: &Vec<f64>, kept: f64, index: u32) -> Vec<f64> {
            let new = (1.0 - kept * kept).sqrt();
            from.iter().zip(self.independent(index)).map(|(old, fresh)| kept * old + new * fresh).collect()
        }

        fn responses(&mut self, states: &[Vec<f64>]) -> Result<Vec<f64>, Infallible> {
            Ok(states.iter().map(|state| (self.response)(state)).collect())
        }
    }

    fn sum(state: &[f64]) -> f64 {
        state.iter().sum::<f64>() / (state.len() as f64).sqrt()
    }

    fn radius(state: &[f64]) -> f64 {
        state.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Of one in a hundred down to one in ten million: sums of one, of many, of both signs, a radius.
    #[test]
    fn probabilities_and_what_is_exceeded_are_the_closed_forms() {
        let upper = |x: f64| 1.0 - normal_cdf(x);
        let cases: [(usize, Response, f64, f64); 5] = [
            (1, sum, 5.199, normal_cdf(-5.199)),
            (200, sum, 5.199, normal_cdf(-5.199)),
            (200, sum, 2.326, upper(2.326)),
            (20, |state| sum(state).abs(), 5.327, 2.0 * normal_cdf(-5.327)),
            (3, radius, 6.0, chi_squared_survival(36.0, 3.0)),
        ];
        for (count, response, limit, truth) in cases {
            let Ok(got) = exceedance(&mut Normals { count, response, seed: 3 }, limit, 4000);
            let found = got.probability.expect("found");
            // Three times the half-width of the interval: 7.1 standard errors of Student's law with
            // seven degrees of freedom, which one in five thousand exceeds.
            let reach = 3.0 * (found.ci95[1] / found.value).ln();
            assert!((found.value / truth).ln().abs() < reach && reach < 1.5, "{count}: {found:?}, {truth}");
        }
        let Ok(got) = exceedance(&mut Normals { count: 200, response: sum, seed: 4 }, 5.199, 4000);
        let quantiles = [1.2816, 2.3263, 3.0902, 3.7190, 4.2649, 4.7534];
        for (estimate, truth) in got.exceeded.iter().zip(quantiles) {
            assert!(
                (estimate.value / truth).ln().abs() < 3.0 * (estimate.ci95[1] / estimate.value).ln(),
                "{estimate:?}"
            );
        }
        assert!(got.exceeded.len() >= quantiles.len() && got.without == 0);
    }

    /// Of 60 intervals of 95 %, 57 should hold the truth; fewer than 52 do so once in 350 tries
    /// (binomial law). Two fifths of the truth, the control, is held far less often.
    #[test]
    fn intervals_hold_the_probability_as_often_as_they_say() {
        let truth = normal_cdf(-4.265);
        let holds = |truth: f64| {
            let one = |seed: u64| {
                let Ok(got) = exceedance(&mut Normals { count: 10, response: sum, seed }, 4.265, 2000);
                got.probability.is_some_and(|found| (found.ci95[0]..=found.ci95[1]).contains(&truth))
            };
            (0..60).filter(|seed| one(*seed)).count()
        };
        let [right, wrong] = [truth, 0.4 * truth].map(holds);
        assert!(right >= 52 && wrong < 20, "{right} and {wrong} of 60");
    }

    #[test]
    fn what_nothing_reaches_is_said_and_what_has_no_response_is_counted() {
        let capped = |state: &[f64]| state[0].min(2.0);
        let Ok(got) = exceedance(&mut Normals { count: 1, response: capped, seed: 1 }, 3.0, 1000);
        // 23 in 1000 lie at the ceiling.
        assert_eq!((got.probability, got.exceeded.len()), (None, 1));
        let Ok(got) = exceedance(&mut Normals { count: 1, response: |_| 1.0, seed: 1 }, 3.0, 1000);
        assert_eq!((got.probability, got.exceeded.len()), (None, 0));
        let broken = |state: &[f64]| if state[0] < 0.0 { f64::NAN } else { state[0] };
        let Ok(got) = exceedance(&mut Normals { count: 1, response: broken, seed: 1 }, 0.5, 1000);
        assert!((3500..4500).contains(&got.without), "{}", got.without);
    }
}
