//! `rate-ramp`: a bias that drifts along a straight line.

use super::row::{IEEE, Row, signed};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::Curve;
use crate::rest::estimate::straight;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "rate-ramp",
    kind: Kind::Static,
    statement: "The bias drifts along a straight line.",
    equation: "b(t) = R t",
    parameters: &[signed("rate", "y/s")],
    acts: "readout",
    signature: "The Allan deviation rises as τ.",
    confusable_with: &["warm-up", "random-walk"],
    reference: IEEE,
};

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| {
        if to.current.has(Cause::RateRamp) {
            return Ok(Vec::new());
        }
        let count = to.samples();
        let ramp = Curve::new((0..count).map(|n| n as f64 / count as f64).collect());
        Ok(vec![to.with_curves(Cause::RateRamp, vec![ramp], 0.0)])
    },
    numbers: 1.0,
    chance: |gain, _| chi_squared_survival(gain, 1.0),
    imitates: &[],
    is_drift: true,
    parameters: |of| {
        let duration_s = of.channel.values.len() as f64 * (1.0 / of.channel.rate_hz);
        let rise = of.fitted.amplitudes_of(of.index)[0];
        vec![straight("rate", format!("{}/s", of.channel.unit), of.channel.scale / duration_s, rise)]
    },
};
