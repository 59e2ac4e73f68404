//! From the best set of laws to what may be named: each law with its share, its rivals and its free
//! form; all names together; and what the rest depends on.

use std::sync::Arc;

use super::evidence::Gain;
use super::fit::Fitted;
use super::kind::{Argument, Form, Kind, Point};
use super::levels::{AT_NOISE, CLEAR, EXACT, FAINT, TOGETHER};
use super::search::{Search, sorted};

/// Sets that are fitted again, next to the best one, where the rows are others.
const CONTENDERS: usize = 8;

/// A law that holds.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    /// Place in the set.
    pub place: usize,
    /// Over the set without it.
    pub gain: Gain,
    /// Equally good sets that have another law in its place, with that law.
    pub rivals: Vec<(usize, Arc<Fitted>)>,
    /// The set with its form free, where that betters the stated form.
    pub departs: Option<(Arc<Fitted>, Gain)>,
}

/// A quantity on which what a model leaves depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dependence {
    /// Quantity on which it depends.
    pub argument: Argument,
    /// Gain of a free form of it.
    pub gain: Gain,
}

/// Holds what a search allows to be said.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    /// The base model alone.
    pub base: Arc<Fitted>,
    /// The base model with the named laws; the base model where none is named.
    pub model: Arc<Fitted>,
    /// Laws that hold, strongest first.
    pub named: Vec<Named>,
    /// All of them over the base model.
    pub together: Option<Gain>,
    /// Laws that hold one by one and remove too little together to be named.
    pub imitations: Vec<usize>,
    /// The best set, named or not.
    pub best: Arc<Fitted>,
    /// Sets of laws over which the best one does not hold, lowest error first: other rows may tell them apart.
    pub contenders: Vec<Arc<Fitted>>,
    /// Holds what the rest depends on, the largest share first.
    pub rest: Vec<Dependence>,
    /// Each law alone over the base model, best first.
    pub alone: Vec<(usize, Gain)>,
}

/// Searches, and says what holds; `base` is the fitted base model, `known` a set that was found
/// already.
pub(crate) fn names<K: Kind>(search: &Search<'_, K>, base: Arc<Fitted>, known: Option<Arc<Fitted>>) -> Found {
    let found = search.run(&base, known);
    let judged = judged(search, base, found, None);
    let mut alone: Vec<(usize, Gain)> = search
        .all()
        .into_iter()
        .filter_map(|f| Some((*f.set.first().filter(|_| f.set.len() == 1)?, search.gain(&judged.base, &f))))
        .filter(|(law, _)| search.kind.form(*law) == Form::Stated)
        .collect();
    alone.sort_by(|a, b| b.1.removed.total_cmp(&a.1.removed));
    Found { alone, ..judged }
}

/// Says what holds of the best set on other rows than those it was found on, with the rivals found there, and
/// with what only these rows show where it `grows`. A set is fitted from where `begin` says.
pub(crate) fn again<K: Kind>(
    search: &Search<'_, K>,
    base: Arc<Fitted>,
    found: &Found,
    begin: impl Fn(&Fitted) -> Point,
    grows: bool,
) -> Option<Found> {
    let best = search.at(&found.best.set, &begin(&found.best))?;
    for (_, rival) in found.named.iter().flat_map(|n| &n.rivals) {
        search.at(&rival.set, &begin(rival));
    }
    let named = std::iter::once(&found.model).filter(|f| !f.set.is_empty());
    let contenders = || named.chain(&found.contenders).filter_map(|f| search.at(&f.set, &begin(f)));
    let best = if grows { search.grown(&base, best, contenders().collect()) } else { best };
    let judged = judged(search, base, best, Some(found));
    Some(Found { alone: found.alone.clone(), ..judged })
}

/// Says what holds of the best set; rivals are looked for where nothing was found `earlier`.
fn judged<K: Kind>(search: &Search<'_, K>, base: Arc<Fitted>, found: Arc<Fitted>, earlier: Option<&Found>) -> Found {
    // A law is another one of its kind where that leaves the noise alone, or, at the noise, does better by more
    // than laws are inexact by.
    let found = search.straightened(&base, found);
    let bent = search.or_expanded(search.with_exponents(found.clone()));
    let (best, named) = held(search, &base, &found, earlier);
    let reaches = excess(search, &bent) < AT_NOISE && excess(search, &best) >= FAINT;
    let is_other = reaches || best.error - bent.error > EXACT * (base.error - best.error);
    let (best, mut named) = if is_other { held(search, &base, &bent, earlier) } else { (best, named) };
    named.sort_by(|a, b| b.gain.removed.total_cmp(&a.gain.removed));
    let together = search.gain(&base, &best);
    let whole = !named.is_empty() && named.len() == best.set.len();
    let enough = together.share >= TOGETHER || excess(search, &best) < AT_NOISE;
    let is_argued = whole && enough && !is_outdone_by_another_argument(search, &base, &best);
    let (model, imitations) = if is_argued { (best, Vec::new()) } else { (base.clone(), found.set.clone()) };
    if !imitations.is_empty() {
        named.clear();
    }
    let rest = dependences(search, &model);
    for name in &mut named {
        name.departs = departs(search, &model, name.place);
    }
    let together = (!named.is_empty()).then_some(together);
    let contenders = contenders(search, &found);
    Found { base, model, named, together, imitations, best: found, contenders, rest, alone: Vec::new() }
}

