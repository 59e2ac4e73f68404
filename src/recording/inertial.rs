//! The readings of an IMU in SI units, each at its own stamp, on the clock that other files share.
//!
//! Rows stay where their stamps put them: nothing is filled or resampled. Not for logs at rest on a
//! clock of their own: that is [`read`](fn@super::read).

use std::path::Path;

use super::clock::instant::{Instant, unit_by_size};
use super::clock_column;
use super::finding::Finding;
use super::format;
use super::formats;
use super::request::Request;
use super::roles::{self, Roles};
use super::rows::{Rows, Wanted};
use super::scale::{self, Measured, Named};
use super::time_unit::TimeUnit;
use super::unit::Quantity;
use crate::error::{Error, Result};
use crate::numerics::order;

/// Readings in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertial {
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Data rows in the file.
    pub rows: usize,
    /// First stamp of the log.
    pub start: Instant,
    /// Since the first stamp, s.
    pub time_s: Vec<f64>,
    /// Row of each reading, counted from zero after the header.
    pub row: Vec<usize>,
    /// Angular rate about x, y and z, rad/s.
    pub rate_rad_s: Vec<[f64; 3]>,
    /// Specific force along x, y and z, m/s².
    pub force_m_s2: Vec<[f64; 3]>,
    /// Rows with a reading that is missing or NaN, and rows that repeat the stamp before; left out.
    pub left_out: usize,
    /// The first of them.
    pub first_left_out: Option<usize>,
    /// Holds what was taken for granted of the units.
    pub findings: Vec<Finding>,
    /// From one reading to the next, as a rule, s.
    pub interval_s: f64,
}

/// The way to state a unit where there is no option for it.
const SCALED: &str = "columns in a unit of the sensor, named in the headings, e.g. gx_deg_s, ax_m_s2";

/// Fewest readings that are worth anything.
const FEWEST: usize = 100;

/// Columns x, y and z of a gyro and of an accelerometer, by their headings.
pub type Names = [[String; 3]; 2];

