//! Search for start values: where to begin with a candidate whose misfit has several local minima.
//!
//! A grid of start values around the fitted model is simulated freely, eight at a time, and each is
//! judged by what it would leave after the parameters fitted so far had moved along: its errors
//! less their projection on the model's own derivatives. The best few are where the fit begins, on
//! the way along which those parameters move: a sharp resonance is detuned by a spring that they do
//! not follow, and far above what it began with a fit would have nowhere to go. Not for noise terms,
//! which no free simulation shows.

use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::driven::simulation::structure::ModelStructure;
use crate::numerics::least_squares::{Linear, Residuals};
use crate::numerics::order;
use crate::parallel;
use crate::physics::law::StartGrid;
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};
use crate::physics::state::LANES;

use super::fit::{Fit, Search};

/// A model, and the directions of error that it can still absorb.
pub struct StartSearch<'a> {
    data: &'a Data,
    fit: &'a Fit,
    basis: Vec<Vec<f64>>,
}

/// A model with one more term, run freely over a recording.
struct Way<'s> {
    structure: &'s ModelStructure,
    /// Its point where that term is absent.
    none: &'s [f64],
    /// Place of the term's first parameter.
    first: usize,
    run: Run,
}

/// A place where a fit may begin.
#[derive(Debug, Clone)]
struct Start {
    /// Sum of squares that it would leave.
    left: f64,
    point: Vec<f64>,
    /// Factor on the term's strength at which that is left, where the point has it all but absent.
    times: Option<f64>,
}

impl<'a> StartSearch<'a> {
    /// Around a model fitted to this data; `None` where it has noise terms, which no free
    /// simulation shows.
    pub fn around(data: &'a Data, fit: &'a Fit) -> Option<Self> {
        if fit.structure.is_noisy() { None } else { Self::with_held(data, fit, None) }
    }

    /// Around any model, with one free parameter, by its place among them, held where each point
    /// puts it.
    pub fn with_held(data: &'a Data, fit: &'a Fit, held: Option<usize>) -> Option<Self> {
        if fit.linear.residual.len() != data.train_len() {
            return None;
        }
        let columns = fit.linear.columns.iter().enumerate().filter(|(i, _)| Some(*i) != held).map(|c| c.1);
        Some(Self { data, fit, basis: basis(columns) })
    }

    /// The most promising starts of a term's start grid, best first, as points of the model with it;
    /// `None` where it has none.
    pub fn starts(&self, term: Term, scales: &Scales, most: usize) -> Option<Vec<Vec<f64>>> {
        let (values, is_strength) = match term.start_grid(scales)? {
            StartGrid::Points(values) => (values, false),
            StartGrid::Directions { strength, directions } => {
                let of = |direction: Vec<f64>| std::iter::once(strength).chain(direction).collect();
                (directions.into_iter().map(of).collect(), true)
            }
        };
        let mut none = values.first()?.clone();
        *none.first_mut()? = 0.0;
        let (structure, none) = self.fit.with(term, &none);
        let points: Vec<Vec<f64>> = values.iter().map(|values| self.fit.with(term, values).1).collect();
        let steps = points.iter().map(|p| structure.coarse_steps(p, scales)).max()?.max(self.fit.steps);
        let way = Way {
            first: structure.block(structure.terms.len() - 1).start,
            structure: &structure,
            none: &none,
            run: Run { range: self.data.hull.clone(), steps, corrected: false },
        };
        let mut ranked = if is_strength { self.along(&way, points) } else { self.there(&way, points) };
        // A strength that has one sign alone is none at the other.
        let has_one_sign = matches!(term.coordinates(scales)[0], Coordinate::Bounded(_, low, _) if low >= 0.0);
        ranked
            .retain(|start| start.left.is_finite() && !(has_one_sign && start.times.is_some_and(|times| times <= 0.0)));
        order::sort_by_key(&mut ranked, |start| start.left);
        Some(self.moved_along(&way, &apart(ranked, way.first + 1, most), scales))
    }

    /// These points, and what each would leave.
    fn there(&self, way: &Way<'_>, points: Vec<Vec<f64>>) -> Vec<Start> {
        let left = self.unexplained(way.structure, &points, &way.run);
        left.into_iter().zip(points).map(|(left, point)| Start { left, point, times: None }).collect()
    }

    /// These points, at which the term is all but absent, and what each would leave if its strength were the
    /// best one, as far as it acts in proportion.
    fn along(&self, way: &Way<'_>, points: Vec<Vec<f64>>) -> Vec<Start> {
        let rows = self.rows();
        let of_group = |_, group: &[Vec<f64>]| {
            let mut lanes = vec![way.none.to_vec()];
            lanes.extend_from_slice(group);
            let lanes = innovations(self.data, way.structure, &lanes, &way.run, &mut Nothing);
            let mut none: Vec<f64> = rows.iter().map(|k| lanes[*k][0]).collect();
            self.basis.iter().for_each(|b| remove(&mut none, b));
            let start = |(l, point): (usize, &Vec<f64>)| {
                let mut effect: Vec<f64> = rows.iter().map(|k| lanes[*k][l + 1] - lanes[*k][0]).collect();
                self.basis.iter().for_each(|b| remove(&mut effect, b));
                let (shared, own) = (dot(&effect, &none), dot(&effect, &effect));
                let left = dot(&none, &none) - shared * shared / own;
                Start { left, point: point.clone(), times: Some(-shared / own) }
            };
            group.iter().enumerate().map(start).collect::<Vec<_>>()
        };
        parallel::map_chunks(&points, LANES - 1, of_group).into_iter().flatten().collect()
    }

