//! The [`Control`] of a program on a terminal: progress bars on stderr, and signals that stop.
//! Without the feature `terminal` it shows nothing.

use crate::control::Control;

#[cfg(feature = "terminal")]
mod bars;
#[cfg(feature = "terminal")]
mod lines;

/// What the program hands down: stages are bars on stderr, hidden where that is not a terminal, and
/// signals stop.
#[cfg(feature = "terminal")]
pub fn terminal() -> Control {
    Control::new(bars::Terminal::new())
}

/// What a program without a command line hands down: nothing is shown.
#[cfg(not(feature = "terminal"))]
pub fn terminal() -> Control {
    Control::silent()
}
