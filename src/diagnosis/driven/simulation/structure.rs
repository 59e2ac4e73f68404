//! States which parameters a model has, and what follows from them alone: the base, its terms,
//! their places, how each moves, how short the steps must be. Not for running it (`run`).

use crate::driven::base::{BASE, INITIAL, OFFSET, OMEGA, OMEGAS_PER_SAMPLE, PER_RECORDING, ZETA, ZETAS};
use crate::driven::intake::input::MOST_STEPS;
use crate::physics::law::{Noise, Place, Role};
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};

use super::gain::{self, Noisy};

/// Largest angle of the fastest rotation per integration step, rad: fourth-order errors stay below
/// 1e-4 of a term.
const ANGLE: f64 = 0.25;

/// The same for a free motion, whose linear part is exact: errors stay below 1e-4 of what a term does.
const FREE_ANGLE: f64 = 0.32;

/// A model: the base and some terms.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelStructure {
    /// Terms added to the base model.
    pub terms: Vec<Term>,
    /// First parameter of each.
    pub first: Vec<usize>,
    /// Number of parameters, base and terms together.
    pub parameters: usize,
    /// Recordings beyond the first, each with its own offset and initial state.
    pub further: usize,
}

impl ModelStructure {
    /// A model of one recording with these terms.
    pub fn new(terms: &[Term]) -> Self {
        Self::over(terms, 0)
    }

    /// The same of this many recordings beyond the first: after the base parameters those of each
    /// further recording, and after each term's values its unknown initial values in each further
    /// recording.
    pub fn over(terms: &[Term], further: usize) -> Self {
        let mut next = BASE + PER_RECORDING * further;
        let first = terms
            .iter()
            .map(|t| {
                let here = next;
                next += t.values() + further * t.unknown_beginnings();
                here
            })
            .collect();
        Self { terms: terms.to_vec(), first, parameters: next, further }
    }

    /// The parameters of this model from those of the same terms over another number of recordings;
    /// a recording that is new begins at rest, at this displacement.
    pub fn from_other(&self, other: &ModelStructure, point: &[f64], displacements: &[f64]) -> Vec<f64> {
        let mut new = point[..BASE].to_vec();
        for (recording, displacement) in displacements.iter().enumerate().take(self.further) {
            let at = BASE + PER_RECORDING * recording;
            match point.get(at..at + PER_RECORDING).filter(|_| recording < other.further) {
                Some(known) => new.extend_from_slice(known),
                None => new.extend([point[OFFSET], displacement - point[OFFSET], 0.0]),
            }
        }
        for (i, term) in self.terms.iter().enumerate() {
            let here = new.len();
            new.extend_from_slice(&point[other.block(i)]);
            new.resize(here + self.block(i).len(), 0.0);
            debug_assert_eq!(here, self.first[i], "{}", term.id());
        }
        new
    }

    /// Places of one term's parameters and of all its initial values.
    pub fn block(&self, term: usize) -> std::ops::Range<usize> {
        let (first, term) = (self.first[term], &self.terms[term]);
        first..first + term.values() + self.further * term.unknown_beginnings()
    }

    /// Place of the offset of a recording, whose initial displacement and velocity follow for all
    /// but the first.
    pub fn offset(&self, recording: usize) -> usize {
        if recording == 0 { OFFSET } else { BASE + PER_RECORDING * (recording - 1) }
    }

    /// Place of the displacement at the beginning of a recording; its velocity follows.
    pub fn initial(&self, recording: usize) -> usize {
        if recording == 0 { INITIAL } else { self.offset(recording) + 1 }
    }

    /// Returns whether the model has noise terms, so that free simulation is not all of it.
    pub fn is_noisy(&self) -> bool {
        self.terms.iter().any(|t| t.noise().is_some())
    }

    /// Returns the places of what only states where the mass, and the states of terms, begin in the
    /// first recording.
    pub fn beginnings(&self) -> Vec<usize> {
        let of_terms = self.terms.iter().zip(&self.first).flat_map(|(term, first)| {
            let end = first + term.values();
            end - term.unknown_beginnings()..end
        });
        [INITIAL, INITIAL + 1].into_iter().chain(of_terms).collect()
    }

