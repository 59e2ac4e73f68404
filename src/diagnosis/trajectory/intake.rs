//! From a file and its model to readings and reference on one clock; what is wrong with them is
//! said by name.

use nalgebra::{UnitQuaternion, Vector3};

use super::log::{Halves, Log, Motion};
use super::mistaken::Mistake;
use super::orientation;
use super::permutation::Permutation;
use super::start::Start;
use super::upright;
use crate::error::{Error, Result};
use crate::model::{Half, Reference, Trajectory};
use crate::motion::file::part::{Part, Wanted};
use crate::motion::file::span::Span;
use crate::motion::file::{self, Poses};
use crate::number::rounded;
use crate::numerics::order;
use crate::recording::clock::instant::Instant;
use crate::recording::inertial::{self, Names};
use crate::recording::scale::Named;
use crate::recording::unit::Quantity;
use crate::recording::{Recording, roles};

/// Fewest seconds that both cover.
const SHORTEST_S: f64 = 10.0;
/// Fewest poses that both cover.
const FEWEST: usize = 100;
/// The same of positions alone: five rows of three poses in each of twenty blocks, whose attitudes
/// are free.
const FEWEST_ALONE: usize = 300;
/// A difference of clocks that no overlap will mend, s.
const DAYS_S: f64 = 86_400.0;
/// A year, s.
const YEAR_S: f64 = 365.25 * DAYS_S;
/// Share of the gyro's variance that the reference must explain before both move alike.
const ALIKE: f64 = 0.3;
/// Root mean square of the rate, rad/s, below which nothing turns.
const TURNS: f64 = 0.01;

fn fail(recording: &Recording, cause: String, hint: &str) -> Error {
    Error::new(format!("could not diagnose {}", recording.path.display()), cause, hint)
}

/// Which columns are which: as the model says, else as their headings do.
pub(super) fn names(recording: &Recording, model: &Trajectory) -> Result<Names> {
    let headings: Vec<String> = recording.columns.iter().map(|c| c.name.clone()).collect();
    let found = roles::of(&headings);
    let of = |given: &Option<[String; 3]>, found: Option<[usize; 3]>, what: &str| {
        given.clone().or_else(|| found.map(|places| places.map(|k| headings[k].clone()))).ok_or_else(|| {
            let hint = "name the columns under [columns]: gyro = [\"gx\", \"gy\", \"gz\"], and accelerometer";
            fail(recording, format!("no three columns are recognised as its {what}"), hint)
        })
    };
    Ok([
        of(&model.columns.gyro, found.gyro, "gyro")?,
        of(&model.columns.accelerometer, found.accelerometer, "accelerometer")?,
    ])
}

/// Readings, and when the first of the file was.
pub(super) fn log(recording: &Recording, names: &Names, findings: &mut Vec<String>) -> Result<(Log, Option<Instant>)> {
    if recording.path.exists() {
        let read = inertial::read(&recording.path, Some(names))?;
        let first = read.row.partition_point(|row| *row < recording.first_row);
        let until = read.time_s.get(first).copied().unwrap_or_default()
            + (recording.samples() as f64 - 0.5) / recording.rate_hz;
        let last = read.time_s.partition_point(|t| *t <= until).max(first);
        findings.extend(read.findings.iter().map(ToString::to_string));
        let of = |values: &[[f64; 3]]| values[first..last].iter().map(|v| Vector3::from(*v)).collect();
        let log = Log {
            time_s: read.time_s[first..last].to_vec(),
            rate: of(&read.rate_rad_s),
            force: of(&read.force_m_s2),
            interval_s: read.interval_s,
        };
        return Ok((log, Some(read.start)));
    }
    let of = |names: &[String; 3]| -> Vec<Vector3<f64>> {
        let columns = names.each_ref().map(|name| recording.column(name).unwrap_or_default());
        (0..recording.samples()).map(|k| Vector3::from_fn(|i, _| columns[i].get(k).copied().unwrap_or(0.0))).collect()
    };
    let si = |names: &[String; 3], quantity: Quantity| -> Result<[f64; 3]> {
        let mut si = [1.0; 3];
        for (si, name) in si.iter_mut().zip(names) {
            let named = Named { name, stated: recording.stated(name), quantity, option: "the heading" };
            *si = named.unit(None)?.map_or(1.0, |unit| unit.si);
        }
        Ok(si)
    };
    let scales = [si(&names[0], Quantity::Gyro)?, si(&names[1], Quantity::Accelerometer)?];
    let of = |sensor: usize| -> Vec<Vector3<f64>> {
        of(&names[sensor]).into_iter().map(|v| v.component_mul(&Vector3::from(scales[sensor]))).collect()
    };
    let interval_s = 1.0 / recording.rate_hz;
    let time_s = (0..recording.samples()).map(|k| k as f64 * interval_s).collect();
    Ok((Log { time_s, rate: of(0), force: of(1), interval_s }, None))
}

