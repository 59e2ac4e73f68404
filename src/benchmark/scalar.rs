//! States what one writes first: a loop over members on all threads, a loop over steps inside, a
//! normal number from a library. The yardstick for lanes, not part of the tool's path.

use rand::rand_core::UnwrapErr;
use rand_distr::{Distribution, StandardNormal};

use super::duffing::{MEMBERS, STEP_S, STEPS};
use proofmass_base::parallel;
use proofmass_base::units::MICRO_G;
use proofmass_numerics::rng::{Philox, Stream};

/// The noisy work unit for the first `members` oscillators; the sum of final displacements, m.
pub fn duffing(members: usize) -> f64 {
    let tau = std::f64::consts::TAU;
    let force: Vec<f64> = (0..=2 * STEPS)
        .map(|k| 0.5 * STEP_S * k as f64)
        .map(|t| 7.0 * (tau * 1.3 * t).sin() + 3.0 * (tau * 7.1 * t).cos())
        .collect();
    let ends = parallel::map_indices(members, |i| {
        let s = i as f64 / MEMBERS as f64;
        let w = tau * (30.0 + 5.0 * s);
        let (damping, stiffness, cubic) = (w / (0.7 + s), w * w, 0.05 * 10.0 / (10.0 / (w * w)).powi(3));
        let sigma = 60.0 * MICRO_G * (0.5 / STEP_S).sqrt() * (0.9 + 0.2 * s);
        let mut random = UnwrapErr(Philox::new(1, i as u64, Stream::Force));
        let rate = |x: f64, v: f64, f: f64| f - damping * v - x * (stiffness + cubic * x * x);
        let (mut x, mut v, h) = (0.0, 0.0, STEP_S);
        for f in force.windows(3).step_by(2) {
            let number: f64 = StandardNormal.sample(&mut random);
            let push = sigma * number;
            let a1 = rate(x, v, f[0] + push);
            let (x2, v2) = (x + 0.5 * h * v, v + 0.5 * h * a1);
            let a2 = rate(x2, v2, f[1] + push);
            let (x3, v3) = (x + 0.5 * h * v2, v + 0.5 * h * a2);
            let a3 = rate(x3, v3, f[1] + push);
            let (x4, v4) = (x + h * v3, v + h * a3);
            let a4 = rate(x4, v4, f[2] + push);
            x += h / 6.0 * (v + 2.0 * (v2 + v3) + v4);
            v += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
        }
        x
    });
    ends.iter().sum()
}
