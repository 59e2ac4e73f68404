//! Factors of an error over time: the motion and the temperature that all members share, and laws
//! of time that are the same in every study.

use crate::excitation::Waveform;
use crate::navigation::closed_form::Process;
use crate::navigation::slow;
use crate::study::Study;
use crate::units::STANDARD_GRAVITY_M_S2;

/// Factor over time that all members share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// The specific force.
    Force,
    /// Its square.
    Square,
    /// Says how much warmer than its reference the sensor is, less what a still start takes off.
    Warmer,
    /// That times the specific force.
    WarmerForce,
    /// The square of how much warmer it is, less what a still start takes off.
    WarmerSquare,
    /// The same of the cube.
    WarmerCube,
}

impl Course {
    /// The power of how much warmer the sensor is, where it is one alone.
    pub(super) fn power_of_kelvins(self) -> Option<i32> {
        match self {
            Self::Warmer => Some(1),
            Self::WarmerSquare => Some(2),
            Self::WarmerCube => Some(3),
            Self::Force | Self::Square | Self::WarmerForce => None,
        }
    }
}

/// Number of them.
const COURSES: usize = 6;

/// A course at a time, and its integrals up to there.
#[derive(Clone, Copy)]
pub(super) struct Integrals {
    now: f64,
    once: f64,
    twice: f64,
    three_times: f64,
}

impl Integrals {
    /// Position, velocity and acceleration of an accelerometer's error, and no tilt.
    pub(super) fn direct(self) -> [f64; 4] {
        [self.twice, self.once, self.now, 0.0]
    }

    /// The same of a gyro's: tilt is its integral, and gravity makes an acceleration of that.
    pub(super) fn through_tilt(self) -> [f64; 4] {
        let g = STANDARD_GRAVITY_M_S2;
        [g * self.three_times, g * self.twice, g * self.once, self.once]
    }
}

/// Integrals of the courses.
#[derive(Default)]
pub(super) struct CourseIntegrals {
    /// Per course, per time.
    pub integrals: [Vec<Integrals>; COURSES],
    /// Says how much warmer the sensor is during a still start, K; 0 without one.
    pub taken_k: f64,
}

impl CourseIntegrals {
    /// By the trapezoidal rule on the integration steps, or on ten million of them where there are
    /// more.
    pub(super) fn of(study: &Study, time_s: &[f64]) -> Self {
        let waveform: &dyn Waveform = study.excitation.waveform.as_ref();
        let warmer_k = |t: f64| study.temperature.above_reference_k(t);
        let taken_k = if study.still_s() > 0.0 { warmer_k(0.0) } else { 0.0 };
        let mut integrals = [const { Vec::new() }; COURSES];
        let steps = (study.duration_s() / study.clock.step_s).min(1e7);
        let step_s = study.duration_s() / steps;
        let course = |t: f64| {
            let (f, warmer) = (waveform.specific_force_m_s2(t), warmer_k(t));
            let power = |n: i32| warmer.powi(n) - taken_k.powi(n);
            [f, f * f, power(1), warmer * f, power(2), power(3)]
        };
        let none = [0.0; COURSES];
        let (mut velocity, mut position, mut area, mut now_s) = (none, none, none, 0.0);
        let mut before = course(0.0);
        for time_s in time_s {
            let parts = ((time_s - now_s) / step_s).round().max(1.0);
            let h = (time_s - now_s) / parts;
            for part in 1..=parts as u64 {
                let after = course(now_s + h * part as f64);
                for p in 0..COURSES {
                    // Exact for one that is linear over the step.
                    let third = h * h * h * (before[p] / 8.0 + after[p] / 24.0);
                    area[p] += h * position[p] + 0.5 * h * h * velocity[p] + third;
                    position[p] += h * velocity[p] + h * h * (before[p] / 3.0 + after[p] / 6.0);
                    velocity[p] += 0.5 * h * (before[p] + after[p]);
                }
                before = after;
            }
            now_s = *time_s;
            for p in 0..COURSES {
                let (once, twice, three_times) = (velocity[p], position[p], area[p]);
                integrals[p].push(Integrals { now: before[p], once, twice, three_times });
            }
        }
        Self { integrals, taken_k }
    }
}

/// A course that the same closed form holds for in every study.
#[derive(Clone, Copy)]
pub(super) enum Known {
    /// A constant that has been integrated so often since the beginning of the run.
    Power(u32),
    /// It dies out from the beginning of the run on with this time constant, s.
    Settling(f64),
}

impl Known {
    pub(super) fn grown(self, still_s: f64, n: u32, time_s: f64) -> f64 {
        match self {
            Self::Power(integrals) => grown(integrals, still_s, n, time_s),
            Self::Settling(tau_s) => slow::settled_after_still_start(tau_s, still_s, n, time_s),
        }
    }

    pub(super) fn mean_of_still_start(self, still_s: f64) -> f64 {
        match self {
            Self::Power(integrals) => mean_of_still_start(integrals, still_s),
            Self::Settling(tau_s) => slow::mean_settling(tau_s, still_s),
        }
    }
}

fn power(n: u32, time_s: f64) -> f64 {
    Process::Constant(1.0).variance(n, time_s).sqrt()
}

/// A constant 1 that has been integrated `integrals` times since the beginning of the run, after
/// `n` more from the end of the still start, which has taken off its mean: (T + t)ᵏ/k! less that
/// mean, by powers of t.
fn grown(integrals: u32, still_s: f64, n: u32, time_s: f64) -> f64 {
    if still_s == 0.0 {
        return power(n + integrals, time_s);
    }
    let whole: f64 = (0..=integrals).map(|i| power(integrals - i, still_s) * power(i + n, time_s)).sum();
    whole - mean_of_still_start(integrals, still_s) * power(n, time_s)
}

/// Its mean over the still start.
fn mean_of_still_start(integrals: u32, still_s: f64) -> f64 {
    power(integrals, still_s) / f64::from(integrals + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp from the beginning of a still start of T is T/2 + t from its end on, less what it was
    /// in the mean.
    #[test]
    fn a_ramp_after_a_still_start_is_what_the_start_has_not_taken_off() {
        let (still_s, t) = (10.0, 7.0f64);
        for (n, want) in [(0, 5.0 + t), (1, 5.0 * t + t * t / 2.0), (2, 2.5 * t * t + t.powi(3) / 6.0)] {
            assert!((grown(1, still_s, n, t) / want - 1.0).abs() < 1e-12, "{n}");
            // Without a start it is the ramp alone; a constant is taken off whole.
            assert!((grown(1, 0.0, n, t) / power(n + 1, t) - 1.0).abs() < 1e-12);
            assert_eq!(grown(0, still_s, n, t), 0.0);
        }
        assert_eq!((mean_of_still_start(0, still_s), mean_of_still_start(1, still_s)), (1.0, 5.0));
    }
}
