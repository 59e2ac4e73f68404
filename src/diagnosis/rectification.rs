//! States how far a proof mass alone carries the position off under a sine: what a nonlinear spring
//! or damper rectifies.
//!
//! The user integrates a = ω₀²x twice; the error is what that differs by from the true motion. The
//! equation of motion is integrated in f64 (Runge–Kutta 4) until the motion repeats from one period
//! of the vibration to the next. Then a period adds the same velocity and the same displacement
//! every time, so that the rest of the minute is a sum in closed form: exact, and as fast for a
//! resonance at 100 kHz as for one at 10 Hz. Motion that never repeats is integrated to the end.

use std::cell::OnceCell;

use super::repair::Vibration;
use crate::control::{Control, Stopped};
use crate::physics::coefficients::StudyLaw;
use crate::physics::dimension::Units;
use crate::physics::library::Term;
use crate::physics::state::{Base, Instants, MOST_VALUES};
use crate::sensor::ProofMass;

/// Steps per radian of the fastest motion: Runge–Kutta 4 then errs by less than 1e-6 in the metres
/// stated.
const STEPS_PER_RADIAN: f64 = 12.0;
/// The motion repeats when neither position nor velocity changes by more than this share of its
/// size in a period: what it still changes by is multiplied by the square of the periods left.
const REPEATS: f64 = 1e-13;
/// A period of more steps is not kept: 16 MB of forces.
const MOST_KEPT: usize = 1_000_000;
/// More steps than this no user waits for: then the last period stands for all others.
const MOST_STEPS: usize = 30_000_000;

/// x, x′, velocity error, position error.
type State = [f64; 4];

/// One sensor under one vibration, a whole number of steps per period.
struct VibratedSensor<'a> {
    control: &'a Control,
    stiffness: f64,
    damping: f64,
    /// Further laws and their parameters.
    laws: Vec<(Term, [[f64; 1]; MOST_VALUES])>,
    vibration: &'a Vibration,
    omega_rad_s: f64,
    period_s: f64,
    steps_per_period: usize,
    /// The force at each half step of a period, the same in all of them, from the first whole one
    /// on.
    period: OnceCell<Vec<f64>>,
}

/// Returns whether a law acts the same in every period. Laws that change with time or temperature,
/// or that have states of their own, do not, and the position error here leaves them out.
pub(crate) fn repeats(law: &StudyLaw) -> bool {
    !matches!(law.term, Term::StiffnessDrift(_)) && !law.term.follows_temperature() && !law.has_states()
}

/// Position error (m, with its sign) at the stated times, in ascending order. Infinite where the
/// mass runs away, as behind the hill of a softening spring; zero where nothing vibrates.
///
/// # Errors
/// Stopped.
pub(crate) fn position_error_m(
    mass: &ProofMass,
    vibration: &Vibration,
    times_s: [f64; 2],
    control: &Control,
) -> Result<[f64; 2], Stopped> {
    let omega_rad_s = std::f64::consts::TAU * vibration.frequency_hz;
    let fastest = mass.fastest_rad_s().max(omega_rad_s);
    let period_s = 1.0 / vibration.frequency_hz;
    let steps = (period_s.min(times_s[1]) * fastest * STEPS_PER_RADIAN).ceil();
    if !(1.0..1e15).contains(&steps) || vibration.amplitude_m_s2 == 0.0 {
        return Ok([0.0; 2]);
    }
    let steps_per_period = (period_s * fastest * STEPS_PER_RADIAN).ceil() as usize;
    let motion = VibratedSensor::of(control, mass, vibration, steps_per_period);
    let mut out = [0.0; 2];
    let mut state = [0.0; 4];
    let mut periods = 0.0;
    let mut taken = 0;
    let progress = control.stage("cost in metres", MOST_STEPS as u64);
    for (time_s, out) in times_s.into_iter().zip(&mut out) {
        let whole = (time_s * vibration.frequency_hz).floor();
        while periods < whole {
            // Velocity and position are counted from the period's own start, so that two periods
            // can be compared.
            let [x, v, velocity, position] = state;
            let [next_x, next_v, gained, moved] = motion.advance([x, v, 0.0, 0.0], &mut taken)?;
            let rest = whole - periods;
            let size = |a: f64, b: f64| (a - b).abs() <= REPEATS * (next_x.abs() + next_v.abs() / fastest);
            let repeats = size(next_x, x) && size(next_v / fastest, v / fastest);
            let count = if repeats || taken > MOST_STEPS { rest } else { 1.0 };
            state = [
                next_x,
                next_v,
                velocity + count * gained,
                position + count * (velocity * period_s + moved) + 0.5 * count * (count - 1.0) * gained * period_s,
            ];
            periods += count;
            progress.set(taken.min(MOST_STEPS) as u64);
            if !state.iter().all(|v| v.is_finite()) {
                return Ok([f64::INFINITY; 2]);
            }
        }
        // The rest of a period; the state at its start is kept for the next time.
        let left_s = time_s - whole * period_s;
        let steps = (left_s / period_s * steps_per_period as f64).ceil() as usize;
        *out = if steps == 0 { state[3] } else { motion.span(state, left_s, steps, &mut taken)?[3] };
    }
    Ok(if out.iter().all(|v| v.is_finite()) { out } else { [f64::INFINITY; 2] })
}

