//! `study --risk`: the probability that an error exceeds a limit, where it is too small to count.
//!
//! Subset simulation (`statistics::subset`) over the study's own members, whose random numbers are
//! mixed from several (`chain`), on the CPU and in f32.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use serde::{Serialize, Serializer};

use super::chain::{Chain, Link};
use super::statistic::Compared;
use super::values::{MOST_STEPS, Place, Run};
use super::watched::Watched;
use crate::control::{Control, Progress};
use crate::error::{Error, Result};
use crate::statistics::Estimate;
use crate::statistics::subset::{self, Exceedance, REPEATS, Space};
use crate::study::Study;

/// Members of the sample of each event, where the run is short enough: one in 10⁷ then has a 95 %
/// interval of ± 12 to 16 % (four studies, twelve or sixteen seeds each).
const MEMBERS: u64 = 10_000;
/// Fewest of them.
const FEWEST_MEMBERS: u64 = 1000;
/// Members that one in 10⁷ takes, as multiples of those of one sample: nine tenths for each of
/// seven events after the first, in each of the repeats.
const SAMPLES: u64 = 8 * REPEATS as u64;

/// The event that an error exceeds a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Exceeds {
    /// The error.
    #[serde(serialize_with = "by_name")]
    pub quantity: Watched,
    /// Says whether its sign is left out.
    #[serde(rename = "absolute")]
    pub is_absolute: bool,
    /// Time of it, s from the end of the still start.
    pub time_s: f64,
    /// Limit, in the unit of the error.
    pub limit: f64,
}

fn by_name<S: Serializer>(quantity: &Watched, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.serialize_str(quantity.name())
}

const FORM: &str = "need abs(QUANTITY, TIME_S) > NUMBER or signed(QUANTITY, TIME_S) > NUMBER, e.g. \
    \"abs(position_error_m, 60) > 100\"";

impl fmt::Display for Exceeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { is_absolute, quantity, time_s, limit } = self;
        write!(f, "{}({quantity}, {time_s}) > {limit}", if *is_absolute { "abs" } else { "signed" })
    }
}

impl Exceeds {
    /// Refuses an event that a study does not have, or whose members are all alike.
    ///
    /// # Errors
    /// An error that it does not have, a time outside its run; nothing is drawn.
    pub fn check(&self, study: &Study) -> Result<()> {
        self.quantity.check(study)?;
        Place::at(self.time_s, study)?;
        if study.groups().is_empty() {
            return alike(study, self);
        }
        Ok(())
    }
}

impl FromStr for Exceeds {
    type Err = String;

    /// `abs(QUANTITY, TIME_S) > NUMBER`, or `signed`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let Compared { name, quantity, time_s, number } = Compared::read(text, '>', FORM)?;
        let is_absolute = match name {
            "abs" => true,
            "signed" => false,
            _ => return Err(format!("`{name}` is neither abs nor signed; {FORM}")),
        };
        if is_absolute && number < 0.0 {
            return Err(format!("the limit is {number}: every absolute error exceeds it; need zero or more"));
        }
        Ok(Self { is_absolute, quantity: Watched::named(quantity)?, time_s, limit: number })
    }
}

/// The probability of such an event.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Risk {
    /// The event.
    #[serde(flatten)]
    pub event: Exceeds,
    /// Probability that it exceeds the limit; `None` where that is below the last of `exceeded`.
    pub probability: Option<Estimate>,
    /// Errors that are exceeded with probabilities of a tenth, a hundredth and so on, up to the limit.
    pub exceeded: Vec<Exceeded>,
    /// Members simulated.
    pub members: u64,
}

/// An error that is exceeded with some probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Exceeded {
    /// Probability to exceed it.
    pub probability: f64,
    /// The error that is.
    #[serde(flatten)]
    pub error: Estimate,
}

