//! `sinusoid`: a line in the spectrum.

use std::f64::consts::TAU;

use super::row::{IEEE, Placed, Row, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::{Channel, Curve, Fitted};
use crate::rest::estimate::straight;
use crate::rest::search;
use crate::verdict::Estimate;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "sinusoid",
    kind: Kind::Static,
    statement: "A sine is picked up: vibration, mains or a switching supply.",
    equation: "b(t) = A sin(2πft + φ)",
    parameters: &[size("amplitude", "y"), size("frequency", "Hz")],
    acts: "readout",
    signature: "A single line in the spectrum; ripples in the Allan curve.",
    confusable_with: &[],
    reference: IEEE,
};

/// Grid points at which a frequency is searched for, and how far to either side of the strongest
/// line, as a part of 1/N.
const FREQUENCIES: usize = 7;
const REACH: f64 = 0.6;

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    offer: |to| {
        let Some(frequency) = strongest_line(to.channel, to.current) else { return Ok(Vec::new()) };
        let count = to.samples();
        let wave = |f: f64| {
            let part = |shift: f64| Curve::new((0..count).map(|n| (TAU * f * n as f64 + shift).sin()).collect());
            vec![part(0.0), part(TAU / 4.0)]
        };
        let half = REACH / count as f64;
        let within = [frequency - half, frequency + half];
        Ok(vec![search::best(within, FREQUENCIES, to.control, |f| to.with_curves(Cause::Sinusoid, wave(f), f))?])
    },
    numbers: 3.0,
    chance: |gain, samples| 2.0 * samples * chi_squared_survival(gain, 2.0),
    imitates: &[],
    is_drift: false,
    parameters,
};

fn parameters(of: &Placed<'_>) -> Vec<Estimate> {
    let parts = of.fitted.amplitudes_of(of.index);
    let amplitude = parts[0].0.hypot(parts[1].0);
    let error = parts[0].1.max(parts[1].1);
    // Cramér–Rao bound of a frequency: var(ω) = 24 s/(A² N³), and 2 s/N is the variance of an
    // amplitude.
    let count = of.channel.values.len() as f64;
    let spread = (12.0f64).sqrt() * error / (amplitude * count) / TAU;
    vec![
        straight("amplitude", of.channel.unit.clone(), of.channel.scale, (amplitude, error)),
        straight("frequency", "Hz".into(), of.channel.rate_hz, (of.term().searched, spread)),
    ]
}

/// Frequency (cycles per sample) where two neighbouring coefficients stand out most from the model
/// and from their neighbourhood; slower than three cycles is drift.
fn strongest_line(channel: &Channel, current: &Fitted) -> Option<f64> {
    let c = &current.residual;
    let count = c.len();
    let mut best = (0.0, 0);
    for (bin, variance) in current.bins.iter().zip(&current.variances) {
        for k in bin.from.max(6)..bin.to.min(count - 1) {
            let score = (c[k] * c[k] + c[k + 1] * c[k + 1]) / variance;
            if score > best.0 {
                best = (score, k);
            }
        }
    }
    let (score, k) = best;
    if k == 0 {
        return None;
    }
    let near = |i: usize| c[i] * c[i];
    let (from, to) = (k.saturating_sub(40).max(1), (k + 42).min(count));
    let around: f64 = (from..to).filter(|i| i.abs_diff(k) > 3).map(near).sum::<f64>() / (to - from).max(8) as f64;
    let local = (c[k] * c[k] + c[k + 1] * c[k + 1]) / around.max(f64::MIN_POSITIVE);
    let chance = 2.0 * channel.values.len() as f64 * chi_squared_survival(local.min(score), 2.0);
    let fraction = near(k + 1).sqrt() / (near(k).sqrt() + near(k + 1).sqrt());
    (chance < 0.01).then_some((k as f64 + fraction) / (2 * count) as f64)
}
