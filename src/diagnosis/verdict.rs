//! The verdict as the public document `proofmass.verdict/1`: what is named, where it shows, how
//! sure we are.

mod effect;

use serde::Serialize;

use crate::recording::Recording;
use crate::recording::dropped::Dropped;

pub use effect::{DependsOn, Effect, Estimate, Evidence, Form, Share, named};

/// The four things a diagnosis can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Nothing is missing that this recording could show.
    Adequate,
    /// Named effects bring the residual to the noise.
    Explained,
    /// The mismatch is real and nothing in the library accounts for it.
    Unexplained,
    /// Several candidates fit equally, or the excitation is too weak.
    Undecidable,
}

impl Outcome {
    /// Returns the word of verdict.json.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Adequate => "adequate",
            Outcome::Explained => "explained",
            Outcome::Unexplained => "unexplained",
            Outcome::Undecidable => "undecidable",
        }
    }
}

/// File, size and rate of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingInfo {
    /// Path of the recording, as given.
    pub file: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Data rows in the file.
    pub rows: usize,
    /// Samples that were judged, those that stand in for missing ones included.
    pub samples: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Rows that were not used, and why.
    pub dropped: Vec<Dropped>,
}

impl RecordingInfo {
    /// Of a recording in memory.
    pub fn of(recording: &Recording) -> Self {
        Self {
            file: recording.path.display().to_string(),
            sha256: recording.sha256.clone(),
            rows: recording.rows,
            samples: recording.samples(),
            rate_hz: recording.rate_hz,
            dropped: recording.dropped.clone(),
        }
    }
}

/// A stretch of time, band of frequency or range of state where the residual exceeds the noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stretch {
    /// Lower end, in the unit of the list it stands in.
    pub from: f64,
    /// Upper end, in the unit of the list it stands in.
    pub to: f64,
    /// Residual power over what noise explains, as a ratio.
    pub excess: f64,
}

/// Location of the mismatch, after false-discovery control.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Where {
    /// Place of the mismatch in one sentence.
    pub summary: String,
    /// Intervals of time with excess residual, s.
    pub time_s: Vec<Stretch>,
    /// Bands with excess residual, Hz.
    pub frequency_hz: Vec<Stretch>,
    /// In state (amplitude), output unit; for static logs averaging time in s.
    pub state: Vec<Stretch>,
    /// In the plane of displacement and velocity, strongest first; driven recordings only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub state_cells: Vec<StateCell>,
    /// Quantity on which the residual of the final model depends most; absent where it is at the
    /// noise or depends on none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub argument: Option<DependsOn>,
}

/// A cell of displacement and velocity where a force is missing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateCell {
    /// Displacements from, to; output unit.
    pub displacement: [f64; 2],
    /// Velocities from, to; output unit per s.
    pub velocity: [f64; 2],
    /// Mean missing force over ω₀², output unit.
    pub force: f64,
    /// Force over its standard error.
    pub excess: f64,
}

/// Fit on one part of the recording: root-mean-square error of free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// Error of the base model, in the output's unit.
    pub rmse_before: f64,
    /// RMSE with the named effects; absent where nothing is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_after: Option<f64>,
    /// 95 % interval of after / before, block bootstrap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio_ci95: Option<[f64; 2]>,
    /// Part of the base model's error that all named effects remove together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<Share>,
}

impl Score {
    /// Part of the base model's error over this noise that is gone, from the errors alone; `None`
    /// where nothing is named or the base model errs by no more than the noise.
    pub(crate) fn share_over(&self, noise: f64) -> Option<Share> {
        let excess = self.rmse_before.powi(2) - noise.powi(2);
        let part = |after: f64| 1.0 - (after.powi(2) - noise.powi(2)).max(0.0) / excess;
        let [low, high] = self.ratio_ci95?.map(|ratio| part(ratio * self.rmse_before));
        (excess > 0.0).then_some(Share { value: part(self.rmse_after?), ci95: [high, low] })
    }
}

/// Root-mean-square error of free simulation on one range of samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangeScore {
    /// First sample of the range.
    pub from: usize,
    /// The one after the last.
    pub to: usize,
    /// Error of the base model, in the output's unit.
    pub rmse_before: f64,
    /// RMSE with the named effects; absent where nothing is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_after: Option<f64>,
}

/// Use of a recording in the diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Used to fit the model.
    Train,
    /// Used for validation only.
    Test,
}

/// Root-mean-square error of free simulation on one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingScore {
    /// Path of the recording, as given.
    pub file: String,
    /// States whether it is fitted or only validates.
    pub role: Role,
    /// Samples on which the errors were taken.
    pub samples: usize,
    /// Error of the base model, in the output's unit.
    pub rmse_before: f64,
    /// RMSE with the named effects; absent where nothing is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_after: Option<f64>,
    /// Of a body without a spring, whose errors above are of windows restarted every second: root
    /// mean square of the difference between the input and the input that its motion takes, over
    /// that of the input, below a twenty-fifth of the sampling rate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_error_before: Option<f64>,
    /// The same with the named effects; absent where nothing is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_error_after: Option<f64>,
}

/// Mean log-likelihood per sample on the test part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LogScore {
    /// Value for the base model.
    pub before: f64,
    /// Score of the model with the named effects.
    pub after: f64,
}

/// The noise of a reading, measured apart from every fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Noise {
    /// Standard deviation, in `unit`.
    pub value: f64,
    /// Unit of the output.
    pub unit: String,
    /// Method of the measurement.
    pub how: String,
}

