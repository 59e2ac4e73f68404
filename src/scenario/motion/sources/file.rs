//! `file`: poses that were recorded, as EuRoC, TUM, KITTI or a table with headings.

use std::path::Path;

use super::section::Section;
use super::source::{Source, fail};
use crate::error::Result;
use crate::motion::file::part::Wanted;
use crate::motion::file::span::Span;
use crate::motion::file::{self, Poses, Request, finding::Finding};
use crate::motion::pose::Pose;
use crate::motion::spline::{Departure, through};
use crate::motion::trajectory::Trajectory;
use crate::numerics::order;
use crate::recording::clock::instant::Instant;

/// Name and keys of kind = "file".
pub const SOURCE: Source =
    Source { name: "file", keys: &["file", "format", "from_s", "times", "up", "quaternion", "compare"], poses: None };

/// The motion that a file holds, from `from_s` on.
///
/// # Errors
/// As [`file::read`], and a motion that ends too early.
pub fn trajectory(section: &Section, duration_s: f64) -> Result<Trajectory> {
    let (path, Poses { poses, findings, .. }) = poses(section, duration_s)?;
    let (first, last) = (poses.first().map_or(0.0, |p| p.time_s), poses.last().map_or(0.0, |p| p.time_s));
    if last < duration_s - 1e-9 || first > 1e-9 {
        return Err(short(path, section.from_s.unwrap_or_default(), last, duration_s));
    }
    along(&poses, findings)
}

/// All that a file holds from `from_s` on, on its own clock.
#[derive(Debug, Clone)]
pub struct Whole {
    /// The motion; its zero is `from_s` after the file's first pose.
    pub trajectory: Trajectory,
    /// When the file's first pose was, where its stamps say it.
    pub start: Option<Instant>,
    /// When the motion begins and ends, s from its zero.
    pub extent_s: [f64; 2],
}

/// All of it.
///
/// # Errors
/// As [`file::read`].
pub fn whole(section: &Section) -> Result<Whole> {
    let (_, Poses { poses, start, findings, .. }) = poses(section, f64::INFINITY)?;
    let extent_s = [poses.first().map_or(0.0, |p| p.time_s.max(0.0)), poses.last().map_or(0.0, |p| p.time_s)];
    Ok(Whole { trajectory: along(&poses, findings)?, start, extent_s })
}

fn poses(section: &Section, duration_s: f64) -> Result<(&Path, Poses)> {
    let Some(path) = &section.file else {
        return Err(fail("trajectory.file is missing", "name the file of poses: file = \"ground_truth.csv\""));
    };
    let from_s = section.from_s.unwrap_or_default();
    if !(from_s.is_finite() && from_s >= 0.0) {
        return Err(fail(format!("trajectory.from_s: need zero or more, got {from_s}"), "e.g. from_s = 5.0"));
    }
    let request = Request {
        path,
        format: section.format,
        times: section.times.as_deref(),
        up: section.up,
        quaternion: section.quaternion,
        wanted: Wanted::Both,
        span: Span::Study { from_s, duration_s },
    };
    Ok((path, file::read(&request)?))
}

fn along(poses: &[Pose], mut findings: Vec<Finding>) -> Result<Trajectory> {
    let usual = order::median(poses.windows(2).map(|p| p[1].time_s - p[0].time_s).collect()).unwrap_or_default();
    let spline = through(poses, usual)
        .ok_or_else(|| fail("no spline fits its poses", "are the positions metres and the stamps right?"))?;
    let departure = Departure::of(&spline, poses);
    let Departure { rms_m, largest_m, rms_rad, largest_rad, .. } = departure;
    findings.push(Finding::Knots { knot_s: spline.knot_s(), rms_m, largest_m, rms_rad, largest_rad });
    Ok(Trajectory::new(spline, departure, findings))
}

fn short(path: &Path, from_s: f64, last_s: f64, duration_s: f64) -> crate::error::Error {
    fail(
        format!("{} holds {:.3} s from {from_s} s on, the study needs {duration_s} s", path.display(), last_s.max(0.0)),
        "shorten duration_s, or begin earlier (trajectory.from_s)",
    )
}
