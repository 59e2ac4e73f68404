//! States what the rules of a diagnosis changed: one record each time a gate acts.
//!
//! All copies of a recording share one trace, as they share the work spent on it. Gates act in the
//! sequential parts of a diagnosis only, so that the order of the records does not depend on
//! threads.

use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;

use crate::gate::Gate;

/// Holds what one gate changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Step {
    /// The rule.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub gate: Gate,
    /// Id of the candidate that it is about; none where it is about the whole model.
    pub term: Option<&'static str>,
    /// Holds what stood before, in words or ids of candidates.
    pub before: String,
    /// Holds what stands now.
    pub after: String,
    /// Holds what the gate measured, as `Gate::quantity`.
    pub value: Option<f64>,
    /// Holds what it was compared with.
    pub threshold: Option<f64>,
}

impl Step {
    /// A step about the whole model.
    pub fn of(gate: Gate, before: impl Into<String>, after: impl Into<String>) -> Self {
        Self { gate, term: None, before: before.into(), after: after.into(), value: None, threshold: None }
    }

    /// A step that drops a term.
    pub fn drops(gate: Gate, term: &'static str) -> Self {
        Self { term: Some(term), ..Self::of(gate, "named", DROPPED) }
    }

    /// A step that keeps a candidate from being added to a model.
    pub fn keeps_out(gate: Gate, term: Option<&'static str>) -> Self {
        Self { term, ..Self::of(gate, "tried", NOT_ADDED) }
    }

    /// The same with what was measured and what it was compared with.
    pub fn measured(self, value: f64, threshold: f64) -> Self {
        let finite = |v: f64| Some(v).filter(|v| v.is_finite());
        Self { value: finite(value), threshold: finite(threshold), ..self }
    }

    /// Returns whether it is the same change as another, whatever was measured.
    fn repeats(&self, other: &Self) -> bool {
        (self.gate, self.term, &self.before, &self.after) == (other.gate, other.term, &other.before, &other.after)
    }

    /// Returns whether it kept a term from the model, or took its name.
    pub fn is_out(&self) -> bool {
        [DROPPED, NOT_ADDED].contains(&self.after.as_str())
    }
}

/// States what stands after a gate dropped a term.
const DROPPED: &str = "dropped";
/// States what stands after a gate kept a candidate out.
const NOT_ADDED: &str = "not added";

/// Steps taken so far, and the gates that never act.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    without: Arc<[Gate]>,
    steps: Arc<Mutex<Vec<Step>>>,
}

impl Trace {
    /// An empty trace in which these gates never act.
    pub fn without(gates: &[Gate]) -> Self {
        Self { without: gates.into(), ..Self::default() }
    }

    /// Returns whether a gate is not switched off: asked where the work behind it can be saved.
    pub fn is_on(&self, gate: Gate) -> bool {
        !self.without.contains(&gate)
    }

    /// Returns whether a gate acts now: records the step, unless the gate is switched off.
    pub fn acts(&self, step: Step) -> bool {
        let on = self.is_on(step.gate);
        if on {
            let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
            // Searches that begin anew repeat themselves.
            steps.retain(|s| !s.repeats(&step));
            steps.push(step);
        }
        on
    }

    /// The steps in their order; one that was repeated stands where it came last.
    pub fn steps(&self) -> Vec<Step> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_that_is_off_never_acts_and_copies_share_what_others_did() {
        let trace = Trace::without(&[Gate::Twins]);
        assert!(!trace.clone().acts(Step::drops(Gate::Twins, "a")));
        assert!(trace.clone().acts(Step::drops(Gate::Bound, "a").measured(1.0, f64::NAN)));
        assert!(trace.acts(Step::drops(Gate::Bound, "b")) && trace.acts(Step::drops(Gate::Bound, "a")));
        let terms: Vec<_> = trace.steps().iter().map(|s| (s.gate, s.term)).collect();
        assert_eq!(terms, [(Gate::Bound, Some("b")), (Gate::Bound, Some("a"))]);
    }
}
