//! States what may move the reading of a sensor at rest, by name.

/// A term of a channel's model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cause {
    /// White noise at another level than promised.
    WhiteNoise,
    QuantisationNoise,
    FlickerNoise,
    /// A sum of independent steps.
    RandomWalk,
    RateRamp,
    GaussMarkov,
    /// A line in the spectrum.
    Sinusoid,
    WarmUp,
    /// Something that an environment column or another channel shows.
    TemperatureSensitivity,
    /// A filter in the sensor that takes the top of its band away: no physics left out.
    BandLimit,
    /// A single jump of the bias: in no library, a check on what is.
    Jump,
}
