//! Questions about one error of a study, answered next to its drift where they are asked.

use serde::Serialize;

use super::risk::{Exceeds, Risk, risk};
use super::variance::{self, Variance, variance};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::study::Study;

/// The questions.
#[derive(Debug, Clone, Copy, Default)]
pub struct Questions {
    /// Says whether the variance of the last position error is to be shared among its sources.
    pub variance: bool,
    /// The event whose probability is to be found.
    pub risk: Option<Exceeds>,
}

/// The answers to those that were asked.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Further {
    /// The variance of the last position error, shared among its sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variance: Option<Variance>,
    /// The probability that an error exceeds a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub risk: Option<Risk>,
}

impl Questions {
    /// Refuses what cannot be asked of a study, before it is simulated.
    ///
    /// # Errors
    /// A study at several values of a key, members that are all alike; an error that it does not
    /// have, a time outside its run.
    pub fn check(&self, study: &Study) -> Result<()> {
        if !self.variance && self.risk.is_none() {
            return Ok(());
        }
        if study.sweep.is_some() {
            let what = if self.variance { "share the variance" } else { "find a probability" };
            return Err(Error::new(
                format!("could not {what} of {}", study.name),
                "its [sweep] asks for several studies, and each has its own",
                "leave [sweep] out and give each value with --set KEY=VALUE and its own --out",
            ));
        }
        if self.variance {
            variance::check(study)?;
        }
        self.risk.iter().try_for_each(|event| event.check(study))
    }

    /// Answers them.
    ///
    /// # Errors
    /// As [`check`](Self::check); a member that cannot be stepped; stopped.
    pub fn answer(&self, study: &Study, control: &Control) -> Result<Further> {
        Ok(Further {
            variance: self.variance.then(|| variance(study, control)).transpose()?,
            risk: self.risk.map(|event| risk(study, &event, control)).transpose()?,
        })
    }
}

impl Further {
    /// Nothing was asked.
    pub const NONE: &Self = &Self { variance: None, risk: None };

    /// Returns whether nothing was asked.
    pub fn is_empty(&self) -> bool {
        self.variance.is_none() && self.risk.is_none()
    }
}
