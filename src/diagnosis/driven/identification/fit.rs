//! A model of the recording and its fit: base parameters and terms together, by maximum likelihood
//! of the innovations.

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::numerics::least_squares::{Linear, Minimum, Residuals, minimise};
use crate::parallel;
use crate::physics::end_stop::EndStop;
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};
use crate::physics::state::{LANES, Lanes};

pub use crate::driven::base::{BASE, GAIN, INITIAL, OFFSET, OMEGA, ZETA};
pub use crate::driven::simulation::structure::{ModelStructure, coordinates};

/// A fit in progress: which parameters move, and how.
pub struct Search<'a> {
    /// The recording as fits see it.
    pub data: &'a Data,
    /// Structure of the model that is fitted.
    pub structure: &'a ModelStructure,
    /// Values at which parameters that do not move stay.
    pub point: Vec<f64>,
    /// Indices of the free parameters.
    pub free: Vec<usize>,
    /// Optimiser coordinate of each parameter, free or not.
    pub coordinates: Vec<Coordinate>,
    /// Range, substeps and mode of the simulation.
    pub run: Run,
    /// Rows that count, relative to the recording.
    pub rows: Vec<Range<usize>>,
}

impl<'a> Search<'a> {
    /// All parameters of a model that a fit may move, on the training rows.
    pub fn all(data: &'a Data, structure: &'a ModelStructure, point: &[f64], scales: &Scales) -> Self {
        let coordinates = coordinates(structure, scales);
        let moves = |i: &usize| coordinates[*i] != Coordinate::Held && (*i != GAIN || data.input.is_some());
        let free = (0..structure.parameters).filter(moves).collect();
        Self {
            data,
            structure,
            point: point.to_vec(),
            free,
            coordinates,
            run: Run { range: data.hull.clone(), steps: structure.steps(point, scales), corrected: true },
            rows: data.train.clone(),
        }
    }

    /// Converts coordinates to parameters.
    pub fn point(&self, z: &[f64]) -> Vec<f64> {
        let mut point = self.point.clone();
        for (i, z) in self.free.iter().zip(z) {
            point[*i] = match self.coordinates[*i] {
                Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => z * scale,
                Coordinate::Held => self.point[*i],
                Coordinate::Log(..) => z.exp(),
            };
        }
        point
    }

    /// Converts parameters to coordinates.
    pub fn z(&self, point: &[f64]) -> Vec<f64> {
        self.free
            .iter()
            .map(|i| match self.coordinates[*i] {
                Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => point[*i] / scale,
                Coordinate::Held => 0.0,
                Coordinate::Log(low, high) => point[*i].clamp(low, high).ln(),
            })
            .collect()
    }

    /// Derivative of a free parameter by its coordinate.
    pub fn slope(&self, i: usize, point: &[f64]) -> f64 {
        match self.coordinates[i] {
            Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => scale,
            Coordinate::Log(..) => point[i],
            Coordinate::Held => 0.0,
        }
    }

    fn pick(&self, lanes: &[Lanes], lane: usize) -> Vec<f64> {
        self.rows.iter().flat_map(|r| r.clone()).map(|k| lanes[k - self.run.range.start][lane]).collect()
    }

    /// Minimises the sum of squared innovations.
    pub fn minimise(&self, most: usize) -> Option<Minimum> {
        minimise(self, &self.z(&self.point), 0.02, most)
    }
}

/// Step in coordinates for derivatives: small next to any feature, large next to rounding.
const NUDGE: f64 = 1e-5;

impl Residuals for Search<'_> {
    fn linearise(&self, z: &[f64]) -> Option<Linear> {
        let mut points = vec![self.point(z)];
        for j in 0..z.len() {
            let mut moved = z.to_vec();
            moved[j] += NUDGE;
            points.push(self.point(&moved));
        }
        let mut residual = Vec::new();
        let mut columns = Vec::with_capacity(z.len());
        let passes: Vec<Vec<Lanes>> = parallel::map_chunks(&points, LANES, |_, group| {
            innovations(self.data, self.structure, group, &self.run, &mut Nothing)
        });
        for (chunk, (group, lanes)) in points.chunks(LANES).zip(&passes).enumerate() {
            for l in 0..group.len() {
                if chunk == 0 && l == 0 {
                    residual = self.pick(lanes, 0);
                    continue;
                }
                let mut column = self.pick(lanes, l);
                for (c, e) in column.iter_mut().zip(&residual) {
                    *c = (*c - e) / NUDGE;
                }
                columns.push(column);
            }
        }
        let finite = residual.iter().all(|v| v.is_finite()) && columns.iter().flatten().all(|v| v.is_finite());
        finite.then_some(Linear { residual, columns })
    }

    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let of_group = |group: &[Vec<f64>]| {
            let lanes = innovations(self.data, self.structure, group, &self.run, &mut Nothing);
            (0..group.len()).map(|l| self.pick(&lanes, l)).collect::<Vec<_>>()
        };
        let points: Vec<Vec<f64>> = points.iter().map(|z| self.point(z)).collect();
        points.chunks(LANES).flat_map(of_group).collect()
    }

    fn confine(&self, z: &mut [f64]) {
        for (i, z) in self.free.iter().zip(z) {
            if let Coordinate::Log(low, high) = self.coordinates[*i] {
                *z = z.clamp(low.ln(), high.ln());
            } else if let Coordinate::Bounded(scale, low, high) = self.coordinates[*i] {
                *z = z.clamp(low / scale, high / scale);
            }
            if !z.is_finite() {
                *z = 0.0;
            }
        }
    }

    fn together(&self) -> usize {
        LANES
    }
}

