//! Search for start values: where to begin with a candidate whose misfit has several local minima.
//!
//! A grid of start values around the fitted model is simulated freely, eight at a time, and each is
//! judged by what it would leave after the parameters fitted so far had moved along: its errors
//! less their projection on the model's own derivatives. The best few are where the fit begins. Not
//! for noise terms, which no free simulation shows.

use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::driven::simulation::structure::ModelStructure;
use crate::numerics::order;
use crate::parallel;
use crate::physics::law::StartGrid;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::physics::state::LANES;

use super::fit::Fit;

/// A model, and the directions of error that it can still absorb.
pub struct StartSearch<'a> {
    data: &'a Data,
    fit: &'a Fit,
    basis: Vec<Vec<f64>>,
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

    /// The most promising starts of a term's start grid, best first; `None` where it has none.
    pub fn starts(&self, term: Term, scales: &Scales, most: usize) -> Option<Vec<Vec<f64>>> {
        let grid = term.start_grid(scales)?;
        let points = match &grid {
            StartGrid::Points(points) => points.clone(),
            StartGrid::Directions { strength, directions } => {
                let with = |s: f64, direction: &Vec<f64>| std::iter::once(s).chain(direction.iter().copied()).collect();
                let pairs =
                    directions.iter().flat_map(|direction| [with(*strength, direction), with(-strength, direction)]);
                std::iter::once(with(0.0, directions.first()?)).chain(pairs).collect::<Vec<Vec<f64>>>()
            }
        };
        let residual = self.residuals(term, &points, scales)?;
        let mut ranked: Vec<(f64, Vec<f64>)> = match grid {
            StartGrid::Points(_) => residual.into_iter().zip(points).collect(),
            StartGrid::Directions { strength, directions } => {
                let (none, pairs) = residual.split_first()?;
                let vertex = |(pair, direction): (&[f64], Vec<f64>)| {
                    let (best, least) = parabola(*none, pair[0], pair[1]);
                    (least, std::iter::once(best * strength).chain(direction).collect())
                };
                pairs.chunks_exact(2).zip(directions).map(vertex).collect()
            }
        };
        ranked.retain(|r| r.0.is_finite());
        order::sort_by_key(&mut ranked, |r| r.0);
        Some(apart(ranked.into_iter().map(|r| r.1), most))
    }

    /// Sum of squares that each point leaves on the fitted rows after the model's own parameters
    /// have moved along.
    fn residuals(&self, term: Term, points: &[Vec<f64>], scales: &Scales) -> Option<Vec<f64>> {
        let models: Vec<(ModelStructure, Vec<f64>)> = points.iter().map(|p| self.fit.with(term, p)).collect();
        let (structure, _) = models.first()?;
        let steps = models.iter().map(|m| structure.coarse_steps(&m.1, scales)).max()?.max(self.fit.steps);
        let points: Vec<Vec<f64>> = models.iter().map(|m| m.1.clone()).collect();
        Some(self.unexplained(structure, &points, &Run { range: self.data.hull.clone(), steps, corrected: false }))
    }

    /// The same for points of the fitted model itself.
    pub fn unexplained_at(&self, points: &[Vec<f64>]) -> Vec<f64> {
        self.unexplained(&self.fit.structure, points, &self.fit.run(self.data, true))
    }

    /// Returns the residual of the errors at each point after their projection on the model's
    /// derivatives.
    fn unexplained(&self, structure: &ModelStructure, points: &[Vec<f64>], run: &Run) -> Vec<f64> {
        let rows: Vec<usize> = self.data.train.iter().flat_map(|r| r.clone()).map(|k| k - run.range.start).collect();
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
            for b in &basis {
                let along = dot(b, &rest);
                rest.iter_mut().zip(b).for_each(|(r, b)| *r -= along * b);
            }
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

/// Lowest point of a parabola through values at 0, 1 and −1, and its value there; no further out
/// than 3.
fn parabola(none: f64, plus: f64, minus: f64) -> (f64, f64) {
    let (slope, bend) = (0.5 * (plus - minus), 0.5 * (plus + minus) - none);
    if bend.is_nan() || bend <= 0.0 {
        return if plus < minus { (1.0, plus) } else { (-1.0, minus) };
    }
    let at = (-0.5 * slope / bend).clamp(-3.0, 3.0);
    (at, none + at * (slope + at * bend))
}

/// The first of a ranking and those that lie apart from all taken before: another valley, perhaps.
fn apart(ranked: impl Iterator<Item = Vec<f64>>, most: usize) -> Vec<Vec<f64>> {
    let mut taken: Vec<Vec<f64>> = Vec::new();
    for point in ranked {
        // By the second parameter, which sets the scale: gap, rail, yield displacement, frequency.
        let near = |other: &Vec<f64>| {
            let (here, there) = (point.get(1).unwrap_or(&0.0), other.get(1).unwrap_or(&0.0));
            (here - there).abs() < 0.06 * here.abs().max(there.abs())
        };
        if taken.len() < most && !taken.iter().any(near) {
            taken.push(point);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_vertex_where_calculus_says() {
        // 5 − 3a + 2a²: lowest at 3/4, 5 − 9/8 there.
        let (at, least) = parabola(5.0, 4.0, 10.0);
        assert!((at - 0.75).abs() < 1e-12 && (least - 3.875).abs() < 1e-12);
        assert_eq!(parabola(5.0, 4.0, 6.0), (1.0, 4.0));
    }

    #[test]
    fn neighbours_of_the_best_are_passed_over() {
        let ranked = [vec![0.0, 10.0, 0.1], vec![1.0, 10.5, 0.1], vec![0.0, 20.0, 0.1]];
        assert_eq!(apart(ranked.clone().into_iter(), 2), vec![ranked[0].clone(), ranked[2].clone()]);
    }
}
