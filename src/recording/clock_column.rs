//! Which column holds the time, where the user names none and gives no rate: what the format says,
//! else a heading that names a clock over numbers that rise, else, in a file without headings,
//! numbers that alone rise in even steps.

use std::path::Path;

use super::finding::{ClockBy, Finding};
use super::format;
use super::formats;
use super::request::Request;
use super::rows::{Rows, Wanted};
use crate::error::Result;

/// Rows that are looked at.
const LOOKED_AT: usize = 1000;
/// Fewer rows tell nothing.
const FEWEST: usize = 16;
/// By how much the steps of a clock that only its numbers tell may differ from their mean.
const EVEN: f64 = 0.2;

/// The request with its clock, and what is to be said of it.
///
/// # Errors
/// As `formats::open` and `Rows::open_wanted`.
pub fn settled(path: &Path, request: &Request) -> Result<(Request, Option<Finding>)> {
    if request.time.is_some() || request.rate_hz.is_some() {
        return Ok((request.clone(), None));
    }
    own(path, request)
}

/// The same of a request that has a clock already: the file's own, whether it is to be used or not.
///
/// # Errors
/// As [`settled`].
pub(super) fn own(path: &Path, request: &Request) -> Result<(Request, Option<Finding>)> {
    let opened = formats::open_in(path, request.memory.as_ref(), request.topic.as_deref())?;
    let headings = opened.headings();
    let with = |name: &str, by: ClockBy| {
        let request = Request { time: Some(name.to_owned()), ..request.clone() };
        let heading = headings.place(name).map_or(name.to_owned(), |place| headings.clock_heading(place));
        (request, Some(Finding::ClockFound { heading, by }))
    };
    if let Some(stated) = opened.stated_clock() {
        return Ok(with(stated, ClockBy::Format));
    }
    let columns = headings.names.iter().filter(|n| opened.names_a_clock(n) && !format::counts_rows(n));
    let mut rising = Vec::new();
    for name in columns.take(4) {
        if !request.columns.contains(name) && steps(path, request, name)?.is_some_and(|s| s.rise) {
            rising.push(name.as_str());
        }
    }
    if let [only] = rising[..] {
        return Ok(with(only, ClockBy::Heading));
    }
    let counted = (1..).zip(&headings.names).all(|(place, name): (usize, _)| *name == place.to_string());
    if counted && headings.names.len() <= 64 {
        let mut even = Vec::new();
        for name in headings.names.iter().filter(|n| !request.columns.contains(n)) {
            if steps(path, request, name)?.is_some_and(|s| s.even) {
                even.push(name.as_str());
            }
        }
        if let [only @ "1"] = even[..] {
            return Ok(with(only, ClockBy::Numbers));
        }
    }
    Ok((request.clone(), None))
}

/// States how the numbers of a column go on.
struct Steps {
    /// They never fall, and do not stand still.
    rise: bool,
    /// They rise by the same each time, nearly.
    even: bool,
}

/// The first rows of a column; `None` where they are too few, or no numbers.
fn steps(path: &Path, request: &Request, name: &str) -> Result<Option<Steps>> {
    let wanted =
        Wanted { topic: request.topic.as_deref(), time: Some(name), columns: &[], memory: request.memory.as_ref() };
    let Ok(rows) = Rows::open_wanted(path, &wanted) else { return Ok(None) };
    let mut rows = rows.without_checksum();
    let mut stamps = Vec::new();
    while stamps.len() < LOOKED_AT && rows.advance().unwrap_or(false) {
        match rows.stamp() {
            Ok(stamp) => stamps.extend(Some(stamp).filter(|s| !s.is_missing())),
            Err(_) => return Ok(None),
        }
    }
    let steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1].since(&pair[0])).collect();
    let span: f64 = steps.iter().sum();
    // A counter may overflow once and a file be short; what falls otherwise is no clock.
    let falls = steps.iter().filter(|s| **s < 0.0).count();
    let mean = span / steps.len().max(1) as f64;
    let even = stamps.len() >= FEWEST && mean > 0.0 && steps.iter().all(|s| (s / mean - 1.0).abs() < EVEN);
    let moves = steps.iter().any(|s| *s > 0.0);
    Ok((stamps.len() >= 2).then_some(Steps { rise: falls <= 1 && moves && (falls == 0 || steps.len() > 10), even }))
}
