//! Computes how fast an error grows, exactly: the standard deviation of an error process after n
//! integrations over time.
//!
//! Acceleration reaches position after two integrations; a gyro's rate error reaches tilt after one
//! and, through gravity, position after three. A flat, non-rotating Earth: valid for minutes, far
//! below the Schuler period of 84.4 min. Sources: Woodman, *An introduction to inertial
//! navigation*, UCAM-CL-TR-696 (2007), §6; Titterton & Weston, *Strapdown Inertial Navigation
//! Technology*, 2nd ed., §12; the held process is summed here from its covariance.
//!
//! After a still start of T seconds the mean error ē over those seconds is subtracted. With t
//! counted from its end, n integrations give ∫₀ᵗ (t−u)^(n−1)/(n−1)! e(u) du − ē tⁿ/n!, so that
//!
//! - a constant leaves nothing;
//! - white noise N leaves N²/T in ē, independent of what follows: n = 2 gives N² (t³/3 + t⁴/4T);
//! - a random walk K, whose increments before and after the end are independent, leaves K² T/3 in
//!   e(0) − ē: n = 2 gives K² (t⁵/20 + t⁴ T/12);
//! - a held process is correlated across the end: its values are summed with their weights before
//!   and after it.

use super::slow;

/// An error process in the unit of what is integrated (m/s², rad/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Process {
    /// A constant of this standard deviation over members, unit.
    Constant(f64),
    /// White noise with random-walk coefficient N, unit·√s (two-sided).
    White(f64),
    /// A Gauss–Markov sequence from its stationary law: a value is held, then keeps e⁻¹ of itself
    /// at each renewal.
    Held {
        /// Standard deviation, unit.
        sigma: f64,
        /// First renewal, s.
        first_s: f64,
        /// Time between renewals, which is also the correlation time, s.
        hold_s: f64,
    },
    /// Random walk with coefficient K, unit/√s, from zero.
    Walk(f64),
    /// A first-order Gauss–Markov process from its stationary law.
    Markov {
        /// Standard deviation, unit.
        sigma: f64,
        /// Correlation time, s.
        tau_s: f64,
    },
    /// A sine with a phase drawn around the circle.
    Sine {
        /// Amplitude, unit.
        amplitude: f64,
        /// Frequency, rad/s.
        omega_rad_s: f64,
    },
}

impl Process {
    /// Mean square at `time_s` after `integrations` from rest.
    /// White noise itself has no variance in continuous time: zero integrations give infinity.
    pub fn variance(self, integrations: u32, time_s: f64) -> f64 {
        let n = f64::from(integrations);
        match self {
            Self::Constant(value) => (value * time_s.powi(integrations as i32) / factorial(integrations)).powi(2),
            Self::White(density) if integrations == 0 => density * density * f64::INFINITY,
            // ∫₀ᵗ ((t−u)^(n−1)/(n−1)!)² du
            Self::White(density) => {
                density.powi(2) * time_s.powf(2.0 * n - 1.0) / ((2.0 * n - 1.0) * factorial(integrations - 1).powi(2))
            }
            Self::Walk(density) => Self::White(density).variance(integrations + 1, time_s),
            Self::Markov { sigma, tau_s } => sigma * sigma * slow::markov(tau_s, integrations, time_s),
            Self::Sine { amplitude, omega_rad_s } => {
                amplitude * amplitude * slow::sine(omega_rad_s, 0.0, integrations, time_s)
            }
            Self::Held { sigma, .. } if integrations == 0 => sigma * sigma,
            Self::Held { sigma, first_s, hold_s } => {
                let held = Held { first_s, hold_s };
                sigma * sigma * held.square_of_sum(0.0, integrations, time_s)
            }
        }
    }

