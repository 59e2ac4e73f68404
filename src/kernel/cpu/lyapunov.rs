//! CPU twin of `lyapunov.wgsl`: the largest Lyapunov exponent of forced Duffing oscillators, 64
//! lanes at a time.
//!
//! Each lane carries its orbit and one tangent vector through the same Runge–Kutta step; once per
//! forcing period the tangent is shortened to one and the logarithm of what it had grown by is
//! summed (Benettin et al., Meccanica 15, 1980). Generic over f32 (the shader's twin) and f64 (the
//! oracle). No fused multiply-add: results do not depend on the host.

#![allow(clippy::needless_range_loop, reason = "one index over many arrays is the form that vectorises")]

use super::lanes::LANES;
use super::poincare::{Block, lose, noise, step};
use crate::numerics::elementary::Real;
use crate::orbit::{ALIGN_PERIODS, Plan};
use crate::physics::cubic_stiffness::{pull, tangent_stiffness};

/// Exponents of the block's lanes, 1/s, and the block carried to the end of the averaging.
#[inline(always)]
pub fn exponents<T: Real>(block: &mut Block<T>, plan: &Plan, table: &[T]) -> [f64; LANES] {
    let mut sum = [0.0f64; LANES];
    let mut tangent = ([T::of(1.0); LANES], [T::of(0.0); LANES]);
    for period in 0..plan.transient_periods {
        for j in 0..plan.steps_per_period as usize {
            let noise = noise(block, plan, period, j);
            step(block, [table[2 * j], table[2 * j + 1], table[2 * j + 2]], &noise);
        }
    }
    for period in 0..ALIGN_PERIODS + plan.periods {
        for j in 0..plan.steps_per_period as usize {
            let noise = noise(block, plan, plan.transient_periods + period, j);
            both(block, &mut tangent, [table[2 * j], table[2 * j + 1], table[2 * j + 2]], &noise);
        }
        for l in 0..LANES {
            let (x, v) = (tangent.0[l].f64(), tangent.1[l].f64());
            let length = x.hypot(v);
            if period >= ALIGN_PERIODS {
                sum[l] += length.ln();
            }
            tangent.0[l] = T::of(x / length);
            tangent.1[l] = T::of(v / length);
        }
        lose(block);
    }
    let span = f64::from(plan.periods) * f64::from(plan.steps_per_period);
    std::array::from_fn(|l| if block.lost[l] { f64::NAN } else { sum[l] / (span * block.h[l].f64()) })
}

/// One Runge–Kutta step of orbit and tangent together.
#[inline(always)]
fn both<T: Real>(block: &mut Block<T>, tangent: &mut ([T; LANES], [T; LANES]), cosine: [T; 3], noise: &[T; LANES]) {
    let (half, two, sixth) = (T::of(0.5), T::of(2.0), T::of(1.0 / 6.0));
    for l in 0..LANES {
        let (d, k, b, h) = (block.damping[l], block.stiffness[l], block.cubic[l], block.h[l]);
        let force = |c: T| block.amplitude[l] * c + noise[l];
        let rate = |x: T, v: T, f: T| f - d * v - pull(k, b, x);
        let bend = |x: T, tx: T, tv: T| T::of(0.0) - d * tv - (k + tangent_stiffness(b, x)) * tx;
        let (x, v, tx, tv) = (block.x[l], block.v[l], tangent.0[l], tangent.1[l]);
        let hh = half * h;

        let (a1, s1) = (rate(x, v, force(cosine[0])), bend(x, tx, tv));
        let (x2, v2, tx2, tv2) = (x + hh * v, v + hh * a1, tx + hh * tv, tv + hh * s1);
        let (a2, s2) = (rate(x2, v2, force(cosine[1])), bend(x2, tx2, tv2));
        let (x3, v3, tx3, tv3) = (x + hh * v2, v + hh * a2, tx + hh * tv2, tv + hh * s2);
        let (a3, s3) = (rate(x3, v3, force(cosine[1])), bend(x3, tx3, tv3));
        let (x4, v4, tx4, tv4) = (x + h * v3, v + h * a3, tx + h * tv3, tv + h * s3);
        let (a4, s4) = (rate(x4, v4, force(cosine[2])), bend(x4, tx4, tv4));

        let w = h * sixth;
        block.x[l] = x + w * (v + two * (v2 + v3) + v4);
        block.v[l] = v + w * (a1 + two * (a2 + a3) + a4);
        tangent.0[l] = tx + w * (tv + two * (tv2 + tv3) + tv4);
        tangent.1[l] = tv + w * (s1 + two * (s2 + s3) + s4);
    }
}
