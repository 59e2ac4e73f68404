//! Which backend a flight gets, and what happens where a device fails.

use std::sync::Arc;

use super::kept::Kept;
use super::run::{Ensemble, integrate, run};
use super::share::Share;
use crate::backend::flight::{FlightBackend, FlightCpu};
use crate::backend::gpu::Gpu;
use crate::backend::gpu::flight::Flights;
use crate::control::Control;
use crate::ensemble::Choice;
use crate::error::Result;
use crate::kernel::flight::Flight;

/// Member-steps below which the CPU is done before a GPU is open.
const WORTH_A_GPU: u64 = 500_000_000;

/// Integrates a flight where the choice says. Where it is automatic and a GPU fails, the CPU begins
/// anew.
///
/// # Errors
/// A GPU was asked for and there is none, or it fails; whatever stops a run.
pub fn run_on(choice: Choice, flight: &Flight, control: &Control) -> Result<Ensemble> {
    run_kept(choice, flight, &mut Kept::none(), control)
}

/// The same, keeping what is summed and going on with what was kept.
///
/// # Errors
/// As [`run_on`]; a state that cannot be gone on with.
pub fn run_kept(choice: Choice, flight: &Flight, kept: &mut Kept, control: &Control) -> Result<Ensemble> {
    on(choice, flight, kept, control, run)
}

/// Integrates the members of a shard; their sums end up in its file.
///
/// # Errors
/// As [`run_on`]; a state that cannot be gone on with, a folder that cannot be written.
pub fn run_share(choice: Choice, flight: &Flight, share: Share, control: &Control) -> Result<()> {
    on(choice, flight, &mut Kept::share(share), control, integrate).map(drop)
}

/// Some work on a backend.
type Work<R> = fn(&Flight, &mut dyn FlightBackend, &mut Kept, &Control) -> Result<R>;

fn on<R>(choice: Choice, flight: &Flight, kept: &mut Kept, control: &Control, work: Work<R>) -> Result<R> {
    let gpu = match choice {
        Choice::Cpu => None,
        Choice::Gpu => Some(Gpu::open()?),
        Choice::Auto if flight.member_steps() < WORTH_A_GPU => None,
        Choice::Auto => Gpu::hardware().unwrap_or_else(|error| {
            control.remark(&format!("note: {}: {}. The CPU is used instead.", error.attempt, error.cause));
            None
        }),
    };
    let Some(gpu) = gpu.map(Arc::new) else { return work(flight, &mut FlightCpu::default(), kept, control) };
    match work(flight, &mut Flights::on(gpu.clone()), kept, control) {
        Err(error) if choice == Choice::Auto && gpu.has_failed() => {
            control
                .remark(&format!("note: {} failed: {}. The run restarts on the CPU.", gpu.adapter.name, error.cause));
            kept.restart();
            work(flight, &mut FlightCpu::default(), kept, control)
        }
        done => done,
    }
}