    /// Returns the places of all offsets and of all that states where the mass, and the states of
    /// terms, begin.
    pub fn all_beginnings(&self) -> Vec<usize> {
        let of_terms = self.terms.iter().enumerate().flat_map(|(i, term)| {
            let block = self.block(i);
            block.start + term.values() - term.unknown_beginnings()..block.end
        });
        let of_recording = |r: usize| [self.offset(r), self.initial(r), self.initial(r) + 1];
        (0..=self.further).flat_map(of_recording).chain(of_terms).collect()
    }

    /// Parameters of one term.
    pub fn of<'a>(&self, term: usize, point: &'a [f64]) -> &'a [f64] {
        &point[self.first[term]..self.first[term] + self.terms[term].values()]
    }

    /// The stationary gain at a point.
    pub fn gain(&self, point: &[f64], interval_s: f64) -> gain::Gain {
        gain::stationary(&self.noisy(point, interval_s))
    }

    /// The linear part at a point, with its noise.
    pub fn noisy(&self, point: &[f64], interval_s: f64) -> Noisy {
        let (omega_rad_s, zeta) = (point[OMEGA], point[ZETA]);
        let mut noisy = Noisy { omega_rad_s, zeta, interval_s, force: 0.0, walk: 0.0, lag_s: 0.0 };
        for (term, first) in self.terms.iter().zip(&self.first) {
            match term.noise() {
                Some(Noise::Force) => noisy.force = point[*first],
                Some(Noise::Walk) => noisy.walk = point[*first],
                None if term.role() == Role::Filter(Place::LowPass) => noisy.lag_s = point[*first],
                None => {}
            }
        }
        noisy
    }

    /// Integration steps per sample that this point needs.
    pub fn steps(&self, point: &[f64], scales: &Scales) -> usize {
        self.steps_by(point, scales, ANGLE)
    }

    /// Returns the same as `steps`, for a look that need not be exact.
    pub fn coarse_steps(&self, point: &[f64], scales: &Scales) -> usize {
        self.steps_by(point, scales, 4.0 * ANGLE)
    }

    /// Returns the same as `steps`, where no input has to be followed between the samples: one
    /// where that is enough.
    pub fn free_steps(&self, point: &[f64], scales: &Scales) -> usize {
        self.angles(point, scales, FREE_ANGLE).clamp(1, MOST_STEPS)
    }

    fn steps_by(&self, point: &[f64], scales: &Scales, angle: f64) -> usize {
        self.angles(point, scales, angle).clamp(2, MOST_STEPS)
    }

    fn angles(&self, point: &[f64], scales: &Scales, angle: f64) -> usize {
        let fastest = self
            .terms
            .iter()
            .enumerate()
            .map(|(i, t)| scales.fineness * t.fastest_rad_s(self.of(i, point), scales))
            // What balances at once does not turn.
            .fold(if scales.at_once { 0.0 } else { point[OMEGA] }, f64::max);
        (fastest * scales.interval_s / angle).ceil() as usize
    }
}

/// Optimiser coordinates of every parameter of a model.
pub fn coordinates(structure: &ModelStructure, scales: &Scales) -> Vec<Coordinate> {
    let omega = scales.omega_rad_s;
    let mut all = vec![
        Coordinate::Linear(0.1 * scales.gain.abs().max(1e-300)),
        Coordinate::Log(OMEGAS_PER_SAMPLE[0] / scales.interval_s, OMEGAS_PER_SAMPLE[1] / scales.interval_s),
        Coordinate::Log(ZETAS[0], ZETAS[1]),
        Coordinate::Linear(0.1 * scales.output),
        Coordinate::Linear(0.1 * scales.output),
        Coordinate::Linear(0.1 * scales.output * omega),
    ];
    if scales.at_once {
        [OMEGA, ZETA, INITIAL, INITIAL + 1].into_iter().for_each(|place| all[place] = Coordinate::Held);
    }
    for _ in 0..structure.further {
        all.extend_from_within(OFFSET..OFFSET + PER_RECORDING);
    }
    for term in &structure.terms {
        let own = term.coordinates(scales);
        let beginnings = &own[own.len() - term.unknown_beginnings()..];
        all.extend_from_slice(&own);
        (0..structure.further).for_each(|_| all.extend_from_slice(beginnings));
    }
    all
}
