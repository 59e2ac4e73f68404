//! White noise and flicker from what a sensor does inside its poses.
//!
//! Each pose is taken apart into cosines that end flat at both ends. Under white noise of
//! coefficient N their mean squares are N²/T in a pose of length T, under flicker (the spectrum
//! B²/(πf)) they are (B²/π) times a number that falls as one over the order, whatever the length:
//! see `of_order`. They are all but independent, so that the likelihood is that of normal values,
//! weighted by the law that is fitted: weights from the squares as observed would favour those that
//! chance made small, and with them too little flicker. Large squares count only so far (Huber,
//! Robust Statistics, 1981, chapter 5), and poses that slipped not at all. Flicker is kept where it
//! is beyond chance in all axes together, or in one where they disagree: a level that is no more
//! than chance would hide what moves the poses.

use std::f64::consts::PI;

use crate::numerics::{golden, order};

/// Shortest average that is looked at, s: below it filters in the sensor colour the noise.
const SHORTEST_S: f64 = 0.05;
/// More orders than this tell nothing new about flicker.
const MOST_ORDERS: usize = 256;
/// Fewest averages in a short pose.
const FEWEST_AVERAGES: usize = 8;
/// Square over its mean from which it counts as that much: one normal value in a hundred.
const CLIPPED: f64 = 6.635;
/// Mean of a clipped square of a standard normal value.
const MEAN_CLIPPED: f64 = 0.98185;
/// Fall in twice the log-likelihood from which flicker is beyond chance: 5 % for one parameter at
/// its bound (Self & Liang, J. Am. Stat. Assoc. 82 (1987) 605).
const SIGNIFICANT: f64 = 2.7;
/// Loss in it from which three axes do not share one level: 5 % for two parameters.
const DISAGREE: f64 = 6.0;
/// Orders in which a slip within a pose shows.
const SLIPS: usize = 8;
/// Sum of that many squares over their means that one still pose in ten thousand has.
const SLIPPED: f64 = 31.8;
/// One pose in this many may be left out as slipped.
const ONE_IN: usize = 10;

/// Times that a bracket of the level is cut: to a hundredth of it.
const SECTIONS: usize = 9;

/// One pose of one axis.
struct Cosines {
    length_s: f64,
    /// Squares of the coefficients, from the first order on.
    squares: Vec<f64>,
}

impl Cosines {
    fn of(values: &[f64], rate_hz: f64) -> Self {
        let each = ((SHORTEST_S * rate_hz).round() as usize).min(values.len() / FEWEST_AVERAGES).max(1);
        let means: Vec<f64> = values.chunks_exact(each).map(|c| c.iter().sum::<f64>() / each as f64).collect();
        let count = means.len() as f64;
        let square = |order: usize| {
            let step = PI * order as f64 / count;
            // cos(a + 2b) = 2 cos(a + b) cos b − cos a.
            let (mut before, mut now) = ((0.5 * step).cos(), (0.5 * step).cos());
            let mut sum = 0.0;
            for value in &means {
                sum += value * now;
                (before, now) = (now, 2.0 * step.cos() * now - before);
            }
            2.0 * (sum / count).powi(2)
        };
        let squares = (1..means.len().min(MOST_ORDERS + 1)).map(square).collect();
        Self { length_s: (means.len() * each) as f64 / rate_hz, squares }
    }
}

/// Poses of one axis, with the least white level that they can have.
struct Axis {
    poses: Vec<Cosines>,
    floor: f64,
}

/// White level N² and flicker B²/π that fit, with twice the negative log-likelihood.
#[derive(Clone, Copy)]
struct Law {
    white: f64,
    flicker: f64,
    deviance: f64,
}

/// White level N² in u²·s and flicker B²/π in u² of each axis of one sensor, from its values inside
/// each pose; the white level is no less than its floor.
pub(super) fn levels(axes: &[(Vec<&[f64]>, f64)], rate_hz: f64) -> Vec<(f64, f64)> {
    let of_order = of_order();
    let cosines = |poses: &[&[f64]]| poses.iter().map(|v| Cosines::of(v, rate_hz)).collect();
    let mut axes: Vec<Axis> = axes.iter().map(|(poses, floor)| Axis { poses: cosines(poses), floor: *floor }).collect();
    let mut laws = fitted(&axes, &of_order);
    let mut slipped = false;
    for (axis, law) in axes.iter_mut().zip(&laws) {
        slipped |= axis.leave_out(law, &of_order);
    }
    if slipped {
        laws = fitted(&axes, &of_order);
    }
    laws.iter().map(|l| (l.white, l.flicker)).collect()
}

