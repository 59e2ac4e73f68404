//! `warm-up`: a bias that settles exponentially.

use super::row::{Row, TITTERTON, signed, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::{Addition, Curve};
use crate::rest::estimate::{beside_searched, searched, straight, with_searched};
use crate::rest::search;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "warm-up",
    kind: Kind::Static,
    statement: "The bias settles exponentially after switching on.",
    equation: "b(t) = A e^(−t/T)",
    parameters: &[signed("amplitude", "y"), size("T", "s")],
    acts: "readout",
    signature: "A drift that is fast at first and dies out.",
    confusable_with: &["rate-ramp"],
    reference: TITTERTON,
};

/// Time constants, as parts of the recording, between which one is searched for; and at how many
/// grid points.
const PARTS: [f64; 2] = [0.01, 0.5];
const TIMES: usize = 9;

/// An exponential with this time constant, in samples.
fn settling(count: usize, samples: f64) -> Curve {
    Curve::new((0..count).map(|n| (-(n as f64) / samples).exp()).collect())
}

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| {
        if to.current.has(Cause::WarmUp) {
            return Ok(Vec::new());
        }
        let count = to.samples();
        let with = |time: f64| to.with_curves(Cause::WarmUp, vec![settling(count, time)], time);
        Ok(vec![search::best(PARTS.map(|p| (p * count as f64).ln()), TIMES, to.control, |m| with(m.exp()))?])
    },
    numbers: 2.0,
    chance: |gain, _| 5.0 * chi_squared_survival(gain, 1.0),
    imitates: &[Cause::RateRamp],
    is_drift: true,
    parameters: |of| {
        let count = of.channel.values.len();
        let curve = |samples: f64| Addition::Curves(vec![settling(count, samples)]);
        let time = searched("T", of.channel, of.fitted, of.index, &curve);
        let own =
            straight("amplitude", of.channel.unit.clone(), of.channel.scale, of.fitted.amplitudes_of(of.index)[0]);
        let at = |time_s: f64| {
            let other = with_searched(of.channel, of.fitted, of.index, time_s * of.channel.rate_hz, &curve);
            other.amplitudes_of(of.index)[0].0 * of.channel.scale
        };
        vec![beside_searched(own, &time, at), time]
    },
};
