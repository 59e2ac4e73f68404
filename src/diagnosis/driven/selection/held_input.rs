//! Decides whether an input is held between its samples or smooth, where the reading is late. A
//! held input acts late by half a sample, and may have been taken for a reading that is late; if
//! that is late by less, the input seems to have been recorded late.

use crate::control::{Control, Stopped};
use crate::driven::identification::refined_scales::refined;
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Interpolation;
use crate::gate::Gate;
use crate::physics::library::Term;
use crate::physics::readout_delay::ReadoutDelay;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::candidates_round::round;
use super::deferred_linear::score_without_initial_states;
use super::earned::earned;
use super::free_forms::LEAST_LEAD;
use super::identifiability::is_linear;
use super::judged::{Judged, Rival, Selection, Trial};
use super::rivals::TIE;

/// The recording with a smooth input, where one that is taken otherwise is late, or read late, in the
/// model chosen: what is held acts late by half a sample, and may have been taken for a reading that
/// is late.
pub(crate) fn smooth_input(data: &Data, chosen: &Judged) -> Option<Data> {
    let input = data.input.as_ref().filter(|i| i.interpolation != Interpolation::BandLimited)?;
    let is_late = data.windows.is_none() && chosen.fit.structure.terms.iter().any(is_linear);
    is_late.then(|| Data { input: Some(input.clone().gone(Interpolation::BandLimited)), ..data.clone() })
}

/// Returns whether nothing is chosen but a held input that comes late, by less than the half sample
/// that this brings.
pub(crate) fn is_half_a_sample(data: &Data, held: &Selection) -> bool {
    let chosen = &held.chosen.fit;
    let is_held = data.input.as_ref().is_some_and(|i| i.interpolation == Interpolation::Hold);
    let [Term::InputLag(_)] = chosen.structure.terms[..] else { return false };
    is_held && chosen.structure.of(0, &chosen.point)[0] < 0.5 * data.interval_s()
}

/// Returns whether the model found on a smooth input does better than the one found on another, or
/// as well with fewer terms.
pub(crate) fn is_better(data: &Data, smooth: &Selection, other: &Selection) -> bool {
    let [here, there] = [smooth, other].map(|s| s.departing.as_ref().map_or(&s.chosen, |d| &d.judged));
    let [fewer, more] = [here, there].map(|j| j.fit.structure.terms.len());
    let least = if fewer < more { -LEAST_LEAD } else { LEAST_LEAD };
    let lead = score_without_initial_states(here) - score_without_initial_states(there);
    lead > least && data.trace.acts(Step::of(Gate::SmoothInput, there.words(), here.words()).measured(lead, least))
}

/// Selects the readout behind a smooth input, late or smoothed, where that does as well as a held
/// input that comes late: one law instead of two. Where it does not lead, the two are
/// indistinguishable. `base` is the base model on the smooth input.
///
/// # Errors
/// Stopped.
pub(crate) fn on_a_smooth_one(
    smooth: &Data,
    base: Judged,
    held: &Selection,
    scales: &Scales,
    control: &Control,
) -> Result<Option<Selection>, Stopped> {
    let low_pass = [Poles::One, Poles::Two].map(|poles| Term::ReadoutLowpass(ReadoutLowpass(poles)));
    let readouts = [Term::ReadoutDelay(ReadoutDelay), low_pass[0], low_pass[1]];
    let here = refined(smooth, &base.fit, scales);
    let readouts = round(smooth, &base, &readouts, &here, readouts.len(), control)?;
    let found = readouts.iter().filter_map(|t| Some(Rival { judged: t.judged.clone()?, id: t.term.id() }));
    let found: Vec<Rival> = found.filter(|r| !r.judged.fit.at_bound(&here)).collect();
    let best = found
        .iter()
        .max_by(|a, b| score_without_initial_states(&a.judged).total_cmp(&score_without_initial_states(&b.judged)))
        .cloned();
    let is_earned = |best: &Rival| earned(smooth, &base, &best.judged, scales, held.tried).is_some();
    let best = best.filter(|best| {
        score_without_initial_states(&best.judged) > score_without_initial_states(&held.chosen) - TIE && is_earned(best)
    });
    let lead = |best: &Rival| score_without_initial_states(&best.judged) - score_without_initial_states(&held.chosen);
    let step = |best: &Rival| Step::of(Gate::HalfSample, held.chosen.words(), best.id).measured(lead(best), -TIE);
    let Some(best) = best.filter(|best| smooth.trace.acts(step(best))) else { return Ok(None) };
    let lag = Rival { judged: held.chosen.clone(), id: held.chosen.fit.structure.terms[0].id() };
    let mut tied: Vec<Rival> = Vec::new();
    for rival in found.into_iter().chain([lag]) {
        let is_new = rival.id != best.id && tied.iter().all(|r| r.id != rival.id);
        if is_new && score_without_initial_states(&best.judged) - score_without_initial_states(&rival.judged) < TIE {
            tied.push(rival);
        }
    }
    let is_other = |t: &&Trial| readouts.iter().all(|r| r.term != t.term);
    let others: Vec<Trial> = held.alone.iter().filter(is_other).cloned().collect();
    let alone = readouts.iter().cloned().chain(others).collect();
    let (rivals, stand_ins) = (vec![tied], Vec::new());
    Ok(Some(Selection { base, chosen: best.judged, rivals, stand_ins, alone, departing: None, ..held.clone() }))
}