    /// Mean square at `time_s` from the end of a still start of `still_s`, over which the process'
    /// mean is subtracted, after `integrations`. Without a still start (0 s) as
    /// [`Process::variance`].
    pub fn variance_after_still_start(self, still_s: f64, integrations: u32, time_s: f64) -> f64 {
        match self {
            _ if still_s <= 0.0 => self.variance(integrations, time_s),
            Self::Constant(_) => 0.0,
            Self::Markov { sigma, tau_s } => {
                sigma * sigma * slow::markov_after_still_start(tau_s, still_s, integrations, time_s)
            }
            Self::Sine { amplitude, omega_rad_s } => {
                amplitude * amplitude * slow::sine(omega_rad_s, still_s, integrations, time_s)
            }
            Self::White(_) | Self::Walk(_) => {
                self.variance(integrations, time_s)
                    + self.bias_left(still_s) * Self::Constant(1.0).variance(integrations, time_s)
            }
            Self::Held { sigma, first_s, hold_s } => {
                let held = Held { first_s, hold_s };
                sigma * sigma * held.square_of_sum(still_s, integrations, time_s)
            }
        }
    }

    /// Variance of the constant error that a still start of `still_s` leaves from its end on: what
    /// its mean misses of the process. Zero for one that forgets or comes back, whose error is none that
    /// stays.
    pub fn bias_left(self, still_s: f64) -> f64 {
        match self {
            _ if still_s <= 0.0 => 0.0,
            Self::Constant(_) | Self::Held { .. } | Self::Markov { .. } | Self::Sine { .. } => 0.0,
            Self::White(density) => density * density / still_s,
            Self::Walk(density) => density * density * still_s / 3.0,
        }
    }

    /// Mean square of the process' mean over its first `over_s`: what levelling takes for tilt.
    pub fn variance_of_mean(self, over_s: f64) -> f64 {
        self.variance(1, over_s) / (over_s * over_s)
    }
}

/// When the values of a held process change.
#[derive(Clone, Copy)]
struct Held {
    first_s: f64,
    hold_s: f64,
}

impl Held {
    /// Mean square, for unit values, of the sum that `integrations` until `time_s` after a still
    /// start make of them: each value counts with ∫ (t−u)^(n−1)/(n−1)! du over the time it is held
    /// after the end of the still start, less its share of the mean times tⁿ/n!.
    fn square_of_sum(self, still_s: f64, integrations: u32, time_s: f64) -> f64 {
        let power = |t: f64| t.powi(integrations as i32) / factorial(integrations);
        let (end, whole) = (still_s + time_s, power(time_s));
        // What is still to come after a time, and of the mean before it. Without integration, the
        // value held at the end.
        let remaining = |at: f64| match integrations {
            0 => f64::from(u8::from(at < end * (1.0 - 1e-12))),
            _ => power((end - at.max(still_s)).max(0.0)),
        };
        let before = |at: f64| if still_s > 0.0 { at.min(still_s) / still_s } else { 0.0 };
        let (mut sum, mut carried, mut from, mut until) = (0.0, 0.0, 0.0, self.first_s);
        while from < end {
            let weight = remaining(from) - remaining(until) - whole * (before(until) - before(from));
            sum += weight * (weight + 2.0 * carried);
            carried = (carried + weight) * (-1.0f64).exp();
            (from, until) = (until, until + self.hold_s);
        }
        sum
    }
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_textbook_powers_come_out() {
        let (t, g) = (7.0f64, 9.81);
        let position = |p: Process| p.variance(2, t).sqrt();
        let through_tilt = |p: Process| g * p.variance(3, t).sqrt();
        for (got, want) in [
            (position(Process::Constant(0.2)), 0.5 * 0.2 * t * t),
            (position(Process::White(0.2)), 0.2 * t.powf(1.5) / 3f64.sqrt()),
            (position(Process::Walk(0.2)), 0.2 * t.powf(2.5) / 20f64.sqrt()),
            (through_tilt(Process::Constant(0.2)), g * 0.2 * t.powi(3) / 6.0),
            (through_tilt(Process::White(0.2)), g * 0.2 * t.powf(2.5) / 20f64.sqrt()),
            (through_tilt(Process::Walk(0.2)), g * 0.2 * t.powf(3.5) / 252f64.sqrt()),
        ] {
            assert!((got / want - 1.0).abs() < 1e-12, "{got} {want}");
        }
    }

    #[test]
    fn the_papers_example_is_1_7_m_after_10_s() {
        // Section II.A: "a linear acceleration error of 0.034 m/s² … after 10 seconds … will be 1.7
        // m".
        assert!((Process::Constant(0.034).variance(2, 10.0).sqrt() - 1.7).abs() < 1e-12);
        // "0.2 degrees" of tilt: g sin 0.2° = 0.0342.
        let tilt: f64 = 9.81 * 0.2f64.to_radians().sin();
        assert!((tilt - 0.034).abs() < 3e-4);
    }

