//! The way through the rows of a file, one by one or many at a time: watched, and stopped where asked.

use std::ops::Range;
use std::path::Path;

use super::rows::Rows;
use super::run::Run;
use crate::control::{Control, Progress, Stopped};
use crate::error::Result;

/// Rows between looks at the control.
const LOOK: usize = 65_536;

/// Holds what a visitor of rows wants next.
pub enum Next {
    /// The next row.
    Go,
    /// No more rows.
    Stop,
}

/// Holds what is passed on the way through a file.
#[derive(Debug)]
pub enum Passed<'a> {
    /// One row, at hand.
    Row(&'a mut Rows),
    /// Several that need no look one by one.
    Run(&'a Run<'a>),
}

/// Goes through the rows within `range`; those before are passed. What comes behind is left unread.
///
/// # Errors
/// As [`Rows::advance`]; Ctrl-C; whatever `visit` says.
pub fn walk(
    path: &Path,
    control: &Control,
    table: &mut Rows,
    range: &Range<usize>,
    mut visit: impl FnMut(&mut Rows) -> Result<Next>,
) -> Result<()> {
    let watched = Watched { path, control, progress: control.stage("reading", table.length_bytes()) };
    for row in 0..range.end {
        watched.look(table, row)?;
        if row < range.start {
            if !table.skip()? {
                break;
            }
            continue;
        }
        if !table.advance()? || matches!(visit(table)?, Next::Stop) {
            break;
        }
    }
    Ok(())
}

/// The same, with many rows at a time where nothing is to be said of any.
///
/// # Errors
/// As [`walk`].
pub fn walk_runs(
    path: &Path,
    control: &Control,
    table: &mut Rows,
    range: &Range<usize>,
    mut visit: impl FnMut(Passed<'_>) -> Result<Next>,
) -> Result<()> {
    let watched = Watched { path, control, progress: control.stage("reading", table.length_bytes()) };
    let mut row = 0;
    while row < range.end {
        watched.look(table, row)?;
        let is_wanted = row >= range.start;
        let end = if is_wanted { range.end } else { range.start }.min((row / LOOK + 1) * LOOK);
        if let Some(run) = table.run(end - row, is_wanted) {
            row += run.rows.len();
            if is_wanted && matches!(visit(Passed::Run(&run))?, Next::Stop) {
                break;
            }
            continue;
        }
        row += 1;
        if is_wanted {
            if !table.advance()? || matches!(visit(Passed::Row(table))?, Next::Stop) {
                break;
            }
        } else if !table.skip()? {
            break;
        }
    }
    Ok(())
}

/// A way through a file that is watched and may be stopped.
struct Watched<'a> {
    path: &'a Path,
    control: &'a Control,
    progress: Progress,
}

impl Watched<'_> {
    /// Reports progress and checks for a stop every [`LOOK`] rows.
    #[inline]
    fn look(&self, table: &Rows, row: usize) -> Result<()> {
        if row.is_multiple_of(LOOK) {
            self.progress.set(table.bytes_read());
            let attempt = |by: Stopped| by.during(format!("could not read {}", self.path.display()), "start it again");
            self.control.go_on().map_err(attempt)?;
        }
        Ok(())
    }
}
