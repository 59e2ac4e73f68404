//! Search over sets of laws: best first, a few sets in parallel, pairs that only help together
//! included; each set is fitted once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use crate::numerics::order;

use super::evidence::{Gain, gain};
use super::fit::{Fitted, MOST_STEPS, fit, squares};
use super::kind::{Form, Kind, Point, Set};
use super::levels::{AT_NOISE, CLEAR, EXACT, FAINT, INEXACT};
use super::prospect::Prospects;

/// Sets that are followed in parallel.
const BEAM: usize = 2;
/// Laws in a set at most.
pub(super) const MOST_LAWS: usize = 6;
/// Laws in a set after which it shows whether the model beneath them is right.
const FEW_LAWS: usize = 2;

/// Fits of sets of laws, remembered.
pub(crate) struct Search<'a, K> {
    /// The recording and its laws.
    pub kind: &'a K,
    /// Variance of the noise of a row.
    pub noise: f64,
    fitted: Mutex<HashMap<Set, Option<Arc<Fitted>>>>,
    /// Beginnings of laws next to sets.
    pub(super) begun: Prospects,
}

impl<'a, K: Kind> Search<'a, K> {
    /// Begins with the base model alone; `None` where it cannot be fitted from there.
    pub(crate) fn begin(kind: &'a K, noise: f64, base: &Point) -> Option<(Self, Arc<Fitted>)> {
        let base = Arc::new(fit(kind, &[], base, MOST_STEPS)?);
        let fitted = Mutex::new(HashMap::from([(Vec::new(), Some(base.clone()))]));
        Some((Self { kind, noise, fitted, begun: Prospects::default() }, base))
    }

    /// Gain of one fitted set over another.
    pub(crate) fn gain(&self, without: &Fitted, with: &Fitted) -> Gain {
        gain(self.kind.layout(), without, with, self.noise)
    }

    /// Returns whether what one set has more than the other earns a name.
    pub(crate) fn holds(&self, without: &Fitted, with: &Fitted) -> bool {
        self.gain(without, with).holds()
    }

    /// Returns whether a set is as good as the best one but for chance, or fits no worse with as few
    /// coordinates. The error on rows that were not fitted comes from a linear step, which is wrong where the
    /// mass comes to rest.
    fn is_no_worse(&self, one: &Fitted, best: &Fitted) -> bool {
        let fits = one.variance <= best.variance && one.point.shared.len() <= best.point.shared.len();
        fits || self.gain(one, best).is_chance()
    }

    /// Returns whether a model leaves no more than the noise.
    pub(crate) fn is_at_noise(&self, model: &Fitted) -> bool {
        model.variance < (1.0 + AT_NOISE) * self.noise
    }

    /// Returns whether two sets are equally good.
    pub(crate) fn as_good(&self, one: &Fitted, best: &Fitted) -> bool {
        let gain = self.gain(one, best);
        let left = (best.error - self.noise * self.kind.layout().rows() as f64).max(0.0);
        self.is_no_worse(one, best) || gain.removed < INEXACT * left
    }

    /// The best set that the search finds; the base where none holds. It begins at the base model
    /// and at what is `known` already.
    pub(crate) fn run(&self, base: &Arc<Fitted>, known: Option<Arc<Fitted>>) -> Arc<Fitted> {
        let mut held: Vec<Arc<Fitted>> = std::iter::once(base.clone()).chain(known).collect();
        // Nothing needs to be added to what leaves only noise; its rivals are found by exchange, below.
        let from = held.iter().skip(1).find(|f| self.is_at_noise(f)).map_or_else(|| held.clone(), |f| vec![f.clone()]);
        self.grow(from, &mut held, MOST_LAWS);
        let mut chosen = self.simplest(base, &held);
        loop {
            let lowest = held.iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or(&chosen);
            let others = [&chosen, lowest].into_iter().flat_map(|f| self.exchanged(f));
            let mut others: Vec<Arc<Fitted>> = others.filter(|f| is_new(&held, f)).collect();
            order::sort_by_key(&mut others, |f| f.error);
            others.dedup_by(|a, b| sorted(&a.set) == sorted(&b.set));
            held.extend(others.iter().cloned());
            let better = others.into_iter().filter(|f| self.holds(&chosen, f));
            if let Some(best) = better.min_by(|a, b| a.error.total_cmp(&b.error)) {
                self.grow(vec![best], &mut held, MOST_LAWS);
            }
            let again = self.simplest(base, &held);
            if sorted(&again.set) == sorted(&chosen.set) {
                return again;
            }
            chosen = again;
        }
    }

