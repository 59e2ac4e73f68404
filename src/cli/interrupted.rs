//! Sums of a study that are kept while it runs, next to those of a run that was interrupted.

use proofmass_base::error::Result;
use proofmass_base::output::Folder;
use proofmass_base::output::names::INTERRUPTED;

use crate::output::remark;

/// Begins to keep a study's sums in its folder, and says so where they will replace those of an
/// interrupted run.
///
/// # Errors
/// As [`Folder::state`].
pub(crate) fn keep(folder: &mut Folder, resume: bool) -> Result<()> {
    folder.state(INTERRUPTED, resume)?;
    if !resume && folder.holds(INTERRUPTED) {
        remark!(
            "note: {} holds what an interrupted run had done: --resume goes on from it; this run begins anew, and \
             replaces it when it first saves its own",
            folder.path().display()
        );
    }
    Ok(())
}
