//! The first pass over a file: which of its rows are used, by which clock, before any is read for
//! its values.

use std::ops::Range;
use std::path::Path;

use super::clock::survey::Survey;
use super::clock::timeline::{SetBack, Timeline};
use super::clock::{self, Clock, Question};
use super::clock_column;
use super::dropped::{Dropped, Reason, Tally};
use super::finding::Finding;
use super::limits::RATES_HZ;
use super::repeats::{Meaning, Repeated, Repeats};
use super::request::Request;
use super::rows::{Rows, Wanted};
use super::source::FileSummary;
use super::time_unit::Basis;
use super::walk::{Next, Passed, walk, walk_runs};
use crate::control::Control;
use crate::error::{Error, Kind, Result};
use crate::number::rounded;

/// Which rows are used and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Rows used, apart from single ones that are dropped.
    pub rows: Range<usize>,
    /// The clock, where there is a time column.
    pub clock: Option<Clock>,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Rows that repeat the one before, where there is none.
    pub repeated: Option<Repeated>,
    /// About how many samples come of it.
    pub samples: usize,
    /// Holds what was found and survived.
    pub findings: Vec<Finding>,
    /// Size of the file when it was looked at, bytes.
    pub length_bytes: u64,
}

/// Opens a file as it is asked for.
///
/// # Errors
/// As [`Rows::open_wanted`].
pub(crate) fn open(path: &Path, request: &Request) -> Result<Rows> {
    let columns: Vec<String> = request.columns.iter().filter(|c| Some(*c) != request.time.as_ref()).cloned().collect();
    if columns.is_empty() && !request.columns.is_empty() {
        return Err(refuse(
            path,
            "the time column is the only column asked for".into(),
            "name a column of readings as well",
        ));
    }
    let (topic, time) = (request.topic.as_deref(), request.time.as_deref());
    let rows = Rows::open_wanted(path, &Wanted { topic, time, columns: &columns, memory: request.memory.as_ref() })?;
    if rows.names().iter().all(|name| Some(name.as_str()) == rows.time()) {
        let cause = "it has no column of numbers next to the clock".to_owned();
        return Err(refuse(
            path,
            cause,
            "give a file with a column of readings; a column whose first cell is text is taken for text",
        ));
    }
    Ok(rows)
}

/// Looks through a file. `values` asks for rows that repeat where no clock tells.
///
/// # Errors
/// A file that cannot be read, a clock that none can go by, rows or seconds that are not there.
pub(crate) fn make(path: &Path, request: &Request, values: bool) -> Result<Plan> {
    for (name, seconds) in [("--from-s", request.from_s), ("--to-s", request.to_s)] {
        if seconds.is_some_and(|s| !(s.is_finite() && s >= 0.0)) {
            return Err(refuse(path, format!("{name} is {:?}", seconds.unwrap_or_default()), SECONDS));
        }
    }
    if request.from_s.zip(request.to_s).is_some_and(|(from, to)| from >= to) {
        return Err(refuse(path, "--from-s is not before --to-s".into(), SECONDS));
    }
    let wanted = request.rows.clone().unwrap_or(0..usize::MAX);
    match request.time {
        Some(_) if request.force_rate && request.rate_hz.is_some() => untimed(path, request, wanted, values),
        Some(_) => timed(path, request, wanted),
        None => untimed(path, request, wanted, values),
    }
}

/// Rows of a clock that are looked at where a rate is given.
const ENOUGH_ROWS: usize = 100_000;

/// The file's own clock against the rate that is given: a finding where the rate is forced.
///
/// # Errors
/// A rate that contradicts the clock; Ctrl-C. A clock that cannot be used, or whose unit is only
/// guessed, contradicts nothing.
pub(crate) fn against_clock(path: &Path, request: &Request) -> Result<Option<Finding>> {
    let Some(given_hz) = request.rate_hz else { return Ok(None) };
    let timed = match &request.time {
        Some(_) => request.clone(),
        None => clock_column::own(path, &Request { rate_hz: None, ..request.clone() })?.0,
    };
    if timed.time.is_none() {
        return Ok(None);
    }
    let Ok(table) = open(path, &timed) else { return Ok(None) };
    let table = table.without_checksum().stamps_only();
    let heading = table.time().unwrap_or_default().to_owned();
    let question = Question { path, heading: &heading, rate_hz: None };
    let rows = request.rows.clone().unwrap_or(0..usize::MAX);
    let wanted = rows.start..rows.end.min(rows.start.saturating_add(ENOUGH_ROWS));
    let surveyed = survey(&question, &request.control, table, &wanted, false);
    let judged = surveyed.and_then(|survey| match survey.steps {
        0 => Err(too_few(path, survey.rows)),
        _ => clock::judge(&question, &survey),
    });
    let clock = match judged {
        Ok(clock) => clock,
        Err(error) if error.kind == Kind::Interrupted => return Err(error),
        Err(_) => return Ok(None),
    };
    let guessed = |f: &Finding| matches!(f, Finding::TimeUnit { basis: Basis::Magnitude, .. });
    let clock_hz = clock.rate_hz;
    if clock.findings.iter().any(guessed) || !clock::contradict(clock_hz, given_hz) {
        return Ok(None);
    }
    if request.force_rate {
        return Ok(Some(Finding::RateForced { given_hz, clock_hz }));
    }
    Err(question.refuse(
        format!("the file's own clock `{heading}` says {} Hz, the rate given is {given_hz} Hz", rounded(clock_hz, 6)),
        "leave the rate out and the clock holds, or correct the rate; --force-rate (force_rate = true) uses the rate given",
    ))
}

