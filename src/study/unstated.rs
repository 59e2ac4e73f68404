//! Names what one study states of its sensor and another does not.

use std::slice;

use super::Study;
use super::tolerances::{Tolerances, keys};
use crate::sensor::SensorTerm;
use crate::units::key::Key;

impl Study {
    /// The axes of its sensor: one, or the three that a trajectory carries.
    pub fn axes(&self) -> &[Tolerances] {
        self.in_motion.as_ref().map_or(slice::from_ref(&self.tolerances), |motion| &motion.between)
    }

    /// Names of the numbers of its sensor, other than zero, that another study states by no key.
    pub fn unstated_in(&self, other: &Study) -> Vec<&'static str> {
        let says = |study: &Study, key: &Key| study.axes().iter().any(|axis| axis[key].is_some_and(|n| !n.is_zero()));
        let states = |key: &Key| other.axes().iter().any(|axis| axis[key].is_some());
        let by_any = |key: &Key| {
            let term = SensorTerm::ALL.into_iter().find(|term| term.row().keys.contains(key));
            states(key) || term.is_some_and(|term| term.row().keys.iter().any(&states))
        };
        keys().filter(|key| says(self, key) && !by_any(key)).map(|key| key.name).collect()
    }
}
