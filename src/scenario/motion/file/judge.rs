//! Checks whether poses in order of time can be one motion: holes, jumps, poses that come too
//! rarely.
//!
//! A study has nothing but the poses and needs all of them. Next to a log, holes and turns that no
//! body makes are for the asker to leave out, who has a gyro to judge them by.

use nalgebra::Vector3;

use super::finding::{Finding, Leap};
use super::refusal::{Refusal, refusal};
use super::span::Span;
use crate::motion::pose::Pose;
use crate::number::rounded;
use crate::numerics::order;

/// Poses that come more rarely than this are mentioned, Hz.
const RARE_HZ: f64 = 9.0;
/// Between poses, times the usual interval: from the first on poses are missing; for this many
/// seconds the spline may guess.
const HOLE: (f64, f64) = (2.5, 1.0);
/// Beyond, the way from one pose to the next is not known, rad.
const TURN_RAD: f64 = 2.0;
/// A jump is a change of velocity, and of rate, that asks for more than this, m/s² and rad/s², …
const JUMP: [f64; 2] = [50.0, 500.0];
/// … and is this many times the usual one, and the one that a tenth of the poses exceed.
const UNUSUAL: [f64; 2] = [30.0, 10.0];

/// A jump that the spline may smooth, m or rad: references do that when they find their bearings
/// again.
const SURVIVED: f64 = 0.3;
/// Share of turns too wide to follow from which on the poses themselves are too few.
const MOST_WIDE: f64 = 0.1;

/// Judges poses, whose rows these are.
///
/// # Errors
/// Fewer than ten poses, a wide jump, a long hole, turns too wide to follow.
pub(super) fn judge(poses: &[Pose], rows: &[usize], span: &Span) -> Result<Vec<Finding>, Refusal> {
    if poses.len() < 10 {
        let cause = format!("{} poses lie in the stretch that is used: need 10 at least", poses.len());
        return Err(refusal(cause, "choose a longer stretch, or give a longer file"));
    }
    let intervals: Vec<f64> = poses.windows(2).map(|p| p[1].time_s - p[0].time_s).collect();
    let usual = order::median(intervals.clone()).unwrap_or_default();
    let mut findings = Vec::new();
    if usual > 1.0 / RARE_HZ {
        findings.push(Finding::Slow { rate_hz: 1.0 / usual });
    }
    let holes = intervals.iter().filter(|dt| **dt > HOLE.0 * usual);
    let longest_s = intervals.iter().fold(0.0f64, |a, b| a.max(*b));
    let holes = holes.count();
    let at = intervals.iter().position(|dt| *dt >= longest_s).unwrap_or_default();
    if longest_s > HOLE.1.max(HOLE.0 * usual) && !span.leaves_out() {
        let cause = format!(
            "no pose for {} s after row {} (at {} s {})",
            rounded(longest_s, 3),
            rows[at],
            rounded(poses[at].time_s, 4),
            span.of_what()
        );
        return Err(refusal(cause, span.choose()));
    }
    if holes > 0 {
        findings.push(Finding::Bridged { holes, longest_s, after_row: rows[at], so: span.of_holes() });
    }
    let way = |p: &[Pose]| p[1].position_m - p[0].position_m;
    let turn = |p: &[Pose]| (p[0].attitude.inverse() * p[1].attitude).scaled_axis();
    let velocities: Vec<_> = poses.windows(2).zip(&intervals).map(|(p, dt)| way(p) / *dt).collect();
    let rates: Vec<_> = poses.windows(2).zip(&intervals).map(|(p, dt)| turn(p) / *dt).collect();
    let metres: fn(f64) -> Leap = Leap::Metres;
    let radians: fn(f64) -> Leap = Leap::Radians;
    for (slopes, limit, what) in [(&velocities, JUMP[0], metres), (&rates, JUMP[1], radians)] {
        let all = jumps(slopes, &intervals, limit);
        let Some((at, size)) = all.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let finding = Finding::Jumps {
            jumps: all.len(),
            largest: what(size),
            first_row: rows[at],
            at_s: poses[at].time_s,
            since: span.of_what(),
        };
        if size > SURVIVED && matches!(finding, Finding::Jumps { largest: Leap::Radians(_), .. }) && span.leaves_out() {
            continue;
        }
        if size > SURVIVED {
            return Err(refusal(finding.to_string(), span.choose()));
        }
        findings.push(finding);
    }
    let wide: Vec<usize> = (0..intervals.len()).filter(|k| turn(&poses[*k..k + 2]).norm() > TURN_RAD).collect();
    let most = if span.leaves_out() { (MOST_WIDE * intervals.len() as f64) as usize } else { 0 };
    if let Some(at) = wide.first().copied().filter(|_| wide.len() > most) {
        let cause = format!(
            "poses at {} Hz are too far apart: it turns by {}° between rows {} and {}",
            rounded(1.0 / usual, 3),
            rounded(turn(&poses[at..]).norm().to_degrees(), 3),
            rows[at],
            rows[at + 1]
        );
        return Err(refusal(cause, "a trajectory needs poses ten times as often as it turns"));
    }
    Ok(findings)
}

