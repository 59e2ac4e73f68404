//! Several recordings of one sensor as one data set in which the mass begins anew with each; those
//! that only judge come last.
//!
//! The ends of each recording, where its input cannot be interpolated, are left out, so that fitted
//! samples follow on one another without a gap. Each recording is checked on its own (`prepare`).

use std::ops::Range;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::model;
use crate::number::short;
use crate::recording::Recording;
use crate::recordings::Recordings;
use crate::verdict::Role;

use super::data::{Data, Followed};
use super::excerpt::{self, LONGEST};
use super::input::{Input, Interpolation};
use super::notes::Notes;
use super::prepare::{self, FEWEST_JUDGES, Prepared};
use super::stretches::{Stretches, minus};

/// Relative difference of two sampling rates that clocks explain.
const SAME_RATE: f64 = 1e-3;

/// Place of a recording among the samples that fits see.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Path of the recording, as given.
    pub file: String,
    /// States whether it is fitted or only validates.
    pub role: Role,
    /// Its samples in the joint data set, half-open.
    pub range: Range<usize>,
}

/// Recordings joined into one sequence.
#[derive(Debug, Clone)]
pub struct Taken {
    /// All recordings as one data set.
    pub prepared: Prepared,
    /// Range and role of each recording.
    pub pieces: Vec<Piece>,
    /// Samples that the model file names as judging.
    pub judging: model::Ranges,
}

/// Decides whether an input that was moved stays where it is, which takes a fit: intake itself
/// fits nothing.
pub(crate) type Settle = fn(Prepared) -> Prepared;

/// All recordings as one data set, each settled by itself.
///
/// # Errors
/// As [`prepare::prepare`] for each; several recordings whose rates differ, with ranges of samples
/// in the model, or with more samples than are fitted at once; when stopped.
pub(crate) fn taken(
    recordings: Recordings<'_>,
    model: &model::Driven,
    settle: Settle,
    control: &Control,
) -> Result<Taken> {
    match recordings.only() {
        Some(only) => alone(only, model, settle, control),
        None => joined(recordings, model, settle, control),
    }
}

/// One recording; of a long one its loudest stretch.
fn alone(recording: &Recording, model: &model::Driven, settle: Settle, control: &Control) -> Result<Taken> {
    let part = excerpt::excerpt(recording, model);
    let (kept, model) = part.as_ref().map_or((recording, model), |p| (&p.recording, &p.model));
    let mut prepared = settle(prepare::prepare(kept, model, control)?);
    let piece = Piece { file: file(recording), role: Role::Train, range: prepared.data.hull.clone() };
    let judging = model.split.test.clone();
    prepared.notes.doubts.extend(part.as_ref().and_then(|p| p.doubt.clone()));
    prepared.notes.findings.extend(part.map(|p| p.said));
    Ok(Taken { prepared, pieces: vec![piece], judging })
}

fn file(recording: &Recording) -> String {
    recording.path.display().to_string()
}

fn name(recording: &Recording) -> String {
    recording.path.file_name().map_or_else(|| file(recording), |name| name.to_string_lossy().into_owned())
}

/// One recording prepared, and its role.
struct Part<'a> {
    recording: &'a Recording,
    role: Role,
    prepared: Prepared,
}

fn joined(recordings: Recordings<'_>, model: &model::Driven, settle: Settle, control: &Control) -> Result<Taken> {
    agree(recordings, model)?;
    let of = |role: Role| {
        move |recording| Ok(Part { recording, role, prepared: settle(prepare::prepare(recording, model, control)?) })
    };
    let train = recordings.train.iter().map(of(Role::Train));
    let parts = train.chain(recordings.test.iter().map(of(Role::Test))).collect::<Result<Vec<Part<'_>>>>()?;
    let mut all = Joined::default();
    let mut pieces = Vec::with_capacity(parts.len());
    for part in &parts {
        let range = all.add(part);
        if part.role == Role::Test && range.len() < FEWEST_JUDGES {
            let cause = format!("{} samples are too few for validation: need at least {FEWEST_JUDGES}", range.len());
            return refuse(
                part.recording,
                cause,
                "its first samples only determine the initial state; give a longer recording",
            );
        }
        pieces.push(Piece { file: file(part.recording), role: part.role, range });
    }
    let own_test = !all.test.is_empty();
    if !own_test {
        all.test.clone_from(&all.validation);
    }
    let (environment, followed) = environment(&parts, model);
    let first = &parts[0].prepared.data;
    let data = Data {
        input: joined_input(&parts, model),
        hull: 0..pieces.iter().filter(|p| p.role == Role::Train).map(|p| p.range.end).max().unwrap_or(0),
        reading: all.reading,
        observed: first.observed,
        environment,
        environments: followed.len(),
        followed,
        rate_hz: first.rate_hz,
        breaks: pieces.iter().skip(1).filter(|p| p.role == Role::Train).map(|p| p.range.start).collect(),
        train: all.train,
        validation: all.validation,
        test: all.test,
        own_test,
        windows: None,
        clock_s: Vec::new(),
        work: first.work.clone(),
        trace: first.trace.clone(),
    };
    let names =
        |role: Role| -> Vec<String> { parts.iter().filter(|p| p.role == role).map(|p| name(p.recording)).collect() };
    let mut said = format!("fitted together: {}", names(Role::Train).join(", "));
    if own_test {
        said += &format!("; validation only: {}", names(Role::Test).join(", "));
    }
    said += "; times count through the recordings in this order";
    all.notes.findings.insert(0, said);
    let start = parts[0].prepared.start;
    let prepared = Prepared { data, start, filled: all.filled, shift: None, notes: all.notes };
    Ok(Taken { prepared, pieces, judging: Vec::new() })
}