impl<'a> VibratedSensor<'a> {
    fn of(control: &'a Control, mass: &ProofMass, vibration: &'a Vibration, steps_per_period: usize) -> Self {
        let (omega, si) = (mass.natural_frequency_rad_s, Units { y: 1.0, u: 1.0, s: 1.0 });
        let values = |law: &StudyLaw| mass.laws.values(law, &si).map(|v| [v]);
        Self {
            control,
            stiffness: omega.powi(2),
            damping: 2.0 * mass.damping_ratio * omega,
            laws: mass.laws.acting().filter(|law| repeats(law)).map(|law| (law.term, values(law))).collect(),
            vibration,
            omega_rad_s: std::f64::consts::TAU * vibration.frequency_hz,
            period_s: 1.0 / vibration.frequency_hz,
            steps_per_period,
            period: OnceCell::new(),
        }
    }

    /// A whole period from phase zero.
    fn advance(&self, state: State, taken: &mut usize) -> Result<State, Stopped> {
        let steps = self.steps_per_period;
        if steps > MOST_KEPT {
            return self.span(state, self.period_s, steps, taken);
        }
        let step_s = self.period_s / steps as f64;
        let at = |half: usize| self.force_m_s2(0.5 * step_s * half as f64);
        let period = self.period.get_or_init(|| (0..=2 * steps).map(at).collect());
        self.integrate(state, step_s, steps, |half| period[half], taken)
    }

    /// Part of a period from phase zero.
    fn span(&self, state: State, length_s: f64, steps: usize, taken: &mut usize) -> Result<State, Stopped> {
        let step_s = length_s / steps as f64;
        self.integrate(state, step_s, steps, |half| self.force_m_s2(0.5 * step_s * half as f64), taken)
    }

    fn force_m_s2(&self, time_s: f64) -> f64 {
        self.vibration.amplitude_m_s2 * (self.omega_rad_s * time_s).sin()
    }

    /// Under a force given at each half step.
    fn integrate(
        &self,
        mut state: State,
        h: f64,
        steps: usize,
        force_m_s2: impl Fn(usize) -> f64,
        taken: &mut usize,
    ) -> Result<State, Stopped> {
        let slope = |f: f64, s: State| [s[1], self.acceleration(s[0], s[1], f), self.stiffness * s[0] - f, s[2]];
        let add = |s: State, k: State, by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
        for n in 0..steps {
            let [begin, middle, end] = [0, 1, 2].map(|half| force_m_s2(2 * n + half));
            let k1 = slope(begin, state);
            let k2 = slope(middle, add(state, k1, h / 2.0));
            let k3 = slope(middle, add(state, k2, h / 2.0));
            let k4 = slope(end, add(state, k3, h));
            state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            *taken += 1;
            if taken.is_multiple_of(100_000) {
                self.control.go_on()?;
            }
        }
        Ok(state)
    }

