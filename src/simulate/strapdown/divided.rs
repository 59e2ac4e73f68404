//! A study in motion divided among machines: one ensemble, cut between blocks of members, and the
//! answer from the files of all shards.

use std::path::Path;

use super::answer::{Answer, flight, of_ensemble};
use super::run::Ensemble;
use super::share::Results;
use super::windows;
use crate::control::Control;
use crate::drift::carried::{self, Line, refuse};
use crate::error::{Error, Result};
use crate::kernel::cpu::reduce::BLOCK;
use crate::kernel::flight::Flight;
use crate::shard::file::{Header, damaged};
use crate::shard::gather::Found;
use crate::shard::{Part, Shard};
use crate::study::Study;
use crate::study::in_motion::InMotion;

fn parts(flight: &Flight) -> Vec<Part> {
    vec![Part { units: flight.members(), grain: BLOCK as u64, effort: flight.clock().samples }]
}

/// The head of a shard's file before anything is done.
///
/// # Errors
/// As [`flight`].
pub fn header(study: &Study, motion: &InMotion, input: Option<&Path>, shard: Shard) -> Result<Header> {
    Ok(Line::of(study, parts(&flight(study, motion)?), input)?.header(shard))
}

/// The answer to a study from the files of all its shards.
///
/// # Errors
/// A file that is damaged; a recording of the study that has changed; shards of machines that give
/// other bits.
pub fn merged(study: &Study, motion: &InMotion, found: &[Found], control: &Control) -> Result<Answer> {
    let compared = windows::compare(motion, control)?;
    let flight = flight(study, motion)?;
    carried::identity(study, &parts(&flight), found)?;
    let mut whole: Option<Results> = None;
    for file in found {
        control
            .go_on()
            .map_err(|s| s.during("could not finish the merge", "run it again: the shards are as they were"))?;
        let contents = file.contents()?;
        for (_, bytes) in contents.pieces().filter(|(_, bytes)| !bytes.is_empty()) {
            let results = Results::read(bytes, &file.path)?;
            if !results.totals.fit(&flight) {
                return Err(damaged(&file.path, "its sums are not at the times of this study"));
            }
            whole = Some(match whole {
                None => results,
                Some(sum) => added(sum, results, &file.path)?,
            });
        }
    }
    let whole = whole.ok_or_else(|| refuse("nothing was summed".into(), "run the shards again"))?;
    let ensemble = Ensemble::of(&flight, &whole.totals, whole.machine, whole.seconds);
    of_ensemble(study, motion, flight, ensemble, compared, control)
}

fn added(mut sum: Results, next: Results, path: &Path) -> Result<Results> {
    if !sum.machine.same_bits(&next.machine) || !sum.totals.absorb(&next.totals) {
        let of = |r: &Results| format!("{} ({}, {})", r.machine.name, r.machine.kind, r.machine.driver);
        return Err(Error::new(
            "could not merge the shards of a study",
            format!("{} was integrated on {}, others on {}: their bits differ", path.display(), of(&next), of(&sum)),
            "run those shards again on one kind of machine, e.g. all with --backend cpu",
        ));
    }
    sum.seconds += next.seconds;
    Ok(sum)
}
