//! Tests for laws that the library has no name for. Where one of them fits, no candidate is named for what it
//! does, and nothing that was named explains the difference, least of all noise of the reference.

use super::blocks::Linear;
use super::candidate::{self, Term};
use super::fitted::Fitted;
use super::judgement::{Question, judge};
use super::log::Halves;
use super::selection::{Named, Selection};
use crate::error::Result;
use crate::number::short;

/// Holds what they are looked for in.
pub(super) struct Left<'a> {
    /// The linearised model.
    pub linear: &'a Linear,
    /// Holds what of each pose the reference has.
    pub halves: Halves,
    /// The names found while no law is free.
    pub selection: &'a Selection,
    /// From one reading to the next, s.
    pub interval_s: f64,
}

impl Left<'_> {
    /// Returns the laws that hold on blocks kept out of the fit and under the jackknife. Each is free while the library is searched, and
    /// counts if it is large enough to matter, or if a name falls away with it. `select` searches the library with the
    /// laws it is given free.
    ///
    /// # Errors
    /// When `select` is stopped.
    pub(super) fn laws(&self, select: impl Fn(&[&'static Term]) -> Result<Selection>) -> Result<Vec<&'static Term>> {
        let all = candidate::beyond(self.halves);
        let mut laws = Vec::new();
        for term in &all {
            let beside = select(&[*term])?;
            let is_spared = |n: &Named| !beside.named.iter().any(|b| b.standing.term == n.standing.term);
            let spares = self.selection.named.iter().any(is_spared);
            let larger = beside.active();
            let smaller: Vec<usize> = larger.iter().copied().filter(|p| !term.parameters.contains(p)).collect();
            let question = Question {
                linear: self.linear,
                smaller: &smaller,
                larger: &larger,
                term,
                tilt_rad: 0.0,
                least_part: 0.0,
                interval_s: self.interval_s,
            };
            let standing = judge(&question, all.len());
            if standing.counts() || (spares && standing.holds()) {
                laws.push(*term);
            }
        }
        Ok(laws)
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