    /// The best of a set and its contenders on other rows; where that leaves more than the noise there, the best set
    /// that growing it leads to.
    pub(crate) fn grown(&self, base: &Arc<Fitted>, found: Arc<Fitted>, contenders: Vec<Arc<Fitted>>) -> Arc<Fitted> {
        // A contender that leaves more than the noise is no law of the recording either.
        let contenders = contenders.into_iter().filter(|f| self.is_at_noise(f));
        let all: Vec<Arc<Fitted>> = std::iter::once(found.clone()).chain(contenders).collect();
        let stands: Vec<&Arc<Fitted>> =
            all.iter().filter(|f| !all.iter().any(|g| self.need_not_bend(base, f, g))).collect();
        let lowest = stands.iter().min_by(|a, b| a.error.total_cmp(&b.error)).map_or(&found, |f| *f);
        let is_near = |f: &Fitted| self.is_at_noise(f) && f.error - lowest.error <= EXACT * (base.error - lowest.error);
        let good = stands.iter().filter(|f| self.is_no_worse(f, lowest) || is_near(f));
        let size = |f: &Fitted| (f.point.shared.len(), f.set.len());
        let best = good.min_by(|a, b| size(a).cmp(&size(b)).then(a.error.total_cmp(&b.error)));
        let best = Arc::clone(best.map_or(&found, |f| *f));
        let mut held: Vec<Arc<Fitted>> = std::iter::once(base.clone()).chain(all.iter().cloned()).collect();
        if self.is_at_noise(&best) {
            return best;
        }
        self.grow(vec![best], &mut held, MOST_LAWS);
        self.simplest(base, &held)
    }

    /// Returns whether a set has a law with its exponent free where the other one has that law as it is stated, and
    /// does no better than laws are inexact by.
    fn need_not_bend(&self, base: &Fitted, bent: &Fitted, stated: &Fitted) -> bool {
        let only = |of: &Fitted, other: &Fitted| -> Set {
            of.set.iter().copied().filter(|law| !other.set.contains(law)).collect()
        };
        let ([one], [other]) = (&only(bent, stated)[..], &only(stated, bent)[..]) else { return false };
        let is_pair = self.kind.form(*one) == Form::Exponent
            && self.kind.form(*other) == Form::Stated
            && self.kind.argument(*one) == self.kind.argument(*other);
        let is_small = stated.error - bent.error <= EXACT * (base.error - bent.error);
        let reaches = self.is_at_noise(bent) && stated.variance >= (1.0 + FAINT) * self.noise;
        is_pair && !reaches && (is_small || !(self.holds(stated, bent) || self.gain(stated, bent).frees()))
    }

    /// With each law as it is stated where its exponent need not be free.
    pub(crate) fn straightened(&self, base: &Fitted, mut best: Arc<Fitted>) -> Arc<Fitted> {
        for law in best.set.clone().into_iter().filter(|law| self.kind.form(*law) == Form::Exponent) {
            let place = best.set.iter().position(|l| *l == law);
            let Some(without) = place.and_then(|place| self.without(&best, place)) else { continue };
            let stated = self.instead(&without, law, Form::Stated).into_iter();
            let lowest = stated.min_by(|a, b| a.error.total_cmp(&b.error));
            best = lowest.filter(|stated| self.need_not_bend(base, &best, stated)).unwrap_or(best);
        }
        best
    }

    /// The best set of few laws, before the search goes on to more.
    pub(crate) fn early(&self, base: &Arc<Fitted>) -> Arc<Fitted> {
        let mut held = vec![base.clone()];
        self.grow(held.clone(), &mut held, FEW_LAWS);
        held.into_iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or_else(|| base.clone())
    }

