//! Free simulation of a body without a spring in windows: whatever is wrong with its force is
//! integrated twice, so that it begins anew every second from the state that was measured.

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::intake::several::Piece;

use super::motion::{MotionAndForce, Part};
use super::regression::Regression;

/// Length of a window.
const WINDOW_S: f64 = 1.0;
/// Integration steps per sample.
const STEPS: usize = 4;

/// Reading less simulation, sample by sample of the data.
pub fn errors(data: &Data, pieces: &[Piece], motion: &MotionAndForce, model: &Regression) -> Vec<f64> {
    let window = ((WINDOW_S * data.rate_hz) as usize).max(2);
    let mut out = vec![0.0; data.reading.len()];
    for range in pieces.iter().map(|p| &p.range) {
        for start in range.clone().step_by(window) {
            one(data, motion, model, start..(start + window).min(range.end), &mut out);
        }
    }
    out
}

fn one(data: &Data, motion: &MotionAndForce, model: &Regression, window: Range<usize>, out: &mut [f64]) {
    let Some(input) = data.input.as_ref().map(|i| i.samples()) else { return };
    let mass = model.coefficients[0];
    let friction = (model.of(Part::Direction) / mass).max(0.0);
    let smooth: Vec<(Part, f64)> = model.parts.iter().copied().zip(model.coefficients.iter().copied()).collect();
    // What accelerates besides dry friction.
    let pull = |v: f64, u: f64| {
        let others = smooth.iter().filter(|(p, _)| !matches!(p, Part::Acceleration | Part::Direction));
        (u - others.map(|(p, w)| w * p.at(v, 0.0, u)).sum::<f64>()) / mass
    };
    let h = 1.0 / (data.rate_hz * STEPS as f64);
    let (mut x, mut v) = (motion.x[window.start], motion.v[window.start]);
    for k in window.clone() {
        out[k] = data.reading[k] - x;
        let next = input[(k + 1).min(window.end - 1)];
        for step in 0..STEPS {
            let at = |part: f64| input[k] + (next - input[k]) * (step as f64 + part) / STEPS as f64;
            let push = pull(v, at(0.0));
            if v == 0.0 && push.abs() <= friction {
                continue;
            }
            // Heun's method with the direction held over the step; a body that turns within it is
            // at rest at its end.
            let side = if v == 0.0 { push.signum() } else { v.signum() };
            let first = push - side * friction;
            let second = pull(v + h * first, at(1.0)) - side * friction;
            let turned = v + 0.5 * h * (first + second);
            let end = if turned * side < 0.0 && friction > 0.0 { 0.0 } else { turned };
            x += 0.5 * h * (v + end);
            v = end;
        }
    }
}
