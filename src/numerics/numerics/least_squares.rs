//! Nonlinear least squares where many trial points cost little more than one: Levenberg–Marquardt
//! whose damping is chosen by trying several at once, and whose steps follow a valley that bends
//! (geodesic acceleration: Transtrum & Sethna, arXiv 1201.5885).
//!
//! Not for deciding whether a fit is good: it returns the minimum and what is needed to judge it.

use super::moments::dot;
use nalgebra::{DMatrix, DVector};

/// Residuals to be made small.
pub trait Residuals {
    /// Residual and its derivatives (one column per coordinate) at a point; `None` where the model
    /// breaks down.
    fn linearise(&self, z: &[f64]) -> Option<Linear>;
    /// Residuals at several points; not finite where the model breaks down.
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Vec<f64>>;
    /// Moves a point into the allowed region.
    fn confine(&self, z: &mut [f64]);
    /// Points that are best tried together.
    fn together(&self) -> usize;
}

/// A residual and its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// Residual, row by row.
    pub residual: Vec<f64>,
    /// Derivative by each coordinate.
    pub columns: Vec<Vec<f64>>,
}

/// Normal equations of a linearised problem, residuals e and derivatives D.
#[derive(Debug, Clone, PartialEq)]
pub struct Normal {
    /// DᵀD, one row and column per parameter.
    pub matrix: DMatrix<f64>,
    /// Dᵀe, one entry per parameter.
    pub vector: DVector<f64>,
    /// eᵀe, the sum of squares.
    pub sum: f64,
}

impl Linear {
    /// Its normal equations.
    pub fn normal(&self) -> Normal {
        let n = self.columns.len();
        let mut matrix = DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                let value = dot(&self.columns[i], &self.columns[j]);
                matrix[(i, j)] = value;
                matrix[(j, i)] = value;
            }
        }
        let vector = DVector::from_iterator(n, self.columns.iter().map(|c| dot(c, &self.residual)));
        Normal { matrix, vector, sum: dot(&self.residual, &self.residual) }
    }
}

impl Normal {
    /// The step that minimises |e + Ds|² + λ|diag(D)s|²; zero where it cannot be had.
    pub fn step(&self, lambda: f64) -> DVector<f64> {
        let inverse = self.inverse(lambda);
        inverse.map_or_else(|| DVector::zeros(self.vector.len()), |inverse| -(inverse * &self.vector))
    }

    /// (DᵀD + λ diag)⁻¹, with directions that the data do not see at all held fast.
    pub fn inverse(&self, lambda: f64) -> Option<DMatrix<f64>> {
        let n = self.matrix.nrows();
        let size = DVector::from_iterator(n, (0..n).map(|i| self.matrix[(i, i)].sqrt().max(1e-150)));
        let mut scaled = DMatrix::from_fn(n, n, |i, j| self.matrix[(i, j)] / (size[i] * size[j]));
        for i in 0..n {
            scaled[(i, i)] = 1.0 + lambda + 1e-12;
        }
        let inverse = scaled.cholesky()?.inverse();
        Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (size[i] * size[j])))
    }

    /// Sum of squares that a full linear step would leave.
    pub fn predicted(&self) -> f64 {
        let step = self.step(1e-9);
        (self.sum + 2.0 * self.vector.dot(&step) + (&self.matrix * &step).dot(&step)).max(0.0)
    }
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Parameter vector at the minimum.
    pub z: Vec<f64>,
    /// Sum of squares there.
    pub sum: f64,
    /// Residual and derivatives there.
    pub linear: Linear,
    /// Says whether a further step promises less than the tolerance, or none that lowers the sum
    /// and has derivatives can be had.
    pub converged: bool,
}

