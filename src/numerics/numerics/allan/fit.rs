//! From an Allan curve to Q, N, B, K, R with honest intervals.
//!
//! Estimate: generalised least squares on the variance at octave-spaced averaging times,
//! coefficients squared and not negative, weights from the exact covariance of overlapping points
//! under the fitted mixture (`covariance`), iterated (a method of wavelet moments: Guerrier et
//! al., *Wavelet-variance-based estimation for composite stochastic processes*, JASA 2013).
//! Intervals: a Monte Carlo test inverted. A hypothetical value of one coefficient, the others
//! fitted under it, is kept when the estimate lies within the central 95 % of what simulated curves
//! would give. So skewness at long times, the wall at zero and the correlation between points are
//! all in the interval. A term whose interval begins at zero is not supported by the data.
//!
//! A filter on the chip lowers the variance of white noise by N² c/τ² at averaging times above its length (the
//! first term of a series in length over τ). Where the shortest octaves are left out, the square of Q may
//! therefore be negative.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

use super::Point;
use super::covariance::Covariance;
use super::fitted::{BAD, Coefficient, Fit};
use super::law::{self, TERMS, Term};
use crate::numerics::non_negative::signed;

/// Simulated curves per test; the same random numbers serve every hypothesis.
const DRAWS: usize = 400;
/// Octaves at the short end that may be left out when they follow no law.
const SHORTEST_DROPPED: usize = 6;
/// Misfit χ² that leaving out an octave must save: two standard deviations squared.
const LEFT_OUT: f64 = 4.0;
/// Relative errors of the laws themselves, on the variance, that are tried in turn.
const DISCREPANCIES: [f64; 8] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6];

/// Fits an Allan curve. `None` for fewer than four octaves or a signal without any variance.
///
/// Where the five terms cannot describe the curve, the shortest octaves are left out (an on-chip
/// filter bends them). If that does not help, the laws are taken as true only to within a share of
/// their value, the smallest that explains the curve: then no point counts for more than the laws
/// are worth, and the intervals are wide as they should be. `tails`: see [`Covariance::with_tails`].
pub fn fit(points: &[Point], rate_hz: f64, tails: f64, rng: &mut impl Rng) -> Option<Fit> {
    let octaves: Vec<Point> = points.iter().copied().filter(Point::on_octave).collect();
    if octaves.len() < 4 || octaves.iter().any(|p| p.variance.is_nan() || p.variance <= 0.0) {
        return None;
    }
    let draws = DMatrix::from_fn(octaves.len(), DRAWS, |_, _| rng.sample::<f64, _>(StandardNormal));
    let drops = 0..=SHORTEST_DROPPED.min(octaves.len() - 4);
    let curve = |d: usize| Curve { is_filtered: d > 0, ..Curve::new(&octaves[d..], rate_hz, tails, &draws) };
    let mut curves: Vec<Curve<'_>> = drops.map(curve).collect();
    let Chosen { left_out, p_value, squares: best, .. } = choose(&mut curves);
    let curve = &curves[left_out];
    let coefficients = std::array::from_fn(|p| curve.interval(p, &best));
    let ratio = |p: &Point| (p.variance / law::variance(&best, p.tau_s)).sqrt();
    let from_s = curve.points[0].tau_s;
    let fitted = points.iter().filter(|p| p.tau_s >= from_s);
    let sure = fitted.filter(|p| p.samples > 20 * p.factor);
    let worst = sure.max_by(|a, b| ratio(a).ln().abs().total_cmp(&ratio(b).ln().abs())).unwrap_or(&curve.points[0]);
    Some(Fit {
        coefficients,
        covariance: curve.whitened(&best).covariance(&best),
        p_value,
        from_s,
        to_s: octaves[octaves.len() - 1].tau_s,
        worst: (worst.tau_s, ratio(worst)),
        discrepancy: curve.discrepancy / 2.0,
        filtered: -Term::Quantisation.variance(1.0) * best[Term::Quantisation as usize].min(0.0),
    })
}

/// A number of octaves that are left out, and what is fitted to the others.
struct Chosen {
    left_out: usize,
    /// Misfit χ², with what the octaves that are left out cost.
    criterion: f64,
    /// Probability of deviations as large by chance.
    p_value: f64,
    squares: [f64; 5],
}

