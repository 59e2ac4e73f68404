//! The ensembles that are timed: 4096 samples of one step of 1 ms, sums every 256.

use std::sync::Arc;

use proofmass_base::units::STANDARD_GRAVITY_M_S2;
use proofmass_kernel::integrator::Integrator;
use proofmass_kernel::job::{Clock, Job, Member};
use proofmass_kernel::orbit::{ALIGN_PERIODS, Plan, Point};
use proofmass_scenario::sensor::mechanics::CUBIC_STIFFNESS;
use proofmass_scenario::sensor::{ProofMass, Sensor};
use proofmass_simulate::validation::jobs::{Sine, duffing};
use proofmass_simulate::validation::parity::everything;

/// Name of the rows of ensembles by the full path.
pub const FULL: &str = "full: Runge-Kutta 4, force noise, two integrations";
/// Sizes at which the full path is timed: from one sensor to a fleet.
pub(crate) const SIZES: [u64; 7] = [1, 64, 1024, 8192, 65_536, 1 << 20, 10_000_000];
/// Name of these rows.
pub(crate) const SIZED: &str = "full, by size of the ensemble";
/// Name of the rows of 8192 members over ever longer runs.
pub(crate) const SCALED: &str = "full, by length of the run";
/// Name of the row whose run is so long that a card does nothing else.
pub const LONG: &str = "full, a run of 100000 steps";
/// Samples of that run.
pub(super) const LONG_SAMPLES: u64 = 100_000;
/// Samples of the runs of [`SCALED`].
pub(super) const LENGTHS: [u64; 4] = [1000, 10_000, 100_000, 1_000_000];

fn job(sensor: Sensor, members: u64, samples: u64, integrator: Integrator) -> Job {
    Job {
        seed: 1,
        members,
        clock: Clock {
            step_s: 1e-3,
            steps_per_sample: 1,
            samples,
            report_samples: (1..=samples / 256).map(|i| i * 256).collect(),
            still_samples: 0,
        },
        draw: Arc::new(move |_| Member { sensor, sine: None }),
        waveform: Arc::new(Sine { amplitude_m_s2: 7.0, frequency_hz: 1.3, offset_m_s2: 0.0 }),
        integrator,
        temperature: Arc::default(),
        gravity_m_s2: STANDARD_GRAVITY_M_S2,
        chained: None,
    }
}

/// Runge–Kutta 4 with force noise, two integrations, sums every 256 steps; fewer steps for very
/// many members.
pub fn full(members: u64) -> Job {
    let mass = ProofMass { force_noise_m_s_rts: 4e-4, ..duffing(30.0, 0.7) };
    let sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
    let samples = if members > 8192 { 512 } else { 4096 };
    job(sensor, members, samples, Integrator::RungeKutta4 { substeps: 1 })
}

/// The same without force noise: what is left of its time is the generator's.
pub(super) fn noiseless(members: u64) -> Job {
    let sensor = Sensor { proof_mass: Some(duffing(30.0, 0.7)), ..Sensor::default() };
    Job { draw: Arc::new(move |_| Member { sensor, sine: None }), ..full(members) }
}

/// The full path over that many samples, one report at its end: what cost per member-step depends
/// on if it is not constant.
pub(crate) fn long(members: u64, samples: u64) -> Job {
    let mut job = full(members);
    (job.clock.samples, job.clock.report_samples) = (samples, vec![samples]);
    job
}

/// Orbits of a map: forced Duffing oscillators over a range of amplitudes, without noise.
pub fn orbits(points: usize) -> (Vec<Point>, Plan) {
    let point = |i: usize| Point {
        damping_per_s: 0.3,
        stiffness_per_s2: -1.0,
        cubic_per_m2_s2: 1.0,
        amplitude_m_s2: 0.2 + 0.5 * i as f64 / points as f64,
        omega_rad_s: 1.2,
        noise_m_s2_rts: 0.0,
        x_m: 1.0,
        v_m_s: 0.0,
    };
    let plan = Plan {
        seed: 1,
        first_member: 0,
        steps_per_period: 128,
        transient_periods: 0,
        periods: 64 - ALIGN_PERIODS,
        strobes: 0,
    };
    ((0..points).map(point).collect(), plan)
}

/// Steps of orbit and tangent in that map.
pub(super) fn orbit_steps(points: usize, plan: &Plan) -> f64 {
    points as f64 * f64::from(plan.steps_per_period) * f64::from(ALIGN_PERIODS + plan.periods)
}

/// Returns what an ensemble is mostly asked for.
pub(crate) fn ensembles(members: u64) -> Vec<(&'static str, Job)> {
    let linear = duffing(1200.0, 0.7).with(&CUBIC_STIFFNESS, 0.0);
    let mut plain = Sensor { proof_mass: Some(linear), ..Sensor::default() };
    plain.accelerometer.velocity_random_walk_m_s_rts = 4e-4;
    let all = Sensor { proof_mass: Some(linear), ..everything() };
    vec![
        (FULL, Job { clock: full(1).clock, ..full(members) }),
        ("linear: exact map, white noise, two integrations", job(plain, members, 4096, Integrator::ExactHold)),
        ("every error on: exact map, nine noises, tilt", job(all, members, 4096, Integrator::ExactHold)),
    ]
}
