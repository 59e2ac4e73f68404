//! The most multiply-adds per second that this machine can do, measured: what a kernel's speed is a
//! share of.

use std::hint::black_box;

use proofmass_base::parallel;
use proofmass_kernel::cpu::lanes::{Kernel, LANES, Lane, Level};
use proofmass_numerics::numerics::elementary::{Real, fma};

/// Multiply-adds per number and call.
const LENGTH: usize = 100_000;

/// `N` × 64 independent chains, to be kept in registers.
struct Chains<T, const N: usize>(T);

impl<T: Real, const N: usize> Kernel for Chains<T, N> {
    type Output = f64;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let (factor, term) = (self.0, T::of(1e-9));
        let mut chains = [Lane::splat(T::of(1.0)); N];
        for _ in 0..LENGTH {
            for chain in &mut chains {
                for l in 0..LANES {
                    chain[l] = fma::<T, FMA>(chain[l], factor, term);
                }
            }
        }
        chains.iter().flat_map(|chain| chain.0).map(Real::f64).sum()
    }
}

/// Runs `N` × 64 chains on every thread; returns the multiply-adds done, for a clock to divide.
///
/// Which `N` fills the registers without spilling depends on the machine: take the best of 1, 2
/// and 3.
pub(crate) fn multiply_adds<T: Real, const N: usize>() -> f64 {
    let threads = parallel::threads();
    let one = |_| Level::best().run(Chains::<T, N>(black_box(T::of(0.999_999))));
    let sums: Vec<f64> = parallel::map_indices(threads, one);
    black_box(sums);
    (threads * LENGTH * N * LANES) as f64
}
