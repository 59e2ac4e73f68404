//! The proof mass in error coordinates, for each integrator, and the reading it gives. Twin of
//! `shaders/shared/oscillator.wgsl`.
//!
//! The state is the error e = a − f of the reading a = ω₀²x, and q, the reading's rate times the
//! substep. Integrating the error, never the reading, keeps f32 good enough: a constant force of 1
//! g cancels exactly. Equation, with the substep as unit of time (see `member`): a″ + Ca′ + W(a +
//! γa³) = W(f + w), with w held. Further laws: `general`.

use super::lanes::{Kernel, LANES, Lane};
use super::low_pass::{LowPass, Moved};
use crate::force::Force;
use crate::member::{COEFFICIENTS, COLUMNS, column};
use crate::numerics::elementary::{Real, fma, sin_cos, sin_cos_turns};
use crate::physics::cubic_stiffness::{acceleration, tangent_stiffness};

/// A member's coefficients, as `member::coefficients` orders them.
pub(crate) type Coefficients<T> = [T; COEFFICIENTS];

/// A way of stepping; implemented by types without values, so that a kernel is compiled for each.
pub trait Oscillator<T: Real>: Send + Sync + 'static {
    /// Says whether there is a state at all.
    const MOVES: bool = true;
    /// (e, q) after one substep under force `f` and noise `w`, which Runge–Kutta takes times W.
    fn step<const FMA: bool>(k: &Coefficients<T>, e: T, q: T, f: &Force<T>, w: T) -> (T, T);
}

/// The reading follows the force at once.
pub(crate) struct Ideal;
/// The exact map of a linear proof mass.
pub(crate) struct ExactHold;
/// Runge–Kutta of order 4, linear and cubic spring.
pub(crate) struct RungeKutta4;
/// Exponential Runge–Kutta of order 2.
pub(crate) struct ExponentialRk2;
pub(crate) struct RosenbrockEuler;

impl<T: Real> Oscillator<T> for Ideal {
    const MOVES: bool = false;
    #[inline(always)]
    fn step<const FMA: bool>(_: &Coefficients<T>, e: T, q: T, _: &Force<T>, _: T) -> (T, T) {
        (e, q)
    }
}

/// The linear map: with a force that grows by f.to_end, the error tends to w − (C/W)·growth.
#[inline(always)]
fn relax<T: Real, const FMA: bool>(k: &Coefficients<T>, u: T, r: T) -> (T, T) {
    (fma::<T, FMA>(k[0], u, k[1] * r), fma::<T, FMA>(k[2], u, k[3] * r))
}

impl<T: Real> Oscillator<T> for ExactHold {
    #[inline(always)]
    fn step<const FMA: bool>(k: &Coefficients<T>, e: T, q: T, f: &Force<T>, w: T) -> (T, T) {
        let rest = fma::<T, FMA>(-k[4], f.to_end, w);
        let (u, r) = relax::<T, FMA>(k, e - rest, q - f.to_end);
        (u + rest, r + f.to_end)
    }
}

/// Classic Runge–Kutta on (a, q), written for e = a − f: algebraically the same, without the large
/// parts. As q₂ = q + d₁/2, q₃ = q + d₂/2 and q₄ = q + d₃, the weighted sum of rates is 6q + d₁ +
/// d₂ + d₃.
#[inline(always)]
fn runge_kutta<T: Real, const FMA: bool>(e: T, q: T, f: &Force<T>, acceleration: impl Fn(T, T, T) -> T) -> (T, T) {
    let (half, sixth) = (T::of(0.5), T::of(1.0 / 6.0));
    let (middle, end) = (e - f.to_middle, e - f.to_end);
    let d1 = acceleration(e, e + f.begin, q);
    let e2 = fma::<T, FMA>(half, q, middle);
    let q2 = fma::<T, FMA>(half, d1, q);
    let d2 = acceleration(e2, e2 + f.middle, q2);
    let e3 = fma::<T, FMA>(half, q2, middle);
    let q3 = fma::<T, FMA>(half, d2, q);
    let d3 = acceleration(e3, e3 + f.middle, q3);
    let (e4, q4) = (end + q3, q + d3);
    let d4 = acceleration(e4, e4 + f.end, q4);
    let twice = d2 + d3;
    let once = d1 + twice;
    (fma::<T, FMA>(sixth, once, end + q), fma::<T, FMA>(sixth, once + twice + d4, q))
}

impl<T: Real> Oscillator<T> for RungeKutta4 {
    #[inline(always)]
    fn step<const FMA: bool>(k: &Coefficients<T>, e: T, q: T, f: &Force<T>, w: T) -> (T, T) {
        runge_kutta::<T, FMA>(e, q, f, |e, a, q| {
            let spring = acceleration::<T, FMA>(k[2], a, fma::<T, FMA>(-k[0], e, w));
            fma::<T, FMA>(-k[1], q, spring)
        })
    }
}