/// The curve with the smallest discrepancy that is described; `p_value` is that without any. Where all octaves are
/// not described, one more is left out as often as it lies two standard deviations away.
fn choose(curves: &mut [Curve<'_>]) -> Chosen {
    let mut without = 0.0;
    for discrepancy in DISCREPANCIES {
        let mut best: Option<Chosen> = None;
        for (left_out, curve) in curves.iter_mut().enumerate() {
            curve.discrepancy = discrepancy;
            let squares = curve.estimate();
            let (misfit, p_value) = curve.quality(&squares);
            if discrepancy == 0.0 && left_out == 0 {
                without = p_value;
            }
            let criterion = misfit + LEFT_OUT * left_out as f64;
            let is_better = best.as_ref().is_none_or(|b| criterion < b.criterion);
            if p_value >= BAD && is_better && squares.iter().all(|s| s.is_finite()) {
                let p_value = if discrepancy == 0.0 { p_value } else { without };
                best = Some(Chosen { left_out, criterion, p_value, squares });
            }
            if left_out == 0 && best.is_some() {
                break;
            }
        }
        if let Some(chosen) = best {
            return chosen;
        }
    }
    Chosen { left_out: 0, criterion: f64::INFINITY, p_value: without, squares: curves[0].estimate() }
}

/// Octave points with what their fit needs.
struct Curve<'a> {
    points: &'a [Point],
    covariance: Covariance,
    /// Allan variances per unit of each squared coefficient.
    laws: DMatrix<f64>,
    measured: DVector<f64>,
    draws: &'a DMatrix<f64>,
    /// Relative error of the laws, on the variance.
    discrepancy: f64,
    /// States whether the square of Q may be negative.
    is_filtered: bool,
}

/// Least squares under one covariance: everything is divided by its Cholesky factor.
struct Whitened {
    factor: DMatrix<f64>,
    laws: DMatrix<f64>,
    normal: [[f64; 5]; 5],
    is_filtered: bool,
}

impl<'a> Curve<'a> {
    fn new(points: &'a [Point], rate_hz: f64, tails: f64, draws: &'a DMatrix<f64>) -> Self {
        let factors: Vec<usize> = points.iter().map(|p| p.factor).collect();
        let samples: Vec<usize> = points.iter().map(|p| p.samples).collect();
        Self {
            points,
            covariance: Covariance::new(&factors, &samples, rate_hz).with_tails(tails),
            laws: DMatrix::from_fn(points.len(), 5, |i, p| TERMS[p].variance(points[i].tau_s)),
            measured: DVector::from_fn(points.len(), |i, _| points[i].variance),
            draws,
            discrepancy: 0.0,
            is_filtered: false,
        }
    }

    /// Covariance of two points: of chance, and of the laws' own error.
    fn covariance(&self, i: usize, j: usize, squares: &[f64; 5]) -> f64 {
        // What a filter takes is not taken from the chance of what it leaves: intervals err to the wide side.
        let chance = self.covariance.at(i, j, &squares.map(|s| s.max(0.0)));
        if i != j {
            return chance;
        }
        chance + (self.discrepancy * law::variance(squares, self.points[i].tau_s)).powi(2)
    }

    fn whitened(&self, squares: &[f64; 5]) -> Whitened {
        let count = self.points.len();
        let mut matrix = DMatrix::from_fn(count, count, |i, j| self.covariance(i, j, squares));
        // Lags are summed in steps and far pairs left out, so the matrix may miss being positive by
        // a little; what cannot be repaired (an overflow) is treated as uncorrelated.
        let mut factor = None;
        for _ in 0..50 {
            factor = matrix.clone().cholesky().map(|c| c.unpack());
            if factor.is_some() {
                break;
            }
            (0..count).for_each(|i| (0..count).filter(|j| *j != i).for_each(|j| matrix[(i, j)] *= 0.9));
        }
        let spread = || DVector::from_fn(count, |i, _| matrix[(i, i)].sqrt().max(f64::MIN_POSITIVE));
        let factor = factor.unwrap_or_else(|| DMatrix::from_diagonal(&spread()));
        let laws = solve_lower(&factor, &self.laws);
        let normal = square(&laws);
        Whitened { factor, laws, normal, is_filtered: self.is_filtered }
    }

    fn estimate(&self) -> [f64; 5] {
        // A first guess with white-noise weights: the variance's spread is its value over the root
        // of the windows.
        let weight =
            |i: usize| self.measured[i] * (self.points[i].factor as f64 / self.points[i].samples as f64).sqrt();
        let laws = DMatrix::from_fn(self.points.len(), 5, |i, p| self.laws[(i, p)] / weight(i));
        let measured = DVector::from_fn(self.points.len(), |i, _| self.measured[i] / weight(i));
        let target = from_column(laws.tr_mul(&measured).as_slice());
        let mut squares = signed(&square(&laws), &target, &[true; 5], self.is_filtered);
        for _ in 0..6 {
            squares = self.whitened(&squares).solve(&self.measured, &[true; 5]);
        }
        squares
    }

