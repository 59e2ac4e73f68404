//! Whether what an input that is held between its samples leaves is its own: held, it looks late by
//! half a sample and weaker at high frequencies, and a reading that comes late by less asks of a
//! held input that it come early.

use crate::control::{Control, Stopped};
use crate::diagnosis::driven::identification::refined_scales::refined;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::intake::input::Interpolation;
use crate::physics::library::Term;
use crate::physics::readout_delay::ReadoutDelay;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::scales::Scales;

use super::judged::{Judged, Rival, Selection};
use super::kept_back::worth;
use super::rivals::TIE;
use super::round::round;

/// The recording with a smooth input, where one that is taken as held comes late, and nothing else,
/// by less than the half sample that this brings.
pub(crate) fn smooth_input(data: &Data, held: &Selection) -> Option<Data> {
    let chosen = &held.chosen.fit;
    let input = data.input.as_ref().filter(|i| i.interpolation == Interpolation::Hold)?;
    let [Term::InputLag(_)] = chosen.structure.terms[..] else { return None };
    let is_less = chosen.structure.of(0, &chosen.point)[0] < 0.5 * data.interval_s();
    is_less.then(|| Data { input: Some(input.clone().gone(Interpolation::BandLimited)), ..data.clone() })
}

/// The readout behind a smooth input, late or smoothed, where that does as well as a held input that
/// comes late: one law in the place of two. Where it does not lead, the two are tied. `base` is the
/// base model on the smooth input.
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
    let alone = round(smooth, &base, &readouts, &here, readouts.len(), control)?;
    let found = alone.iter().filter_map(|t| Some(Rival { judged: t.judged.clone()?, id: t.term.id() }));
    let found: Vec<Rival> = found.filter(|r| !r.judged.fit.at_bound(&here)).collect();
    let best = found.iter().max_by(|a, b| worth(&a.judged).total_cmp(&worth(&b.judged))).cloned();
    let Some(best) = best.filter(|best| worth(&best.judged) > worth(&held.chosen) - TIE) else { return Ok(None) };
    let lag = Rival { judged: held.chosen.clone(), id: held.chosen.fit.structure.terms[0].id() };
    let mut tied: Vec<Rival> = Vec::new();
    for rival in found.into_iter().chain([lag]) {
        let is_new = rival.id != best.id && tied.iter().all(|r| r.id != rival.id);
        if is_new && worth(&best.judged) - worth(&rival.judged) < TIE {
            tied.push(rival);
        }
    }
    Ok(Some(Selection { base, chosen: best.judged, rivals: vec![tied], alone, departing: None, ..held.clone() }))
}
