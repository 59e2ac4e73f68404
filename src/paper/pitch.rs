//! Figures 5 to 10: pitch from the accelerometer (eq. 3) and pitch from the integrated gyro, moving
//! and still.
//!
//! Not fusion: the two stand side by side here, see `fusion`.

use super::check::{Check, Exhibit};
use super::inertial::{Inertial, PRINTED_GYRO_DENSITY};
use proofmass_base::units::{DEGREE, DENSITY_TO_RANDOM_WALK};
use proofmass_numerics::numerics::allan;
use proofmass_numerics::numerics::allan::fit::fit;
use proofmass_numerics::numerics::allan::fitted::Coefficient;
use proofmass_numerics::numerics::moments::{self, mean_sd, rms};
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_physics::dynamics::estimate::{Estimate, slope};
use proofmass_scenario::navigation::tilt::{Vector, mean, norm, pitch_rad, pitch_rate_rad_s, turn};

/// Time against a value.
pub(crate) type Curve = Vec<(f64, f64)>;

/// Curves and checks of figures 5 to 10. Angles in rad.
#[derive(Debug, Clone)]
pub struct Pitch {
    /// Words on where the readings come from.
    pub origin: String,
    /// Moving: pitch by the accelerometer.
    pub moving_force: Curve,
    /// Moving: pitch by the gyro, starting anew from every still pose.
    pub moving_gyro: Curve,
    /// The one move that is enlarged: from and to, s.
    pub enlarged_s: (f64, f64),
    /// Still: pitch by the accelerometer less its mean.
    pub still_force: Curve,
    /// Still: pitch by the gyro, with the offset that the calibration found over all poses.
    pub still_gyro: Curve,
    /// Still: pitch by the gyro with the still stretch's own mean rate taken off.
    pub still_walk: Curve,
    /// Allan deviation of the still rate: averaging time in s, rad/s.
    pub allan: Curve,
    /// Angle random walk fitted to it, rad/√s.
    pub angle_walk: Coefficient,
    /// Deviation of the accelerometer's pitch at rest with its standard error, rad.
    pub force_deviation: Estimate,
    /// Deviation of the walk over the still stretch, rad; its standard error is the law's.
    pub walk_deviation: Estimate,
    /// Length of a stretch over which both are equally wide, by the law, s.
    pub equal_s: f64,
    /// Figures 5 to 10.
    pub exhibits: [Exhibit; 6],
}

/// One move between two poses.
struct Move {
    force: Vec<f64>,
    gyro: Vec<f64>,
    /// Pitch by the gyro at the end less that of the pose it ended in.
    miss: f64,
}

fn deviation(values: &[f64]) -> f64 {
    mean_sd(values).1
}

/// Root mean square of second differences: what is left of a curve when everything smooth is taken
/// away.
fn roughness(values: &[f64]) -> f64 {
    rms(values.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]))
}

