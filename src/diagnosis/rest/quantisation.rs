//! The noise before a coarse rounding: maximum likelihood from how often each step is read.
//!
//! When the step is wider than the noise, the variance of the reading depends on where between two
//! steps the value lies, and subtracting q²/12 is wrong by as much as q²/12. The counts of the
//! steps know both. For independent readings about a constant; not where the value drifts over
//! steps.

use crate::numerics::special::normal_cdf;

/// Counts of readings by step.
pub(super) struct Counts {
    /// Reading in units of the step, and how often.
    levels: Vec<(f64, f64)>,
    mean: f64,
    spread: f64,
}

impl Counts {
    /// Of readings on a grid of `step`.
    pub(super) fn of(values: &[f64], step: f64) -> Self {
        let first = values.first().copied().unwrap_or(0.0);
        let mut steps: Vec<i64> = values.iter().map(|v| ((v - first) / step).round() as i64).collect();
        steps.sort_unstable();
        let mut levels: Vec<(f64, f64)> = Vec::new();
        for step in steps {
            match levels.last_mut() {
                Some(last) if last.0 == step as f64 => last.1 += 1.0,
                _ => levels.push((step as f64, 1.0)),
            }
        }
        let count: f64 = levels.iter().map(|l| l.1).sum::<f64>().max(1.0);
        let mean = levels.iter().map(|l| l.0 * l.1).sum::<f64>() / count;
        let spread = (levels.iter().map(|l| l.1 * (l.0 - mean).powi(2)).sum::<f64>() / count).sqrt();
        Self { levels, mean, spread }
    }

    /// Log-likelihood of noise of `sigma` steps, at its best place between two steps.
    fn log_likelihood(&self, sigma: f64) -> f64 {
        let at = |place: f64| -> f64 {
            let edge = |x: f64| normal_cdf((x - place) / sigma);
            self.levels
                .iter()
                .map(|(level, count)| {
                    // Beyond a side's tail the difference is taken there, where it does not cancel.
                    let (low, high) = (level - 0.5, level + 0.5);
                    let probability = if low > place {
                        normal_cdf((place - low) / sigma) - normal_cdf((place - high) / sigma)
                    } else {
                        edge(high) - edge(low)
                    };
                    count * probability.max(1e-300).ln()
                })
                .sum()
        };
        // Concave in the place, which lies within a step of the mean.
        let (mut low, mut high) = (self.mean - 1.0, self.mean + 1.0);
        for _ in 0..60 {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if at(a) < at(b) { low = a } else { high = b }
        }
        at(0.5 * (low + high))
    }

    /// The best noise, in steps, its 95 % interval by profile likelihood, and twice what it gains
    /// over `promised` steps.
    pub(super) fn noise(&self, promised: f64) -> (f64, [f64; 2], f64) {
        let at = |log_sigma: f64| self.log_likelihood(log_sigma.exp());
        let (mut low, mut high) = (0.05f64.ln(), (2.0 * self.spread + 1.0).ln());
        let (floor, ceiling) = (low, high);
        for _ in 0..50 {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if at(a) < at(b) { low = a } else { high = b }
        }
        let best = 0.5 * (low + high);
        let top = at(best);
        let edge = |mut out: f64| {
            let mut inside = best;
            for _ in 0..40 {
                let middle = 0.5 * (inside + out);
                if top - at(middle) < 1.92 { inside = middle } else { out = middle }
            }
            inside.exp()
        };
        (best.exp(), [edge(floor), edge(ceiling)], 2.0 * (top - at(promised.ln())).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// At every place between two steps, where the variance less q²/12 is wrong by up to a quarter
    /// of a step.
    #[test]
    fn noise_of_a_third_of_a_step_comes_back_wherever_the_value_lies() {
        let (mut covered, mut alarms) = (0, 0);
        for member in 0..40 {
            let mut rng = Philox::new(6, member, Stream::Host);
            let place = member as f64 / 40.0;
            let values: Vec<f64> = (0..3000).map(|_| (place + 0.35 * rng.normal()).round() * 0.01).collect();
            let (_, [low, high], gain) = Counts::of(&values, 0.01).noise(0.35);
            covered += usize::from((low..=high).contains(&0.35));
            alarms += usize::from(gain > 6.63);
            let louder = Counts::of(&values, 0.01).noise(0.25).2;
            assert!(louder > 20.0, "a level wrong by 40 % must show at {place}: {louder}");
        }
        assert!(covered >= 34, "95 % of 40 less two and a half standard errors: {covered}");
        assert!(alarms <= 3, "1 % of 40 and more by chance once in a thousand: {alarms}");
    }
}