/// The law of each axis, their flicker shared where they agree, and none where it is chance.
fn fitted(axes: &[Axis], of_order: &[f64]) -> Vec<Law> {
    let without: Vec<Law> = axes.iter().map(|a| a.white(0.0, a.first_guess(), of_order)).collect();
    let total = |laws: &[Law]| laws.iter().map(|l| l.deviance).sum::<f64>();
    let best = |which: &[usize]| -> Vec<Law> {
        let unit = which.iter().map(|i| without[*i].white / axes[*i].length_s()).sum::<f64>() / which.len() as f64;
        let at = |logarithm: f64| -> Vec<Law> {
            let level = unit * logarithm.exp();
            which.iter().map(|i| axes[*i].white(level, without[*i].white, of_order)).collect()
        };
        lowest(&at, &total)
    };
    let all: Vec<usize> = (0..axes.len()).collect();
    let shared = best(&all);
    let own: Vec<Law> = all.iter().flat_map(|i| best(&[*i])).collect();
    if total(&shared) - total(&own) < DISAGREE {
        return if total(&without) - total(&shared) > SIGNIFICANT { shared } else { without };
    }
    let kept = without.iter().zip(own).map(|(w, o)| if w.deviance - o.deviance > SIGNIFICANT { o } else { *w });
    kept.collect()
}

/// The laws of least deviance over the logarithm of the level: a scan of factors of √2, then a
/// golden section about the best.
fn lowest(at: &dyn Fn(f64) -> Vec<Law>, total: &dyn Fn(&[Law]) -> f64) -> Vec<Law> {
    const STEP: f64 = 0.5 * std::f64::consts::LN_2;
    let scan = (-14..=24).map(|n| f64::from(n) * STEP);
    let judged = scan.map(|x| (x, total(&at(x)))).min_by(|a, b| a.1.total_cmp(&b.1));
    let middle = judged.map_or(0.0, |j| j.0);
    let (best, _) = golden::least(|x| total(&at(x)), [middle - STEP, middle + STEP], SECTIONS, |_| false);
    at(best)
}

impl Axis {
    /// Mean length of a pose, s.
    fn length_s(&self) -> f64 {
        self.poses.iter().map(|p| p.length_s).sum::<f64>() / self.poses.len().max(1) as f64
    }

    /// The white level by the median of all squares (that of a standard normal value is 0.455).
    fn first_guess(&self) -> f64 {
        let levels = self.poses.iter().flat_map(|p| p.squares.iter().map(|s| s * p.length_s)).collect();
        (order::median(levels).unwrap_or(0.0) / 0.455).max(self.floor).max(f64::MIN_POSITIVE.sqrt())
    }

    /// The white level of greatest likelihood next to this flicker, by Fisher's scoring.
    fn white(&self, flicker: f64, guess: f64, of_order: &[f64]) -> Law {
        let floor = self.floor.max(f64::MIN_POSITIVE.sqrt());
        let mut white = guess.max(floor);
        for _ in 0..30 {
            let (mut score, mut information) = (0.0, 0.0);
            self.each(white, flicker, of_order, |length_s, mean, square| {
                let slope = 1.0 / (length_s * mean);
                score += slope * ((square / mean).min(CLIPPED) - MEAN_CLIPPED);
                information += slope * slope;
            });
            let next = (white + score / information.max(f64::MIN_POSITIVE)).clamp(0.25 * white, 4.0 * white).max(floor);
            let change = (next / white - 1.0).abs();
            white = next;
            if change < 1e-5 {
                break;
            }
        }
        let mut deviance = 0.0;
        self.each(white, flicker, of_order, |_, mean, square| {
            let over = square / mean;
            let beyond = if over > CLIPPED { CLIPPED * (1.0 + (over / CLIPPED).ln()) } else { over };
            deviance += mean.ln() + beyond / MEAN_CLIPPED;
        });
        Law { white, flicker, deviance }
    }

    /// Calls with the length of the pose, the square's mean under the law, and the square.
    fn each(&self, white: f64, flicker: f64, of_order: &[f64], mut call: impl FnMut(f64, f64, f64)) {
        for pose in &self.poses {
            for (square, g) in pose.squares.iter().zip(of_order) {
                call(pose.length_s, white / pose.length_s + flicker * g, *square);
            }
        }
    }

    /// Leaves out poses that slipped, the worst first; whether there was one.
    fn leave_out(&mut self, law: &Law, of_order: &[f64]) -> bool {
        let size = |p: &Cosines| -> f64 {
            let over = p.squares.iter().zip(of_order).map(|(s, g)| s / (law.white / p.length_s + law.flicker * g));
            over.take(SLIPS).sum()
        };
        let mut found: Vec<(usize, f64)> = self.poses.iter().map(size).enumerate().filter(|p| p.1 > SLIPPED).collect();
        order::sort_by_key(&mut found, |p| -p.1);
        found.truncate(self.poses.len() / ONE_IN);
        let mut place = 0;
        self.poses.retain(|_| {
            place += 1;
            found.iter().all(|f| f.0 != place - 1)
        });
        !found.is_empty()
    }
}

