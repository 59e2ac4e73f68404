//! The signals that stop a run: Ctrl-C, `kill`, a closed terminal. Computations hear of them by
//! their `Control`.

use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

#[cfg(feature = "terminal")]
mod listen;
#[cfg(feature = "terminal")]
pub use listen::listen_for_interrupt;

/// A request to stop, by the signal that carried it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// SIGINT: Ctrl-C.
    Interrupt,
    /// SIGTERM: `kill`, `timeout`, a batch system.
    Terminate,
    /// SIGHUP: the terminal was closed.
    HangUp,
}

impl Signal {
    /// The exit code of a process that this signal has stopped: 128 + its number, as shells have
    /// it.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Interrupt => 130,
            Self::Terminate => 143,
            Self::HangUp => 129,
        }
    }

    /// Returns the name that a person knows it by.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interrupt => "Ctrl-C",
            Self::Terminate => "SIGTERM",
            Self::HangUp => "SIGHUP",
        }
    }
}

/// Exit code of the first signal; 0 before one has come.
static STOP: AtomicU8 = AtomicU8::new(0);

/// Raises the flag that long loops look at.
pub fn raise(signal: Signal) {
    let _ = STOP.compare_exchange(0, signal.exit_code(), Ordering::SeqCst, Ordering::SeqCst);
}

/// The signal that asked the process to stop, if one has; the first, where several came.
pub fn stopped_by() -> Option<Signal> {
    let code = STOP.load(Ordering::Relaxed);
    [Signal::Interrupt, Signal::Terminate, Signal::HangUp].into_iter().find(|s| s.exit_code() == code)
}

/// Number of runs that keep a state which is not written yet.
static KEEPING: AtomicUsize = AtomicUsize::new(0);

/// A run that keeps a state from which it can be resumed: while it lives, a signal asks the run to
/// stop and leaves it the time to write that state. Without one, a process that has not ended soon
/// after a signal has nothing to save, and is ended.
#[derive(Debug)]
pub struct Keeping(());

impl Keeping {
    /// Begins to hold the end of the process off.
    pub fn begin() -> Self {
        KEEPING.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Keeping {
    fn drop(&mut self) {
        KEEPING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Returns true while a run keeps a state.
#[cfg(feature = "terminal")]
fn is_kept() -> bool {
    KEEPING.load(Ordering::SeqCst) > 0
}
