//! One recording with known physics, made by the trial's generator on a fixed proof mass.

use std::f64::consts::TAU;

use libtest_mimic::Failed;
use proofmass::rng::{Philox, Stream};
use proofmass::trial::driven::{Columns, Driven};
use proofmass::trial::equation::Oscillator;
use proofmass::trial::excitation::{Excitation, Lines};
use proofmass::trial::physics::Physics;
use proofmass::trial::plant::{self, Size};

/// A recording to be made.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    pub physics: Option<Physics>,
    /// Of the effect, relative to the output.
    pub size: Size,
    pub samples: usize,
    pub rate_hz: f64,
    pub resonance_hz: f64,
    pub zeta: f64,
    /// White readout noise, relative to the output.
    pub noise: f64,
    pub seed: u64,
    /// Whether an input drives it; otherwise it rings down.
    pub driven: bool,
}

/// Input and reading.
pub struct Planted {
    pub input: Vec<f64>,
    pub reading: Vec<f64>,
    /// °C, where the effect follows it.
    pub temperature: Option<Vec<f64>>,
    /// Value of the effect's first parameter.
    pub strength: f64,
    /// Its values by the symbols of the library.
    pub values: Vec<(&'static str, f64)>,
}

/// Makes it, with a shape drawn at random.
pub fn plant(plan: &Plan) -> Result<Planted, Failed> {
    plant_as(plan, None)
}

/// Makes it with an effect of this shape.
pub fn plant_as(plan: &Plan, shape: Option<[f64; 2]>) -> Result<Planted, Failed> {
    let omega_rad_s = TAU * plan.resonance_hz;
    let duration_s = plan.samples as f64 / plan.rate_hz;
    let (from_hz, to_hz) = (0.1 * plan.resonance_hz, (2.5 * plan.resonance_hz).min(0.4 * plan.rate_hz));
    let lines = Lines { rms: 1.0, from_hz, to_hz, count: 200, envelope_start: 1.0, duration_s, seed: plan.seed };
    let excitation = if plan.driven { Excitation::Random(lines) } else { Excitation::None };
    let start = if plan.driven { [0.0; 2] } else { [1.0, 0.0] };
    let oscillator = Oscillator { omega_rad_s, zeta: plan.zeta, gain: omega_rad_s.powi(2), start };
    let mut case = Driven::linear(oscillator, excitation, plan.rate_hz, plan.samples, plan.seed);
    case.noise = plan.noise * case.output_rms;
    if let Some(physics) = plan.physics {
        let planted = (0..8).any(|attempt| {
            let mut rng = Philox::new(plan.seed, attempt, Stream::Host);
            let shape = shape.unwrap_or_else(|| plant::shape(&mut rng, physics, &case));
            plant::plant(&mut case, physics, shape, plan.size)
        });
        if !planted {
            return Err(format!("{} cannot be planted at {:?}", physics.id(), plan.size).into());
        }
    }
    let strength = case.planted.first().map_or(0.0, |p| p.term.value(&case.scales));
    let values = case.planted.first().map_or(Vec::new(), |p| p.term.parameters(&case.scales));
    let Columns { force, reading, temperature, .. } = case.render();
    Ok(Planted { input: force.unwrap_or_default(), reading, temperature, strength, values })
}
