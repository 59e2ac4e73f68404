//! Real drift next to the predicted band: a recorded IMU, dead-reckoned from the reference's state
//! in windows, and what the study's sensor should make of each of them.
//!
//! `recorded` (with `accord`): log and reference on one clock · `cut` → `window`: where windows
//! lie, and the error at the end of each · `linear` → `predict`: what each error of a sensor makes
//! of that end · `bias` (with `median`): what is taken off the readings · `inflation` →
//! `length` → `reference`: how large errors would have to be for the windows to be consistent ·
//! `score`: fractions inside the bands, normalised errors squared. Bands are of the linear model,
//! window by window: exact for errors this small, and the ensemble's own check of it stands next to
//! every study. Not for logs at rest: that is `drift::windows`.

mod accord;
pub mod bias;
mod cut;
pub mod document;
pub mod finding;
pub mod inflation;
pub mod length;
pub mod linear;
mod median;
pub mod predict;
pub mod recorded;
pub mod reference;
pub mod score;
pub mod window;

use std::path::Path;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::motion::Section;
use crate::motion::sources::Bias;
use crate::number::rounded;
use crate::parallel;
use crate::sensor::Sense;
use crate::study::flown::Flown;
use crate::study::in_motion::InMotion;
use bias::{Base, Still, Taken};
use finding::Finding;
use inflation::{CAUSES, Cause, Inflation, Split, Units, Whose};
use length::{Length, Reckoned};
use linear::{Kind, Linear, Part};
use predict::{Expected, Place, expected};
use recorded::Recorded;
use window::{Asked, Nine, Window};

/// A sensor that the recording is laid next to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sensor {
    /// Sensor as the study states it.
    Stated,
    /// The same with noise and random walks tenfold, as a rule of thumb has it.
    Tenfold,
    /// A sensor read from another file.
    File(String),
    /// The study's own, inflated as the windows justify.
    Inflated,
}

/// The factor of the rule of thumb.
const TENFOLD: f64 = 10.0;

/// A recorded flight next to the predictions.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The log, as the study names it.
    pub imu: String,
    /// SHA-256 of the log, hexadecimal.
    pub sha256: String,
    /// Length of the overlap, s.
    pub seconds: f64,
    /// The sensors, in the order of every list of them.
    pub sensors: Vec<Sensor>,
    /// Per length of window.
    pub lengths: Vec<Length>,
    /// Inflation that would make the windows consistent; the last of the sensors.
    pub inflation: Option<Inflation>,
    /// The coefficients that the study states for the same causes, SI.
    pub stated: [f64; CAUSES.len()],
    /// Findings that were survived.
    pub findings: Vec<String>,
}

/// One sensor, with its parts in each base.
struct Laid {
    motion: InMotion,
    factor: f64,
    in_bases: Vec<Vec<Part>>,
}

/// Prediction that every window is compared with.
struct Beside {
    biased: Biased,
    laid: Vec<Laid>,
    /// The stated sensor without the causes that are inflated.
    rest: Vec<Vec<Part>>,
    units: Vec<Units>,
}

impl Beside {
    fn new(biased: Biased, laid: Vec<Laid>) -> Self {
        let rest = laid.first().map_or_else(Vec::new, |stated| stated.in_bases.iter().map(|p| rest(p)).collect());
        let units = inflation::in_bases(biased.bases());
        Self { biased, laid, rest, units }
    }
}

/// The parts that are not inflated.
fn rest(parts: &[Part]) -> Vec<Part> {
    let stays =
        |part: &&Part| matches!(part, Part::Constant { .. } | Part::Noise { kind: Kind::Flicker | Kind::Poses, .. });
    parts.iter().filter(stays).cloned().collect()
}

impl Laid {
    fn new(motion: InMotion, factor: f64, bases: &[Base]) -> Result<Self> {
        let mut laid = Self { motion, factor, in_bases: Vec::new() };
        laid.in_bases = bases.iter().map(|base| laid.parts(&base.linear)).collect::<Result<_>>()?;
        Ok(laid)
    }

    fn parts(&self, linear: &Linear) -> Result<Vec<Part>> {
        let (mut parts, _) = linear.parts(&self.motion)?;
        for part in &mut parts {
            if let Part::Noise { kind: Kind::White | Kind::Walk, squares, end } = part {
                squares.iter_mut().for_each(|square| *square *= self.factor * self.factor);
                **end *= self.factor * self.factor;
            }
        }
        Ok(parts)
    }
}

/// Source from which all windows of a flight take their biases.
enum Biased {
    Others(Vec<Base>),
    Still(Still),
}

impl Biased {
    fn bases(&self) -> &[Base] {
        match self {
            Self::Others(bases) => bases,
            Self::Still(_) => &[],
        }
    }

