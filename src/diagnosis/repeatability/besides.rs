//! Names the channels of a log that hold more than the noise whose coefficients are compared, and the sensors of poses
//! whose linear model leaves more than noise.

/// One of those channels or sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct Besides {
    /// Heading of the column, or name of the sensor.
    pub channel: String,
    /// The effect found in it.
    pub what: What,
}

/// An effect that is no such noise.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Effects of the library, by id.
    Named(Vec<String>),
    /// Jumps of the bias, s from the first sample.
    Jumps(Vec<f64>),
    /// Something that no law of the library describes.
    Unnamed,
    /// More than the linear model of a sensor has: by how many times its noise, root mean square.
    Beyond(f64),
}
