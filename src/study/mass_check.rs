//! Whether the numbers of a proof mass, and of what reads it, go together.

use super::refusal::refuse;
use super::tolerances::Tolerances;
use crate::error::Result;
use crate::excitation::plan::Variation;
use crate::number::short;
use crate::physics::{end_stop, one_sided_stop, stiffness_drift};
use crate::sensor::{SensorTerm, mechanics};
use crate::units::key::Key;
use crate::units::number::Number;

/// Refuses a delay that differs between members: it is one of the force that all of them share.
pub(super) fn one_delay(name: &str, all: &Tolerances) -> Result<()> {
    let key = &SensorTerm::ReadoutDelay.row().keys[0];
    match all[key] {
        None | Some(Number::Fixed(_)) => Ok(()),
        Some(_) => Err(refuse(
            name,
            format!("`{}` is drawn per member: a study runs one delay for all of them", key.path),
            format!("give one number, and sweep it for others, e.g. [sweep] {} = \"0.001:0.01:4\"", key.path),
        )),
    }
}

/// Refuses a delay beside a sine that is drawn per member.
pub(super) fn delayed_force(name: &str, all: &Tolerances, variation: Variation) -> Result<()> {
    let key = &SensorTerm::ReadoutDelay.row().keys[0];
    if variation != Variation::Sine || all[key].is_none_or(|n| n.is_zero()) {
        return Ok(());
    }
    Err(refuse(
        name,
        format!("`{}` cannot be combined with a sine that is drawn per member", key.path),
        "give the sine's amplitude, frequency and phase as one number each",
    ))
}

/// Which of the two numbers of a stop is given, and which is not, where they are apart.
fn end_stops(all: &Tolerances) -> Option<(&'static Key, &'static Key)> {
    [end_stop::GIVEN, one_sided_stop::GIVEN].into_iter().find_map(|given| {
        let (stiffness, place) = (&given[0].key, &given[1].key);
        match (all[stiffness].is_some(), all[place].is_some()) {
            (true, false) => Some((stiffness, place)),
            (false, true) => Some((place, stiffness)),
            _ => None,
        }
    })
}

/// Refuses numbers of a proof mass that do not determine it, or determine it twice.
pub(super) fn mechanics(name: &str, all: &Tolerances) -> Result<()> {
    let given = |key: &&Key| all[key].is_some();
    let first = |keys: &'static [Key]| keys.iter().find(given);
    let (modal, further, physical) = (first(mechanics::MODAL), first(mechanics::further()), first(mechanics::PHYSICAL));
    if let (Some(a), Some(b)) = (modal, physical) {
        return Err(refuse(
            name,
            format!("`{}` and `{}` describe the proof mass in two ways", a.path, b.path),
            "give either resonance, damping ratio and cubic stiffness, or mass, damping, stiffness and cubic stiffness",
        ));
    }
    if let Some((has, lacks)) = end_stops(all) {
        let cause = format!("`{}` is given without `{}`", has.path, lacks.path);
        return Err(refuse(name, cause, format!("add `{}`, or remove both", lacks.path)));
    }
    let missing = match (modal.or(further), physical) {
        (_, Some(p)) => [&mechanics::MASS, &mechanics::STIFFNESS].into_iter().find(|m| !given(m)).map(|m| (p, m)),
        (Some(p), None) if !given(&&mechanics::RESONANCE) => Some((p, &mechanics::RESONANCE)),
        _ => None,
    };
    match missing {
        Some((has, lacks)) => Err(refuse(
            name,
            format!("`{}` is given without `{}`", has.path, lacks.path),
            format!("add `{}`, or leave the mechanics out for an ideal proof mass", lacks.path),
        )),
        None => Ok(()),
    }
}

/// Refuses a spring that drifts to nothing before the study ends.
pub(super) fn lasting_spring(name: &str, all: &Tolerances, duration_s: f64) -> Result<()> {
    let key = &stiffness_drift::GIVEN[0].key;
    let (drift_per_s, _) = all.moments(key);
    if all[key].is_none() || 1.0 + drift_per_s * duration_s > 0.0 {
        return Ok(());
    }
    Err(refuse(
        name,
        format!("`{}` = {} leaves no spring after {} s", key.path, short(drift_per_s), short(-1.0 / drift_per_s)),
        format!("need more than {} per s for {} s, or a shorter study", short(-1.0 / duration_s), short(duration_s)),
    ))
}
