//! States where the base model's mismatch lives: which residual, which poses, and which component
//! of gravity it follows.

use nalgebra::Vector3;

use super::account::{Location, Rms};
use super::fit::Fit;
use super::group::{GROUPS, Group};
use super::imu::Observed;
use crate::answer::Places;
use crate::numerics::special::{chi_squared_survival, discoveries};
use crate::units::STANDARD_GRAVITY_M_S2;
use crate::verdict::Stretch;

/// Share of the stretches named that may be false.
const FALSE_DISCOVERIES: f64 = 0.05;

/// Root-mean-square of each kind of residual.
fn residuals(fit: &Fit) -> Vec<Rms> {
    let of = |group: Group| {
        let mut sums = (0.0, 0.0, 0.0);
        for r in (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] == group) {
            let (value, deviation) = (fit.rows.residual[r], fit.rows.deviation[r]);
            sums = (sums.0 + (value * deviation).powi(2), sums.1 + deviation.powi(2), sums.2 + 1.0);
        }
        let root = |sum: f64| (sum / f64::max(sums.2, 1.0)).sqrt() * group.factor();
        Rms { group, value: root(sums.0), noise: root(sums.1) }
    };
    GROUPS.map(of).into()
}

/// Isolation of the base model's residual; `forces` as the repaired model sees them.
pub(crate) fn locate(observed: &Observed<'_>, base: &Fit, forces: &[Vector3<f64>]) -> (Places, Location) {
    let excess: Vec<(f64, f64)> = (0..observed.poses.len())
        .map(|k| {
            let own = (0..base.rows.pose.len()).filter(|r| base.rows.pose[*r] == k);
            let (sum, n) = own.fold((0.0, 0.0), |s, r| (s.0 + base.rows.residual[r].powi(2), s.1 + 1.0));
            (sum / f64::max(n, 1.0), chi_squared_survival(sum, f64::max(n, 1.0)))
        })
        .collect();
    let found = discoveries(&excess.iter().map(|e| e.1).collect::<Vec<_>>(), FALSE_DISCOVERIES);
    let seconds = |sample: usize| sample as f64 / observed.imu.rate_hz;
    let time_s: Vec<Stretch> = observed
        .poses
        .iter()
        .zip(&excess)
        .zip(&found)
        .filter(|(_, found)| **found)
        .map(|((p, e), _)| Stretch { from: seconds(p.samples.start), to: seconds(p.samples.end), excess: e.0 })
        .collect();
    let (axis, state) = by_component(base, forces);
    let location = Location {
        residuals: residuals(base),
        standing_out: time_s.len(),
        axis: Some(axis).filter(|_| !state.is_empty()),
    };
    (Places { time_s, state, ..Places::default() }, location)
}

/// The component of gravity that the excess follows most, and the excess in five bins of it (in
/// m/s²).
fn by_component(base: &Fit, forces: &[Vector3<f64>]) -> (&'static str, Vec<Stretch>) {
    const BINS: usize = 5;
    let g = STANDARD_GRAVITY_M_S2;
    let mut best: (f64, &'static str, Vec<Stretch>) = (0.0, "", Vec::new());
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut sums = [(0.0, 0.0); BINS];
        for r in 0..base.rows.pose.len() {
            let fraction = forces[base.rows.pose[r]][axis] / g;
            let bin = (((fraction + 1.0) / 2.0 * BINS as f64).max(0.0) as usize).min(BINS - 1);
            sums[bin].0 += base.rows.residual[r].powi(2);
            sums[bin].1 += 1.0;
        }
        let p: Vec<f64> = sums.iter().map(|s| if s.1 > 0.0 { chi_squared_survival(s.0, s.1) } else { 1.0 }).collect();
        let found = discoveries(&p, FALSE_DISCOVERIES / 3.0);
        let excess: Vec<f64> = sums.iter().map(|s| if s.1 > 0.0 { s.0 / s.1 } else { 0.0 }).collect();
        let filled: Vec<f64> = excess.iter().zip(&sums).filter(|e| e.1.1 > 0.0).map(|e| *e.0).collect();
        let contrast =
            filled.iter().fold(0.0, |m: f64, e| m.max(*e)) - filled.iter().fold(f64::INFINITY, |m: f64, e| m.min(*e));
        if contrast > best.0 && found.iter().any(|f| *f) {
            let edge = |b: usize| (2.0 * b as f64 / BINS as f64 - 1.0) * g;
            let stretches = (0..BINS)
                .filter(|b| found[*b])
                .map(|b| Stretch { from: edge(b), to: edge(b + 1), excess: excess[b] })
                .collect();
            best = (contrast, name, stretches);
        }
    }
    (best.1, best.2)
}
