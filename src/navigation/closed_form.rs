//! How fast an error grows, exactly: the standard deviation of an error process after n integrations over time.
//!
//! Acceleration reaches position after two integrations; a gyro's rate error reaches tilt after one and, through
//! gravity, position after three. A flat, non-rotating Earth: valid for minutes, far below the Schuler period of 84.4 min.
//! Sources: Woodman, *An introduction to inertial navigation*, UCAM-CL-TR-696 (2007), §6; Titterton & Weston,
//! *Strapdown Inertial Navigation Technology*, 2nd ed., §12; the Gauss–Markov rows are integrated here from R = σ²e^(−|Δ|/τ).

/// An error process in the unit of what is integrated (m/s², rad/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Process {
    /// A constant.
    Constant(f64),
    /// White noise with random-walk coefficient N, unit·√s (two-sided).
    White(f64),
    /// First-order Gauss–Markov, from its stationary law.
    GaussMarkov {
        /// Standard deviation, unit.
        sigma: f64,
        /// Correlation time, s.
        tau_s: f64,
    },
    /// Random walk with coefficient K, unit/√s, from zero.
    Walk(f64),
}

impl Process {
    /// Mean square at `time_s` after `integrations` (0 to 3 for Gauss–Markov, any for the others) from rest.
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
            Self::GaussMarkov { sigma, tau_s } => {
                let z = time_s / tau_s;
                let shape = match integrations {
                    0 => 1.0,
                    1 => 2.0 * once(z),
                    2 => 2.0 * twice(z),
                    _ => 0.5 * thrice(z),
                };
                sigma.powi(2) * tau_s.powi(2 * integrations.min(3) as i32) * shape
            }
        }
    }
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// z − 1 + e^(−z), by its series where the terms cancel.
fn once(z: f64) -> f64 {
    if z < 1.0 { series(z, 2, |_| 1.0) } else { z - 1.0 + (-z).exp() }
}

/// z³/3 − z²/2 + 1 − (1 + z)e^(−z).
fn twice(z: f64) -> f64 {
    if z < 1.0 { series(z, 4, |k| k - 1.0) } else { z.powi(3) / 3.0 - z * z / 2.0 + 1.0 - (1.0 + z) * (-z).exp() }
}

/// z⁵/5 − z⁴/2 + 2z³/3 − 4 + 2(z² + 2z + 2)e^(−z).
fn thrice(z: f64) -> f64 {
    if z < 1.0 {
        series(z, 6, |k| 2.0 * (k - 1.0) * (k - 2.0))
    } else {
        z.powi(5) / 5.0 - z.powi(4) / 2.0 + 2.0 * z.powi(3) / 3.0 - 4.0 + 2.0 * (z * z + 2.0 * z + 2.0) * (-z).exp()
    }
}

/// Σ over k ≥ `first` of (−z)^k c(k)/k!, `first` even; z below 1 converges to rounding within 20 terms.
fn series(z: f64, first: u32, coefficient: impl Fn(f64) -> f64) -> f64 {
    (first..first + 20).map(|k| (-z).powi(k as i32) / factorial(k) * coefficient(f64::from(k))).sum()
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
    fn a_gauss_markov_process_lies_between_white_noise_and_a_constant() {
        for n in 1..=3 {
            let fast = Process::GaussMarkov { sigma: 2.0, tau_s: 1e-5 }.variance(n, 10.0);
            // White limit: two-sided density N² = 2σ²τ.
            let white = Process::White(2.0 * (2e-5f64).sqrt()).variance(n, 10.0);
            assert!((fast / white - 1.0).abs() < 1e-4, "n = {n}: {fast} {white}");
            let slow = Process::GaussMarkov { sigma: 2.0, tau_s: 1e6 }.variance(n, 10.0);
            let constant = Process::Constant(2.0).variance(n, 10.0);
            assert!((slow / constant - 1.0).abs() < 1e-4, "n = {n}: {slow} {constant}");
        }
    }

    #[test]
    fn series_and_closed_expression_meet() {
        for f in [once, twice, thrice] {
            let (below, above) = (f(1.0 - 1e-9), f(1.0));
            assert!((below / above - 1.0).abs() < 1e-7, "{below} {above}");
        }
    }

    #[test]
    fn a_double_sum_over_the_covariance_agrees() {
        // Direct quadrature of ∬ h(p) h(q) R(p − q) with h = p (two integrations) and p²/2 (three).
        let (sigma, tau_s, t, m) = (1.3, 2.5, 6.0, 600);
        let mid = |k: usize| (k as f64 + 0.5) * t / m as f64;
        for (n, h) in [(2u32, (|p| p) as fn(f64) -> f64), (3, |p| 0.5 * p * p)] {
            let sum: f64 = (0..m)
                .flat_map(|i| (0..m).map(move |j| (mid(i), mid(j))))
                .map(|(p, q)| h(p) * h(q) * sigma * sigma * (-(p - q).abs() / tau_s).exp())
                .sum::<f64>()
                * (t / m as f64).powi(2);
            let got = Process::GaussMarkov { sigma, tau_s }.variance(n, t);
            assert!((got / sum - 1.0).abs() < 1e-4, "n = {n}: {got} {sum}");
        }
    }
}
