//! One member as the kernels see it: a column of numbers, derived in f64 from its sensor.
//!
//! Per-sample levels are σ = N√f_s and K√T; the proof mass is scaled so that a substep is the unit
//! of time and the reading a = ω₀²x is the unknown: a″ + Ca′ + W(a + γa³) = W(f + w) with W =
//! (ω₀h)², C = 2ζω₀h, γ = β/ω₀⁶.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::flicker;
use super::integrator::{Capability, Integrator};
use super::job::{Clock, Member};
use super::low_pass;
use crate::physics::coefficients;
use crate::physics::dimension::Units;
use crate::physics::free_oscillator::transition;
use crate::sensor::error_law::{ErrorLaw, Shape, full_scale};
use crate::sensor::terms::alike;
use crate::sensor::{ProofMass, SensorTerm};

/// Numbers of one member.
pub const COLUMNS: usize = column::TERMS + SensorTerm::COUNT;
/// Coefficients of the oscillator, the first columns.
pub(super) const COEFFICIENTS: usize = 8;

/// Places in a member's column, emitted into the shader by the same names.
pub mod column {
    use crate::sensor::SensorTerm;

    /// Factor on the shared excitation.
    pub const GAIN: usize = 8;
    /// Amplitude of the member's own sine.
    pub const SINE: usize = 9;
    /// Brownian force per sample.
    pub const FORCE: usize = 10;
    /// Steps of the reading per m/s², 0 without steps.
    pub const STEPS: usize = 11;
    /// The sensor terms, in the order of their table.
    pub const TERMS: usize = 12;
    /// Indices by the names that the shader uses.
    pub const NAMED: [(&str, usize); 4] = [("GAIN", GAIN), ("SINE", SINE), ("FORCE", FORCE), ("STEPS", STEPS)];

    /// Returns the column of a term.
    pub const fn of(term: SensorTerm) -> usize {
        TERMS + term as usize
    }

    /// Constant bias of the accelerometer.
    pub const BIAS: usize = of(SensorTerm::AccelerometerBias);
    /// Scale-factor error.
    pub const SCALE: usize = of(SensorTerm::ScaleFactor);
    /// Second-order nonlinearity.
    pub const K2: usize = of(SensorTerm::Nonlinearity);
    /// Third-order nonlinearity.
    pub const K3: usize = of(SensorTerm::CubicNonlinearity);
    /// Size of a step of the reading.
    pub const QUANTISATION: usize = of(SensorTerm::Quantisation);
    /// Full scale.
    pub const RANGE: usize = of(SensorTerm::Range);
    /// Constant bias of the gyro.
    pub const GYRO_BIAS: usize = of(SensorTerm::GyroBias);
}

/// A member, ready for a kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Its numbers, in the order of the module [`column`](mod@column).
    pub values: [f64; COLUMNS],
    /// Coefficients of its laws with the substep as unit of time and the reading as displacement,
    /// where the integrator takes them one by one; else 0.
    pub laws: [f64; coefficients::MOST],
    /// Weights of the low-pass behind its proof mass, see `low_pass`.
    pub low_pass: [f64; low_pass::WEIGHTS],
    /// Phase of its own sine at t = 0 and per half substep, in 2⁻³² turns.
    pub turns: [u32; 2],
    /// The same of each sinusoid of its readings, per half sample.
    pub waves: [u32; WAVES],
}

/// Numbers of the sinusoids of the readings: a phase and a step each.
pub const WAVES: usize = 2 * alike(ErrorLaw::Sine, SensorTerm::COUNT);

/// A number of a sinusoid of the readings, and where it stands among them.
struct Wave {
    shape: SensorTerm,
    place: usize,
    is_phase: bool,
}

