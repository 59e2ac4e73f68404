//! The base model of a recording, and whether another way of the input between its samples would do what terms seem to.

use crate::diagnosis::model;

use super::fit::{Data, Fit, OMEGA, Shape, fit};
use super::input::{Input, Interpolation};
use super::select::Judged;
use super::start;
use super::term::{Scales, Term};

/// The base fit; says what was noticed.
pub fn base(data: &Data, hints: &model::Start, findings: &mut Vec<String>) -> Option<(Fit, Scales)> {
    let best = start::base(data, hints)?;
    let turn = best.0.point[OMEGA] * data.interval_s();
    if turn > std::f64::consts::PI {
        findings.push(format!(
            "the resonance fitted, {:.4} Hz, lies above half the sampling rate: what happens there cannot be seen in this recording",
            best.0.point[OMEGA] / std::f64::consts::TAU
        ));
    }
    Some(best)
}

/// Whether steps or straight lines between the samples of the input do as well as the linear terms of `chosen` that they
/// could be mistaken for: a held input looks late by half a sample, straight lines look like a weak low-pass.
pub fn other_input(data: &mut Data, chosen: &Judged, scales: &Scales) -> Option<Interpolation> {
    let mistaken =
        |t: &Term| matches!(t, Term::Delay(_) | Term::Lowpass(_) | Term::Feedthrough(_) | Term::ParasiticMode(_));
    if !chosen.fit.shape.terms.iter().any(mistaken) {
        return None;
    }
    let (mut terms, mut point) = (Vec::new(), chosen.fit.point[..super::fit::BASE].to_vec());
    for (i, term) in chosen.fit.shape.terms.iter().enumerate().filter(|(_, t)| !mistaken(t)) {
        terms.push(*term);
        point.extend_from_slice(chosen.fit.shape.of(i, &chosen.fit.point));
    }
    let shape = Shape::new(&terms);
    for how in [Interpolation::Hold, Interpolation::Linear] {
        let kept = data.input.take()?;
        data.input = Some(Input::new(kept.samples().to_vec(), how));
        let other = fit(data, &shape, &point, scales, 25);
        if other.is_some_and(|o| o.variance < 1.01 * chosen.fit.variance) {
            return Some(how);
        }
        data.input = Some(kept);
    }
    None
}
