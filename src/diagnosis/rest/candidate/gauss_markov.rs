//! `gauss-markov`: a bias with a memory of finite length.

use super::band_limit::{LONGEST, is_one_pole};
use super::row::{IEEE, Row, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::{Addition, Fitted};
use crate::rest::estimate::{beside_searched, root, searched, with_searched};
use crate::rest::search;
use crate::rest::spectrum::Law;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "gauss-markov",
    kind: Kind::Static,
    statement: "The bias fluctuates with a memory of finite length.",
    equation: "db = −b/T dt + σ√(2/T) dW",
    parameters: &[size("sigma", "y"), size("T", "s")],
    acts: "readout",
    signature: "The Allan deviation has a hump at 1.89 T.",
    confusable_with: &["flicker-noise", "random-walk"],
    reference: IEEE,
};

/// Grid points at which a memory is searched for.
pub(in crate::rest) const MEMORIES: usize = 14;

/// Logarithms of the memories, in samples, between which one is searched for; `None` where there
/// are none. Next to a filter, a shorter memory belongs to its shape.
pub(in crate::rest) fn memories(samples: usize, filtered: bool) -> Option<[f64; 2]> {
    let range = [if filtered { LONGEST } else { 1.5 }.ln(), (samples as f64 / 4.0).ln()];
    (range[0] < range[1]).then_some(range)
}

/// Returns whether the memory found is a filter's.
pub(in crate::rest) fn is_filter(fitted: &Fitted) -> bool {
    let memory = fitted.terms.iter().find(|t| t.cause == Cause::GaussMarkov).map(|t| t.searched);
    memory.is_some_and(|memory| match fitted.has(Cause::BandLimit) {
        true => memory < 1.01 * LONGEST,
        false => is_one_pole(fitted, memory),
    })
}

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| {
        if !to.is_open_to(Cause::GaussMarkov) {
            return Ok(Vec::new());
        }
        let with = |memory: f64| to.with_law(Cause::GaussMarkov, Law::Markov(memory), memory);
        let Some(range) = memories(to.samples(), to.current.has(Cause::BandLimit)) else { return Ok(Vec::new()) };
        let best = search::best(range, MEMORIES, to.control, |m| with(m.exp()))?;
        Ok(if is_filter(&best) { Vec::new() } else { vec![best] })
    },
    numbers: 2.0,
    chance: |gain, _| 4.0 * chi_squared_survival(gain, 2.0),
    imitates: &[Cause::RandomWalk],
    is_drift: true,
    parameters: |of| {
        let memory = |samples: f64| Addition::Law(Law::Markov(samples));
        let time = searched("T", of.channel, of.fitted, of.index, &memory);
        let own = root("sigma", of.channel.unit.clone(), of.channel.scale, of.fitted.strength_of(of.index));
        // What is known well is σ²/T, the power at high frequencies.
        let at = |time_s: f64| {
            let other = with_searched(of.channel, of.fitted, of.index, time_s * of.channel.rate_hz, &memory);
            other.strength_of(of.index).0.sqrt() * of.channel.scale
        };
        vec![beside_searched(own, &time, at), time]
    },
};
