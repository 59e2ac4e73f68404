//! `gauss-markov`: a bias with a memory of finite length.

use super::band_limit::{LONGEST, is_one_pole};
use super::row::{IEEE, Row, size};
use crate::diagnosis::candidate::{Candidate, Kind};
use crate::diagnosis::rest::cause::Cause;
use crate::diagnosis::rest::channel::Addition;
use crate::diagnosis::rest::estimate::{root, searched};
use crate::diagnosis::rest::search;
use crate::diagnosis::rest::spectrum::Law;
use crate::numerics::special::chi_squared_survival;

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
pub(in crate::diagnosis::rest) const MEMORIES: usize = 14;

/// Logarithms of the memories, in samples, between which one is searched for.
pub(in crate::diagnosis::rest) fn memories(samples: usize) -> [f64; 2] {
    [1.5f64.ln(), (samples as f64 / 4.0).ln()]
}

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| {
        if !to.is_open_to(Cause::GaussMarkov) {
            return Ok(Vec::new());
        }
        let with = |memory: f64| to.with_law(Cause::GaussMarkov, Law::Markov(memory), memory);
        // Beside a filter, a shorter memory belongs to its shape.
        let filtered = to.current.has(Cause::BandLimit);
        let [shortest, longest] = memories(to.samples());
        let shortest = if filtered { LONGEST.ln() } else { shortest };
        if shortest >= longest {
            return Ok(Vec::new());
        }
        let best = search::best([shortest, longest], MEMORIES, to.control, |m| with(m.exp()))?;
        let memory = best.terms.last().map_or(0.0, |t| t.searched);
        let filters = if filtered { memory < 1.01 * LONGEST } else { is_one_pole(&best, memory) };
        Ok(if filters { Vec::new() } else { vec![best] })
    },
    numbers: 2.0,
    chance: |gain, _| 4.0 * chi_squared_survival(gain, 2.0),
    imitates: &[Cause::RandomWalk],
    is_drift: true,
    parameters: |of| {
        let memory = |samples: f64| Addition::Law(Law::Markov(samples));
        vec![
            root("sigma", of.unit.into(), of.channel.scale, of.fitted.strength_of(of.index)),
            searched("T", of.channel, of.fitted, of.index, &memory),
        ]
    },
};
