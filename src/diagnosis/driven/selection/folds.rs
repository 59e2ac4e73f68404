//! Other ways to part the samples that are fitted from those that judge: for what is rare, and
//! happens to lie on one side only.

use crate::driven::intake::data::Data;
use crate::driven::intake::stretches::{Stretches, merged};
use crate::numerics::order;

use super::held_out::LEAD;

/// A way to part the samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fold {
    /// Samples that are fitted.
    pub train: Stretches,
    pub validation: Stretches,
}

/// Two other ways: halves of what is fitted judge in turn. The first samples are fitted in both,
/// for they show where the mass began: from later ones alone, by when that has faded, any beginning
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
