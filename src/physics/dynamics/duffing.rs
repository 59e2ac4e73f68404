//! The paper's equation 6, m x″ + D₀x′ + kx + εx³ = F, stepped by classic Runge–Kutta; ε = 0 is
//! equation 4.
//!
//! Not for stiff proof masses of real sensors: those have integrators of their own in `kernel`.

use crate::cubic_stiffness::{acceleration, tangent_stiffness};

/// Coefficients of equation 6, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Proof mass m, kg.
    pub mass_kg: f64,
    /// Damping coefficient D₀, kg/s.
    pub damping_kg_s: f64,
    /// Linear stiffness k, N/m.
    pub stiffness_n_m: f64,
    /// Cubic stiffness ε, N/m³.
    pub cubic_n_m3: f64,
}

/// Displacement and velocity of the proof mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Displacement x, m.
    pub x_m: f64,
    /// Velocity x′, m/s.
    pub v_m_s: f64,
}

/// The values that the paper prints for its chaotic case. It prints no mass; the kilogram is ours.
pub const PAPER: Oscillator = Oscillator { mass_kg: 1.0, damping_kg_s: 0.1, stiffness_n_m: 1.0, cubic_n_m3: 0.3 };

impl Oscillator {
    /// The same proof mass on a linear spring: equation 4.
    pub fn linear(self) -> Self {
        Self { cubic_n_m3: 0.0, ..self }
    }

    /// x″ under a force.
    #[inline]
    pub fn acceleration_m_s2(&self, state: State, force_n: f64) -> f64 {
        let linear = force_n - self.damping_kg_s * state.v_m_s - self.stiffness_n_m * state.x_m;
        acceleration::<f64, false>(self.cubic_n_m3, state.x_m, linear) / self.mass_kg
    }

    /// Stiffness k + 3εx² of the spring at a displacement, N/m.
    #[inline]
    pub fn tangent_stiffness_n_m(&self, x_m: f64) -> f64 {
        self.stiffness_n_m + tangent_stiffness(self.cubic_n_m3, x_m)
    }

    /// One step of classic Runge–Kutta (order 4) with the force at the step's beginning, middle and
    /// end.
    #[inline]
    pub fn step(&self, state: State, step_s: f64, force_n: [f64; 3]) -> State {
        let slope = |s: State, f| State { x_m: s.v_m_s, v_m_s: self.acceleration_m_s2(s, f) };
        let ahead = |d: State, h: f64| State { x_m: state.x_m + h * d.x_m, v_m_s: state.v_m_s + h * d.v_m_s };
        let k1 = slope(state, force_n[0]);
        let k2 = slope(ahead(k1, 0.5 * step_s), force_n[1]);
        let k3 = slope(ahead(k2, 0.5 * step_s), force_n[1]);
        let k4 = slope(ahead(k3, step_s), force_n[2]);
        State {
            x_m: state.x_m + step_s / 6.0 * (k1.x_m + 2.0 * (k2.x_m + k3.x_m) + k4.x_m),
            v_m_s: state.v_m_s + step_s / 6.0 * (k1.v_m_s + 2.0 * (k2.v_m_s + k3.v_m_s) + k4.v_m_s),
        }
    }

    /// Returns the place at which a constant force holds the mass: the one real root of kx + εx³ =
    /// F for k, ε ≥ 0, by Newton's method.
    pub fn equilibrium_m(&self, force_n: f64) -> f64 {
        let (k, e) = (self.stiffness_n_m, self.cubic_n_m3);
        // Starting beyond the root, where the curve is convex, Newton descends to it monotonically.
        let mut x = force_n / k;
        for _ in 0..100 {
            x += acceleration::<f64, false>(e, x, force_n - k * x) / self.tangent_stiffness_n_m(x);
        }
        x
    }

    /// Steps per forcing period that keep ωh near 0.2 at the stiffest point of an orbit driven with
    /// this amplitude.
    ///
    /// The spring is stiffest at the largest displacement. That is bounded here by twice the static
    /// deflection under the force (or by the linear resonance where that is nearer), where ω² =
    /// (k + 3εx²)/m.
    pub fn steps_per_period(&self, amplitude_n: f64, omega_rad_s: f64) -> u32 {
        let x = 2.0 * self.equilibrium_m(amplitude_n.abs());
        let stiffest = (self.tangent_stiffness_n_m(x) / self.mass_kg).abs().sqrt();
        let needed = 2.0 * std::f64::consts::PI * stiffest.max(omega_rad_s) / omega_rad_s / 0.2;
        // Even and bounded: below 64 the force itself is poorly sampled, above 4096 nobody waits.
        (needed.ceil().clamp(64.0, 4096.0) as u32).next_multiple_of(8)
    }
}

/// A force F₀ cos ωt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Amplitude F₀, N.
    pub amplitude_n: f64,
    /// Angular frequency ω, rad/s.
    pub omega_rad_s: f64,
}

impl Drive {
    /// The force at a time.
    pub fn at_n(&self, time_s: f64) -> f64 {
        self.amplitude_n * (self.omega_rad_s * time_s).cos()
    }

    /// Returns what an ideal sensor of unit mass that starts at rest would report: reading, speed
    /// and distance.
    pub fn ideal(&self, time_s: f64) -> (f64, f64, f64) {
        let (a, w) = (self.amplitude_n, self.omega_rad_s);
        (self.at_n(time_s), a / w * (w * time_s).sin(), a / (w * w) * (1.0 - (w * time_s).cos()))
    }

    /// Length of a period.
    pub fn period_s(&self) -> f64 {
        2.0 * std::f64::consts::PI / self.omega_rad_s
    }

    /// The force at every half step of one period: `2 steps + 1` values, the last equal to the
    /// first.
    pub fn table_n(&self, steps: u32) -> Vec<f64> {
        let halves = 2 * steps;
        let angle = |j: u32| 2.0 * std::f64::consts::PI * f64::from(j % halves) / f64::from(halves);
        (0..=halves).map(|j| self.amplitude_n * angle(j).cos()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runge_kutta_is_of_order_four() {
        let run = |steps: u32| {
            let drive = Drive { amplitude_n: 2.0, omega_rad_s: 1.5 };
            let (table, h) = (drive.table_n(steps), drive.period_s() / f64::from(steps));
            (0..steps as usize).fold(State { x_m: 1.0, v_m_s: 0.0 }, |s, j| {
                PAPER.step(s, h, [table[2 * j], table[2 * j + 1], table[2 * j + 2]])
            })
        };
        let (coarse, fine, reference) = (run(64).x_m, run(128).x_m, run(4096).x_m);
        let order = ((coarse - reference) / (fine - reference)).abs().log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn the_equilibrium_balances_the_force() {
        for force in [0.0, 0.1, 1.0, 70.0, -500.0] {
            let x = PAPER.equilibrium_m(force);
            assert!((x + 0.3 * x.powi(3) - force).abs() < 1e-9 * (1.0 + force.abs()), "{force}");
        }
    }
}