impl<T: Real> Oscillator<T> for ExponentialRk2 {
    #[inline(always)]
    fn step<const FMA: bool>(k: &Coefficients<T>, e: T, q: T, f: &Force<T>, w: T) -> (T, T) {
        let bend = |a: T, less: T| -acceleration::<T, FMA>(k[5], a, less);
        let rest = fma::<T, FMA>(-k[4], f.to_end, w);
        // The cubic force held at its first value moves the point of rest by −γa³.
        let bent = bend(e + f.begin, T::of(0.0));
        let (u, r) = relax::<T, FMA>(k, e - rest + bent, q - f.to_end);
        let first = u - bent + rest;
        // Then its growth over the step is put right.
        let growth = bend(first + f.end, bent);
        (fma::<T, FMA>(-k[6], growth, first), fma::<T, FMA>(-k[7], growth, r + f.to_end))
    }
}

impl<T: Real> Oscillator<T> for RosenbrockEuler {
    #[inline(always)]
    fn step<const FMA: bool>(k: &Coefficients<T>, e: T, q: T, f: &Force<T>, w: T) -> (T, T) {
        let (w0, c, half_c) = (k[0], k[1], T::of(0.5) * k[1]);
        let a = e + f.begin;
        // In units of ω₀².
        let slope = tangent_stiffness(k[2], a);
        // Tangent stiffness; with a hardening spring it is positive.
        let stiff = fma::<T, FMA>(w0, slope, w0);
        let r = q - f.to_end;
        // Newton's distance to rest, z = J⁻¹F, and what the force's growth adds.
        let pull = fma::<T, FMA>(w0, -acceleration::<T, FMA>(k[2], a, w - e), c * q);
        let share = T::of(1.0) / stiff;
        let g = slope * f.to_end * (w0 * share);
        let y1 = (pull - c * (r + g)) * share;
        let y2 = r + g;
        // exp(J) in closed form.
        let frequency = fma::<T, FMA>(-half_c, half_c, stiff).max(T::of(1e-12)).sqrt();
        let (sin, cos) = sin_cos::<T, FMA>(frequency);
        let odd = k[3] * (sin / frequency);
        let even = k[3] * cos;
        let ey1 = fma::<T, FMA>(even + half_c * odd, y1, odd * y2);
        let ey2 = fma::<T, FMA>(-stiff * odd, y1, (even - half_c * odd) * y2);
        (e - g + (ey1 - y1), r + (ey2 - y2) + f.to_end)
    }
}

/// The proof masses of 64 members over consecutive samples.
pub(super) struct ProofMasses<'a, T> {
    pub k: &'a [Lane<T>; COLUMNS],
    pub e: &'a mut Lane<T>,
    pub q: &'a mut Lane<T>,
    /// The shared force over the substeps of these samples.
    pub force: &'a [Force<T>],
    pub substeps: usize,
    /// Normal numbers of the force noise, one a sample, if there is any.
    pub push: Option<&'a [Lane<T>]>,
    /// Says whether some member feels the shared force by a gain of its own.
    pub gain: bool,
    /// Phases of the members' own sines and the first half substep's number, if there are any.
    pub sine: Option<(&'a [Lane<u32>; 2], u64)>,
    /// The low-pass behind them, if some member has one.
    pub low_pass: Option<&'a mut LowPass<T>>,
    /// Says whether some member has a scale error or a second-order one.
    pub scaled: bool,
    /// Receives the error of each reading: the proof mass's, the bias and the scale's.
    pub error: &'a mut [Lane<T>],
    /// Receives the specific force felt at the end of each sample.
    pub felt: &'a mut [Lane<T>],
}

/// [`ProofMasses`] by one way of stepping.
pub(super) struct Step<'a, T, O>(pub O, pub ProofMasses<'a, T>);

