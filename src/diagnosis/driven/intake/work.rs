//! Counts the integration steps computed on a recording, so that a diagnosis ends at the same place
//! on every machine. Not a clock.
//!
//! Each stage has a budget of its own: the search for terms, the look for others that would do as
//! well, the conclusion with its intervals. It is looked at where all fits begun have ended; what
//! has been begun is finished, so that a stage overruns its budget by at most the fits of one step.
//! The verdict reports what a stage had to leave out.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples that a stage may always take for granted: shorter recordings get the work of this many.
const LEAST_SAMPLES: usize = 20_000;

/// Integration steps that a stage may spend per sample, eight parameter sets side by side counted
/// as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The base model and the search for terms.
    Search,
    /// The search again, with the input going otherwise between its samples.
    SearchAgain,
    /// Candidates instead of others.
    Rivals,
    /// Linear laws that the search defers.
    KeptBack,
    /// Laws with a free form.
    Forms,
    /// Laws whose form has an exponent, which the search defers.
    KeptShapes,
    /// Final fits, what each term is worth, intervals and profiles.
    Conclusion,
}

impl Stage {
    fn steps_per_sample(self) -> u64 {
        match self {
            Stage::Search => 5000,
            Stage::SearchAgain | Stage::KeptBack | Stage::KeptShapes => 2500,
            Stage::Forms => 3000,
            Stage::Rivals | Stage::Conclusion => 4000,
        }
    }
}

/// Work count at which a stage must stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget(u64);

impl Budget {
    /// The longer of two.
    pub fn or(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
}

/// A counter that all copies of a recording share.
#[derive(Debug, Clone, Default)]
pub struct Work(Arc<AtomicU64>);

impl Work {
    /// Adds integration steps to the work done.
    pub fn add(&self, steps: usize) {
        self.0.fetch_add(steps as u64, Ordering::Relaxed);
    }

    /// Returns the work up to which a stage that begins here may go on this many samples.
    pub fn budget(&self, stage: Stage, samples: usize) -> Budget {
        Budget(self.spent() + stage.steps_per_sample() * samples.max(LEAST_SAMPLES) as u64)
    }

    /// Returns whether a stage should come to an end.
    pub fn is_spent(&self, budget: Budget) -> bool {
        self.spent() > budget.0
    }

    /// Steps so far. The same for every number of threads wherever all fits begun have ended.
    fn spent(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_has_a_budget_of_its_own_from_where_it_begins() {
        let work = Work::default();
        let search = work.budget(Stage::Search, 40_000);
        work.clone().add(5000 * 40_000);
        assert!(!work.is_spent(search));
        work.add(1);
        let (again, rivals) = (work.budget(Stage::SearchAgain, 100), work.budget(Stage::Rivals, 100));
        assert!(work.is_spent(search) && !work.is_spent(search.or(again)) && !work.is_spent(rivals));
        work.add(2500 * LEAST_SAMPLES + 1);
        assert!(work.is_spent(again) && !work.is_spent(rivals));
    }
}
