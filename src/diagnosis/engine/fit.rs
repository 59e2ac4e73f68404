//! A set of laws fitted by free simulation, with its record on blocks that were left out.

use nalgebra::DVector;

use super::kind::{Kind, Layout, Linearised, Point, Set};
use super::levels::CLEAR;
use super::linear::Products;

/// Dampings that are tried together where a full step does not lower the sum of squares.
const DAMPINGS: [f64; 8] = [1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0, 300.0, 1e4];
/// A step that lowers n ln(sum of squares) by less than this ends the search.
const CONVERGED: f64 = 0.1;
/// A sum of squares this many times what a linear step promises is not at rest.
const RESTLESS: f64 = 1.05;
/// Steps of a fit at most.
pub(crate) const MOST_STEPS: usize = 25;

/// A fitted set of laws.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Laws next to the base model.
    pub set: Set,
    /// Coordinates at the lowest sum of squares.
    pub point: Point,
    /// Linearised there.
    pub model: Linearised,
    /// Residual of each row under the fit to all other blocks; zero where a row does not count.
    pub held_out: Vec<f64>,
    /// Sum of its squares.
    pub error: f64,
    /// Standard deviation of each shared coordinate: the larger one of scatter between blocks and
    /// white noise.
    pub deviations: Vec<f64>,
    /// Mean square of the fitted residual, for the degrees of freedom spent.
    pub variance: f64,
    /// Which shared coordinates are on a bound.
    pub at_bound: Vec<bool>,
    /// States whether the base model would have to be what no sensor is, such as damped less than not at all.
    pub is_impossible: bool,
}

/// Brings a model to rest from a point; `None` where it breaks down or does not come to rest.
pub(crate) fn fit<K: Kind>(kind: &K, set: &[usize], start: &Point, most: usize) -> Option<Fitted> {
    let (point, model) = lowered(kind, set, start, most)?;
    judged(kind, set, point, model)
}

/// Lowers the sum of squares by at most this many steps and returns the point and the sum, whether or not the fit
/// has converged; `None` where the model breaks down.
pub(crate) fn nearer<K: Kind>(kind: &K, set: &[usize], start: &Point, most: usize) -> Option<(Point, f64)> {
    lowered(kind, set, start, most).map(|(point, model)| (point, squares(&model.residual)))
}

fn lowered<K: Kind>(kind: &K, set: &[usize], start: &Point, most: usize) -> Option<(Point, Linearised)> {
    let mut point = start.clone();
    kind.confine(set, &mut point);
    let rows = kind.layout().rows() as f64;
    let mut model = counted(kind, kind.linearise(set, &point)?);
    for _ in 0..most {
        let products = Products::of(kind.layout(), &model, &outward(kind, set, &point, &model));
        let [sum, promised] = products.sums()?;
        if rows * (sum / promised.max(1e-300)).ln() < 0.5 * CONVERGED || sum <= 0.0 {
            break;
        }
        // Most steps are good as they are: then the next derivatives are at hand at once.
        let full = moved(kind, set, &point, &products.steps(&[0.0])?[0]);
        let lower = |model: &Linearised| squares(&model.residual) < sum;
        let next = kind.linearise(set, &full).map(|m| counted(kind, m)).filter(lower);
        let next = next.map(|model| (full, model)).or_else(|| {
            let points: Vec<Point> = products.steps(&DAMPINGS)?.iter().map(|s| moved(kind, set, &point, s)).collect();
            let counts = &kind.layout().counts;
            let sums = kind.residuals(set, &points).into_iter().map(|residual| {
                let sum: f64 = residual?.iter().zip(counts).filter(|(_, c)| **c).map(|(e, _)| e * e).sum();
                sum.is_finite().then_some(sum)
            });
            let lowest = sums.enumerate().filter_map(|(i, s)| Some((i, s?))).min_by(|a, b| a.1.total_cmp(&b.1));
            let (best, _) = lowest.filter(|(_, s)| *s < sum)?;
            Some((points[best].clone(), counted(kind, kind.linearise(set, &points[best])?)))
        });
        let Some(next) = next else { break };
        (point, model) = next;
        if rows * (sum / squares(&model.residual).max(1e-300)).ln() < CONVERGED {
            break;
        }
    }
    Some((point, model))
}

/// Sum of squares.
pub(super) fn squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