/// Reads the columns named, or those of a log whose headings are an IMU's.
///
/// # Errors
/// A file that cannot be read, that has no three gyros and three accelerometers or no clock, units
/// of no inertial sensor, stamps that run backwards, too few readings.
pub fn read(path: &Path, named: Option<&Names>) -> Result<Inertial> {
    let fail =
        |cause: String, hint: &str| Error::new(format!("could not read the IMU of {}", path.display()), cause, hint);
    let (request, _) = clock_column::settled(path, &Request::default())?;
    let opened = formats::open(path, None)?;
    let names = opened.headings().names.clone();
    drop(opened);
    // A clock that is set back is one all the same, and is refused as such below.
    let Some(time) = request.time.or_else(|| names.iter().find(|name| format::names_a_clock(name)).cloned()) else {
        let hint = "give it a column of times with a heading that says so, e.g. t_s or `timestamp [ns]`";
        return Err(fail("no column holds the time of its readings".into(), hint));
    };
    let columns: Vec<String> = match (named, roles::of(&names)) {
        (Some(named), _) => named.iter().flatten().cloned().collect(),
        (None, Roles { gyro: Some(gyro), accelerometer: Some(accelerometer) }) => {
            gyro.iter().chain(&accelerometer).map(|place| names[*place].clone()).collect()
        }
        _ => {
            let hint = "name them gx, gy, gz, ax, ay, az (rad/s and m/s², or with the unit in brackets)";
            return Err(fail("its headings do not name three gyros and three accelerometers".into(), hint));
        }
    };
    let mut table = Rows::open_wanted(path, &Wanted { time: Some(&time), columns: &columns, ..Wanted::default() })?;
    let mut findings = Vec::new();
    let mut si = [1.0; 6];
    for (sensor, quantity) in [Quantity::Gyro, Quantity::Accelerometer].into_iter().enumerate() {
        let mut unstated = Vec::new();
        for place in 3 * sensor..3 * sensor + 3 {
            let (name, stated) = (&columns[place], table.units()[place].as_deref());
            match (Named { name, stated, quantity, option: SCALED }).unit(None)? {
                Some(unit) => si[place] = unit.si,
                None => unstated.push(name.clone()),
            }
        }
        if !unstated.is_empty() {
            // What moves shows gravity's length only roughly: its size is for who judges the
            // motion.
            findings.push(scale::assumed(unstated, quantity, SCALED, &Measured::default()).1);
        }
    }
    let mut unit = TimeUnit::of_heading(table.time().unwrap_or_default());
    let mut all = Inertial {
        sha256: String::new(),
        rows: 0,
        start: Instant::ZERO,
        time_s: Vec::new(),
        row: Vec::new(),
        rate_rad_s: Vec::new(),
        force_m_s2: Vec::new(),
        left_out: 0,
        first_left_out: None,
        findings,
        interval_s: 0.0,
    };
    let mut values = [0.0; 6];
    while table.next(&mut values)? {
        let (row, stamp) = (table.row(), table.stamp()?);
        let mut leave_out = || {
            all.left_out += 1;
            all.first_left_out.get_or_insert(row);
        };
        if stamp.is_missing() || values.iter().any(|v| !v.is_finite()) {
            leave_out();
            continue;
        }
        let at = Instant::new(stamp, *unit.get_or_insert_with(|| unit_by_size(&stamp)));
        if all.time_s.is_empty() {
            all.start = at;
        }
        let time_s = at.since(&all.start);
        if let Some(before) = all.time_s.last() {
            if time_s < *before {
                let cause = format!("its stamps run backwards at row {row}, by {:.3} s", before - time_s);
                return Err(fail(cause, "sort the file by time, or split it where the clock was set"));
            }
            if time_s == *before {
                leave_out();
                continue;
            }
        }
        all.time_s.push(time_s);
        all.row.push(row);
        all.rate_rad_s.push(std::array::from_fn(|i| values[i] * si[i]));
        all.force_m_s2.push(std::array::from_fn(|i| values[3 + i] * si[3 + i]));
    }
    let source = table.finish()?;
    (all.sha256, all.rows) = (source.sha256, source.rows);
    if all.left_out > all.time_s.len() {
        let cause = format!("{} of its {} rows hold no reading (NaN or empty)", all.left_out, all.rows);
        return Err(fail(cause, "are these the right columns, and is the file whole?"));
    }
    if all.time_s.len() < FEWEST {
        return Err(fail(
            format!("it holds {} readings: need {FEWEST} at least", all.time_s.len()),
            "give a longer log",
        ));
    }
    all.interval_s = order::median(all.time_s.windows(2).map(|t| t[1] - t[0]).collect()).unwrap_or_default();
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(heading: &str, row: impl Fn(usize) -> String) -> Result<Inertial> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("imu.csv");
        let rows: String = (0..200).map(|k| row(k) + "\n").collect();
        std::fs::write(&path, format!("{heading}\n{rows}")).expect("written");
        read(&path, None)
    }

    const EUROC: &str = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],\
                         a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]";

    #[test]
    fn readings_keep_their_stamps_and_rows_without_are_counted() {
        let row = |k: usize| match k {
            7 => format!("{},0,0,NaN,0,0,9.8", 1_403_715_523_912_143_104 + 5_000_000 * k as i64),
            _ => format!("{},0.1,0,0,0,0,9.8", 1_403_715_523_912_143_104 + 5_000_000 * k as i64),
        };
        let read = log(EUROC, row).expect("read");
        assert_eq!((read.time_s.len(), read.left_out, read.first_left_out), (199, 1, Some(7)));
        assert!(
            (read.time_s[198] - 0.995).abs() < 1e-12
                && read.findings.is_empty()
                && (read.interval_s - 0.005).abs() < 1e-12
        );
        assert_eq!((read.rate_rad_s[0], read.force_m_s2[0]), ([0.1, 0.0, 0.0], [0.0, 0.0, 9.8]));
    }

    #[test]
    fn degrees_are_scaled_and_what_is_no_imu_is_refused() {
        let degrees =
            log("t_s,gx_deg_s,gy_deg_s,gz_deg_s,ax_g,ay_g,az_g", |k| format!("{},180,0,0,0,0,1", k as f64 * 0.01));
        let degrees = degrees.expect("read");
        assert!((degrees.rate_rad_s[3][0] - std::f64::consts::PI).abs() < 1e-12);
        assert!((degrees.force_m_s2[3][2] - 9.806_65).abs() < 1e-12);
        let counts =
            log("t_s,gx_lsb,gy_lsb,gz_lsb,ax_lsb,ay_lsb,az_lsb", |k| format!("{},1,0,0,0,0,1", k as f64 * 0.01));
        assert!(counts.expect_err("counts").cause.contains("counts"));
        let none = log("t_s,u,v,w,p,q,r", |k| format!("{},1,0,0,0,0,1", k as f64 * 0.01));
        assert!(none.expect_err("no IMU").cause.contains("three gyros"));
        let back = log(EUROC, |k| format!("{},1,0,0,0,0,1", if k == 150 { 0 } else { k * 5_000_000 + 1 }));
        assert!(back.expect_err("backwards").cause.contains("backwards at row 150"));
    }
}
