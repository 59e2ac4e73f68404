//! Figures 2 to 4: how errors grow. A tilt bias becomes metres (eq. 1 and 2), white rate noise
//! becomes a walk, and the two kinds of bias become t² and t³.

use super::check::{Check, Exhibit};
use super::envelope::Envelope;
use proofmass_base::parallel;
use proofmass_base::units::{DEGREE, DEGREE_PER_HOUR, DEGREE_PER_ROOT_HOUR, MILLI_G, STANDARD_GRAVITY_M_S2};
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_physics::dynamics::estimate::{Estimate, slope};
use proofmass_scenario::navigation::closed_form::Process;
use proofmass_scenario::navigation::dead_reckoning::Drift;

const TILT_BIAS_RAD: f64 = 0.2 * DEGREE;
/// White noise of the accelerometer in figure 2 (a density of 200 µg/√Hz), two-sided, m/s/√s.
const VELOCITY_WALK_M_S_RTS: f64 = 1.4e-3;
/// Angle random walk of figure 3.
pub(crate) const ANGLE_WALK_RAD_RTS: f64 = 3.0 * DEGREE_PER_ROOT_HOUR;
/// Angle random walk of figure 4: small, so that the biases show.
const QUIET_WALK_RAD_RTS: f64 = 0.03 * DEGREE_PER_ROOT_HOUR;
/// Standard deviation of the accelerometer's bias in figure 4.
const ACCELEROMETER_BIAS_M_S2: f64 = MILLI_G;
/// Standard deviation of the gyro's bias in figure 4.
const GYRO_BIAS_RAD_S: f64 = 10.0 * DEGREE_PER_HOUR;

const MEMBERS: u64 = 2000;
const STEP_S: f64 = 0.1;

/// Curves and checks of figures 2 to 4.
#[derive(Debug, Clone)]
pub struct Growth {
    /// Figure 2: time, roll by a true and by a biased sensor, rad.
    pub rolls: Vec<(f64, f64, f64)>,
    /// Figure 2: distance error over 10 s, m.
    pub tilted: Envelope,
    /// Figure 3: some walks, as (x, y) in rad.
    pub walks: Vec<Vec<(f64, f64)>>,
    /// Figure 3: time, root mean square distance from the start, rad.
    pub rms: Vec<(f64, f64)>,
    /// Figure 4: distance error from the accelerometer's bias and noise alone, m.
    pub quadratic: Envelope,
    /// Figure 4: distance error from the gyro's bias and noise alone, m.
    pub cubic: Envelope,
    /// Figure 4: where the two spreads cross, s.
    pub crossing_s: f64,
    /// Figures 2, 3, 4.
    pub exhibits: [Exhibit; 3],
}

fn normals(member: u64, stream: Stream) -> impl FnMut() -> f64 {
    let mut random = Philox::new(2, member, stream);
    move || random.normal()
}

/// Distance errors of an ensemble, sampled every `every` steps. `draw` gives a member its constant
/// errors.
fn drift(duration_s: f64, every: u32, draw: impl Fn(u64) -> (f64, f64) + Sync, white: (f64, f64)) -> Envelope {
    let steps = (duration_s / STEP_S).round() as u32;
    let scale = 1.0 / STEP_S.sqrt();
    let members: Vec<Vec<f64>> = parallel::map_members(0..MEMBERS, |m| {
        let (acceleration, rate) = draw(m);
        let (mut a, mut g) = (normals(m, Stream::AccelerometerWhite), normals(m, Stream::GyroWhite));
        let mut drift = Drift::default();
        let mut path = Vec::new();
        for step in 1..=steps {
            let acceleration = acceleration + white.0 * scale * a();
            drift.step(acceleration, rate + white.1 * scale * g(), STANDARD_GRAVITY_M_S2, STEP_S);
            if step % every == 0 {
                path.push(drift.distance_m);
            }
        }
        path
    });
    let time_s = (1..=steps / every).map(|i| f64::from(i * every) * STEP_S).collect();
    Envelope::of(time_s, &members)
}

