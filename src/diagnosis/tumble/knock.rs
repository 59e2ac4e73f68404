//! Poses that disagree with all the others, as one that was touched while it was read does: left
//! out, and told.
//!
//! A law of the sensor shows in every pose of like attitude; a knock in one. Each pose in turn is
//! left out of a fit of what nearly every unit has and of g-sensitivity, and the fall of the misfit
//! is held against what is left (an F test of the deleted residuals; Cook & Weisberg, Residuals and
//! Influence in Regression, 1982, §2.2).

use super::calibration::{Point, gyro};
use super::candidate::{Role, terms};
use super::fit::Fit;
use super::group::Group;
use super::imu::Observed;
use super::residual::Residual;
use super::start;
use crate::numerics::special::f_survival;

/// Chance of leaving out a pose in which nothing happened, over all poses.
const FALSE_KNOCK: f64 = 1e-4;
/// Mean square of a knocked pose's residuals over their noise, at the least; what is left of the
/// others must be less.
pub(crate) const CLEAR: f64 = 10.0;
/// One pose in this many may be left out.
const ONE_IN: usize = 10;

/// Marks knocked poses as not counting and returns them, in order of time.
pub(crate) fn leave_out(observed: &mut Observed<'_>, guess: &Point) -> Vec<usize> {
    let with_gyro = observed.imu.gyro.is_some();
    let usual = terms(with_gyro, observed.imu.covariate.is_some())
        .into_iter()
        .filter(|t| matches!(t.role, Role::EveryUnit | Role::OfAColumn) || t.parameters == [gyro::G_SENSITIVITY]);
    let active: Vec<usize> =
        start::base(with_gyro).into_iter().chain(usual.flat_map(|t| t.active().collect::<Vec<_>>())).collect();
    let mut out = Vec::new();
    for _ in 0..observed.poses.len() / ONE_IN {
        let fit = Fit::balanced(observed, guess, &active);
        if !fit.determined || Residual::of(&fit).above.is_empty() {
            break;
        }
        let Some(pose) = knocked(&fit, observed.poses.len()) else { break };
        observed.poses[pose].counts = false;
        out.push(pose);
    }
    out.sort_unstable();
    out
}

/// The pose that disagrees most, where one does beyond chance.
fn knocked(fit: &Fit, poses: usize) -> Option<usize> {
    let rows = &fit.rows;
    let over = |r: usize| rows.residual[r] * rows.residual[r] / fit.inflation[rows.group[r].place()];
    let total: f64 = (0..rows.pose.len()).map(over).sum();
    let judged = (0..poses).filter_map(|k| {
        let touches = |r: usize| rows.pose[r] == k || rows.group[r] == Group::Turn && rows.pose[r] + 1 == k;
        let own: Vec<usize> = (0..rows.pose.len()).filter(|r| touches(*r)).collect();
        let (_, deleted) = fit.without(touches);
        let product = |r: &usize| rows.residual[*r] * deleted[*r];
        let fall: f64 = own.iter().map(|r| product(r) / fit.inflation[rows.group[*r].place()]).sum();
        let clear = own.iter().map(product).sum::<f64>() > CLEAR * own.len() as f64;
        let (spent, degrees_of_freedom) =
            (own.len() as f64, rows.pose.len() as f64 - fit.active.len() as f64 - own.len() as f64);
        if !clear || degrees_of_freedom < 4.0 {
            return None;
        }
        let ratio = fall / spent / ((total - fall).max(0.0) / degrees_of_freedom).max(f64::MIN_POSITIVE);
        let p_value = f_survival(ratio, spent, degrees_of_freedom) * poses as f64;
        (p_value < FALSE_KNOCK).then_some((k, ratio))
    });
    judged.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}
