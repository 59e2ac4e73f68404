//! Models with their record on samples that were not fitted, and what a search among them leaves.

use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::simulated::space::excludes;
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::held_out::{Comparison, HeldOut, held_out};
use super::identifiability::Identifiability;

/// A model with its record.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The fitted model.
    pub fit: Fit,
    /// Errors on the validation samples.
    pub held_out: HeldOut,
}

impl Judged {
    /// Log-likelihood less the penalty of its terms' parameters (Schwarz 1978).
    pub fn score(&self) -> f64 {
        let n = self.fit.linear.residual.len().max(2) as f64;
        self.fit.log_likelihood() - 0.5 * self.fit.free.len() as f64 * n.ln()
    }

    /// Ids of its terms, as one text.
    pub(crate) fn words(&self) -> String {
        let ids: Vec<&str> = self.fit.structure.terms.iter().map(|t| t.id()).collect();
        if ids.is_empty() { "base model".into() } else { ids.join(" + ") }
    }

    /// Returns whether this term may be added: neither it nor one that excludes it is there.
    pub fn may_hold(&self, term: &Term) -> bool {
        !self.fit.structure.terms.iter().any(|t| excludes(t, term))
    }

    /// Returns whether a term with this id is in it.
    pub fn has(&self, id: &str) -> bool {
        self.fit.structure.terms.iter().any(|t| t.id() == id)
    }
}

/// A candidate's trial against a model.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The candidate that was tried.
    pub term: Term,
    /// Sum of squares that one linear step promised, relative to the model's.
    pub promised: f64,
    /// The fit with it, where it came that far.
    pub judged: Option<Judged>,
    /// States whether it is an oscillation that would describe the reading better, and is not tried
    /// because the input may cause it.
    pub follows_input: bool,
    /// Against the model without it.
    pub comparison: Comparison,
}

/// A candidate that fits as well in a term's place.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The model with it.
    pub judged: Judged,
    /// Library id of the rival.
    pub id: &'static str,
}

/// A model in which the form of one law is free.
#[derive(Debug, Clone)]
pub struct Departing {
    /// The model with the freed form, and its held-out record.
    pub judged: Judged,
    /// The term whose form is free.
    pub index: usize,
}

/// The outcome of a search among models.
#[derive(Debug, Clone)]
pub struct Selection {
    /// The base model, fitted alone.
    pub base: Judged,
    /// The model chosen; the base where nothing was.
    pub chosen: Judged,
    /// States whether the reading follows the base model at all.
    pub base_follows: bool,
    /// Each candidate alone against the base, best first.
    pub alone: Vec<Trial>,
    /// Candidates that were tried.
    pub tried: usize,
    /// For each term of the chosen model, the candidates that would do as well in its place.
    pub rivals: Vec<Vec<Rival>>,
    /// All other candidates that were fitted instead of the term, where one was chosen.
    pub stand_ins: Vec<Rival>,
    /// The model with the form of one law free, where that law departs from its stated form.
    pub departing: Option<Departing>,
    /// States whether the search ended because its work was spent, with structure left.
    pub cut_short: bool,
    /// States whether an oscillation was left that the input may cause.
    pub follows_input: bool,
    /// Limits of what the input and the length of the recording determine.
    pub reach: Identifiability,
    /// States whether some of those candidates were not tried because the work for it was spent.
    pub rivals_left_out: bool,
}

/// Scores a fit on validation samples.
pub fn judge(data: &Data, fit: Fit, scales: &Scales) -> Judged {
    let held_out = held_out(data, &fit, scales, &data.validation);
    Judged { fit, held_out }
}