/// Sets that the best one at most betters by chance, as far as a name is concerned.
fn contenders<K: Kind>(search: &Search<'_, K>, best: &Fitted) -> Vec<Arc<Fitted>> {
    let is_named = |law: &usize| matches!(search.kind.form(*law), Form::Stated | Form::Exponent);
    let all = search.all().into_iter().filter(|f| !f.set.is_empty() && f.set.iter().all(is_named));
    all.filter(|f| sorted(&f.set) != sorted(&best.set) && !search.holds(f, best)).take(CONTENDERS).collect()
}

/// The laws of a set that hold, and the set without those that do not: each is weighed without
/// them.
fn held<K: Kind>(
    search: &Search<'_, K>,
    base: &Fitted,
    found: &Arc<Fitted>,
    earlier: Option<&Found>,
) -> (Arc<Fitted>, Vec<Named>) {
    let mut best = found.clone();
    loop {
        let stands = |place: usize| {
            let own = named(search, base, &best, place)?;
            let is_weighed = earlier.is_some_and(|found| found.model.set.contains(&best.set[place]));
            (is_weighed || !is_rhythm(search, &best, place)).then_some(own)
        };
        let all: Vec<Option<Named>> = (0..best.set.len()).map(stands).collect();
        // The one that was added last had the least to add.
        let idle = (0..best.set.len()).rev().filter(|place| all[*place].is_none());
        match idle.filter_map(|place| search.without(&best, place)).next() {
            Some(without) => {
                best = without;
                if earlier.is_none() {
                    search.exchanged(&best);
                }
            }
            None => return (best, all.into_iter().flatten().collect()),
        }
    }
}

/// Mean square of what a model leaves over the noise's variance, less one.
pub(crate) fn excess<K: Kind>(search: &Search<'_, K>, model: &Fitted) -> f64 {
    model.variance / search.noise.max(1e-300) - 1.0
}

/// The law at a place of the best set, where it holds, on no bound, with its interval clear of
/// zero.
fn named<K: Kind>(search: &Search<'_, K>, base: &Fitted, best: &Arc<Fitted>, place: usize) -> Option<Named> {
    let without = search.weighed_without(best, place)?;
    let gain = search.gain(&without, best);
    let own = search.kind.coordinates(&best.set, place);
    let on_bound = own.clone().any(|i| best.at_bound[i]);
    let strengths = search.kind.strengths(&best.set, place);
    let is_clear = |i: &usize| best.point.shared[*i].abs() > CLEAR * best.deviations[*i];
    let may_be_zero = !strengths.is_empty() && !strengths.iter().any(is_clear);
    // A law that is linear or goes with time alone can imitate anything slow or broad; one that
    // removes no more than the others may be inexact by, or that leaves more than the noise in any form
    // of it, can be an imitation too. Two of the three are enough to doubt it. A further mode is a
    // line, which imitates nothing large.
    let leaves = |f: &Fitted| excess(search, f) >= AT_NOISE;
    let is_small = gain.removed < EXACT * (base.error - best.error);
    let is_patch = match (search.kind.argument(best.set[place]), is_small) {
        (Argument::Frequency | Argument::Time | Argument::Motion, true) => true,
        (Argument::Frequency | Argument::Time, false) | (_, true) => {
            leaves(best) && search.freed(best, place).is_none_or(|freed| leaves(&freed))
        }
        _ => false,
    };
    let may_be_nothing = may_be_zero || (strengths.is_empty() && reaches_a_bound(search.kind, best, own.start));
    if on_bound || best.is_impossible || may_be_nothing || is_patch || !search.holds(&without, best) {
        return None;
    }
    // Where the other laws do better with one of their forms free, this one only made up for that form.
    let others_freed = || (0..without.set.len()).filter_map(|place| search.freed(&without, place));
    if others_freed().any(|freed| search.holds(best, &freed)) {
        return None;
    }
    let law = best.set[place];
    let instead = |f: &Arc<Fitted>| {
        let same = f.set.len() == best.set.len() && sorted(&f.set) != sorted(&best.set);
        let kept = without.set.iter().all(|l| f.set.contains(l));
        let other = f.set.iter().copied().find(|l| !without.set.contains(l))?;
        let may_stand = match search.kind.form(other) {
            Form::Stated => f.point.shared.len() <= best.point.shared.len(),
            // A different law that depends on the same quantity, with a fitted exponent.
            Form::Exponent => search.kind.argument(other) == search.kind.argument(law) && !f.at_bound.contains(&true),
            Form::Beside | Form::Free => false,
        };
        // The same law with its exponent free does better where the stated one is not quite the law.
        let is_bent = || {
            let is_exact = best.error - f.error <= EXACT * (without.error - best.error);
            search.kind.form(other) == Form::Exponent && !is_exact && search.gain(best, f).may_free()
        };
        let is_other = !search.kind.are_alike(other, law) && (!search.kind.excludes(other, law) || is_bent());
        (same && kept && may_stand && is_other && search.as_good(f, best)).then(|| (other, f.clone()))
    };
    let mut rivals: Vec<(usize, Arc<Fitted>)> = search.all().iter().filter_map(instead).collect();
    rivals.extend(search.expansions(best, &without, place));
    Some(Named { place, gain, rivals, departs: None })
}

