//! Figures 11 and 12: the Kalman filter's own numbers at rest, and how it fails in motion and comes
//! back.
//!
//! Simulated over an ensemble, each member next to a twin with the same noise that was not moved,
//! so that what the motion did is seen apart from the noise; and on the moves of a recording. The
//! filter's beliefs come from printed or fitted noise, never from the outcome.

use super::beliefs::{STEP_S, WEIGHTINGS, model};
use super::check::{Check, Exhibit};
use super::moved::{Moved, moved_checks};
use proofmass_base::parallel;
use proofmass_numerics::numerics::order;
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_scenario::navigation::kalman::{Filter, Model, Reading, Weighting};

/// The paper's times: still until, moved until, back only after, s.
pub(crate) const STILL_UNTIL_S: f64 = 1.2;
pub(crate) const MOVED_UNTIL_S: f64 = 1.4;
pub(crate) const BACK_AFTER_S: f64 = 3.0;

const MEMBERS: u64 = 400;
const END_S: f64 = 8.0;

/// The filter at rest: what figure 11 shows over time.
#[derive(Debug, Clone)]
pub struct AtRest {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// √P of tilt (rad) and bias (rad/s), one per time.
    pub believed: Vec<[f64; 2]>,
    /// The ensemble's own deviation of both errors.
    pub actual: Vec<[f64; 2]>,
    /// Gain on tilt (1) and on bias (1/s).
    pub gain: Vec<[f64; 2]>,
    /// Mean innovation squared over its variance.
    pub nis: f64,
    /// Mean of eᵀP⁻¹e at the end.
    pub nees: f64,
    /// Gain on tilt once settled.
    pub settled_gain: f64,
}

/// The filter in motion, simulated.
#[derive(Debug, Clone)]
pub struct InMotion {
    /// One member: (time, tilt by the accelerometer, by the integrated gyro, by each filter), rad.
    pub example: Vec<(f64, f64, f64, [f64; 3])>,
    /// Recovery times after the motion ended, per filter, sorted, s.
    pub recovery_s: [Vec<f64>; 3],
    /// Largest error of each member, per filter, sorted, rad.
    pub peak_rad: [Vec<f64>; 3],
    /// Mean NIS before, during and in the half second after the motion, per filter.
    pub nis: [[f64; 3]; 3],
}

/// Numbers and checks of figures 11 and 12.
#[derive(Debug, Clone)]
pub struct Fusion {
    /// Sensor noise that the filter assumes.
    pub model: Model,
    /// The filter at rest, for figure 11.
    pub at_rest: AtRest,
    /// The filters under simulated motion, for figure 12.
    pub in_motion: InMotion,
    /// Moves of a recording (or of its simulation).
    pub moved: Moved,
    /// Figures 11 and 12 with their checks.
    pub exhibits: [Exhibit; 2],
}

/// Computes both figures; `moved` are the filters' runs over a recording's moves.
pub fn compute(moved: Moved) -> Fusion {
    let model = model();
    let (at_rest, in_motion) = (at_rest(&model), in_motion(&model));
    let mut checks_of_12 = figure_12_checks(&in_motion);
    checks_of_12.extend(moved_checks(&moved));
    let exhibits = [
        Exhibit::simulated(
            11,
            "The Kalman filter that fuses gyro and accelerometer",
            figure_11_checks(&model, &at_rest),
        ),
        Exhibit { figure: 12, title: "The filter in motion".into(), source: moved.source, checks: checks_of_12 },
    ];
    Fusion { model, at_rest, in_motion, moved, exhibits }
}

fn normals(member: u64, stream: Stream) -> impl FnMut() -> f64 {
    let mut random = Philox::new(11, member, stream);
    move || random.normal()
}

