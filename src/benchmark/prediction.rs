//! What the full path should reach on a card that is not at hand: its published multiply-add rate over the kernel's counted
//! instructions. A prediction from a roofline, never a measurement.

use super::operations::FULL_GPU;

/// A card, as its maker describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Card {
    /// Name.
    pub name: &'static str,
    /// f32 operations per second, a multiply-add counted as two.
    pub flops: f64,
    /// Where that is printed.
    pub source: &'static str,
}

/// Cards that a reader may have.
pub const CARDS: [Card; 3] = [
    Card { name: "NVIDIA V100 SXM2", flops: 15.7e12, source: "NVIDIA V100 datasheet" },
    Card { name: "NVIDIA GeForce RTX 4090", flops: 82.6e12, source: "NVIDIA Ada GPU architecture whitepaper" },
    Card { name: "NVIDIA H200 SXM", flops: 67.0e12, source: "NVIDIA H200 datasheet" },
];

/// Share of the issue bound at which a compute-bound kernel of this kind is expected: a guess, stated as such.
pub const EXPECTED_SHARE: f64 = 0.45;

impl Card {
    /// Member-steps per second of the full path if every instruction slot were used.
    pub fn bound_per_s(&self) -> f64 {
        0.5 * self.flops / FULL_GPU
    }
}