fn autocorrelation(values: &[f64], lag: usize) -> f64 {
    let mean = moments::mean(values);
    let product = |k: usize| values.iter().zip(&values[k..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    product(lag) / product(0)
}

/// "Up" in the sensor's frame, from the mean force of a still pose.
pub(crate) fn up(imu: &Inertial, pose: usize) -> Vector {
    let force = mean(&imu.force_m_s2[imu.poses[pose].clone()]);
    force.map(|f| f / norm(force))
}

fn moves(imu: &Inertial) -> Vec<Move> {
    let between = |k: usize| imu.poses[k].end..imu.poses[k + 1].start;
    (0..imu.poses.len().saturating_sub(1))
        .map(|k| {
            let mut direction = up(imu, k);
            let gyro = between(k).map(|i| {
                direction = turn(direction, imu.rate_rad_s[i], imu.step_s);
                pitch_rad(direction)
            });
            let gyro: Vec<f64> = gyro.collect();
            let force = between(k).map(|i| pitch_rad(imu.force_m_s2[i])).collect();
            let miss = gyro.last().map_or(0.0, |g| g - pitch_rad(up(imu, k + 1)));
            Move { force, gyro, miss }
        })
        .collect()
}

/// Computes all six figures. The readings must hold at least three poses.
pub fn compute(imu: &Inertial) -> Pitch {
    let moves = moves(imu);
    let apart = |m: &Move| rms(m.force.iter().zip(&m.gyro).map(|(f, g)| f - g));
    // The move on which both disagree most, away from the recording's ends, with two poses on
    // either side.
    let inner = 1..moves.len().saturating_sub(2).max(2);
    let worst = inner.max_by(|a, b| apart(&moves[*a]).total_cmp(&apart(&moves[*b]))).unwrap_or(1);
    let shown = imu.poses[worst - 1].end.saturating_sub(100)
        ..(imu.poses[(worst + 2).min(imu.poses.len() - 1)].start + 200).min(imu.force_m_s2.len());
    let seconds = |i: usize| i as f64 * imu.step_s;
    let moving_force = shown.clone().map(|i| (seconds(i), pitch_rad(imu.force_m_s2[i]))).collect();
    let moving_gyro = carried(imu, shown, seconds);
    let enlarged_s = (seconds(imu.poses[worst].end) - 0.5, seconds(imu.poses[worst + 1].start) + 0.5);

    // Half a second off both ends: a pose's edges are where a hand takes hold.
    let margin = (0.5 / imu.step_s) as usize;
    let still = imu.poses[0].start + margin..imu.poses[0].end - margin;
    let direction = up(imu, 0);
    let rates: Vec<f64> = imu.rate_rad_s[still.clone()].iter().map(|r| pitch_rate_rad_s(direction, *r)).collect();
    let force: Vec<f64> = imu.force_m_s2[still].iter().map(|f| pitch_rad(*f)).collect();
    let mean_rate = moments::mean(&rates);
    let integrate = |offset: f64| -> Vec<f64> {
        let mut angle = 0.0;
        let step = |r: &f64| {
            angle += (r - offset) * imu.step_s;
            angle
        };
        rates.iter().map(step).collect()
    };
    let (drifting, walk) = (integrate(0.0), integrate(mean_rate));
    let points = allan::curve(&rates, 1.0 / imu.step_s);
    let mut random = Philox::new(9, 0, Stream::Host);
    let none = Coefficient { value: f64::NAN, ci95: [f64::NAN; 2], p_value: 1.0 };
    let angle_walk = fit(&points, 1.0 / imu.step_s, 0.0, &mut random).map_or(none, |f| f.coefficients[1]);
    let n = angle_walk.value;
    let length_s = rates.len() as f64 * imu.step_s;
    let force_deviation = {
        // Samples that count as independent: fewer where neighbours are alike.
        let rho = autocorrelation(&force, 1).clamp(0.0, 0.99);
        let independent = force.len() as f64 * (1.0 - rho * rho) / (1.0 + rho * rho);
        Estimate { value: deviation(&force), standard_error: deviation(&force) / (2.0 * independent).sqrt() }
    };
    // Watson's statistic has mean 1/12 and variance 1/360; of a root, half the relative error.
    let walk_deviation = Estimate {
        value: deviation(&walk),
        standard_error: 0.5 * n * length_s.sqrt() * (1.0 / 360f64).sqrt() / (1.0 / 12f64).sqrt(),
    };
    let centre = moments::mean(&force);
    let timed = |v: &[f64]| v.iter().enumerate().map(|(i, a)| (seconds(i), *a)).collect::<Curve>();
    let still_force = timed(&force.iter().map(|f| f - centre).collect::<Vec<_>>());
    let case = Case { imu, moves: &moves, worst, force: &force, drifting: &drifting, walk: &walk, n, length_s };
    let titles = [
        "Pitch from the accelerometer while moved by hand",
        "One move enlarged: accelerometer and gyro",
        "Pitch from the gyro alone, at rest",
        "At rest: accelerometer and gyro",
        "The gyro's angle as a random walk",
        "How both pitches are distributed",
    ];
    let checks = [
        case.figure_5_checks(),
        case.figure_6_checks(),
        case.figure_7_checks(),
        case.figure_8_checks(),
        figure_9_checks(&points, &angle_walk),
        case.figure_10_checks(),
    ];
    let mut figure = 4;
    let mut parts = titles.into_iter().zip(checks);
    let exhibits = std::array::from_fn(|_| {
        figure += 1;
        let (title, checks) = parts.next().unwrap_or_default();
        Exhibit { figure, title: title.into(), source: imu.source, checks }
    });
    Pitch {
        origin: imu.origin.clone(),
        moving_force,
        moving_gyro,
        enlarged_s,
        still_force,
        still_gyro: timed(&drifting),
        still_walk: timed(&walk),
        allan: points.iter().map(|p| (p.tau_s, p.variance.sqrt())).collect(),
        angle_walk,
        equal_s: 12.0 * (force_deviation.value / n).powi(2),
        force_deviation,
        walk_deviation,
        exhibits,
    }
}

/// Pitch by the gyro over some samples, taken anew from the accelerometer's mean in every still
/// pose.
fn carried(imu: &Inertial, samples: std::ops::Range<usize>, seconds: impl Fn(usize) -> f64) -> Curve {
    let mut direction = [0.0, 0.0, 1.0];
    let mut curve = Curve::new();
    for i in imu.poses[0].start..samples.end {
        match imu.poses.iter().position(|p| p.contains(&i)) {
            Some(pose) if i == imu.poses[pose].start || i + 1 == imu.poses[pose].end => direction = up(imu, pose),
            _ => direction = turn(direction, imu.rate_rad_s[i], imu.step_s),
        }
        if i >= samples.start {
            curve.push((seconds(i), pitch_rad(direction)));
        }
    }
    curve
}

/// Holds what the checks look at.
struct Case<'a> {
    imu: &'a Inertial,
    moves: &'a [Move],
    worst: usize,
    force: &'a [f64],
    drifting: &'a [f64],
    walk: &'a [f64],
    n: f64,
    length_s: f64,
}

impl Case<'_> {
    fn figure_5_checks(&self) -> Vec<Check> {
        let moving = rms(self.moves.iter().flat_map(|m| m.force.iter().zip(&m.gyro).map(|(f, g)| f - g)));
        let miss = rms(self.moves.iter().map(|m| m.miss)) / DEGREE;
        vec![
            Check::between(
                "disturbance of eq. 3 while moved, over its noise at rest",
                "a hand moves with 0.1 to 10 m/s², which eq. 3 takes for a/g of tilt, 0.6° to 45°; at rest it scatters by \
                 hundredths of a degree",
                5.0,
                1000.0,
                moving / deviation(self.force),
            ),
            Check::near(
                "after a move: pitch carried by the gyro less that of the new pose, RMS over all moves / °",
                "0: the gyro feels no acceleration. Tolerance twice the root of (N√t)² for 5 s in two axes and \
                 (0.1 % of 90°)²",
                0.0,
                miss,
                2.0 * ((self.n / DEGREE).powi(2) * 10.0 + 0.09f64.powi(2)).sqrt(),
            ),
        ]
    }

    fn figure_6_checks(&self) -> Vec<Check> {
        let shown = &self.moves[self.worst];
        let at_rest = roughness(self.force) / (2f64.sqrt() * self.n * self.imu.step_s.sqrt());
        vec![Check::between(
            "roughness of the accelerometer's pitch over the gyro's, within the move",
            "by noise alone the ratio would be that at rest; the hand adds to the accelerometer (and smooth turning to the \
             gyro): from a third of it to thirty times",
            at_rest / 3.0,
            at_rest * 30.0,
            roughness(&shown.force) / roughness(&shown.gyro),
        )]
    }

    fn figure_7_checks(&self) -> Vec<Check> {
        let lag = (1.0 / self.imu.step_s).round() as usize;
        vec![
            Check::between(
                "gyro's pitch: correlation with itself one second later",
                "near 1: an integral changes slowly. A walk over some fifty seconds keeps more than 0.7",
                0.7,
                1.0,
                autocorrelation(self.drifting, lag),
            ),
            Check::near(
                "accelerometer's pitch: correlation with itself one second later",
                "0: no memory; four standard errors 1/√n, and 0.1 for vibration of the table",
                0.0,
                autocorrelation(self.force, lag),
                0.1 + 4.0 / (self.force.len() as f64).sqrt(),
            ),
        ]
    }

    fn figure_8_checks(&self) -> Vec<Check> {
        let half = self.force.len() / 2;
        let batches = |v: &[f64]| {
            let means: Vec<f64> = v.chunks_exact(100).map(moments::mean).collect();
            Estimate::of_mean(&means)
        };
        let (first, second) = (batches(&self.force[..half]), batches(&self.force[half..]));
        let end = self.drifting.last().copied().unwrap_or(f64::NAN);
        vec![
            Check::near(
                "accelerometer's pitch: mean of the second half less that of the first / °",
                "0: it has no drift; four standard errors from batches of one second",
                0.0,
                (second.value - first.value) / DEGREE,
                4.0 * first.standard_error.hypot(second.standard_error) / DEGREE,
            ),
            Check::near(
                "gyro's pitch at the end, in standard deviations of angle random walk",
                "0 ± 4: N√t is what white noise alone makes of it; a bias left by the calibration would add to that",
                0.0,
                end / (self.n * self.length_s.sqrt()),
                4.0,
            ),
        ]
    }

    fn figure_10_checks(&self) -> Vec<Check> {
        let short = (5.0 / self.imu.step_s) as usize;
        let windows = self.force.len() / short;
        // Five seconds at a time, each with its own mean rate taken off, as the whole stretch had.
        let variance = |values: &[f64], level: bool| {
            let parts = values.chunks_exact(short).map(|w| {
                let tilt = if level { (w[short - 1] - w[0]) / (short - 1) as f64 } else { 0.0 };
                deviation(&w.iter().enumerate().map(|(i, v)| v - tilt * i as f64).collect::<Vec<_>>()).powi(2)
            });
            parts.sum::<f64>() / windows as f64
        };
        let ratio = variance(self.walk, true) / variance(self.force, false);
        let law = self.n.powi(2) * 5.0 / 12.0 / deviation(self.force).powi(2);
        vec![
            Check::between(
                "variance of the gyro's pitch over the still stretch, over N²T",
                "Watson's law of a Brownian bridge: mean 1/12, within these ends 998 times in 1000",
                0.018,
                0.385,
                deviation(self.walk).powi(2) / (self.n.powi(2) * self.length_s),
            ),
            Check::near(
                "over 5 s: variance of the gyro's pitch over that of the accelerometer's",
                "N²T/12 over the accelerometer's own; four standard errors √(12²/360/windows) of the mean",
                law,
                ratio,
                4.0 * law * (0.4 / windows as f64).sqrt(),
            ),
        ]
    }
}

fn figure_9_checks(points: &[allan::Point], angle_walk: &Coefficient) -> Vec<Check> {
    let law: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| p.on_octave() && p.tau_s < 2.0)
        .map(|p| (p.tau_s.log10(), 0.5 * p.variance.log10()))
        .collect();
    vec![
        Check::near(
            "slope of the Allan deviation below 2 s",
            "−½: white noise of the rate (IEEE 952); 0.06 for a filter in the sensor and for chance",
            -0.5,
            slope(&law).value,
            0.06,
        ),
        Check::near(
            "angle random walk / (°/√h)",
            "the maker prints a density of 0.05 °/s/√Hz, one-sided: N = 0.05/√2 °/√s; 20 % from unit to unit",
            PRINTED_GYRO_DENSITY * DENSITY_TO_RANDOM_WALK / DEGREE * 60.0,
            angle_walk.value / DEGREE * 60.0,
            0.2 * PRINTED_GYRO_DENSITY * DENSITY_TO_RANDOM_WALK / DEGREE * 60.0,
        ),
    ]
}