    /// Adds laws to these sets, up to this many, as long as they hold.
    fn grow(&self, mut frontier: Vec<Arc<Fitted>>, held: &mut Vec<Arc<Fitted>>, most: usize) {
        frontier.retain(|f| f.set.len() < most);
        while !frontier.is_empty() {
            // One parent after the other: a set that two of them lead to is fitted from the better
            // one.
            let mut next: Vec<Arc<Fitted>> = frontier.iter().flat_map(|f| self.held_children(f)).collect();
            order::sort_by_key(&mut next, |f| f.error);
            // What freedom of its exponent absorbs is no further name: the best set of each
            // argument is tried with it.
            let argument = |f: &Fitted| f.set.last().map(|law| self.kind.argument(*law));
            let first = |i: &usize| next[..*i].iter().all(|f| argument(f) != argument(&next[*i]));
            let may_bend = |i: &usize| !self.is_at_noise(&next[*i]) && !self.is_outdone(&next[*i], &next);
            let bent: Vec<usize> = (0..next.len()).filter(first).filter(may_bend).collect();
            let bent: Vec<Arc<Fitted>> = bent.into_iter().map(|i| self.with_exponents(next[i].clone())).collect();
            next.extend(bent);
            order::sort_by_key(&mut next, |f| f.error);
            next.dedup_by(|a, b| sorted(&a.set) == sorted(&b.set));
            next.truncate(BEAM);
            next = next.into_iter().map(|f| self.without_idle(f)).collect();
            next.retain(|f| is_new(held, f));
            held.extend(next.iter().cloned());
            next.retain(|f| f.set.len() < most && !self.is_outdone(f, held));
            frontier = next;
        }
    }

    /// Sets of one law more, or two, that hold.
    fn held_children(&self, parent: &Arc<Fitted>) -> Vec<Arc<Fitted>> {
        let of = |form: Form| -> Vec<Arc<Fitted>> {
            let all = self.children(parent, form, form == Form::Stated);
            all.into_iter().filter(|child| self.gain(parent, child).may_hold()).collect()
        };
        let mut stated = of(Form::Stated);
        let holds = stated.iter().any(|child| self.holds(parent, child));
        if holds || !parent.set.is_empty() || self.is_at_noise(parent) {
            return stated;
        }
        // If no stated law holds, try laws with a free exponent. These can mimic other physics, so they only count
        // if they bring the residual down to the noise.
        let mut bent = of(Form::Exponent);
        bent.retain(|child| self.is_at_noise(child));
        stated.append(&mut bent);
        stated
    }

    /// Returns whether the law that was added last is within its range: at the end of it a form is that of
    /// another law.
    fn is_inside(&self, set: &Fitted) -> bool {
        let own = set.set.len().checked_sub(1).map(|place| self.kind.coordinates(&set.set, place));
        !own.into_iter().flatten().any(|i| set.at_bound[i])
    }

    /// Returns whether a set leaves more than the noise where one with no more coordinates does not: what
    /// it may grow to is no simpler.
    fn is_outdone(&self, set: &Fitted, held: &[Arc<Fitted>]) -> bool {
        let outdoes = |f: &Arc<Fitted>| self.is_at_noise(f) && f.point.shared.len() <= set.point.shared.len();
        !self.is_at_noise(set) && held.iter().any(outdoes)
    }

    /// Sets that differ from this one by a single law. A law that was added early may have stood for two, and
    /// is then in the place of one of them.
    pub(crate) fn exchanged(&self, set: &Arc<Fitted>) -> Vec<Arc<Fitted>> {
        let children = |without: Arc<Fitted>| -> Vec<Arc<Fitted>> {
            let all = self.children(&without, Form::Stated, false);
            all.into_iter().filter(|child| self.holds(&without, child)).collect()
        };
        (0..set.set.len()).filter_map(|place| self.without(set, place)).flat_map(children).collect()
    }

    /// Without the laws that have no strength next to what was added later.
    fn without_idle(&self, mut set: Arc<Fitted>) -> Arc<Fitted> {
        let is_idle = |f: &Fitted, place: &usize| {
            let strengths = self.kind.strengths(&f.set, *place);
            let is_none = |i: &usize| f.at_bound[*i] || f.point.shared[*i].abs() < CLEAR * f.deviations[*i];
            !strengths.is_empty() && strengths.iter().all(is_none)
        };
        while let Some(place) = (0..set.set.len()).find(|place| is_idle(&set, place)) {
            match self.without(&set, place) {
                Some(without) => set = without,
                None => break,
            }
        }
        set
    }

