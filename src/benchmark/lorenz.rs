//! 1000 Runge–Kutta steps of Lorenz systems, the setting in which solvers for GPUs publish their
//! speed: σ = 10, β = 8/3, ρ from 0 to 21, one ρ per system, steps of 0.01.
//!
//! A yardstick; the tool itself solves no Lorenz system.

use proofmass_base::parallel;
use proofmass_kernel::cpu::lanes::{Kernel, LANES, Lane, Level};
use proofmass_numerics::numerics::elementary::{Real, fma};

pub(crate) const MEMBERS: usize = 16_384;
pub(crate) const STEPS: usize = 1000;
const STEP: f64 = 0.01;
const SIGMA: f64 = 10.0;
const BETA: f64 = 8.0 / 3.0;

/// States where all systems begin.
const START: [f64; 3] = [10.0, 10.0, 10.0];

/// ρ of a system.
fn rho(member: usize) -> f64 {
    21.0 * member as f64 / MEMBERS as f64
}

/// One run on all threads; states of the first system at its end.
pub fn run<T: Real>(level: Level) -> [f64; 3] {
    let one = |block: usize| {
        let mut rho_lanes = Lane::splat(T::of(0.0));
        for l in 0..LANES {
            rho_lanes[l] = T::of(rho(block * LANES + l));
        }
        level.run(Systems { rho: rho_lanes, steps: STEPS })
    };
    let ends: Vec<[f64; 3]> = parallel::map_indices(MEMBERS / LANES, one);
    ends[0]
}

struct Systems<T> {
    rho: Lane<T>,
    steps: usize,
}

impl<T: Real> Kernel for Systems<T> {
    type Output = [f64; 3];
    #[inline(always)]
    fn run<const FMA: bool>(self) -> [f64; 3] {
        let mut u = START.map(|s| Lane::splat(T::of(s)));
        for _ in 0..self.steps {
            step::<T, FMA>(&self.rho, &mut u);
        }
        [u[0][0].f64(), u[1][0].f64(), u[2][0].f64()]
    }
}

#[inline(always)]
fn rate<T: Real, const FMA: bool>(rho: T, u: [T; 3]) -> [T; 3] {
    let [x, y, z] = u;
    [T::of(SIGMA) * (y - x), fma::<T, FMA>(x, rho - z, -y), fma::<T, FMA>(x, y, -(T::of(BETA) * z))]
}

#[inline(always)]
fn step<T: Real, const FMA: bool>(rho: &Lane<T>, u: &mut [Lane<T>; 3]) {
    let (h, half, sixth, two) = (T::of(STEP), T::of(0.5 * STEP), T::of(STEP / 6.0), T::of(2.0));
    for l in 0..LANES {
        let at = [u[0][l], u[1][l], u[2][l]];
        let ahead = |k: [T; 3], h: T| -> [T; 3] { std::array::from_fn(|i| fma::<T, FMA>(h, k[i], at[i])) };
        let k1 = rate::<T, FMA>(rho[l], at);
        let k2 = rate::<T, FMA>(rho[l], ahead(k1, half));
        let k3 = rate::<T, FMA>(rho[l], ahead(k2, half));
        let k4 = rate::<T, FMA>(rho[l], ahead(k3, h));
        for i in 0..3 {
            u[i][l] = fma::<T, FMA>(sixth, fma::<T, FMA>(two, k2[i] + k3[i], k1[i] + k4[i]), at[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_below_the_bifurcation_comes_to_rest_where_it_must() {
        // Below ρ = 1 the origin attracts; above, C± = (±√(β(ρ−1)), ±√(β(ρ−1)), ρ−1) (Lorenz, J.
        // Atmos. Sci. 20, 1963).
        let end = |rho: f64| Level::best().run(Systems { rho: Lane::splat(rho), steps: 5000 });
        assert!(end(0.5).iter().all(|v| v.abs() < 1e-9));
        let [x, y, z] = end(10.0);
        let side = (BETA * 9.0).sqrt();
        assert!((x.abs() - side).abs() < 1e-9 && (x - y).abs() < 1e-9 && (z - 9.0).abs() < 1e-9, "{x} {y} {z}");
    }
}