const SECONDS: &str = "seconds count from the first row: --from-s 60 --to-s 120 is the second minute";

fn refuse(path: &Path, cause: String, hint: &str) -> Error {
    Error::new(format!("could not use {}", path.display()), cause, hint)
}

fn untimed(path: &Path, request: &Request, wanted: Range<usize>, values: bool) -> Result<Plan> {
    let table = open(path, request)?.without_checksum();
    if request.rate_hz.is_none()
        && let Some(name) = table.clock_like()
    {
        // A clock that cannot be gone by is the matter, not that there is none.
        timed(path, &Request { time: Some(name.to_owned()), ..request.clone() }, wanted.clone())?;
    }
    let rate_hz = checked_rate(path, request.rate_hz, &table)?;
    let forced = against_clock(path, request)?;
    // A float beyond all rows becomes the largest number.
    let row = |seconds: f64| (seconds * rate_hz - 1e-6).ceil().max(0.0) as usize;
    let seconds = request.from_s.map_or(0, row)..request.to_s.map_or(usize::MAX, row);
    let rows = wanted.start.max(seconds.start)..wanted.end.min(seconds.end);
    let mut table = table;
    let length_bytes = table.length_bytes();
    let mut repeats = Repeats::default();
    let mut row = vec![f64::NAN; table.names().len()];
    let mut count = 0;
    if values {
        walk(path, &request.control, &mut table, &rows, |table| {
            table.values(&mut row)?;
            repeats.push(&row);
            count += 1;
            Ok(Next::Go)
        })?;
    }
    let repeated = repeats.judge();
    let mut findings: Vec<Finding> = forced.into_iter().collect();
    if let Some(Repeated { meaning, rows: count, first }) = repeated {
        let lost = meaning == Meaning::Lost;
        findings.push(Finding::RepeatedRows { rows: count, first_row: rows.start + first, lost });
    }
    Ok(Plan { rows, clock: None, rate_hz, repeated, samples: count, findings, length_bytes })
}

fn timed(path: &Path, request: &Request, wanted: Range<usize>) -> Result<Plan> {
    let table = open(path, request)?.without_checksum().stamps_only();
    let heading = table.time().unwrap_or_default().to_owned();
    let length_bytes = table.length_bytes();
    let question = Question { path, heading: &heading, rate_hz: request.rate_hz };
    let seconds = request.from_s.is_some() || request.to_s.is_some();
    let mut survey = survey(&question, &request.control, table, &wanted, seconds)?;
    let mut rows = wanted.clone();
    if seconds && survey.steps > 0 {
        let unit = clock::unit_of(&question, &survey)?.0.seconds();
        let window = request.from_s.unwrap_or(0.0) / unit..request.to_s.map_or(f64::INFINITY, |s| s / unit);
        let table = open(path, request)?.without_checksum().stamps_only();
        (rows, survey) = within(&question, &request.control, table, &wanted, &window)?;
        if request.to_s.is_none() {
            rows.end = wanted.end;
        }
    }
    if survey.rows < 2 || survey.steps == 0 {
        return Err(too_few(path, survey.rows));
    }
    let clock = clock::judge(&question, &survey)?;
    let whole = survey.whole();
    let samples = if matches!(clock.kind, clock::Kind::Even) { whole.ticks } else { whole.steps } as usize + 1;
    let (rate_hz, findings) = (clock.rate_hz, clock.findings.clone());
    Ok(Plan { rows, clock: Some(clock), rate_hz, repeated: None, samples, findings, length_bytes })
}

/// All stamps of the rows wanted. Where seconds will be cut out, a clock that is set back ends what
/// can be cut.
fn survey(
    question: &Question<'_>,
    control: &Control,
    mut table: Rows,
    wanted: &Range<usize>,
    seconds: bool,
) -> Result<Survey> {
    let mut survey = Survey::default();
    walk_runs(question.path, control, &mut table, wanted, |passed| {
        let pushed = match passed {
            Passed::Row(table) => survey.push(table.row(), table.stamp()?, table.is_alike()),
            Passed::Run(run) => {
                let mut rows = (run.first..).zip(run.rows.clone());
                rows.try_for_each(|(row, at)| survey.push(row, run.stamp(at), run.is_alike(at)))
            }
        };
        match pushed {
            Ok(()) => Ok(Next::Go),
            Err(_) if seconds => Ok(Next::Stop),
            Err(back) => Err(question.set_back(&back)),
        }
    })?;
    survey.finish();
    Ok(survey)
}

