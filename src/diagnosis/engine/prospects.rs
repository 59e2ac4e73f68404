//! Laws that a linear step promises something of next to a set, and the fits that follow from there.

use std::sync::Arc;

use crate::numerics::order;
use crate::parallel;

use super::fit::{Fitted, MOST_STEPS, fit, squares};
use super::kind::{Form, Kind, Point};
use super::levels::NAME;
use super::linear::{Products, Step};
use super::prospect::Prospect;
use super::search::{MOST_LAWS, Search};

/// Laws that are fitted next to each set.
const WIDTH: usize = 5;
/// Pairs of laws that are fitted next to each set.
const PAIRS: usize = 2;
/// A pair helps together that promises this many times what its laws promise one by one.
const TOGETHER: f64 = 1.5;
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

impl<K: Kind> Search<'_, K> {
    /// The set with one law more, wherever it fits best.
    pub(crate) fn with(&self, from: &Fitted, law: usize) -> Option<Arc<Fitted>> {
        self.fitted(from, &[law], &self.prospects(from, &self.products(from), law))
    }

    /// Products of a fitted set's columns.
    fn products(&self, of: &Fitted) -> Products {
        Products::of(self.kind.layout(), &of.model, &of.at_bound)
    }

    /// Sets of one law of this form more that a linear step promises most of; with `paired`, of a pair that
    /// helps together as well.
    pub(crate) fn children(&self, parent: &Fitted, form: Form, paired: bool) -> Vec<Arc<Fitted>> {
        let kind = self.kind;
        let joins =
            |law: &usize| kind.form(*law) == form && !parent.set.iter().any(|l| l == law || kind.excludes(*l, *law));
        let laws: Vec<usize> = (0..kind.laws()).filter(joins).collect();
        let products = self.products(parent);
        let mut all: Vec<Arc<Vec<Prospect>>> =
            parallel::map_chunks(&laws, 1, |_, law| self.prospects(parent, &products, law[0]));
        all.retain(|p| !p.is_empty());
        order::sort_by_key(&mut all, |p| -p[0].promise);
        let pairs =
            if paired && parent.set.len() + 2 <= MOST_LAWS { self.pairs(parent, &products, &all) } else { Vec::new() };
        let least = (PROMISE * parent.variance).max(FOLLOWED[0] * all.first().map_or(0.0, |p| p[0].promise));
        let singles: Vec<&Arc<Vec<Prospect>>> = all.iter().filter(|p| p[0].promise > least).take(WIDTH).collect();
        let alone = parallel::map_chunks(&singles, 1, |_, one| self.fitted(parent, &[one[0][0].law], one[0]));
        let together = parallel::map_chunks(&pairs, 1, |_, pair| {
            let [first, second] = &pair[0];
            let between = self.fitted(parent, &[first.law], std::slice::from_ref(first))?;
            let both = self.prospects(&between, &self.products(&between), second.law);
            self.fitted(&between, &[second.law], &both)
        });
        alone.into_iter().chain(together).flatten().collect()
    }

    /// Pairs that promise more than their laws one by one, best first.
    fn pairs(&self, parent: &Fitted, products: &Products, all: &[Arc<Vec<Prospect>>]) -> Vec<[Prospect; 2]> {
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
    fn prospects(&self, parent: &Fitted, products: &Products, law: usize) -> Arc<Vec<Prospect>> {
        self.begun.of((parent.set.clone(), parent.error.to_bits(), law), || self.begun(parent, products, law))
    }

    fn begun(&self, parent: &Fitted, products: &Products, law: usize) -> Vec<Prospect> {
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
