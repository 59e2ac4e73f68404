//! The one file of mirrors: what host and device share in memory. `shaders/shared/layout.wgsl` is the source; a test in
//! `source` compares names, offsets and sizes, because a wrong size is accepted in silence by the device.

use bytemuck::{Pod, Zeroable};

use super::member::{COLUMNS, column};

/// Invocations of a workgroup of `simulate`.
pub const SIMULATE_WORKGROUP: u32 = 64;
/// Invocations of a workgroup of `peak`.
pub const PEAK_WORKGROUP: u32 = 64;
/// Bindings of `simulate`.
pub const SIMULATE_BINDINGS: u32 = 6;
/// Entries of the uniform array of forces, 16 bytes each: 64 KB, which every adapter offers.
pub const FORCES: usize = 4096;
/// Members that a workgroup of `reduce` sums up.
pub const BLOCK: u32 = 256;
/// Numbers of a member's state before its flicker terms.
pub const STATE: usize = 14;
/// Numbers of a member per column array and per state: bytes a member takes on the device.
pub fn member_bytes(flicker_terms: usize) -> u64 {
    4 * (COLUMNS + 2 + STATE + flicker_terms + 5) as u64
}

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

/// Invocations of a workgroup of `misfit`.
pub const MISFIT_WORKGROUP: u32 = 64;

/// Mirror of `MisfitTile`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct MisfitTile {
    pub points: u32,
    pub run: u32,
    pub first: u32,
    pub samples: u32,
    pub block: u32,
    pub blocks: u32,
    pub last: u32,
    pub grid_end: u32,
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

/// What a struct of the shader must look like.
pub struct Mirror {
    /// Its name there.
    pub name: &'static str,
    /// Bytes.
    pub size: u32,
    /// Members and their offsets.
    pub members: Vec<(&'static str, u32)>,
}

impl Mirror {
    /// The members with owned names.
    pub fn members_owned(&self) -> Vec<(String, u32)> {
        self.members.iter().map(|(n, o)| ((*n).to_owned(), *o)).collect()
    }
}

macro_rules! mirror {
    ($t:ty as $name:literal { $($field:ident),* } $($padding:literal at $at:expr),*) => {
        Mirror {
            name: $name,
            size: size_of::<$t>() as u32,
            members: {
                let mut members = vec![$((stringify!($field), std::mem::offset_of!($t, $field) as u32)),*];
                members.extend([$(($padding, $at as u32)),*] as [(&str, u32); 0 $(+ { let _ = $padding; 1 })*]);
                members.sort_by_key(|m| m.1);
                members
            },
        }
    };
}

/// All mirrors.
pub fn mirrors() -> Vec<Mirror> {
    vec![
        mirror!(Tile as "Tile" {
            seed, first_member, members, stride, first_sample, samples, flicker_terms, tilt_gain, sample_s, zero, flicker
        }),
        mirror!(Bins as "Bins" { begin, per_unit }),
        mirror!(Partial as "Partial" { count, mean, correction, squares, least, greatest }),
        mirror!(Report as "Report" { members, stride, number, blocks, counts }
            "padding_0" at 20, "padding_1" at 24, "padding_2" at 28),
    ]
}

/// Names in the shader of a member's columns.
pub const COLUMN_NAMES: [(&str, usize); 15] = [
    ("GAIN", column::GAIN),
    ("SINE", column::SINE),
    ("BIAS", column::BIAS),
    ("SCALE", column::SCALE),
    ("K2", column::K2),
    ("WHITE", column::WHITE),
    ("FLICKER", column::FLICKER),
    ("WALK", column::WALK),
    ("QUANTISATION", column::QUANTISATION),
    ("RANGE", column::RANGE),
    ("FORCE", column::FORCE),
    ("GYRO_BIAS", column::GYRO_BIAS),
    ("GYRO_WHITE", column::GYRO_WHITE),
    ("GYRO_FLICKER", column::GYRO_FLICKER),
    ("GYRO_WALK", column::GYRO_WALK),
];
