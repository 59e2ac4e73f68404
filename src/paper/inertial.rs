//! States where figures 5 to 12 get an IMU's readings from: the recording, calibrated by the tool
//! itself, or else a simulation of the same sensor family.
//!
//! Not for judging the calibration: that is `diagnosis::tumble`.

use std::ops::Range;
use std::path::Path;

use super::check::Provenance;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};
use proofmass_base::units::{DEGREE, STANDARD_GRAVITY_M_S2};
use proofmass_diagnosis::tumble::{Imu, Slow, calibrate, poses};
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_recording::{Request, read};
use proofmass_scenario::navigation::tilt::{Vector, turn};

/// Readings in SI on a uniform clock, and where the IMU lay still.
#[derive(Debug, Clone)]
pub struct Inertial {
    /// States whether the readings were recorded or simulated.
    pub source: Provenance,
    /// Origin of the readings, for captions.
    pub origin: String,
    /// Time between readings, s.
    pub step_s: f64,
    /// Specific force, m/s².
    pub force_m_s2: Vec<Vector>,
    /// Angular rate, rad/s.
    pub rate_rad_s: Vec<Vector>,
    /// Still stretches in samples, in order of time; the first is the longest.
    pub poses: Vec<Range<usize>>,
}

/// One-sided noise densities that the maker of the paper's sensor family prints: gyro, rad/s/√Hz;
/// accelerometer, m/s²/√Hz (Xsens, MTi and MTx User Manual, table of specifications).
pub(super) const PRINTED_GYRO_DENSITY: f64 = 0.05 * DEGREE;
pub(super) const PRINTED_ACCELEROMETER_DENSITY: f64 = 0.002;

/// Columns of the recording.
const COLUMNS: [&str; 6] = ["gx_cnt", "gy_cnt", "gz_cnt", "ax_cnt", "ay_cnt", "az_cnt"];

/// The recording in `folder/xsens_mti`, counts turned into SI by a calibration on its own still
/// poses.
///
/// # Errors
/// Files that cannot be read, or poses that cannot be used.
pub fn recorded(folder: &Path, control: &Control) -> Result<Inertial> {
    let folder = folder.join("xsens_mti");
    let path = folder.join("raw_counts.csv");
    let request = Request {
        columns: COLUMNS.map(String::from).to_vec(),
        time: Some("t_s".into()),
        control: control.clone(),
        ..Request::default()
    };
    let recording = read(&path, &request)?;
    let column = |name: &str| {
        recording.column(name).ok_or_else(|| {
            Error::new(format!("could not use {}", path.display()), format!("no column `{name}`"), "see its README")
        })
    };
    let triad = |from: usize| -> Result<[&[f64]; 3]> {
        Ok([column(COLUMNS[from])?, column(COLUMNS[from + 1])?, column(COLUMNS[from + 2])?])
    };
    let imu = Imu {
        rate_hz: recording.rate_hz,
        gyro: Some(triad(0)?),
        accelerometer: triad(3)?,
        covariate: None,
        // Tilt is a ratio of forces: the local value of g drops out.
        gravity_m_s2: STANDARD_GRAVITY_M_S2,
    };
    let intervals = folder.join("static_intervals.csv");
    let poses = if intervals.is_file() { poses::read(&intervals, &recording)? } else { poses::find(&imu) };
    let calibration = calibrate(imu.clone(), &poses)?;
    let (mut force_m_s2, mut rate_rad_s) = (Vec::new(), Vec::new());
    for i in 0..recording.samples() {
        let force = calibration.specific_force_m_s2(imu.accelerometer_at(i).into(), &Slow::default());
        rate_rad_s.push(calibration.rate_rad_s(imu.gyro_at(i).into(), &force, &Slow::default()).into());
        force_m_s2.push(force.into());
    }
    let origin = format!("{} samples of an Xsens MTi at {:.0} Hz", recording.samples(), recording.rate_hz);
    Ok(Inertial {
        source: Provenance::Recorded,
        origin,
        step_s: 1.0 / recording.rate_hz,
        force_m_s2,
        rate_rad_s,
        poses,
    })
}

/// A simulation of the same sensor family: a still minute, then moves by hand between still poses.
pub(crate) fn simulated() -> Inertial {
    let step_s: f64 = 0.01;
    let mut random = Philox::new(5, 0, Stream::Host);
    let mut normal = || random.normal();
    let sigma = |density: f64| density * (0.5 / step_s).sqrt();
    let (gyro, accelerometer) = (sigma(PRINTED_GYRO_DENSITY), sigma(PRINTED_ACCELEROMETER_DENSITY));
    let bias: Vector = std::array::from_fn(|_| 0.01 * DEGREE * normal());
    let mut up = [0.0, 0.1, 1.0f64];
    up = up.map(|u| u / 1.01f64.sqrt());
    let mut out = Inertial {
        source: Provenance::Simulated,
        origin: "a simulated sensor with the datasheet noise of an Xsens MTi at 100 Hz".into(),
        step_s,
        force_m_s2: vec![],
        rate_rad_s: vec![],
        poses: vec![],
    };
    for pose in 0..12 {
        let (still, moving) = if pose == 0 { (6000, 300) } else { (600, 300) };
        let begin = out.force_m_s2.len();
        let axis: Vector = std::array::from_fn(|_| normal());
        let shake: Vector = std::array::from_fn(|_| 2.0 * normal());
        for i in 0..still + moving {
            let mut rate = [0.0; 3];
            let mut extra = [0.0; 3];
            if i >= still {
                let phase = 2.0 * std::f64::consts::PI * f64::from(i - still) / f64::from(moving);
                // A turn that starts and ends at rest, and a hand that shakes while it turns.
                rate = axis.map(|a| 0.35 * a * (1.0 - phase.cos()));
                extra = shake.map(|s| s * (3.0 * phase).sin());
            }
            up = turn(up, rate, step_s);
            out.force_m_s2
                .push(std::array::from_fn(|k| STANDARD_GRAVITY_M_S2 * up[k] + extra[k] + accelerometer * normal()));
            out.rate_rad_s.push(std::array::from_fn(|k| rate[k] + bias[k] + gyro * normal()));
        }
        out.poses.push(begin + 20..begin + still as usize - 20);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_scenario::navigation::tilt::{mean, norm};

    #[test]
    fn the_simulation_lies_still_where_it_says() {
        let imu = simulated();
        for pose in &imu.poses {
            let length = norm(mean(&imu.force_m_s2[pose.clone()]));
            assert!((length - STANDARD_GRAVITY_M_S2).abs() < 0.01, "{length}");
        }
    }
}
