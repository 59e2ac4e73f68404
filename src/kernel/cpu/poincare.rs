//! CPU twin of `poincare.wgsl`: forced Duffing oscillators strobed once per forcing period, 64
//! lanes at a time.

#![allow(clippy::needless_range_loop, reason = "one index over many arrays is the form that vectorises")]

use super::lanes::LANES;
use crate::numerics::elementary::Real;
use crate::orbit::{LOST_M, Plan, Point};
use crate::physics::cubic_stiffness::pull;
use crate::rng::{Stream, philox4x32_10};

/// Parameters and state of one block of lanes.
#[derive(Debug, Clone)]
pub struct Block<T> {
    /// Damping of each lane, 1/s.
    pub damping: [T; LANES],
    /// Linear stiffness of each lane, 1/s².
    pub stiffness: [T; LANES],
    /// Cubic stiffness of each lane, 1/(m² s²).
    pub cubic: [T; LANES],
    /// Amplitude of the drive of each lane, m/s².
    pub amplitude: [T; LANES],
    /// Step of each lane, s.
    pub h: [T; LANES],
    /// Displacement of each lane, m.
    pub x: [T; LANES],
    /// Velocity of each lane, m/s.
    pub v: [T; LANES],
    /// Lanes whose orbit has left the bounds.
    pub lost: [bool; LANES],
    /// Deviation of the force noise held over a step; `None` where no lane has any.
    sigma: Option<[T; LANES]>,
    first_member: u64,
}

impl<T: Real> Block<T> {
    /// Loads up to 64 points; spare lanes repeat the last one. `first` is the number of the block's
    /// first point.
    pub fn load(points: &[Point], plan: &Plan, first: u64) -> Self {
        let at = |l: usize| &points[l.min(points.len().saturating_sub(1))];
        let step_s = |p: &Point| 2.0 * std::f64::consts::PI / (p.omega_rad_s * f64::from(plan.steps_per_period));
        let lanes = |f: &dyn Fn(&Point) -> f64| -> [T; LANES] { std::array::from_fn(|l| T::of(f(at(l)))) };
        let noisy = points.iter().any(|p| p.noise_m_s2_rts > 0.0);
        Self {
            damping: lanes(&|p| p.damping_per_s),
            stiffness: lanes(&|p| p.stiffness_per_s2),
            cubic: lanes(&|p| p.cubic_per_m2_s2),
            amplitude: lanes(&|p| p.amplitude_m_s2),
            h: lanes(&step_s),
            x: lanes(&|p| p.x_m),
            v: lanes(&|p| p.v_m_s),
            lost: [false; LANES],
            sigma: noisy.then(|| lanes(&|p| p.noise_m_s2_rts / step_s(p).sqrt())),
            first_member: plan.first_member + first,
        }
    }
}

/// Runs `plan.strobes` periods from where the block stands; `out` receives the lanes' states after
/// each.
#[inline(always)]
pub fn strobes<T: Real>(
    block: &mut Block<T>,
    plan: &Plan,
    table: &[T],
    begin_period: u32,
    out: &mut Vec<[[f32; 2]; LANES]>,
) {
    for strobe in 0..plan.strobes {
        for j in 0..plan.steps_per_period as usize {
            let noise = noise(block, plan, begin_period + strobe, j);
            step(block, [table[2 * j], table[2 * j + 1], table[2 * j + 2]], &noise);
        }
        lose(block);
        out.push(std::array::from_fn(|l| [block.x[l].f64() as f32, block.v[l].f64() as f32]));
    }
}

/// One Runge–Kutta step of all lanes. `cosine` is cos ωt at the step's beginning, middle and end.
#[inline(always)]
pub fn step<T: Real>(block: &mut Block<T>, cosine: [T; 3], noise: &[T; LANES]) {
    let (half, two, sixth) = (T::of(0.5), T::of(2.0), T::of(1.0 / 6.0));
    for l in 0..LANES {
        let (d, k, b, h) = (block.damping[l], block.stiffness[l], block.cubic[l], block.h[l]);
        let force = |c: T| block.amplitude[l] * c + noise[l];
        let rate = |x: T, v: T, f: T| f - d * v - pull(k, b, x);
        let (x, v, hh) = (block.x[l], block.v[l], half * h);
        let a1 = rate(x, v, force(cosine[0]));
        let (x2, v2) = (x + hh * v, v + hh * a1);
        let a2 = rate(x2, v2, force(cosine[1]));
        let (x3, v3) = (x + hh * v2, v + hh * a2);
        let a3 = rate(x3, v3, force(cosine[1]));
        let (x4, v4) = (x + h * v3, v + h * a3);
        let a4 = rate(x4, v4, force(cosine[2]));
        let w = h * sixth;
        block.x[l] = x + w * (v + two * (v2 + v3) + v4);
        block.v[l] = v + w * (a1 + two * (a2 + a3) + a4);
    }
}

/// The force noise of all lanes over one step; zero where there is none.
///
/// Sum of the eight 16-bit halves of one Philox block, each uniform: an Irwin–Hall deviate, whose
/// moments up to the third are the normal ones. A force held over one of some hundred steps per
/// period acts only through sums of many steps, so its own tails are never seen.
#[inline(always)]
pub fn noise<T: Real>(block: &Block<T>, plan: &Plan, period: u32, j: usize) -> [T; LANES] {
    let Some(sigma) = &block.sigma else { return [T::of(0.0); LANES] };
    let count = period.wrapping_mul(plan.steps_per_period).wrapping_add(j as u32);
    let key = [plan.seed as u32, (plan.seed >> 32) as u32];
    // Halves of 16 bits: their sum is exact in u32, and the same on host and device.
    std::array::from_fn(|l| {
        let member = block.first_member + l as u64;
        let words = philox4x32_10([count, member as u32, (member >> 32) as u32, Stream::Force as u32], key);
        let total: u32 = words.iter().map(|w| (w >> 16) + (w & 0xFFFF)).sum();
        // Eight uniforms on [0, 65535]: mean 4 × 65535, variance 8 (2³² − 1)/12.
        let centred = f64::from(total) - 4.0 * 65535.0;
        sigma[l] * (T::of(centred) * T::of(1.868_812_365e-5))
    })
}

/// Marks lanes that left every bound and brings them back to rest, so that they cost nothing and
/// poison nothing.
#[inline(always)]
pub fn lose<T: Real>(block: &mut Block<T>) {
    for l in 0..LANES {
        let x = block.x[l].f64();
        if x.is_nan() || x.abs() > LOST_M {
            block.lost[l] = true;
            block.x[l] = T::of(0.0);
            block.v[l] = T::of(0.0);
        }
    }
}
