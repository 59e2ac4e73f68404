//! Orders of convergence, and the static equilibrium that every integrator must keep.

use super::jobs::{Sine, duffing, masses};
use super::row::Row;
use std::convert::Infallible;

use crate::error::Result;
use crate::kernel::cpu::lanes::Level;
use crate::kernel::cpu::members::{Members, Shared};
use crate::kernel::cpu::simulate::Simulate;
use crate::kernel::force;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::Job;
use crate::kernel::member::Column;
use crate::physics::{quadratic_stiffness, squeeze_film_damping};
use crate::sensor::mechanics::CUBIC_STIFFNESS;
use crate::sensor::{ProofMass, Sensor};

/// All rows.
///
/// # Errors
/// A step that an integrator refuses.
pub fn rows() -> Result<Vec<Row>> {
    let linear = duffing(20.0, 0.3).with(&CUBIC_STIFFNESS, 0.0);
    let further =
        duffing(20.0, 0.3).with(&quadratic_stiffness::GIVEN[0].key, 1e4).with(&squeeze_film_damping::GIVEN[0].key, 1e7);
    let cases = [
        (linear, Integrator::ExactHold, 2.0),
        (duffing(20.0, 0.3), Integrator::RungeKutta4 { substeps: 1 }, 4.0),
        (further, Integrator::RungeKutta4General { substeps: 1 }, 4.0),
        (duffing(20.0, 0.7), Integrator::ExponentialRk2 { substeps: 1 }, 2.0),
        (duffing(20.0, 0.02), Integrator::RosenbrockEuler { substeps: 1 }, 2.0),
    ];
    let mut rows: Vec<Row> = cases
        .iter()
        .map(|(mass, integrator, order)| {
            Row::near(format!("order of {integrator}, halving a 2 ms step"), measured(mass, *integrator), *order, 0.2)
        })
        .collect();
    rows.push(Row::near("a wrong order", measured(&cases[1].0, cases[1].1), 3.0, 0.2).control());
    rows.extend(masses().iter().map(|(mass, integrator)| {
        let what = format!("static equilibrium of {integrator} under 1 g, step 1 ms, m/s² (bisection)");
        Row::near(what, settled(mass, *integrator), equilibrium(mass), 1e-9)
    }));
    Ok(rows)
}

/// log₂ of how much smaller the error gets when the step is halved; the reference has a sixteenth
/// of it.
fn measured(mass: &ProofMass, integrator: Integrator) -> f64 {
    let force = Sine { amplitude_m_s2: 9.0, frequency_hz: 3.0, offset_m_s2: 2.0 };
    let end = |step_s: f64| integrate(mass, integrator, step_s, (0.24 / step_s).round() as u64, force);
    let reference = integrate(mass, finest(integrator), 1.25e-4, 1920, force);
    ((end(2e-3) - reference) / (end(1e-3) - reference)).abs().log2()
}

/// The reference: Runge–Kutta of order 4, which has none of the other integrators' approximations.
fn finest(integrator: Integrator) -> Integrator {
    match integrator {
        Integrator::RungeKutta4General { .. } => Integrator::RungeKutta4General { substeps: 1 },
        _ => Integrator::RungeKutta4 { substeps: 1 },
    }
}

/// Reading error, m/s², of one noiseless proof mass after some steps from rest, in f64.
fn integrate(mass: &ProofMass, integrator: Integrator, step_s: f64, steps: u64, waveform: Sine) -> f64 {
    let sensor = Sensor { proof_mass: Some(*mass), ..Sensor::default() };
    let mut job: Job = super::jobs::job(sensor, 1, &[1.0], waveform, integrator);
    (job.clock.step_s, job.clock.steps_per_sample, job.clock.samples) = (step_s, 1, steps);
    let shared = Shared::<f64>::of(&job);
    let column = |i| Ok::<_, Infallible>(Column::of(&(job.draw)(i), &job.clock, integrator));
    let Ok(mut members) = Members::new(job.seed, 0..1, shared.flicker.len(), column);
    // At rest in the middle: the reading is zero, so its error is minus the force.
    members.place(-crate::kernel::job::Waveform::specific_force_m_s2(&waveform, 0.0), 0.0);
    let force = force::table::<f64>(&job, 0, steps);
    let work = Simulate {
        shared: &shared,
        members: &mut members,
        force: &force,
        warmer: &[],
        late: &[],
        first: 0,
        count: steps,
        observer: None,
    };
    work.run(Level::best());
    members.placed(0).0
}

const G: Sine = Sine { amplitude_m_s2: 0.0, frequency_hz: 0.0, offset_m_s2: crate::units::STANDARD_GRAVITY_M_S2 };

/// The error once everything has come to rest; a slow ringer needs many steps.
fn settled(mass: &ProofMass, integrator: Integrator) -> f64 {
    integrate(mass, integrator, 1e-3, 20_000, G)
}

/// Root e of e + γa³ + γ₂a² = 0 with a = e + g (γ = β/ω₀⁶, γ₂ = α/ω₀⁴), by bisection.
fn equilibrium(mass: &ProofMass) -> f64 {
    let w2 = mass.natural_frequency_rad_s.powi(2);
    let (cubic, square) =
        (mass.cubic_per_m2_s2() / w2.powi(3), mass.laws.of(&quadratic_stiffness::GIVEN[0].key) / w2.powi(2));
    let balance = |e: f64| {
        let a = e + G.offset_m_s2;
        e + cubic * a * a * a + square * a * a
    };
    let (mut low, mut high) = (-G.offset_m_s2, 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if balance(middle) > 0.0 { high = middle } else { low = middle }
    }
    low
}
