//! Which device a command computes on, how that is chosen on the command line, and what it does
//! when that device fails.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use super::output::remark;
use proofmass_base::error::Result;
use proofmass_simulate::backend::gpu::Gpu;
use proofmass_simulate::backend::orbits::Device;
use proofmass_simulate::ensemble::Choice;

/// Parses `--backend`.
pub(super) fn backends() -> impl TypedValueParser<Value = Choice> {
    let values = Choice::ALL.map(|choice| {
        let help = match choice {
            Choice::Auto => "A hardware GPU if present and the ensemble is large enough to benefit, else the CPU",
            Choice::Gpu => "Any GPU adapter, including software ones",
            Choice::Cpu => "The CPU",
        };
        PossibleValue::new(choice.name()).help(help)
    });
    PossibleValuesParser::new(values).try_map(|name| {
        let choice = Choice::ALL.into_iter().find(|choice| choice.name() == name);
        choice.ok_or_else(|| format!("no device is called {name}"))
    })
}

/// The GPU to use, opened; `None` is the CPU. One that is there and cannot be opened is said.
///
/// # Errors
/// A GPU was asked for and there is none, or it refuses.
pub(super) fn open(choice: Choice) -> Result<Option<Gpu>> {
    match choice {
        Choice::Auto => Ok(Gpu::hardware().unwrap_or_else(|error| {
            remark!("note: {}: {}. The CPU is used instead.", error.attempt, error.cause);
            None
        })),
        Choice::Gpu => Gpu::open().map(Some),
        Choice::Cpu => Ok(None),
    }
}

/// Does `work` on the device of the choice. Where the choice is automatic and a GPU fails, the CPU
/// does it from the beginning.
///
/// # Errors
/// As [`open`] and `work`.
pub(super) fn on_device<T>(choice: Choice, work: impl Fn(Device<'_>) -> Result<T>) -> Result<T> {
    let Some(gpu) = open(choice)? else { return work(Device::Cpu) };
    match work(Device::Gpu(&gpu)) {
        Err(error) if choice == Choice::Auto && gpu.has_failed() => {
            remark!("note: {} failed: {}. The run restarts on the CPU.", gpu.adapter.name, error.cause);
            work(Device::Cpu)
        }
        done => done,
    }
}
