//! Which backend a job gets. A GPU is looked for only where it could pay, and opened once however
//! many jobs follow.

use std::sync::Arc;

use super::check::check;
use super::checkpoint::Keeper;
use super::integrate::{run_kept, run_or_fall_back, run_part};
use super::options::{Choice, Options};
use crate::backend::cpu::{Cpu, Precision};
use crate::backend::gpu::Gpu;
use crate::backend::gpu::simulate::Ensembles;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::parallel;
use crate::statistics::Statistics;

/// Member-steps per second and thread of the full path on the CPU: what `proofmass bench` finds on
/// a Zen 5, rounded down.
const CPU_PER_THREAD_PER_S: f64 = 1e9;
/// Seconds to find and open an adapter and to compile a kernel for it: on Mesa's lavapipe 0.04 and
/// about 0.1; on an NVIDIA H200 0.4, and 0.3 the first time. The lower end, as the processor's rate
/// is the highest: with every error on it is a tenth of that.
const START_S: f64 = 0.2;
/// Seconds that a step takes on a GPU however few members there are: some sixty instructions that
/// wait for each other, at four to six cycles each and 1.5 GHz. Computed, not measured.
const STEP_S: f64 = 2e-7;

/// Returns whether the CPU would take longer than a GPU must at the least.
fn worth_a_gpu(job: &Job, threads: usize) -> bool {
    let steps = job.steps_per_member() as f64;
    let cpu_s = job.members as f64 * steps / (CPU_PER_THREAD_PER_S * threads as f64);
    cpu_s > START_S + steps * STEP_S
}

/// Backends for one job after the other.
#[derive(Default)]
pub struct Backends {
    /// Result of looking for a GPU, once it was looked for.
    gpu: Option<Option<Arc<Gpu>>>,
    /// Why a GPU that is there is not used.
    refused: Option<String>,
    /// Which of several equal GPUs to take.
    nth: usize,
}

impl Backends {
    /// Backends on the GPU of this number, where there are several of the best kind: processes that
    /// share a machine take one each.
    pub fn on_nth(nth: usize) -> Self {
        Self { nth, ..Self::default() }
    }

    /// Integrates an ensemble and sums it up; `keeper` keeps the sums. Where the choice is
    /// automatic and the GPU fails, the CPU goes on.
    ///
    /// # Errors
    /// Impossible jobs, adapters that are not there, Ctrl-C (the hint says how to go on), state
    /// files that do not fit.
    pub fn run(&mut self, job: &Job, options: &Options, keeper: &mut Keeper) -> Result<Statistics> {
        check(job)?;
        let Some(gpu) = self.open(job, options)? else {
            let mut cpu = Cpu { precision: options.precision, ..Cpu::default() };
            let reason = self.refused.as_deref().filter(|_| options.backend == Choice::Auto);
            return run_part(job, &mut cpu, reason, options, keeper);
        };
        let mut ensembles = Ensembles::on(gpu.clone());
        if options.backend == Choice::Gpu {
            return run_kept(job, &mut ensembles, options, keeper);
        }
        let statistics = run_or_fall_back(job, &mut ensembles, options, keeper);
        if gpu.has_failed() {
            self.gpu = Some(None);
            self.refused = Some(format!("{} failed in an earlier part of this run", gpu.adapter.name));
        }
        statistics
    }

    /// The GPU that the options ask for; `None` is the CPU.
    fn open(&mut self, job: &Job, options: &Options) -> Result<Option<Arc<Gpu>>> {
        match (options.backend, options.precision) {
            (Choice::Gpu, Precision::F64) => {
                let cause = "the kernels on it are written in f32";
                Err(Error::new("could not use a GPU", cause, "use --backend cpu for f64"))
            }
            (Choice::Gpu, Precision::F32) => {
                if self.gpu.as_ref().is_none_or(Option::is_none) {
                    self.gpu = Some(Some(Arc::new(Gpu::open_nth(self.nth)?)));
                }
                Ok(self.gpu.clone().flatten())
            }
            (Choice::Auto, Precision::F32) if worth_a_gpu(job, parallel::threads()) => {
                if self.gpu.is_none() {
                    (self.gpu, self.refused) = hardware(self.nth, &options.control);
                }
                Ok(self.gpu.clone().flatten())
            }
            _ => Ok(None),
        }
    }
}

/// Looks for a GPU in hardware. One that is there and cannot be opened is reported, and left.
fn hardware(nth: usize, control: &Control) -> (Option<Option<Arc<Gpu>>>, Option<String>) {
    match Gpu::hardware_nth(nth) {
        Ok(gpu) => (Some(gpu.map(Arc::new)), None),
        Err(error) => {
            let reason = format!("{}: {}", error.attempt, error.cause);
            control.remark(&format!("note: {reason}. The CPU is used instead."));
            (Some(None), Some(reason))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::integrator::Integrator;
    use crate::sensor::Sensor;
    use crate::validation::jobs::{Sine, job};

    fn worth(members: u64, samples: u64, threads: usize) -> bool {
        let still = Sine { amplitude_m_s2: 0.0, frequency_hz: 0.0, offset_m_s2: 0.0 };
        let mut job = job(Sensor::default(), members, &[1.0], still, Integrator::Ideal);
        job.clock.samples = samples;
        job.clock.steps_per_sample = 1;
        worth_a_gpu(&job, threads)
    }

    #[test]
    fn few_members_or_little_work_stay_on_the_cpu() {
        // One sensor, however long: a GPU steps it no faster than a CPU does.
        assert!(!worth(1, 1_000_000_000, 2));
        // Many members, few steps: done before an adapter is open.
        assert!(!worth(100_000, 1000, 2));
        assert!(worth(100_000, 10_000, 2) && worth(10_000_000, 1_000_000, 64));
        // What is worth it next to two threads need not be next to sixty-four.
        assert!(worth(2000, 10_000_000, 2) && !worth(2000, 10_000_000, 64));
    }
}