/// All of them: of each sinusoid its phase, then its step.
fn waves_of_readings() -> &'static [Wave] {
    // Gathered once: each member of an ensemble goes through them.
    static WAVES: LazyLock<Vec<Wave>> = LazyLock::new(|| {
        let sines = SensorTerm::ALL.into_iter().filter(|term| term.law() == ErrorLaw::Sine);
        let numbers = sines.flat_map(|term| term.shapes().map(move |shape| (term, shape)));
        let wave = |(term, shape): (SensorTerm, SensorTerm)| {
            let is_phase = shape.law() == ErrorLaw::Shape(Shape::Phase);
            Wave { shape, place: 2 * term.rank() + usize::from(!is_phase), is_phase }
        };
        numbers.map(wave).collect()
    });
    &WAVES
}

impl Column {
    /// Derives the numbers of a member.
    pub fn of(member: &Member, clock: &Clock, integrator: Integrator) -> Self {
        let sample_s = clock.sample_s();
        let substep_s = clock.step_s / f64::from(integrator.substeps());
        let sensor = &member.sensor;
        let mut values = NOTHING;
        let mut laws = [0.0; coefficients::MOST];
        if let Some(mass) = &sensor.proof_mass {
            values[..COEFFICIENTS].copy_from_slice(&coefficients(mass, integrator, substep_s));
            if integrator.method().reach == Capability::General {
                let reading_per_m = mass.natural_frequency_rad_s.powi(2);
                laws = mass.laws.scaled(&Units { y: reading_per_m, u: 1.0, s: 1.0 / substep_s });
            }
            let scale = integrator.force_scale(values[0]);
            values[column::FORCE] = scale * mass.force_noise_m_s_rts / sample_s.sqrt();
        }
        values[column::GAIN] = sensor.excitation_gain;
        let errors = SensorTerm::all_of(&sensor.accelerometer, &sensor.gyro);
        for (i, coefficient) in errors.into_iter().enumerate() {
            if coefficient != NEUTRAL[i] {
                values[column::TERMS + i] = SensorTerm::ALL[i].law().per_sample(coefficient, sample_s);
            }
        }
        let time_s = sensor.error(SensorTerm::ReadoutLowPass);
        let low_pass = low_pass::weights(sensor.proof_mass.as_ref(), integrator, substep_s, time_s);
        values[column::STEPS] = steps_per_m_s2(values[column::QUANTISATION]);
        // Turns wrap, as the kernels' arithmetic on them does.
        let fixed = |turn: f64| ((turn.rem_euclid(1.0)) * 4_294_967_296.0).round() as u64 as u32;
        let mut waves = [0; WAVES];
        for Wave { shape, place, is_phase } in waves_of_readings() {
            let turns = sensor.error(*shape) / TAU;
            waves[*place] = fixed(if *is_phase { turns } else { 0.5 * sample_s * turns });
        }
        let mut turns = [0; 2];
        if let Some(sine) = &member.sine {
            values[column::SINE] = sine.amplitude_m_s2;
            let step = fixed(sine.frequency_hz * 0.5 * substep_s);
            // Its phase is that at the end of a still start.
            let substeps = u64::from(clock.steps_per_sample) * u64::from(integrator.substeps());
            let before = (2 * clock.still_samples * substeps) as u32;
            let phase = fixed(sine.phase_rad / TAU);
            turns = [phase.wrapping_sub(before.wrapping_mul(step)), step];
        }
        Self { values, laws, low_pass, turns, waves }
    }

    /// Returns whether the member has this term.
    pub fn has(&self, term: SensorTerm) -> bool {
        self.values[column::of(term)] != absent(term)
    }
}

/// Coefficients of terms that a member does not have.
const NEUTRAL: [f64; SensorTerm::COUNT] = {
    let mut all = [0.0; SensorTerm::COUNT];
    let mut i = 0;
    while i < all.len() {
        all[i] = SensorTerm::ALL[i].law().neutral();
        i += 1;
    }
    all
};

/// The numbers of a member that has no errors and no mass. Most of any member's are these: written
/// once, so that a term that is not there costs a comparison.
pub const NOTHING: [f64; COLUMNS] = {
    let mut all = [0.0; COLUMNS];
    let mut i = 0;
    while i < SensorTerm::COUNT {
        all[column::TERMS + i] = absent(SensorTerm::ALL[i]);
        i += 1;
    }
    all
};

