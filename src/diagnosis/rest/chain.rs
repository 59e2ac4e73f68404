//! A chain of a few levels in white noise (a hidden Markov model) and its fit by
//! expectation–maximisation (Rabiner 1989). Where it leaves a level, every other one is as likely.
//!
//! Not whether a recording is one: that is a contest with a Gaussian drift (`telegraph`).

/// Steps of expectation–maximisation; the likelihood only rises, so that stopping early claims
/// less.
const STEPS: usize = 40;

/// Levels, the variance about them, and the chance per value to leave each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain<const LEVELS: usize> {
    pub(super) level: [f64; LEVELS],
    variance: f64,
    /// The chance to leave each.
    pub(super) leave: [f64; LEVELS],
}

/// Holds what a chain says of values.
pub(super) struct Expected<const LEVELS: usize> {
    /// Up to a constant.
    pub(super) log_likelihood: f64,
    /// Chance of each level, value by value.
    chances: Vec<[f64; LEVELS]>,
    /// Mean number of hops from each level.
    hops: [f64; LEVELS],
}

impl<const LEVELS: usize> Expected<LEVELS> {
    /// Counts the changes of the likeliest level.
    pub(super) fn changes(&self) -> usize {
        let likeliest = |c: &[f64; LEVELS]| (0..LEVELS).max_by(|a, b| c[*a].total_cmp(&c[*b]));
        self.chances.windows(2).filter(|w| likeliest(&w[0]) != likeliest(&w[1])).count()
    }
}

impl<const LEVELS: usize> Chain<LEVELS> {
    /// Sets a level for each part of the values, which `course`, smoother than they are, divides at
    /// `bounds`; `None` where a part is empty.
    pub(super) fn divided(values: &[f64], course: &[f64], bounds: &[f64], variance: f64) -> Option<Self> {
        let part = |v: &f64| bounds.iter().filter(|b| *v > **b).count();
        let (mut count, mut sum, mut hops) = ([0.0f64; LEVELS], [0.0; LEVELS], [0.0; LEVELS]);
        for (value, at) in values.iter().zip(course.iter().map(part)) {
            count[at] += 1.0;
            sum[at] += value;
        }
        course.windows(2).filter(|w| part(&w[0]) != part(&w[1])).for_each(|w| hops[part(&w[0])] += 1.0);
        let level = std::array::from_fn(|k| sum[k] / count[k]);
        let leave = std::array::from_fn(|k| (hops[k] / count[k]).clamp(1e-6, 0.5));
        count.iter().all(|c| *c > 0.0).then_some(Self { level, variance, leave })
    }

    /// Forward and backward (Baum et al. 1970), scaled at every value.
    fn responsibilities(&self, values: &[f64]) -> Expected<LEVELS> {
        let stay = self.leave.map(|l| 1.0 - l);
        let hop = self.leave.map(|l| l / (LEVELS - 1) as f64);
        let emitted = |value: f64| -> ([f64; LEVELS], f64) {
            let exponent = self.level.map(|l| -0.5 * (value - l).powi(2) / self.variance);
            let most = exponent.into_iter().fold(f64::NEG_INFINITY, f64::max);
            (exponent.map(|e| (e - most).exp()), most)
        };
        // At balance each level is as full as it is hard to leave.
        let held = self.leave.map(|l| 1.0 / l);
        let mut state = held.map(|h| h / held.iter().sum::<f64>());
        let mut log_likelihood = -0.5 * values.len() as f64 * self.variance.ln();
        let mut forward = Vec::with_capacity(values.len());
        for (n, value) in values.iter().enumerate() {
            if n > 0 {
                let hopping: f64 = (0..LEVELS).map(|k| state[k] * hop[k]).sum();
                state = std::array::from_fn(|k| state[k] * (stay[k] - hop[k]) + hopping);
            }
            let (weight, most) = emitted(*value);
            let sum = (0..LEVELS).map(|k| state[k] * weight[k]).sum::<f64>().max(f64::MIN_POSITIVE);
            state = std::array::from_fn(|k| state[k] * weight[k] / sum);
            log_likelihood += most + sum.ln();
            forward.push(state);
        }
        let (mut back, mut hops) = ([1.0f64; LEVELS], [0.0; LEVELS]);
        let mut chances = vec![[0.0; LEVELS]; values.len()];
        for n in (0..values.len()).rev() {
            let both: [f64; LEVELS] = std::array::from_fn(|k| forward[n][k] * back[k]);
            let sum = both.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            chances[n] = both.map(|b| b / sum);
            if n == 0 {
                break;
            }
            let (weight, _) = emitted(values[n]);
            let before = forward[n - 1];
            let ahead: [f64; LEVELS] = std::array::from_fn(|k| weight[k] * back[k]);
            let all: f64 = ahead.iter().sum();
            let away: [f64; LEVELS] = std::array::from_fn(|k| hop[k] * (all - ahead[k]));
            back = std::array::from_fn(|k| stay[k] * ahead[k] + away[k]);
            let sum = (0..LEVELS).map(|k| before[k] * back[k]).sum::<f64>().max(f64::MIN_POSITIVE);
            (0..LEVELS).for_each(|k| hops[k] += before[k] * away[k] / sum);
            let scale = back.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            back = back.map(|b| b / scale);
        }
        Expected { log_likelihood, chances, hops }
    }

