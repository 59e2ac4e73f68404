//! A measurement that aids the navigation: which errors it sees, with what noise, and how they are
//! corrected by it.
//!
//! The gains are the same for all members, made on the host before the run (`strapdown::aiding`).
//! Here is only what the kernels need of them; the twins that apply them are `cpu::aiding` and
//! `shaders/shared/fix.wgsl`.

/// Errors that a fix may see: velocity and position in north-east-down.
pub const SEEN: usize = 6;
/// Number of quantities that it may correct: attitude, velocity and position in north-east-down,
/// then what is taken off the readings of the accelerometers and of the gyros in body axes.
pub const CORRECTED: usize = 15;

/// One measurement of position, velocity or both, and the gains it is applied with.
#[derive(Debug, Clone, PartialEq)]
pub struct Fix {
    /// Samples after the end of the still start, those of the fix included.
    pub sample: u64,
    /// Standard deviation of what it sees, m/s and m; `None` where it sees nothing.
    pub sd: [Option<f64>; SEEN],
    /// Correction per unit of what is seen: taken off the nine errors, added to what is taken off
    /// the readings.
    pub gain: [[f64; SEEN]; CORRECTED],
}

impl Fix {
    /// A fix that corrects nothing yet.
    pub fn seeing(sample: u64, sd: [Option<f64>; SEEN]) -> Self {
        Self { sample, sd, gain: [[0.0; SEEN]; CORRECTED] }
    }
}

/// The number of the first fix after `sample` samples, or the number of all.
pub fn next(fixes: &[Fix], sample: u64) -> usize {
    fixes.partition_point(|fix| fix.sample <= sample)
}

/// The fix that is due when `sample` samples have passed, with its number.
pub fn at(fixes: &[Fix], sample: u64) -> Option<(usize, &Fix)> {
    let number = fixes.partition_point(|fix| fix.sample < sample);
    fixes.get(number).filter(|fix| fix.sample == sample).map(|fix| (number, fix))
}