/// The column of a term that a member does not have.
pub(crate) const fn absent(term: SensorTerm) -> f64 {
    let neutral = term.law().neutral();
    if matches!(term.law(), ErrorLaw::FullScale) { full_scale(neutral) } else { neutral }
}

/// Returns the factor that counts a reading in steps, 0 without steps. Divided here, once: a GPU's
/// own division may be off by 2.5 units in the last place, and one that multiplied by a reciprocal
/// took one member in 150 to another step within 50 samples, and with them a 99th percentile by
/// 0.011 sd.
fn steps_per_m_s2(quantisation_m_s2: f64) -> f64 {
    const SMALLEST: f64 = 1e-30;
    if quantisation_m_s2 > SMALLEST { 1.0 / quantisation_m_s2 } else { 0.0 }
}

/// Amplitudes of the flicker terms of a run.
pub fn flicker_amplitudes(clock: &Clock) -> Vec<f64> {
    (0..flicker::terms(clock.samples)).map(flicker::amplitude).collect()
}

/// The oscillator's coefficients, in the order its step takes them.
pub fn coefficients(mass: &ProofMass, integrator: Integrator, substep_s: f64) -> [f64; COEFFICIENTS] {
    let w0 = mass.natural_frequency_rad_s;
    let w = (w0 * substep_s).powi(2);
    let c = 2.0 * mass.damping_ratio * w0 * substep_s;
    let gamma = mass.cubic_per_m2_s2() / w0.powi(6);
    let relaxes = matches!(integrator, Integrator::ExactHold | Integrator::ExponentialRk2 { .. });
    let [a, b, d, e] = if relaxes { transition(w0 * substep_s, mass.damping_ratio, 1.0) } else { [0.0; 4] };
    match integrator {
        Integrator::Ideal => [0.0; COEFFICIENTS],
        Integrator::ExactHold => [a, b, d, e, c / w, 0.0, 0.0, 0.0],
        Integrator::RungeKutta4 { .. } => [w, c, w * gamma, 0.0, 0.0, 0.0, 0.0, 0.0],
        // Its laws have columns of their own.
        Integrator::RungeKutta4General { .. } => [w, c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        // The last two: what a force that grows by one over the step adds to (a, a′).
        Integrator::ExponentialRk2 { .. } => {
            [a, b, d, e, c / w, gamma, 1.0 - c / w + a * c / w - b, 1.0 + d * c / w - e]
        }
        Integrator::RosenbrockEuler { .. } => [w, c, gamma, (-0.5 * c).exp(), 0.0, 0.0, 0.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Sensor;

    fn values(sensor: Sensor, clock: &Clock) -> [f64; COLUMNS] {
        Column::of(&Member { sensor, sine: None }, clock, Integrator::Ideal).values
    }

    #[test]
    fn a_column_holds_what_the_law_of_each_term_makes_of_it_and_nothing_where_there_is_none() {
        for step_s in [1e-3, 1.0, 60.0] {
            let clock = Clock { step_s, steps_per_sample: 1, samples: 1, report_samples: Vec::new(), still_samples: 0 };
            let none = values(Sensor::default(), &clock);
            for (i, term) in SensorTerm::ALL.into_iter().enumerate() {
                let law = term.law();
                assert_eq!(law.per_sample(law.neutral(), step_s), absent(term), "{term:?} after {step_s} s");
                assert_eq!(none[column::of(term)], absent(term), "{term:?}");
                // Another number for each: an order that is not the table's would show.
                let coefficient = 0.5 + i as f64;
                let with = values(Sensor::default().with_error(term, coefficient), &clock);
                assert_eq!(with[column::of(term)], law.per_sample(coefficient, step_s), "{term:?}");
                let others = SensorTerm::ALL.into_iter().filter(|other| *other != term);
                others.for_each(|other| assert_eq!(with[column::of(other)], none[column::of(other)], "{other:?}"));
            }
        }
    }
}
