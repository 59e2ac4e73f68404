//! What long work does, as a line on stderr every ten seconds: for a pipe or a file, where no bar can
//! be drawn. Work that ends sooner says nothing.

use std::io::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Weak};
use std::time::Duration;

use crate::control::Stage;
use crate::escape;

/// Time from one line to the next.
const EVERY: Duration = Duration::from_secs(10);

/// Stages under way, the newest last.
#[derive(Default)]
pub(crate) struct Lines {
    stages: Arc<Mutex<Vec<Arc<Running>>>>,
    is_watched: AtomicBool,
}

/// A stage under way.
struct Running {
    name: Mutex<String>,
    length: u64,
    done: AtomicU64,
}

/// Ends its stage when it is dropped.
struct Line {
    running: Arc<Running>,
    stages: Arc<Mutex<Vec<Arc<Running>>>>,
}

impl Lines {
    /// Begins a stage of `length` steps, zero where nobody knows how many.
    pub(crate) fn begin(&self, name: &str, length: u64) -> Box<dyn Stage> {
        let running = Arc::new(Running { name: Mutex::new(name.to_owned()), length, done: AtomicU64::new(0) });
        if let Ok(mut stages) = self.stages.lock() {
            stages.push(running.clone());
        }
        if !self.is_watched.swap(true, Ordering::Relaxed) {
            let stages = Arc::downgrade(&self.stages);
            // Without a thread the work goes on unseen.
            let _ = std::thread::Builder::new().name("progress".into()).spawn(move || watch(&stages));
        }
        Box::new(Line { running, stages: self.stages.clone() })
    }
}

/// Writes the newest stage every ten seconds, until the work has ended.
fn watch(stages: &Weak<Mutex<Vec<Arc<Running>>>>) {
    loop {
        std::thread::sleep(EVERY);
        let Some(stages) = stages.upgrade() else { return };
        let newest = stages.lock().ok().and_then(|stages| stages.last().cloned());
        if let Some(running) = newest {
            // Where nobody can be told, the report still says it.
            let _ = writeln!(std::io::stderr(), "{}", escape::terminal(&running.words()));
        }
    }
}

impl Running {
    /// Its name, and how far it has come.
    fn words(&self) -> String {
        let name = self.name.lock().map_or_else(|_| String::new(), |name| name.clone());
        let done = self.done.load(Ordering::Relaxed);
        match self.length {
            0 => format!("{name} …"),
            length => format!("{name} {:.0} %", (100.0 * done as f64 / length as f64).min(100.0)),
        }
    }
}

impl Stage for Line {
    fn set(&self, steps: u64) {
        self.running.done.store(steps, Ordering::Relaxed);
    }

    fn add(&self, steps: u64) {
        self.running.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn rename(&self, name: &str) {
        if let Ok(mut known) = self.running.name.lock() {
            name.clone_into(&mut known);
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if let Ok(mut stages) = self.stages.lock() {
            stages.retain(|running| !Arc::ptr_eq(running, &self.running));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_says_its_name_and_how_far_it_has_come_until_it_ends() {
        let lines = Lines::default();
        let newest = || lines.stages.lock().expect("not poisoned").last().map(|running| running.words());
        let outer = lines.begin("searching", 0);
        assert_eq!(newest().as_deref(), Some("searching …"));
        let inner = lines.begin("fits", 8);
        inner.add(3);
        inner.add(1);
        assert_eq!(newest().as_deref(), Some("fits 50 %"));
        inner.rename("more fits");
        inner.set(8);
        assert_eq!(newest().as_deref(), Some("more fits 100 %"));
        drop(inner);
        assert_eq!(newest().as_deref(), Some("searching …"));
        drop(outer);
        assert_eq!(newest(), None);
    }
}
