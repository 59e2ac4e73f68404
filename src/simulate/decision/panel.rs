//! The same members at two neighbouring values, and where between and around them a statistic
//! crosses its limit.
//!
//! Each member's error is taken as linear in the value across the pair, which it is for every
//! additive error and nearly so for any other over a few per cent. A crossing's interval is where
//! the statistic, a standard error times 1.96 higher or lower, crosses: the interval of the
//! statistic carried over to the value, without a slope.

use super::statistic::{Statistic, Z95};
use crate::statistics::Estimate;

/// Members at two values.
#[derive(Debug, Clone)]
pub struct Panel {
    at: [f64; 2],
    pairs: Vec<[f64; 2]>,
}

/// Value at which a statistic crosses a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Value at which the statistic meets the limit.
    pub value: f64,
    /// The 95 % interval; an end that the pair does not reach is absent.
    pub ci95: [Option<f64>; 2],
}

/// Distance beyond the pair up to which a crossing is looked for, in distances of the two.
const REACH: f64 = 2.0;
/// Steps of the search for a root: the pair's distance over 2²⁰ is far below any interval.
const STEPS: usize = 20;

impl Panel {
    /// Errors of the same members at two increasing values; members that failed at either are left
    /// out.
    pub fn new(at: [f64; 2], low: &[f64], high: &[f64]) -> Self {
        let pairs = low.iter().zip(high).map(|(low, high)| [*low, *high]);
        Self { at, pairs: pairs.filter(|pair| pair.iter().all(|v| v.is_finite())).collect() }
    }

    /// Members that are left.
    pub fn members(&self) -> usize {
        self.pairs.len()
    }

    /// The statistic at a value, this many standard errors higher.
    fn statistic(&self, statistic: Statistic, value: f64, shift: f64, buffer: &mut Vec<f64>) -> f64 {
        let weight = (value - self.at[0]) / (self.at[1] - self.at[0]);
        buffer.clear();
        buffer.extend(self.pairs.iter().map(|[low, high]| low + weight * (high - low)));
        statistic.shifted(buffer, shift)
    }

    /// The statistic at a value.
    pub fn estimate(&self, statistic: Statistic, value: f64) -> Estimate {
        let at = |shift: f64| self.statistic(statistic, value, shift, &mut Vec::new());
        Estimate { value: at(0.0), ci95: [at(-Z95), at(Z95)] }
    }

    /// Returns where the statistic crosses the limit; `None` where it does not do so near the pair.
    pub fn crossing(&self, statistic: Statistic, limit: f64) -> Option<Crossing> {
        let mut buffer = Vec::with_capacity(self.pairs.len());
        let mut root = |shift: f64| self.root(limit, |value| self.statistic(statistic, value, shift, &mut buffer));
        let value = root(0.0)?;
        let mut ends = [root(Z95), root(-Z95)];
        // Where the statistic falls with the value, what is higher crosses later.
        let rises = match ends {
            [Some(early), _] => early <= value,
            [None, Some(late)] => late >= value,
            [None, None] => true,
        };
        if !rises {
            ends.reverse();
        }
        Some(Crossing { value, ci95: ends })
    }

    /// A root of `f` − `limit` around the pair, above zero, by bisection.
    fn root(&self, limit: f64, mut f: impl FnMut(f64) -> f64) -> Option<f64> {
        let span = self.at[1] - self.at[0];
        let [mut low, mut high] = [(self.at[0] - REACH * span).max(0.0), self.at[1] + REACH * span];
        let below = f(low) - limit;
        let above = f(high) - limit;
        // NaN has no sign.
        if below.is_nan() || above.is_nan() || (below > 0.0) == (above > 0.0) {
            return None;
        }
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if (f(middle) - limit > 0.0) == (below > 0.0) { low = middle } else { high = middle }
        }
        // The last stretch is straight.
        let (at_low, at_high) = (f(low) - limit, f(high) - limit);
        let fraction = if at_high == at_low { 0.5 } else { (at_low / (at_low - at_high)).clamp(0.0, 1.0) };
        Some(low + fraction * (high - low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::special::exact_interval;
    use crate::rng::{Philox, Stream};

    /// x = v·z: the 95 % quantile crosses L at L/1.645; the interval holds it as often as it says,
    /// and not another value.
    #[test]
    fn the_crossing_of_a_scaled_normal_is_covered_as_stated() {
        let (repeats, truth) = (300, 10.0 / 1.644_853_6);
        let crossing = |repeat: u64, falls: bool| {
            let mut rng = Philox::new(9, repeat, Stream::Host);
            let z: Vec<f64> = (0..1500).map(|_| rng.normal()).collect();
            let at = |v: f64| -> Vec<f64> { z.iter().map(|z| if falls { z * (12.0 - v) } else { z * v }).collect() };
            let at_pair = [5.8, 6.2];
            Panel::new(at_pair, &at(at_pair[0]), &at(at_pair[1])).crossing(Statistic::Quantile(0.95), 10.0)
        };
        for (falls, truth) in [(false, truth), (true, 12.0 - truth)] {
            let holds = |value: f64| {
                let inside = |repeat| match crossing(repeat, falls) {
                    Some(Crossing { ci95: [Some(low), Some(high)], .. }) => low <= value && value <= high,
                    _ => false,
                };
                (0..repeats).filter(|repeat| inside(*repeat)).count() as u64
            };
            let hits = holds(truth);
            let [low, high] = exact_interval(hits, repeats, 0.999);
            assert!(low < 0.95 && 0.95 < high, "{hits} of {repeats}");
            assert!(holds(truth * 1.1) < repeats / 4);
        }
    }

    #[test]
    fn what_crosses_nowhere_near_has_no_crossing() {
        let flat = Panel::new([1.0, 1.1], &[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]);
        assert_eq!(flat.crossing(Statistic::Mean, 5.0), None);
        let failed = Panel::new([1.0, 1.1], &[f64::NAN], &[1.0]);
        assert_eq!((failed.members(), failed.crossing(Statistic::Mean, 0.0)), (0, None));
    }
}