/// The record of a model at a point; `None` where the search has not come to rest there, so that a
/// linear step says nothing of blocks that were left out.
fn judged<K: Kind>(kind: &K, set: &[usize], point: Point, model: Linearised) -> Option<Fitted> {
    let layout = kind.layout();
    let at_bound = kind.at_bound(set, &point);
    let held = outward(kind, set, &point, &model);
    let products = Products::of(layout, &model, &held);
    let left_out = products.left_out(layout, &model)?;
    let [sum, promised] = products.sums()?;
    if sum > RESTLESS * promised {
        return None;
    }
    let spent = model.shared.len() + model.starts.len() * layout.segments.len();
    let variance = sum / (layout.rows() as f64 - spent as f64).max(1.0);
    let inverse = products.inverse()?;
    let by_blocks = scatter(&left_out.steps);
    let deviations =
        (0..model.shared.len()).map(|i| by_blocks[i].max(variance * inverse[(i, i)].max(0.0)).sqrt()).collect();
    let error = left_out.residual.iter().map(|e| e * e).sum();
    let own = if set.is_empty() { held.len() } else { kind.coordinates(set, 0).start };
    let is_impossible = held[..own].contains(&true) && leads_out(layout, &model, &held[..own], variance) == Some(true);
    let held_out = left_out.residual;
    Some(Fitted { set: set.to_vec(), point, model, held_out, error, deviations, variance, at_bound, is_impossible })
}

/// Returns whether a full step takes one of these coordinates beyond the bound it stands on, by more than its 95 %
/// interval.
fn leads_out(layout: &Layout, model: &Linearised, on_bound: &[bool], variance: f64) -> Option<bool> {
    let free = Products::of(layout, model, &[]);
    let (step, inverse) = (free.steps(&[0.0])?.swap_remove(0), free.inverse()?);
    let is_beyond = |i: usize| step.shared[i].abs() > CLEAR * (variance * inverse[(i, i)].max(0.0)).sqrt();
    Some((0..on_bound.len()).any(|i| on_bound[i] && is_beyond(i)))
}

/// Rows that do not count have no residual and no derivatives.
fn counted<K: Kind>(kind: &K, mut model: Linearised) -> Linearised {
    let counts = &kind.layout().counts;
    let columns = model.shared.iter_mut().chain(&mut model.starts).chain(std::iter::once(&mut model.residual));
    for column in columns {
        column.iter_mut().zip(counts).filter(|(_, c)| !**c).for_each(|(v, _)| *v = 0.0);
    }
    model
}

/// Coordinates on a bound that a step would leave behind: they stay.
fn outward<K: Kind>(kind: &K, set: &[usize], point: &Point, model: &Linearised) -> Vec<bool> {
    let mut held = kind.at_bound(set, point);
    if !held.contains(&true) {
        return held;
    }
    let free = Products::of(kind.layout(), model, &[]);
    let step = free.steps(&[1e-4]).map(|mut s| s.remove(0));
    for (i, held) in held.iter_mut().enumerate().filter(|(_, h)| **h) {
        let Some(step) = &step else { continue };
        let mut there = point.clone();
        there.shared[i] += step.shared[i];
        let wanted = there.shared[i];
        kind.confine(set, &mut there);
        *held = (there.shared[i] - wanted).abs() > 1e-9 * (1.0 + wanted.abs());
    }
    held
}

fn moved<K: Kind>(kind: &K, set: &[usize], from: &Point, step: &super::linear::Step) -> Point {
    let mut point = from.clone();
    point.shared.iter_mut().zip(&step.shared).for_each(|(v, s)| *v += s);
    for (start, step) in point.starts.iter_mut().zip(&step.starts) {
        start.iter_mut().zip(step).for_each(|(v, s)| *v += s);
    }
    kind.confine(set, &mut point);
    point
}

/// Variance of each coordinate by leaving each block out once (Tukey's jackknife).
fn scatter(steps: &[DVector<f64>]) -> Vec<f64> {
    let count = steps.len() as f64;
    let Some(first) = steps.first() else { return Vec::new() };
    let mean = steps.iter().fold(DVector::zeros(first.len()), |sum, s| sum + s) / count;
    (0..first.len())
        .map(|i| (count - 1.0) / count * steps.iter().map(|s| (s[i] - mean[i]).powi(2)).sum::<f64>())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    // A coordinate that may not be negative, of size −1/2 or 0 in unit noise, known to 1/√(400/2) = 0.07: the one
    // is seven standard deviations beyond its bound, the other by chance on either side of it.
    #[test]
    fn a_bound_that_the_data_lead_across_is_told_from_one_that_chance_leads_to() {
        let rows = 400;
        let layout = Layout::new(std::iter::once(0..rows).collect(), 40, vec![true; rows]);
        let column = |rate: f64| (0..rows).map(|k| (rate * k as f64).sin()).collect::<Vec<f64>>();
        let beyond = |size: f64, seed: u64| {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let residual = column(0.3).iter().map(|c| size * c + rng.normal()).collect();
            let model = Linearised { residual, shared: vec![column(0.3), column(0.7)], starts: Vec::new() };
            leads_out(&layout, &model, &[true], 1.0) == Some(true)
        };
        assert!((0..50).all(|seed| beyond(-0.5, seed)));
        // By binomial law 5 % of 50 are 2.5, and more than 8 come once in a thousand.
        assert!((0..50).filter(|seed| beyond(0.0, *seed)).count() <= 8);
    }
}
