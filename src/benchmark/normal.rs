//! Normal numbers alone, as many as the noisy Duffing unit needs: the generator's part of an
//! ensemble's time.

use super::duffing::{MEMBERS, STEPS};
use proofmass_base::parallel;
use proofmass_kernel::cpu::lanes::{LANES, Lane, Level};
use proofmass_kernel::cpu::noise::{Draw, Drawer};
use proofmass_numerics::numerics::elementary::Real;
use proofmass_numerics::rng::Stream;

/// Numbers drawn at a time, as the ensemble's own kernel does.
const STRETCH: usize = 16;

/// One run on all threads; the sum of the first member's last numbers of every block.
pub fn run<T: Real>(level: Level) -> f64 {
    let one = |block: usize| {
        let drawer = Drawer::new(1, (block * LANES) as u64);
        let mut numbers = [Lane::splat(T::of(0.0)); STRETCH];
        for i in 0..STEPS / STRETCH {
            let counter = (i * STRETCH / 4) as u32;
            level.run(Draw { drawer, stream: Stream::Force as u32, counter, each: 4, out: &mut numbers });
        }
        numbers[STRETCH - 1][0].f64()
    };
    parallel::map_indices(MEMBERS / LANES, one).iter().sum()
}