/// Minimises the sum of squares from `start`. Stops when a step gains less than `tolerance` in ½ n
/// ln(sum), the log-likelihood of Gaussian residuals. `None` where the model breaks down at the
/// start; where it does so further on, the search stays at the last good point and takes shorter
/// steps.
pub fn minimise<R: Residuals>(problem: &R, start: &[f64], tolerance: f64, most: usize) -> Option<Minimum> {
    let mut z = start.to_vec();
    problem.confine(&mut z);
    let mut linear = problem.linearise(&z)?;
    let mut normal = linear.normal();
    let mut converged = false;
    let mut centre = 0.0;
    for _ in 0..most {
        let rows = linear.residual.len().max(1) as f64;
        let gain = |to: f64| 0.5 * rows * (normal.sum / to.max(1e-300 + 1e-16 * normal.sum)).ln();
        if gain(normal.predicted()) < 0.5 * tolerance {
            converged = true;
            break;
        }
        let dampings = ladder(centre, problem.together());
        let straight = dampings.iter().map(|lambda| (*lambda, normal.step(*lambda))).collect();
        let mut trials = tried(problem, &z, straight);
        // Where a straight step does as much as it promises, nothing bends.
        let straight = lowest(&trials, normal.sum).map_or(0.0, |k| gain(trials[k].sum));
        if gain(normal.predicted()) - straight > tolerance {
            let bent = trials.iter().filter_map(|t| Some((t.damping, turned(t, &linear, &normal)?))).collect();
            trials.extend(tried(problem, &z, bent));
        }
        // A step to where derivatives break down is no better than one that raises the cost.
        let best = lowest(&trials, normal.sum).map(|k| &trials[k]);
        let Some((best, there)) = best.and_then(|best| Some((best, problem.linearise(&best.point)?))) else {
            if centre >= 1e6 {
                converged = true;
                break;
            }
            centre = if centre == 0.0 { 1e3 } else { centre * 1e4 };
            continue;
        };
        let done = gain(best.sum) < tolerance;
        z.clone_from(&best.point);
        centre = if best.damping > 10.0 { best.damping } else { 0.0 };
        linear = there;
        normal = linear.normal();
        if done {
            converged = true;
            break;
        }
    }
    Some(Minimum { z, sum: normal.sum, linear, converged })
}

/// A place that a step leads to.
struct Trial {
    damping: f64,
    point: Vec<f64>,
    /// The step as it was taken, within the allowed region.
    step: Vec<f64>,
    residual: Vec<f64>,
    /// Sum of its squares; not finite where the model breaks down.
    sum: f64,
}

/// Takes these steps, each of a damping, from a point.
fn tried<R: Residuals>(problem: &R, z: &[f64], steps: Vec<(f64, DVector<f64>)>) -> Vec<Trial> {
    let to = |(_, step): &(f64, DVector<f64>)| {
        let mut point: Vec<f64> = z.iter().zip(step.iter()).map(|(z, s)| z + s).collect();
        problem.confine(&mut point);
        point
    };
    let points: Vec<Vec<f64>> = steps.iter().map(to).collect();
    let residuals = problem.residuals(&points);
    let trial = |((damping, point), residual): ((f64, Vec<f64>), Vec<f64>)| {
        let step = point.iter().zip(z).map(|(to, from)| to - from).collect();
        Trial { damping, step, sum: dot(&residual, &residual), point, residual }
    };
    steps.into_iter().map(|(damping, _)| damping).zip(points).zip(residuals).map(trial).collect()
}

/// Place of the trial that leaves least, if that is less than this.
fn lowest(trials: &[Trial], than: f64) -> Option<usize> {
    let lower = trials.iter().enumerate().filter(|(_, t)| t.sum < than);
    lower.min_by(|a, b| a.1.sum.total_cmp(&b.1.sum)).map(|(k, _)| k)
}

/// The step of a trial with the turn that takes out, to second order, what its residual is off the straight
/// line that the derivatives promise: e + Dv + ½c, so that the turn s minimises |c + 2Ds|² at the same damping.
fn turned(trial: &Trial, linear: &Linear, normal: &Normal) -> Option<DVector<f64>> {
    if !trial.sum.is_finite() {
        return None;
    }
    let mut off: Vec<f64> = trial.residual.iter().zip(&linear.residual).map(|(there, here)| there - here).collect();
    for (column, step) in linear.columns.iter().zip(&trial.step) {
        off.iter_mut().zip(column).for_each(|(o, d)| *o -= step * d);
    }
    let vector = DVector::from_iterator(linear.columns.len(), linear.columns.iter().map(|c| dot(c, &off)));
    let turn = -(normal.inverse(trial.damping)? * vector);
    Some(DVector::from_column_slice(&trial.step) + turn)
}

