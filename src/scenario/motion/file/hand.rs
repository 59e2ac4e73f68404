//! Judges whether quaternions mean what the file says, by what does not depend on it: seen from the
//! body, the force that carries it and the direction of its travel keep their places, or wander
//! about if the numbers are read in a wrong order or sense.
//!
//! Not a proof: it speaks up only where another reading makes the motion far more regular than the
//! one at hand.

use nalgebra::{UnitQuaternion, Vector3};

use super::format::Order;
use super::refusal::{Refusal, refusal};
use super::span::Span;
use crate::motion::pose::Pose;
use crate::units::STANDARD_GRAVITY_M_S2;

/// Another reading of the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reading {
    /// Taken as the file states them.
    AsSaid,
    /// The scalar stands at the other end.
    OtherEnd,
    /// The rotation goes the other way.
    Inverse,
    /// One axis of the reference points the other way for positions, not for attitudes; where both
    /// are mirrored alike, the motion is as regular as it was, and nothing can be told.
    Mirrored,
}

/// Accelerations are taken over this, s; above this speed a direction of travel is one, m/s.
const STRIDE_S: f64 = 0.1;
const MOVING_M_S: f64 = 0.3;
/// Poses that have to move before their direction counts.
const FEWEST: usize = 50;
/// Below the first, gravity's direction is steady; the second is the largest part of its wandering
/// that a better reading may leave, the third how much it may disturb the other direction.
const STEADY: f64 = 0.02;
const SHARE: f64 = 0.25;
const DISTURBED: f64 = 1.2;

impl Reading {
    /// A pose read so, from numbers in this order.
    fn of(self, pose: &Pose, order: Order) -> Pose {
        let q = pose.attitude;
        let (attitude, mut position_m) = (
            match self {
                Self::AsSaid | Self::Mirrored => q,
                Self::OtherEnd => UnitQuaternion::from_quaternion(order.at_other_end(&q)),
                Self::Inverse => q.inverse(),
            },
            pose.position_m,
        );
        if self == Self::Mirrored {
            position_m.y = -position_m.y;
        }
        Pose { attitude, position_m, ..*pose }
    }
}

/// Measures how much the direction of the force that carries the body, and that of its travel,
/// wander in its own axes: 0 for none, towards 1 for all about. Travel is none where it hardly
/// moves.
fn wandering(poses: &[Pose], stride: usize, up: Vector3<f64>) -> [Option<f64>; 2] {
    let (mut force, mut travel) = ((Vector3::zeros(), 0usize), (Vector3::zeros(), 0usize));
    let reach = poses.len().saturating_sub(2 * stride);
    for k in (0..reach).step_by(stride.max(reach / 20_000).max(1)) {
        let [before, here, after] = [&poses[k], &poses[k + stride], &poses[k + 2 * stride]];
        let half = 0.5 * (after.time_s - before.time_s);
        let velocity = (after.position_m - before.position_m) / (2.0 * half);
        let acceleration = (after.position_m - 2.0 * here.position_m + before.position_m) / (half * half);
        let add = |sum: &mut (Vector3<f64>, usize), direction: Vector3<f64>| {
            sum.0 += here.attitude.inverse_transform_vector(&direction.normalize());
            sum.1 += 1;
        };
        add(&mut force, acceleration + up * STANDARD_GRAVITY_M_S2);
        if velocity.norm() > MOVING_M_S {
            add(&mut travel, velocity);
        }
    }
    [force, travel].map(|(sum, count)| (count >= FEWEST).then(|| 1.0 - sum.norm() / count as f64))
}

/// Returns whether a reading is far more regular in one direction, and not less in the other.
fn is_better(said: [Option<f64>; 2], other: [Option<f64>; 2]) -> bool {
    let settles = |k: usize| matches!((said[k], other[k]), (Some(a), Some(b)) if a > STEADY && b < SHARE * a);
    let keeps = |k: usize| match (said[k], other[k]) {
        (Some(a), Some(b)) => b < DISTURBED * a + STEADY,
        _ => true,
    };
    (settles(0) && keeps(1)) || (settles(1) && keeps(0))
}