/// A model fitted to the recording: structure, parameters, likelihood.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Structure of the model.
    pub structure: ModelStructure,
    /// Parameter vector at the maximum of the likelihood.
    pub point: Vec<f64>,
    /// Integration steps per sample.
    pub steps: usize,
    /// Innovations on the training rows, and their derivatives by the coordinates of the free
    /// parameters.
    pub linear: Linear,
    /// Indices of the fitted parameters.
    pub free: Vec<usize>,
    /// Derivative of each free parameter by its coordinate.
    pub slopes: Vec<f64>,
    /// Mean squared innovation on the training rows.
    pub variance: f64,
    /// States whether the search came to rest.
    pub converged: bool,
}

impl Fit {
    /// Mean Gaussian log-likelihood per training sample.
    pub fn log_score(&self) -> f64 {
        -0.5 * ((2.0 * std::f64::consts::PI * self.variance).ln() + 1.0)
    }

    /// Log-likelihood of the training rows.
    pub fn log_likelihood(&self) -> f64 {
        self.log_score() * self.linear.residual.len() as f64
    }

    /// The same model with one more term, at this start.
    pub fn with(&self, term: Term, start: &[f64]) -> (ModelStructure, Vec<f64>) {
        let mut terms = self.structure.terms.clone();
        terms.push(term);
        let structure = ModelStructure::over(&terms, self.structure.further);
        let mut point = self.point.clone();
        point.extend_from_slice(start);
        point.resize(structure.parameters, 0.0);
        (structure, point)
    }

    /// The same model without its `index`th term.
    pub fn without(&self, index: usize) -> (ModelStructure, Vec<f64>) {
        let mut terms = self.structure.terms.clone();
        terms.remove(index);
        let mut point = self.point.clone();
        point.drain(self.structure.block(index));
        (ModelStructure::over(&terms, self.structure.further), point)
    }

    /// The same model with the terms at these places alone.
    pub fn only(&self, kept: &[usize]) -> (ModelStructure, Vec<f64>) {
        let dropped = (0..self.structure.terms.len()).rev().filter(|i| !kept.contains(i));
        let mut point = self.point.clone();
        dropped.for_each(|i| drop(point.drain(self.structure.block(i))));
        let terms: Vec<Term> = kept.iter().map(|i| self.structure.terms[*i]).collect();
        (ModelStructure::over(&terms, self.structure.further), point)
    }

    /// Returns whether a law's parameter lies at the end of its plausible range, where the law is
    /// not what its name states.
    pub fn at_bound(&self, scales: &Scales) -> bool {
        (0..self.structure.terms.len()).any(|index| self.term_at_bound(index, scales))
    }

    /// The same of one term. Noise has no such range.
    pub fn term_at_bound(&self, index: usize, scales: &Scales) -> bool {
        let term = self.structure.terms[index];
        let values = self.structure.of(index, &self.point);
        let bends = |t: &Term| matches!(t, Term::CubicStiffness(_) | Term::QuadraticStiffness(_));
        let is_stop = matches!(term, Term::EndStop(_));
        if is_stop && EndStop::may_be_a_bend(values, scales) && self.structure.terms.iter().any(bends) {
            return true;
        }
        term.noise().is_none()
            && term.coordinates(scales).iter().zip(values).any(|(c, v)| match *c {
                Coordinate::Log(low, high) | Coordinate::Bounded(_, low, high) => {
                    *v <= low + 0.01 * low.abs() || *v >= high - 0.01 * high.abs()
                }
                Coordinate::Linear(_) | Coordinate::Held => false,
            })
    }

    /// The run it was fitted on.
    pub fn run(&self, data: &Data, corrected: bool) -> Run {
        Run { range: data.hull.clone(), steps: self.steps, corrected }
    }
}

/// Fits a model from a start; `None` where it breaks down there. A model of another number of
/// recordings is taken over to those of the data.
pub fn fit(data: &Data, structure: &ModelStructure, start: &[f64], scales: &Scales, most: usize) -> Option<Fit> {
    if structure.further != data.breaks.len() {
        let here = ModelStructure::over(&structure.terms, data.breaks.len());
        let displacements: Vec<f64> = data.breaks.iter().map(|k| data.reading[*k]).collect();
        let start = here.from_other(structure, start, &displacements);
        return fit(data, &here, &start, scales, most);
    }
    let search = Search::all(data, structure, start, scales);
    let minimum = search.minimise(most)?;
    let point = search.point(&minimum.z);
    let slopes = search.free.iter().map(|i| search.slope(*i, &point)).collect();
    Some(Fit {
        structure: structure.clone(),
        steps: search.run.steps,
        variance: minimum.sum / minimum.linear.residual.len().max(1) as f64,
        converged: minimum.converged,
        free: search.free.clone(),
        linear: minimum.linear,
        slopes,
        point,
    })
}