/// Checks whether specific force is in m/s², with gravity in it.
pub(super) fn units(recording: &Recording, log: &Log) -> Result<()> {
    let usual = order::median(log.force.iter().map(Vector3::norm).collect()).unwrap_or_default();
    if usual > 4.0 && usual < 25.0 {
        return Ok(());
    }
    let size = rounded(usual, 3);
    let (cause, hint) = if (0.8..1.25).contains(&usual) {
        (format!("specific force is typically {size}: in g?"), "head its columns with their unit, e.g. ax_g")
    } else if usual < 4.0 {
        let cause = format!("specific force is typically {size} m/s²: gravity has been removed");
        (cause, "record specific force as the sensor reads it, 9.8 m/s² at rest")
    } else {
        (format!("specific force is typically {size} m/s²"), "head its columns with their unit, e.g. ax_mg or ax_m_s2")
    };
    Err(fail(recording, cause, hint))
}

/// The reference on the clock of the IMU, over the time that both cover.
pub(super) fn motion(
    recording: &Recording,
    reference: &Reference,
    log: &Log,
    start: Option<Instant>,
    findings: &mut Vec<String>,
) -> Result<Motion> {
    let (first, last) = (log.time_s[0], log.time_s[log.time_s.len() - 1]);
    let request = file::Request {
        path: &reference.file,
        format: reference.format,
        times: reference.times.as_deref(),
        up: reference.up,
        quaternion: reference.quaternion,
        wanted: match reference.only {
            None => Wanted::Any,
            Some(Half::Attitude) => Wanted::Only(Part::Attitude),
            Some(Half::Position) => Wanted::Only(Part::Position),
        },
        span: Span::Log { start, ends_s: [first, last] },
    };
    let Poses { poses, rows, has_position, has_attitude, quaternion, place, turn, start: began, findings: found } =
        file::read(&request)?;
    findings.extend(found.iter().map(ToString::to_string));
    let shift_s = match (start, began) {
        (Some(start), Some(began)) => began.since(&start),
        _ => 0.0,
    };
    let ends = [poses.first(), poses.last()].map(|p| p.map_or(0.0, |p| p.time_s + shift_s));
    let gap_s = (ends[0] - last).max(first - ends[1]);
    if gap_s > DAYS_S {
        let apart = match gap_s / YEAR_S {
            years if years >= 1.0 => format!("{} years", rounded(years, 3)),
            _ => format!("{} days", rounded(gap_s / DAYS_S, 4)),
        };
        let cause = format!("the clocks of {} and the IMU are {apart} apart", reference.file.display());
        return Err(fail(recording, cause, "stamp both by one clock, or both from zero on"));
    }
    if gap_s > 0.0 {
        let side = if ends[0] > last { "begins after the IMU ends" } else { "ends before the IMU begins" };
        let cause = format!(
            "{} and the IMU do not overlap: the reference {side}, by {} s",
            reference.file.display(),
            rounded(gap_s, 4)
        );
        return Err(fail(recording, cause, "are they of one run, and stamped by one clock?"));
    }
    let inside = |t: f64| t >= first + 2.0 * log.interval_s && t <= last - 2.0 * log.interval_s;
    let (poses, row): (Vec<_>, Vec<_>) =
        poses.into_iter().zip(rows).filter(|(p, _)| inside(p.time_s + shift_s)).unzip();
    let covered_s = poses.last().map_or(0.0, |p| p.time_s) - poses.first().map_or(0.0, |p| p.time_s);
    let fewest = if has_attitude { FEWEST } else { FEWEST_ALONE };
    if covered_s < SHORTEST_S || poses.len() < fewest {
        let cause = format!(
            "reference and IMU overlap for {} s with {} poses: need {SHORTEST_S} s and {fewest} poses",
            rounded(covered_s, 3),
            poses.len()
        );
        return Err(fail(recording, cause, "give a longer recording, or a reference of all of it"));
    }
    let time_s: Vec<f64> = poses.iter().map(|p| p.time_s + shift_s).collect();
    let interval_s = order::median(time_s.windows(2).map(|t| t[1] - t[0]).collect()).unwrap_or_default();
    let position: Vec<Vector3<f64>> = poses.iter().map(|p| p.position_m).collect();
    let attitude: Vec<UnitQuaternion<f64>> = poses.iter().map(|p| p.attitude).collect();
    let halves = Halves { attitude: has_attitude, position: has_position };
    Ok(Motion { time_s, position, attitude, row, interval_s, halves, zero_s: -shift_s, quaternion, place, turn })
}

