//! The whole mounting: the rotation that the search began with, and by how much the fit turned it further.

use nalgebra::{UnitQuaternion, Vector3};

use super::candidate::MOUNTING;
use super::course::vector;
use super::effects::effect;
use super::fitted::Fitted;
use super::parameters::{self, Point};
use super::start::Start;
use crate::units::DEGREE;
use crate::verdict::{Effect, Estimate, Evidence};

/// Accuracy to which a mounting that was not fitted is known, °: below, it would cost nothing.
const SMALL_DEG: f64 = 0.1;

/// Its rotation vector, °.
pub(super) fn angles(fit: &Fitted, turned: UnitQuaternion<f64>, names: [&str; 3]) -> [Estimate; 3] {
    let further = |point: &Point| UnitQuaternion::from_scaled_axis(vector(point, parameters::MOUNTING.start));
    let at_best = (turned * further(&fit.point)).scaled_axis();
    // Near half a turn one rotation is two vectors, either way round: the one next to the best.
    let near = |turn: UnitQuaternion<f64>| -> Vector3<f64> {
        let vector = turn.scaled_axis();
        let other = vector - vector.normalize() * std::f64::consts::TAU;
        if vector.dot(&at_best) < 0.0 && (other - at_best).norm() < (vector - at_best).norm() { other } else { vector }
    };
    std::array::from_fn(|axis| {
        let (value, ci95) = if fit.has(parameters::MOUNTING.start) {
            fit.number(&|point| near(turned * further(point))[axis] / DEGREE)
        } else {
            let value = at_best[axis] / DEGREE;
            (value, [value - SMALL_DEG, value + SMALL_DEG])
        };
        Estimate { name: names[axis].into(), value, unit: "deg".into(), ci95 }
    })
}

/// Names a mounting that the search began with, with the whole rotation in place of the part that was
/// fitted; none where the fit turned it back to nothing.
pub(super) fn named(effects: &mut Vec<Effect>, fit: &Fitted, start: &Start, names: &[[String; 3]; 2]) {
    if start.turned.angle() == 0.0 {
        return;
    }
    effects.retain(|e| e.id != MOUNTING.id);
    let parameters = angles(fit, start.turned, ["x", "y", "z"]);
    if parameters.iter().any(|e| e.ci95[0] > 0.0 || e.ci95[1] < 0.0) {
        let evidence = Evidence { held_out_gain: start.explained.max(0.0), p_value: start.chance_turned };
        effects.insert(0, effect(&MOUNTING, parameters.into(), names.concat(), evidence));
    }
}