    #[test]
    fn a_held_process_lies_between_white_noise_and_a_constant() {
        for n in 1..=3 {
            let fast = Process::Held { sigma: 2.0, first_s: 1e-4, hold_s: 1e-4 }.variance(n, 10.0);
            // White limit: N² = σ² × hold × (1 + 2Σe⁻ᵏ) = σ² × hold × coth ½.
            let white = Process::White(2.0 * (1e-4 / 0.5f64.tanh()).sqrt()).variance(n, 10.0);
            assert!((fast / white - 1.0).abs() < 1e-4, "n = {n}: {fast} {white}");
            let slow = Process::Held { sigma: 2.0, first_s: 11.0, hold_s: 22.0 }.variance(n, 10.0);
            assert!((slow / Process::Constant(2.0).variance(n, 10.0) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_still_start_leaves_what_its_mean_misses() {
        let (t, still) = (7.0f64, 3.0f64);
        let position = |p: Process| p.variance_after_still_start(still, 2, t);
        assert_eq!(position(Process::Constant(0.2)), 0.0);
        for (got, want) in [
            (position(Process::White(0.2)), 0.04 * (t.powi(3) / 3.0 + t.powi(4) / (4.0 * still))),
            (position(Process::Walk(0.2)), 0.04 * (t.powi(5) / 20.0 + t.powi(4) * still / 12.0)),
            (Process::White(0.2).variance_of_mean(still), 0.04 / still),
            (Process::Walk(0.2).variance_of_mean(still), 0.04 * still / 3.0),
        ] {
            assert!((got / want - 1.0).abs() < 1e-12, "{got} {want}");
        }
        for n in 1..=3 {
            // A value held over both is a constant; one that changes fast is white.
            let slow = Process::Held { sigma: 2.0, first_s: 11.0, hold_s: 22.0 };
            assert!(slow.variance_after_still_start(still, n, t) < 1e-18);
            let fast =
                Process::Held { sigma: 2.0, first_s: 1e-4, hold_s: 1e-4 }.variance_after_still_start(still, n, t);
            let white = Process::White(2.0 * (1e-4 / 0.5f64.tanh()).sqrt()).variance_after_still_start(still, n, t);
            assert!((fast / white - 1.0).abs() < 1e-3, "n = {n}: {fast} {white}");
        }
    }

    #[test]
    fn a_double_sum_over_the_covariance_agrees() {
        // Direct quadrature of ∬ h(p) h(q) R(p, q), p and q counted back from the end; h = p (two
        // integrations), p²/2 (three).
        let (sigma, first_s, hold_s, t, m) = (1.3, 0.5, 1.0, 6.0, 600);
        let mid = |k: usize| (k as f64 + 0.5) * t / m as f64;
        let segment = |p: f64| ((t - p - first_s) / hold_s).floor();
        for (n, h) in [(2u32, (|p| p) as fn(f64) -> f64), (3, |p| 0.5 * p * p)] {
            let square = |weight: &dyn Fn(f64) -> f64| {
                let weights: Vec<(f64, f64)> = (0..m).map(|k| (weight(mid(k)), segment(mid(k)))).collect();
                let pair = |a: &(f64, f64)| {
                    weights.iter().map(|b| a.0 * b.0 * sigma * sigma * (-(a.1 - b.1).abs()).exp()).sum::<f64>()
                };
                weights.iter().map(pair).sum::<f64>() * (t / m as f64).powi(2)
            };
            let held = Process::Held { sigma, first_s, hold_s };
            let (got, sum) = (held.variance(n, t), square(&h));
            assert!((got / sum - 1.0).abs() < 1e-3, "n = {n}: {got} {sum}");
            // The first 2 s are a still start: their mean is taken off what 4 s make of it.
            let (still, after) = (2.0, t - 2.0);
            let weight = |p: f64| if p < after { h(p) } else { -h(after) * after / f64::from(n) / still };
            let (got, sum) = (held.variance_after_still_start(still, n, after), square(&weight));
            assert!((got / sum - 1.0).abs() < 1e-3, "n = {n}, still start: {got} {sum}");
        }
    }
}