    fn taken(&self, window: &Window) -> Option<Taken> {
        match self {
            Self::Others(bases) => bias::of_others(bases, window),
            Self::Still(still) => Some(Taken { biases: still.biases, source: bias::Source::Still(still.clone()) }),
        }
    }
}

/// Lays the recorded flight of a study next to its predictions; `None` where it asks for none.
///
/// # Errors
/// Files that cannot be read or are not of one flight, windows of which none fits, Ctrl-C.
pub fn compare(motion: &InMotion, control: &Control) -> Result<Option<Compared>> {
    let Some(flown) = &motion.flown else { return Ok(None) };
    let recorded = Recorded::read(&flown.imu, &flown.reference, flown, motion)?;
    let mut findings: Vec<String> = recorded.trajectory.findings.iter().map(ToString::to_string).collect();
    let mut found = recorded.findings.clone();
    found.extend(linear::left_out(motion).map(|source| Finding::NotInBands { source }));
    let biased = biased(&recorded, flown, motion, &mut found)?;
    let (mut sensors, laid) = sensors(flown, motion, biased.bases())?;
    let beside = Beside::new(biased, laid);
    let pieces = match &beside.biased {
        Biased::Still(still) => cut::without(&recorded.pieces, &still.readings),
        Biased::Others(_) => recorded.pieces.clone(),
    };
    let progress = control.stage("dead-reckoning", flown.windows_s.len() as u64);
    let mut lengths = Vec::new();
    for seconds in flown.windows_s.iter().copied() {
        control.go_on().map_err(|s| s.during("could not finish the windows", "run it again"))?;
        let asked = Asked { motion, flown, seconds, flight: OWN };
        let windows = windows(&recorded, asked, &pieces);
        progress.step();
        if windows.is_empty() {
            let longest = pieces.iter().map(|p| p.len().saturating_sub(1)).max().unwrap_or_default();
            found.push(Finding::NoWindow { seconds, longest_s: longest as f64 * recorded.interval_s });
            continue;
        }
        let cut = windows.len();
        let length = length(motion, &beside, (seconds, windows), recorded.seconds())?;
        if length.windows.len() < cut {
            found.push(Finding::NoOther { seconds, windows: cut - length.windows.len() });
        }
        lengths.extend((!length.windows.is_empty()).then_some(length));
    }
    if lengths.is_empty() {
        return Err(Error::new(
            format!("could not cut {} into windows", recorded.imu),
            format!(
                "it shares {} s with the reference, and no window of {} s fits with another one next to it",
                rounded(recorded.seconds(), 4),
                flown.windows_s[0]
            ),
            "shorten trajectory.compare.windows_s, or give a longer recording",
        ));
    }
    let inflation = inflate(flown, motion, &lengths[0])?;
    let inflation = inflation.map(|inflation| reference::lay(inflation, &mut lengths, &mut found));
    sensors.extend(inflation.map(|_| Sensor::Inflated));
    findings.extend(found.iter().map(ToString::to_string));
    Ok(Some(Compared {
        inflation,
        stated: stated(motion),
        imu: recorded.imu.clone(),
        sha256: recorded.sha256.clone(),
        seconds: recorded.seconds(),
        sensors,
        lengths,
        findings,
    }))
}

/// The number of the flight that is compared; others follow.
const OWN: usize = 0;

fn windows(recorded: &Recorded, asked: Asked<'_>, pieces: &[std::ops::Range<usize>]) -> Vec<Window> {
    let steps = (asked.seconds / recorded.interval_s).round().max(1.0) as usize;
    let [first, last] = recorded.inside_s;
    let from = recorded.time_s.partition_point(|time_s| *time_s < first);
    let to = recorded.time_s.partition_point(|time_s| *time_s <= last);
    let inside: Vec<_> = pieces.iter().map(|p| p.start.max(from)..p.end.min(to)).filter(|p| !p.is_empty()).collect();
    parallel::map(&cut::windows(&inside, steps), |first| Window::new(recorded, asked, *first, steps))
}

/// The bases of one flight: its windows of the shortest length.
fn bases(recorded: &Recorded, flown: &Flown, motion: &InMotion, flight: usize) -> Result<Vec<Base>> {
    let seconds = flown.windows_s[0];
    let guess = bias::guess(recorded, flown, motion);
    let windows = windows(recorded, Asked { motion, flown, seconds, flight }, &recorded.pieces);
    parallel::map(&windows, |window| Base::new(motion, window.clone(), &guess)).into_iter().collect()
}

fn biased(recorded: &Recorded, flown: &Flown, motion: &InMotion, found: &mut Vec<Finding>) -> Result<Biased> {
    if flown.bias == Bias::Still {
        let still = bias::still(recorded, flown, motion)?;
        found.push(Finding::Still { from_s: still.span_s[0], seconds: flown.still_s });
        return Ok(Biased::Still(still));
    }
    if flown.others.is_empty() {
        return Ok(Biased::Others(bases(recorded, flown, motion, OWN)?));
    }
    let mut all = Vec::new();
    for (number, [imu, reference]) in flown.others.iter().enumerate() {
        let other = other(imu, reference, flown, motion)?;
        all.extend(bases(&other, flown, motion, OWN + 1 + number)?);
    }
    Ok(Biased::Others(all))
}

