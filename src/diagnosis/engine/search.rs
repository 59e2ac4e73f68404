//! Search over sets of laws: best first, a few sets in parallel, pairs that only help together
//! included; each set is fitted once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use crate::numerics::order;
use crate::parallel;

use super::evidence::{Gain, gain};
use super::fit::{Fitted, MOST_STEPS, fit};
use super::kind::{Form, Kind, Point, Set};
use super::levels::{AT_NOISE, CLEAR, EXACT, INEXACT, NAME};
use super::linear::{Products, Step};

/// Sets that are followed in parallel.
const BEAM: usize = 2;
/// Laws that are fitted next to each set.
const WIDTH: usize = 5;
/// Pairs of laws that are fitted next to each set.
const PAIRS: usize = 2;
/// A pair helps together that promises this many times what its laws promise one by one.
const TOGETHER: f64 = 1.5;
/// Laws in a set at most.
const MOST_LAWS: usize = 6;
/// Beginnings from which a law is fitted.
const BEGINNINGS: usize = 2;
/// Log-likelihood ratio (twice) that a linear step must promise for a fit: of less no name can
/// come.
const PROMISE: f64 = NAME * NAME;
/// Part of what a linear step promises that a fit from elsewhere must have found.
const MISSED: f64 = 0.5;
/// Part of the most that is promised by any law, or by any beginning of one, that is still
/// followed.
const FOLLOWED: [f64; 2] = [0.1, 0.6];

/// A beginning of one law next to a set, and what a linear step from there promises.
#[derive(Debug, Clone)]
struct Prospect {
    law: usize,
    beginnings: Vec<Point>,
    /// Change of the prediction.
    direction: Vec<f64>,
    /// Fall of the sum of squares.
    promise: f64,
}

/// Fits of sets of laws, remembered.
pub(crate) struct Search<'a, K> {
    /// The recording and its laws.
    pub kind: &'a K,
    /// Variance of the noise of a row.
    pub noise: f64,
    fitted: Mutex<HashMap<Set, Option<Arc<Fitted>>>>,
}

