//! How fast an error grows, exactly: the standard deviation of an error process after n integrations over time.
//!
//! Acceleration reaches position after two integrations; a gyro's rate error reaches tilt after one and, through
//! gravity, position after three. A flat, non-rotating Earth: valid for minutes, far below the Schuler period of 84.4 min.
//! Sources: Woodman, *An introduction to inertial navigation*, UCAM-CL-TR-696 (2007), §6; Titterton & Weston,
//! *Strapdown Inertial Navigation Technology*, 2nd ed., §12; the held process is summed here from its covariance.

/// An error process in the unit of what is integrated (m/s², rad/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Process {
    /// A constant.
    Constant(f64),
    /// White noise with random-walk coefficient N, unit·√s (two-sided).
    White(f64),
    /// A Gauss–Markov sequence from its stationary law: a value is held, then keeps e⁻¹ of itself at each renewal.
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
            Self::Held { sigma, .. } if integrations == 0 => sigma * sigma,
            Self::Held { sigma, first_s, hold_s } => {
                // Sum of correlated steps: each value counts with ∫ (t−u)^(n−1)/(n−1)! du over the time it is held.
                let left = |from: f64| (time_s - from).max(0.0).powi(integrations as i32) / factorial(integrations);
                let (mut sum, mut carried, mut from) = (0.0, 0.0, 0.0);
                let mut until = first_s;
                while from < time_s {
                    let weight = left(from) - left(until);
                    sum += weight * (weight + 2.0 * carried);
                    carried = (carried + weight) * (-1.0f64).exp();
                    (from, until) = (until, until + hold_s);
                }
                sigma * sigma * sum
            }
        }
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
        // Section II.A: "a linear acceleration error of 0.034 m/s² … after 10 seconds … will be 1.7 m".
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
    fn a_double_sum_over_the_covariance_agrees() {
        // Direct quadrature of ∬ h(p) h(q) R(p, q), p and q counted back from the end; h = p (two integrations), p²/2 (three).
        let (sigma, first_s, hold_s, t, m) = (1.3, 0.5, 1.0, 6.0, 600);
        let mid = |k: usize| (k as f64 + 0.5) * t / m as f64;
        let segment = |p: f64| ((t - p - first_s) / hold_s).floor();
        for (n, h) in [(2u32, (|p| p) as fn(f64) -> f64), (3, |p| 0.5 * p * p)] {
            let sum: f64 = (0..m)
                .flat_map(|i| (0..m).map(move |j| (mid(i), mid(j))))
                .map(|(p, q)| h(p) * h(q) * sigma * sigma * (-(segment(p) - segment(q)).abs()).exp())
                .sum::<f64>()
                * (t / m as f64).powi(2);
            let got = Process::Held { sigma, first_s, hold_s }.variance(n, t);
            assert!((got / sum - 1.0).abs() < 1e-3, "n = {n}: {got} {sum}");
        }
    }
}
