//! Which parameters a model has, and what follows from them alone: the base, its terms, their places, how each moves, how
//! short the steps must be. Not for running it (`run`).

use crate::diagnosis::driven::base::{BASE, INITIAL, OMEGA, OMEGAS_PER_SAMPLE, ZETA, ZETAS};
use crate::diagnosis::driven::intake::input::MOST_STEPS;
use crate::physics::law::{Noise, Role};
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};

use super::gain::{self, Noisy};

/// Largest angle of the fastest rotation per integration step, rad: fourth-order errors stay below 1e-4 of a term.
const ANGLE: f64 = 0.25;

/// A model: the base and some terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// The terms.
    pub terms: Vec<Term>,
    /// First parameter of each.
    pub first: Vec<usize>,
    /// Number of parameters.
    pub parameters: usize,
}

impl Shape {
    /// A model with these terms.
    pub fn new(terms: &[Term]) -> Self {
        let mut next = BASE;
        let first = terms
            .iter()
            .map(|t| {
                let here = next;
                next += t.values();
                here
            })
            .collect();
        Self { terms: terms.to_vec(), first, parameters: next }
    }

    /// Whether free simulation is not all there is to it.
    pub fn is_noisy(&self) -> bool {
        self.terms.iter().any(|t| t.noise().is_some())
    }

    /// Places of what only says where the mass, and the states of terms, begin.
    pub fn beginnings(&self) -> Vec<usize> {
        let of_terms = self.terms.iter().zip(&self.first).flat_map(|(term, first)| {
            let end = first + term.values();
            end - term.unknown_beginnings()..end
        });
        [INITIAL, INITIAL + 1].into_iter().chain(of_terms).collect()
    }

    /// Parameters of one term.
    pub fn of<'a>(&self, term: usize, point: &'a [f64]) -> &'a [f64] {
        &point[self.first[term]..self.first[term] + self.terms[term].values()]
    }

    /// The stationary gain at a point.
    pub fn gain(&self, point: &[f64], interval_s: f64) -> gain::Gain {
        let (omega_rad_s, zeta) = (point[OMEGA], point[ZETA]);
        let mut noisy = Noisy { omega_rad_s, zeta, interval_s, force: 0.0, walk: 0.0, lag_s: 0.0 };
        for (term, first) in self.terms.iter().zip(&self.first) {
            match term.noise() {
                Some(Noise::Force) => noisy.force = point[*first],
                Some(Noise::Walk) => noisy.walk = point[*first],
                None if term.role() == Role::LowPass => noisy.lag_s = point[*first],
                None => {}
            }
        }
        gain::stationary(&noisy)
    }

    /// Integration steps per sample that this point needs.
    pub fn steps(&self, point: &[f64], scales: &Scales) -> usize {
        self.steps_by(point, scales, ANGLE)
    }

    /// As `steps`, for a look that need not be exact.
    pub fn coarse_steps(&self, point: &[f64], scales: &Scales) -> usize {
        self.steps_by(point, scales, 4.0 * ANGLE)
    }

    fn steps_by(&self, point: &[f64], scales: &Scales, angle: f64) -> usize {
        let fastest = self
            .terms
            .iter()
            .enumerate()
            .map(|(i, t)| scales.fineness * t.fastest_rad_s(self.of(i, point), scales))
            .fold(point[OMEGA], f64::max);
        ((fastest * scales.interval_s / angle).ceil() as usize).clamp(2, MOST_STEPS)
    }
}

/// How every parameter of a model moves.
pub fn coordinates(shape: &Shape, scales: &Scales) -> Vec<Coordinate> {
    let omega = scales.omega_rad_s;
    let mut all = vec![
        Coordinate::Linear(0.1 * scales.gain.abs().max(1e-300)),
        Coordinate::Log(OMEGAS_PER_SAMPLE[0] / scales.interval_s, OMEGAS_PER_SAMPLE[1] / scales.interval_s),
        Coordinate::Log(ZETAS[0], ZETAS[1]),
        Coordinate::Linear(0.1 * scales.output),
        Coordinate::Linear(0.1 * scales.output),
        Coordinate::Linear(0.1 * scales.output * omega),
    ];
    for term in &shape.terms {
        all.extend(term.coordinates(scales));
    }
    all
}
