//! Compares a law whose exponent is fitted with the first terms of a series: the stated law plus one more. Both
//! have as many coordinates, and over a limited range of amplitudes either can imitate the other.

use std::sync::Arc;

use super::fit::Fitted;
use super::kind::{Form, Kind};
use super::search::Search;

impl<K: Kind> Search<'_, K> {
    /// Sets in which the law with a fitted exponent is replaced by the stated law and a further one, with no more
    /// coordinates. Empty if the exponent of the law is not fitted, or may be a whole number.
    fn expanded(&self, best: &Fitted, without: &Fitted, place: usize) -> Vec<Arc<Fitted>> {
        let law = best.set[place];
        let is_whole = || self.kind.may_be_whole(&best.set, place, &best.point, &best.deviations);
        if self.kind.form(law) != Form::Exponent || is_whole() {
            return Vec::new();
        }
        let stated = self.instead(without, law, Form::Stated);
        let all = stated.iter().flat_map(|one| self.children(one, Form::Beside, false));
        all.filter(|f| f.point.shared.len() <= best.point.shared.len()).collect()
    }

    /// Laws of such sets that fit as well as the best one, each with its set.
    pub(super) fn expansions(&self, best: &Fitted, without: &Fitted, place: usize) -> Vec<(usize, Arc<Fitted>)> {
        let as_good = self.expanded(best, without, place).into_iter().filter(|f| self.as_good(f, best));
        let own = |f: Arc<Fitted>| {
            let new: Vec<usize> = f.set.iter().copied().filter(|l| !without.set.contains(l)).collect();
            new.into_iter().map(move |l| (l, f.clone()))
        };
        as_good.flat_map(own).collect()
    }

    /// The set itself, unless replacing a fitted exponent in this way fits better: then the best such set.
    pub(super) fn or_expanded(&self, best: Arc<Fitted>) -> Arc<Fitted> {
        let of_place = |place: usize| {
            let without = self.without(&best, place)?;
            let all = self.expanded(&best, &without, place).into_iter();
            all.filter(|f| f.error < best.error && !self.as_good(&best, f)).min_by(|a, b| a.error.total_cmp(&b.error))
        };
        let better = (0..best.set.len()).filter_map(of_place).min_by(|a, b| a.error.total_cmp(&b.error));
        better.unwrap_or(best)
    }
}