fn ladder(centre: f64, count: usize) -> Vec<f64> {
    let low = if centre == 0.0 { 1e-4 } else { centre * 1e-4 };
    std::iter::once(centre * 1e-6).chain((0..count.max(2) - 1).map(|k| low * 7f64.powi(k as i32))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as two residuals; the minimum (1, 1) is known.
    struct Rosenbrock;

    impl Residuals for Rosenbrock {
        fn linearise(&self, z: &[f64]) -> Option<Linear> {
            let residual = vec![10.0 * (z[1] - z[0] * z[0]), 1.0 - z[0]];
            Some(Linear { residual, columns: vec![vec![-20.0 * z[0], -1.0], vec![10.0, 0.0]] })
        }
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
            points.iter().map(|z| vec![10.0 * (z[1] - z[0] * z[0]), 1.0 - z[0]]).collect()
        }
        fn confine(&self, _: &mut [f64]) {}
        fn together(&self) -> usize {
            8
        }
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_known_end() {
        let found = minimise(&Rosenbrock, &[-1.2, 1.0], 1e-9, 100).map(|m| m.z).unwrap_or_default();
        assert!((found[0] - 1.0).abs() < 1e-6 && (found[1] - 1.0).abs() < 1e-6, "{found:?}");
    }

    // The residuals are quadratic, so that the first turn is all of the bend: from (−1.2, 1) the straight step
    // ends at x = 1 but 2.2² away from the valley's floor y = x².
    #[test]
    fn a_bend_of_second_order_is_followed_in_one_step() {
        let found = minimise(&Rosenbrock, &[-1.2, 1.0], 1e-9, 1).map(|m| m.z).unwrap_or_default();
        assert!((found[0] - 1.0).abs() < 1e-3 && (found[1] - 1.0).abs() < 1e-3, "{found:?}");
        let straight = Rosenbrock.linearise(&[-1.2, 1.0]).map(|there| there.normal().step(0.0)[1]);
        let off = straight.map(|step| (1.0 + step + 3.84).abs());
        assert!(off.is_some_and(|off| off < 1e-6), "control: the straight step ends off it, {straight:?}");
    }

    /// eᶻ − eᵐ and a small pull on the second coordinate, whose lowest point is (m, 1); beyond the
    /// wall nothing is a number, and derivatives, taken by a step forward, end that step before it.
    struct Walled {
        lowest: f64,
        wall: f64,
    }

    const FORWARD: f64 = 1e-5;

    impl Walled {
        fn errors(&self, z: &[f64]) -> Vec<f64> {
            let first = if z[0] > self.wall { f64::NAN } else { z[0].exp() - self.lowest.exp() };
            vec![first, 0.1 * (z[1] - 1.0)]
        }
    }

    impl Residuals for Walled {
        fn linearise(&self, z: &[f64]) -> Option<Linear> {
            let residual = self.errors(z);
            let column = |moved: [f64; 2]| -> Vec<f64> {
                self.errors(&moved).iter().zip(&residual).map(|(m, e)| (m - e) / FORWARD).collect()
            };
            let columns = vec![column([z[0] + FORWARD, z[1]]), column([z[0], z[1] + FORWARD])];
            let finite = columns.iter().chain([&residual]).flatten().all(|v| v.is_finite());
            finite.then_some(Linear { residual, columns })
        }
        fn residuals(&self, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
            points.iter().map(|z| self.errors(z)).collect()
        }
        fn confine(&self, _: &mut [f64]) {}
        fn together(&self) -> usize {
            8
        }
    }

    #[test]
    fn a_wall_beyond_which_nothing_is_a_number_stops_a_step_and_not_the_search() {
        let end = |lowest: f64, wall: f64, start: f64| {
            minimise(&Walled { lowest, wall }, &[start, -3.0], 1e-12, 200).map(|m| m.z).unwrap_or_default()
        };
        // From below, full steps overshoot the lowest point by far and end beyond the wall.
        for (lowest, wall) in [(2.0, 2.5), (2.0, 2.0 + 2.0 * FORWARD), (0.0, 0.01)] {
            let found = end(lowest, wall, -4.0);
            assert!(found.len() == 2 && (found[0] - lowest).abs() < 1e-4 && (found[1] - 1.0).abs() < 1e-3, "{found:?}");
        }
        // A lowest point at the wall or just beyond the last place with derivatives: as near as
        // they reach.
        for (lowest, wall) in [(2.0, 2.0), (2.0, 2.0 + 0.5 * FORWARD)] {
            let found = end(lowest, wall, 1.9);
            assert!(found.len() == 2 && found[0] <= wall && lowest - found[0] < 0.01, "{found:?}");
        }
        assert!(minimise(&Walled { lowest: 0.0, wall: 1.0 }, &[1.5, 0.0], 1e-12, 200).is_none(), "a broken start");
        assert!(minimise(&Walled { lowest: 0.0, wall: 1.0 }, &[1.0, 0.0], 1e-12, 200).is_none(), "one without slopes");
    }
}
