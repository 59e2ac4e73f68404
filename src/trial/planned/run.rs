//! The run: sensors are drawn and sealed, each goes its way and is kept as a line, the truth is opened
//! after the last.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::ask;
use super::line::Line;
use super::pair::Pair;
use crate::ask::Subject;
use crate::envelope;
use crate::independent::run::{keep, kept};
use crate::scratch::Scratch;
use crate::workers::side_by_side;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};

/// Seed and number of the sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of all random draws.
    pub seed: u64,
    /// Sensors drawn; of a part of them the first recording leaves laws tied.
    pub sensors: usize,
}

/// Contents of the sealed file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truths {
    /// Always "proofmass.planned-truth/1".
    pub schema: String,
    /// Plan that the sensors were drawn by.
    pub plan: Plan,
    /// Every sensor with its law.
    pub pairs: Vec<Pair>,
}

/// Lines by sensor.
pub type Lines = BTreeMap<usize, Line>;

/// Draws the sensors and seals them; a resumed trial takes those that are sealed. Returns the seal and the
/// sensors.
///
/// # Errors
/// The file cannot be written or read, it belongs to another plan, or when stopped.
pub fn prepare(plan: Plan, path: &Path, resume: bool, control: &Control) -> Result<(String, Vec<Pair>)> {
    if resume {
        let (sealed, truths) = envelope::sealed::<Truths>(path)?;
        if truths.plan != plan {
            let cause = format!("it was started with {:?}; requested is {plan:?}", truths.plan);
            return Err(Error::new("could not resume", cause, "give the options of the interrupted trial"));
        }
        return Ok((sealed, truths.pairs));
    }
    let numbers: Vec<usize> = (0..plan.sensors).collect();
    let stage = control.stage("drawing sensors", numbers.len() as u64);
    let made = side_by_side(&numbers, |number| {
        control.go_on().map_err(|stopped| stopped.during("could not draw the sensors", "run it again"))?;
        let pair = Pair::make(plan.seed, *number);
        stage.add(1);
        Ok(pair)
    })?;
    let pairs = made.into_iter().flatten().collect();
    let truths = Truths { schema: "proofmass.planned-truth/1".into(), plan, pairs };
    let (sealed, truths) = envelope::seal(&truths, path)?;
    Ok((sealed, truths.pairs))
}

/// Lines of an interrupted run.
///
/// # Errors
/// The file is there and cannot be read.
pub fn earlier(path: &Path) -> Result<Lines> {
    Ok(kept::<Line>(path)?.into_iter().map(|l| (l.number, l)).collect())
}

/// Goes the way with every sensor that has no line yet, and keeps each as a line of a file.
///
/// # Errors
/// Nothing can be written, or when stopped.
pub fn run(pairs: &[Pair], path: &Path, mut done: Lines, subject: &Subject<'_>, control: &Control) -> Result<Lines> {
    let scratch = Scratch::new(path.parent())?;
    let open: Vec<&Pair> = pairs.iter().filter(|p| !done.contains_key(&p.number)).collect();
    let quiet = control.without_stages();
    let fresh = keep(&open, path, control, |pair| {
        let folder = scratch.case()?;
        ask::line(pair, folder.path(), subject, &quiet)
    })?;
    done.extend(fresh.into_iter().map(|line| (line.number, line)));
    Ok(done)
}

/// Opens the envelope after the last verdict.
///
/// # Errors
/// It has changed since it was sealed.
pub fn open(path: &Path, sealed: &str) -> Result<Truths> {
    envelope::open(path, sealed)
}
