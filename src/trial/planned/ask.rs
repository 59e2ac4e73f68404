//! The way of a user with one sensor: a first recording and its verdict; where laws are tied, a plan, the
//! experiment that it proposes, recorded, and the verdict on that.

use std::path::Path;

use super::line::{Decided, Experiment, Line, Planned, Stage};
use super::pair::Pair;
use crate::ask::{self, Files, Subject};
use crate::independent::driven::Driven;
use crate::independent::wave::Shape;
use crate::said::{Ending, Said};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Kind, Result};
use proofmass_diagnosis::plan::experiment::{Experiment as Proposed, broadband};
use proofmass_diagnosis::plan::limits::Limits;
use proofmass_diagnosis::plan::{Wish, asked, plan};
use proofmass_diagnosis::verdict::Verdict;

/// Times that the longest experiment is as long as the first recording.
const LONGER: f64 = 4.0;
/// Probability of a right decision that is wished.
pub(super) const WISH: f64 = 0.95;

/// Files of one sensor's way: recordings with what they are of, its model, its verdict and the limits.
pub const FILES: [&str; 6] =
    ["first.csv", "experiment.csv", "broadband.csv", "model.toml", "verdict.json", "limits.toml"];

/// Goes the whole way with one sensor, whose files are written to a folder.
///
/// # Errors
/// Files that cannot be written, or when stopped; a plan or diagnosis that fails is a line.
pub fn line(pair: &Pair, folder: &Path, subject: &Subject<'_>, control: &Control) -> Result<Line> {
    let (said, verdict) = diagnosed(&pair.driven, &folder.join(FILES[0]), subject)?;
    let rivals = rivals(&said);
    let line =
        |stage| Line { number: pair.number, law: pair.law.clone(), left: pair.left, rivals: rivals.clone(), stage };
    let Some(verdict) = verdict.filter(|_| said.outcome == Ending::Undecidable && rivals.len() > 1) else {
        return Ok(line(Stage::NotOpen { said: said.outcome, names: said.ids() }));
    };
    let path = folder.join(FILES[4]);
    std::fs::write(&path, to_json(&verdict)?).map_err(|e| Error::io("write", &path, &e))?;
    match played(pair, &path, folder, subject, control) {
        Ok(planned) => Ok(line(Stage::Planned(Box::new(planned)))),
        Err(error) if error.kind == Kind::Interrupted => Err(error),
        Err(error) => Ok(line(Stage::NotPlanned { words: error.to_string() })),
    }
}

/// Ids that are tied in a verdict.
fn rivals(said: &Said) -> Vec<String> {
    let mut ids: Vec<String> = said.groups.iter().filter(|group| group.len() > 1).flatten().cloned().collect();
    ids.sort();
    ids.dedup();
    ids
}

/// Plans, records what is proposed and a broadband multisine of twice its length, and asks for both verdicts.
fn played(pair: &Pair, verdict: &Path, folder: &Path, subject: &Subject<'_>, control: &Control) -> Result<Planned> {
    let (o, columns) = (&pair.driven.oscillator, &pair.driven.columns);
    let first = pair.driven.readings(o.rows, true);
    let peak = first.iter().flat_map(|r| &r.input).fold(0.0f64, |a, u| a.max(u.abs())) * columns.input_scale.abs();
    let text = format!(
        "largest_input_m_s2 = {:e}\nrate_hz = {:e}\nlongest_s = {:e}\n",
        peak,
        o.rate_hz,
        LONGER * o.rows as f64 / o.rate_hz
    );
    let path = folder.join(FILES[5]);
    std::fs::write(&path, &text).map_err(|e| Error::io("write", &path, &e))?;
    let limits = Limits::parse(FILES[5], &text)?;
    let question = asked::read(verdict, None, &limits)?;
    let (found, _) = plan(&question, &limits, Wish { probability: WISH, confirm: 0 }, control)?;
    let proposals: Vec<_> = found.proposals().collect();
    let Some(best) = proposals.first() else {
        return Err(Error::new("could not plan an experiment", "there is none", "allow a longer one"));
    };
    let (shape, level) = broadband(&limits, question.sensor.resonance_hz());
    let twice = Proposed { shape, level, seconds: 2.0 * best.experiment.seconds, rate_hz: o.rate_hz };
    let asked: Vec<String> = found.question.rivals.iter().map(|k| k.term.id().to_owned()).collect();
    let decided = |experiment: &Proposed, nth: usize| {
        let (said, _) = diagnosed(&recorded(pair, experiment, nth), &folder.join(FILES[nth]), subject)?;
        Ok::<_, Error>(Decided::of(&said, &pair.law, &asked))
    };
    Ok(Planned {
        experiment: Experiment::of(&best.experiment),
        promised: best.probability,
        reached: found.reached,
        decided: decided(&best.experiment, 1)?,
        broadband: found.broadband.map(|p| p.experiment.samples()),
        twice_broadband: decided(&twice, 2)?,
        rivals: asked.clone(),
    })
}

/// Records an experiment with the sensor: from rest, with fresh noise.
fn recorded(pair: &Pair, experiment: &Proposed, nth: usize) -> Driven {
    let mut driven = pair.driven.clone();
    let (o, scale) = (&mut driven.oscillator, driven.columns.input_scale);
    let values = experiment.input().iter().map(|u| u / scale).collect();
    o.input = Shape::Played { rate_hz: experiment.rate_hz, values };
    // A converter that held the first input holds this one.
    (o.rows, o.before, o.constant, o.hidden, o.start) = (experiment.samples(), 0, 0.0, 0.0, [0.0; 2]);
    o.seed ^= (nth as u64) << 48;
    driven
}

fn diagnosed(driven: &Driven, recording: &Path, subject: &Subject<'_>) -> Result<(Said, Option<Verdict>)> {
    let [text, model] = driven.texts();
    let files = Files { recording: recording.into(), model: recording.with_file_name(FILES[3]), judging: Vec::new() };
    for (path, text) in [(&files.recording, text), (&files.model, model)] {
        std::fs::write(path, text).map_err(|e| Error::io("write", path, &e))?;
    }
    ask::ask(&files, subject)
}
