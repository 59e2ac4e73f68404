//! The base model of a recording, and whether another way of the input between its samples would do
//! what terms seem to.

use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::ops::Range;

use crate::control::{Control, Stopped};
use crate::driven::base::{BASE, OMEGA};
use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::start;
use crate::driven::intake::data::Data;
use crate::driven::intake::dependence::{bends, depends};
use crate::driven::intake::input::Interpolation;
use crate::driven::intake::notes::Notes;
use crate::driven::simulation::run::trace;
use crate::driven::simulation::structure::ModelStructure;
use crate::model;
use crate::number::short;
use crate::numerics::moments::mean_sd;
use crate::physics::input_lag::InputLag;
use crate::physics::library::Term;
use crate::physics::readout_delay::ReadoutDelay;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::scales::Scales;
use crate::remainder::REAL;

use super::at_once;
use super::held_out::held_out;
use super::judged::Judged;
use super::residual_structure::residual_structure_of_noise;

/// Fits whose mean squares differ by a smaller factor are alike.
const ALIKE: f64 = 1.01;
/// Share of the reading's power that an oscillator must explain to be one.
const LEAST_SHARE: f64 = 0.02;
/// Log-likelihood that it must gain in a ring-down, whose later part may be nothing but noise.
const LEAST_GAIN: f64 = 20.0;
/// Share of what it leaves that may be predictable before that is more than noise.
const STRUCTURED: f64 = 0.05;
/// Factor by which a hint may be off before it is worth a word.
const HINT: f64 = 4.0;

/// No oscillator explains a reading.
#[derive(Debug)]
pub(crate) enum NoOscillator {
    /// None can be fitted.
    None,
    /// The best one explains next to nothing.
    Poor {
        /// The best one.
        best: Box<(Fit, Scales)>,
        /// States how much it explains, as a clause.
        explains: String,
    },
}

impl NoOscillator {
    /// Returns why the recording is refused, in words.
    pub(crate) fn cause(&self) -> String {
        match self {
            Self::None => "no oscillator, at any resonance or damping, can be fitted to it".to_owned(),
            Self::Poor { explains, .. } => format!("no oscillator can be identified: the best one {explains}"),
        }
    }
}

/// The base fit; notes what a reader must know of it.
///
/// # Errors
/// Where no oscillator explains the reading.
pub(crate) fn base(data: &Data, hints: &model::Start, notes: &mut Notes) -> Result<(Fit, Scales), NoOscillator> {
    let Some(best) = start::base(data, hints) else {
        return Err(NoOscillator::None);
    };
    let fit = &best.0;
    let rows: Vec<f64> = data.train.iter().flat_map(|r| &data.reading[r.clone()]).copied().collect();
    let residual = fit.variance / mean_sd(&rows).1.powi(2).max(1e-300);
    let gain = -0.5 * rows.len() as f64 * residual.min(1.0).ln();
    // Of the power of both: after a single blow little moves where it was not fitted.
    let unseen = data.validation.iter().flat_map(|r| &data.reading[r.clone()]);
    let power = mean_sd(&rows.iter().chain(unseen).copied().collect::<Vec<f64>>()).1.powi(2);
    let predicted = 1.0 - held_out(data, fit, &best.1, &data.validation).free() / power.max(1e-300);
    if gain < LEAST_GAIN || (data.input.is_some() && (1.0 - residual).min(predicted) < LEAST_SHARE) {
        let explains = format!(
            "explains {} % of the output's power where it was fitted and {} % elsewhere",
            short(100.0 * (1.0 - residual).max(0.0)),
            short(100.0 * predicted.max(0.0))
        );
        return Err(NoOscillator::Poor { best: Box::new(best), explains });
    }
    let hz = fit.point[OMEGA] / TAU;
    if let Some(at_once) = at_once::found(data, &best) {
        notes.findings.push(at_once::WORDS.to_owned());
        return Ok(at_once);
    }
    if hz > 0.5 * data.rate_hz {
        notes.doubt(
            format!(
                "no resonance can be identified: the one fitted, {} Hz, lies above half the sampling rate, {} Hz",
                short(hz),
                short(0.5 * data.rate_hz)
            ),
            "; what happens there cannot be seen in this recording",
        );
    } else if let Some(hint) = hints.resonance_hz.filter(|h| (hz / h).ln().abs() > HINT.ln()) {
        notes.doubt(
            format!("the resonance found, {} Hz, is far from the hint, {} Hz", short(hz), short(hint)),
            ": a rate or a hint in the wrong unit?",
        );
    }
    Ok(best)
}

/// Returns whether the residual that a linear oscillator leaves of the reading has structure.
fn is_structured(data: &Data, fit: &Fit) -> bool {
    let left = residual_structure_of_noise(data, fit).structure;
    left.p_value < REAL && left.r_squared > STRUCTURED
}

