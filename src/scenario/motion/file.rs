//! Poses from files: EuRoC, TUM, KITTI, and tables with headings, in any format that recordings
//! have.
//!
//! `format` → `layout` → `read` → `rotation`: which columns say what, and what the rows say; then
//! `hand` and `judge` tell what is wrong with them. Body axes stay the file's. Not for readings of
//! sensors (`recording`).

pub mod finding;
pub mod format;
mod geodetic;
mod hand;
mod judge;
mod layout;
pub mod part;
mod read;
mod refusal;
mod rotation;
pub mod span;

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::earth::Place;
use super::pose::Pose;
use crate::error::{Error, Result};
use crate::recording::clock::instant::Instant;
use crate::recording::formats;
use finding::Finding;
use format::{Format, Order, Up};
use layout::{Axes, Layout, Rotation};
use part::Wanted;
use refusal::Refusal;
use span::Span;

/// The part of a file of poses that is wanted, and how to read it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request<'a> {
    /// Path of the file of poses.
    pub path: &'a Path,
    /// Layout that the user states.
    pub format: Option<Format>,
    /// The file of times that belongs to it.
    pub times: Option<&'a Path>,
    /// The axis that points up; none: what the format has.
    pub up: Option<Up>,
    /// The order of quaternions, which is then not questioned.
    pub quaternion: Option<Order>,
    /// Part of each pose that is read.
    pub wanted: Wanted,
    /// The stretch that is used.
    pub span: Span,
}

/// Poses of a file in north, east and down; time counts from where the user begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Poses {
    /// The poses, in order of time.
    pub poses: Vec<Pose>,
    /// Row of the file of each, as messages count them.
    pub rows: Vec<usize>,
    /// Says whether the file says where the body is; every position is zero where it does not.
    pub has_position: bool,
    /// Says whether the file says how the body is turned; every attitude is level where it does
    /// not.
    pub has_attitude: bool,
    /// Place of the scalar in its quaternions, as they were read; none: it has none.
    pub quaternion: Option<Order>,
    /// Place of the first pose, where the file states latitudes.
    pub place: Option<Place>,
    /// From the file's own axes to north, east and down.
    pub turn: UnitQuaternion<f64>,
    /// When the file's first pose was, where its stamps say it.
    pub start: Option<Instant>,
    /// Irregularities that did not prevent reading.
    pub findings: Vec<Finding>,
}

/// Reads them.
///
/// # Errors
/// A file that cannot be read, columns that are not there, and poses that cannot be one motion:
/// which, where, what to do.
pub fn read(request: &Request<'_>) -> Result<Poses> {
    let path = request.path;
    let fail = |r: Refusal| Error::new(format!("could not read the poses of {}", path.display()), r.cause, r.hint);
    let opened = formats::open(path, None)?;
    let mut layout = Layout::of(opened.headings(), request.format, request.wanted).map_err(fail)?;
    drop(opened);
    let said = layout.insist(request.quaternion);
    let read::Read { mut rows, start, mut findings } = read::rows(path, &layout, request.times, &request.span)?;
    let scalar_first = said.map(|order| order == Order::ScalarFirst);
    let mut place = None;
    if let Some(unit_rad) = layout.geodetic {
        layout.axes = match request.up {
            Some(Up::Z) => Axes::EastNorthUp,
            Some(Up::MinusZ) => Axes::NorthEastDown,
            _ => layout.axes,
        };
        place = geodetic::unroll(&mut rows, unit_rad, layout.axes).map_err(fail)?;
        findings
            .extend(place.map(|place| Finding::Geodetic { place, is_east_first: layout.axes == Axes::EastNorthUp }));
    }
    findings.insert(0, Finding::Recognised { format: layout.format, scalar_first });
    let numbers: Vec<Vec<f64>> = rows.iter().map(|row| row.attitude.clone()).collect();
    let level = || vec![Some(UnitQuaternion::identity()); numbers.len()];
    let attitudes = layout.rotation.map_or_else(|| Ok(level()), |r| rotation::attitudes(r, &numbers)).map_err(fail)?;
    let (mut poses, mut places, mut lost) = (Vec::new(), Vec::new(), Vec::new());
    for (row, attitude) in rows.iter().zip(attitudes) {
        match attitude {
            Some(attitude) => {
                poses.push(Pose { time_s: row.time_s - request.span.zero_s(), position_m: row.position_m, attitude });
                places.push(row.row);
            }
            None => lost.push(row.row),
        }
    }
    findings.extend(lost.first().map(|first_row| Finding::Dropped { rows: lost.len(), first_row: *first_row }));
    findings.extend(judge::judge(&poses, &places, &request.span).map_err(fail)?);
    let to_level = to_level(&layout, request.up, &mut findings);
    if let (Some(order), None, true) = (said, request.quaternion, layout.has_position) {
        let up = to_level.transpose() * -Vector3::z();
        hand::check(&poses, order, up, &request.span).map_err(fail)?;
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(to_level));
    for pose in &mut poses {
        pose.position_m = to_level * pose.position_m;
        pose.attitude = turn * pose.attitude;
    }
    let (has_position, has_attitude) = (layout.has_position, layout.rotation.is_some());
    if !has_attitude {
        poses.iter_mut().for_each(|pose| pose.attitude = UnitQuaternion::identity());
    }
    Ok(Poses { poses, rows: places, has_position, has_attitude, quaternion: said, place, turn, start, findings })
}

/// From the file's reference to north, east and down, and what is to be said of it.
fn to_level(layout: &Layout, up: Option<Up>, findings: &mut Vec<Finding>) -> Matrix3<f64> {
    match (layout.axes, up.filter(|_| layout.geodetic.is_none())) {
        (Axes::NorthEastDown, None) => {
            findings.push(Finding::NamedAxes);
            Matrix3::identity()
        }
        (Axes::EastNorthUp, None) => {
            findings.push(Finding::NamedAxes);
            Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0)
        }
        (_, up) => {
            let up = up.unwrap_or(if layout.format == Format::Kitti { Up::MinusY } else { Up::Z });
            findings.push(Finding::Turned { up });
            up.to_level()
        }
    }
}

impl Layout {
    /// Takes the user's order of quaternions for the file's; the order that holds, where there are
    /// quaternions.
    fn insist(&mut self, order: Option<Order>) -> Option<Order> {
        let Some(Rotation::Quaternion(found)) = self.rotation else { return None };
        let Some(order) = order.filter(|order| *order != found) else { return Some(found) };
        // The numbers stand in the file where they are; their meaning moves by one place.
        let numbers = self.numbers_of_position();
        match order {
            Order::ScalarFirst => self.columns[numbers..].rotate_left(1),
            Order::ScalarLast => self.columns[numbers..].rotate_right(1),
        }
        self.rotation = Some(Rotation::Quaternion(order));
        Some(order)
    }
}
