//! States what the full path should reach on a card that is not at hand: its lanes times its boost
//! clock over the kernel's counted instructions, and the share of that which a card has reached.

use super::operations::FULL_GPU;

/// A card, as its maker describes it. Lanes and clock were compared with independent lists of
/// specifications, as the makers' own sheets were not at hand; the products are the 15.7, 82.6 and
/// 67 TFLOP/s that those sheets are quoted with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Card {
    /// Name of the card.
    pub name: &'static str,
    /// f32 lanes ("CUDA cores").
    pub lanes: u32,
    /// Boost clock, GHz.
    pub boost_ghz: f64,
}

/// Cards that a reader may have.
pub(crate) const CARDS: [Card; 2] = [
    Card { name: "NVIDIA V100 SXM2", lanes: 5120, boost_ghz: 1.53 },
    Card { name: "NVIDIA GeForce RTX 4090", lanes: 16_384, boost_ghz: 2.52 },
];

/// The card that the full path was measured on (Vulkan, driver 580.159.04).
const MEASURED: Card = Card { name: "NVIDIA H200 SXM", lanes: 16_896, boost_ghz: 1.98 };
/// Member-steps per second there in a run of 100,000 steps: reports/bench/summary.md.
const MEASURED_PER_S: f64 = 199.4e9;

/// Share of the issue bound that the measured card has reached.
pub(crate) fn reached() -> f64 {
    MEASURED_PER_S / MEASURED.bound_per_s()
}

impl Card {
    /// Instructions per second over all lanes.
    pub fn instructions_per_s(&self) -> f64 {
        1e9 * self.boost_ghz * f64::from(self.lanes)
    }

    /// f32 operations per second, a multiply-add counted as two.
    pub fn flops(&self) -> f64 {
        2.0 * self.instructions_per_s()
    }

    /// Member-steps per second of the full path if every instruction slot were used.
    pub fn bound_per_s(&self) -> f64 {
        self.instructions_per_s() / FULL_GPU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_and_clock_give_the_rates_that_are_quoted() {
        for (card, teraflops) in CARDS.iter().chain([&MEASURED]).zip([15.7, 82.6, 67.0]) {
            assert!((card.flops() / 1e12 - teraflops).abs() < 0.1, "{}: {}", card.name, card.flops());
        }
        assert!(0.5 < reached() && reached() < 1.0, "{}", reached());
    }
}