/// Computes all three figures.
pub fn compute() -> Growth {
    let leak = STANDARD_GRAVITY_M_S2 * TILT_BIAS_RAD.sin();
    let tilted = drift(10.0, 1, |_| (leak, 0.0), (VELOCITY_WALK_M_S_RTS, 0.0));
    let mut noise = normals(0, Stream::Host);
    let rolls: Vec<(f64, f64, f64)> = (0..=1000)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            let roll = 2.0 * DEGREE * (0.6 * t).sin() + 0.5 * DEGREE * (1.7 * t).sin();
            // Each sensor adds 0.02° of its own noise.
            (t, roll + 0.02 * DEGREE * noise(), roll + TILT_BIAS_RAD + 0.02 * DEGREE * noise())
        })
        .collect();
    let (walks, rms, last) = walk();
    let bias = |m, stream, sd| sd * normals(m, stream)();
    let (accelerometer, gyro) = (Stream::Tolerance, Stream::Host);
    let quadratic =
        drift(300.0, 20, |m| (bias(m, accelerometer, ACCELEROMETER_BIAS_M_S2), 0.0), (VELOCITY_WALK_M_S_RTS, 0.0));
    let cubic = drift(300.0, 20, |m| (0.0, bias(m + 1, gyro, GYRO_BIAS_RAD_S)), (0.0, QUIET_WALK_RAD_RTS));
    let crossing_s = crossing(&quadratic, &cubic);
    let exhibits = [
        Exhibit::simulated(2, "A tilt of 0.2° becomes metres", figure_2_checks(&rolls, leak, &tilted)),
        Exhibit::simulated(3, "White rate noise becomes a walk of the angle", figure_3_checks(&rms, &last)),
        Exhibit::simulated(
            4,
            "Distance errors that grow as t² and as t³",
            figure_4_checks(&quadratic, &cubic, crossing_s),
        ),
    ];
    Growth { rolls, tilted, walks, rms, quadratic, cubic, crossing_s, exhibits }
}

/// Points (x, y), or (time, value).
type Walk = Vec<(f64, f64)>;

/// Some walks, the RMS distance of all, and where all end.
fn walk() -> (Vec<Walk>, Walk, Walk) {
    let sigma = ANGLE_WALK_RAD_RTS * STEP_S.sqrt();
    let all: Vec<Walk> = parallel::map_members(0..MEMBERS, |m| {
        let (mut x, mut y) = (normals(m, Stream::GyroWhite), normals(m, Stream::GyroWalk));
        let mut at = (0.0, 0.0);
        let step = |_| {
            at = (at.0 + sigma * x(), at.1 + sigma * y());
            at
        };
        (0..1000).map(step).collect()
    });
    let rms = |i: usize| (all.iter().map(|w| w[i].0.powi(2) + w[i].1.powi(2)).sum::<f64>() / all.len() as f64).sqrt();
    let curve = (0..1000).map(|i| ((i + 1) as f64 * STEP_S, rms(i))).collect();
    let last = all.iter().map(|w| w[999]).collect();
    (all.into_iter().take(5).collect(), curve, last)
}

/// The time at which two spreads are equal, by interpolation of their logarithms; NaN where they
/// never are.
fn crossing(first: &Envelope, second: &Envelope) -> f64 {
    let gap: Vec<f64> = first.sd.iter().zip(&second.sd).map(|(a, b)| (a / b).ln()).collect();
    let crossed = gap.windows(2).position(|w| w[0] > 0.0 && w[1] <= 0.0);
    crossed.map_or(f64::NAN, |i| {
        let part = gap[i] / (gap[i] - gap[i + 1]);
        first.time_s[i] * (first.time_s[i + 1] / first.time_s[i]).powf(part)
    })
}

fn figure_2_checks(rolls: &[(f64, f64, f64)], leak: f64, tilted: &Envelope) -> Vec<Check> {
    let apart = Estimate::of_mean(&rolls.iter().map(|r| (r.2 - r.1) / DEGREE).collect::<Vec<_>>());
    let distance = tilted.mean.last().copied().unwrap_or(f64::NAN);
    let error = tilted.sd.last().map_or(f64::NAN, |s| s / (MEMBERS as f64).sqrt());
    vec![
        Check::near(
            "difference of the two rolls / °",
            "the bias put in, 0.2°; four standard errors",
            0.2,
            apart.value,
            4.0 * apart.standard_error,
        ),
        Check::near(
            "gravity that a tilt of 0.2° lets in / (m/s²)",
            "the paper: 0.034 m/s², as rounded",
            0.034,
            leak,
            5e-4,
        ),
        Check::near("distance error after 10 s / m", "the paper: 1.7 m, as rounded", 1.7, distance, 0.05),
        Check::near(
            "distance error after 10 s, mean of the ensemble with noise / m",
            "½ g sin(0.2°) t²; four standard errors",
            0.5 * leak * 100.0,
            distance,
            4.0 * error,
        ),
    ]
}