fn at_rest(model: &Model) -> AtRest {
    let steps = 6000;
    let scale = 1.0 / STEP_S.sqrt();
    // Per member: errors of tilt and bias at every step, and the sum of NIS over the second half.
    let runs: Vec<(Vec<[f64; 2]>, f64, f64)> = parallel::map_members(0..MEMBERS, |m| {
        let (mut g, mut b, mut a) =
            (normals(m, Stream::GyroWhite), normals(m, Stream::GyroWalk), normals(m, Stream::AccelerometerWhite));
        let mut filter = Filter::new(*model, Weighting::Plain, model.start_deviation[0] * a());
        let mut bias = model.start_deviation[1] * b();
        let (mut errors, mut nis, mut nees) = (Vec::with_capacity(steps), 0.0, f64::NAN);
        for step in 0..steps {
            // The tilt is zero throughout; the gyro reads its bias and its noise.
            let rate_rad_s = bias + model.angle_walk_rad_rts * scale * g();
            let tilt_rad = model.tilt_noise_rad * a();
            let update = filter.step(Reading { rate_rad_s, tilt_rad, force_m_s2: model.gravity_m_s2 });
            bias += model.bias_walk_rad_s_rts * STEP_S.sqrt() * b();
            let error = update.state - nalgebra::Vector2::new(0.0, bias);
            errors.push([error[0], error[1]]);
            if step >= steps / 2 {
                nis += update.nis / (steps / 2) as f64;
            }
            let inverse = update.covariance.try_inverse();
            nees = inverse.map_or(f64::NAN, |p| (error.transpose() * p * error)[0]);
        }
        (errors, nis, nees)
    });
    let mut filter = Filter::new(*model, Weighting::Plain, 0.0);
    let still = Reading { rate_rad_s: 0.0, tilt_rad: 0.0, force_m_s2: model.gravity_m_s2 };
    let mut rest = AtRest {
        time_s: vec![],
        believed: vec![],
        actual: vec![],
        gain: vec![],
        nis: runs.iter().map(|r| r.1).sum::<f64>() / MEMBERS as f64,
        nees: runs.iter().map(|r| r.2).sum::<f64>() / MEMBERS as f64,
        settled_gain: f64::NAN,
    };
    for step in 0..steps {
        let update = filter.step(still);
        rest.settled_gain = update.gain[0];
        // Every step at first, then ever fewer: the axis is logarithmic.
        if step < 20 || step % (step / 20) == 0 {
            let sd = |i: usize| (runs.iter().map(|r| r.0[step][i].powi(2)).sum::<f64>() / MEMBERS as f64).sqrt();
            rest.time_s.push((step + 1) as f64 * STEP_S);
            rest.believed.push([update.covariance[(0, 0)].sqrt(), update.covariance[(1, 1)].sqrt()]);
            rest.actual.push([sd(0), sd(1)]);
            rest.gain.push([update.gain[0], update.gain[1]]);
        }
    }
    rest
}

/// One filter over one member.
#[derive(Default)]
struct Trace {
    tilt_rad: Vec<f64>,
    believed_rad: Vec<f64>,
    nis: Vec<f64>,
    /// Tilt by the accelerometer and by the integrated gyro.
    inputs: Vec<(f64, f64)>,
}

/// Runs one filter over one member.
fn run(model: &Model, weighting: Weighting, member: u64, moved: bool) -> Trace {
    let (mut g, mut a, mut draw) = (
        normals(member, Stream::GyroWhite),
        normals(member, Stream::AccelerometerWhite),
        normals(member, Stream::Excitation),
    );
    // A hand's push to one side and stop again: one swing of acceleration, 5 to 25 m/s² in the
    // middle 90 %.
    let push_m_s2 = 12.0 * (0.5 * draw()).exp() * draw().signum();
    let mut filter = Filter::new(Model { start_deviation: settled(model), ..*model }, weighting, 0.0);
    let mut trace = Trace::default();
    let mut integral = 0.0;
    for step in 0..(END_S / STEP_S) as u32 {
        let t = f64::from(step) * STEP_S;
        let phase = (t - STILL_UNTIL_S) / (MOVED_UNTIL_S - STILL_UNTIL_S);
        let swing = if moved && (0.0..1.0).contains(&phase) { (2.0 * std::f64::consts::PI * phase).sin() } else { 0.0 };
        let x = push_m_s2 * swing + model.force_noise_m_s2 * a();
        let z = model.gravity_m_s2 + model.force_noise_m_s2 * a();
        let rate_rad_s = model.angle_walk_rad_rts / STEP_S.sqrt() * g();
        integral += rate_rad_s * STEP_S;
        let update = filter.step(Reading { rate_rad_s, tilt_rad: x.atan2(z), force_m_s2: x.hypot(z) });
        trace.tilt_rad.push(update.state[0]);
        trace.believed_rad.push(update.covariance[(0, 0)].sqrt());
        trace.nis.push(update.nis);
        trace.inputs.push((x.atan2(z), integral));
    }
    trace
}

/// Deviations after long rest, so that a run begins settled.
fn settled(model: &Model) -> [f64; 2] {
    let p = model.settled_covariance();
    [p[(0, 0)].sqrt(), p[(1, 1)].sqrt()]
}

