//! A chain of two levels in white noise (a hidden Markov model) and its fit by
//! expectation–maximisation (Rabiner 1989).
//!
//! Not whether a recording is one: that is a contest with a Gaussian drift (`telegraph`).

/// Steps of expectation–maximisation; the likelihood only rises, so that stopping early claims
/// less.
const STEPS: usize = 40;

/// Two levels, the variance about them, and the chance per value to leave each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    pub(super) level: [f64; 2],
    variance: f64,
    /// The chance to leave each.
    pub(super) leave: [f64; 2],
}

/// Holds what a chain says of values: log-likelihood up to a constant, and the chance of the higher
/// level at each.
pub(super) struct Expected {
    /// Up to a constant.
    pub(super) log_likelihood: f64,
    /// Chance of the higher level, value by value.
    pub(super) high: Vec<f64>,
    /// Mean number of hops from each level.
    hops: [f64; 2],
}

impl Chain {
    /// From a division of the values into low and high; `None` where one side is empty.
    pub(super) fn divided(values: &[f64], high: &[bool], variance: f64) -> Option<Self> {
        let mut count = [0.0f64; 2];
        let mut sum = [0.0; 2];
        for (value, side) in values.iter().zip(high) {
            count[usize::from(*side)] += 1.0;
            sum[usize::from(*side)] += value;
        }
        let hops = high.windows(2).filter(|w| w[0] != w[1]).count() as f64;
        let of = |side: usize| sum[side] / count[side];
        let leave = |side: usize| (0.5 * hops / count[side]).clamp(1e-6, 0.5);
        (count.iter().all(|c| *c > 0.0)).then(|| Self { level: [of(0), of(1)], variance, leave: [leave(0), leave(1)] })
    }

    /// Forward and backward (Baum et al. 1970), scaled at every value.
    fn responsibilities(&self, values: &[f64]) -> Expected {
        let stay = self.leave.map(|l| 1.0 - l);
        let emitted = |value: f64| -> ([f64; 2], f64) {
            let exponent = self.level.map(|l| -0.5 * (value - l).powi(2) / self.variance);
            let most = exponent[0].max(exponent[1]);
            (exponent.map(|e| (e - most).exp()), most)
        };
        let total = self.leave[0] + self.leave[1];
        let mut state = [self.leave[1] / total, self.leave[0] / total];
        let mut log_likelihood = -0.5 * values.len() as f64 * self.variance.ln();
        let mut forward = Vec::with_capacity(values.len());
        for (n, value) in values.iter().enumerate() {
            if n > 0 {
                state = [state[0] * stay[0] + state[1] * self.leave[1], state[1] * stay[1] + state[0] * self.leave[0]];
            }
            let (weight, most) = emitted(*value);
            let sum = (state[0] * weight[0] + state[1] * weight[1]).max(f64::MIN_POSITIVE);
            state = [state[0] * weight[0] / sum, state[1] * weight[1] / sum];
            log_likelihood += most + sum.ln();
            forward.push(state);
        }
        let (mut back, mut hops) = ([1.0f64; 2], [0.0; 2]);
        let mut high = vec![0.0; values.len()];
        for n in (0..values.len()).rev() {
            let now = forward[n];
            let both = [now[0] * back[0], now[1] * back[1]];
            high[n] = both[1] / (both[0] + both[1]).max(f64::MIN_POSITIVE);
            if n == 0 {
                break;
            }
            let (weight, _) = emitted(values[n]);
            let ahead = [weight[0] * back[0], weight[1] * back[1]];
            let before = forward[n - 1];
            let (up, down) = (before[0] * self.leave[0] * ahead[1], before[1] * self.leave[1] * ahead[0]);
            let (low, top) = (before[0] * stay[0] * ahead[0], before[1] * stay[1] * ahead[1]);
            let sum = (up + down + low + top).max(f64::MIN_POSITIVE);
            hops[0] += up / sum;
            hops[1] += down / sum;
            back = [stay[0] * ahead[0] + self.leave[0] * ahead[1], stay[1] * ahead[1] + self.leave[1] * ahead[0]];
            let scale = (back[0] + back[1]).max(f64::MIN_POSITIVE);
            back = back.map(|b| b / scale);
        }
        Expected { log_likelihood, high, hops }
    }

    /// The likeliest chain given where the values probably were; white noise not below `least`.
    fn improved(&self, values: &[f64], expected: &Expected, least: f64) -> Self {
        let top: f64 = expected.high.iter().sum();
        let count = [values.len() as f64 - top, top].map(|c| c.max(1e-9));
        let (mut sum, mut squares) = ([0.0; 2], 0.0);
        for (value, high) in values.iter().zip(&expected.high) {
            sum[0] += (1.0 - high) * value;
            sum[1] += high * value;
        }
        let level = [sum[0] / count[0], sum[1] / count[1]];
        for (value, high) in values.iter().zip(&expected.high) {
            squares += (1.0 - high) * (value - level[0]).powi(2) + high * (value - level[1]).powi(2);
        }
        Self {
            level,
            variance: (squares / values.len() as f64).max(least),
            leave: [0, 1].map(|s| (expected.hops[s] / count[s]).clamp(1e-6, 0.5)),
        }
    }
}

/// The best chain found from a start, with what it expects.
pub(super) fn climb(mut chain: Chain, values: &[f64], least: f64) -> (Chain, Expected) {
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
