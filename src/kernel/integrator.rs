//! Which way of stepping the proof mass: a pure choice with its reason, and the refusal of steps
//! that would blow up.
//!
//! The steps themselves stand in `cpu::oscillator` and `shaders/shared/oscillator.wgsl`.

use crate::error::{Error, Result};
use crate::sensor::ProofMass;

/// Integrator of the proof mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// No mechanics: the reading follows the force at once.
    Ideal,
    /// Linear: the exact map for a force that is linear and a noise that is constant over a step,
    /// in error coordinates; one step whatever the resonance.
    ExactHold,
    /// Cubic with ω₀h small: classic Runge–Kutta, order 4.
    RungeKutta4 {
        /// Substeps per integration step.
        substeps: u32,
    },
    /// Any further term (quadratic, friction, squeeze film): classic Runge–Kutta with all of them.
    RungeKutta4General {
        /// Substeps per integration step.
        substeps: u32,
    },
    /// Stiff cubic, Q ≤ 1: exponential Runge–Kutta of order 2 (Cox and Matthews 2002, ETD2RK).
    ExponentialRk2 {
        /// Substeps per integration step.
        substeps: u32,
    },
    /// Stiff hardening cubic, Q ≥ 10: exponential Rosenbrock–Euler, order 2 (Hochbruck and
    /// Ostermann 2006).
    RosenbrockEuler {
        /// Substeps per integration step.
        substeps: u32,
    },
}

/// Which proof masses a method can step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Capability {
    /// No proof mass.
    Nothing,
    /// Linear proof masses.
    Linear,
    /// Those with a cubic spring that hardens, or none.
    Hardening,
    /// Those with any cubic spring.
    Cubic,
    /// Those with any term.
    General,
}

/// Properties of a method, whatever its substeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// Name in reports.
    pub name: &'static str,
    /// Name of its function in `shaders/shared/oscillator.wgsl`, and in capitals of its code.
    pub wgsl: &'static str,
    /// Says whether there is a state to step.
    pub moves: bool,
    /// The proof masses that it can step.
    pub reach: Capability,
    /// Above this ω₀h it grows without bound on an undamped oscillator; infinity where the linear
    /// part is exact.
    pub stable_below: f64,
}

/// The methods, in the order of [`Integrator`]'s variants.
pub(super) const METHODS: &[Method] = &[
    Method { name: "ideal", wgsl: "ideal", moves: false, reach: Capability::Nothing, stable_below: f64::INFINITY },
    Method {
        name: "exact map",
        wgsl: "exact_hold",
        moves: true,
        reach: Capability::Linear,
        stable_below: f64::INFINITY,
    },
    Method {
        name: "Runge-Kutta 4",
        wgsl: "runge_kutta_4",
        moves: true,
        reach: Capability::Cubic,
        stable_below: RK4_STABLE,
    },
    Method {
        name: "Runge-Kutta 4 (all terms)",
        wgsl: "runge_kutta_4_general",
        moves: true,
        reach: Capability::General,
        stable_below: RK4_STABLE,
    },
    Method {
        name: "exponential Runge-Kutta 2",
        wgsl: "exponential_rk_2",
        moves: true,
        reach: Capability::Cubic,
        stable_below: f64::INFINITY,
    },
    Method {
        name: "exponential Rosenbrock-Euler",
        wgsl: "rosenbrock_euler",
        moves: true,
        reach: Capability::Hardening,
        stable_below: f64::INFINITY,
    },
];

impl Method {
    /// Its number in the shader: its place in `METHODS`.
    pub fn code(&self) -> usize {
        METHODS.iter().position(|m| m == self).unwrap_or(METHODS.len())
    }

    fn reaches(&self, mass: &ProofMass) -> bool {
        match self.reach {
            Capability::Nothing => false,
            Capability::Linear => mass.cubic_per_m2_s2() == 0.0 && !mass.has_further_terms(),
            Capability::Hardening => mass.cubic_per_m2_s2() >= 0.0 && !mass.has_further_terms(),
            Capability::Cubic => !mass.has_further_terms(),
            Capability::General => true,
        }
    }
}

/// The largest ω₀h at which classic Runge–Kutta is accurate: 25 steps per period.
const RK4_ACCURATE: f64 = 0.25;
/// Above this ω₀h classic Runge–Kutta grows without bound on an undamped oscillator (2√2, less a
/// margin).
const RK4_STABLE: f64 = 2.7;

/// A choice and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The integrator.
    pub integrator: Integrator,
    /// One sentence for the report.
    pub because: String,
}