fn other(imu: &Path, reference: &Path, flown: &Flown, motion: &InMotion) -> Result<Recorded> {
    let section: Section = flown.reference_of(reference);
    Recorded::read(imu, &section, flown, motion)
}

fn sensors(flown: &Flown, motion: &InMotion, bases: &[Base]) -> Result<(Vec<Sensor>, Vec<Laid>)> {
    let mut all = vec![
        (Sensor::Stated, Laid::new(motion.clone(), 1.0, bases)?),
        (Sensor::Tenfold, Laid::new(motion.clone(), TENFOLD, bases)?),
    ];
    for (name, axes) in &flown.sensors {
        all.push((Sensor::File(name.clone()), Laid::new(motion.with_sensor(axes), 1.0, bases)?));
    }
    Ok(all.into_iter().unzip())
}

fn length(
    motion: &InMotion,
    beside: &Beside,
    (seconds, windows): (f64, Vec<Window>),
    overlap_s: f64,
) -> Result<Length> {
    let one = |window: &Window| -> Result<Option<(Reckoned, Vec<Expected>, Split)>> {
        let Some(taken) = beside.biased.taken(window) else { return Ok(None) };
        let linear = Linear::new(motion, window)?;
        let place = Place { linear: &linear, taken: &taken, begin_s: window.span_s[0], samples: window.steps() as u64 };
        let parts = beside.laid.iter().map(|sensor| sensor.parts(&linear)).collect::<Result<Vec<_>>>()?;
        let expect =
            |(sensor, parts): (&Laid, &Vec<Part>)| expected(&place, parts, |base| sensor.in_bases[base].as_slice());
        let rest = rest(parts.first().map_or(&[][..], Vec::as_slice));
        let rest = expected(&place, &rest, |base| beside.rest[base].as_slice());
        let reckoned = Reckoned {
            span_s: window.span_s,
            rows: window.rows,
            biases: taken.biases,
            error: window.error(motion, &taken.biases),
        };
        let split = inflation::split(&place, &beside.units, rest);
        Ok(Some((reckoned, beside.laid.iter().zip(&parts).map(expect).collect(), split)))
    };
    let done: Vec<_> = parallel::map(&windows, one).into_iter().collect::<Result<_>>()?;
    let expected = vec![Vec::new(); beside.laid.len()];
    let mut length = Length { seconds, unused_s: overlap_s, windows: Vec::new(), expected, splits: Vec::new() };
    for (reckoned, expected, split) in done.into_iter().flatten() {
        length.unused_s -= reckoned.span_s[1] - reckoned.span_s[0];
        length.windows.push(reckoned);
        length.splits.push(split);
        length.expected.iter_mut().zip(expected).for_each(|(all, one)| all.push(one));
    }
    Ok(length)
}

/// Finds what makes windows of the shortest length consistent: those of the flights that the study
/// names for it, else its own.
fn inflate(flown: &Flown, motion: &InMotion, own: &Length) -> Result<Option<Inflation>> {
    let pairs = |length: &Length| -> Vec<(Nine, Split)> { length.seen().into_iter().map(|seen| seen.end).collect() };
    if flown.fit.is_empty() {
        return Ok(inflation::fit(&pairs(own)));
    }
    let mut all = Vec::new();
    for [imu, reference] in &flown.fit {
        let recorded = other(imu, reference, flown, motion)?;
        let bases = bases(&recorded, flown, motion, OWN)?;
        let windows = bases.iter().map(|base| base.window.clone()).collect();
        let stated = Laid::new(motion.clone(), 1.0, &bases)?;
        let beside = Beside::new(Biased::Others(bases), vec![stated]);
        all.extend(pairs(&length(motion, &beside, (flown.windows_s[0], windows), recorded.seconds())?));
    }
    Ok(inflation::fit(&all).map(|fitted| Inflation { whose: Whose::Others, ..fitted }))
}

/// The coefficients of the causes as the study states them: root mean square over the axes.
fn stated(motion: &InMotion) -> [f64; CAUSES.len()] {
    let squares = |kind: Kind, sense: Sense| -> f64 {
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        linear::coefficients(motion, kind)[first..first + 3].iter().sum::<f64>() / 3.0
    };
    let tilt = motion.misalignment;
    CAUSES
        .map(|cause| match cause {
            Cause::Attitude => (2.0 * tilt.tilt_sd_rad.powi(2) + tilt.heading_sd_rad.powi(2)) / 3.0,
            Cause::White(sense) => squares(Kind::White, sense),
            Cause::Walk(sense) => squares(Kind::Walk, sense),
        })
        .map(f64::sqrt)
}
