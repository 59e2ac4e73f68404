//! What a diagnosis at rest says while it works.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use libtest_mimic::Failed;
use proofmass::control::{Control, Stage, Watcher};
use proofmass::diagnosis::rest;
use proofmass::rng::{Philox, Stream};

use super::plant::white;
use super::{asked, check};

/// Notes what it is told: the steps of the last stage that has any.
#[derive(Clone, Default)]
struct Counted {
    stages: Arc<Mutex<Vec<String>>>,
    steps: Arc<AtomicU64>,
}

impl Stage for Counted {
    fn set(&self, _: u64) {}
    fn add(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
    }
    fn rename(&self, _: &str) {}
}

impl Watcher for Counted {
    fn stopped_by(&self) -> Option<&'static str> {
        None
    }
    fn begin(&self, name: &str, length: u64) -> Box<dyn Stage> {
        self.stages.lock().expect("not poisoned").push(format!("{name} {length}"));
        Box::new(self.clone())
    }
    fn remark(&self, _: &str) {}
}

pub(super) fn told() -> Result<(), Failed> {
    let mut rng = Philox::new(1, 1, Stream::Host);
    let (recording, model) = asked((0..3).map(|_| white(600, &mut rng)).collect(), None);
    let counted = Counted::default();
    rest::diagnose(&recording, &model, &Control::new(counted.clone()))?;
    let stages = counted.stages.lock().expect("not poisoned").clone();
    check(stages == ["searching the laws of each channel 3"], format!("{stages:?}"))?;
    let steps = counted.steps.load(Ordering::Relaxed);
    check(steps == 3, format!("{steps} steps"))
}