impl<'a, K: Kind> Search<'a, K> {
    /// Begins with the base model alone; `None` where it cannot be fitted from there.
    pub(crate) fn begin(kind: &'a K, noise: f64, base: &Point) -> Option<(Self, Arc<Fitted>)> {
        let base = Arc::new(fit(kind, &[], base, MOST_STEPS)?);
        let fitted = Mutex::new(HashMap::from([(Vec::new(), Some(base.clone()))]));
        Some((Self { kind, noise, fitted }, base))
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
    fn is_at_noise(&self, model: &Fitted) -> bool {
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
        self.grow(held.clone(), &mut held);
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
                self.grow(vec![best], &mut held);
            }
            let again = self.simplest(base, &held);
            if sorted(&again.set) == sorted(&chosen.set) {
                return again;
            }
            chosen = again;
        }
    }

    /// The best set that growing one leads to on finer rows, where it leaves more than the noise there.
    pub(crate) fn grown(&self, base: &Arc<Fitted>, found: Arc<Fitted>) -> Arc<Fitted> {
        if self.is_at_noise(&found) {
            return found;
        }
        let mut held = vec![base.clone(), found.clone()];
        self.grow(vec![found], &mut held);
        self.simplest(base, &held)
    }

    /// Adds laws to these sets as long as they hold.
    fn grow(&self, mut frontier: Vec<Arc<Fitted>>, held: &mut Vec<Arc<Fitted>>) {
        frontier.retain(|f| f.set.len() < MOST_LAWS);
        while !frontier.is_empty() {
            // One parent after the other: a set that two of them lead to is fitted from the better
            // one.
            let held_children = |parent: &Arc<Fitted>| -> Vec<Arc<Fitted>> {
                let all = self.children(parent, true);
                all.into_iter().filter(|child| self.holds(parent, child)).collect()
            };
            let mut next: Vec<Arc<Fitted>> = frontier.iter().flat_map(held_children).collect();
            order::sort_by_key(&mut next, |f| f.error);
            // What freedom of its exponent absorbs is no further name: the best set of each
            // argument is tried with it.
            let argument = |f: &Fitted| f.set.last().map(|law| self.kind.argument(*law));
            let first = |i: &usize| next[..*i].iter().all(|f| argument(f) != argument(&next[*i]));
            let bent: Vec<usize> = (0..next.len()).filter(first).filter(|i| !self.is_at_noise(&next[*i])).collect();
            let bent: Vec<Arc<Fitted>> = bent.into_iter().map(|i| self.with_exponents(next[i].clone())).collect();
            next.extend(bent);
            order::sort_by_key(&mut next, |f| f.error);
            next.dedup_by(|a, b| sorted(&a.set) == sorted(&b.set));
            next.truncate(BEAM);
            next = next.into_iter().map(|f| self.without_idle(f)).collect();
            next.retain(|f| is_new(held, f));
            held.extend(next.iter().cloned());
            next.retain(|f| f.set.len() < MOST_LAWS);
            frontier = next;
        }
    }

    /// A set with another law in the place of one of its own: one that was added first may stand for two that
    /// were added later, and take the place of one of them.
    pub(crate) fn exchanged(&self, set: &Arc<Fitted>) -> Vec<Arc<Fitted>> {
        let children = |without: Arc<Fitted>| -> Vec<Arc<Fitted>> {
            let all = self.children(&without, false);
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
    fn with_exponents(&self, mut best: Arc<Fitted>) -> Arc<Fitted> {
        for law in best.set.clone() {
            let place = best.set.iter().position(|l| *l == law);
            let Some(without) = place.and_then(|place| self.without(&best, place)) else { continue };
            let fits = self.instead(&without, law, Form::Exponent).into_iter();
            let bent = fits.min_by(|a, b| a.error.total_cmp(&b.error));
            best = bent.filter(|bent| self.holds(&best, bent)).unwrap_or(best);
        }
        best
    }

    /// Sets with a law of this form, and of the same argument, in the place of a law.
    pub(crate) fn instead(&self, without: &Fitted, law: usize, form: Form) -> Vec<Arc<Fitted>> {
        let kind = self.kind;
        let takes_place = |other: &usize| {
            kind.form(*other) == form
                && (kind.argument(*other) == kind.argument(law) || kind.excludes(*other, law))
                && !without.set.iter().any(|l| kind.excludes(*l, *other))
        };
        (0..kind.laws()).filter(takes_place).filter_map(|other| self.with(without, other)).collect()
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

    /// The set without the law at a place, and where no fit of that comes to rest, the best set of
    /// fewer of its laws that does.
    pub(crate) fn weighed_without(&self, from: &Fitted, place: usize) -> Option<Arc<Fitted>> {
        let law = from.set[place];
        let is_part = |f: &Arc<Fitted>| !f.set.contains(&law) && f.set.iter().all(|l| from.set.contains(l));
        let fewer = || self.all().into_iter().filter(is_part).min_by(|a, b| a.error.total_cmp(&b.error));
        self.without(from, place).or_else(fewer)
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
        let mut set = from.set.clone();
        set.remove(place);
        self.at(&set, &self.kind.without(&from.set, &from.point, place))
    }

    /// The set with one law more, wherever it fits best.
    pub(crate) fn with(&self, from: &Fitted, law: usize) -> Option<Arc<Fitted>> {
        self.fitted(from, &[law], &self.prospects(from, &self.products(from), law))
    }

    /// Products of a fitted set's columns.
    fn products(&self, of: &Fitted) -> Products {
        Products::of(self.kind.layout(), &of.model, &of.at_bound)
    }

    /// Sets of one law more that a linear step promises most of; with `paired`, of a pair that
    /// helps together as well.
    pub(crate) fn children(&self, parent: &Fitted, paired: bool) -> Vec<Arc<Fitted>> {
        let kind = self.kind;
        let joins = |law: &usize| {
            kind.form(*law) == Form::Stated && !parent.set.iter().any(|l| l == law || kind.excludes(*l, *law))
        };
        let laws: Vec<usize> = (0..kind.laws()).filter(joins).collect();
        let products = self.products(parent);
        let mut all: Vec<Vec<Prospect>> =
            parallel::map_chunks(&laws, 1, |_, law| self.prospects(parent, &products, law[0]));
        all.retain(|p| !p.is_empty());
        order::sort_by_key(&mut all, |p| -p[0].promise);
        let pairs =
            if paired && parent.set.len() + 2 <= MOST_LAWS { self.pairs(parent, &products, &all) } else { Vec::new() };
        let least = (PROMISE * parent.variance).max(FOLLOWED[0] * all.first().map_or(0.0, |p| p[0].promise));
        let singles: Vec<&Vec<Prospect>> = all.iter().filter(|p| p[0].promise > least).take(WIDTH).collect();
        let alone = parallel::map_chunks(&singles, 1, |_, one| self.fitted(parent, &[one[0][0].law], one[0]));
        let together = parallel::map_chunks(&pairs, 1, |_, pair| {
            let [first, second] = &pair[0];
            let between = self.fitted(parent, &[first.law], std::slice::from_ref(first))?;
            let both: Vec<Prospect> = self.prospects(&between, &self.products(&between), second.law);
            self.fitted(&between, &[second.law], &both)
        });
        alone.into_iter().chain(together).flatten().collect()
    }

    /// Pairs that promise more than their laws one by one, best first.
    fn pairs(&self, parent: &Fitted, products: &Products, all: &[Vec<Prospect>]) -> Vec<[Prospect; 2]> {
        let layout = self.kind.layout();
        let some = &all[..all.len().min(2 * WIDTH)];
        let mut pairs = Vec::new();
        for (i, first) in some.iter().enumerate() {
            for second in &some[i + 1..] {
                let (a, b) = (&first[0], &second[0]);
                if self.kind.excludes(a.law, b.law) {
                    continue;
                }
                let both = products.with(layout, &parent.model, &[&a.direction, &b.direction]);
                let promise = promise(&both);
                if promise > TOGETHER * (a.promise + b.promise) && promise > PROMISE * parent.variance {
                    pairs.push((promise, [a.clone(), b.clone()]));
                }
            }
        }
        order::sort_by_key(&mut pairs, |p| -p.0);
        pairs.truncate(PAIRS);
        pairs.into_iter().map(|p| p.1).collect()
    }

    /// Beginnings of a law next to a set, the most promising first. A fit begins where the linear
    /// step ends.
    fn prospects(&self, parent: &Fitted, products: &Products, law: usize) -> Vec<Prospect> {
        let (kind, layout) = (self.kind, self.kind.layout());
        let mut set = parent.set.clone();
        set.push(law);
        let points = kind.joined(&parent.set, &parent.point, law);
        let residuals = kind.residuals(&set, &points);
        let prospect = |(point, residual): (Point, Option<Vec<f64>>)| {
            let pairs = parent.model.residual.iter().zip(residual?).zip(&layout.counts);
            let direction: Vec<f64> = pairs.map(|((a, b), c)| if *c { a - b } else { 0.0 }).collect();
            let with = products.with(layout, &parent.model, &[&direction]);
            let promise = Some(promise(&with)).filter(|p| p.is_finite())?;
            let step = with.steps(&[0.0])?.swap_remove(0);
            let size = *step.shared.iter().next_back()?;
            // Where a law takes over part of what others stand for, they make room for it: unless that is
            // worse, as where a linear step is none.
            let beginnings: Vec<Point> =
                [shifted(&point, &step), point].iter().filter_map(|p| kind.strengthened(&set, p, size)).collect();
            (!beginnings.is_empty()).then_some(Prospect { law, beginnings, direction, promise })
        };
        let mut all: Vec<Prospect> = points.into_iter().zip(residuals).filter_map(prospect).collect();
        order::sort_by_key(&mut all, |p| -p.promise);
        all
    }

    /// Points by what they leave, the least first.
    fn by_what_they_leave(&self, set: &[usize], points: &[Point]) -> Vec<Point> {
        let counts = &self.kind.layout().counts;
        let left =
            |residual: Vec<f64>| -> f64 { residual.iter().zip(counts).filter(|(_, c)| **c).map(|(e, _)| e * e).sum() };
        let all = self.kind.residuals(set, points).into_iter().zip(points);
        let mut known: Vec<(f64, &Point)> = all.filter_map(|(r, point)| Some((left(r?), point))).collect();
        known.retain(|(left, _)| left.is_finite());
        order::sort_by_key(&mut known, |k| k.0);
        known.into_iter().map(|(_, point)| point.clone()).collect()
    }

    fn fitted(&self, parent: &Fitted, laws: &[usize], prospects: &[Prospect]) -> Option<Arc<Fitted>> {
        let mut set = parent.set.clone();
        set.extend(laws);
        let promised = squares(&parent.model.residual) - prospects.first().map_or(0.0, |p| MISSED * p.promise);
        self.remembered(&set, promised, || {
            let follows = |p: &&Prospect| p.promise >= FOLLOWED[1] * prospects[0].promise;
            let fits = prospects.iter().take(BEGINNINGS).filter(follows).filter_map(|p| {
                let from = self.by_what_they_leave(&set, &p.beginnings);
                from.iter().find_map(|point| fit(self.kind, &set, point, MOST_STEPS))
            });
            fits.min_by(|a, b| a.error.total_cmp(&b.error))
        })
    }

    /// The fit of a set so far, where it leaves no more than is promised here; else the better one of it and of
    /// a fit from here.
    fn remembered(&self, set: &[usize], promised: f64, fit: impl FnOnce() -> Option<Fitted>) -> Option<Arc<Fitted>> {
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

/// A point to which a law was added, with the step of all that was there before: the law takes over part of
/// what they stand for.
fn shifted(point: &Point, step: &Step) -> Point {
    let mut point = point.clone();
    let before = step.shared.len() - 1;
    point.shared.iter_mut().zip(step.shared.iter().take(before)).for_each(|(v, s)| *v += s);
    for (start, step) in point.starts.iter_mut().zip(&step.starts) {
        start.iter_mut().zip(step).for_each(|(v, s)| *v += s);
    }
    point
}

/// Fall of the sum of squares that a linear step promises.
fn promise(products: &Products) -> f64 {
    products.sums().map_or(0.0, |[sum, promised]| sum - promised)
}

fn squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

/// A set in the order of the space.
pub(crate) fn sorted(set: &[usize]) -> Set {
    let mut set = set.to_vec();
    set.sort_unstable();
    set
}
