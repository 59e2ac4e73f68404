//! `random-walk`: rate or acceleration random walk, 1/f².

use super::row::{IEEE, Row, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::estimate::root;
use crate::rest::spectrum::Law;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "random-walk",
    kind: Kind::Static,
    statement: "The bias wanders as a random walk.",
    equation: "db = K dW",
    parameters: &[size("K", "y/√s"), size("exponent", "1")],
    acts: "readout",
    signature: "The Allan deviation rises as √τ; the density as 1/f².",
    confusable_with: &["flicker-noise", "temperature-sensitivity", "rate-ramp"],
    reference: IEEE,
};

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| to.law(Cause::RandomWalk, Law::Walk),
    numbers: 1.0,
    chance: |gain, _| 0.5 * chi_squared_survival(gain, 1.0),
    imitates: &[],
    is_drift: true,
    parameters: |of| {
        let factor = of.channel.scale * of.channel.rate_hz.sqrt();
        vec![root("K", format!("{}/√s", of.channel.unit), factor, of.fitted.strength_of(of.index))]
    },
};
