//! Each error source alone grows by its closed form (Titterton and Weston, ch. 12; IEEE 952).

use super::jobs::{Place, REST, job};
use super::row::Row;
use crate::error::Result;
use crate::kernel::integrator::Integrator;
use crate::sensor::Sensor;
use crate::statistics::Summary;
use crate::statistics::quantity::{POSITION, TILT};
use crate::units::STANDARD_GRAVITY_M_S2 as G;

const MEMBERS: u64 = 8192;
const TIMES_S: [f64; 3] = [5.0, 10.0, 20.0];
/// Four standard errors of a standard deviation from 8192 members are 3.1 %.
const SPREAD: f64 = 0.04;

/// One source: how it is switched on, and what its position error must be.
struct ErrorCase {
    name: &'static str,
    set: fn(&mut Sensor),
    law: fn(f64) -> f64,
    /// The mean of a constant error, else the standard deviation.
    constant: bool,
}

const SOURCES: [ErrorCase; 6] = [
    ErrorCase {
        name: "bias 0.034 m/s²: ½bt²",
        set: |s| s.accelerometer.bias_m_s2 = 0.034,
        law: |t| 0.5 * 0.034 * t * t,
        constant: true,
    },
    ErrorCase {
        name: "velocity random walk: N t^1.5/√3",
        set: |s| s.accelerometer.velocity_random_walk_m_s_rts = 4e-4,
        law: |t| 4e-4 * t.powf(1.5) / 3_f64.sqrt(),
        constant: false,
    },
    ErrorCase {
        name: "acceleration random walk: K t^2.5/√20",
        set: |s| s.accelerometer.acceleration_random_walk_m_s2_rts = 1e-4,
        law: |t| 1e-4 * t.powf(2.5) / 20_f64.sqrt(),
        constant: false,
    },
    ErrorCase {
        name: "gyro bias: gbt³/6",
        set: |s| s.gyro.bias_rad_s = 1e-4,
        law: |t| G * 1e-4 * t.powi(3) / 6.0,
        constant: true,
    },
    ErrorCase {
        name: "angle random walk: gN t^2.5/√20",
        set: |s| s.gyro.angle_random_walk_rad_rts = 1e-4,
        law: |t| G * 1e-4 * t.powf(2.5) / 20_f64.sqrt(),
        constant: false,
    },
    ErrorCase {
        name: "rate random walk: gK t^3.5/√252",
        set: |s| s.gyro.rate_random_walk_rad_s_rts = 1e-5,
        law: |t| G * 1e-5 * t.powf(3.5) / 252_f64.sqrt(),
        constant: false,
    },
];

/// All rows on one backend.
///
/// # Errors
/// As the backend.
pub fn rows(place: &mut Place) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for source in &SOURCES {
        let mut sensor = Sensor::default();
        (source.set)(&mut sensor);
        let job = job(sensor, MEMBERS, &TIMES_S, REST, Integrator::Ideal);
        let statistics = place.run(&job)?;
        let pick = |s: &Summary| if source.constant { s.mean } else { s.sd };
        for (t, got) in statistics.time_s.iter().zip(statistics.series(POSITION, pick)) {
            let what = format!("{}: position after {t} s, {}", source.name, place.name);
            let tolerance = if source.constant { 1e-3 } else { SPREAD };
            rows.push(Row::near(what, got, (source.law)(*t), tolerance * (source.law)(*t)));
        }
        if source.name.starts_with("velocity") {
            // Control: one-sided density in place of the two-sided coefficient, a factor √2.
            let last = statistics.at.last().map_or(f64::NAN, |at| at[POSITION].sd);
            let wrong = 2_f64.sqrt() * (source.law)(TIMES_S[2]);
            rows.push(Row::near("N taken for a density", last, wrong, SPREAD * wrong).control());
        }
        if source.name.starts_with("angle") {
            let last = statistics.at.last().map_or(f64::NAN, |at| at[TILT].sd);
            let law = 1e-4 * TIMES_S[2].sqrt();
            rows.push(Row::near(format!("tilt N√t after 20 s, {}", place.name), last, law, SPREAD * law));
        }
    }
    rows.extend(paper(place)?);
    Ok(rows)
}

/// The paper's example: an error of 0.034 m/s² (0.2° of tilt) gives 1.7 m after 10 s.
fn paper(place: &mut Place) -> Result<Option<Row>> {
    let mut sensor = Sensor::default();
    sensor.accelerometer.bias_m_s2 = 0.034;
    let statistics = place.run(&job(sensor, 256, &[10.0], REST, Integrator::Ideal))?;
    let what = format!("the paper: 0.034 m/s² for 10 s, as printed, {}", place.name);
    Ok(statistics.at.first().map(|at| Row::near(what, at[POSITION].mean, 1.7, 0.05)))
}
