//! States what a unit of work costs in instructions, counted by hand in the kernels' source: the
//! numerator of every share of peak.
//!
//! One fused multiply-add, addition, multiplication, comparison, blend, shift or exclusive-or of a
//! full-width vector is one instruction; loads and stores are not counted, for they run alongside.
//! Divisions and roots count as one although they take several, so a share is if anything too
//! small.

use proofmass_kernel::cpu::lanes::LANES;
use proofmass_kernel::cpu::members::Members;
use proofmass_numerics::numerics::elementary::Real;

/// A Runge–Kutta step of the Duffing oscillator in displacement: 16 for four accelerations, 14 for
/// the stages.
pub(super) const DUFFING: f64 = 30.0;
/// A Runge–Kutta step of a Lorenz system: 24 for four rates of six, 9 for the stages, 12 for the
/// sum.
pub(super) const LORENZ: f64 = 45.0;
/// A step of orbit and tangent together, without fused multiply-adds: four rates of 7 and four
/// bends of 6, 6 for the force, 24 for the stages of four numbers, 24 for their sums, 2 for the
/// step.
pub(super) const LYAPUNOV: f64 = 108.0;

/// A proof mass in error coordinates by Runge–Kutta: four accelerations of 6, 8 for the stages, 7
/// for the sums, 1 for the force noise.
const PROOF_MASS: f64 = 40.0;
/// Reading and two integrations: a bias, and 3 for a rectangle and a trapezium.
const INTEGRATIONS: f64 = 4.0;
/// One normal number by Box and Muller, half a pair: 9 to take the first word apart, 10 for the
/// logarithm, 2 for the root; 6 to take the second apart, 10 for sine and cosine, 6 to choose the
/// quadrant; 2 to multiply.
const BOX_MULLER: f64 = 22.5;
/// Philox: ten rounds of two multiplications, two shifts and two exclusive-ors of three for four
/// numbers.
const PHILOX_WIDE: f64 = 15.0;
/// If a multiplication gives one half of its product: two more, no shifts, and two
/// additions for the key.
const PHILOX_NARROW: f64 = 25.0;

/// One normal number on the CPU: Philox in 64-bit lanes takes twice the instructions of f32 lanes.
pub fn normal<T: Real>() -> f64 {
    BOX_MULLER + PHILOX_WIDE * if size_of::<T>() == 4 { 2.0 } else { 1.0 }
}

/// An Euler–Maruyama step of three states: two multiply-adds and a normal number each.
pub(super) fn diffusion<T: Real>() -> f64 {
    3.0 * (2.0 + normal::<T>())
}

/// A sample of the full path on the CPU: a Runge–Kutta step under force noise, the reading, two
/// integrations.
pub fn full<T: Real>() -> f64 {
    PROOF_MASS + INTEGRATIONS + normal::<T>()
}

/// The same on a GPU, whose lanes are 32 bits wide for whole numbers too.
pub(super) const FULL_GPU: f64 = PROOF_MASS + INTEGRATIONS + BOX_MULLER + PHILOX_NARROW;

/// Bytes that a member-step of the full path moves to and from memory: parameters and state of a
/// member, once in and once out per tile. Within a tile they stay in the first-level cache.
pub(super) fn full_bytes<T: Real>(tile_samples: u64) -> f64 {
    2.0 * size_of::<Members<T>>() as f64 / LANES as f64 / tile_samples as f64
}
