//! Checks the uncertainty of a named parameter without assuming a parabola: the likelihood that it
//! costs to hold the parameter elsewhere while all others follow (profile likelihood).
//!
//! The ensemble evaluates the grid in one go: each point starts where the others' Gaussian
//! approximation puts them, is simulated, and what they could still absorb is projected out. A
//! check on the interval stated (`interval`), not its source. The strength of a noise has no
//! profile here: it changes no simulation.

use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::numerics::least_squares::Linear;
use crate::numerics::order;
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};
use crate::verdict::Effect;

use super::fit::{Fit, Search};
use super::interval::Spread;
use super::start_search::StartSearch;

/// Points on either side of the best value.
const SIDE: usize = 16;
/// Distance that they reach, in half-widths of the stated interval.
const REACH: f64 = 2.0;
/// Log-likelihood that the 95 % interval gives away: half the 0.95 quantile of χ² with one degree
/// of freedom.
pub const FALL: f64 = 1.920_729;

/// Log-likelihood below which a whole profile is flat.
const FLAT: f64 = 0.1;

/// Profile likelihood of one parameter, the others refitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Effect and parameter, for a legend.
    pub label: String,
    /// Estimate stated in the verdict, in the parameter's unit.
    pub value: f64,
    /// The 95 % interval stated.
    pub ci95: [f64; 2],
    /// Parameter and log-likelihood lost there, ascending.
    pub points: Vec<(f64, f64)>,
}

impl Profile {
    /// Returns where the profile itself crosses the 95 % line on both sides; `None` where it does
    /// not within reach.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let lowest = self.points.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1))?.0;
        let crossing = |outward: Vec<(f64, f64)>| {
            let pair = outward.windows(2).find(|w| w[0].1 < FALL && w[1].1 >= FALL)?;
            let fraction = (FALL - pair[0].1) / (pair[1].1 - pair[0].1);
            Some(pair[0].0 + fraction * (pair[1].0 - pair[0].0))
        };
        let up = crossing(self.points[lowest..].to_vec())?;
        let down = crossing(self.points[..=lowest].iter().rev().copied().collect())?;
        Some([down, up])
    }

    /// A sentence where the profile is flat, or much wider than the interval stated.
    pub fn finding(&self) -> Option<String> {
        let stated = self.ci95[1] - self.ci95[0];
        let most = self.points.iter().map(|p| p.1).fold(0.0, f64::max);
        if most < FLAT {
            return Some(format!("{}: the recording does not depend on its value", self.label));
        }
        let wider = self.interval().is_none_or(|[a, b]| b - a > 1.5 * stated);
        // Still likely at an edge of what was looked at.
        let open = self.points.first().zip(self.points.last()).is_some_and(|(a, b)| a.1.min(b.1) < FALL);
        (wider && open).then(|| {
            let what = "the misfit rises more slowly than the stated interval assumes: the interval is too short";
            format!("{}: {what}", self.label)
        })
    }
}

/// A profile of every parameter of every named effect that a simulation shows, and the labels of
/// those for which the work was spent.
pub fn profiles(
    data: &Data,
    fit: &Fit,
    scales: &Scales,
    effects: &[Effect],
    spread: &Spread,
    budget: Budget,
) -> (Vec<Profile>, Vec<String>) {
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    for effect in effects {
        let simulated = |t: &Term| t.id() == effect.id && t.noise().is_none();
        let Some(index) = fit.structure.terms.iter().position(simulated) else { continue };
        // A force restated in the unit of the input is no parameter of the model.
        let own = fit.structure.terms[index].candidate().parameters.len();
        for (j, stated) in effect.parameters.iter().take(own).enumerate() {
            let place = fit.structure.first[index] + j;
            let Some(free) = fit.free.iter().position(|f| *f == place) else { continue };
            let label = format!("{} {}", effect.id, stated.name);
            if data.work.is_spent(budget) {
                left_out.push(label);
                continue;
            }
            let points = rise(data, fit, scales, free, stated.ci95, spread.dispersion[free]).unwrap_or_default();
            if !points.is_empty() {
                all.push(Profile { label, value: stated.value, ci95: stated.ci95, points });
            }
        }
    }
    (all, left_out)
}

/// Log-likelihood lost over a grid of one free parameter; scatter between blocks beyond the noise's
/// own weighs less.
fn rise(
    data: &Data,
    fit: &Fit,
    scales: &Scales,
    free: usize,
    ci95: [f64; 2],
    dispersion: f64,
) -> Option<Vec<(f64, f64)>> {
    let place = fit.free[free];
    let ensemble = StartSearch::with_held(data, fit, Some(free))?;
    let search = Search::all(data, &fit.structure, &fit.point, scales);
    let centre = search.z(&fit.point);
    // A noise's strength stays: it bends the gain, and where that ends no tangent says.
    let terms = || fit.structure.terms.iter().zip(&fit.structure.first);
    let is_strength =
        |i: usize| terms().any(|(t, first)| t.noise().is_some() && (*first..first + t.values()).contains(&i));
    let moving: Vec<usize> = (0..fit.free.len()).filter(|k| !is_strength(fit.free[*k])).collect();
    let held = moving.iter().position(|k| *k == free)?;
    let columns = moving.iter().map(|k| fit.linear.columns[*k].clone()).collect();
    let inverse = Linear { residual: fit.linear.residual.clone(), columns }.normal().inverse(0.0)?;
    let coordinate = |value: f64| match search.coordinates[place] {
        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => value / scale,
        Coordinate::Log(low, _) => value.max(low).ln(),
        Coordinate::Held => 0.0,
    };
    let (low, high) = (coordinate(ci95[0]), coordinate(ci95[1]));
    let half = REACH * 0.5 * (high - low);
    if half.is_nan() || half <= 0.0 || !half.is_finite() {
        return None;
    }
    let grid: Vec<Vec<f64>> = (0..=2 * SIDE)
        .map(|i| {
            let off = half * (i as f64 / SIDE as f64 - 1.0);
            let mut z = centre.clone();
            moving.iter().enumerate().for_each(|(m, k)| z[*k] += inverse[(m, held)] / inverse[(held, held)] * off);
            search.point(&z)
        })
        .collect();
    let residual = ensemble.unexplained_at(&grid);
    let least = residual.iter().copied().fold(f64::INFINITY, f64::min);
    let rows = fit.linear.residual.len() as f64 / dispersion.max(1.0);
    let mut points: Vec<(f64, f64)> = grid
        .iter()
        .zip(&residual)
        .filter(|(_, s)| s.is_finite())
        .map(|(p, s)| (p[place], 0.5 * rows * (s / least).ln()))
        .collect();
    order::sort_by_key(&mut points, |p| p.0);
    Some(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parabola(width: f64) -> Profile {
        let points = (-16..=16).map(|i| 0.125 * f64::from(i)).map(|t| (3.0 + t, FALL * (t / width).powi(2))).collect();
        Profile { label: "x".into(), value: 3.0, ci95: [2.0, 4.0], points }
    }

    #[test]
    fn a_parabola_gives_its_own_interval_and_a_flat_one_is_reported() {
        let [a, b] = parabola(1.0).interval().unwrap_or_default();
        assert!((a - 2.0).abs() < 1e-12 && (b - 4.0).abs() < 1e-12);
        assert_eq!(parabola(1.0).finding(), None);
        assert!(parabola(5.0).finding().is_some_and(|f| f.contains("too short")));
        assert!(parabola(50.0).finding().is_some_and(|f| f.contains("does not depend on")));
    }
}
