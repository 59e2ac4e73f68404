//! Count, mean, variance and extremes of a stream, mergeable.
//!
//! Source: Chan, Golub, LeVeque, *Updating formulae and a pairwise algorithm for computing sample
//! variances*, 1979. Merging is done in block order, so that the same blocks give the same bits
//! however they were computed.

use serde::{Deserialize, Serialize};

/// Moments of the values seen so far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Number of values.
    pub count: u64,
    /// Mean of the values.
    pub mean: f64,
    /// Sum of squared deviations from the mean.
    pub squares: f64,
    /// Smallest; of none, the largest f64.
    pub min: f64,
    /// Largest; of none, the smallest f64.
    pub max: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0, min: f64::MAX, max: f64::MIN }
    }
}

impl Moments {
    /// Moments of a few values, in two passes and in their order.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let [moments] = Self::of_each(values.map(|x| [x]));
        moments
    }

    /// Of several quantities, each as [`Moments::of`] has it, bit for bit: side by side, because a
    /// sum waits for its last addition and the others need not.
    pub fn of_each<const N: usize>(rows: impl Iterator<Item = [f64; N]> + Clone) -> [Self; N] {
        let mut all = [Self::default(); N];
        rows.clone().for_each(|row| {
            for (m, x) in all.iter_mut().zip(row) {
                m.count += 1;
                m.mean += x;
                m.min = m.min.min(x);
                m.max = m.max.max(x);
            }
        });
        all.iter_mut().filter(|m| m.count > 0).for_each(|m| m.mean /= m.count as f64);
        rows.for_each(|row| {
            for (m, x) in all.iter_mut().zip(row) {
                m.squares += (x - m.mean) * (x - m.mean);
            }
        });
        all
    }

    /// Adds the values behind `other`.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        self.count += other.count;
        self.mean += delta * (b / (a + b));
        self.squares += other.squares + delta * delta * (a * b / (a + b));
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Returns the standard deviation with n − 1; 0 for fewer than two values, and for values that are all
    /// one, whatever the rounding of their mean.
    pub fn sd(&self) -> f64 {
        if self.count < 2 || self.min == self.max { 0.0 } else { (self.squares / (self.count - 1) as f64).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The mean of thirds is rounded, and squares the rounding of it; a spread of one ulp is one.
    #[test]
    fn values_that_are_all_one_have_no_spread() {
        let third = 1.0 / 3.0;
        let alike = Moments::of((0..1001).map(|_| third));
        assert!(alike.squares > 0.0 && alike.sd() == 0.0, "{alike:?}");
        let apart = Moments::of((0..1001).map(|i| if i == 0 { f64::next_up(third) } else { third }));
        assert!(apart.sd() > 0.0);
    }

    #[test]
    fn quantities_side_by_side_are_those_alone() {
        let row = |i: u32| [f64::from(i).sin(), 1e6 + f64::from(i * i % 97), -3.0];
        let all = Moments::of_each((0..100).map(row));
        for (q, got) in all.iter().enumerate() {
            assert_eq!(*got, Moments::of((0..100).map(|i| row(i)[q])));
        }
        assert_eq!(Moments::of_each(std::iter::empty::<[f64; 2]>()), [Moments::default(); 2]);
    }

    #[test]
    fn merging_blocks_gives_the_moments_of_the_whole() {
        let values: Vec<f64> = (0..1000).map(|i| 1e6 + f64::from(i * i % 97)).collect();
        let mut merged = Moments::default();
        for block in values.chunks(77) {
            merged.merge(&Moments::of(block.iter().copied()));
        }
        let whole = Moments::of(values.iter().copied());
        assert_eq!((merged.count, merged.min, merged.max), (whole.count, whole.min, whole.max));
        assert!((merged.mean - whole.mean).abs() < 1e-9 && (merged.sd() / whole.sd() - 1.0).abs() < 1e-12);
    }
}
