//! Which other candidates would do as well in the place of a term that was chosen: a better one takes it, an equal one is
//! remembered, so that no name is given where the recording cannot tell two apart.

use crate::parallel;
use crate::progress;

use super::fit::Data;
use super::select::{Judged, Selection, Trial, pruned, refined, round, without};
use super::term::{Scales, Term};

/// Times that a better stand-in may take a term's place.
const SWAPS: usize = 1;
/// Log-likelihood by which a model must lead to be told from another: odds of 400 to 1.
pub const TIE: f64 = 6.0;

/// A candidate that fits as well in a term's place.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The model with it.
    pub judged: Judged,
    /// Its id.
    pub id: &'static str,
}

/// Whether the library says that one can be mistaken for the other.
pub fn alike(a: &Term, b: &Term) -> bool {
    a.words().confusable_with.contains(&b.id()) || b.words().confusable_with.contains(&a.id())
}

/// A model in which one other candidate does the work of two terms that can be mistaken for each other: what neither of two
/// look-alikes is, both together can imitate. `None` where two are needed.
pub fn one_for_two(data: &Data, chosen: &Judged, scales: &Scales, candidates: &[Term]) -> Option<Judged> {
    let terms = &chosen.fit.shape.terms;
    let pairs = (0..terms.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let twins: Vec<(usize, usize)> = pairs.filter(|(i, j)| alike(&terms[*i], &terms[*j])).collect();
    let in_place = |&(i, j): &(usize, usize)| {
        let open = candidates.iter().copied().filter(|t| !chosen.has(t.id()));
        let open: Vec<Term> = open.filter(|t| alike(t, &terms[i]) || alike(t, &terms[j])).collect();
        let poorer = without(data, &without(data, chosen, i, scales)?, j, scales)?;
        let here = refined(data, &poorer.fit, scales);
        let tried = round(data, &poorer, &open, &here, open.len());
        tried.into_iter().filter_map(|t| t.judged).find(|j| !j.fit.at_bound(&here))
    };
    let found: Vec<Judged> = parallel::filter_map(&twins, in_place);
    let better = found.into_iter().filter(|j| j.score() > chosen.score());
    better.max_by(|a, b| a.score().total_cmp(&b.score()))
}

/// Tries every other candidate in the place of each chosen term.
pub fn settle(data: &Data, selection: &mut Selection, scales: &Scales, candidates: &[Term]) {
    for attempt in 0..=SWAPS {
        let here = refined(data, &selection.chosen.fit, scales);
        let terms = selection.chosen.fit.shape.terms.clone();
        let trials: Vec<Vec<Trial>> =
            parallel::map_indices(terms.len(), |i| in_place_of(data, selection, i, &here, candidates));
        let stand_ins: Vec<Vec<Rival>> = terms
            .iter()
            .zip(trials)
            .map(|(term, others)| {
                let others = others.into_iter().filter(|t| t.term.id() != term.id());
                let fitted = others.filter_map(|t| Some(Rival { id: t.term.id(), judged: t.judged? }));
                fitted.filter(|r| !r.judged.fit.at_bound(&here)).collect()
            })
            .collect();
        let score = selection.chosen.score();
        let ahead = |r: &Rival| r.judged.score() - score;
        let all = stand_ins.iter().enumerate().flat_map(|(i, others)| others.iter().map(move |r| (i, r)));
        let better = all.filter(|(_, r)| ahead(r) > 1.0).max_by(|(_, a), (_, b)| ahead(a).total_cmp(&ahead(b)));
        let again = attempt < SWAPS && !data.work.is_spent(data.hull.len()) && !progress::interrupted();
        match better {
            Some((_, better)) if again => {
                selection.chosen = pruned(data, better.judged.clone(), scales, selection.tried);
            }
            // Too late to look around from there: what has been seen from here is weighed against it.
            Some((place, better)) => {
                let old = Rival { judged: selection.chosen.clone(), id: terms[place].id() };
                selection.chosen = better.judged.clone();
                let mut others = stand_ins.clone();
                others.remove(place);
                others.push(stand_ins[place].iter().cloned().chain([old]).collect());
                selection.rivals = tied(&selection.chosen, others);
                break;
            }
            None => {
                selection.rivals = tied(&selection.chosen, stand_ins);
                break;
            }
        }
    }
}

/// For each term of a model, the stand-ins that it does not clearly lead, each id once.
fn tied(chosen: &Judged, stand_ins: Vec<Vec<Rival>>) -> Vec<Vec<Rival>> {
    let score = chosen.score();
    let equal = |others: Vec<Rival>| {
        let mut equal: Vec<Rival> = Vec::new();
        for rival in others {
            let behind = score - rival.judged.score();
            if behind < TIE && !chosen.has(rival.id) && !equal.iter().any(|e| e.id == rival.id) {
                equal.push(rival);
            }
        }
        equal
    };
    stand_ins.into_iter().map(equal).collect()
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