impl Integrator {
    /// The integrator for this proof mass and step (s).
    ///
    /// Give it the stiffest member of an ensemble (largest ω₀, any nonlinearity that some member
    /// has).
    pub fn choose(proof_mass: Option<&ProofMass>, step_s: f64) -> Choice {
        let choice = |integrator, because: String| Choice { integrator, because };
        let Some(m) = proof_mass else {
            return choice(Self::Ideal, "there are no mechanics: the reading follows the force instantly".to_owned());
        };
        let stiffness = m.fastest_rad_s() * step_s;
        let quality = 0.5 / m.damping_ratio;
        let substeps = ((stiffness / RK4_ACCURATE).ceil() as u32).max(1);
        let steps = |n: u32| if n == 1 { "one step".to_owned() } else { format!("{n} substeps a step") };
        if m.has_further_terms() {
            return choice(
                Self::RungeKutta4General { substeps },
                format!(
                    "the equation has terms beyond the cubic: Runge-Kutta of order 4, {} keep ω₀h ≤ 0.25",
                    steps(substeps)
                ),
            );
        }
        if m.cubic_per_m2_s2() == 0.0 {
            return choice(
                Self::ExactHold,
                format!(
                    "the exact solution of the linear spring, one step whatever the resonance (ω₀h = {stiffness:.3})"
                ),
            );
        }
        if stiffness <= RK4_ACCURATE {
            return choice(
                Self::RungeKutta4 { substeps: 1 },
                format!("the spring is cubic and the step short (ω₀h = {stiffness:.3}): Runge-Kutta of order 4"),
            );
        }
        if quality <= 1.0 {
            return choice(
                Self::ExponentialRk2 { substeps: 4 },
                format!(
                    "the spring is cubic, stiff (ω₀h = {stiffness:.2}) and well damped (Q = {quality:.2}): exponential \
                     Runge-Kutta of order 2, 4 substeps a step"
                ),
            );
        }
        if quality >= 10.0 && m.cubic_per_m2_s2() > 0.0 {
            return choice(
                Self::RosenbrockEuler { substeps: 1 },
                format!(
                    "the spring is cubic, stiff (ω₀h = {stiffness:.2}) and rings (Q = {quality:.0}): exponential \
                     Rosenbrock-Euler, one step"
                ),
            );
        }
        choice(
            Self::RungeKutta4 { substeps },
            format!(
                "the spring is cubic and stiff (ω₀h = {stiffness:.2}, Q = {quality:.1}): Runge-Kutta of order 4, {} keep \
                 ω₀h ≤ 0.25",
                steps(substeps)
            ),
        )
    }

    /// The same for a proof mass with a low-pass behind it, which follows the motion within a step:
    /// what is not linear is resolved.
    pub fn choose_resolving(proof_mass: Option<&ProofMass>, step_s: f64) -> Choice {
        let choice = Self::choose(proof_mass, step_s);
        let (Self::ExponentialRk2 { .. } | Self::RosenbrockEuler { .. }, Some(m)) = (choice.integrator, proof_mass)
        else {
            return choice;
        };
        let substeps = ((m.natural_frequency_rad_s * step_s / RK4_ACCURATE).ceil() as u32).max(1);
        let because = format!(
            "the spring is cubic and stiff, and a low-pass follows its motion: Runge-Kutta of order 4, {substeps} \
             substeps a step keep ω₀h ≤ 0.25"
        );
        Choice { integrator: Self::RungeKutta4 { substeps }, because }
    }

    /// Substeps per integration step.
    pub fn substeps(self) -> u32 {
        match self {
            Self::Ideal | Self::ExactHold => 1,
            Self::RungeKutta4 { substeps }
            | Self::RungeKutta4General { substeps }
            | Self::ExponentialRk2 { substeps }
            | Self::RosenbrockEuler { substeps } => substeps,
        }
    }

    /// Returns the factor of the noise of the force, given W = (ω₀h)²: Runge–Kutta wants it as it
    /// stands in the equation, W·w; the others as the reading that it is.
    pub fn force_scale(self, w: f64) -> f64 {
        match self {
            Self::RungeKutta4 { .. } | Self::RungeKutta4General { .. } => w,
            _ => 1.0,
        }
    }

