//! Job × backend → statistics: the pilot that sets the bins, batches that fit the memory, progress, stops and resuming.
//!
//! Results depend neither on the batches nor on where a run was stopped: members are summed in blocks of 256, in order,
//! and counts are integers.

use crate::error::Result;
use crate::kernel::job::Job;
use crate::statistics::Statistics;

mod backends;
mod check;
mod integrate;
mod keeper;
mod options;
mod sound;
mod state;
mod state_file;

pub use backends::Backends;
pub use integrate::{run_kept, run_on, run_or_fall_back, times_s};
pub use keeper::Keeper;
pub use options::{Choice, Options};

/// Integrates an ensemble and sums it up.
///
/// # Errors
/// Impossible jobs, adapters that are not there, Ctrl-C.
pub fn run(job: &Job, options: &Options) -> Result<Statistics> {
    Backends::default().run(job, options, &mut Keeper::none())
}
