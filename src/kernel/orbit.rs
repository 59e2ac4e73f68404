//! The contract of the two map kernels, `lyapunov` and `poincare`: a forced Duffing oscillator per
//! lane.
//!
//! All lanes of a job share the phase of the force: time is counted in steps per forcing period, so
//! the cosine is a table and a step's length in seconds may differ from lane to lane. Not for
//! ensembles of sensors, see `job`.

use crate::dynamics::duffing::{Drive, Oscillator};

/// One oscillator, per unit mass: x″ + δx′ + αx + βx³ = A cos ωt + w(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// δ = D₀/m, 1/s.
    pub damping_per_s: f64,
    /// α = k/m, 1/s².
    pub stiffness_per_s2: f64,
    /// β = ε/m, 1/(m² s²).
    pub cubic_per_m2_s2: f64,
    /// A = F₀/m, m/s².
    pub amplitude_m_s2: f64,
    /// Angular frequency of the force ω, rad/s.
    pub omega_rad_s: f64,
    /// White force noise w per unit mass, two-sided coefficient N (σ = N/√h held over a step h),
    /// m/s²·√s.
    pub noise_m_s2_rts: f64,
    /// Initial displacement, m.
    pub x_m: f64,
    /// Initial velocity, m/s.
    pub v_m_s: f64,
}

impl Point {
    /// A driven oscillator that starts at rest, without noise.
    pub fn at_rest(oscillator: &Oscillator, drive: &Drive) -> Self {
        Self {
            damping_per_s: oscillator.damping_kg_s / oscillator.mass_kg,
            stiffness_per_s2: oscillator.stiffness_n_m / oscillator.mass_kg,
            cubic_per_m2_s2: oscillator.cubic_n_m3 / oscillator.mass_kg,
            amplitude_m_s2: drive.amplitude_n / oscillator.mass_kg,
            omega_rad_s: drive.omega_rad_s,
            noise_m_s2_rts: 0.0,
            x_m: 0.0,
            v_m_s: 0.0,
        }
    }
}

/// Integration of all points of one job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Seed of the force noise.
    pub seed: u64,
    /// Number of the first point, so that noise does not depend on how points are split into jobs.
    pub first_member: u64,
    /// Runge–Kutta steps per forcing period.
    pub steps_per_period: u32,
    /// Transient periods before averaging.
    pub transient_periods: u32,
    /// Periods over which the exponent is averaged.
    pub periods: u32,
    /// Strobes recorded afterwards, one per period.
    pub strobes: u32,
}

/// Outcome of one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// Largest Lyapunov exponent, 1/s; NaN where the orbit left every bound.
    pub exponent_per_s: f64,
    /// Displacement and velocity once per period, in m and m/s, after the averaging.
    pub strobes: Vec<[f32; 2]>,
}

/// Displacements beyond this count as lost, m. The cubic spring holds any orbit far inside; only a
/// step too long for it leaves.
pub const LOST_M: f64 = 1e6;

/// Periods during which the tangent vector turns into its growing direction before growth is
/// counted.
pub const ALIGN_PERIODS: u32 = 8;

impl Orbit {
    /// Period in forcing periods, up to half the recorded strobes: the smallest shift that maps the
    /// strobes onto themselves within `tolerance` of their size. `None`: longer, or chaotic.
    pub fn period(&self, tolerance: f32) -> Option<u32> {
        let size = self.strobes.iter().flatten().fold(1e-6f32, |s, v| s.max(v.abs()));
        let near = |a: &[f32; 2], b: &[f32; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) <= tolerance * size;
        (1..=self.strobes.len() / 2)
            .find(|p| self.strobes.windows(p + 1).all(|w| near(&w[0], &w[*p])))
            .map(|p| p as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_the_smallest_shift_that_repeats() {
        let orbit =
            |f: fn(usize) -> f32| Orbit { exponent_per_s: 0.0, strobes: (0..32).map(|n| [f(n), 0.0]).collect() };
        assert_eq!(orbit(|n| (n % 3) as f32).period(1e-3), Some(3));
        assert_eq!(orbit(|_| 2.0).period(1e-3), Some(1));
        assert_eq!(orbit(|n| (n * n) as f32).period(1e-3), None);
    }
}