/// Mean squares of √2 cos(πku) over 0 < u < 1 where two values have the covariance −ln|u − v|, of
/// each order k: (2/a)(Si(a) − (1 − cos a)/a) with a = πk, which tends to 1/k.
fn of_order() -> Vec<f64> {
    let over = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
    let mut integral = 0.0;
    let of = |k: usize| {
        // Simpson's rule over the half wave that this order adds.
        const PARTS: usize = 16;
        let (from, width) = (PI * (k - 1) as f64, PI / PARTS as f64);
        let weight = |n: usize| if n == 0 || n == PARTS { 1.0 } else { f64::from(2 + 2 * (n % 2) as u32) };
        integral += (0..=PARTS).map(|n| weight(n) * over(from + n as f64 * width)).sum::<f64>() * width / 3.0;
        let a = PI * k as f64;
        2.0 / a * (integral - (1.0 - a.cos()) / a)
    };
    (1..=MOST_ORDERS).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// White noise of one per reading and flicker of this level as a sum of Gauss–Markov processes,
    /// two to a decade: of equal variance B²/π · ln √10 each, their spectra add up to B²/(πf).
    fn noise(flicker: f64, rows: usize, seed: u64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 4, Stream::Host);
        let kept: Vec<f64> = (-1..10).map(|k| (-10f64.powf(-0.5 * f64::from(k))).exp()).collect();
        let mut states: Vec<f64> = kept.iter().map(|_| rng.normal()).collect();
        let each = (flicker * 10f64.sqrt().ln()).sqrt();
        let mut step = |_| {
            for (state, kept) in states.iter_mut().zip(&kept) {
                *state = kept * *state + (1.0 - kept * kept).sqrt() * rng.normal();
            }
            rng.normal() + each * states.iter().sum::<f64>()
        };
        (0..rows).map(&mut step).collect()
    }

    /// Levels of `noise` in three axes of thirty poses of four seconds.
    fn measured(flicker: f64, seed: u64) -> Vec<(f64, f64)> {
        let columns: Vec<Vec<f64>> = (0..3).map(|n| noise(flicker, 18_000, 3 * seed + n)).collect();
        let mut axes: Vec<(Vec<&[f64]>, f64)> = Vec::new();
        for column in &columns {
            axes.push(((0..30).map(|k| &column[k * 600..k * 600 + 400]).collect(), 0.0));
        }
        levels(&axes, 100.0)
    }

    #[test]
    fn an_order_of_flicker_has_the_mean_square_that_the_kernel_gives() {
        // ∬ −ln|u − v| · 2 cos(πku) cos(πkv) by the midpoint rule, over v − u.
        let direct = |k: f64| -> f64 {
            let of = |w: f64| (1.0 - w) * (PI * k * w).cos() - (PI * k * w).sin() / (PI * k);
            // w = z² takes the edge off the logarithm.
            let points = (0..4000).map(|n| (f64::from(n) + 0.5) / 4000.0);
            points.map(|z| -4.0 * z * (z * z).ln() * of(z * z) / 4000.0).sum()
        };
        let found = of_order();
        for k in [1, 2, 3, 8] {
            assert!((found[k - 1] / direct(k as f64) - 1.0).abs() < 1e-3, "{k}: {} {}", found[k - 1], direct(k as f64));
        }
        assert!((found[200] * 201.0 - 1.0).abs() < 0.01, "{}", found[200]);
    }

    #[test]
    fn flicker_is_measured_where_there_is_some() {
        for flicker in [0.003, 0.03] {
            let each: Vec<f64> = (0..10).flat_map(|s| measured(flicker, s)).map(|l| l.1).collect();
            let mean = each.iter().sum::<f64>() / each.len() as f64;
            assert!((mean / flicker - 1.0).abs() < 0.25, "{flicker}: {mean}");
        }
    }

    #[test]
    fn chance_is_not_flicker() {
        let found = (100..140).filter(|s| measured(0.0, *s).iter().any(|l| l.1 > 0.0)).count();
        // 5 % each: seven of forty come once in a hundred.
        assert!(found < 7, "{found}");
        assert!(measured(0.0, 100).iter().all(|l| (l.0 * 100.0 - 1.0).abs() < 0.1), "{:?}", measured(0.0, 100));
    }
}
