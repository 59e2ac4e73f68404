//! The small ensembles that checks run, and the places they run on.

use std::sync::Arc;

use crate::backend::Backend;
use crate::backend::cpu::Cpu;
use crate::backend::gpu::Gpu;
use crate::backend::gpu::simulate::Ensembles;
use crate::control::Control;
use crate::ensemble::{self, Options};
use crate::error::Result;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::{Clock, Job, Member, Waveform};
use crate::physics::{quadratic_damping, quadratic_stiffness};
use crate::sensor::mechanics::CUBIC_STIFFNESS;
use crate::sensor::{ProofMass, Sensor};
use crate::statistics::Statistics;
use crate::units::STANDARD_GRAVITY_M_S2;

/// A backend and its name.
pub struct Place {
    /// Name of the backend in the rows.
    pub name: String,
    /// Says whether it is a GPU.
    pub is_gpu: bool,
    backend: Box<dyn Backend>,
    options: Options,
}

impl Place {
    /// The CPU as the place to run on.
    pub fn cpu(control: &Control) -> Self {
        Self::of("CPU".to_owned(), false, Box::new(Cpu::default()), control)
    }

    /// The best adapter.
    ///
    /// # Errors
    /// There is none.
    pub fn gpu(control: &Control) -> Result<Self> {
        let gpu = Gpu::open()?;
        Ok(Self::of(gpu.adapter.name.clone(), true, Box::new(Ensembles::on(Arc::new(gpu))), control))
    }

    /// Its many short runs are no stages of their own.
    fn of(name: String, is_gpu: bool, backend: Box<dyn Backend>, control: &Control) -> Self {
        Self { name, is_gpu, backend, options: Options { control: control.without_stages(), ..Options::default() } }
    }

    /// Runs a job there.
    ///
    /// # Errors
    /// As the backend.
    pub fn run(&mut self, job: &Job) -> Result<Statistics> {
        ensemble::run_on(job, self.backend.as_mut(), &self.options)
    }
}

/// Specific force a·sin(ωt) + offset.
#[derive(Debug, Clone, Copy)]
pub struct Sine {
    /// Amplitude, m/s².
    pub amplitude_m_s2: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Constant part, m/s².
    pub offset_m_s2: f64,
}

impl Waveform for Sine {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let angle = std::f64::consts::TAU * self.frequency_hz * time_s;
        self.amplitude_m_s2 * angle.sin() + self.offset_m_s2
    }
}

pub(super) const REST: Sine = Sine { amplitude_m_s2: 0.0, frequency_hz: 0.0, offset_m_s2: 0.0 };

/// An ensemble of one sensor, sampled at 100 Hz with ten steps a sample.
pub fn job(sensor: Sensor, members: u64, report_s: &[f64], force: Sine, integrator: Integrator) -> Job {
    let report_samples: Vec<u64> = report_s.iter().map(|t| (t * 100.0).round() as u64).collect();
    Job {
        seed: 20_261_120,
        members,
        clock: Clock {
            step_s: 1e-3,
            steps_per_sample: 10,
            samples: report_samples.last().copied().unwrap_or(1),
            report_samples,
            still_samples: 0,
        },
        draw: Arc::new(move |_| Member { sensor, sine: None }),
        waveform: Arc::new(force),
        integrator,
        temperature: Arc::default(),
        gravity_m_s2: STANDARD_GRAVITY_M_S2,
        chained: None,
    }
}

/// A proof mass whose cubic spring carries a hundredth of a 1 g load.
pub fn duffing(resonance_hz: f64, damping_ratio: f64) -> ProofMass {
    let natural_frequency_rad_s = std::f64::consts::TAU * resonance_hz;
    let cubic = 0.01 * natural_frequency_rad_s.powi(6) / STANDARD_GRAVITY_M_S2.powi(2);
    ProofMass { natural_frequency_rad_s, damping_ratio, ..ProofMass::default() }.with(&CUBIC_STIFFNESS, cubic)
}

/// One proof mass per integrator, as the tool would choose it at a step of 1 ms.
pub fn masses() -> Vec<(ProofMass, Integrator)> {
    let linear = duffing(1200.0, 0.7).with(&CUBIC_STIFFNESS, 0.0);
    let slow = duffing(30.0, 0.7);
    // A quadratic spring that carries another hundredth of the load.
    let quadratic = 0.01 * slow.natural_frequency_rad_s.powi(4) / STANDARD_GRAVITY_M_S2;
    let further = slow.with(&quadratic_stiffness::GIVEN[0].key, quadratic).with(&quadratic_damping::GIVEN[0].key, 1e3);
    [linear, slow, further, duffing(1200.0, 0.7), duffing(1200.0, 0.01)]
        .into_iter()
        .map(|m| (m, Integrator::choose(Some(&m), 1e-3).integrator))
        .collect()
}