    fn acceleration(&self, x: f64, v: f64, force: f64) -> f64 {
        let base = Base { gain: [1.0], stiffness: [self.stiffness], damping: [self.damping] };
        // No step: friction is not smoothed.
        let at = Instants { time: 0.0, step: 0.0, input: [force], x: [x], v: [v], base: &base, environment: &[] };
        let mut sum = [force - self.damping * v - self.stiffness * x];
        for (term, p) in &self.laws {
            term.force::<f64, 1, false>(&at, p, &[], &mut [], &mut sum);
        }
        sum[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{quadratic_damping, quadratic_stiffness};
    use crate::sensor::mechanics::CUBIC_STIFFNESS;

    const TIMES_S: [f64; 2] = [10.0, 60.0];

    fn mass(natural_frequency_rad_s: f64, damping_ratio: f64) -> ProofMass {
        ProofMass { natural_frequency_rad_s, damping_ratio, ..ProofMass::default() }
    }

    /// Steady displacement x = X sin(ωt − φ) and its rate.
    fn steady(mass: &ProofMass, vibration: &Vibration, time_s: f64) -> (f64, f64, f64) {
        let omega = std::f64::consts::TAU * vibration.frequency_hz;
        let natural = mass.natural_frequency_rad_s;
        let (real, imaginary) = (natural * natural - omega * omega, 2.0 * mass.damping_ratio * natural * omega);
        let (size, lag) = (vibration.amplitude_m_s2 / real.hypot(imaginary), imaginary.atan2(real));
        let phase = omega * time_s - lag;
        (size * phase.sin(), size * omega * phase.cos(), size)
    }

    /// From the equation of motion: ω₀²x − f = −x″ − 2ζω₀x′, so the position error is −x − 2ζω₀∫x,
    /// and ω₀²∫x = ∫f − x′ − 2ζω₀x. The time is no whole number of periods.
    #[test]
    fn a_linear_sensor_errs_by_its_closed_form() {
        for (natural, zeta) in [(400.0, 0.5), (2e4, 0.7), (60.0, 0.1)] {
            let mass = mass(natural, zeta);
            let vibration = Vibration { amplitude_m_s2: 5.0, frequency_hz: 3.37 };
            let got = position_error_m(&mass, &vibration, TIMES_S, &Control::silent()).expect("not interrupted");
            for (got, t) in got.into_iter().zip(TIMES_S) {
                let (x, v, _) = steady(&mass, &vibration, t);
                let omega = std::f64::consts::TAU * vibration.frequency_hz;
                let impulse = vibration.amplitude_m_s2 * (1.0 - (omega * t).cos()) / omega;
                let expected = -x - 2.0 * zeta / natural * (impulse - v - 2.0 * zeta * natural * x);
                assert!((got - expected).abs() < 1e-6 * expected.abs(), "{natural} at {t}: {got:e} {expected:e}");
            }
        }
    }

    /// A quadratic spring rectifies: the mean of αx² is αX²/2, a bias that drifts as ½ b t² =
    /// −αX²t²/4.
    #[test]
    fn a_quadratic_spring_drifts_as_the_bias_that_it_rectifies() {
        let mut mass = mass(400.0, 0.5);
        let vibration = Vibration { amplitude_m_s2: 5.0, frequency_hz: 5.0 };
        let straight = position_error_m(&mass, &vibration, TIMES_S, &Control::silent()).expect("not interrupted");
        let size = steady(&mass, &vibration, 0.0).2;
        let alpha = 1e4;
        mass = mass.with(&quadratic_stiffness::GIVEN[0].key, alpha);
        let bent = position_error_m(&mass, &vibration, TIMES_S, &Control::silent()).expect("not interrupted");
        let expected = -alpha * size * size * 3600.0 / 4.0;
        // To first order in α, and up to the velocity that the first period leaves: 1/(ωt) = 5e-4.
        assert!(((bent[1] - straight[1]) / expected - 1.0).abs() < 2e-3, "{bent:?} {straight:?} {expected}");
    }

    /// A cubic spring is odd: under a sine it shifts no mean, and leaves no drift that grows with
    /// t².
    #[test]
    fn a_cubic_spring_rectifies_nothing() {
        let mut mass = mass(400.0, 0.5);
        let vibration = Vibration { amplitude_m_s2: 5.0, frequency_hz: 5.0 };
        mass = mass.with(&CUBIC_STIFFNESS, 1e11);
        let [ten, sixty] = position_error_m(&mass, &vibration, TIMES_S, &Control::silent()).expect("not interrupted");
        assert!(sixty.abs() < 7.0 * ten.abs(), "no faster than t: {ten:e} {sixty:e}");
    }

    /// Periods summed in closed form and periods integrated one by one give the same metres.
    #[test]
    fn the_sum_of_periods_is_what_integration_to_the_end_gives() {
        let mut mass = mass(300.0, 0.4);
        mass = mass.with(&quadratic_stiffness::GIVEN[0].key, 2e6).with(&quadratic_damping::GIVEN[0].key, 20.0);
        let vibration = Vibration { amplitude_m_s2: 8.0, frequency_hz: 7.3 };
        let fast = position_error_m(&mass, &vibration, TIMES_S, &Control::silent()).expect("not interrupted");
        let steps_per_period = 4000;
        let control = Control::silent();
        let motion = VibratedSensor::of(&control, &mass, &vibration, steps_per_period);
        let slow = motion.span([0.0; 4], 10.0, 73 * steps_per_period, &mut 0).expect("not interrupted")[3];
        assert!((fast[0] / slow - 1.0).abs() < 1e-5, "{} {slow}", fast[0]);
    }
}