    /// Misfit χ², and the probability of a worse one by chance.
    fn quality(&self, squares: &[f64; 5]) -> (f64, f64) {
        let whitened = self.whitened(squares);
        let misfits = |curves: &DMatrix<f64>| -> Vec<f64> {
            let curves = solve_lower(&whitened.factor, curves);
            let fitted = whitened.solve_whitened(&curves, &[true; 5]);
            let misfit =
                |c: usize| (curves.column(c) - &whitened.laws * DVector::from(fitted[c].to_vec())).norm_squared();
            (0..fitted.len()).map(misfit).collect()
        };
        let measured = misfits(&as_matrix(&self.measured))[0];
        let simulated = misfits(&self.simulate(squares, &whitened));
        let worse = simulated.iter().filter(|s| **s >= measured).count();
        (measured, (worse + 1) as f64 / (simulated.len() + 1) as f64)
    }

    /// Curves (one per column) as chance would give them: each point a scaled χ² with its own
    /// degrees of freedom (Wilson–Hilferty), joined by the points' correlation.
    fn simulate(&self, squares: &[f64; 5], whitened: &Whitened) -> DMatrix<f64> {
        let count = self.points.len();
        let mut curves = &whitened.factor * self.draws.rows(self.draws.nrows() - count, count);
        for i in 0..count {
            let mean = law::variance(squares, self.points[i].tau_s).max(f64::MIN_POSITIVE);
            let spread = self.covariance(i, i, squares).sqrt();
            let cube_root_variance = (spread / mean).powi(2) / 9.0;
            for value in curves.row_mut(i).iter_mut() {
                *value =
                    mean * (1.0 - cube_root_variance + *value / spread * cube_root_variance.sqrt()).max(0.0).powi(3);
            }
        }
        curves
    }

    /// Fractions of simulated estimates of coefficient `p` at or above, and at or below, the one
    /// measured, if its square were `value`.
    fn tail_probabilities(&self, p: usize, value: f64, best: &[f64; 5]) -> (f64, f64) {
        let mut free = [true; 5];
        free[p] = false;
        let rest = &self.measured - self.laws.column(p) * value;
        let mut hypothesis = *best;
        for _ in 0..2 {
            hypothesis = self.whitened(&hypothesis).solve(&rest, &free);
            hypothesis[p] = value;
        }
        let whitened = self.whitened(&hypothesis);
        let (mut above, mut below) = (0, 0);
        for simulated in whitened.solve_all(&self.simulate(&hypothesis, &whitened), &[true; 5]) {
            above += usize::from(simulated[p] >= best[p]);
            below += usize::from(simulated[p] <= best[p]);
        }
        let probability = |count: usize| (count + 1) as f64 / (DRAWS + 1) as f64;
        (probability(above), probability(below))
    }

    fn interval(&self, p: usize, best: &[f64; 5]) -> Coefficient {
        const TAIL: f64 = 0.025;
        let p_value = if best[p] > 0.0 { self.tail_probabilities(p, 0.0, best).0 } else { 1.0 };
        let low =
            if p_value > TAIL { 0.0 } else { crossing(0.0, best[p], |v| self.tail_probabilities(p, v, best).0 > TAIL) };
        // The first step up: as large as the term could be at its best point.
        let ceiling =
            (0..self.points.len()).map(|i| self.measured[i] / self.laws[(i, p)]).fold(f64::INFINITY, f64::min);
        if best[p] < 0.0 {
            // A filter hides it.
            return Coefficient { value: 0.0, ci95: [0.0, ceiling.sqrt()], p_value };
        }
        let mut beyond = best[p].max(1e-6 * ceiling);
        let mut inside = best[p];
        for _ in 0..60 {
            if self.tail_probabilities(p, beyond, best).1 <= TAIL {
                break;
            }
            (inside, beyond) = (beyond, beyond * 2.0);
        }
        let high = crossing(inside, beyond, |v| self.tail_probabilities(p, v, best).1 <= TAIL);
        Coefficient { value: best[p].sqrt(), ci95: [low.sqrt(), high.sqrt()], p_value }
    }
}