/// The rows whose time since the first one lies in a window, and their stamps.
fn within(
    question: &Question<'_>,
    control: &Control,
    mut table: Rows,
    wanted: &Range<usize>,
    window: &Range<f64>,
) -> Result<(Range<usize>, Survey)> {
    let (mut survey, mut whole) = (Survey::default(), Timeline::default());
    let mut rows: Option<Range<usize>> = None;
    let mut fail: Option<SetBack> = None;
    walk(question.path, control, &mut table, wanted, |table| {
        let (row, stamp) = (table.row(), table.stamp()?);
        if !stamp.is_missing()
            && let Err(back) = whole.advance(row, stamp)
        {
            fail = Some(back);
            return Ok(Next::Stop);
        }
        if whole.elapsed() >= window.end {
            return Ok(Next::Stop);
        }
        if whole.elapsed() >= window.start {
            rows = Some(rows.as_ref().map_or(row, |r| r.start)..row + 1);
            survey.push(row, stamp, table.is_alike()).map_err(|back| question.set_back(&back))?;
        }
        Ok(Next::Go)
    })?;
    survey.finish();
    match (rows, fail) {
        (Some(rows), None) => Ok((rows, survey)),
        (_, Some(back)) => Err(question.set_back(&back)),
        (None, None) => Err(refuse(question.path, "no row lies in the seconds asked for".into(), SECONDS)),
    }
}

/// Fewer than two rows.
pub(super) fn too_few(path: &Path, rows: usize) -> Error {
    refuse(
        path,
        format!("{rows} data rows"),
        "a recording needs at least two rows under its header, and several thousand to be useful",
    )
}

fn checked_rate(path: &Path, rate_hz: Option<f64>, table: &Rows) -> Result<f64> {
    let fail = |cause: String, hint: String| {
        Err(Error::new(format!("could not assign times to {}", path.display()), cause, hint))
    };
    match rate_hz {
        Some(rate) if RATES_HZ.contains(&rate) => Ok(rate),
        Some(rate) => fail(format!("a sampling rate of {rate:?} Hz"), "give samples per second, e.g. 100.0".into()),
        None => {
            let hint = match table.clock_like() {
                Some(name) => format!(
                    "is `{name}` the time? Name it: --time {name:?}, or time = {name:?} under [columns]; or give"
                ),
                None => "name the column that holds the time (--time NAME, or time under [columns]), or give".into(),
            };
            fail(
                "neither a sampling rate nor a time column was given".into(),
                format!("{hint} the rate in Hz (--rate-hz, rate_hz)"),
            )
        }
    }
}

/// Counts the rows outside those used, once the whole file is known to have `total`.
pub(super) fn drop_outside(tally: &mut Tally, request: &Request, used: &Range<usize>, total: usize) {
    let wanted = request.rows.clone().unwrap_or(0..usize::MAX);
    let parts = [
        (Reason::OutsideRows, 0..wanted.start),
        (Reason::OutsideRows, wanted.end..total),
        (Reason::OutsideSeconds, wanted.start..used.start),
        (Reason::OutsideSeconds, used.end..wanted.end),
    ];
    for (reason, part) in parts {
        let part = part.start.min(total)..part.end.min(total);
        tally.add_all(reason, part);
    }
}

/// Returns whether dropped rows are a finding of their own; others stand in a finding already.
pub(super) fn is_said(dropped: &Dropped) -> bool {
    !matches!(
        dropped.reason,
        Reason::OutsideRows | Reason::OutsideSeconds | Reason::OutsideSplit | Reason::BeyondGap | Reason::HoldsPlace
    )
}

/// Returns what was cut out, where a part was asked for.
pub(super) fn cut_finding(request: &Request, used: &Range<usize>, total: usize) -> Option<Finding> {
    let asked = request.rows.is_some() || request.from_s.is_some() || request.to_s.is_some();
    asked.then(|| Finding::Cut { from_row: used.start, to_row: used.end.min(total), of: total })
}

/// States what is said of a file that was read to its end: rows wanted that are not there, and a
/// file that changed meanwhile.
///
/// # Errors
/// Both.
pub(super) fn check_end(path: &Path, request: &Request, plan: &Plan, source: &FileSummary) -> Result<()> {
    if source.length_bytes != plan.length_bytes {
        return Err(refuse(path, "the file changed while it was read".into(), "wait until the log is complete"));
    }
    let Some(wanted) = request.rows.as_ref().filter(|r| r.start >= r.end || r.end > source.rows) else { return Ok(()) };
    Err(Error::new(
        format!("could not use rows {}..{} of {}", wanted.start, wanted.end, path.display()),
        format!("the file has {} data rows", source.rows),
        "rows are counted from zero after the header; the end is exclusive",
    ))
}