/// Errors of the repaired model where it also holds terms without a name.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WithUnnamed {
    /// Ids of the terms that are in the repaired model and are not named.
    pub terms: Vec<String>,
    /// Root-mean-square error on the fitted samples.
    pub train_rmse: f64,
    /// Root-mean-square error on the held-out samples.
    pub test_rmse: f64,
    /// The same on each range of them, in the order of `test_ranges`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub test_ranges_rmse: Vec<f64>,
}

/// Errors of the models on fitted and held-out samples. What is called "after" is the base model
/// with the named effects and nothing else.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Unit of the errors.
    pub unit: String,
    /// Holds what noise alone leaves, by the model that was fitted.
    pub noise_floor: f64,
    /// The noise of the reading, measured without any model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// Errors on the fitted samples.
    pub train: Score,
    /// Errors on the held-out samples.
    pub test: Score,
    /// The same on each range of it, where the model file names several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub test_ranges: Vec<RangeScore>,
    /// Each recording of a driven sensor, in the order given, those that only judge last.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<RecordingScore>,
    /// Errors of the repaired model, where that holds more than what is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_unnamed: Option<WithUnnamed>,
    /// Log-likelihood per held-out sample, where noise terms are judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_score: Option<LogScore>,
    /// RMSE of one-step prediction on the test part, stated apart from free simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_step_rmse: Option<[f64; 2]>,
}

/// States whether the repaired model leaves white noise, or noise that is white once each reading
/// is compared with the few before it (a finding says so then).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Whiteness {
    /// At the 5 % level, corrected for the number of tests and channels; the same in every kind.
    pub white: bool,
    /// The smallest probability among all tests of what is left, corrected in the same way.
    pub p_value: f64,
}

/// The smallest strength of a candidate that would have been named.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Detectable {
    /// Id in the library of candidates.
    pub id: String,
    /// Symbol of the parameter that states the strength.
    pub parameter: String,
    /// The smallest strength; absent where no strength would show.
    pub strength: Option<f64>,
    /// Unit of that parameter.
    pub unit: String,
    /// Root-mean-square of what that strength does to the reading, over the noise.
    pub effect_over_noise: Option<f64>,
    /// Share of that power which refitted base parameters hide.
    pub hidden_share: f64,
}

/// A sensor's way from readings to SI: calibrated = matrix · (reading − bias).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SensorCalibration {
    /// Matrix by rows, calibrated unit per unit of the reading.
    pub matrix: [[f64; 3]; 3],
    /// 95 % interval of each entry.
    pub matrix_ci95: [[[f64; 2]; 3]; 3],
    /// Bias in the reading's own unit.
    pub bias: [f64; 3],
    /// 95 % interval of each.
    pub bias_ci95: [[f64; 2]; 3],
    /// Unit after calibration.
    pub unit: String,
}

/// Calibrations of an IMU.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Triads {
    /// Absent where none was recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gyro: Option<SensorCalibration>,
    /// Calibration of the accelerometer, m/s².
    pub accelerometer: SensorCalibration,
    /// Ids of the effects that were fitted with it and that biases and matrices leave in the readings.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub leaves: Vec<&'static str>,
}

/// Thermomechanical noise of a resonator, by its fitted resonance and width and by the mass and
/// temperature that the model states.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Thermal {
    /// Temperature that was stated, K.
    pub temperature_k: f64,
    /// One-sided density of the force, N²/Hz.
    pub force_psd_n2_hz: f64,
    /// One-sided density of the displacement at resonance, m²/Hz.
    pub displacement_psd_m2_hz: f64,
    /// Root mean square of the displacement over all frequencies, m.
    pub displacement_rms_m: f64,
    /// Noise-equivalent bandwidth that was stated, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bandwidth_hz: Option<f64>,
    /// Root mean square that it makes of X and of Y at resonance, in the reading's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reading_rms: Option<f64>,
    /// Root mean square of the final residual over that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_ratio: Option<f64>,
}

/// The public document `proofmass.verdict/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// Always "proofmass.verdict/1".
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    pub schema: &'static str,
    /// Kind of recording that was diagnosed.
    #[cfg_attr(feature = "schema", schemars(with = "String", extend("enum" = super::candidate::Kind::ALL.map(super::candidate::Kind::name))))]
    pub kind: super::candidate::Kind,
    /// The verdict, one of four.
    pub verdict: Outcome,
    /// The verdict in a sentence or two.
    pub sentence: String,
    /// File, size and rate of the recording.
    pub recording: RecordingInfo,
    /// The base model's own numbers, fitted together with the named effects.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub base: Vec<Estimate>,
    /// Named effects, strongest first.
    pub effects: Vec<Effect>,
    /// Location of the mismatch.
    #[serde(rename = "where")]
    pub location: Where,
    /// Biases and matrices of an IMU in poses, whatever the verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Triads>,
    /// Errors before and after repair.
    pub fit: Fit,
    /// States whether anything is left.
    pub residual_after: Whiteness,
    /// Noise of a resonator's own temperature, where mass, temperature and calibration are stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// If nothing is named: strengths that would have been named.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub detectable: Vec<Detectable>,
    /// Experiment that would decide or confirm the verdict.
    pub next_experiment: String,
    /// Found in the file and survived; said so that nothing is silent.
    pub findings: Vec<String>,
    /// Holds what each rule that acted changed, where that was asked for (`diagnose --trace`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace: Option<Vec<super::trace::Step>>,
}

/// Value of `schema` in the document.
pub const SCHEMA: &str = "proofmass.verdict/1";