/// Standard errors of the logarithms of the coefficients that a fit to a log of this many samples would
/// have, were these the squared coefficients; infinite of those that are zero.
pub fn expected_errors(squares: &[f64; 5], rate_hz: f64, samples: usize) -> [f64; 5] {
    let octaves = (0..usize::BITS).map(|power| 1usize << power).take_while(|factor| *factor <= samples / 3);
    let at = |factor: usize| {
        let tau_s = factor as f64 / rate_hz;
        Point { factor, tau_s, variance: law::variance(squares, tau_s), samples }
    };
    let points: Vec<Point> = octaves.map(at).collect();
    let covariance = Curve::new(&points, rate_hz, 0.0, &DMatrix::zeros(0, 0)).whitened(squares).covariance(squares);
    std::array::from_fn(|p| match squares[p] > 0.0 {
        true => covariance[p][p].sqrt() / (2.0 * squares[p]),
        false => f64::INFINITY,
    })
}

impl Whitened {
    /// Covariance of squared coefficients of which those that are zero are held there.
    fn covariance(&self, squares: &[f64; 5]) -> [[f64; 5]; 5] {
        let free: Vec<usize> = (0..5).filter(|p| squares[*p] != 0.0).collect();
        let scale = |p: usize| self.normal[p][p].sqrt();
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            self.normal[free[i]][free[j]] / (scale(free[i]) * scale(free[j]))
        });
        let inverse = matrix.try_inverse();
        let mut out = [[0.0; 5]; 5];
        for (i, p) in free.iter().enumerate() {
            for (j, q) in free.iter().enumerate() {
                out[*p][*q] = inverse.as_ref().map_or(f64::INFINITY, |m| m[(i, j)] / (scale(*p) * scale(*q)));
            }
        }
        out
    }

    fn solve(&self, curve: &DVector<f64>, free: &[bool; 5]) -> [f64; 5] {
        self.solve_all(&as_matrix(curve), free)[0]
    }

    /// Squared coefficients of each column.
    fn solve_all(&self, curves: &DMatrix<f64>, free: &[bool; 5]) -> Vec<[f64; 5]> {
        self.solve_whitened(&solve_lower(&self.factor, curves), free)
    }

    fn solve_whitened(&self, curves: &DMatrix<f64>, free: &[bool; 5]) -> Vec<[f64; 5]> {
        let targets = self.laws.tr_mul(curves);
        let solve = |target: &[f64]| signed(&self.normal, &from_column(target), free, self.is_filtered);
        targets.column_iter().map(|target| solve(target.as_slice())).collect()
    }
}

/// Normal matrix of a design with five columns.
fn square(laws: &DMatrix<f64>) -> [[f64; 5]; 5] {
    let normal = laws.tr_mul(laws);
    std::array::from_fn(|p| std::array::from_fn(|q| normal[(p, q)]))
}

fn from_column(values: &[f64]) -> [f64; 5] {
    std::array::from_fn(|p| values[p])
}

fn as_matrix(curve: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(curve.len(), 1, curve.as_slice())
}

fn solve_lower(factor: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    // The diagonal of a Cholesky factor is positive, so this cannot fail.
    factor.solve_lower_triangular(right).unwrap_or_else(|| DMatrix::zeros(right.nrows(), right.ncols()))
}

/// Finds where a test first holds between two ends, by bisection of the square root.
fn crossing(from: f64, to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut from, mut to) = (from.sqrt(), to.sqrt());
    for _ in 0..9 {
        let middle = (from + to) / 2.0;
        if holds(middle * middle) { to = middle } else { from = middle }
    }
    (from + to).powi(2) / 4.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_four_times_as_long_halves_the_error_of_white_noise_and_shows_nothing_that_is_absent() {
        let errors = [1 << 14, 1 << 16].map(|samples| expected_errors(&[0.0, 1.0, 0.0, 0.0, 0.0], 100.0, samples));
        // Alone, white noise is known as the variance of all samples is: ln N errs by 1/√(2n). The Allan curve at
        // octaves keeps two thirds of that information or more (Greenhall & Riley's degrees of freedom).
        let best = (2.0 * f64::from(1 << 14)).sqrt().recip();
        assert!((1.0..1.3).contains(&(errors[0][1] / best)), "{}", errors[0][1] / best);
        assert!((errors[0][1] / errors[1][1] - 2.0).abs() < 0.05, "{errors:?}");
        assert!(errors[0][3].is_infinite());
    }
}
