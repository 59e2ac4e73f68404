//! Plans the next experiment: of those that a shaker allows, the shortest after which a diagnosis most
//! probably decides rightly, where each of the rivals is as likely to be true as another.
//!
//! Chain: `limits` → `experiment` → `question` → `asked` → `simulated` → `chance` → `strength` → `search` →
//! `confirm`. One idea throughout: what the best rival leaves of the truth's motion, over the noise, is a
//! noncentrality, and every comparison that a diagnosis makes is a log-likelihood ratio of known law in it.
//! Not for naming anything: the laws, their simulation and the comparisons are those of `driven`.

pub mod asked;
pub mod chance;
pub mod confirm;
pub mod experiment;
pub mod limits;
pub mod question;
pub mod search;
mod simulated;
mod strength;

use crate::control::Control;
use crate::error::{Error, Result};

use confirm::Confirmed;
use limits::Limits;
use question::Question;
use search::Planned;

/// Requests next to the question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wish {
    /// Probability of a right decision at which an experiment is long enough.
    pub probability: f64,
    /// Times that the best experiments are recorded and diagnosed under each rival.
    pub confirm: usize,
}

/// Finds the experiment, and diagnoses recordings of it where that is wished.
///
/// # Errors
/// A wish for no probability; when stopped; where no experiment can be simulated.
pub fn plan(question: &Question, limits: &Limits, wish: Wish, control: &Control) -> Result<(Planned, Vec<Confirmed>)> {
    if !(wish.probability > 0.0 && wish.probability < 1.0) {
        let cause = format!("--probability {} is no probability between zero and one", wish.probability);
        return Err(Error::new("could not plan an experiment", cause, "0.95 decides rightly in 19 of 20 cases"));
    }
    let planned = search::search(question, limits, wish.probability, control)?;
    let asked = planned.proposals().take(if wish.confirm > 0 { 2 } else { 0 });
    let confirmed = asked.map(|p| confirm::confirm(&planned.question, &p.experiment, wish.confirm, control));
    let confirmed = confirmed.collect::<Result<_, _>>().map_err(search::stopped)?;
    Ok((planned, confirmed))
}
