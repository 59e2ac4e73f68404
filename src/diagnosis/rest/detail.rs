//! Plain numbers behind the figures of a sensor at rest.

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Unit of the channels.
    pub unit: String,
    /// One per channel.
    pub channels: Vec<ChannelDetail>,
}

/// What the figures show of a channel; all in file units.
#[derive(Debug, Clone, Default)]
pub struct ChannelDetail {
    /// Heading.
    pub name: String,
    /// Ids named in it.
    pub named: Vec<String>,
    /// τ in s, recorded Allan deviation, base model's, repaired model's.
    pub allan: Vec<[f64; 4]>,
    /// Frequency in Hz, one-sided density recorded, base, repaired, unit/√Hz.
    pub density: Vec<[f64; 4]>,
    /// Time in s, block mean, repaired model's curve (0 where it has none).
    pub trace: Vec<[f64; 3]>,
}
