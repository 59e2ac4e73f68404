//! Search for start values: where to begin with a candidate whose misfit has several valleys.
//!
//! A cloud of points around the fitted model is simulated freely by the misfit kernel, and each is judged by what it would
//! leave after the parameters fitted so far had moved along: its errors less their projection on the model's own
//! derivatives. The best few are where the fit begins. Not for noise terms, which no free simulation shows.

use crate::backend::misfits::evaluate;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::intake::input::Input;
use crate::diagnosis::driven::simulation::filter::Nothing;
use crate::diagnosis::driven::simulation::run::innovations;
use crate::diagnosis::driven::simulation::shape::Shape;
use crate::diagnosis::driven::terms::base::{BASE, GAIN, INITIAL, OFFSET, OMEGA, ZETA};
use crate::diagnosis::driven::terms::law::{self, Cloud};
use crate::diagnosis::driven::terms::scales::Scales;
use crate::diagnosis::driven::terms::term::Term;
use crate::kernel::cpu::lanes::LANES;
use crate::kernel::misfit::{Job, MOST_DIRECTIONS, Misfit, Point, Units};
use crate::numerics::order;
use crate::parallel;

use super::fit::Fit;

/// A model and what it can still take up.
pub struct StartSearch<'a> {
    data: &'a Data,
    fit: &'a Fit,
    units: Units,
    basis: Vec<Vec<f64>>,
}

impl<'a> StartSearch<'a> {
    /// Around a model fitted to this data; `None` where the kernel does not have one of its terms.
    pub fn around(data: &'a Data, fit: &'a Fit, scales: &Scales) -> Option<Self> {
        placed(&fit.shape, &fit.point)?;
        Self::but(data, fit, scales, None)
    }

    /// Around any model, with one free parameter, by its place among them, held where each point puts it.
    pub fn but(data: &'a Data, fit: &'a Fit, scales: &Scales, held: Option<usize>) -> Option<Self> {
        if fit.linear.residual.len() != data.train_len() {
            return None;
        }
        let columns = fit.linear.columns.iter().enumerate().filter(|(i, _)| Some(*i) != held).map(|c| c.1);
        let input = if scales.input > 0.0 { scales.input } else { 1.0 };
        let units = Units { output: scales.output, input, interval_s: scales.interval_s };
        Some(Self { data, fit, units, basis: basis(data, columns) })
    }

    /// The starts of a term's cloud that promise most, best first; `None` where it has no cloud.
    pub fn starts(&self, term: Term, scales: &Scales, most: usize) -> Option<Vec<Vec<f64>>> {
        let cloud = term.cloud(scales)?;
        let points = match &cloud {
            Cloud::Points(points) => points.clone(),
            Cloud::Shapes { strength, shapes } => {
                let with = |s: f64, shape: &Vec<f64>| std::iter::once(s).chain(shape.iter().copied()).collect();
                let pairs = shapes.iter().flat_map(|shape| [with(*strength, shape), with(-strength, shape)]);
                std::iter::once(with(0.0, shapes.first()?)).chain(pairs).collect::<Vec<Vec<f64>>>()
            }
        };
        let left = self.left(term, &points, scales)?;
        let mut ranked: Vec<(f64, Vec<f64>)> = match cloud {
            Cloud::Points(_) => left.into_iter().zip(points).collect(),
            Cloud::Shapes { strength, shapes } => {
                let (none, pairs) = left.split_first()?;
                let vertex = |(pair, shape): (&[f64], Vec<f64>)| {
                    let (best, least) = parabola(*none, pair[0], pair[1]);
                    (least, std::iter::once(best * strength).chain(shape).collect())
                };
                pairs.chunks_exact(2).zip(shapes).map(vertex).collect()
            }
        };
        ranked.retain(|r| r.0.is_finite());
        order::sort_by_key(&mut ranked, |r| r.0);
        Some(apart(ranked.into_iter().map(|r| r.1), most))
    }

    /// Sum of squares that each point leaves on the fitted rows after the model's own parameters have moved along.
    fn left(&self, term: Term, points: &[Vec<f64>], scales: &Scales) -> Option<Vec<f64>> {
        let models: Vec<(Shape, Vec<f64>)> = points.iter().map(|p| self.fit.with(term, p)).collect();
        let (shape, _) = models.first()?;
        let steps = models.iter().map(|m| shape.coarse_steps(&m.1, scales)).max()?.max(self.fit.steps);
        let placed = models.iter().map(|m| placed(shape, &m.1)).collect::<Option<Vec<Point>>>()?;
        self.evaluate(&placed, steps)
    }

