//! The one file of mirrors: what host and device share in memory. `shaders/shared/layout.wgsl` is the source; a test in
//! `mirror` compares names, offsets and sizes, because a wrong size is accepted in silence by the device.

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
/// Numbers of a member's state before its flicker terms.
pub const STATE: usize = 14;

/// Mirror of `Tile`.
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
    pub flicker: [f32; 16],
}

/// Invocations of a workgroup of `lyapunov` and `poincare`.
pub const ORBIT_WORKGROUP: u32 = 64;

/// Mirror of `OrbitTile`.
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

/// Mirror of `Partial`.
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

/// Mirror of `Report`.
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

/// Mirror of `Bins`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct Bins {
    pub begin: f32,
    pub per_unit: f32,
}
