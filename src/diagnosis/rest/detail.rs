//! States what a diagnosis of a sensor at rest keeps: plain numbers behind its figures, reasons
//! behind its words.

use super::statement::Statement;
use crate::verdict::Stretch;

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Unit of the channels.
    pub unit: String,
    /// Holds what the figures show of each channel.
    pub channels: Vec<ChannelDetail>,
    /// States whether something that a temperature column would show is named, and none was
    /// recorded.
    pub temperature_unlogged: bool,
    /// States whether environment columns were recorded.
    pub has_environment: bool,
    /// Location of the mismatch.
    pub location: Location,
    /// Drifts whose exponent is not, or may not be, that of a library law.
    pub departures: Vec<Departure>,
    /// Holds what is found of the readings and their noise besides.
    pub statements: Vec<Statement>,
}

/// Holds what the figures show of a channel; all in file units.
#[derive(Debug, Clone, Default)]
pub struct ChannelDetail {
    /// Heading of the column.
    pub name: String,
    /// Ids named in it.
    pub named: Vec<String>,
    /// States whether its own model leaves noise.
    pub fits: bool,
    /// τ in s, recorded Allan deviation, base model's, repaired model's.
    pub allan: Vec<[f64; 4]>,
    /// Frequency in Hz, one-sided density recorded, base, repaired, unit/√Hz.
    pub density: Vec<[f64; 4]>,
    /// Time in s, block mean, repaired model's curve (0 where it has none).
    pub trace: Vec<[f64; 3]>,
}

/// A drift with an exponent of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Departure {
    /// Heading of the column that drifts.
    pub channel: String,
    /// Library laws that describe it best.
    pub ids: Vec<String>,
    /// The law named for it, whose exponent is nearest.
    pub near: Option<String>,
    /// States whether they are refuted; else the recording cannot tell.
    pub refuted: bool,
    /// States whether the exponent is that of the course in time, t^p; else of the spectrum, f^−α.
    pub in_time: bool,
    /// The environment column that a function of no stated form describes it by, where one does.
    pub column: Option<String>,
    /// Time of a single jump that describes it as well, s from the first sample.
    pub jump_s: Option<f64>,
    /// The exponent; absent where a smooth course without one does best.
    pub exponent: Option<f64>,
    /// 95 % interval of the exponent.
    pub ci95: Option<[f64; 2]>,
}

/// States where the mismatch lives: the one that repair removed where every channel is described,
/// else what is left.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Location {
    /// States whether the models found describe every channel.
    pub described: bool,
    /// Jumps of the bias, each once for all channels that take part.
    pub jumps: Vec<Jump>,
    /// Knocks, which were left out of the fits.
    pub knocks: Vec<Knocked>,
    /// Channels with many single readings far off, of one size.
    pub spikes: Vec<Spiky>,
    /// Channels that hop between levels.
    pub hops: Vec<Hops>,
    /// Channels that are not noise as modelled, worst first.
    pub mismatches: Vec<Mismatch>,
    /// Further such channels, by name.
    pub also: Vec<String>,
}

/// A short disturbance of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Knocked {
    /// Heading of the disturbed column.
    pub channel: String,
    /// First time left out of the fit, s.
    pub from_s: f64,
    /// Last time left out of the fit, s.
    pub to_s: f64,
    /// Its largest reading off the level, in standard deviations of the noise.
    pub deviations: f64,
}

/// A channel with spikes.
#[derive(Debug, Clone, PartialEq)]
pub struct Spiky {
    /// Heading of the column with spikes.
    pub channel: String,
    /// Number of outlying readings.
    pub count: usize,
}

/// A jump of the bias.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// Channels that jump then.
    pub channels: Vec<String>,
    /// Time of the jump, s from the first sample.
    pub time_s: f64,
}

/// A bias that hops between levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Hops {
    /// Heading of the column that hops.
    pub channel: String,
    /// Levels above the lowest, from it up, in the unit of the channels.
    pub levels: Vec<f64>,
    /// Mean time at each, s.
    pub dwell_s: Vec<f64>,
    /// Number of hops between the levels.
    pub count: usize,
}

/// A channel that differs from noise as modelled.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mismatch {
    /// Heading of the column that differs.
    pub channel: String,
    /// The band of frequency, Hz, that stands out most.
    pub band_hz: Option<Stretch>,
    /// Frequency below which it has less power than modelled, Hz, and the share of it that it has.
    pub fading: Option<[f64; 2]>,
    /// States whether nothing is amiss in time.
    pub steady: bool,
    /// Least and most power over that modelled among stretches of time.
    pub power: [f64; 2],
    /// Stretches of time that stand out, s.
    pub time_s: Vec<Stretch>,
    /// Change of the power from end to end over its mean, where it creeps.
    pub creep: Option<f64>,
    /// States whether nothing is amiss outside those stretches.
    pub only_there: bool,
}
