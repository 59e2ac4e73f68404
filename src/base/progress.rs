//! The [`Control`] of a program on a terminal: progress bars on stderr, and signals that stop.
//! Without the feature `cli` it shows nothing.

use crate::control::Control;

#[cfg(feature = "cli")]
mod bars;

/// What the program hands down: stages are bars on stderr, hidden where that is not a terminal, and
/// signals stop.
#[cfg(feature = "cli")]
pub(crate) fn terminal() -> Control {
    Control::new(bars::Terminal::new())
}

/// What a program without a command line hands down: nothing is shown.
#[cfg(not(feature = "cli"))]
pub(crate) fn terminal() -> Control {
    Control::silent()
}