    /// With an exponent of its own for each law that it betters.
    pub(super) fn with_exponents(&self, mut best: Arc<Fitted>) -> Arc<Fitted> {
        for law in best.set.clone() {
            let place = best.set.iter().position(|l| *l == law);
            let Some(without) = place.and_then(|place| self.without(&best, place)) else { continue };
            let fits = self.in_place_of(&without, law, Form::Exponent, |other| {
                let point = self.kind.widened(&best.set, &best.point, place?, other)?;
                let set: Set = without.set.iter().copied().chain([other]).collect();
                self.remembered(&set, f64::INFINITY, || fit(self.kind, &set, &point, MOST_STEPS))
            });
            let lowest = fits.iter().min_by(|a, b| a.error.total_cmp(&b.error)).cloned();
            let good = fits.into_iter().filter(|f| lowest.as_ref().is_some_and(|best| self.is_no_worse(f, best)));
            let bent = good.min_by_key(|f| f.point.shared.len());
            let is_better = |bent: &Fitted| self.holds(&best, bent) || self.bends(&without, &best, bent);
            best = bent.filter(|bent| self.is_inside(bent) && is_better(bent)).unwrap_or(best);
        }
        best
    }

    /// Returns whether a law has another exponent than it states, by more than laws are inexact by.
    fn bends(&self, without: &Fitted, stated: &Fitted, bent: &Fitted) -> bool {
        stated.error - bent.error > EXACT * (without.error - bent.error) && self.gain(stated, bent).frees()
    }

    /// Sets with a law of this form, and of the same argument, in the place of a law.
    pub(crate) fn instead(&self, without: &Fitted, law: usize, form: Form) -> Vec<Arc<Fitted>> {
        self.in_place_of(without, law, form, |_| None)
    }

    /// The same; a law for which `known` has a fit is not searched from the set without it.
    fn in_place_of(
        &self,
        without: &Fitted,
        law: usize,
        form: Form,
        known: impl Fn(usize) -> Option<Arc<Fitted>>,
    ) -> Vec<Arc<Fitted>> {
        let kind = self.kind;
        let takes_place = |other: &usize| {
            kind.form(*other) == form
                && (kind.argument(*other) == kind.argument(law) || kind.excludes(*other, law))
                && !without.set.iter().any(|l| kind.excludes(*l, *other))
        };
        (0..kind.laws())
            .filter(takes_place)
            .filter_map(|other| known(other).or_else(|| self.with(without, other)))
            .collect()
    }

    /// The best of these sets; of equally good ones that with the fewest laws, and the fewest
    /// coordinates. A set is equally good, too, where only the exact form of one of its laws is
    /// missing.
    fn simplest(&self, base: &Fitted, held: &[Arc<Fitted>]) -> Arc<Fitted> {
        let lowest = held.iter().min_by(|a, b| a.error.total_cmp(&b.error)).cloned();
        let best = lowest.unwrap_or_else(|| held[0].clone());
        let lacks = |f: &Fitted| held.iter().any(|g| f.set.iter().all(|l| g.set.contains(l)) && self.holds(f, g));
        let size = |f: &Fitted| (f.point.shared.len(), f.set.len());
        // It lacks no more than laws are inexact by, leaves no more than the noise, or is as good
        // with one of its forms free: two of the three show that no law is missing.
        let is_near = |f: &Fitted| {
            let is_exact = f.error - best.error <= EXACT * (base.error - best.error);
            let is_a_form = || {
                let freed = (0..f.set.len()).filter_map(|place| self.freed(f, place));
                freed.into_iter().any(|freed| self.is_no_worse(&freed, &best))
            };
            match [is_exact, self.is_at_noise(f)] {
                [true, true] => true,
                [false, false] => false,
                _ => is_a_form(),
            }
        };
        let is_good =
            |f: &Arc<Fitted>| (self.is_no_worse(f, &best) && !lacks(f)) || (size(f) < size(&best) && is_near(f));
        let good = held.iter().filter(|f| f.set.len() <= best.set.len() && is_good(f));
        let simple = good.min_by(|a, b| size(a).cmp(&size(b)).then(a.error.total_cmp(&b.error)));
        self.pruned(simple.cloned().unwrap_or(best))
    }

