//! `flicker-noise`: bias instability, 1/f.

use super::row::{IEEE, Row, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::estimate::root;
use crate::rest::spectrum::Law;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "flicker-noise",
    kind: Kind::Static,
    statement: "The bias flickers: its noise density rises as 1/f towards low frequencies.",
    equation: "S(f) = B²/(πf)",
    parameters: &[size("B", "y"), size("exponent", "1")],
    acts: "readout",
    signature: "The Allan deviation has a floor at 0.664 B.",
    confusable_with: &["gauss-markov", "random-walk"],
    reference: IEEE,
};

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| to.law(Cause::FlickerNoise, Law::Flicker),
    numbers: 1.0,
    chance: |gain, _| 0.5 * chi_squared_survival(gain, 1.0),
    imitates: &[],
    is_drift: true,
    parameters: |of| vec![root("B", of.channel.unit.clone(), of.channel.scale, of.fitted.strength_of(of.index))],
};
