//! `study --digits D`: enough members for D digits of the last position error to be stable.
//!
//! The first blocks of members tell how many that is (`statistics::jcgm101`); the study then runs
//! with that number like any other, so that it can be stopped and resumed.

use super::values::{Place, Work};
use super::watched::Watched;
use crate::backend::flight::Quantity;
use crate::control::Control;
use crate::drift::Drift;
use crate::error::{Error, Result};
use crate::statistics::jcgm101::{self, BLOCK, BLOCKS, Linear, Need, Stated};
use crate::statistics::quantity;
use crate::strapdown::answer::Answer;
use crate::study::{Study, StudyText};

/// Returns the number of members that it takes.
///
/// # Errors
/// A study that cannot be simulated; stopped.
pub fn need(study: &Study, digits: u32, control: &Control) -> Result<Need> {
    let samples = study.clock.report_samples.last().copied().unwrap_or(study.clock.samples);
    let place = Place { quantity: Watched::drift(study), samples };
    let mut work = Work::new(control, "first stage");
    let mut blocks = Vec::new();
    for k in 0..BLOCKS {
        let mut values = work.values(study, place, k * BLOCK..(k + 1) * BLOCK)?;
        values.retain(|v| v.is_finite());
        if values.len() < 2 {
            return Err(Error::new(
                format!("could not simulate {}", study.name),
                "nearly all members diverged: their position error is not finite",
                "some error, spring or excitation is far too large; check the exponents and units of the study",
            ));
        }
        blocks.push(jcgm101::block(&mut values));
    }
    Ok(jcgm101::need(&blocks, digits))
}

/// The study with enough members for this many stable digits.
///
/// # Errors
/// As [`need`]; more members than can be addressed.
pub fn sized(source: &StudyText, digits: u32, control: &Control) -> Result<Study> {
    let study = source.study()?;
    let need = need(&study, digits, control)?;
    control.remark(&format!("{} members for {digits} stable digits", need.trials));
    source.with_members(need.trials)
}

/// The horizontal error of a study in motion at its last report time, with `digits` digits of its
/// standard uncertainty.
/// Without a linear answer next to it: a distance is no linear function of the errors.
pub fn stated_in_motion(answer: &Answer, digits: u32) -> Option<Stated> {
    let last = answer.report.last()?;
    Some(Stated::of_summary(answer.ensemble.summary(*last, Quantity::Horizontal), digits))
}

/// The position error at the last report time, with `digits` digits of its standard uncertainty,
/// and the linear (GUM) result.
pub fn stated(drift: &Drift, digits: u32) -> Option<(Stated, Linear)> {
    let summary = drift.at_report(quantity::POSITION).pop()?;
    let stated = Stated::of_summary(summary, digits);
    let expected = drift.expected.total(quantity::POSITION);
    let linear = expected.get(*drift.report.last()?)?;
    Some((stated, stated.beside(linear.mean, linear.variance.sqrt())))
}
