//! Long work next to Python: without its lock, on a thread of its own, stopped by Ctrl-C; errors as
//! its exceptions.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::{PyKeyboardInterrupt, PyUserWarning};
use pyo3::prelude::*;

use proofmass_base::control::{Control, Stage, Watcher};
use proofmass_base::error::{Error, Kind, Result};
use proofmass_base::signal::Signal;

/// States how often Python is asked whether a signal has come.
const LOOK: Duration = Duration::from_millis(50);

/// Stops when told to, and keeps remarks until Python can be given them.
#[derive(Default)]
struct Watch {
    stop: AtomicBool,
    remarks: Mutex<Vec<String>>,
}

/// A part of the work that nobody watches.
struct Unseen;

impl Stage for Unseen {
    fn set(&self, _: u64) {}
    fn add(&self, _: u64) {}
    fn rename(&self, _: &str) {}
}

/// Python's hold on a watch.
struct Held(Arc<Watch>);

impl Watcher for Held {
    fn stopped_by(&self) -> Option<&'static str> {
        self.0.stop.load(Ordering::Relaxed).then_some(Signal::Interrupt.name())
    }

    fn begin(&self, _: &str, _: u64) -> Box<dyn Stage> {
        Box::new(Unseen)
    }

    fn remark(&self, sentence: &str) {
        self.0.remarks.lock().unwrap_or_else(PoisonError::into_inner).push(sentence.to_owned());
    }
}

/// Does the work; remarks become warnings.
///
/// # Errors
/// What the work says, as `proofmass.Error`; `KeyboardInterrupt` and whatever else a handler of
/// Python raises meanwhile.
pub(super) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce(&Control) -> Result<T> + Send) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let control = Control::new(Held(watch.clone()));
    let (send, receive) = mpsc::channel();
    // Shared, as Python's lock is given up in a closure that could be sent elsewhere.
    let receive = Mutex::new(receive);
    let wait = |patience| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(patience);
    let done = std::thread::scope(|scope| {
        let worker = scope.spawn(move || send.send(work(&control)));
        loop {
            match py.detach(|| wait(LOOK)) {
                Ok(done) => return done.map_err(|error| raised(py, error)),
                Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                    watch.stop.store(true, Ordering::Relaxed);
                    py.detach(|| while matches!(wait(LOOK), Err(RecvTimeoutError::Timeout)) {});
                })?,
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(_) => {
                        return Err(raised(py, Error::new("could not continue", "the work ended early", "try again")));
                    }
                },
            }
        }
    });
    let remarks = std::mem::take(&mut *watch.remarks.lock().unwrap_or_else(PoisonError::into_inner));
    for remark in remarks {
        let text = std::ffi::CString::new(remark).unwrap_or_default();
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
    }
    done
}

/// An error as Python's: `proofmass.Error`, or `KeyboardInterrupt`.
pub(super) fn raised(py: Python<'_>, error: Error) -> PyErr {
    if error.kind == Kind::Interrupted {
        return PyKeyboardInterrupt::new_err(error.to_string());
    }
    let kind = py.import("proofmass._error").and_then(|module| module.getattr("Error"));
    match kind.and_then(|kind| kind.call1((error.attempt, error.cause, error.hint))) {
        Ok(made) => PyErr::from_value(made),
        Err(other) => other,
    }
}