    /// The likeliest chain given where the values probably were; white noise not below `least`.
    fn improved(&self, values: &[f64], expected: &Expected<LEVELS>, least: f64) -> Self {
        let (mut count, mut sum) = ([1e-9f64; LEVELS], [0.0; LEVELS]);
        for (value, chances) in values.iter().zip(&expected.chances) {
            (0..LEVELS).for_each(|k| count[k] += chances[k]);
            (0..LEVELS).for_each(|k| sum[k] += chances[k] * value);
        }
        let level: [f64; LEVELS] = std::array::from_fn(|k| sum[k] / count[k]);
        let about = |(value, chances): (&f64, &[f64; LEVELS])| -> f64 {
            (0..LEVELS).map(|k| chances[k] * (value - level[k]).powi(2)).sum()
        };
        let squares: f64 = values.iter().zip(&expected.chances).map(about).sum();
        let leave = std::array::from_fn(|k| (expected.hops[k] / count[k]).clamp(1e-6, 0.5));
        Self { level, variance: (squares / values.len() as f64).max(least), leave }
    }
}

/// The best chain found from a start, with what it expects.
pub(super) fn climb<const LEVELS: usize>(
    mut chain: Chain<LEVELS>,
    values: &[f64],
    least: f64,
) -> (Chain<LEVELS>, Expected<LEVELS>) {
    let mut expected = chain.responsibilities(values);
    for _ in 0..STEPS {
        let next = chain.improved(values, &expected, least);
        let then = next.responsibilities(values);
        let gained = then.log_likelihood - expected.log_likelihood;
        if gained > 0.0 {
            (chain, expected) = (next, then);
        }
        if gained < 0.05 {
            break;
        }
    }
    (chain, expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    // Levels two and three standard deviations apart, which change every 50 values: a level has a
    // standard error of 0.012, and few hops hide in the noise.
    #[test]
    fn three_levels_and_their_dwells_are_found() {
        let mut rng = Philox::new(44, 0, Stream::Host);
        let (planted, mut side) = ([-1.0, 1.0, 4.0], 0);
        let values: Vec<f64> = (0..20_000)
            .map(|n| {
                if n % 50 == 49 {
                    side = (side + 1 + usize::from(rng.normal() > 0.0)) % 3;
                }
                planted[side] + rng.normal()
            })
            .collect();
        let start = Chain::<3>::divided(&values, &values, &[0.0, 3.0], 1.0);
        let Some((chain, expected)) = start.map(|c| climb(c, &values, 0.1)) else { panic!("three levels") };
        for (level, planted) in chain.level.iter().zip(planted) {
            assert!((level - planted).abs() < 0.06, "{level} for {planted}");
        }
        assert!(chain.leave.iter().all(|l| (0.7..1.4).contains(&(50.0 * l))), "{:?}", chain.leave);
        assert!(expected.changes().abs_diff(400) <= 12, "{} of 400 hops", expected.changes());
        assert!(Chain::<3>::divided(&values, &values, &[9.0, 99.0], 1.0).is_none(), "control: nothing is there");
    }
}
