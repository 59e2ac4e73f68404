//! The laws that reading errors follow, whatever instrument and unit: a constant, white noise, a
//! random walk and so on.
//!
//! Here stands what needs no simulation: the value that switches a law off, its power of time in
//! position, what one sample gets of it. How it is added to a reading, on the CPU and in WGSL, is
//! `kernel::reading`.

use crate::rng::Stream;

/// A law of reading errors. Coefficients are two-sided as in IEEE 952 (N = n/√2 for a one-sided
/// density n).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorLaw {
    /// A constant added to every reading, unit.
    Constant,
    /// A further constant next to the bias, unit: what geometry adds to it.
    Offset,
    /// In proportion to the specific force along the axis to a power, unit/(m/s²)^power: in an
    /// instrument that should not feel it.
    Force(u32),
    /// In proportion to how much warmer than its reference the sensor is, and to the specific force
    /// along the axis to a power, unit/K/(m/s²)^power.
    Warm(u32),
    /// In proportion to a power of how much warmer than its reference the sensor is, unit/K^power.
    WarmPower(u32),
    /// In proportion to the true signal to a power, unit^(1 − power).
    Proportional(u32),
    /// White noise with random-walk coefficient N, unit·√s.
    White(Stream),
    /// Bias instability B (minimum Allan deviation / 0.664), unit.
    Flicker(Stream),
    /// Random walk K, unit/√s, from zero.
    Walk(Stream),
    /// A straight line in time with slope R (IEEE 952), unit/s, from zero.
    Ramp,
    /// A first-order Gauss–Markov process of this standard deviation from its stationary law, unit;
    /// its correlation time is the next row.
    Markov(Stream),
    /// An error that dies out exponentially from the beginning of the run on: its first value,
    /// unit; its time constant is the next row.
    Settling,
    /// A sine of this amplitude, unit; frequency and phase are the next rows.
    Sine,
    /// No error by itself: a number of the term before it.
    Shape(Shape),
    /// Rounding to steps of this size, unit.
    Rounding,
    /// Full scale: the largest magnitude of a reading, unit.
    FullScale,
    /// A first-order low-pass between the proof mass and all that is added to its reading: its time
    /// constant, s.
    LowPass,
    /// The reading of the proof mass comes late by so long, s: the same for all members.
    Delay,
}

/// A number by which a term is more than its strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Correlation time of a Gauss–Markov process, s; 0 for one that never forgets.
    Memory,
    /// Time constant of what dies out, s; 0 for what stays.
    Settling,
    /// Frequency of a sine, rad/s.
    Frequency,
    /// Phase of a sine at the beginning of the run, rad; drawn around the circle where it is not
    /// given.
    Phase,
}

/// Growth of an error from the simplest ones, by integrals over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Growth {
    /// A constant, integrated so often.
    OfAConstant(u32),
    /// White noise, integrated so often.
    OfWhiteNoise(u32),
    /// Any other error.
    Other,
}

/// Stands for "no limit" in the kernels: f32 arithmetic on it must not overflow into NaN.
const NO_LIMIT: f64 = 1e30;

/// A full scale as a kernel takes it, which knows no infinity.
pub const fn full_scale(limit: f64) -> f64 {
    limit.min(NO_LIMIT)
}

impl ErrorLaw {
    /// The coefficient that switches it off.
    pub const fn neutral(self) -> f64 {
        match self {
            Self::FullScale => f64::INFINITY,
            _ => 0.0,
        }
    }

    /// A number that laws of the same kind share, whatever they draw.
    pub const fn kind(self) -> u32 {
        match self {
            Self::Constant => 0,
            Self::Proportional(_) => 1,
            Self::White(_) => 2,
            Self::Flicker(_) => 3,
            Self::Walk(_) => 4,
            Self::Rounding => 5,
            Self::FullScale => 6,
            Self::Ramp => 7,
            Self::Offset => 8,
            Self::Force(_) => 9,
            Self::Warm(_) => 10,
            Self::Markov(_) => 11,
            Self::Settling => 12,
            Self::Sine => 13,
            Self::Shape(_) => 14,
            Self::LowPass => 15,
            Self::Delay => 16,
            Self::WarmPower(_) => 17,
        }
    }

    /// Returns what it is an integral of, where theory has a closed form for it.
    pub fn growth(self) -> Growth {
        match self {
            Self::Constant | Self::Offset => Growth::OfAConstant(0),
            Self::Ramp => Growth::OfAConstant(1),
            Self::White(_) => Growth::OfWhiteNoise(0),
            Self::Walk(_) => Growth::OfWhiteNoise(1),
            Self::Force(_)
            | Self::Warm(_)
            | Self::WarmPower(_)
            | Self::Proportional(_)
            | Self::Flicker(_)
            | Self::Markov(_)
            | Self::Settling
            | Self::Sine
            | Self::Shape(_)
            | Self::Rounding
            | Self::FullScale
            | Self::LowPass
            | Self::Delay => Growth::Other,
        }
    }

    /// The power of time by which an accelerometer's position error grows, where it is one power; a
    /// gyro's, which acts through tilt and gravity, grows by one more.
    pub fn position_exponent(self) -> Option<f64> {
        match self.growth() {
            Growth::OfAConstant(integrals) => Some(2.0 + f64::from(integrals)),
            Growth::OfWhiteNoise(integrals) => Some(1.5 + f64::from(integrals)),
            Growth::Other => None,
        }
    }

    /// Returns whether it acts on the reading as a whole, so that "alone" means nothing: rounding
    /// is a constant without noise and white with it, saturation needs the full reading. Such a
    /// term is judged by switching it off.
    pub fn acts_on_the_reading(self) -> bool {
        matches!(self, Self::Rounding | Self::FullScale)
    }

    /// Returns the factor of a kernel's unit noise at each sample: N/√T, K√T, RT, times of a shape
    /// in samples, the others as they are.
    pub fn per_sample(self, coefficient: f64, sample_s: f64) -> f64 {
        match self {
            Self::White(_) => coefficient / sample_s.sqrt(),
            Self::Walk(_) => coefficient * sample_s.sqrt(),
            Self::Ramp => coefficient * sample_s,
            Self::FullScale => full_scale(coefficient),
            // Exact: the part of itself that a process loses over a sample, 1 − e^(−T/τ).
            Self::Shape(Shape::Memory) if coefficient > 0.0 => -(-sample_s / coefficient).exp_m1(),
            Self::Shape(Shape::Settling) if coefficient > 0.0 => sample_s / coefficient,
            Self::Constant
            | Self::Offset
            | Self::Force(_)
            | Self::Warm(_)
            | Self::WarmPower(_)
            | Self::Proportional(_)
            | Self::Flicker(_)
            | Self::Markov(_)
            | Self::Settling
            | Self::Sine
            | Self::Shape(_)
            | Self::Rounding
            | Self::LowPass
            | Self::Delay => coefficient,
        }
    }

    /// The random numbers it draws, if it draws any.
    pub const fn stream(self) -> Option<Stream> {
        match self {
            Self::White(stream) | Self::Flicker(stream) | Self::Walk(stream) | Self::Markov(stream) => Some(stream),
            _ => None,
        }
    }
}