    /// Each start at the place that leaves least on the way along which the model's own parameters
    /// move, as far as they act in proportion: a whole way, half of it, a quarter and so on.
    fn moved_along(&self, way: &Way<'_>, starts: &[Start], scales: &Scales) -> Vec<Vec<f64>> {
        let rows = self.rows();
        let at = |points: &[Vec<f64>]| innovations(self.data, way.structure, points, &way.run, &mut Nothing);
        let search = Search::all(self.data, &self.fit.structure, &self.fit.point, scales);
        let begin = search.z(&self.fit.point);
        let moved = |start: &Start| -> Option<Vec<f64>> {
            let times = start.times.unwrap_or(1.0);
            let lanes = at(&[way.none.to_vec(), start.point.clone()]);
            let expected = |k: &usize| lanes[*k][0] + times * (lanes[*k][1] - lanes[*k][0]);
            let residual = rows.iter().map(expected).collect();
            let step = Linear { residual, columns: self.fit.linear.columns.clone() }.normal().step(1e-9);
            let place = |part: f64| {
                let own = search.free.iter().zip(&self.fit.slopes).zip(step.iter());
                let z = own
                    .zip(&begin)
                    .map(|(((i, slope), step), z)| z + part * step * slope / search.slope(*i, &self.fit.point));
                let mut z: Vec<f64> = z.collect();
                search.confine(&mut z);
                let mut point = start.point.clone();
                let base = search.point(&z);
                point[..base.len()].copy_from_slice(&base);
                point[way.first] *= start.times.map_or(1.0, |times| part * times);
                point
            };
            let places: [Vec<f64>; LANES] = std::array::from_fn(|k| place(0.5f64.powi(k as i32)));
            let lanes = at(&places);
            let left = |l: usize| rows.iter().map(|k| lanes[*k][l].powi(2)).sum::<f64>();
            let left: Vec<f64> = (0..LANES).map(left).collect();
            let best = (0..LANES).filter(|l| left[*l].is_finite()).min_by(|a, b| left[*a].total_cmp(&left[*b]));
            best.map(|l| places[l].clone())
        };
        starts.iter().filter_map(moved).collect()
    }

    /// The fitted rows, counted from the beginning of a run over the whole recording.
    fn rows(&self) -> Vec<usize> {
        self.data.train.iter().flat_map(|r| r.clone()).map(|k| k - self.data.hull.start).collect()
    }

    /// Sum of squares that points of the fitted model leave once its other parameters have moved along.
    pub fn unexplained_at(&self, points: &[Vec<f64>]) -> Vec<f64> {
        self.unexplained(&self.fit.structure, points, &self.fit.run(self.data, true))
    }

    /// Sum of squares that each point leaves once the model's own parameters have moved along: of its errors,
    /// less their projection on the model's derivatives.
    fn unexplained(&self, structure: &ModelStructure, points: &[Vec<f64>], run: &Run) -> Vec<f64> {
        let rows = self.rows();
        let of_group = |_, group: &[Vec<f64>]| {
            let lanes = innovations(self.data, structure, group, run, &mut Nothing);
            let one = |l: usize| {
                let sum: f64 = rows.iter().map(|k| lanes[*k][l].powi(2)).sum();
                let along = |b: &Vec<f64>| rows.iter().zip(b).map(|(k, b)| lanes[*k][l] * b).sum::<f64>().powi(2);
                sum - self.basis.iter().map(along).sum::<f64>()
            };
            (0..group.len()).map(one).collect::<Vec<f64>>()
        };
        parallel::map_chunks(points, LANES, of_group).concat()
    }
}

/// An orthonormal basis of columns on the fitted rows: modified Gram–Schmidt, twice.
fn basis<'c>(columns: impl Iterator<Item = &'c Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let mut rest = column.clone();
        let size = dot(&rest, &rest);
        for _ in 0..2 {
            basis.iter().for_each(|b| remove(&mut rest, b));
        }
        let residual = dot(&rest, &rest);
        // What is all but a sum of the others adds only rounding.
        if residual > 1e-8 * size {
            let norm = residual.sqrt();
            rest.iter_mut().for_each(|r| *r /= norm);
            basis.push(rest);
        }
    }
    basis
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Takes its part along a unit vector out of a column.
fn remove(column: &mut [f64], unit: &[f64]) {
    let along = dot(unit, column);
    column.iter_mut().zip(unit).for_each(|(c, u)| *c -= along * u);
}

/// The first of a ranking and those that lie apart from all taken before: another valley, perhaps.
/// They are apart by this parameter, which sets the scale: gap, rail, yield displacement, frequency.
fn apart(ranked: Vec<Start>, by: usize, most: usize) -> Vec<Start> {
    let mut taken: Vec<Start> = Vec::new();
    for start in ranked {
        let near = |other: &Start| {
            let of = |start: &Start| start.point.get(by).copied().unwrap_or(0.0);
            (of(&start) - of(other)).abs() < 0.06 * of(&start).abs().max(of(other).abs())
        };
        if taken.len() < most && !taken.iter().any(near) {
            taken.push(start);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_the_best_are_passed_over() {
        let ranked = [vec![0.0, 10.0, 0.1], vec![1.0, 10.5, 0.1], vec![0.0, 20.0, 0.1]];
        let start = |point: &Vec<f64>| Start { left: 0.0, point: point.clone(), times: None };
        let chosen = apart(ranked.iter().map(start).collect(), 1, 2);
        assert_eq!(chosen.into_iter().map(|s| s.point).collect::<Vec<_>>(), [ranked[0].clone(), ranked[2].clone()]);
    }
}
