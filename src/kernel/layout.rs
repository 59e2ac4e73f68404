//! The one file of mirrors: what host and device share in memory. `shaders/shared/layout.wgsl` is
//! the source; a test in `mirror` compares names, offsets and sizes, because a wrong size is
//! accepted in silence by the device.

use bytemuck::{Pod, Zeroable};

/// Invocations of a workgroup of `simulate`.
pub const SIMULATE_WORKGROUP: u32 = 64;
/// Invocations of a workgroup of `peak`.
pub const PEAK_WORKGROUP: u32 = 64;
/// Entries of the uniform array of forces, 16 bytes each: 64 KB, which every adapter offers.
pub const FORCES: usize = 4096;
/// Invocations of a workgroup of `reduce`.
pub const REDUCE_WORKGROUP: u32 = 64;
/// Members that a workgroup of `reduce` sums up.
pub const BLOCK: u32 = 256;
/// Places in a member's state, emitted into the shader as `STATE_…`. Totals are two numbers each: a
/// sum and what it lost.
pub mod state {
    use crate::rng::Stream;
    use crate::sensor::SensorTerm;
    use crate::sensor::error_law::ErrorLaw;
    use crate::sensor::terms::alike;

    /// Error of the reading.
    pub const E: usize = 0;
    /// Rate of the reading times the substep.
    pub const Q: usize = 1;
    /// Position since the last multiple of 64 samples.
    pub const POSITION: usize = 2;
    /// Velocity since the last multiple of 64 samples.
    pub const VELOCITY: usize = 3;
    /// Rate of turn summed since then.
    pub const RATE: usize = 4;
    /// Position up to then.
    pub const POSITION_TOTAL: usize = 5;
    /// Velocity up to then.
    pub const VELOCITY_TOTAL: usize = 7;
    /// Rate of turn summed up to then.
    pub const RATE_TOTAL: usize = 9;
    /// Says whether the member left the range of its model.
    pub const FAILED: usize = 11;
    /// Mean error of the accelerometer that a still start takes off.
    pub const MEAN: usize = 12;
    /// Mean error of the gyro that it takes off.
    pub const GYRO_MEAN: usize = 13;
    /// Error of what a low-pass shows.
    pub const LOW_PASS: usize = 14;
    /// Random walks, one for each term that is one.
    pub const WALKS: usize = 15;
    /// Number of random walks.
    pub const WALK_COUNT: usize = alike(ErrorLaw::Walk(Stream::Host), SensorTerm::COUNT);
    /// Gauss–Markov processes, one for each term that is one.
    pub const MARKOVS: usize = WALKS + WALK_COUNT;
    /// Number of Gauss–Markov processes.
    pub const MARKOV_COUNT: usize = alike(ErrorLaw::Markov(Stream::Host), SensorTerm::COUNT);
    /// States of the laws' own follow here, of those that act, and behind them flicker terms, a set
    /// for each sensor term that is switched on.
    pub const TERMS: usize = MARKOVS + MARKOV_COUNT;
    /// Indices by the names that the shader uses.
    pub const NAMED: [(&str, usize); 12] = [
        ("E", E),
        ("Q", Q),
        ("POSITION", POSITION),
        ("VELOCITY", VELOCITY),
        ("RATE", RATE),
        ("POSITION_TOTAL", POSITION_TOTAL),
        ("VELOCITY_TOTAL", VELOCITY_TOTAL),
        ("RATE_TOTAL", RATE_TOTAL),
        ("FAILED", FAILED),
        ("MEAN", MEAN),
        ("GYRO_MEAN", GYRO_MEAN),
        ("LOW_PASS", LOW_PASS),
    ];
}

/// Mirror of the shader's `Tile`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Tile {
    pub seed: [u32; 2],
    pub first_member: [u32; 2],
    pub members: u32,
    pub stride: u32,
    pub first_sample: u32,
    pub samples: u32,
    pub flicker_terms: u32,
    pub tilt_gain: f32,
    pub sample_s: f32,
    pub zero: u32,
    pub still_samples: u32,
    pub still_share: f32,
    pub level: f32,
    pub padding: u32,
    pub flicker: [f32; 16],
}

/// Invocations of a workgroup of `navigate`.
pub const NAVIGATE_WORKGROUP: u32 = 64;
/// Numbers of a member's state in `navigate`: three vectors of parts, three compensated totals, and
/// whether it failed.
pub const NAVIGATE_STATE: usize = 28;
/// Place at which the totals of the attitude begin in it.
pub const NAVIGATE_ATTITUDE: usize = 9;
/// Vectors of the uniform array of passages, 16 bytes each.
pub const PASSAGES: usize = 4096;

/// Mirror of the shader's `Flight`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Flight {
    pub members: u32,
    pub stride: u32,
    pub samples: u32,
    pub since: u32,
    pub sample_s: f32,
    pub free: f32,
    pub zero: u32,
    pub cosine: f32,
    pub sine: f32,
    pub first_sample: u32,
    pub passed: u32,
    pub padding: u32,
    pub own_place: [f32; 4],
    pub own_speed: [f32; 4],
    pub own_turn: [f32; 4],
}

/// Mirror of the shader's `Fix`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Fix {
    pub seed: [u32; 2],
    pub first_member: [u32; 2],
    pub number: u32,
    pub present: u32,
    pub padding: [u32; 2],
    pub sd: [[f32; 4]; 2],
    pub gain: [[f32; 4]; 30],
}

/// Invocations of a workgroup of `lyapunov` and `poincare`.
pub const ORBIT_WORKGROUP: u32 = 64;

/// Mirror of the shader's `OrbitTile`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct OrbitTile {
    pub seed: [u32; 2],
    pub first: [u32; 2],
    pub points: u32,
    pub steps: u32,
    pub begin: u32,
    pub periods: u32,
    pub counted: u32,
    pub strobe: u32,
    pub padding: [u32; 2],
}

/// Mirror of the shader's `Partial`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Partial {
    pub count: u32,
    pub mean: f32,
    pub correction: f32,
    pub squares: f32,
    pub least: f32,
    pub greatest: f32,
}

/// Mirror of the shader's `Report`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Report {
    pub members: u32,
    pub stride: u32,
    pub number: u32,
    pub blocks: u32,
    pub counts: u32,
    pub padding: [u32; 3],
}

/// Mirror of the shader's `Bins`, byte for byte.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Bins {
    pub begin: f32,
    pub per_unit: f32,
}
