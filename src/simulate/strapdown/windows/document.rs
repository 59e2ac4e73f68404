//! The windows of a recorded flight as `windows` of the public document.

use serde::Serialize;

use super::inflation::Inflation;
use super::length::Length;
use super::score::{self, Nees};
use super::{Compared, Sensor};

/// One axis of one sensor, over all windows of a length.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Entry {
    sensor: String,
    axis: &'static str,
    unit: &'static str,
    seconds: f64,
    windows: usize,
    inside50: f64,
    inside90: f64,
    inside99: f64,
    inside50_ci95: [f64; 2],
    inside90_ci95: [f64; 2],
    inside99_ci95: [f64; 2],
    rms_recorded: f64,
    sd_recorded: Option<f64>,
    sd_predicted: f64,
    nees: Option<f64>,
    nees_if_right95: [f64; 2],
}

/// Names and units of the nine errors.
pub const AXES: [(&str, &str); 9] = [
    ("north", "m"),
    ("east", "m"),
    ("down", "m"),
    ("north_velocity", "m/s"),
    ("east_velocity", "m/s"),
    ("down_velocity", "m/s"),
    ("roll", "rad"),
    ("pitch", "rad"),
    ("heading", "rad"),
];

/// Errors that are looked at together.
pub const TOGETHER: [(&str, std::ops::Range<usize>); 4] =
    [("position", 0..3), ("velocity", 3..6), ("attitude", 6..9), ("all", 0..9)];

/// Statement on all windows together.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Flight {
    imu: String,
    sha256: String,
    overlap_s: f64,
    lengths: Vec<Windows>,
    nees: Vec<Joint>,
    inflation: Option<Vec<Inflated>>,
    inflation_windows: Option<usize>,
}

/// Inflation of one cause, with its interval.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Inflated {
    cause: &'static str,
    unit: &'static str,
    stated: f64,
    value: f64,
    ci95: [Option<f64>; 2],
}

/// Names of the causes, and their units.
pub const CAUSES: [(&str, &str); 5] = [
    ("reference_attitude", "rad"),
    ("gyro_white_noise", "rad/sqrt(s)"),
    ("gyro_random_walk", "rad/s/sqrt(s)"),
    ("accelerometer_white_noise", "m/s/sqrt(s)"),
    ("accelerometer_random_walk", "m/s^2/sqrt(s)"),
];

/// The windows of one length.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Windows {
    seconds: f64,
    unused_s: f64,
    windows: Vec<One>,
}

/// Errors and predictions of one window.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct One {
    from_s: f64,
    to_s: f64,
    rows: [usize; 2],
    accelerometer_bias_m_s2: [f64; 3],
    gyro_bias_rad_s: [f64; 3],
    error: [f64; 9],
}

/// Normalised errors squared of several axes together.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Joint {
    sensor: String,
    seconds: f64,
    of: &'static str,
    freedom: usize,
    nees: Option<f64>,
    nees_if_right95: [f64; 2],
}

impl Sensor {
    /// Returns its name in the document.
    pub fn name(&self) -> String {
        match self {
            Self::Stated => "stated".into(),
            Self::Tenfold => "tenfold".into(),
            Self::File(name) => name.clone(),
            Self::Inflated => "inflated".into(),
        }
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Rows of the comparison, one for each axis and length of window.
pub fn entries(compared: &Compared) -> Vec<Entry> {
    let mut all = Vec::new();
    for length in &compared.lengths {
        let errors = length.errors();
        for (sensor, expected) in compared.sensors.iter().zip(&length.expected) {
            for (place, (axis, unit)) in AXES.into_iter().enumerate() {
                let score = score::axis(&errors, expected, place);
                let [inside50, inside90, inside99] = score.inside.map(|hits| hits as f64 / score.windows as f64);
                let [inside50_ci95, inside90_ci95, inside99_ci95] = score.interval;
                let Nees { mean, interval, .. } = score.nees;
                all.push(Entry {
                    sensor: sensor.name(),
                    axis,
                    unit,
                    seconds: length.seconds,
                    windows: score.windows,
                    inside50,
                    inside90,
                    inside99,
                    inside50_ci95,
                    inside90_ci95,
                    inside99_ci95,
                    rms_recorded: score.rms_recorded,
                    sd_recorded: finite(score.sd_recorded),
                    sd_predicted: score.sd_predicted,
                    nees: finite(mean),
                    nees_if_right95: interval,
                });
            }
        }
    }
    all
}

/// Entry of the flight with its windows.
pub fn flight(compared: &Compared) -> Flight {
    let triple = |v: &super::window::Biases, first: usize| [v[first], v[first + 1], v[first + 2]];
    let windows = |length: &Length| Windows {
        seconds: length.seconds,
        unused_s: length.unused_s,
        windows: length
            .windows
            .iter()
            .map(|w| One {
                from_s: w.span_s[0],
                to_s: w.span_s[1],
                rows: w.rows,
                accelerometer_bias_m_s2: triple(&w.biases, 0),
                gyro_bias_rad_s: triple(&w.biases, 3),
                error: w.error.into(),
            })
            .collect(),
    };
    let mut nees = Vec::new();
    for length in &compared.lengths {
        let errors = length.errors();
        for (sensor, expected) in compared.sensors.iter().zip(&length.expected) {
            nees.extend(TOGETHER.map(|(of, places)| {
                let Nees { freedom, mean, interval } = score::together(&errors, expected, places);
                let (sensor, seconds, nees) = (sensor.name(), length.seconds, finite(mean));
                Joint { sensor, seconds, of, freedom, nees, nees_if_right95: interval }
            }));
        }
    }
    let inflated = |inflation: &Inflation| -> Vec<Inflated> {
        let one = |(place, (cause, unit)): (usize, (&'static str, &'static str))| Inflated {
            cause,
            unit,
            stated: compared.stated[place],
            value: inflation.coefficients[place],
            ci95: inflation.interval[place].map(finite),
        };
        CAUSES.into_iter().enumerate().map(one).collect()
    };
    Flight {
        inflation: compared.inflation.as_ref().map(inflated),
        inflation_windows: compared.inflation.map(|i| i.windows),
        imu: compared.imu.clone(),
        sha256: compared.sha256.clone(),
        overlap_s: compared.seconds,
        lengths: compared.lengths.iter().map(windows).collect(),
        nees,
    }
}