/// Finds the probability.
///
/// # Errors
/// An error that the study does not have, a time outside the run; members that are all alike or
/// that fail; a member that cannot be stepped; stopped.
pub fn risk(study: &Study, event: &Exceeds, control: &Control) -> Result<Risk> {
    event.check(study)?;
    let samples = Place::at(event.time_s, study)?;
    let all = samples + study.alignment.still_samples();
    let chain = Arc::new(Chain::new(all));
    let run = Run::of(&study.with_chained(chain.clone()), samples, [event.quantity])?;
    let size = sample_size(study, all);
    let mut space = Members {
        event,
        run,
        blocks: chain.blocks(all),
        chain,
        seed: study.seed,
        control,
        progress: control.stage("risk", 0),
    };
    let found = subset::exceedance(&mut space, event.limit, size as usize)?;
    check(study, event, &found)?;
    let exceeded = found.exceeded.iter().enumerate();
    Ok(Risk {
        event: *event,
        probability: found.probability,
        exceeded: exceeded
            .map(|(k, error)| Exceeded { probability: 10f64.powi(k as i32 + 1).recip(), error: *error })
            .collect(),
        members: found.states,
    })
}

fn sample_size(study: &Study, samples: u64) -> u64 {
    let [one_axis, in_motion] = MOST_STEPS;
    let most_steps = if study.in_motion.is_some() { in_motion } else { one_axis };
    let steps = samples.saturating_mul(u64::from(study.clock.steps_per_sample)).max(1);
    (most_steps / steps / SAMPLES).clamp(FEWEST_MEMBERS, MEMBERS)
}

/// Refuses an answer that says nothing.
fn check(study: &Study, event: &Exceeds, found: &Exceedance) -> Result<()> {
    if found.without > 0 {
        return Err(Error::new(
            format!("could not find the probability of {event} in {}", study.name),
            format!("{} of the first {} members left the range of their model", found.without, found.first),
            "simulate it without --risk to see which fail, and narrow what they draw",
        ));
    }
    match found.probability.is_none() && found.exceeded.is_empty() {
        true => alike(study, event),
        false => Ok(()),
    }
}

fn alike(study: &Study, event: &Exceeds) -> Result<()> {
    Err(Error::new(
        format!("could not find the probability of {event} in {}", study.name),
        "the error is the same for all members: nothing that reaches it is drawn, and there is no noise",
        "give a number a spread, e.g. --set 'accelerometer.bias_mg={ mean = 0.0, sd = 1.0 }'",
    ))
}

/// The members of a study as states of a chain.
struct Members<'a> {
    event: &'a Exceeds,
    run: Run,
    chain: Arc<Chain>,
    blocks: u64,
    seed: u64,
    control: &'a Control,
    progress: Progress,
}

impl Space for Members<'_> {
    type State = Link;
    type Error = Error;

    fn independent(&self, index: u32) -> Link {
        Link::independent(index, self.blocks)
    }

    fn moved(&self, from: &Link, kept: f64, index: u32) -> Link {
        from.moved(kept, index, self.seed)
    }

    fn responses(&mut self, states: &[Link]) -> Result<Vec<f64>> {
        self.chain.set(states.to_vec());
        let rows = self.run.several([self.event.quantity], 0..states.len() as u64, self.control)?;
        self.progress.add(states.len() as u64);
        let response = |[error]: [f64; 1]| if self.event.is_absolute { error.abs() } else { error };
        Ok(rows.into_iter().map(response).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_is_read_as_it_is_written_and_refused_in_words() {
        let event: Exceeds = "abs(position_error_m, 60) > 100".parse().expect("read");
        let expected = Exceeds { is_absolute: true, quantity: Watched::OneAxis(0), time_s: 60.0, limit: 100.0 };
        assert_eq!((event, event.to_string().parse()), (expected, Ok(expected)));
        for (wrong, word) in [
            ("position_error_m > 100", "need abs(QUANTITY"),
            ("p95(position_error_m, 60) > 100", "`p95` is neither"),
            ("abs(position_error_m, 60) < 100", "> NUMBER"),
            ("abs(position_error_m, 60) > -1", "zero or more"),
            ("abs(position_eror_m, 60) > 1", "did you mean `position_error_m`"),
        ] {
            assert!(wrong.parse::<Exceeds>().is_err_and(|e| e.contains(word)), "{wrong}");
        }
    }
}