/// That a reference goes on in another frame behind this row, turned by so much.
pub(super) fn lost_bearings(recording: &Recording, reference: &Reference, row: usize, angle_rad: f64) -> Error {
    let cause = format!(
        "{}: attitude jumps by {}° behind row {row} and stays so, where the gyro does not turn",
        reference.file.display(),
        rounded(angle_rad.to_degrees(), 3)
    );
    fail(recording, cause, "choose a stretch without it: the IMU's rows, as rows = [[from, to]] in the model")
}

/// That readings do not agree with positions, and what is mistaken where that is known.
pub(super) fn not_alike(
    recording: &Recording,
    reference: &Reference,
    explained: f64,
    mistake: Option<Mistake>,
) -> Error {
    let (cause, hint) = mistake.map_or_else(
        || {
            let cause = format!(
                "reference and IMU do not move alike: gyro and accelerometer explain {} % of the accelerations that \
                 its positions show",
                rounded(100.0 * explained.max(0.0), 2)
            );
            (cause, "are they of one run, and does the body accelerate? with attitudes as well it need not")
        },
        |mistake| {
            let (cause, hint) = mistake.words();
            (cause.to_owned(), hint)
        },
    );
    fail(recording, format!("{}: {cause}", reference.file.display()), hint)
}

/// Checks whether both move alike, in the same units and with the same hand: all of the reference,
/// where the search starts from its sound part, and what part of it that is.
pub(super) fn alike(
    recording: &Recording,
    reference: &Reference,
    (log, masked, motion): (&Log, &[bool], &Motion),
    (start, kept): (&Start, f64),
    gravity_m_s2: f64,
) -> Result<()> {
    if let Some(wrong) = upright::wrong(log, motion, start, gravity_m_s2) {
        let (cause, hint) = wrong.words();
        return Err(fail(recording, format!("{}: {cause}", reference.file.display()), &hint));
    }
    let turning = (log.rate.iter().map(Vector3::norm_squared).sum::<f64>() / log.rate.len() as f64).sqrt();
    // What hardly turns does not tell one reading of a quaternion from another.
    let fault =
        if turning > TURNS { orientation::fault((log, masked, motion), (start, kept), gravity_m_s2) } else { None };
    if let Some(fault) = fault {
        let (cause, hint) = fault.words();
        return Err(fail(recording, format!("{}: {cause}", reference.file.display()), &hint));
    }
    if turning > TURNS && start.explained < ALIKE {
        let cause = format!(
            "reference and gyro do not turn alike, however its quaternions are read: one explains {} % of the other at the best shift of their clocks",
            rounded(100.0 * start.explained.max(0.0), 2)
        );
        return Err(fail(recording, cause, "are they of one run? are the reference's quaternions body to world?"));
    }
    if start.accelerometer == (Permutation { axis: [0, 1, 2], turned: [true; 3] }) {
        let cause =
            "the accelerometer reads −g at rest where specific force is +g: gravity has the wrong sign".to_owned();
        return Err(fail(recording, cause, "negate its columns: specific force is acceleration less gravity"));
    }
    let times = start.gyro_unit;
    if (40.0..80.0).contains(&times) {
        let cause = format!("the gyro reads {} times the reference's rate: degrees for radians?", rounded(times, 3));
        return Err(fail(recording, cause, "head its columns with their unit, e.g. gx_deg_s"));
    }
    Ok(())
}
