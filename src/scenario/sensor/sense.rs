//! The kinds of sensor in an IMU.

/// Kind of sensor in an IMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// Accelerometer: specific force, m/s².
    Accelerometer,
    /// Gyro: angular rate, rad/s.
    Gyro,
}

impl Sense {
    /// Name as a word in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accelerometer => "accelerometer",
            Self::Gyro => "gyro",
        }
    }
}
