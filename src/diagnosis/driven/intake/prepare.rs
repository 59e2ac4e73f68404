//! Arranges a recording and its model into what can be fitted: columns found, ranges checked,
//! defects reported.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::control::Control;
use crate::driven::base::{BASE, OMEGAS_PER_SAMPLE, ZETAS};
use crate::error::{Error, Result, nearest};
use crate::model;
use crate::number::short;
use crate::numerics::moments::mean_sd;
use crate::numerics::order;
use crate::recording::Recording;
use crate::trace::Trace;

use super::alignment::{self, align};
use super::data::{Data, Followed};
use super::defects;
use super::dependence::depends;
use super::holes;
use super::input::{Input, Interpolation, REACH};
use super::lines;
use super::notes::{Broken, Notes};
use super::observed::Observed;
use super::refusal::Refusal;
use super::shift::Shift;
use super::stretches::{Stretches, interleaved, merged, minus, sorted};
use super::work::Work;

/// Fewer samples than this cannot carry a base model and a judgement on it.
const FEWEST: usize = 20 * BASE;

/// Fewest samples of a range apart that judge: its first ones only show in which state it begins.
pub(super) const FEWEST_JUDGES: usize = 200;
/// Fewest samples in a row that are worth judging on.
const PIECE: usize = 20;
/// Numbers beyond this, or below its inverse, leave the range of double precision once they are
/// squared and summed.
const LARGEST: f64 = 1e100;

/// Data that can be fitted, and what was noticed on the way.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// The recording as fits see it.
    pub data: Data,
    /// Hints that can be right.
    pub start: model::Start,
    /// Samples that were not recorded.
    pub filled: Stretches,
    /// Shift of the input, where it looks misaligned.
    pub(crate) shift: Option<Shift>,
    /// Defects and choices that the verdict must mention.
    pub notes: Notes,
}

/// Checks and arranges.
///
/// # Errors
/// A column that is not there, values that are not numbers, a reading that never changes, too few
/// samples, ranges outside the recording or in both train and test; when stopped.
pub fn prepare(recording: &Recording, model: &model::Driven, control: &Control) -> Result<Prepared> {
    let mut notes = Notes { findings: recording.sentences(), ..Notes::default() };
    let start = hints(recording, &model.start, &mut notes.findings);
    let mut reading = column(recording, &model.columns.output)?.to_vec();
    let samples = reading.len();
    if samples < FEWEST + 2 * REACH {
        return Err(refuse(
            recording,
            format!("{samples} samples; the base model alone has {BASE} parameters"),
            "give at least a few hundred samples, preferably several thousand",
        ));
    }
    if mean_sd(&reading).1 <= 1e-12 * mean_sd(&reading).0.abs() {
        return Err(refuse(
            recording,
            format!("the output {} never changes: a dead channel", model.columns.output),
            "check the wiring and the name of the column",
        ));
    }
    let mut filled = recording.filled.clone();
    let stray = defects::glitches(&mut reading);
    if let Some(first) = stray.first() {
        let clause = format!("{} outliers in {}, the first in row {first}", stray.len(), model.columns.output);
        notes.doubt(clause, ", far from their neighbours: replaced by linear interpolation and not fitted");
        filled.extend(stray.iter().map(|k| *k..k + 1));
        order::sort_by_key(&mut filled, |r| r.start as f64);
    }
    let mut ends = REACH..samples - REACH;
    let (mut input, mut shift) = (None, None);
    if let Some(name) = &model.columns.input {
        let mut values = column(recording, name)?.to_vec();
        if mean_sd(&values).1 <= 1e-12 * mean_sd(&values).0.abs() {
            notes.doubt(
                format!("the input {name} never changes"),
                ": a dead channel? The recording is treated as a free ring-down",
            );
        } else {
            let holes = holes::refill(&mut values, recording.filled_of(name));
            if holes > 0 {
                let said = format!("values of {name} filled again, by prediction from both sides: {holes} short holes");
                notes.findings.push(said);
            }
            let columns = Columns { model, reading: &reading, control };
            shift = columns
                .together(&mut values, &mut ends, &mut notes)
                .map_err(|refusal| refusal.of(recording, &model.columns))?;
            input = Some(Input::new(values, Interpolation::BandLimited));
        }
    }
    if input.is_none() {
        // No input has to be interpolated.
        ends = 0..samples;
    }
    let mut environment = Vec::new();
    let (mut columns, mut followed): (Vec<Vec<f64>>, Vec<Followed>) = (Vec::new(), Vec::new());
    for name in &model.columns.environment {
        let values = column(recording, name)?;
        if let Some(kept) = Followed::of(name, values) {
            columns.push(values.iter().map(|v| v - kept.mean).collect());
            followed.push(kept);
        }
    }
    for k in 0..samples {
        environment.extend(columns.iter().map(|c| c[k]));
    }
    let (train, test) = ranges(recording, &model.split, &ends, &mut notes.findings)?;
    let own_test = !test.is_empty();
    let hull = train.first().map_or(0, |r| r.start)..train.last().map_or(0, |r| r.end);
    notes.jumps = jumps(input.as_ref(), &reading, &hull, &filled);
    let (fitted, validation) = interleaved(&train);
    let recorded = |ranges: &[Range<usize>]| -> Stretches {
        let whole = |r: &Range<usize>| filled.iter().all(|f| f.end <= r.start || f.start >= r.end);
        let (mut all, torn): (Stretches, Stretches) = ranges.iter().cloned().partition(whole);
        all.extend(minus(&torn, &filled).into_iter().filter(|r| r.len() >= PIECE));
        order::sort_by_key(&mut all, |r| r.start as f64);
        all
    };
    let (fitted, validation) = (minus(&fitted, &filled), recorded(&validation));
    let test = if own_test { recorded(&test) } else { validation.clone() };
    let data = Data {
        reading,
        observed: Observed { output: model.output_is, ..Observed::default() },
        input,
        environment,
        environments: columns.len(),
        followed,
        rate_hz: recording.rate_hz,
        hull,
        breaks: Vec::new(),
        train: fitted,
        validation,
        test,
        own_test,
        windows: None,
        clock_s: Vec::new(),
        work: Work::default(),
        trace: Trace::without(&model.without),
    };
    if data.train_len() < FEWEST / 2 {
        return Err(refuse(
            recording,
            format!("{} samples to fit; the base model alone has {BASE} parameters", data.train_len()),
            "widen [split] train",
        ));
    }
    Ok(Prepared { data, start, filled, shift, notes })
}

