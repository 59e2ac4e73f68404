//! 256 Euler–Maruyama steps of a stochastic equation with three states, du = a u dt + b u dW with
//! noises of their own: the size of problem on which solvers for GPUs publish their speed. Every
//! step draws three normal numbers.
//!
//! A yardstick; the tool itself solves no such equation.

use proofmass_base::parallel;
use proofmass_kernel::cpu::lanes::{Kernel, LANES, Lane, Level};
use proofmass_kernel::cpu::noise::Drawer;
use proofmass_numerics::numerics::elementary::{Real, fma};
use proofmass_numerics::rng::Stream;

pub(crate) const MEMBERS: usize = 32_768;
pub(crate) const STEPS: usize = 256;
const STEP: f64 = 1.0 / 256.0;
const DRIFT: f64 = 1.5;
const DIFFUSION: f64 = 0.1;
const START: f64 = 0.1;

/// One run on all threads; the mean of the first state at its end, over all trajectories.
pub fn run<T: Real>(level: Level) -> f64 {
    let one = |block: usize| level.run(Paths::<T>::new(Drawer::new(1, (block * LANES) as u64)));
    let sums: Vec<f64> = parallel::map_indices(MEMBERS / LANES, one);
    sums.iter().sum::<f64>() / MEMBERS as f64
}

struct Paths<T> {
    drawer: Drawer,
    states: [Lane<T>; 3],
}

impl<T: Real> Paths<T> {
    fn new(drawer: Drawer) -> Self {
        Self { drawer, states: [Lane::splat(T::of(START)); 3] }
    }
}

impl<T: Real> Kernel for Paths<T> {
    type Output = f64;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let mut u = self.states;
        let mut numbers = [Lane::splat(T::of(0.0)); 12];
        // Three counters give the twelve numbers of four steps.
        for four in 0..STEPS as u32 / 4 {
            self.drawer.fill::<T, FMA>(Stream::Force as u32, 3 * four, 4, &mut numbers);
            for number in numbers.chunks_exact(3) {
                for (u, number) in u.iter_mut().zip(number) {
                    step::<T, FMA>(u, number);
                }
            }
        }
        u[0].0.iter().map(|v| v.f64()).sum()
    }
}

#[inline(always)]
fn step<T: Real, const FMA: bool>(u: &mut Lane<T>, number: &Lane<T>) {
    let (drift, diffusion) = (T::of(DRIFT * STEP), T::of(DIFFUSION * STEP.sqrt()));
    for l in 0..LANES {
        u[l] = fma::<T, FMA>(u[l], fma::<T, FMA>(diffusion, number[l], drift), u[l]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_and_its_scatter_are_those_of_the_scheme() {
        // E u = u₀(1 + a h)ⁿ exactly; Var u = u₀²[((1 + a h)² + b² h)ⁿ − (1 + a h)²ⁿ].
        let (growth, n) = (1.0 + DRIFT * STEP, STEPS as i32);
        let mean = START * growth.powi(n);
        let square = growth * growth;
        let variance = START * START * ((square + DIFFUSION * DIFFUSION * STEP).powi(n) - square.powi(n));
        let error = (variance / MEMBERS as f64).sqrt();
        let found = run::<f64>(Level::best());
        assert!((found - mean).abs() < 4.0 * error, "{found} {mean} ± {error}");
    }
}