    /// The set with the form of the law at a place free.
    pub(crate) fn freed(&self, from: &Fitted, place: usize) -> Option<Arc<Fitted>> {
        let without = self.without(from, place)?;
        let fits = self.instead(&without, from.set[place], Form::Free).into_iter();
        fits.min_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// The set without the law at a place, fitted from here too, so that no law is named for a minimum that the
    /// others have without it; where no fit of it comes to rest, the best set of fewer of its laws that does.
    pub(crate) fn weighed_without(&self, from: &Fitted, place: usize) -> Option<Arc<Fitted>> {
        let law = from.set[place];
        let is_part = |f: &Arc<Fitted>| !f.set.contains(&law) && f.set.iter().all(|l| from.set.contains(l));
        let fewer = || self.all().into_iter().filter(is_part).min_by(|a, b| a.error.total_cmp(&b.error));
        self.reduced(from, place, 0.0).or_else(fewer)
    }

    /// Without the laws that do not hold next to the others.
    fn pruned(&self, mut best: Arc<Fitted>) -> Arc<Fitted> {
        loop {
            let reduced = (0..best.set.len()).filter_map(|place| self.without(&best, place));
            let idle = reduced.filter(|r| !self.holds(r, &best)).min_by(|a, b| a.error.total_cmp(&b.error));
            match idle {
                Some(reduced) => best = reduced,
                None => return best,
            }
        }
    }

    /// A set, fitted from a point; `None` where no fit from there comes to rest.
    pub(crate) fn at(&self, set: &[usize], point: &Point) -> Option<Arc<Fitted>> {
        self.remembered(set, f64::INFINITY, || fit(self.kind, set, point, MOST_STEPS))
    }

    /// The set without the law at a place.
    pub(crate) fn without(&self, from: &Fitted, place: usize) -> Option<Arc<Fitted>> {
        self.reduced(from, place, f64::INFINITY)
    }

    /// The same, where the fit so far leaves more than is promised, the better one of that and of a fit from here.
    fn reduced(&self, from: &Fitted, place: usize, promised: f64) -> Option<Arc<Fitted>> {
        let mut set = from.set.clone();
        set.remove(place);
        let point = self.kind.without(&from.set, &from.point, place);
        self.remembered(&set, promised, || fit(self.kind, &set, &point, MOST_STEPS))
    }

    /// The fit of a set so far, where it leaves no more than is promised here; else the better one of it and of
    /// a fit from here.
    pub(super) fn remembered(
        &self,
        set: &[usize],
        promised: f64,
        fit: impl FnOnce() -> Option<Fitted>,
    ) -> Option<Arc<Fitted>> {
        let key = sorted(set);
        let left = |f: &Arc<Fitted>| squares(&f.model.residual);
        let known = self.fitted.lock().ok().and_then(|map| map.get(&key).cloned());
        if let Some(known) = &known
            && known.as_ref().is_none_or(|f| left(f) <= promised)
        {
            return known.clone();
        }
        let found = known.flatten().into_iter().chain(fit().map(Arc::new)).min_by(|a, b| left(a).total_cmp(&left(b)));
        if let Ok(mut map) = self.fitted.lock() {
            map.insert(key, found.clone());
        }
        found
    }

    /// All fits of sets so far.
    pub(crate) fn all(&self) -> Vec<Arc<Fitted>> {
        let mut all: Vec<Arc<Fitted>> =
            self.fitted.lock().map(|map| map.values().flatten().cloned().collect()).unwrap_or_default();
        all.sort_by(|a, b| a.error.total_cmp(&b.error).then_with(|| a.set.cmp(&b.set)));
        all
    }
}

/// Returns whether a set is none of these.
fn is_new(held: &[Arc<Fitted>], set: &Fitted) -> bool {
    held.iter().all(|h| sorted(&h.set) != sorted(&set.set))
}

/// A set in the order of the space.
pub(crate) fn sorted(set: &[usize]) -> Set {
    let mut set = set.to_vec();
    set.sort_unstable();
    set
}