/// Hints that this recording could show; what could not be is reported and left out.
fn hints(recording: &Recording, start: &model::Start, findings: &mut Vec<String>) -> model::Start {
    let (half_hz, slowest_hz) = (0.5 * recording.rate_hz, OMEGAS_PER_SAMPLE[0] / TAU * recording.rate_hz);
    let [least, most] = ZETAS;
    let mut ignore = |cause: String| findings.push(format!("[start] was ignored: {cause}"));
    let resonance_hz = start.resonance_hz.filter(|hz| {
        if !(*hz > 0.0 && hz.is_finite()) {
            ignore(format!("a resonance of {hz} Hz is not a valid frequency"));
        } else if *hz >= half_hz {
            ignore(format!("a resonance of {hz} Hz lies above half the sampling rate, {} Hz", short(half_hz)));
        } else if *hz < slowest_hz {
            ignore(format!("a resonance of {hz:e} Hz would not complete one cycle in this recording"));
        }
        *hz >= slowest_hz && *hz < half_hz
    });
    let damping_ratio = start.damping_ratio.filter(|zeta| {
        let can_be = zeta.is_finite() && (least..=most).contains(zeta);
        if !can_be {
            ignore(format!("a damping ratio of {zeta:e}; 0.05 is lightly damped, 0.7 well damped"));
        }
        can_be
    });
    model::Start { resonance_hz, damping_ratio }
}

/// The model and the reading for which an input, which may have been moved, is checked.
struct Columns<'a> {
    model: &'a model::Driven,
    reading: &'a [f64],
    control: &'a Control,
}

impl Columns<'_> {
    /// Checks that input and output belong together as they stand; an input that is far early or
    /// late is moved.
    ///
    /// # Errors
    /// Where the two have nothing to do with each other, by a linear law or any other; when stopped.
    fn together(
        &self,
        input: &mut [f64],
        ends: &mut Range<usize>,
        notes: &mut Notes,
    ) -> Result<Option<Shift>, Refusal> {
        let Self { model, reading, control } = *self;
        let (output, name) = (&model.columns.output, model.columns.input.as_deref().unwrap_or("the input"));
        if let Some((row, factor)) = defects::rescaled(input, reading, ends) {
            notes.broken = Some(Broken::Rescaled { input: name.to_owned(), output: output.clone(), row, factor });
        }
        if lines::are_all(&input[ends.clone()]) {
            return Ok(None);
        }
        let Some(forward) = align(input, reading, ends) else { return Ok(None) };
        // What is known of misaligned and exchanged columns is known of displacement: a velocity leads it by a
        // quarter of a cycle, and an acceleration by half a one.
        let is_displacement = model.output_is == model::Output::Displacement;
        if is_displacement
            && forward.residual > 0.2
            && let Some(backward) = align(reading, input, ends)
            && alignment::exchanged(&forward, &backward)
        {
            notes.broken = Some(Broken::Exchanged { input: name.to_owned(), output: output.clone() });
            return Ok(None);
        }
        if forward.is_chance() && notes.broken.is_none() {
            let explains = format!(
                "explains {} % of the power of {output} from {name}, no more than with the input shifted in time",
                short(100.0 * (1.0 - forward.residual))
            );
            if depends(input, reading, ends, control)? {
                notes.bent =
                    Some(format!("{output} depends on {name}, but by no linear law: the best oscillator {explains}"));
                return Ok(None);
            }
            return Err(Refusal::Cause(format!("no oscillator can be identified: the best one {explains}")));
        }
        let lag = forward.lag;
        if !forward.is_misaligned() || !is_displacement {
            return Ok(None);
        }
        let shift = Shift::of(input, lag, format!("{output} is misaligned with {name}: it comes"));
        *ends = ends.start + lag.max(0) as usize..ends.end - (-lag).max(0) as usize;
        Ok(Some(shift))
    }
}

