//! States what is found of a channel besides missing physics: statements about its readings and its
//! noise, as data.
//!
//! None of them is a mismatch. What is one stands in `detail::Location`.

pub use super::spectrum::Filter;

/// Quantities of the Earth that a sensor at rest should read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Earth {
    /// Gravity, which an accelerometer reads.
    Gravity,
    /// Rotation, which a gyro reads.
    Rate,
}

/// Holds what may lie behind the difference between the length of the means and what the Earth
/// shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Difference {
    /// Nothing: the interval holds what is expected.
    None,
    /// Gravity, which deviates as much from that of the ellipsoid.
    Anomaly,
    /// An error of the sensor as well as gravity of another latitude, °, at the same height.
    Latitude(f64),
    /// An error of the sensor: no place shows as much or as little.
    Sensor,
}

/// Something that a bias follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Follows {
    /// A column of the environment.
    Column {
        /// Heading of the column.
        name: String,
        /// Mean of the column as it acts, after its lag or play, in its unit: θ̄.
        mean: f64,
    },
    /// A ramp or warm-up.
    Time,
}

/// A statement; the words are made in `report`.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// A single reading was left out.
    BadReading {
        /// Heading of the channel.
        channel: String,
        /// Data row in the file, counted from one; absent where rows were dropped, so that places
        /// and rows differ.
        row: Option<usize>,
        /// When, s.
        time_s: f64,
        /// The reading as recorded, in the channel's unit.
        value: f64,
        /// States how far off, in standard deviations of the noise.
        deviations: f64,
    },
    /// More readings far off than normal noise has.
    HeavyTails {
        /// Heading of the channel.
        channel: String,
        /// Fourth moment over the squared second one; 3 for normal noise.
        kurtosis: f64,
    },
    /// A filter in the sensor takes the top of its band away: no error that drifts.
    Filtered {
        /// Heading of the channel.
        channel: String,
        /// Shape of the filter.
        filter: Filter,
        /// Part of the white power that is gone at half the sampling rate.
        lost: f64,
        /// Sampling rate, Hz.
        rate_hz: f64,
    },
    /// Drift makes the bias less certain than the mean of the recording.
    Mean {
        /// Heading of the channel.
        channel: String,
        /// Mean of the recording, in the channel's unit.
        value: f64,
        /// Half the 95 % interval of the recording's own mean.
        of_recording: f64,
        /// Half the 95 % interval of the bias that the drift was added to.
        of_bias: f64,
        /// Things that the bias follows: `value` is its mean over their course.
        follows: Vec<Follows>,
    },
    /// Holds what the Earth should show of itself, next to the length of the three means.
    Reference {
        /// Gravity or its rate.
        earth: Earth,
        /// Of the means, in their unit.
        length: f64,
        /// Its 95 % interval.
        ci95: [f64; 2],
        /// Holds what it should be.
        expected: f64,
        /// Geodetic latitude, °.
        latitude_deg: f64,
        /// Height above the ellipsoid, m, where the model states it; else gravity is that at 0 m.
        height_m: Option<f64>,
        /// Holds what may lie behind the difference.
        difference: Difference,
    },
    /// The power of the noise is not the same at all times.
    Uneven {
        /// Heading of the channel.
        channel: String,
        /// Least and most power of stretches over the mean.
        power: [f64; 2],
        /// Change from end to end over the mean, where it creeps along a straight line.
        creep: Option<f64>,
    },
}
