//! Watches and stops a long computation: an argument that is handed down to whatever takes time.
//!
//! The program hands down one that draws bars and listens to signals (`progress::terminal`); tests
//! and other callers hand down [`Control::silent`], or one with a [`Watcher`] of their own. Nothing
//! here knows a terminal or a signal.

use std::sync::Arc;

use crate::error::{Error, Kind};

/// Whoever watches a computation and may stop it.
pub trait Watcher: Send + Sync {
    /// Returns what asks the computation to stop, e.g. "Ctrl-C"; `None` to go on. Asked often, from
    /// many threads.
    fn stopped_by(&self) -> Option<&'static str>;
    /// A part of the work begins; `length` is its number of steps, zero where it is not known. It
    /// ends when the returned value is dropped.
    fn begin(&self, name: &str, length: u64) -> Box<dyn Stage>;
    /// Shows a sentence while the work goes on.
    fn remark(&self, sentence: &str);
}

/// A part of the work that a [`Watcher`] was told of.
pub trait Stage: Send + Sync {
    /// Steps done since the beginning.
    fn set(&self, steps: u64);
    /// Adds member-steps to the progress.
    fn add(&self, steps: u64);
    /// Names the current part of the work.
    fn rename(&self, name: &str);
}

/// Handed down to whatever takes time.
#[derive(Clone, Default)]
pub struct Control {
    watcher: Option<Arc<dyn Watcher>>,
    hides_stages: bool,
}

/// The computation was asked to stop, and did; what it had done is gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped by {by}")]
pub struct Stopped {
    by: &'static str,
}

impl Stopped {
    /// Turns it into an error of the work that was stopped; `hint` says how to go on.
    pub fn during(self, attempt: impl Into<String>, hint: impl Into<String>) -> Error {
        Error { kind: Kind::Interrupted, ..Error::new(attempt, self.to_string(), hint) }
    }
}

impl Control {
    /// Nobody watches and nobody stops.
    pub const fn silent() -> Self {
        Self { watcher: None, hides_stages: false }
    }

    /// A control that reports progress to a watcher.
    pub fn new(watcher: impl Watcher + 'static) -> Self {
        Self { watcher: Some(Arc::new(watcher)), hides_stages: false }
    }

    /// The same, but with nothing told of stages: for work that runs many times at once.
    pub fn without_stages(&self) -> Self {
        Self { hides_stages: true, ..self.clone() }
    }

    /// Returns whether to stop. Long loops ask at least every 100 ms.
    pub fn cancelled(&self) -> bool {
        self.go_on().is_err()
    }

    /// Goes on unless asked to stop.
    ///
    /// # Errors
    /// Who asked to stop.
    pub fn go_on(&self) -> Result<(), Stopped> {
        self.watcher.as_ref().and_then(|w| w.stopped_by()).map_or(Ok(()), |by| Err(Stopped { by }))
    }

    /// Begins a part of the work of this many steps, zero where nobody knows how many.
    pub fn stage(&self, name: &str, length: u64) -> Progress {
        Progress(self.watcher.as_ref().filter(|_| !self.hides_stages).map(|w| w.begin(name, length)))
    }

    /// Something to be read while the work goes on.
    pub fn remark(&self, sentence: &str) {
        if let Some(watcher) = &self.watcher {
            watcher.remark(sentence);
        }
    }
}

impl std::fmt::Debug for Control {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Control {{ watched: {} }}", self.watcher.is_some())
    }
}

/// Reports how far a part of the work has come; it ends when this is dropped.
pub struct Progress(Option<Box<dyn Stage>>);

impl Progress {
    /// Steps done since the beginning.
    pub fn set(&self, steps: u64) {
        self.0.iter().for_each(|s| s.set(steps));
    }

    /// Adds member-steps to the progress.
    pub fn add(&self, steps: u64) {
        self.0.iter().for_each(|s| s.add(steps));
    }

    /// One more step done.
    pub fn step(&self) {
        self.add(1);
    }

    /// Names what is done right now.
    pub fn rename(&self, name: &str) {
        self.0.iter().for_each(|s| s.rename(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Notes what it is told.
    #[derive(Default)]
    struct Notes {
        stop: AtomicBool,
        told: Arc<Mutex<Vec<String>>>,
    }

    struct Noted(String, Arc<Mutex<Vec<String>>>);

    impl Noted {
        fn note(&self, what: &str) {
            self.1.lock().expect("not poisoned").push(format!("{} {what}", self.0));
        }
    }

    impl Stage for Noted {
        fn set(&self, steps: u64) {
            self.note(&format!("at {steps}"));
        }
        fn add(&self, steps: u64) {
            self.note(&format!("+{steps}"));
        }
        fn rename(&self, name: &str) {
            self.note(name);
        }
    }

    impl Drop for Noted {
        fn drop(&mut self) {
            self.note("ends");
        }
    }

    impl Watcher for Arc<Notes> {
        fn stopped_by(&self) -> Option<&'static str> {
            self.stop.load(Ordering::Relaxed).then_some("a test")
        }
        fn begin(&self, name: &str, length: u64) -> Box<dyn Stage> {
            let noted = Noted(name.to_owned(), self.told.clone());
            noted.note(&format!("of {length}"));
            Box::new(noted)
        }
        fn remark(&self, sentence: &str) {
            self.told.lock().expect("not poisoned").push(sentence.to_owned());
        }
    }

    #[test]
    fn a_watcher_is_told_of_stages_and_may_stop_and_silence_hides_only_the_stages() {
        let notes = Arc::new(Notes::default());
        let control = Control::new(notes.clone());
        control.stage("fits", 3).step();
        control.without_stages().stage("hidden", 3).step();
        control.without_stages().remark("shown");
        assert_eq!(*notes.told.lock().expect("not poisoned"), ["fits of 3", "fits +1", "fits ends", "shown"]);
        assert!(control.go_on().is_ok() && !Control::silent().cancelled());
        notes.stop.store(true, Ordering::Relaxed);
        let error = control.without_stages().go_on().map_err(|s| s.during("could not fit", "again"));
        assert_eq!(error.map_err(|e| (e.cause, e.kind)), Err(("stopped by a test".to_owned(), Kind::Interrupted)));
        assert!(!Control::silent().cancelled());
    }
}