    /// Returns what is known of it.
    pub fn method(self) -> &'static Method {
        let place = match self {
            Self::Ideal => 0,
            Self::ExactHold => 1,
            Self::RungeKutta4 { .. } => 2,
            Self::RungeKutta4General { .. } => 3,
            Self::ExponentialRk2 { .. } => 4,
            Self::RosenbrockEuler { .. } => 5,
        };
        &METHODS[place]
    }

    /// Refuses a proof mass that this integrator cannot step.
    ///
    /// # Errors
    /// Runge–Kutta at ω₀h > 2.7, naming the step that would do; terms that the integrator does not
    /// have.
    pub fn check(self, proof_mass: Option<&ProofMass>, step_s: f64) -> Result<()> {
        let Some(m) = proof_mass else { return Ok(()) };
        // Every member of an ensemble is checked: nothing is written unless it fails.
        let attempt = || format!("could not integrate with {self}");
        if !self.method().reaches(m) {
            let cause = "the proof mass has terms that it leaves out";
            return Err(Error::new(attempt(), cause, "let the tool choose the integrator"));
        }
        let stiffness = m.fastest_rad_s() * step_s / f64::from(self.substeps());
        let bound = self.method().stable_below;
        if stiffness > bound {
            let need = RK4_ACCURATE / m.fastest_rad_s();
            return Err(Error::new(
                attempt(),
                format!("the step is unstable: ω₀h = {stiffness:.2}, and above {bound} the solution blows up"),
                format!("use a step of at most {need:.2e} s (ω₀h = {RK4_ACCURATE}), or let the tool choose"),
            ));
        }
        Ok(())
    }
}

impl std::fmt::Display for Integrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ideal | Self::ExactHold => write!(f, "{}", self.method().name),
            _ => write!(f, "{} × {}", self.method().name, self.substeps()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::coulomb_friction;
    use crate::sensor::mechanics::CUBIC_STIFFNESS;

    fn mass(hz: f64, damping_ratio: f64, cubic: f64) -> ProofMass {
        ProofMass { natural_frequency_rad_s: hz * std::f64::consts::TAU, damping_ratio, ..ProofMass::default() }
            .with(&CUBIC_STIFFNESS, cubic)
    }

    #[test]
    fn the_choice_follows_stiffness_damping_and_terms() {
        let chosen = |hz, z, b| Integrator::choose(Some(&mass(hz, z, b)), 1e-3).integrator;
        assert_eq!(Integrator::choose(None, 1e-3).integrator, Integrator::Ideal);
        assert_eq!(chosen(5000.0, 1e-4, 0.0), Integrator::ExactHold);
        assert_eq!(chosen(30.0, 0.7, 1e9), Integrator::RungeKutta4 { substeps: 1 });
        assert_eq!(chosen(1200.0, 0.7, 1e9), Integrator::ExponentialRk2 { substeps: 4 });
        assert_eq!(chosen(1200.0, 0.001, 1e9), Integrator::RosenbrockEuler { substeps: 1 });
        assert_eq!(chosen(1200.0, 0.001, -1e9), Integrator::RungeKutta4 { substeps: 31 });
        let resolved = |hz, z, b| Integrator::choose_resolving(Some(&mass(hz, z, b)), 1e-3).integrator;
        assert_eq!(resolved(1200.0, 0.7, 1e9), Integrator::RungeKutta4 { substeps: 31 });
        assert_eq!(resolved(1200.0, 0.001, 1e9), Integrator::RungeKutta4 { substeps: 31 });
        assert_eq!(resolved(5000.0, 1e-4, 0.0), Integrator::ExactHold);
        let further = mass(30.0, 0.7, 0.0).with(&coulomb_friction::GIVEN[0].key, 0.1);
        assert_eq!(Integrator::choose(Some(&further), 1e-3).integrator, Integrator::RungeKutta4General { substeps: 1 });
    }

    #[test]
    fn every_integrator_has_the_method_of_its_name() {
        let all = [
            (Integrator::Ideal, "ideal"),
            (Integrator::ExactHold, "exact map"),
            (Integrator::RungeKutta4 { substeps: 2 }, "Runge-Kutta 4 × 2"),
            (Integrator::RungeKutta4General { substeps: 1 }, "Runge-Kutta 4 (all terms) × 1"),
            (Integrator::ExponentialRk2 { substeps: 4 }, "exponential Runge-Kutta 2 × 4"),
            (Integrator::RosenbrockEuler { substeps: 1 }, "exponential Rosenbrock-Euler × 1"),
        ];
        for (place, (integrator, name)) in all.into_iter().enumerate() {
            assert_eq!((integrator.method().code(), integrator.to_string()), (place, name.to_owned()));
        }
        assert_eq!(METHODS.len(), all.len());
    }

    #[test]
    fn an_unstable_step_is_refused_with_the_step_that_would_do() {
        let m = mass(1200.0, 0.7, 1e9);
        let error = Integrator::RungeKutta4 { substeps: 1 }.check(Some(&m), 1e-3).expect_err("unstable");
        assert!(error.hint.contains("3.32e-5 s"), "{error}");
        assert!(Integrator::choose(Some(&m), 1e-3).integrator.check(Some(&m), 1e-3).is_ok());
        assert!(Integrator::ExactHold.check(Some(&m), 1e-3).is_err());
    }
}