/// Intervals whose slope is none of their neighbours' by far, and how far each leaps beyond what
/// they explain.
fn jumps(slopes: &[Vector3<f64>], intervals: &[f64], limit: f64) -> Vec<(usize, f64)> {
    let leap = |k: usize| (slopes[k] - 0.5 * (slopes[k - 1] + slopes[k + 1])).norm();
    let odd: Vec<f64> = (1..slopes.len().saturating_sub(1)).map(|k| leap(k) / intervals[k]).collect();
    let mut sorted = odd.clone();
    order::sort(&mut sorted);
    let usual = UNUSUAL[0] * order::quantile(&sorted, 0.5);
    let many = UNUSUAL[1] * order::quantile(&sorted, 0.9);
    let most = limit.max(usual).max(many);
    // A jump disturbs its neighbours half as much: it is where the oddity is largest.
    let is_peak =
        |k: usize| odd[k] > most && odd[k.saturating_sub(1)] <= odd[k] && odd.get(k + 1).is_none_or(|o| *o < odd[k]);
    (0..odd.len()).filter(|k| is_peak(*k)).map(|k| (k + 1, leap(k + 1) * intervals[k + 1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    fn circle(rate_hz: f64, count: usize) -> Vec<Pose> {
        let pose = |k: usize| {
            let t = k as f64 / rate_hz;
            let position_m = Vector3::new((0.5 * t).sin(), (0.5 * t).cos(), 0.0) * 10.0;
            Pose { time_s: t, position_m, attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, -0.5 * t) }
        };
        (0..count).map(pose).collect()
    }

    const SPAN: Span = Span::Study { from_s: 0.0, duration_s: 10.0 };

    #[test]
    fn a_motion_passes_and_what_is_none_is_named() {
        let rows: Vec<usize> = (0..2000).collect();
        assert_eq!(judge(&circle(200.0, 2000), &rows, &SPAN), Ok(vec![]));
        let slow = judge(&circle(2.0, 100), &rows, &SPAN).expect("mentioned");
        assert_eq!(slow, [Finding::Slow { rate_hz: 2.0 }]);
        let mut jumped = circle(200.0, 2000);
        jumped[1200..].iter_mut().for_each(|p| p.position_m.x += 0.4);
        let cause = judge(&jumped, &rows, &SPAN).expect_err("jump").cause;
        assert!(cause.contains("position jumps by 0.4 m") && cause.contains("row 1199"), "{cause}");
        let mut nudged = circle(200.0, 2000);
        nudged[1200..].iter_mut().for_each(|p| p.position_m.x += 0.1);
        nudged[1500..].iter_mut().for_each(|p| p.position_m.y += 0.02);
        let found = judge(&nudged, &rows, &SPAN).expect("survived");
        assert!(matches!(found[..], [Finding::Jumps { jumps: 2, first_row: 1199, .. }]), "{found:?}");
        let mut turned = circle(200.0, 2000);
        turned[700..].iter_mut().for_each(|p| p.attitude *= UnitQuaternion::from_euler_angles(0.4, 0.0, 0.0));
        let cause = judge(&turned, &rows, &SPAN).expect_err("jump").cause;
        assert!(cause.contains("attitude jumps by 22.9°") && cause.contains("row 699"), "{cause}");
        let mut holed = circle(200.0, 2000);
        holed.drain(500..900);
        assert!(judge(&holed, &rows, &SPAN).expect_err("hole").cause.contains("no pose for 2"));
        let mut bridged = circle(200.0, 2000);
        bridged.drain(500..520);
        assert!(matches!(judge(&bridged, &rows, &SPAN).expect("bridged")[..], [Finding::Bridged { holes: 1, .. }]));
    }
}
