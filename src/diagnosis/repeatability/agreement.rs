//! Tests whether runs of one sensor agree: parameter by parameter, all together, and which run is the odd
//! one.

use nalgebra::{DMatrix, DVector};

use super::parameter::Estimate;
use super::spread::{Measured, Spread, misfit};
use crate::numerics::special::{f_survival, t_quantile};

/// Probability of a difference in one parameter by chance below which it does not agree: the
/// complement of the 95 % intervals that are shown.
const OF_ONE: f64 = 0.05;
/// The same of all parameters together: a false alarm in a hundred sets of runs.
const OF_ALL: f64 = 0.01;

/// One parameter over the runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its place among the parameters.
    pub parameter: usize,
    /// Each run's value and standard error.
    pub runs: Vec<Measured>,
    /// The largest difference between two runs, later less earlier.
    pub difference: f64,
    /// Half its 95 % interval.
    pub half_width: f64,
    /// Probability of such differences between all runs by chance.
    pub p_value: f64,
    /// Mean and spread over the runs.
    pub spread: Option<Spread>,
}

impl Line {
    /// Returns whether the runs agree in it.
    pub fn agrees(&self) -> bool {
        self.p_value >= OF_ONE
    }
}

/// The tests of all parameters together: a difference that many share shows in χ², one of a single parameter in the
/// least likely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// χ²: squared differences over their full covariance.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// Probability of more by chance.
    pub p_value: f64,
    /// Probability of one as unlikely as the least likely parameter among as many (Bonferroni).
    pub least_p_value: f64,
}

impl Joint {
    /// Returns whether the runs agree, by each test at half the level.
    pub fn agrees(&self) -> bool {
        self.p_value.min(self.least_p_value) >= 0.5 * OF_ALL
    }
}

/// Which run is not like the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Odd {
    /// Without this run the others agree, and without no other.
    Run(usize),
    /// No run alone accounts for the disagreement, or more than one does.
    Undecided,
}

/// Runs of one sensor, compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Parameters that every run determines.
    pub lines: Vec<Line>,
    /// All of them together; `None` where there is none.
    pub joint: Option<Joint>,
    /// Asked only where three or more runs disagree.
    pub odd: Option<Odd>,
}

impl Agreement {
    /// Compares two runs or more, of the same parameters.
    pub fn of(runs: &[&Estimate]) -> Self {
        let shared = shared(runs);
        let lines = shared.iter().map(|p| line(runs, *p)).collect();
        let joint = joint(runs, &shared);
        let disagree = joint.is_some_and(|j| !j.agrees());
        let odd = (disagree && runs.len() >= 3).then(|| odd(runs));
        Self { lines, joint, odd }
    }
}

/// Parameters that every run determines.
fn shared(runs: &[&Estimate]) -> Vec<usize> {
    let count = runs.iter().map(|r| r.parameters.len()).min().unwrap_or(0);
    let told = |r: &&Estimate, p: usize| r.determines(p) && r.value[p].is_finite() && r.deviation(p) > 0.0;
    (0..count).filter(|p| runs.iter().all(|r| told(r, *p))).collect()
}

fn line(runs: &[&Estimate], parameter: usize) -> Line {
    let told: Vec<Measured> = runs.iter().map(|r| (r.value[parameter], r.deviation(parameter))).collect();
    let freedom: f64 = runs.iter().map(|r| r.freedom[parameter]).fold(f64::INFINITY, f64::min);
    let pairs = (0..told.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let widest = pairs.map(|(a, b)| (told[b].0 - told[a].0, told[a].1.hypot(told[b].1)));
    let widest = widest.max_by(|a, b| (a.0 / a.1).abs().total_cmp(&(b.0 / b.1).abs()));
    let (difference, deviation) = widest.unwrap_or((0.0, 0.0));
    let between = told.len() as f64 - 1.0;
    Line {
        parameter,
        difference,
        half_width: t_quantile(1.0 - 0.5 * OF_ONE, freedom) * deviation,
        p_value: if between < 1.0 { 1.0 } else { f_survival(misfit(&told, 0.0) / between, between, freedom) },
        spread: Spread::of(&told),
        runs: told,
    }
}

/// Squared distances of the runs from their weighted mean, over their covariances (a generalisation
/// of Hotelling's test to runs of unlike precision).
fn joint(runs: &[&Estimate], shared: &[usize]) -> Option<Joint> {
    if shared.is_empty() || runs.len() < 2 {
        return None;
    }
    let scale: Vec<f64> = shared.iter().map(|p| runs[0].deviation(*p)).collect();
    let count = shared.len();
    let vector =
        |r: &Estimate| DVector::from_fn(count, |i, _| (r.value[shared[i]] - runs[0].value[shared[i]]) / scale[i]);
    let weight = |r: &Estimate| {
        let covariance =
            DMatrix::from_fn(count, count, |i, j| r.covariance[(shared[i], shared[j])] / (scale[i] * scale[j]));
        covariance.cholesky().map(|c| c.inverse())
    };
    let weights: Vec<DMatrix<f64>> = runs.iter().map(|r| weight(r)).collect::<Option<_>>()?;
    let values: Vec<DVector<f64>> = runs.iter().map(|r| vector(r)).collect();
    let total = weights.iter().fold(DMatrix::zeros(count, count), |sum, w| sum + w);
    let sum = weights.iter().zip(&values).fold(DVector::zeros(count), |sum, (w, v)| sum + w * v);
    let mean = total.cholesky()?.solve(&sum);
    let chi_squared: f64 = weights.iter().zip(&values).map(|(w, v)| (v - &mean).dot(&(w * (v - &mean)))).sum();
    let freedom = count as f64 * (runs.len() - 1) as f64;
    // The covariances' own scale is known as well as its least certain part.
    let behind = runs.iter().flat_map(|r| shared.iter().map(|p| r.freedom[*p])).fold(f64::INFINITY, f64::min);
    let p_value = f_survival(chi_squared / freedom, freedom, behind);
    let least = shared.iter().map(|p| line(runs, *p).p_value).fold(1.0, f64::min);
    let least_p_value = (least * count as f64).min(1.0);
    chi_squared.is_finite().then_some(Joint { chi_squared, freedom, p_value, least_p_value })
}

/// Leaves out each run in turn.
fn odd(runs: &[&Estimate]) -> Odd {
    let agrees_without = |left_out: usize| {
        let rest: Vec<&Estimate> = runs.iter().enumerate().filter(|(n, _)| *n != left_out).map(|(_, r)| *r).collect();
        joint(&rest, &shared(runs)).is_some_and(|j| j.agrees())
    };
    let found: Vec<usize> = (0..runs.len()).filter(|n| agrees_without(*n)).collect();
    match found[..] {
        [only] => Odd::Run(only),
        _ => Odd::Undecided,
    }
}
