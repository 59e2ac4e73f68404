//! Selects the laws that the force of a body without a spring asks for: stepwise forward, judged on
//! samples that were not fitted.

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::selection::earned::LEVEL;
use crate::driven::selection::held_out::{Comparison, compare};
use crate::physics::candidate::Candidate;
use crate::physics::coulomb_friction::{self, Sides};
use crate::physics::{drive_nonlinearity, quadratic_damping};

use super::motion::{MotionAndForce, Part};
use super::regression::Regression;

/// Fraction of the held-out error variance that a law must remove to have a name: the residual is
/// then no larger than what the law removes.
const LEAST: f64 = 0.5;
/// The same of a law's wider form, which takes no name of its own.
const LEAST_OF_FORM: f64 = 0.02;

/// The parts of the body alone.
pub const BASE: [Part; 3] = [Part::Acceleration, Part::Velocity, Part::Constant];

/// A law that can act on such a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// f_c sgn x′, and where the sides differ f_d |x′| besides.
    Friction(Sides),
    /// Quadratic damping, c₂|x′|x′.
    Drag,
    /// A force that also follows the square of the input, κu².
    Drive,
}

/// All of them, in their plain forms.
pub(crate) const LAWS: [Law; 3] = [Law::Friction(Sides::Alike), Law::Drag, Law::Drive];

impl Law {
    /// Its entry in the library of candidates.
    pub fn candidate(self) -> &'static Candidate {
        match self {
            Self::Friction(_) => &coulomb_friction::CANDIDATE,
            Self::Drag => &quadratic_damping::CANDIDATE,
            Self::Drive => &drive_nonlinearity::CANDIDATE,
        }
    }

    /// Parts of the force that it adds.
    pub fn parts(self) -> &'static [Part] {
        match self {
            Self::Friction(Sides::Alike) => &[Part::Direction],
            Self::Friction(Sides::Apart) => &[Part::Direction, Part::Speed],
            Self::Drag => &[Part::SquaredVelocity],
            Self::Drive => &[Part::SquaredInput],
        }
    }

    /// Its wider form, if it has one.
    pub fn wider(self) -> Option<Self> {
        (self == Self::Friction(Sides::Alike)).then_some(Self::Friction(Sides::Apart))
    }

    /// Returns whether physics allows the sign that was fitted: what feeds the motion instead of
    /// damping it is no friction.
    fn is_allowed(self, model: &Regression) -> bool {
        let over_mass = |part| model.of(part) / model.coefficients[0];
        match self {
            Self::Friction(_) => over_mass(Part::Direction) > 0.0,
            Self::Drag => over_mass(Part::SquaredVelocity) > 0.0,
            Self::Drive => true,
        }
    }
}

/// A law tried or chosen, and how it fared against the model without it.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// The law that was added or removed.
    pub law: Law,
    /// Comparison on samples that were not fitted.
    pub comparison: Comparison,
}

/// Result of a search.
#[derive(Debug, Clone)]
pub(crate) struct Selection {
    /// Chosen, in the order of their choice.
    pub chosen: Vec<Law>,
    /// Each law alone against the body alone, best first.
    pub alone: Vec<Trial>,
}

/// The parts of a body with these laws.
pub(crate) fn parts(laws: &[Law]) -> Vec<Part> {
    BASE.iter().chain(laws.iter().flat_map(|law| law.parts())).copied().collect()
}

/// Chooses; `None` where not even the body alone can be fitted.
pub(crate) fn search(data: &Data, motion: &MotionAndForce) -> Option<Selection> {
    let judged = |laws: &[Law]| {
        let fit = Regression::fit(motion, &parts(laws), &data.train)?;
        let held_out = fit.held_out(motion, &data.validation);
        Some((fit, held_out))
    };
    let with = |chosen: &[Law], law: Law| -> Option<Trial> {
        let (_, before) = judged(chosen)?;
        let (fit, after) = judged(&[chosen, &[law]].concat())?;
        let comparison = compare(&before, &after);
        law.is_allowed(&fit).then_some(Trial { law, comparison })
    };
    judged(&[])?;
    let (mut chosen, mut alone): (Vec<Law>, Vec<Trial>) = (Vec::new(), Vec::new());
    loop {
        let open = LAWS.iter().filter(|l| chosen.iter().all(|c| c.candidate().id != l.candidate().id));
        let mut trials: Vec<Trial> = open.filter_map(|law| with(&chosen, *law)).collect();
        trials.sort_by(|a, b| b.comparison.gain.total_cmp(&a.comparison.gain));
        if chosen.is_empty() {
            alone.clone_from(&trials);
        }
        let tried = LAWS.len() as f64;
        let qualifies = |t: &&Trial| t.comparison.gain >= LEAST && t.comparison.p_value * tried < LEVEL;
        let Some(best) = trials.first().filter(qualifies) else { break };
        chosen.push(best.law);
    }
    for i in 0..chosen.len() {
        let Some(wider) = chosen[i].wider() else { continue };
        let mut form = chosen.clone();
        form[i] = wider;
        let Some(((_, before), (fit, after))) = judged(&chosen).zip(judged(&form)) else { continue };
        let comparison = compare(&before, &after);
        if comparison.gain >= LEAST_OF_FORM && comparison.p_value < LEVEL && wider.is_allowed(&fit) {
            chosen = form;
        }
    }
    Some(Selection { chosen, alone })
}

/// A model with these laws, fitted to everything that may be fitted.
pub fn last(motion: &MotionAndForce, laws: &[Law], ranges: &[Range<usize>]) -> Option<Regression> {
    Regression::fit(motion, &parts(laws), ranges)
}
