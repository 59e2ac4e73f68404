//! States what the omission costs: how far a navigator errs with the original model, and with the
//! named physics, in one sentence and as a table.
//!
//! A flight is flown again, uncorrected and repaired, by the two studies that are written next to the
//! page; for the other kinds see `consequence` of the diagnosis.

use std::path::Path;

use proofmass_base::control::Control;
use proofmass_base::error::{Error, Kind as Failure, Result};
use proofmass_base::number::significant;
use proofmass_diagnosis::answer::Detail;
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::repair::{Cost, Row};
use proofmass_diagnosis::verdict::Verdict;
use proofmass_diagnosis::{consequence, repaired};
use proofmass_simulate::strapdown::position::position_rms_m;
use proofmass_study::overrides::Overrides;
use proofmass_study::{Surroundings, parse_watched};

use super::words::Diagnosis;
use crate::table::Table;

/// Navigators of a flight that is flown again: they settle a root mean square to 1/√(2 · 256), 4 %.
const MEMBERS: u64 = 256;

/// Computes what leaving out the named physics costs; what a flight's calibration is worth.
///
/// # Errors
/// Stopped.
pub fn costs(diagnosis: &Diagnosis, control: &Control) -> Result<Vec<Cost>> {
    if let Detail::Trajectory(detail) = &diagnosis.detail {
        let verdict = &diagnosis.verdict;
        let goes = detail.repaired.as_ref().is_some_and(|sensor| sensor.along.lacks.is_none());
        let under = if goes { "along the recorded motion" } else { "at rest" };
        let studies = [
            (Row::Before, "uncorrected.toml: constants left in", repaired::uncorrected(&diagnosis.detail, verdict)),
            (Row::After, "repaired.toml", repaired::document(None, &diagnosis.detail, verdict)),
        ];
        let mut rows = Vec::new();
        for (row, of, study) in studies {
            let Some(study) = study else { continue };
            match flown(&study, control) {
                Ok([ten, sixty]) => rows.push(Cost {
                    row,
                    of: of.into(),
                    under: under.into(),
                    position_10_s_m: ten,
                    position_60_s_m: sixty,
                    basis: format!("that study with {MEMBERS} members, ideal start: root mean square"),
                }),
                Err(stopped) if stopped.kind == Failure::Interrupted => return Err(stopped),
                // What no study can fly, because of its limits, has no cost in metres.
                Err(_) => {}
            }
        }
        return Ok(rows);
    }
    consequence::costs(diagnosis.repair.as_ref(), control)
        .map_err(|s| s.during("could not state the cost in metres", "start it again"))
}

/// Root mean square of the position error of a study in motion after 10 s and 60 s, m; no number for a
/// time beyond its end.
fn flown(study: &str, control: &Control) -> Result<[f64; 2]> {
    let overrides = Overrides { members: Some(MEMBERS), ..Overrides::default() };
    let surroundings = Surroundings::new(Path::new("."), control);
    let study = parse_watched("the repaired sensor", study, &overrides, &surroundings)?;
    let motion = study.in_motion.as_ref().ok_or_else(|| {
        Error::new("could not fly the repaired sensor", "its study has no [trajectory]", "state the cost by a study")
    })?;
    let errors = position_rms_m(&study, motion, control)?;
    let after = |time_s: f64| errors.iter().find(|(t, _)| (t - time_s).abs() < 1e-3).map_or(f64::NAN, |(_, m)| *m);
    Ok([after(10.0), after(60.0)])
}

/// A length to two digits; a dash where there is none.
fn metres(value: f64) -> String {
    if value.is_finite() { significant(value, 2) } else { "–".into() }
}

/// Says how far a navigator errs with the original model, and with the named physics.
pub(super) fn sentence(costs: &[Cost], diagnosis: &Diagnosis) -> Option<String> {
    let of = |row: Row| costs.iter().find(|c| c.row == row).filter(|c| c.position_10_s_m.is_finite());
    let verdict: &Verdict = &diagnosis.verdict;
    let names = !verdict.effects.is_empty();
    let (before, after) = (of(Row::Before), of(Row::After));
    if let (None, Some(only)) = (before, after)
        && !names
    {
        let [ten, sixty] = [only.position_10_s_m, only.position_60_s_m].map(metres);
        let later =
            if only.position_60_s_m.is_finite() { format!(" and by {sixty} m after 60 s") } else { String::new() };
        return Some(format!("{}, a navigator errs by {ten} m after 10 s{later}", only.under));
    }
    let (before, after) = (before?, after?);
    let [old, new] = [before, after].map(|c| metres(c.position_10_s_m));
    // A recording shorter than that has no such number.
    let later = if [before, after].iter().all(|c| c.position_60_s_m.is_finite()) {
        let [old, new] = [before, after].map(|c| metres(c.position_60_s_m));
        format!(" (after 60 s {old} m and {new} m)")
    } else {
        String::new()
    };
    let under = &before.under;
    match verdict.kind {
        // What a calibration subtracts is known whether it has a name or not.
        Kind::Trajectory => Some(format!(
            "{under}, a navigator errs by {old} m after 10 s with the sensor uncorrected, by {new} m with it \
             repaired{later}"
        )),
        // Noise is no error of a navigator's model that a better one takes away.
        Kind::Static if names => Some(format!(
            "{under}, the old model predicts a position error of {old} m after 10 s, the repaired one {new} m{later}"
        )),
        _ if names => Some(format!(
            "{under}, a navigator with the old model errs by {old} m after 10 s, with the repaired one by {new} \
             m{later}"
        )),
        _ => None,
    }
}

/// The rows as a table.
pub(super) fn table(costs: &[Cost]) -> Table {
    let mut table = Table::new(&["of", "under", "after 10 s, m", "after 60 s, m", "computed by"]);
    for c in costs {
        let [ten, sixty] = [c.position_10_s_m, c.position_60_s_m].map(metres);
        table.row([c.of.clone(), c.under.clone(), ten, sixty, c.basis.clone()]);
    }
    table
}
