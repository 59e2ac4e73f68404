//! States what a model asks of its recording: columns, clock, and which stretch of it.

use std::collections::HashSet;
use std::path::Path;

use super::split::Ranges;
use super::{MOST_AT_REST, Model};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::recording::{self, Recording, Request};

/// Seconds of a recording that are used, counted from its first row.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// First second used; absent means the first row.
    pub from_s: Option<f64>,
    /// To here, exclusive; absent means the last row.
    pub to_s: Option<f64>,
}

/// Reads the columns of a recording that its model names.
///
/// # Errors
/// As [`recording::read`](fn@recording::read), and a column that is given two roles.
pub fn read_recording(path: &Path, model: &Model, control: &Control) -> Result<Recording> {
    read_part(path, model, Seconds::default(), control)
}

/// The same of some seconds alone.
///
/// # Errors
/// As [`read_recording`].
pub fn read_part(path: &Path, model: &Model, seconds: Seconds, control: &Control) -> Result<Recording> {
    recording::read(path, &Request { control: control.clone(), ..requested(path, model, seconds)? })
}

/// Returns what a model asks of a recording; `path` stands for it in messages.
///
/// # Errors
/// A column that is given two roles, rows that are none.
pub fn requested(path: &Path, model: &Model, seconds: Seconds) -> Result<Request> {
    let fail = |cause: String, hint: &str| Err(Error::new(format!("could not use {}", path.display()), cause, hint));
    let (rate_hz, rows, time, columns): (Option<f64>, &Ranges, &Option<String>, Vec<&String>) = match model {
        Model::Driven(m) => {
            let c = &m.columns;
            (m.rate_hz, &m.rows, &c.time, c.input.iter().chain([&c.output]).chain(&c.environment).collect())
        }
        Model::Static(m) => {
            let c = &m.columns;
            (m.rate_hz, &m.rows, &c.time, c.channels.iter().chain(&c.environment).collect())
        }
        Model::Tumble(m) => {
            let c = &m.columns;
            (
                m.rate_hz,
                &m.rows,
                &c.time,
                c.gyro.iter().flatten().chain(&c.accelerometer).chain(&c.environment).collect(),
            )
        }
        // One row a step: its clock, if it has one, is a column like the others.
        Model::Response(m) => (Some(1.0), &m.rows, &None, m.columns.all().collect()),
        // None named: the headings say it, and every column is read.
        Model::Trajectory(m) => (m.rate_hz, &m.rows, &m.columns.time, m.columns.readings().collect()),
    };
    if matches!(model, Model::Static(m) if m.columns.channels.is_empty()) {
        return fail("the model names no channel".into(), "name at least one: channels = [\"ax\"] under [columns]");
    }
    let mut known = HashSet::with_capacity(columns.len());
    if let Some(twice) = columns.iter().find(|c| !known.insert(c.as_str())) {
        return fail(
            format!("the model gives the column `{twice}` two roles"),
            "name each column once under [columns]",
        );
    }
    let rows = match &rows[..] {
        [] => None,
        [[from, to]] if from < to => Some(*from..*to),
        [[from, to]] => {
            return fail(
                format!("rows = [[{from}, {to}]] holds no row"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            );
        }
        several => {
            return fail(
                format!("rows names {} ranges, and a recording is one stretch in time", several.len()),
                "give one range; which parts of it are fitted and which judge is for [split]",
            );
        }
    };
    let columns = columns.into_iter().cloned().collect();
    let slow = model.environment().to_vec();
    let mut request = Request { columns, slow, rate_hz, time: time.clone(), rows, ..Request::default() };
    (request.from_s, request.to_s) = (seconds.from_s, seconds.to_s);
    request.topic = model.topic().cloned();
    request.force_rate = match model {
        Model::Driven(m) => m.force_rate,
        Model::Static(m) => m.force_rate,
        Model::Tumble(m) => m.force_rate,
        Model::Trajectory(m) => m.force_rate,
        Model::Response(_) => true,
    };
    if let Model::Static(m) = model {
        request.at_most = Some(MOST_AT_REST);
        request.samples = m.split.hull();
    }
    Ok(request)
}