fn figure_3_checks(rms: &[(f64, f64)], last: &[(f64, f64)]) -> Vec<Check> {
    let n = last.len() as f64;
    let square = |pick: fn(&(f64, f64)) -> f64| last.iter().map(|p| pick(p).powi(2)).sum::<f64>() / n;
    let (xx, yy) = (square(|p| p.0), square(|p| p.1));
    let xy = last.iter().map(|p| p.0 * p.1).sum::<f64>() / n;
    // Direction of the end points: the length of their mean unit vector.
    let (c, s) = last.iter().fold((0.0, 0.0), |a, p| (a.0 + p.0 / p.0.hypot(p.1), a.1 + p.1 / p.0.hypot(p.1)));
    let law: Vec<(f64, f64)> = rms.iter().step_by(9).skip(1).map(|p| (p.0.ln(), p.1.ln())).collect();
    let (end_s, end) = rms.last().copied().unwrap_or((f64::NAN, f64::NAN));
    vec![
        Check::near(
            "exponent of the RMS distance in time",
            "½: a walk of independent steps; four times the wander of the fit in 2000 members",
            0.5,
            slope(&law).value,
            0.03,
        ),
        Check::near(
            "RMS distance after 100 s over its law",
            "N√(2t) for two axes of angle random walk N; four standard errors of 2000 members",
            1.0,
            end / (ANGLE_WALK_RAD_RTS * (2.0 * end_s).sqrt()),
            4.0 / (4.0 * n).sqrt(),
        ),
        Check::near(
            "isotropy: logarithm of the ratio of both axes' variances",
            "0: equal axes; four standard errors of 2/√n",
            0.0,
            (xx / yy).ln(),
            8.0 / n.sqrt(),
        ),
        Check::near(
            "isotropy: correlation of the axes",
            "0: independent axes; four standard errors of 1/√n",
            0.0,
            xy / (xx * yy).sqrt(),
            4.0 / n.sqrt(),
        ),
        Check::near(
            "isotropy: length of the mean direction",
            "0: no direction preferred; exceeded by chance once in 10,000 (Rayleigh test)",
            0.0,
            c.hypot(s) / n,
            (1e4f64.ln() / n).sqrt(),
        ),
    ]
}

fn figure_4_checks(quadratic: &Envelope, cubic: &Envelope, crossing_s: f64) -> Vec<Check> {
    let exponent = |e: &Envelope| {
        let late = e.time_s.iter().zip(&e.sd).filter(|(t, _)| **t >= 30.0);
        slope(&late.map(|(t, s)| (t.ln(), s.ln())).collect::<Vec<_>>()).value
    };
    let end_s = 300.0;
    let end = |e: &Envelope| e.sd.last().copied().unwrap_or(f64::NAN);
    // Bias and white noise together, by the closed forms of the drift study.
    let law = |bias: f64, white: f64, integrations: u32| {
        let constant = bias * bias * Process::Constant(1.0).variance(integrations, end_s);
        (constant + Process::White(white).variance(integrations, end_s)).sqrt()
    };
    let accelerometer = law(ACCELEROMETER_BIAS_M_S2, VELOCITY_WALK_M_S_RTS, 2);
    let gyro = STANDARD_GRAVITY_M_S2 * law(GYRO_BIAS_RAD_S, QUIET_WALK_RAD_RTS, 3);
    // Four standard errors of a standard deviation.
    let band = 4.0 / (2.0 * MEMBERS as f64).sqrt();
    vec![
        Check::near(
            "exponent of the accelerometer's part",
            "2: a constant integrated twice; the white noise beside it bends the curve by less than 0.02",
            2.0,
            exponent(quadratic),
            0.02,
        ),
        Check::near(
            "exponent of the gyro's part",
            "3: a constant rate becomes tilt, tilt lets gravity in, and that is integrated twice",
            3.0,
            exponent(cubic),
            0.02,
        ),
        Check::near(
            "accelerometer's part: spread after 300 s over its closed form",
            "√((½σt²)² + N²t³/3); four standard errors of 2000 members",
            1.0,
            end(quadratic) / accelerometer,
            band,
        ),
        Check::near(
            "gyro's part: spread after 300 s over its closed form",
            "g√((σt³/6)² + N²t⁵/20); four standard errors of 2000 members",
            1.0,
            end(cubic) / gyro,
            band,
        ),
        Check::near(
            "time at which the gyro's part overtakes / s",
            "3σ_a/(gσ_g), where ½σ_a t² = gσ_g t³/6; four standard errors of the ratio of two spreads",
            3.0 * ACCELEROMETER_BIAS_M_S2 / (STANDARD_GRAVITY_M_S2 * GYRO_BIAS_RAD_S),
            crossing_s,
            4.0 / (MEMBERS as f64).sqrt() * 62.0,
        ),
    ]
}