impl<T: Real, O: Oscillator<T>> Kernel for Step<'_, T, O> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let m = self.1;
        let zero = Lane::splat(T::of(0.0));
        let (mut e, mut q) = (*m.e, *m.q);
        // Loops of their own: with the choice inside one, the state goes through memory
        // (Runge-Kutta a fifth slower, the exact map a third).
        let samples = m.error.iter_mut().zip(m.felt).zip(m.force.chunks_exact(m.substeps)).enumerate();
        if let Some(low_pass) = m.low_pass {
            let mut half = m.sine.map_or(0, |(_, half)| half);
            let (mut growth, mut noise) = (zero, zero);
            for (i, ((error, felt), steps)) in samples {
                let push = m.push.map_or(&zero, |p| &p[i]);
                for l in 0..LANES {
                    noise[l] = m.k[column::FORCE][l] * push[l];
                }
                for f in steps {
                    let sine = m.sine.map_or([zero; 3], |(turns, _)| sines::<T, FMA>(m.k, turns, half));
                    half += 2;
                    let from = [e, q];
                    pushed_each::<T, O, FMA>(m.k, f, &sine, push, &mut e, &mut q, felt);
                    for l in 0..LANES {
                        growth[l] = fma::<T, FMA>(m.k[column::GAIN][l], f.to_end, sine[2][l] - sine[0][l]);
                    }
                    let [e0, q0] = &from;
                    low_pass.step::<FMA>(&Moved { from: [e0, q0], to: [&e, &q], growth: &growth, push: &noise });
                }
                read::<T, FMA>(m.k, &low_pass.p, felt, m.scaled, error);
            }
        } else if m.gain || m.sine.is_some() {
            let mut half = m.sine.map_or(0, |(_, half)| half);
            for (i, ((error, felt), steps)) in samples {
                let push = m.push.map_or(&zero, |p| &p[i]);
                for f in steps {
                    let sine = m.sine.map_or([zero; 3], |(turns, _)| sines::<T, FMA>(m.k, turns, half));
                    half += 2;
                    pushed_each::<T, O, FMA>(m.k, f, &sine, push, &mut e, &mut q, felt);
                }
                read::<T, FMA>(m.k, &e, felt, m.scaled, error);
            }
        } else {
            for (i, ((error, felt), steps)) in samples {
                let push = m.push.map_or(&zero, |p| &p[i]);
                for f in steps {
                    if O::MOVES {
                        pushed_alike::<T, O, FMA>(m.k, f, push, &mut e, &mut q);
                    }
                    *felt = Lane::splat(f.end);
                }
                read::<T, FMA>(m.k, &e, felt, m.scaled, error);
            }
        }
        (*m.e, *m.q) = (e, q);
    }
}

/// The members' own sines at the beginning, the middle and the end of a substep.
#[inline(always)]
pub(super) fn sines<T: Real, const FMA: bool>(
    k: &[Lane<T>; COLUMNS],
    turns: &[Lane<u32>; 2],
    half: u64,
) -> [Lane<T>; 3] {
    let mut out = [Lane::splat(T::of(0.0)); 3];
    for (i, out) in out.iter_mut().enumerate() {
        for l in 0..LANES {
            let turns = turns[0][l].wrapping_add((half as u32).wrapping_add(i as u32).wrapping_mul(turns[1][l]));
            out[l] = k[column::SINE][l] * sin_cos_turns::<T, FMA>(turns).0;
        }
    }
    out
}

#[inline(always)]
fn pushed_alike<T: Real, O: Oscillator<T>, const FMA: bool>(
    k: &[Lane<T>; COLUMNS],
    f: &Force<T>,
    push: &Lane<T>,
    e: &mut Lane<T>,
    q: &mut Lane<T>,
) {
    for l in 0..LANES {
        (e[l], q[l]) = O::step::<FMA>(&coefficients(k, l), e[l], q[l], f, k[column::FORCE][l] * push[l]);
    }
}

#[inline(always)]
fn pushed_each<T: Real, O: Oscillator<T>, const FMA: bool>(
    k: &[Lane<T>; COLUMNS],
    f: &Force<T>,
    sine: &[Lane<T>; 3],
    push: &Lane<T>,
    e: &mut Lane<T>,
    q: &mut Lane<T>,
    felt: &mut Lane<T>,
) {
    for l in 0..LANES {
        let gain = k[column::GAIN][l];
        let [begin, middle, end] = [sine[0][l], sine[1][l], sine[2][l]];
        let own = Force {
            begin: fma::<T, FMA>(gain, f.begin, begin),
            middle: fma::<T, FMA>(gain, f.middle, middle),
            end: fma::<T, FMA>(gain, f.end, end),
            to_middle: fma::<T, FMA>(gain, f.to_middle, middle - begin),
            to_end: fma::<T, FMA>(gain, f.to_end, end - begin),
        };
        (e[l], q[l]) = O::step::<FMA>(&coefficients(k, l), e[l], q[l], &own, k[column::FORCE][l] * push[l]);
        felt[l] = own.end;
    }
}

/// The reading's error: the proof mass's or its low-pass's, the bias, and the scale's on what that
/// shows.
#[inline(always)]
pub(super) fn read<T: Real, const FMA: bool>(
    k: &[Lane<T>; COLUMNS],
    e: &Lane<T>,
    felt: &Lane<T>,
    scaled: bool,
    error: &mut Lane<T>,
) {
    for l in 0..LANES {
        error[l] = e[l] + k[column::BIAS][l];
    }
    if scaled {
        for l in 0..LANES {
            let a = felt[l] + e[l];
            let bend = fma::<T, FMA>(k[column::K3][l], a, k[column::K2][l]);
            error[l] = fma::<T, FMA>(fma::<T, FMA>(bend, a, k[column::SCALE][l]), a, error[l]);
        }
    }
}

#[inline(always)]
fn coefficients<T: Real>(k: &[Lane<T>; COLUMNS], l: usize) -> Coefficients<T> {
    std::array::from_fn(|c| k[c][l])
}