/// Checks poses in the file's own reference, whose up is this.
///
/// # Errors
/// Quaternions that make a regular motion only in the other order, or as those of a left-handed
/// system.
pub(super) fn check(poses: &[Pose], order: Order, up: Vector3<f64>, span: &Span) -> Result<(), Refusal> {
    let lasts_s = poses.last().map_or(0.0, |p| p.time_s) - poses.first().map_or(0.0, |p| p.time_s);
    let stride = ((STRIDE_S * poses.len() as f64 / lasts_s.max(STRIDE_S)) as usize).max(1);
    let wanders = |reading: Reading| {
        let read: Vec<Pose> = poses.iter().map(|pose| reading.of(pose, order)).collect();
        wandering(&read, stride, up)
    };
    let said = wanders(Reading::AsSaid);
    // What is turned on the spot, by hand or on a table, keeps no direction in its axes: that another reading
    // would is no sign of it.
    if said[1].is_none() {
        return Ok(());
    }
    let better = |reading: Reading| is_better(said, wanders(reading));
    let (is, named) = match order {
        Order::ScalarFirst => ("last", "scalar-last"),
        Order::ScalarLast => ("first", "scalar-first"),
    };
    let insist = match order {
        Order::ScalarFirst => "scalar-first",
        Order::ScalarLast => "scalar-last",
    };
    if better(Reading::OtherEnd) {
        return Err(refusal(
            format!(
                "the quaternions are {named}: only with the scalar {is} does the specific force stay steady in body \
                axes"
            ),
            format!("set {} = \"{named}\", or \"{insist}\" if they are right as they are", span.key("quaternion")),
        ));
    }
    if [Reading::Inverse, Reading::Mirrored].into_iter().any(better) {
        return Err(refusal(
            "the quaternions are left-handed: only after inversion does the specific force stay steady in body axes",
            format!(
                "negate their x, y and z (or the axis of the reference that is mirrored), or set {} = \"{insist}\" if \
                 they are right as they are",
                span.key("quaternion")
            ),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Quaternion;

    /// A car on an eight, z up: nose along the way.
    fn figure_of_eight() -> Vec<Pose> {
        let pose = |k: u32| {
            let t = f64::from(k) * 0.01;
            let position_m = Vector3::new((0.3 * t).sin() * 20.0, (0.6 * t).sin() * 10.0, 0.0);
            let heading = (0.6 * t).cos().atan2((0.3 * t).cos());
            Pose { time_s: t, position_m, attitude: UnitQuaternion::from_euler_angles(0.0, 0.02, heading) }
        };
        (0..6000).map(pose).collect()
    }

    fn unit(w: f64, x: f64, y: f64, z: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
    }

    const SPAN: Span = Span::Study { from_s: 0.0, duration_s: 60.0 };

    #[test]
    fn a_wrong_order_and_a_wrong_hand_are_named_and_a_right_one_passes() {
        let (poses, up) = (figure_of_eight(), Vector3::z());
        assert_eq!(check(&poses, Order::ScalarFirst, up, &SPAN), Ok(()));
        let changed = |change: fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>| -> Vec<Pose> {
            poses.iter().map(|p| Pose { attitude: change(p.attitude), ..*p }).collect()
        };
        // Written w x y z, read x y z w.
        let first = changed(|q| unit(q.k, q.w, q.i, q.j));
        let cause = check(&first, Order::ScalarLast, up, &SPAN).expect_err("order").cause;
        assert!(cause.contains("scalar-first"), "{cause}");
        let last = changed(|q| unit(q.i, q.j, q.k, q.w));
        let cause = check(&last, Order::ScalarFirst, up, &SPAN).expect_err("order").cause;
        assert!(cause.contains("scalar-last"), "{cause}");
        let inverse = changed(|q| q.inverse());
        assert!(check(&inverse, Order::ScalarFirst, up, &SPAN).expect_err("hand").cause.contains("left-handed"));
        let mirrored: Vec<Pose> = poses.iter().map(|p| Reading::Mirrored.of(p, Order::ScalarFirst)).collect();
        assert!(check(&mirrored, Order::ScalarFirst, up, &SPAN).expect_err("hand").cause.contains("left-handed"));
        // One that is turned about a level axis on the spot neither: with the scalar last it would seem to hang
        // still.
        let turned = |k: u32| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), f64::from(k) * 0.01);
        let turned: Vec<Pose> = (0..6000)
            .map(|k| Pose { time_s: f64::from(k) * 0.01, position_m: Vector3::zeros(), attitude: turned(k) })
            .collect();
        assert_eq!(check(&turned, Order::ScalarFirst, up, &SPAN), Ok(()));
        // A body that slides about in all directions says nothing.
        let slid = changed(|_| UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3));
        assert_eq!(check(&slid, Order::ScalarFirst, up, &SPAN), Ok(()));
    }
}