/// Returns where the reading jumps, apart from gaps that are known.
fn jumps(input: Option<&Input>, reading: &[f64], hull: &Range<usize>, filled: &[Range<usize>]) -> Vec<usize> {
    let mut places = defects::jumps(input.map(Input::samples), reading, hull);
    places.retain(|k| !filled.iter().any(|r| r.start <= k + REACH && *k <= r.end + REACH));
    places
}

fn refuse(recording: &Recording, cause: String, hint: &str) -> Error {
    Error::new(format!("could not diagnose {}", recording.path.display()), cause, hint)
}

fn column<'a>(recording: &'a Recording, name: &str) -> Result<&'a [f64]> {
    let Some(values) = recording.column(name) else {
        let known = recording.columns.iter().map(|c| c.name.as_str());
        let hint = nearest(name, known)
            .map_or_else(|| "name a column of the file".to_owned(), |known| format!("did you mean \"{known}\"?"));
        return Err(refuse(recording, format!("there is no column \"{name}\""), &hint));
    };
    let largest = values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    if largest.is_finite() && (largest > LARGEST || (largest > 0.0 && largest < 1.0 / LARGEST)) {
        return Err(refuse(
            recording,
            format!("values of {name} reach {largest:e}: their squares overflow double precision"),
            "give the column in another unit",
        ));
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(refuse(
            recording,
            format!("row {row} of {name} is not a number"),
            "fill the gap or cut it out; short gaps are filled when the tool itself reads the file",
        )),
        None => Ok(values),
    }
}

/// Fitted and judging ranges as the model file states them; the whole recording where it states
/// nothing.
fn ranges(
    recording: &Recording,
    split: &model::Split,
    ends: &Range<usize>,
    findings: &mut Vec<String>,
) -> Result<(Stretches, Stretches)> {
    let samples = recording.samples();
    for [from, to] in split.train.iter().chain(&split.test) {
        if from >= to || *to > samples {
            return Err(refuse(
                recording,
                format!("the range [{from}, {to}) does not lie in the {samples} samples"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            ));
        }
    }
    for (role, ranges, least) in [("train", &split.train, FEWEST), ("test", &split.test, FEWEST_JUDGES)] {
        let given: usize = merged(sorted(ranges)).iter().map(Range::len).sum();
        if !ranges.is_empty() && given < least {
            return Err(refuse(
                recording,
                format!("[split] {role}: need at least {least} samples, got {given}"),
                "widen the ranges, or leave [split] out: blocks then judge in turn",
            ));
        }
    }
    let clip = |ranges: &[[usize; 2]]| -> Vec<Range<usize>> {
        let inside = |r: Range<usize>| r.start.max(ends.start)..r.end.min(ends.end);
        merged(sorted(ranges)).into_iter().map(inside).filter(|r| r.start < r.end).collect()
    };
    let (mut train, test) = (clip(&split.train), clip(&split.test));
    if train.is_empty() {
        train = minus(std::slice::from_ref(ends), &test);
    }
    let apart = minus(&test, &train);
    let lost = test.iter().map(Range::len).sum::<usize>() - apart.iter().map(Range::len).sum::<usize>();
    if lost > 0 {
        return Err(refuse(
            recording,
            format!("[split] train and test overlap in {lost} samples"),
            "training samples cannot validate: make the ranges disjoint",
        ));
    }
    let (apart, short): (Vec<Range<usize>>, Vec<Range<usize>>) =
        apart.into_iter().partition(|r| r.len() >= FEWEST_JUDGES);
    if !short.is_empty() && !apart.is_empty() {
        let count: usize = short.iter().map(Range::len).sum();
        findings.push(format!(
            "{count} test samples, in ranges shorter than {FEWEST_JUDGES}, are not used for validation: each range \
             needs an initial state of its own"
        ));
    }
    if !split.test.is_empty() && apart.is_empty() {
        findings.push("no test samples are left, so every third block of the training samples is held out".to_owned());
    }
    Ok((train, apart))
}
