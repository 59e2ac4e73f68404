//! Job × backend → statistics: the pilot that sets the bins, batches that fit the memory, progress,
//! stops and resuming.
//!
//! Results depend neither on the batches nor on where a run was stopped, nor on how it was divided
//! among shards: members are summed in blocks of 256, blocks are merged in the order of a fixed
//! tree, and counts are integers.

use crate::error::Result;
use crate::kernel::job::Job;
use crate::statistics::Statistics;

mod backends;
mod check;
mod checkpoint;
pub mod divided;
mod encode;
mod integrate;
mod kept;
mod options;
mod samples;
mod state;
mod state_file;
mod verify;

pub use backends::Backends;
pub use checkpoint::Keeper;
pub use integrate::{run_kept, run_on, run_or_fall_back, times_s};
pub use kept::Kept;
pub use options::{Choice, Options};
pub use samples::samples;

/// Integrates an ensemble and sums it up.
///
/// # Errors
/// Impossible jobs, adapters that are not there, Ctrl-C.
pub fn run(job: &Job, options: &Options) -> Result<Statistics> {
    Backends::default().run(job, options, &mut Keeper::none())
}