    /// The same for points of the fitted model itself, by the diagnosis' own filter where the kernel does not have a term.
    pub fn left_at(&self, points: &[Vec<f64>]) -> Option<Vec<f64>> {
        let (shape, steps) = (&self.fit.shape, self.fit.steps);
        // The kernel smooths friction: good enough for a start, not for a likelihood.
        let smoothed = shape.terms.iter().any(|t| t.rubs());
        if !smoothed && let Some(placed) = points.iter().map(|p| placed(shape, p)).collect::<Option<Vec<Point>>>() {
            return self.evaluate(&placed, steps);
        }
        let run = self.fit.run(self.data, true);
        let rows: Vec<usize> = self.data.train.iter().flat_map(|r| r.clone()).map(|k| k - run.range.start).collect();
        let of_group = |_, group: &[Vec<f64>]| {
            let lanes = innovations(self.data, shape, group, &run, &mut Nothing);
            let one = |l: usize| {
                let sum: f64 = rows.iter().map(|k| lanes[*k][l].powi(2)).sum();
                let along = |b: &Vec<f64>| rows.iter().map(|k| lanes[*k][l] * b[*k]).sum::<f64>().powi(2);
                sum - self.basis.iter().map(along).sum::<f64>()
            };
            (0..group.len()).map(one).collect::<Vec<f64>>()
        };
        Some(parallel::map_chunks(points, law::LANES, of_group).concat())
    }

    /// What points of the kernel leave; `None` when stopped.
    fn evaluate(&self, points: &[Point], steps: usize) -> Option<Vec<f64>> {
        let job = Job {
            reading: &self.data.reading,
            grid: self.data.input.as_ref().map_or(&[], |i| i.grid(steps)),
            grid_end: self.data.input.as_ref().map_or(0, Input::end),
            steps,
            run: self.data.hull.clone(),
            blocks: self.data.train.clone(),
            directions: &self.basis,
            units: self.units,
        };
        // A group of 64 in single precision takes about as long as eight parameter sets in the filter.
        self.data.work.add(job.run.len() * steps * points.len().div_ceil(LANES));
        Some(evaluate::<f32>(&job, points).ok()?.iter().map(unexplained).collect())
    }
}

/// What is left of a misfit after its projections.
fn unexplained(misfit: &Misfit) -> f64 {
    let along: f64 = misfit.along.iter().map(|a| a * a).sum();
    misfit.squares.iter().sum::<f64>() - along
}

/// A model as the kernel takes it; `None` where that does not have one of its terms.
fn placed(shape: &Shape, p: &[f64]) -> Option<Point> {
    let (gain, omega_rad_s, zeta) = (p[GAIN], p[OMEGA], p[ZETA]);
    let base =
        Point { gain, omega_rad_s, zeta, offset: p[OFFSET], x0: p[INITIAL], v0: p[BASE - 1], ..Point::default() };
    let mut point = base;
    let all = shape.terms.iter().enumerate().all(|(i, term)| term.place(shape.of(i, p), &mut point));
    // The kernel bends the displacement alone, and lets feedthrough be as late as the rest.
    let bends = point.bend_2 != 0.0 || point.bend_3 != 0.0;
    let composed = bends && (point.lowpass_s != 0.0 || point.mode_gain != 0.0);
    let late = point.delay_s != 0.0 && point.feedthrough != 0.0;
    (all && !composed && !late).then_some(point)
}

/// An orthonormal basis of columns on the fitted rows, as sequences over the hull: modified Gram–Schmidt, twice.
fn basis<'c>(data: &Data, columns: impl Iterator<Item = &'c Vec<f64>>) -> Vec<Vec<f64>> {
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
        let left = dot(&rest, &rest);
        // What single precision cannot tell from the others adds only noise.
        if left > 1e-8 * size && basis.len() < MOST_DIRECTIONS {
            let norm = left.sqrt();
            rest.iter_mut().for_each(|r| *r /= norm);
            basis.push(rest);
        }
    }
    let spread = |short: Vec<f64>| {
        let mut long = vec![0.0; data.hull.len()];
        let rows = data.train.iter().flat_map(|r| r.clone());
        rows.zip(short).for_each(|(k, v)| long[k - data.hull.start] = v);
        long
    };
    basis.into_iter().map(spread).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Lowest point of a parabola through values at 0, 1 and −1, and its value there; no further out than 3.
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
