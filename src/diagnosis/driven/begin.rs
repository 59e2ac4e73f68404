//! The base model of a recording: fitted with each way that its input may go between samples, and what that already shows.

use crate::diagnosis::model;

use super::fit::{Data, Fit, OMEGA, fit};
use super::input::{Input, Interpolation};
use super::lag::Delay;
use super::start;
use super::term::{Scales, Term};

/// Another interpolation must leave this much less variance than a band-limited one.
const CLEARLY: f64 = 0.9;

/// The base fit; sets the input's interpolation and says what was noticed.
pub fn base(data: &mut Data, hints: &model::Start, findings: &mut Vec<String>) -> Option<(Fit, Scales)> {
    let mut best = start::base(data, hints)?;
    if data.input.is_some() {
        let smooth = delayed(data, &best).unwrap_or(best.0.variance);
        for how in [Interpolation::Hold, Interpolation::Linear] {
            let kept = data.input.take()?;
            data.input = Some(Input::new(kept.samples().to_vec(), how));
            let other = fit(data, &best.0.shape, &best.0.point, &best.1, 25);
            match other {
                Some(other) if other.variance < CLEARLY * best.0.variance && other.variance < 0.97 * smooth => {
                    findings.push(format!("the input fits best when it goes by {} between samples", how.words()));
                    best.0 = other;
                    break;
                }
                _ => data.input = Some(kept),
            }
        }
    }
    let turn = best.0.point[OMEGA] * data.interval_s();
    if turn > std::f64::consts::PI {
        findings.push(format!(
            "the resonance fitted, {:.4} Hz, lies above half the sampling rate: what happens there cannot be seen in this recording",
            best.0.point[OMEGA] / std::f64::consts::TAU
        ));
    }
    Some(best)
}

/// Variance with a delay added: a held input looks like one of half a sample.
fn delayed(data: &Data, base: &(Fit, Scales)) -> Option<f64> {
    let (shape, point) = base.0.with(Term::Delay(Delay), &[0.0]);
    fit(data, &shape, &point, &base.1, 10).map(|f| f.variance)
}
