//! Figure 12 on real hands: the three filters over the moves between a recording's poses.
//!
//! The reference is the pitch that the gyro carries through a move from one still pose into the
//! next, corrected to meet the accelerometer's mean in both. Moves that come near to standing
//! upright are left out: eq. 3 has no pitch rate there.

use super::beliefs::{WEIGHTINGS, model};
use super::check::{Check, Provenance};
use super::inertial::Inertial;
use super::pitch::{Pitch, up};
use proofmass_base::units::{DEGREE, STANDARD_GRAVITY_M_S2};
use proofmass_numerics::numerics::order;
use proofmass_scenario::navigation::kalman::{Filter, Model, Reading};
use proofmass_scenario::navigation::tilt::{norm, pitch_rad, pitch_rate_rad_s, turn};

/// "Back" on a recording: within this of the pose's own mean, for good. Several deviations of each
/// filter's noise.
const BACK_RAD: f64 = 0.25 * DEGREE;
/// Steeper poses and moves are left out.
const STEEPEST_RAD: f64 = 60.0 * DEGREE;

/// Time, reference, accelerometer and the three filters, s and rad.
pub(crate) type Line = (f64, f64, f64, [f64; 3]);

/// All usable moves of one recording.
#[derive(Debug, Clone)]
pub struct Moved {
    /// States whether the readings were recorded or simulated.
    pub source: Provenance,
    /// Largest error in a move, per filter, sorted, rad.
    pub peak_rad: [Vec<f64>; 3],
    /// Time from the end of the motion until back, per filter, sorted, s.
    pub recovery_s: [Vec<f64>; 3],
    /// Mean NIS in still poses before the moves, per filter.
    pub nis_still: [f64; 3],
    /// The move with the largest error of the plain filter.
    pub example: Vec<Line>,
}

/// Runs the filters over every usable move, with noise as fitted to the recording itself.
pub fn compute(imu: &Inertial, pitch: &Pitch) -> Moved {
    let model = Model {
        step_s: imu.step_s,
        angle_walk_rad_rts: pitch.angle_walk.value,
        tilt_noise_rad: pitch.force_deviation.value,
        force_noise_m_s2: pitch.force_deviation.value * STANDARD_GRAVITY_M_S2,
        ..model()
    };
    let mut moved = Moved {
        source: imu.source,
        peak_rad: Default::default(),
        recovery_s: Default::default(),
        nis_still: [0.0; 3],
        example: vec![],
    };
    let mut worst = 0.0;
    let mut usable = 0.0;
    for k in 0..imu.poses.len().saturating_sub(1) {
        let Some(run) = over_move(imu, &model, k) else { continue };
        usable += 1.0;
        for w in 0..3 {
            moved.peak_rad[w].push(run.peak_rad[w]);
            moved.recovery_s[w].push(run.recovery_s[w]);
            moved.nis_still[w] += run.nis_still[w];
        }
        if run.peak_rad[0] > worst {
            worst = run.peak_rad[0];
            moved.example = run.lines;
        }
    }
    for w in 0..3 {
        order::sort(&mut moved.peak_rad[w]);
        order::sort(&mut moved.recovery_s[w]);
        moved.nis_still[w] /= usable;
    }
    moved
}

struct Run {
    peak_rad: [f64; 3],
    recovery_s: [f64; 3],
    nis_still: [f64; 3],
    lines: Vec<Line>,
}