fn in_motion(model: &Model) -> InMotion {
    let index = |t: f64| (t / STEP_S).round() as usize;
    let (begin, end) = (index(STILL_UNTIL_S), index(MOVED_UNTIL_S));
    let mut out =
        InMotion { example: vec![], recovery_s: Default::default(), peak_rad: Default::default(), nis: [[0.0; 3]; 3] };
    for (w, weighting) in WEIGHTINGS.into_iter().enumerate() {
        // Recovery time, largest error, NIS by phase.
        let members: Vec<(f64, f64, [f64; 3])> = parallel::map_members(0..MEMBERS, |m| {
            let (moved, quiet) = (run(model, weighting, m, true), run(model, weighting, m, false));
            // What the motion did, against what the filter itself holds possible at that time.
            let differences: Vec<f64> =
                moved.tilt_rad.iter().zip(&quiet.tilt_rad).map(|(a, b)| (a - b).abs()).collect();
            let visible = |i: &usize| differences[*i] > moved.believed_rad[*i];
            let back = (0..differences.len()).rev().find(visible).map_or(0, |i| i + 1);
            let mean = |r: std::ops::Range<usize>| moved.nis[r.clone()].iter().sum::<f64>() / r.len() as f64;
            let recovery_s = back.saturating_sub(end) as f64 * STEP_S;
            let peak = differences.iter().copied().fold(0.0, f64::max);
            (recovery_s, peak, [mean(0..begin), mean(begin..end), mean(end..end + 50)])
        });
        let sorted = |pick: fn(&(f64, f64, [f64; 3])) -> f64| {
            let mut values: Vec<f64> = members.iter().map(pick).collect();
            order::sort(&mut values);
            values
        };
        out.recovery_s[w] = sorted(|m| m.0);
        out.peak_rad[w] = sorted(|m| m.1);
        out.nis[w] = std::array::from_fn(|k| members.iter().map(|m| m.2[k]).sum::<f64>() / MEMBERS as f64);
    }
    let filters = WEIGHTINGS.map(|w| run(model, w, 3, true));
    out.example = (0..filters[0].tilt_rad.len())
        .map(|i| {
            let (force, gyro) = filters[0].inputs[i];
            (i as f64 * STEP_S, force, gyro, std::array::from_fn(|w| filters[w].tilt_rad[i]))
        })
        .collect();
    out
}

fn figure_11_checks(model: &Model, rest: &AtRest) -> Vec<Check> {
    let p = model.settled_covariance();
    let expected = p[(0, 0)] / (p[(0, 0)] + model.tilt_noise_rad.powi(2));
    let n = MEMBERS as f64;
    vec![
        Check::near(
            "gain on the tilt after a minute",
            "the algebraic Riccati equation solved by doubling, independent of the filter's recursion; after a minute the bias has nearly settled",
            expected,
            rest.settled_gain,
            1e-3 * expected,
        ),
        Check::near(
            "NIS, innovation squared over its variance, mean over half a minute of 400 members",
            "1: the filter's model is that of the simulation; four standard errors √(2/n) of 1.2 million innovations",
            1.0,
            rest.nis,
            4.0 * (2.0 / (n * 3000.0)).sqrt(),
        ),
        Check::near(
            "NEES, eᵀP⁻¹e after a minute",
            "2 for two states (χ²); four standard errors √(4/400)",
            2.0,
            rest.nees,
            4.0 * (4.0 / n).sqrt(),
        ),
    ]
}

fn figure_12_checks(motion: &InMotion) -> Vec<Check> {
    let [plain, magnitude, adaptive] = &motion.recovery_s;
    let half = |times: &[f64]| order::quantile(times, 0.5) / order::quantile(plain, 0.5);
    vec![
        Check::near(
            "plain filter: time at which it is back / s, median of 400 moves",
            "the paper: after 3 s, read off a plot to about 0.5 s, its tuning not given; ours follows from datasheet \
            noise",
            BACK_AFTER_S,
            MOVED_UNTIL_S + order::quantile(plain, 0.5),
            0.5,
        ),
        Check::between(
            "recovery time weighted by ||a| − g| over the plain one's, medians",
            "the point of weighting: less than half",
            0.0,
            0.5,
            half(magnitude),
        ),
        Check::between(
            "recovery time with adaptive R as well over the plain one's, medians",
            "the point of adapting: less than half",
            0.0,
            0.5,
            half(adaptive),
        ),
        Check::near(
            "plain filter: mean NIS before the motion",
            "1 at rest; four standard errors of 400 × 120 innovations",
            1.0,
            motion.nis[0][0],
            4.0 * (2.0 / (MEMBERS as f64 * 120.0)).sqrt(),
        ),
        Check::between(
            "plain filter: mean NIS in the motion, log₁₀",
            "the innovation is some 30° against the filter's own 0.08°: four to six powers of ten; the filter could \
            have detected it",
            3.0,
            6.0,
            motion.nis[0][1].log10(),
        ),
    ]
}
