//! Beginnings of laws next to sets, remembered.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use super::kind::{Point, Set};

/// A beginning of one law next to a set, and what a linear step from there promises.
#[derive(Debug, Clone)]
pub(super) struct Prospect {
    /// The law.
    pub law: usize,
    /// Points from which a fit may begin.
    pub beginnings: Vec<Point>,
    /// Change of the prediction.
    pub direction: Vec<f64>,
    /// Fall of the sum of squares.
    pub promise: f64,
}

/// A set, the bits of the error that it leaves, and the law that joins it.
type Joining = (Set, u64, usize);

/// Prospects so far.
#[derive(Debug, Default)]
pub(super) struct Prospects(Mutex<HashMap<Joining, Arc<Vec<Prospect>>>>);

impl Prospects {
    /// Returns the prospects of a law next to a set, looked for once.
    pub(super) fn of(&self, joining: Joining, find: impl FnOnce() -> Vec<Prospect>) -> Arc<Vec<Prospect>> {
        if let Some(known) = self.0.lock().ok().and_then(|map| map.get(&joining).cloned()) {
            return known;
        }
        let found = Arc::new(find());
        if let Ok(mut map) = self.0.lock() {
            map.insert(joining, found.clone());
        }
        found
    }
}