/// Returns whether a periodic change in time fits as well as the further mode at a place of a set: it puts lines next to
/// that of the first mode.
fn is_rhythm<K: Kind>(search: &Search<'_, K>, best: &Arc<Fitted>, place: usize) -> bool {
    let kind = search.kind;
    if kind.argument(best.set[place]) != Argument::Motion {
        return false;
    }
    let Some(without) = search.without(best, place) else { return false };
    let is_other = |l: &usize| kind.form(*l) == Form::Free && kind.argument(*l) == Argument::Rhythm;
    let mut others = (0..kind.laws()).filter(is_other).filter_map(|l| search.with(&without, l));
    others.any(|f| search.as_good(&f, best))
}

/// Returns whether the 95 % interval of a coordinate reaches a bound: of a law without a strength that can be zero,
/// such as a low-pass, the first one ends where the law is nothing.
fn reaches_a_bound<K: Kind>(kind: &K, model: &Fitted, coordinate: usize) -> bool {
    let reach = CLEAR * model.deviations[coordinate];
    [-reach, reach].into_iter().any(|by| {
        let mut end = model.point.clone();
        end.shared[coordinate] += by;
        let wanted = end.shared[coordinate];
        kind.confine(&model.set, &mut end);
        (end.shared[coordinate] - wanted).abs() > 1e-9 * (1.0 + wanted.abs())
    })
}

/// The model with the form of one of its laws free, where that holds over the stated form.
fn departs<K: Kind>(search: &Search<'_, K>, model: &Arc<Fitted>, place: usize) -> Option<(Arc<Fitted>, Gain)> {
    if excess(search, model) < AT_NOISE {
        return None;
    }
    let best = search.freed(model, place)?;
    search.holds(model, &best).then(|| (best.clone(), search.gain(model, &best)))
}

/// Returns whether a free form of another argument alone does better than a set of laws, even with the form of one
/// of them free: the laws only imitate it. In a decay the amplitude falls with time, so one can stand for the other.
fn is_outdone_by_another_argument<K: Kind>(search: &Search<'_, K>, base: &Arc<Fitted>, model: &Arc<Fitted>) -> bool {
    let kind = search.kind;
    if model.set.is_empty() || excess(search, model) < AT_NOISE {
        return false;
    }
    let is_other = |law: &usize| !model.set.iter().any(|own| kind.argument(*own).overlaps(kind.argument(*law)));
    let others = (0..kind.laws()).filter(|law| kind.form(*law) == Form::Free && is_other(law));
    let freed: Vec<Arc<Fitted>> = (0..model.set.len()).filter_map(|place| search.freed(model, place)).collect();
    let outdoes = |free: &Arc<Fitted>| std::iter::once(model).chain(&freed).all(|own| search.holds(own, free));
    others.filter_map(|law| search.with(base, law)).any(|free| outdoes(&free))
}

/// Arguments of which a free form betters a model, the largest share first; none where it leaves no
/// more than the noise.
pub(crate) fn dependences<K: Kind>(search: &Search<'_, K>, model: &Arc<Fitted>) -> Vec<Dependence> {
    let kind = search.kind;
    if excess(search, model) < AT_NOISE {
        return Vec::new();
    }
    let mut all: Vec<Dependence> = Vec::new();
    for law in (0..kind.laws()).filter(|l| kind.form(*l) == Form::Free) {
        let place = model.set.iter().position(|l| kind.excludes(*l, law));
        let from = place.map_or_else(|| Some(model.clone()), |place| search.without(model, place));
        let Some(freed) = from.and_then(|from| search.with(&from, law)) else { continue };
        if search.holds(model, &freed) {
            let here = Dependence { argument: kind.argument(law), gain: search.gain(model, &freed) };
            match all.iter_mut().find(|d| d.argument == here.argument) {
                Some(known) if known.gain.removed >= here.gain.removed => {}
                Some(known) => *known = here,
                None => all.push(here),
            }
        }
    }
    all.sort_by(|a, b| b.gain.removed.total_cmp(&a.gain.removed));
    all
}
