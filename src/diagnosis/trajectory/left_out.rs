//! States what is left out before anything is fitted: readings at a noisy rail, and stretches of
//! the reference that are wrong. Each is found with the other left out, for either spoils the
//! judgement of the other.

use super::alignment::Alignment;
use super::clipping::{self, Limit};
use super::course::reckoned;
use super::faults::{self, Fault};
use super::integral::{Rule, place};
use super::judgement::FALSE_NAME;
use super::log::{Log, Motion};

/// Turn across a fault that the gyro does not know, beyond which a reference has lost its bearings
/// for good, rad: positions and attitudes are then of two frames.
const LOST: f64 = 0.3;

/// Faults of a reference of attitude, next to a gyro with these limits, whose readings are masked;
/// noisy rails that the reference bears out are added to both.
pub(super) fn faults(log: &Log, limits: &mut Vec<Limit>, masked: &mut [bool], motion: &Motion) -> Found {
    let rails = clipping::rails(&log.rate, limits);
    let mut suspected = masked.to_vec();
    for rail in &rails {
        rail.clone().mark(&mut suspected);
    }
    let Some((faults, alignment)) = faults::find(log, &suspected, motion) else { return Found::default() };
    let all = rails.len();
    let known = limits.len();
    for rail in rails {
        let chance = rail.beyond(log, motion, (&faults, &alignment));
        if chance < FALSE_NAME {
            let limit = rail.mark(masked);
            limits.push(Limit { p_value: limit.p_value.max(chance), ..limit });
        }
    }
    if limits.len() - known == all {
        return Found { faults, alignment: Some(alignment) };
    }
    let again = faults::find(log, masked, motion);
    again.map_or_else(Found::default, |(faults, alignment)| Found { faults, alignment: Some(alignment) })
}

/// Faults, and the alignment that they stand out from.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    /// In order of time.
    pub faults: Vec<Fault>,
    alignment: Option<Alignment>,
}

impl Found {
    /// The fault behind which attitudes go on in another frame than before it, by what angle, rad:
    /// nothing where readings are masked meanwhile.
    pub(super) fn lost_bearings(&self, log: &Log, masked: &[bool], motion: &Motion) -> Option<(usize, f64)> {
        let alignment = self.alignment?;
        let rates: Vec<_> = log.rate.iter().map(|w| w - alignment.bias).collect();
        let attitude = reckoned(log, &rates, Rule::Straight);
        let across = |fault: &Fault| -> Option<(usize, f64)> {
            let [before, after] = [fault.poses[0].checked_sub(1)?, fault.poses[1]];
            let ends_s = [motion.time_s[before], *motion.time_s.get(after)?];
            let [from, to] = ends_s.map(|t| place(&log.time_s, t + alignment.late_s).0);
            if masked[from..=to].iter().any(|m| *m) {
                return None;
            }
            let read = (attitude[from].inverse() * attitude[to]).scaled_axis();
            let turn = (motion.attitude[before].inverse() * motion.attitude[after]).scaled_axis();
            let [read, turn] =
                [alignment.turned.transpose() * read, turn].map(nalgebra::UnitQuaternion::from_scaled_axis);
            let angle = read.angle_to(&turn);
            (angle > LOST).then_some((before, angle))
        };
        self.faults.iter().find_map(across)
    }

    /// IMU's stamps, in order, at which the reckoning begins anew, where it stamps so much later,
    /// s.
    pub(super) fn cuts_s(&self, log: &Log, masked: &[bool], motion: &Motion, late_s: f64) -> Vec<f64> {
        let middle = |from_s: f64, to_s: f64| 0.5 * (from_s + to_s);
        let of = |fault: &Fault| {
            let [from, to] = [fault.poses[0], fault.poses[1] - 1].map(|pose| motion.time_s[pose] + late_s);
            middle(from, to)
        };
        let mut cuts_s: Vec<f64> = self.faults.iter().map(of).collect();
        let mut from = None;
        for (k, masked) in masked.iter().chain(&[false]).enumerate() {
            match (from, masked) {
                (None, true) => from = Some(k),
                (Some(first), false) => {
                    cuts_s.push(middle(log.time_s[first], log.time_s[k - 1]));
                    from = None;
                }
                _ => {}
            }
        }
        crate::numerics::order::sort(&mut cuts_s);
        cuts_s
    }
}
