//! Tests the residual against laws that the library has no name for. Where one of them fits, nothing
//! that was named explains the difference, least of all noise of the reference.

use super::blocks::Linear;
use super::candidate::{self, Term};
use super::fitted::Fitted;
use super::judgement::{Question, Standing, judge};
use super::log::Halves;
use super::selection::with;
use crate::number::short;

/// Holds what they are looked for in.
pub(super) struct Left<'a> {
    /// The linearised model.
    pub linear: &'a Linear,
    /// Parameters of the chosen model.
    pub active: &'a [usize],
    /// Holds what of each pose the reference has.
    pub halves: Halves,
    /// From one reading to the next, s.
    pub interval_s: f64,
}

impl Left<'_> {
    /// Those that held-out blocks and the jackknife bear out next to the chosen model.
    pub(super) fn laws(&self) -> Vec<&'static Term> {
        let all = candidate::beyond(self.halves);
        let tried = all.len();
        let counts = |term: &&'static Term| {
            let larger = with(self.active, [*term]);
            let question = Question {
                linear: self.linear,
                smaller: self.active,
                larger: &larger,
                term,
                tilt_rad: 0.0,
                least_part: 0.0,
                interval_s: self.interval_s,
            };
            Standing::counts(&judge(&question, tried))
        };
        all.into_iter().filter(counts).collect()
    }
}

/// Returns what is said of one, fitted next to the rest.
pub(super) fn words(term: &Term, fit: &Fitted) -> String {
    let one = |(p, name): (usize, &&str)| {
        let e = fit.estimate(p, name, term.unit.name, term.unit.per_si);
        format!("{name} {} ± {} {}", short(e.value), short(0.5 * (e.ci95[1] - e.ci95[0])), e.unit)
    };
    let numbers: Vec<String> = term.parameters.clone().zip(term.names).map(one).collect();
    format!("what is left goes with the {} ({}): {}", term.id(), term.candidate.equation, numbers.join(", "))
}
