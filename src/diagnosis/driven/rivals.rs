//! Which other candidates would do as well in the place of a term that was chosen: a better one takes it, an equal one is
//! remembered, so that no name is given where the recording cannot tell two apart.

use rayon::prelude::*;

use crate::progress;

use super::fit::Data;
use super::select::{Judged, Selection, Trial, pruned, refined, round, without};
use super::term::{Scales, Term};

/// Times that a better stand-in may take a term's place.
const SWAPS: usize = 1;
/// Log-likelihood by which a model must lead to be told from another: odds of 400 to 1.
const TIE: f64 = 6.0;

/// A candidate that fits as well in a term's place.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The model with it.
    pub judged: Judged,
    /// Its id.
    pub id: &'static str,
    /// By how much the chosen model is more likely, in units of log-likelihood.
    pub behind: f64,
}

/// Whether the library says that one can be mistaken for the other.
pub fn alike(a: &Term, b: &Term) -> bool {
    a.words().confusable_with.contains(&b.id()) || b.words().confusable_with.contains(&a.id())
}

/// Tries every other candidate in the place of each chosen term.
pub fn settle(data: &Data, selection: &mut Selection, scales: &Scales, candidates: &[Term]) {
    for attempt in 0..=SWAPS {
        let here = refined(data, &selection.chosen.fit, scales);
        let terms = selection.chosen.fit.shape.terms.clone();
        let trials: Vec<Vec<Trial>> =
            (0..terms.len()).into_par_iter().map(|i| in_place_of(data, selection, i, &here, candidates)).collect();
        let mut better: Option<Judged> = None;
        let score = selection.chosen.score();
        selection.rivals = Vec::new();
        for (term, others) in terms.iter().zip(&trials) {
            let mut equal: Vec<Rival> = Vec::new();
            for trial in others.iter().filter(|t| t.term.id() != term.id()) {
                let Some(judged) = trial.judged.as_ref().filter(|j| !j.fit.at_bound(&here)) else { continue };
                let behind = score - judged.score();
                if behind < -1.0 && better.as_ref().is_none_or(|b| b.score() < judged.score()) {
                    better = Some(judged.clone());
                }
                if behind < TIE && !equal.iter().any(|e| e.id == trial.term.id()) {
                    equal.push(Rival { judged: judged.clone(), id: trial.term.id(), behind });
                }
            }
            selection.rivals.push(equal);
        }
        match better {
            Some(better) if attempt < SWAPS && !data.work.is_spent(data.hull.len()) && !progress::interrupted() => {
                selection.chosen = pruned(data, better, scales, selection.tried);
            }
            _ => break,
        }
    }
}

/// Candidates in the place of one chosen term: all that it can be mistaken for, and where it is the only one, all.
fn in_place_of(data: &Data, selection: &Selection, index: usize, scales: &Scales, candidates: &[Term]) -> Vec<Trial> {
    let chosen = &selection.chosen;
    let term = &chosen.fit.shape.terms[index];
    let alone = chosen.fit.shape.terms.len() == 1;
    let poorer = if alone { Some(selection.base.clone()) } else { without(data, chosen, index, scales) };
    let Some(poorer) = poorer else { return Vec::new() };
    let mut trials = if alone { selection.alone.clone() } else { Vec::new() };
    let fitted = |t: &Term| trials.iter().any(|other| other.judged.is_some() && other.term == *t);
    let open: Vec<Term> = candidates
        .iter()
        .copied()
        .filter(|t| !poorer.has(t.id()) && t.id() != term.id() && alike(t, term) && !fitted(t))
        .collect();
    trials.extend(round(data, &poorer, &open, scales, open.len()));
    trials
}