/// Checks that the recordings can be of one data set; that the columns are there is seen as each is
/// prepared.
fn agree(recordings: Recordings<'_>, model: &model::Driven) -> Result<()> {
    let first = &recordings.train[0];
    if !(model.split.train.is_empty() && model.split.test.is_empty()) {
        let cause = "[split] names samples of one recording, and several are given".to_owned();
        return refuse(first, cause, "leave [split] out: recordings given by --test validate");
    }
    for other in recordings.all() {
        if (other.rate_hz / first.rate_hz - 1.0).abs() > SAME_RATE {
            let cause = format!(
                "it is sampled at {} Hz, and {} at {} Hz",
                short(other.rate_hz),
                file(first),
                short(first.rate_hz)
            );
            return refuse(other, cause, "recordings that are diagnosed together need one sampling rate: resample one");
        }
    }
    let total = |all: &[Recording]| all.iter().map(Recording::samples).sum::<usize>();
    let most = total(recordings.train).max(total(recordings.test));
    if most > LONGEST {
        let cause = format!("together the recordings have {most} samples, and at most {LONGEST} are fitted at once");
        return refuse(first, cause, "give fewer of them, or only part of each, with --from-s and --to-s");
    }
    Ok(())
}

fn refuse<T>(recording: &Recording, cause: String, hint: &str) -> Result<T> {
    Err(Error::new(format!("could not diagnose {}", recording.path.display()), cause, hint))
}

/// Parts of the data set that grow with each recording.
#[derive(Default)]
struct Joined {
    reading: Vec<f64>,
    train: Stretches,
    validation: Stretches,
    test: Stretches,
    filled: Stretches,
    notes: Notes,
}

impl Joined {
    /// Adds one recording; where it lies.
    fn add(&mut self, part: &Part<'_>) -> Range<usize> {
        let Prepared { data, filled, notes, .. } = &part.prepared;
        let (from, to) = (self.reading.len(), data.hull.clone());
        let moved = |ranges: &[Range<usize>]| -> Stretches {
            let inside = ranges.iter().map(|r| r.start.max(to.start)..r.end.min(to.end)).filter(|r| r.start < r.end);
            inside.map(|r| r.start - to.start + from..r.end - to.start + from).collect()
        };
        self.reading.extend_from_slice(&data.reading[to.clone()]);
        self.filled.extend(moved(filled));
        match part.role {
            Role::Train => {
                self.train.extend(moved(&data.train));
                self.validation.extend(moved(&data.validation));
                self.notes.jumps.extend(notes.jumps.iter().filter(|k| to.contains(k)).map(|k| k - to.start + from));
            }
            Role::Test => {
                let whole = minus(std::slice::from_ref(&to), filled);
                self.test.extend(moved(&whole).into_iter().filter(|r| r.len() >= FEWEST_JUDGES));
            }
        }
        let named = |sentence: &String| format!("{}: {sentence}", name(part.recording));
        self.notes.findings.extend(notes.findings.iter().map(named));
        self.notes.doubts.extend(notes.doubts.iter().map(named));
        self.notes.broken = self.notes.broken.take().or_else(|| notes.broken.clone());
        self.notes.bent = self.notes.bent.take().or_else(|| notes.bent.clone());
        from..self.reading.len()
    }
}

/// The input of all; where one recording has none that moves, what its column holds.
fn joined_input(parts: &[Part<'_>], model: &model::Driven) -> Option<Input> {
    let name = model.columns.input.as_deref()?;
    parts.iter().find(|p| p.prepared.data.input.is_some())?;
    let piece = |part: &Part<'_>| {
        let data = &part.prepared.data;
        let own = data.input.as_ref().map(|i| i.samples().to_vec());
        let values = own.or_else(|| part.recording.column(name).map(<[f64]>::to_vec)).unwrap_or_default();
        (values, data.hull.clone())
    };
    Some(Input::joined(parts.iter().map(piece).collect(), Interpolation::BandLimited))
}

/// Environment columns less their means over all fitted recordings, row by row, and which they are.
fn environment(parts: &[Part<'_>], model: &model::Driven) -> (Vec<f64>, Vec<Followed>) {
    let (mut columns, mut followed): (Vec<Vec<f64>>, Vec<Followed>) = (Vec::new(), Vec::new());
    for name in &model.columns.environment {
        let of = |part: &Part<'_>| -> Vec<f64> {
            let values = part.recording.column(name).unwrap_or_default();
            values[part.prepared.data.hull.clone()].to_vec()
        };
        let fitted: Vec<f64> = parts.iter().filter(|p| p.role == Role::Train).flat_map(of).collect();
        if let Some(kept) = Followed::of(name, &fitted) {
            columns.push(parts.iter().flat_map(of).map(|v| v - kept.mean).collect());
            followed.push(kept);
        }
    }
    let rows = columns.first().map_or(0, Vec::len);
    ((0..rows).flat_map(|k| columns.iter().map(move |c| c[k])).collect(), followed)
}