/// The filters from two seconds before a move to the end of the pose after it; `None` where it gets
/// too steep.
fn over_move(imu: &Inertial, model: &Model, k: usize) -> Option<Run> {
    let (departed, reached) = (imu.poses[k].end, imu.poses[k + 1].start);
    let lead = ((2.0 / imu.step_s) as usize).min(imu.poses[k].len());
    let samples = departed - lead..imu.poses[k + 1].end.min(reached + (4.0 / imu.step_s) as usize);
    let (from, to) = (pitch_rad(up(imu, k)), pitch_rad(up(imu, k + 1)));
    let mut direction = up(imu, k);
    let (mut reference, mut rates) = (Vec::new(), Vec::new());
    for i in samples.clone() {
        rates.push(pitch_rate_rad_s(direction, imu.rate_rad_s[i]));
        if i >= departed {
            direction = turn(direction, imu.rate_rad_s[i], imu.step_s);
        }
        reference.push(pitch_rad(direction));
    }
    let miss = reference[reached - samples.start] - to;
    for (j, value) in reference.iter_mut().enumerate() {
        let i = samples.start + j;
        let part = (i.clamp(departed, reached) - departed) as f64 / (reached - departed) as f64;
        *value = if i < departed {
            from
        } else if i >= reached {
            to
        } else {
            *value - part * miss
        };
    }
    if reference.iter().any(|r| r.abs() > STEEPEST_RAD) {
        return None;
    }
    // The motion ends where the turning rate or the force last leave what the still poses show.
    let restless =
        |i: usize| norm(imu.rate_rad_s[i]) > 5.0 * DEGREE || (norm(imu.force_m_s2[i]) - model.gravity_m_s2).abs() > 0.2;
    let stopped = (departed..reached).rev().find(|i| restless(*i)).unwrap_or(departed) + 1;
    let mut run = Run { peak_rad: [0.0; 3], recovery_s: [0.0; 3], nis_still: [0.0; 3], lines: vec![] };
    let mut tilts: Vec<[f64; 3]> = vec![[0.0; 3]; samples.len()];
    for (w, weighting) in WEIGHTINGS.into_iter().enumerate() {
        let settled = model.settled_covariance();
        let start_deviation = [settled[(0, 0)].sqrt(), settled[(1, 1)].sqrt()];
        let mut filter = Filter::new(Model { start_deviation, ..*model }, weighting, from);
        let mut back = stopped;
        for (j, i) in samples.clone().enumerate() {
            let force = imu.force_m_s2[i];
            let update =
                filter.step(Reading { rate_rad_s: rates[j], tilt_rad: pitch_rad(force), force_m_s2: norm(force) });
            tilts[j][w] = update.state[0];
            let error = (update.state[0] - reference[j]).abs();
            run.peak_rad[w] = run.peak_rad[w].max(error);
            if i < departed {
                run.nis_still[w] += update.nis / lead as f64;
            }
            if i >= stopped && error > BACK_RAD {
                back = i + 1;
            }
        }
        run.recovery_s[w] = (back - stopped) as f64 * imu.step_s;
    }
    let line = |j: usize| {
        let i = samples.start + j;
        let seconds = (i as f64 - departed as f64) * imu.step_s;
        (seconds, reference[j], pitch_rad(imu.force_m_s2[i]), tilts[j])
    };
    run.lines = (0..samples.len()).map(line).collect();
    Some(run)
}

/// Checks on the moves.
pub(super) fn moved_checks(moved: &Moved) -> Vec<Check> {
    let median = |values: &[f64]| order::quantile(values, 0.5);
    let [plain, magnitude, adaptive] = &moved.peak_rad;
    vec![
        Check::between(
            "moves by hand, plain filter: median of the largest error / °",
            "the paper: \"nonsense\" when moved; more than ten of the filter's own standard deviations (0.02°)",
            0.2,
            45.0,
            median(plain) / DEGREE,
        ),
        Check::between(
            "moves by hand: largest error weighted by ||a| − g| over the plain one's, medians",
            "the point of weighting: less than 0.7",
            0.0,
            0.7,
            median(magnitude) / median(plain),
        ),
        Check::between(
            "moves by hand: largest error with adaptive R over the plain one's, medians",
            "the point of adapting: less than 0.7",
            0.0,
            0.7,
            median(adaptive) / median(plain),
        ),
    ]
}
