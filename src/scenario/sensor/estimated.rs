//! Which keys of a sensor a log at rest gives: noise coefficients that an Allan analysis estimates and a study
//! simulates.

use super::error_law::ErrorLaw;
use super::{Sense, SensorTerm};
use crate::numerics::allan::law::Term;
use crate::units::key::Key;

/// The noise terms of a sense that an Allan analysis estimates and a study simulates, each with the
/// key for its two-sided coefficient.
pub fn estimated(sense: Sense) -> Vec<(Term, &'static Key)> {
    let of = |term: SensorTerm| {
        let law = match term.law() {
            ErrorLaw::White(_) => Term::White,
            ErrorLaw::Flicker(_) => Term::Flicker,
            ErrorLaw::Walk(_) => Term::Walk,
            _ => return None,
        };
        Some((law, term.row().keys.iter().find(|key| !key.one_sided)?))
    };
    SensorTerm::ALL.into_iter().filter(|term| term.sense() == sense).filter_map(of).collect()
}
