//! States where a model errs: over frequency and over amplitude.

use crate::numerics::order;
use crate::numerics::special::{chi_squared_survival, discoveries};
use crate::verdict::Stretch;

/// Stretches of equal numbers of steps.
const STRETCHES: usize = 12;
/// Rate of false discoveries.
const RATE: f64 = 0.01;

/// Stretches of a key in which the error exceeds the noise; `squares` are squared errors of a step,
/// of two numbers, over the variance of one.
pub(super) fn stretches(keys: &[f64], squares: &[f64]) -> Vec<Stretch> {
    let ranked = order::ranked(keys);
    let parts = STRETCHES.min(ranked.len() / 4).max(1);
    let part = |i: usize| &ranked[ranked.len() * i / parts..ranked.len() * (i + 1) / parts];
    let sum = |i: usize| part(i).iter().map(|k| squares[*k]).sum::<f64>();
    let p: Vec<f64> = (0..parts).map(|i| chi_squared_survival(sum(i), 2.0 * part(i).len() as f64)).collect();
    let found = discoveries(&p, RATE);
    let stretch = |i: usize| {
        let own = part(i);
        let (from, to) = (keys[own[0]], keys[own[own.len() - 1]]);
        Stretch { from, to, excess: sum(i) / (2.0 * own.len() as f64) }
    };
    let mut all: Vec<Stretch> = (0..parts).filter(|i| found[*i] && !part(*i).is_empty()).map(stretch).collect();
    all.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    all
}
