//! The answer to a study in motion as the public document `proofmass.study/1`.

use serde::Serialize;

use super::answer::Answer;
use super::covariance::Part;
use super::windows;
use super::windows::document::{Entry, Flight};
use crate::backend::flight::Quantity;
use crate::drift::document::{Backend, Distribution, SCHEMA};
use crate::study::Study;

/// The whole document; every list runs along `time_s`.
#[derive(Debug, Clone, Serialize)]
pub struct Document {
    schema: &'static str,
    name: String,
    version: &'static str,
    seed: u64,
    members: u64,
    failed: u64,
    backend: Backend,
    integrator: String,
    time_s: Vec<f64>,
    position_error_ned_m: NorthEastDown,
    velocity_error_ned_m_s: NorthEastDown,
    attitude_error_rad: RollPitchHeading,
    horizontal_error_m: Circular,
    spherical_error_m: Spherical,
    covariance: Linear,
    error_budget: Vec<Share>,
    #[serde(skip_serializing_if = "Option::is_none")]
    windows: Option<Vec<Entry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    recorded_flight: Option<Flight>,
    findings: Vec<String>,
    member_steps: u64,
    seconds: f64,
}

#[derive(Debug, Clone, Serialize)]
struct NorthEastDown {
    north: Distribution,
    east: Distribution,
    down: Distribution,
}

#[derive(Debug, Clone, Serialize)]
struct RollPitchHeading {
    roll: Distribution,
    pitch: Distribution,
    heading: Distribution,
}

/// Radii of circles about the truth that hold 50 and 95 % of the members.
#[derive(Debug, Clone, Serialize)]
struct Circular {
    cep50: Vec<f64>,
    cep95: Vec<f64>,
}

/// Radii of spheres about the truth that hold 50 and 95 % of them.
#[derive(Debug, Clone, Serialize)]
struct Spherical {
    sep50: Vec<f64>,
    sep95: Vec<f64>,
}

/// Mean and standard deviation by the linear model.
#[derive(Debug, Clone, Serialize)]
struct Spread {
    mean: Vec<f64>,
    sd: Vec<f64>,
}

/// The linear covariance, in the places of the ensemble's own.
#[derive(Debug, Clone, Serialize)]
struct Linear {
    position_error_ned_m: Axes,
    velocity_error_ned_m_s: Axes,
    attitude_error_rad: Turns,
    /// Whether every spread of the ensemble lies within four standard errors of its own.
    agrees: bool,
    /// Sources that a linear model has no place for.
    left_out: Vec<&'static str>,
}

#[derive(Debug, Clone, Serialize)]
struct Axes {
    north: Spread,
    east: Spread,
    down: Spread,
}

#[derive(Debug, Clone, Serialize)]
struct Turns {
    roll: Spread,
    pitch: Spread,
    heading: Spread,
}

impl Linear {
    fn of(answer: &Answer) -> Self {
        let Answer { covariance, report, .. } = answer;
        let spread = |place: usize| Spread {
            mean: report.iter().map(|k| covariance.mean(*k, place)).collect(),
            sd: report.iter().map(|k| covariance.variance(*k, place).sqrt()).collect(),
        };
        let axes = |first: usize| Axes { north: spread(first), east: spread(first + 1), down: spread(first + 2) };
        Self {
            position_error_ned_m: axes(0),
            velocity_error_ned_m_s: axes(3),
            attitude_error_rad: Turns { roll: spread(6), pitch: spread(7), heading: spread(8) },
            agrees: answer.apart.is_empty(),
            left_out: covariance.left_out.iter().map(|cause| cause.name()).collect(),
        }
    }
}

/// What one source does to the position, by the linear model: root mean square of the horizontal and the vertical error that it
/// makes alone, and its fraction of the horizontal mean square.
#[derive(Debug, Clone, Serialize)]
struct Share {
    source: &'static str,
    horizontal_rms_m: Vec<f64>,
    down_rms_m: Vec<f64>,
    share_of_variance: Vec<f64>,
}

impl Share {
    fn of(answer: &Answer, part: &Part) -> Self {
        let Answer { covariance, report, .. } = answer;
        Self {
            source: part.cause.name(),
            horizontal_rms_m: report.iter().map(|k| covariance.horizontal_m2(part, *k).sqrt()).collect(),
            down_rms_m: report.iter().map(|k| (part.variance[*k][2] + part.mean[*k][2].powi(2)).sqrt()).collect(),
            share_of_variance: report.iter().map(|k| covariance.fraction(part, *k)).collect(),
        }
    }
}

impl Document {
    /// The document of an answer, with what is to be said about it.
    pub fn of(study: &Study, answer: &Answer, findings: Vec<String>) -> Self {
        let Answer { ensemble, report, .. } = answer;
        let of = |quantity: Quantity| -> Distribution {
            Distribution::of(&report.iter().map(|k| ensemble.summary(*k, quantity)).collect::<Vec<_>>())
        };
        let ned = |quantity: fn(usize) -> Quantity| NorthEastDown {
            north: of(quantity(0)),
            east: of(quantity(1)),
            down: of(quantity(2)),
        };
        let percentile = |quantity: Quantity, place: usize| -> Vec<f64> {
            report.iter().map(|k| ensemble.summary(*k, quantity).percentiles[place]).collect()
        };
        Self {
            schema: SCHEMA,
            name: study.name.clone(),
            version: env!("CARGO_PKG_VERSION"),
            seed: study.seed,
            members: ensemble.members,
            failed: ensemble.failed,
            backend: Backend::of(&ensemble.machine),
            integrator: ensemble.machine.integrator.clone(),
            time_s: answer.report_times_s(),
            position_error_ned_m: ned(Quantity::Position),
            velocity_error_ned_m_s: ned(Quantity::Velocity),
            attitude_error_rad: RollPitchHeading {
                roll: of(Quantity::Attitude(0)),
                pitch: of(Quantity::Attitude(1)),
                heading: of(Quantity::Attitude(2)),
            },
            horizontal_error_m: Circular {
                cep50: percentile(Quantity::Horizontal, 2),
                cep95: percentile(Quantity::Horizontal, 3),
            },
            spherical_error_m: Spherical {
                sep50: percentile(Quantity::Spherical, 2),
                sep95: percentile(Quantity::Spherical, 3),
            },
            covariance: Linear::of(answer),
            error_budget: answer.parts().map(|part| Share::of(answer, part)).collect(),
            windows: answer.compared.as_ref().map(windows::document::entries),
            recorded_flight: answer.compared.as_ref().map(windows::document::flight),
            findings,
            member_steps: ensemble.member_steps,
            seconds: ensemble.seconds,
        }
    }
}
