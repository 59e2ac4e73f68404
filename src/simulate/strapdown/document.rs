//! The answer to a study in motion as the public document `proofmass.study/1`.

mod outage;

use serde::Serialize;

use super::answer::Answer;
use super::covariance::Part;
use super::spreads::{At, Axes, Circular, NorthEastDown, Spherical, Spread};
use super::windows;
use super::windows::document::{Entry, Flight};
use crate::backend::flight::Quantity;
use crate::drift::document::{Backend, Distribution, SCHEMA};
use crate::statistics::jcgm101::Stated;
use crate::study::Study;

/// The whole document; every list runs along `time_s`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
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
    #[serde(skip_serializing_if = "Option::is_none")]
    outages: Option<Vec<outage::Entry>>,
    covariance: Linear,
    error_budget: Vec<Share>,
    #[serde(skip_serializing_if = "Option::is_none")]
    windows: Option<Vec<Entry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    recorded_flight: Option<Flight>,
    findings: Vec<String>,
    member_steps: u64,
    seconds: f64,
    /// Statement of the last horizontal error, where digits were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    jcgm101: Option<Stated>,
    /// Files that the answer was put together from.
    #[serde(skip_serializing_if = "Option::is_none")]
    shards: Option<usize>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RollPitchHeading {
    roll: Distribution,
    pitch: Distribution,
    heading: Distribution,
}

/// The linear covariance, in the places of the ensemble's own.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Linear {
    position_error_ned_m: Axes,
    velocity_error_ned_m_s: Axes,
    attitude_error_rad: Turns,
    /// True if each mean and each spread of the ensemble agrees with the linear model's, to four standard errors.
    agrees: bool,
    /// Sources that a linear model has no place for.
    left_out: Vec<&'static str>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Turns {
    roll: Spread,
    pitch: Spread,
    heading: Spread,
}

impl Linear {
    fn of(answer: &Answer) -> Self {
        let at = At { answer, places: &answer.report };
        Self {
            position_error_ned_m: at.linear_axes(0),
            velocity_error_ned_m_s: at.linear_axes(3),
            attitude_error_rad: Turns { roll: at.linear(6), pitch: at.linear(7), heading: at.linear(8) },
            agrees: answer.apart.is_empty(),
            left_out: answer.covariance.left_out.iter().map(|cause| cause.name()).collect(),
        }
    }
}

/// Effect of one source on the position, by the linear model or, where it leaves the source out, by what the same
/// members err less without it: root mean square of the horizontal and the vertical error, and its fraction of the
/// horizontal mean square of all rows.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Share {
    source: &'static str,
    horizontal_rms_m: Vec<f64>,
    down_rms_m: Vec<f64>,
    share_of_variance: Vec<f64>,
}

impl Share {
    fn of(answer: &Answer, part: &Part) -> Self {
        let report = &answer.report;
        Self {
            source: part.cause.name(),
            horizontal_rms_m: report.iter().map(|k| part.horizontal_m2(*k).sqrt()).collect(),
            down_rms_m: report.iter().map(|k| part.down_m(*k)).collect(),
            share_of_variance: report.iter().map(|k| answer.fraction(part, *k)).collect(),
        }
    }
}

impl Document {
    /// The document of an answer, with what is to be said about it.
    pub fn of(study: &Study, answer: &Answer, findings: Vec<String>) -> Self {
        let ensemble = &answer.ensemble;
        let at = At { answer, places: &answer.report };
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
            position_error_ned_m: at.north_east_down(Quantity::Position),
            velocity_error_ned_m_s: at.north_east_down(Quantity::Velocity),
            attitude_error_rad: RollPitchHeading {
                roll: at.distribution(Quantity::Attitude(0)),
                pitch: at.distribution(Quantity::Attitude(1)),
                heading: at.distribution(Quantity::Attitude(2)),
            },
            horizontal_error_m: at.circular(),
            spherical_error_m: at.spherical(),
            outages: (!answer.outages.is_empty()).then(|| outage::entries(answer)),
            covariance: Linear::of(answer),
            error_budget: answer.parts().map(|part| Share::of(answer, part)).collect(),
            windows: answer.compared.as_ref().map(windows::document::entries),
            recorded_flight: answer.compared.as_ref().map(windows::document::flight),
            findings,
            member_steps: ensemble.member_steps,
            seconds: ensemble.seconds,
            jcgm101: None,
            shards: None,
        }
    }

    /// The same with what is stated of its last horizontal error.
    pub fn with_digits(self, jcgm101: Option<Stated>) -> Self {
        Self { jcgm101, ..self }
    }

    /// The same, put together from this many files.
    pub fn with_shards(self, shards: Option<usize>) -> Self {
        Self { shards, ..self }
    }
}