/// Returns whether the residual that this linear oscillator leaves of the reading is more than
/// noise: it has structure, or depends on the input still.
///
/// # Errors
/// Stopped.
pub(crate) fn leaves_more_than_noise(data: &Data, fit: &Fit, control: &Control) -> Result<bool, Stopped> {
    if is_structured(data, fit) {
        return Ok(true);
    }
    let Some(input) = &data.input else { return Ok(false) };
    let (errors, _) = trace(data, &fit.structure, &fit.point, &fit.run(data, false));
    depends(&input.samples()[data.hull.clone()], &errors, &(0..errors.len()), control)
}

/// Returns whether the reading follows its input by another law, though hardly anything of a linear
/// one is to be seen: it has structure that this oscillator does not describe, and the input bends
/// it. Noise has no such structure, or does not know the input.
///
/// # Errors
/// Stopped.
pub(crate) fn follows_another_law(data: &Data, fit: &Fit, control: &Control) -> Result<bool, Stopped> {
    let Some(input) = data.input.as_ref().filter(|_| is_structured(data, fit)) else { return Ok(false) };
    let reading = &data.reading[data.hull.clone()];
    bends(&input.samples()[data.hull.clone()], reading, &(0..reading.len()), control)
}

/// Puts the base model's readings where none were recorded: a straight line there would be taken
/// for physics.
pub(crate) fn bridge(data: &mut Data, base: &Fit, filled: &[Range<usize>]) {
    if filled.is_empty() {
        return;
    }
    let (errors, _) = trace(data, &base.structure, &base.point, &base.run(data, false));
    let start = data.hull.start;
    for k in filled.iter().flat_map(Range::clone).filter(|k| data.hull.contains(k)) {
        if errors[k - start].is_finite() {
            data.reading[k] -= errors[k - start];
        }
    }
}

/// Writes the finding about how the input goes between its samples.
pub(crate) fn interpolated(how: Interpolation) -> String {
    format!("the input is best interpolated by {} between samples", how.words())
}

/// Returns which of steps and straight lines between the samples of the input, perhaps with a reading
/// that is late or smoothed, an input that is late, or the modes found, does as well as the linear
/// terms of `chosen` that it could be mistaken for, if one does: a held input looks late by half a
/// sample, straight lines look like a weak low-pass.
pub(crate) fn other_input(data: &mut Data, chosen: &Judged, scales: &Scales) -> Option<Interpolation> {
    let is_mode = |t: &Term| matches!(t, Term::ParasiticMode(_) | Term::CoupledMode(_));
    let mistaken = |t: &Term| {
        let is_late =
            matches!(t, Term::ReadoutDelay(_) | Term::InputLag(_) | Term::ReadoutLowpass(_) | Term::Feedthrough(_));
        is_late || is_mode(t)
    };
    let (mut terms, mut point) = (Vec::new(), chosen.fit.point[..BASE].to_vec());
    for (i, term) in chosen.fit.structure.terms.iter().enumerate().filter(|(_, t)| !mistaken(t)) {
        terms.push(*term);
        point.extend_from_slice(chosen.fit.structure.of(i, &chosen.fit.point));
    }
    let spared = chosen.fit.structure.terms.len() - terms.len();
    let [delay, lag, smoothed] =
        [Term::ReadoutDelay(ReadoutDelay), Term::InputLag(InputLag), Term::ReadoutLowpass(ReadoutLowpass(Poles::One))];
    let late: [&[Term]; 6] = [&[], &[delay], &[lag], &[smoothed], &[smoothed, delay], &[smoothed, lag]];
    let modes: Vec<Term> = chosen.fit.structure.terms.iter().copied().filter(is_mode).collect();
    let with_modes = late.iter().filter(|_| !modes.is_empty()).map(|late| [&modes, *late].concat());
    let instead: Vec<Vec<Term>> = late.iter().map(|late| late.to_vec()).chain(with_modes).collect();
    // As late as it is in the model chosen, or as its phase looks.
    let of = |term: Term| {
        let place = chosen.fit.structure.terms.iter().position(|t| t.id() == term.id());
        let known = place.map(|i| chosen.fit.structure.of(i, &chosen.fit.point).to_vec());
        known.or_else(|| term.starts(scales).pop()).unwrap_or_default()
    };
    for added in &instead {
        // With fewer terms it does as well, with as many it does better.
        let most = match spared.cmp(&added.len()) {
            Ordering::Greater => chosen.fit.variance * ALIKE,
            Ordering::Equal if !added.is_empty() => chosen.fit.variance / ALIKE,
            _ => continue,
        };
        let all: Vec<Term> = terms.iter().chain(added).copied().collect();
        let structure = ModelStructure::new(&all);
        let start: Vec<f64> = point.iter().copied().chain(added.iter().copied().flat_map(of)).collect();
        for how in [Interpolation::Hold, Interpolation::Linear] {
            let kept = data.input.take()?;
            data.input = Some(kept.clone().gone(how));
            let other = fit(data, &structure, &start, scales, 25);
            if other.is_some_and(|other| other.variance < most) {
                return Some(how);
            }
            data.input = Some(kept);
        }
    }
    None
}
