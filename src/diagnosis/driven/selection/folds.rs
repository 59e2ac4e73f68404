//! Other ways to part the samples that are fitted from those that judge: for what is rare, and
//! happens to lie on one side only.

use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::intake::stretches::{Stretches, merged};
use crate::driven::simulation::run::trace;
use crate::numerics::order;

use super::held_out::LEAD;

/// How many times louder than the fitted samples the judging ones must be before they change sides.
const LOUDER: f64 = 1.5;

/// A way to part the samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fold {
    /// Samples that are fitted.
    pub train: Stretches,
    pub validation: Stretches,
}

/// Two other ways: halves of what is fitted judge in turn. The first samples are fitted in both,
/// for they say where the mass began: from later ones alone, by when that has faded, any beginning
/// may follow.
pub(crate) fn turned(data: &Data) -> [Fold; 2] {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    let mut beginning = Vec::new();
    let begins = |k: usize| k == data.hull.start || data.breaks.contains(&k);
    for r in &data.train {
        let middle = usize::midpoint(r.start, r.end);
        let start = if begins(r.start) { (r.start + LEAD).min(middle) } else { r.start };
        beginning.push(r.start..start);
        first.push(start..middle);
        second.push(middle..r.end);
    }
    let with_validation = |half: &Stretches| {
        let mut all: Stretches = half.iter().chain(&data.validation).chain(&beginning).cloned().collect();
        all.retain(|r| !r.is_empty());
        order::sort_by_key(&mut all, |r| r.start as f64);
        merged(all)
    };
    let trains = [with_validation(&second), with_validation(&first)];
    let [one, other] = trains;
    [Fold { train: one, validation: first }, Fold { train: other, validation: second }]
}

/// Another fold, where the errors of a fit stand out in the samples that judge: what they show
/// could not be fitted otherwise. The quieter half of the fitted samples judges then.
pub(crate) fn fold_with_rare_events(data: &Data, fit: &Fit) -> Option<Fold> {
    let (errors, _) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let power = |ranges: &Stretches| {
        let squares = ranges.iter().flat_map(|r| r.clone()).map(|k| errors[k - data.hull.start].powi(2));
        squares.sum::<f64>() / ranges.iter().map(ExactSizeIterator::len).sum::<usize>().max(1) as f64
    };
    if power(&data.validation) < LOUDER * power(&data.train) {
        return None;
    }
    turned(data).into_iter().min_by(|a, b| power(&a.validation).total_cmp(&power(&b.validation)))
}
