//! The base model: a linear oscillator read with a gain and an offset. The order of its parameters
//! and how far they reach.

/// Base parameters: gain, ω₀, ζ, offset, displacement and velocity at the beginning.
pub const BASE: usize = 6;
/// Index of the gain.
pub const GAIN: usize = 0;
/// Place of ω₀, rad/s, in the parameter vector.
pub const OMEGA: usize = 1;
/// Place of ζ in the parameter vector.
pub const ZETA: usize = 2;
/// Index of the offset.
pub const OFFSET: usize = 3;
/// Index of the displacement at the beginning; its velocity follows.
pub const INITIAL: usize = 4;
/// Parameters that each further recording of the same sensor brings with it: an offset, and the
/// displacement and velocity at its beginning, in this order after the base parameters.
pub(super) const PER_RECORDING: usize = 3;
/// Natural frequencies that a fit can reach, rad per sample.
pub(super) const OMEGAS_PER_SAMPLE: [f64; 2] = [1e-4, 20.0];
/// Damping ratios that a fit can reach.
pub(super) const ZETAS: [f64; 2] = [1e-5, 30.0];
