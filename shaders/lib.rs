//! Texts of the WGSL shaders in this folder, so that a package that runs them has them wherever it is
//! built. Not for assembling them: that is the kernel crate's.

/// A check of the device: what sums keep of a small number next to a large one.
pub const COMPENSATION: &str = include_str!("compensation.wgsl");
/// Largest Lyapunov exponents.
pub const LYAPUNOV: &str = include_str!("lyapunov.wgsl");
/// Navigation in six axes, a tile of members.
pub const NAVIGATE: &str = include_str!("navigate.wgsl");
/// Nothing but multiply-adds: the peak of the device.
pub const PEAK: &str = include_str!("peak.wgsl");
/// Orbits strobed once a period.
pub const POINCARE: &str = include_str!("poincare.wgsl");
/// Partial sums over the members of a workgroup.
pub const REDUCE: &str = include_str!("reduce.wgsl");
/// The ensemble, a tile of members. Lines that begin with `#` are expanded by the kernel crate.
pub const SIMULATE: &str = include_str!("simulate.wgsl");

/// Parts that several shaders have in common.
pub mod shared {
    /// Sums longer than f32.
    pub const ACCUMULATE: &str = include_str!("shared/accumulate.wgsl");
    /// Elementary functions.
    pub const ELEMENTARY: &str = include_str!("shared/elementary.wgsl");
    /// A fix of position applied to one member.
    pub const FIX: &str = include_str!("shared/fix.wgsl");
    /// Structures that host and device share.
    pub const LAYOUT: &str = include_str!("shared/layout.wgsl");
    /// Forced Duffing oscillators.
    pub const ORBIT: &str = include_str!("shared/orbit.wgsl");
    /// One substep of the proof mass.
    pub const OSCILLATOR: &str = include_str!("shared/oscillator.wgsl");
    /// Random numbers by Philox4x32-10.
    pub const PHILOX: &str = include_str!("shared/philox.wgsl");
    /// A wide product where the device has no integers of 64 bits.
    pub const PHILOX_MULTIPLY_16: &str = include_str!("shared/philox_multiply_16.wgsl");
    /// A wide product with integers of 64 bits.
    pub const PHILOX_MULTIPLY_64: &str = include_str!("shared/philox_multiply_64.wgsl");
}
