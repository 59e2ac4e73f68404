//! Holds the sums of a batch, and what has to be kept of one between two tiles so that it goes on
//! with the same bits.

use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::statistics::{Histogram, Moments};

/// A batch at one report time.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Partial {
    /// Moments of each block of 256 members, in order.
    pub blocks: Vec<[Moments; 4]>,
    /// Counts per quantity; empty where no bins were given.
    pub histograms: Vec<Histogram>,
    /// Members that have failed by then.
    pub failed: u64,
}

/// A batch that was stopped between two tiles.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Unfinished {
    /// Members that it covers, half-open.
    pub members: Range<u64>,
    /// Samples simulated so far.
    pub samples: u64,
    /// Sums, one per report time that was passed.
    pub partials: Vec<Partial>,
    /// State of the members that its backend has between two tiles, as that backend writes it.
    #[serde(serialize_with = "to_text", deserialize_with = "from_text")]
    pub state: Vec<u8>,
}

fn to_text<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&STANDARD.encode(bytes))
}

fn from_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    let text = String::deserialize(deserializer)?;
    STANDARD.decode(text).map_err(serde::de::Error::custom)
}
