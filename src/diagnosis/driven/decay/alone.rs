//! The answer of one recording that no other is joined to, by free simulation.

use crate::answer::Answer;
use crate::driven::intake::several::Taken;
use crate::driven::verdict::asked::Asked;
use crate::model;
use crate::recording::Recording;

use super::searched::{self, Decay};
use super::{answer, driven};

/// The answer of a free decay, and whether what its model leaves is noise with a memory; `None` where
/// an input drives it, samples are kept for validation, or nothing swings.
pub(in crate::driven) fn decayed(
    recording: &Recording,
    taken: &Taken,
    model: &model::Driven,
) -> Option<(Answer, bool)> {
    let Taken { prepared, pieces, .. } = taken;
    let is_displacement = model.output_is == model::Output::Displacement;
    let is_driven = prepared.data.input.is_some();
    if (is_driven && is_displacement) || prepared.data.own_test || pieces.len() != 1 {
        return None;
    }
    let decay = match is_driven {
        true => driven::driven(prepared)?,
        false => searched::decay(&prepared.data, &prepared.filled)?,
    };
    Some((of_decay(recording, taken, model, &decay), decay.leaves_noise_with_memory()))
}

/// Returns whether a recording that is refused as a whole may be searched in segments: it has an input, and no
/// samples are kept for validation.
pub(in crate::driven) fn may_be_segmented(taken: &Taken) -> bool {
    let data = &taken.prepared.data;
    taken.pieces.len() == 1 && !data.own_test && data.input.is_some()
}

/// The answer where an input drives a mass whose resonance moves so far that no oscillator follows the whole
/// recording: in short segments one may. `None` where nothing accounts for what the base model leaves there.
pub(in crate::driven) fn segmented(recording: &Recording, taken: &Taken, model: &model::Driven) -> Option<Answer> {
    let decay = driven::driven(&taken.prepared)?;
    decay.is_accounted_for().then(|| of_decay(recording, taken, model, &decay))
}

/// Puts what a search found into the answer that all kinds give.
fn of_decay(recording: &Recording, taken: &Taken, model: &model::Driven, decay: &Decay) -> Answer {
    let Taken { prepared, pieces, judging } = taken;
    let asked = Asked { recording, pieces, judging, columns: &model.columns, unit: model.unit.as_deref() };
    answer::answer(&asked, decay, prepared.notes.clone())
}
