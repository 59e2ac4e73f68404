//! The loop that a force runs through while the mass swings as one sine.

use std::f64::consts::TAU;

use super::acting::{Acting, At, LARGEST, Own};
use super::picture::{Axis, Curve, Picture, over_largest};

/// Steps in one period.
const STEPS: usize = 400;
/// Periods before the one that is shown: memory of the beginning has faded.
const BEFORE: usize = 5;

/// The mass at the resonance, `turns` periods after its largest displacement.
fn swinging(turns: f64) -> At {
    let (sin, cos) = (TAU * turns).sin_cos();
    At { x: LARGEST * cos, v: -LARGEST * sin, ..At::default() }
}

/// The law's states one step later, by the classic Runge–Kutta method.
fn next(acting: &Acting, own: &Own, turns: f64) -> Own {
    let (part, step_s) = (1.0 / STEPS as f64, TAU / STEPS as f64);
    let rates = |after: f64, own: &Own| acting.force(&swinging(turns + after * part), own).1;
    let add = |by: f64, rates: &Own| -> Own { std::array::from_fn(|i| own[i] + by * step_s * rates[i]) };
    let k1 = rates(0.0, own);
    let k2 = rates(0.5, &add(0.5, &k1));
    let k3 = rates(0.5, &add(0.5, &k2));
    let k4 = rates(1.0, &add(1.0, &k3));
    std::array::from_fn(|i| own[i] + step_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// Force over displacement, once round.
pub(super) fn of(acting: &Acting) -> Option<Picture> {
    let (mut own, mut points) = (Own::default(), Vec::with_capacity(STEPS + 1));
    for n in 0..=(BEFORE + 1) * STEPS {
        let turns = n as f64 / STEPS as f64;
        let at = swinging(turns);
        if n >= BEFORE * STEPS {
            points.push((at.x / LARGEST, -acting.force(&at, &own).0));
        }
        own = next(acting, &own, turns);
    }
    let points = over_largest(points);
    let (x, y) = (Axis::linear("displacement / largest"), Axis::linear("extra force back / largest"));
    let is_whole = points.iter().all(|p| p.1.is_finite()) && points.iter().any(|p| p.1 != 0.0);
    is_whole.then(|| Picture { x, y, curves: vec![Curve { name: "", is_guide: false, points }] })
}
