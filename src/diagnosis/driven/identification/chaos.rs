//! Decides whether a response is chaotic: finds a restoring force without any simulation, and
//! follows how a small difference grows along the recorded motion under it.
//!
//! Multiplied by a smooth weight that vanishes at both ends and integrated by parts, the equation
//! of motion holds for the readings themselves, without derivatives of noise (the weak form:
//! Messenger & Bortz, J. Comput. Phys. 443, 2021). With a force of third degree it is linear in its
//! coefficients. The growth is that of the variational equation (Benettin et al., Meccanica 15,
//! 1980). Not for numbers of the verdict but the exponent and the horizon.

use crate::driven::base::{BASE, GAIN, OFFSET, OMEGA, ZETA};
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Input;
use crate::driven::intake::reading_noise::{Sample, reading_noise};
use crate::driven::intake::stretches::{Stretches, merged, minus};
use crate::driven::intake::windows::{Course, Force as ForceAtRest, Windows};
use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean_sd;

/// Part of the weighted equation that a force of third degree must explain to be believed.
const BELIEVED: f64 = 0.97;
/// Growth over the whole recording, in powers of e, that is no accident of its beginning.
const GROWS: f64 = 8.0;
/// Powers of e by which a difference may grow within a window.
const WITHIN: f64 = 1.5;
/// Cycles of the response in a window, at least and at most.
const CYCLES: [f64; 2] = [1.5, 5.0];
/// Fewest samples of a window.
const FEWEST: usize = 40;
/// Integration steps per sample of the variational equation.
const STEPS: usize = 8;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chaos {
    /// Largest Lyapunov exponent, 1/s.
    pub exponent_per_s: f64,
    /// Time after which a difference of the size of the noise is as large as the motion.
    pub horizon_s: f64,
    pub window_s: f64,
    /// Readings at the bottoms of two wells, where there are two.
    pub wells: Option<[f64; 2]>,
    pub force: ForceAtRest,
}

/// x″ + c x′ + k₁x + k₂x² + k₃x³ = G u + k₀, of the readings.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Force {
    damping: f64,
    gain: f64,
    /// k₀ to k₃, the first with the sign of a force.
    k: [f64; 4],
    explained: f64,
}

/// Cycles within which a periodic response repeats, samples compared with later ones, and the
/// root-mean-square difference, over the size of the motion, below which they are the same.
const LONGEST: f64 = 12.0;
const COMPARED: usize = 2048;
const REPEATED: f64 = 0.1;

/// Returns the chaos of the response within this recording; `None` where it is not chaotic, or
/// where no force of third degree describes it.
pub(crate) fn chaos(data: &Data) -> Option<Chaos> {
    let y = &data.reading[data.hull.clone()];
    let (centre, size) = mean_sd(y);
    let cycle = cycle(y, centre)?;
    // What repeats is not chaotic, and its few harmonics do not determine a force.
    if repeats(y, size, cycle) {
        return None;
    }
    let force = force(data, cycle)?;
    if force.explained < BELIEVED {
        return None;
    }
    let exponent = exponent(y, &force, data.interval_s());
    let duration_s = y.len() as f64 * data.interval_s();
    let noise = reading_noise(&Sample::of(data))?.deviation.max(1e-12 * size);
    let horizon_s = (size / noise).max(std::f64::consts::E).ln() / exponent;
    if !(exponent * duration_s > GROWS && horizon_s < 0.5 * duration_s) {
        return None;
    }
    let cycle_s = cycle * data.interval_s();
    let window_s = (WITHIN / exponent).clamp(CYCLES[0] * cycle_s, CYCLES[1] * cycle_s);
    let (bottom, wells) = force.bottom()?;
    let stiffness = force.stiffness(bottom);
    let omega = stiffness.sqrt();
    let mut start = vec![0.0; BASE];
    (start[GAIN], start[OMEGA], start[OFFSET]) = (force.gain, omega, bottom);
    start[ZETA] = (0.5 * force.damping / omega).clamp(1e-3, 1.0);
    let [_, _, k2, k3] = force.k;
    let force = ForceAtRest { base: start, quadratic: k2 + 3.0 * k3 * bottom, cubic: k3 };
    Some(Chaos { exponent_per_s: exponent, horizon_s, window_s, wells, force })
}

impl Chaos {
    /// Divides the recording into windows, each with its own initial state; every third one is for
    /// validation, unless the model file names the test samples.
    pub(crate) fn in_windows(&self, data: &mut Data) {
        let length = ((self.window_s * data.rate_hz) as usize).max(FEWEST);
        if !data.own_test {
            let known = merged({
                let mut all: Stretches = data.train.iter().chain(&data.validation).cloned().collect();
                all.sort_by_key(|r| r.start);
                all
            });
            let count = (data.hull.len() / length).max(3);
            let at = |i: usize| data.hull.start + data.hull.len() * i / count;
            let pick = |judges: bool| -> Stretches {
                let chosen = (0..count).filter(|i| (i % 3 == 1) == judges).map(|i| at(i)..at(i + 1)).collect();
                let all: Stretches = if judges { chosen } else { merged(chosen) };
                let unknown = minus(std::slice::from_ref(&data.hull), &known);
                minus(&all, &unknown)
            };
            (data.train, data.validation) = (pick(false), pick(true));
            data.test.clone_from(&data.validation);
        }
        let cycle = self.window_s * data.rate_hz / CYCLES[1];
        let course = Course { reading: &data.reading, rate_hz: data.rate_hz, length, cycle };
        data.windows =
            Some(Windows::over(&course, &[&data.train, &data.validation, &data.test], self.force.clone()).into());
    }
}

/// Samples of a cycle, by how often the reading crosses its mean upwards by more than its noise.
fn cycle(y: &[f64], centre: f64) -> Option<f64> {
    let (_, size) = mean_sd(y);
    let (mut above, mut count) = (false, 0usize);
    for v in y {
        if !above && *v > centre + 0.1 * size {
            (above, count) = (true, count + 1);
        } else if above && *v < centre - 0.1 * size {
            above = false;
        }
    }
    (count >= 8).then(|| y.len() as f64 / count as f64)
}

/// Returns whether the reading comes back to itself after some time of up to `LONGEST` cycles.
fn repeats(y: &[f64], size: f64, cycle: f64) -> bool {
    let longest = ((LONGEST * cycle) as usize).min(y.len() / 2);
    let every = ((y.len() - longest) / COMPARED).max(1);
    (((0.5 * cycle) as usize).max(1)..longest).any(|lag| {
        let moved: Vec<f64> = (0..y.len() - lag).step_by(every).map(|k| (y[k + lag] - y[k]).powi(2)).collect();
        moved.iter().sum::<f64>() < (REPEATED * size).powi(2) * moved.len() as f64
    })
}

/// The force by the weak form, weights a cycle long.
fn force(data: &Data, cycle: f64) -> Option<Force> {
    let y = &data.reading[data.hull.clone()];
    let u = data.input.as_ref().map(|i| &Input::samples(i)[data.hull.clone()]);
    let side = ((0.35 * cycle) as usize).clamp(4, 400);
    let step = (side / 2).max(1);
    let half_s = side as f64 * data.interval_s();
    // (1 − s²)⁶ and its derivatives by time.
    let weight = |s: f64| {
        let q = 1.0 - s * s;
        [q.powi(6), -12.0 * s * q.powi(5) / half_s, (-12.0 * q.powi(5) + 120.0 * s * s * q.powi(4)) / (half_s * half_s)]
    };
    let weights: Vec<[f64; 3]> = (0..=2 * side).map(|j| weight(j as f64 / side as f64 - 1.0)).collect();
    let size = mean_sd(y).1.max(1e-300);
    let drive = u.map_or(0.0, |u| mean_sd(u).1);
    let mut columns = vec![Vec::new(); if drive > 0.0 { 6 } else { 5 }];
    let mut residual = Vec::new();
    let mut centre = side;
    while centre + side < y.len() {
        let mut sums = [0.0; 7];
        for (j, [w, first, second]) in weights.iter().enumerate() {
            let x = y[centre - side + j] / size;
            let terms = [second * x, first * x, *w, w * x, w * x * x, w * x * x * x];
            terms.iter().enumerate().for_each(|(i, t)| sums[i] += t);
            if let Some(u) = u {
                sums[6] += w * u[centre - side + j] / drive.max(1e-300);
            }
        }
        // ∫w x″ = c ∫w′x + k₀∫w − k₁∫wx − … + G∫wu.
        residual.push(sums[0]);
        columns.iter_mut().zip(&sums[1..]).for_each(|(c, s)| c.push(*s));
        centre += step;
    }
    if residual.len() < 12 * columns.len() || !residual.iter().all(|v| v.is_finite()) {
        return None;
    }
    let total: f64 = residual.iter().map(|v| v * v).sum();
    let normal = Linear { residual, columns }.normal();
    let residual = normal.predicted();
    // Residual plus columns times step is least: the step is the coefficients with the other sign.
    let p: Vec<f64> = normal.step(0.0).iter().map(|v| -v).collect();
    let gain = if drive > 0.0 { p[5] * size / drive } else { 0.0 };
    Some(Force {
        damping: p[0],
        gain,
        k: [p[1] * size, -p[2], -p[3] / size, -p[4] / (size * size)],
        explained: 1.0 - residual / total.max(1e-300),
    })
}

impl Force {
    fn pull(&self, x: f64) -> f64 {
        let [k0, k1, k2, k3] = self.k;
        x * (k1 + x * (k2 + x * k3)) - k0
    }

    fn stiffness(&self, x: f64) -> f64 {
        let [_, k1, k2, k3] = self.k;
        k1 + x * (2.0 * k2 + 3.0 * x * k3)
    }

    /// A place where the mass rests, the stiffest, and both where there are two.
    fn bottom(&self) -> Option<(f64, Option<[f64; 2]>)> {
        let [k0, k1, k2, k3] = self.k;
        // Beyond this no force of third degree has a root (Cauchy).
        let reach = 1.0 + [k0, k1, k2].into_iter().map(|k| (k / k3).abs()).fold(0.0, f64::max);
        let scale = if reach.is_finite() { reach.min(1e6 * (1.0 + (k0 / k1).abs())) } else { return None };
        const PLACES: i32 = 4000;
        let place = |i: i32| scale * (f64::from(i) / f64::from(PLACES)).powi(3);
        let mut roots = Vec::new();
        for i in -PLACES..PLACES {
            let (mut a, mut b) = (place(i), place(i + 1));
            if self.pull(a) <= 0.0 && self.pull(b) > 0.0 {
                for _ in 0..60 {
                    let m = 0.5 * (a + b);
                    if self.pull(m) > 0.0 { b = m } else { a = m }
                }
                roots.push(0.5 * (a + b));
            }
        }
        let stiffest = roots.iter().copied().max_by(|a, b| self.stiffness(*a).total_cmp(&self.stiffness(*b)))?;
        let wells = match roots.as_slice() {
            [a, b] => Some([*a, *b]),
            _ => None,
        };
        (self.stiffness(stiffest) > 0.0).then_some((stiffest, wells))
    }
}

/// Mean growth of a small difference along the recorded motion, 1/s.
fn exponent(y: &[f64], force: &Force, interval_s: f64) -> f64 {
    let h = interval_s / STEPS as f64;
    let (mut d, mut sum) = ([1.0, 0.0f64], 0.0);
    for pair in y.windows(2) {
        let stiffness = |t: f64| force.stiffness(pair[0] + (pair[1] - pair[0]) * t);
        for s in 0..STEPS {
            let at = |part: f64| stiffness((s as f64 + part) / STEPS as f64);
            let slope = |k: f64, d: [f64; 2]| [d[1], -k * d[0] - force.damping * d[1]];
            let ahead = |d: [f64; 2], r: [f64; 2], h: f64| [d[0] + h * r[0], d[1] + h * r[1]];
            let k1 = slope(at(0.0), d);
            let k2 = slope(at(0.5), ahead(d, k1, 0.5 * h));
            let k3 = slope(at(0.5), ahead(d, k2, 0.5 * h));
            let k4 = slope(at(1.0), ahead(d, k3, h));
            d = std::array::from_fn(|i| d[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        let length = d[0].hypot(d[1]);
        if !(length > 0.0 && length.is_finite()) {
            return f64::NEG_INFINITY;
        }
        sum += length.ln();
        d = d.map(|v| v / length);
    }
    sum / (y.len() as f64 * interval_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driven::intake::input::Interpolation;
    use crate::driven::intake::observed::Observed;
    use crate::driven::intake::stretches::interleaved;
    use crate::driven::intake::work::Work;
    use crate::rng::{Philox, Stream};
    use crate::trace::Trace;
    use proofmass_physics::dynamics::duffing::{Drive, Oscillator, State};
    use proofmass_physics::dynamics::lyapunov::{Span, spectrum};
    use std::f64::consts::TAU;

    const PER_CYCLE: usize = 60;

    /// x″ + c·x′ + k·x + b·x³ = F·cos Ωt after 200 periods, 150 periods at 60 samples each, with
    /// 0.2 % of noise; RK4 in 20 steps per sample.
    fn recorded([damping, stiffness, cubic]: [f64; 3], force: f64, drive_rad_s: f64) -> Data {
        let (steps, count) = (20, 150 * PER_CYCLE);
        let h = TAU / drive_rad_s / (PER_CYCLE * steps) as f64;
        let pushed = |t: f64| force * (drive_rad_s * t).cos();
        let slope = |t: f64, [x, v]: [f64; 2]| [v, pushed(t) - damping * v - stiffness * x - cubic * x.powi(3)];
        let (mut s, mut y, mut u) = ([0.1, 0.1], Vec::new(), Vec::new());
        for k in 0..(200 * PER_CYCLE + count) * steps {
            let t = k as f64 * h;
            if k % steps == 0 && k >= 200 * PER_CYCLE * steps {
                y.push(s[0]);
                u.push(pushed(t));
            }
            let ahead = |r: [f64; 2], h: f64| [s[0] + h * r[0], s[1] + h * r[1]];
            let k1 = slope(t, s);
            let k2 = slope(t + 0.5 * h, ahead(k1, 0.5 * h));
            let k3 = slope(t + 0.5 * h, ahead(k2, 0.5 * h));
            let k4 = slope(t + h, ahead(k3, h));
            s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        let size = mean_sd(&y).1;
        let mut rng = Philox::new(9, 0, Stream::Host);
        y.iter_mut().for_each(|y| *y += 0.002 * size * rng.normal());
        let hull = 24..count - 24;
        let (train, validation) = interleaved(std::slice::from_ref(&hull));
        Data {
            reading: y,
            observed: Observed::default(),
            input: Some(Input::new(u, Interpolation::BandLimited)),
            environment: Vec::new(),
            environments: 0,
            followed: Vec::new(),
            rate_hz: PER_CYCLE as f64 * drive_rad_s / TAU,
            hull,
            breaks: Vec::new(),
            train,
            test: validation.clone(),
            validation,
            own_test: false,
            windows: None,
            clock_s: Vec::new(),
            work: Work::default(),
            trace: Trace::default(),
        }
    }

    // The paper's oscillator (D₀ = 0.1, ε = 0.3) at F₀ = 70.8: the exponent of
    // `dynamics::lyapunov`, which integrates the equation itself, 0.18 1/s.
    #[test]
    fn the_exponent_of_a_chaotic_recording_is_that_of_its_equation() {
        let oscillator = Oscillator { mass_kg: 1.0, damping_kg_s: 0.1, stiffness_n_m: 1.0, cubic_n_m3: 0.3 };
        let drive = Drive { amplitude_n: 70.8, omega_rad_s: 1.5 };
        let span = Span { steps_per_period: 400, transient_periods: 200, periods: 600 };
        let exact = spectrum(&oscillator, &drive, State { x_m: 0.1, v_m_s: 0.1 }, span)[0];
        let found = chaos(&recorded([0.1, 1.0, 0.3], 70.8, 1.5)).expect("it is chaotic");
        // 150 periods say it no better than a few hundredths.
        assert!((found.exponent_per_s - exact).abs() < 0.04, "{} {exact}", found.exponent_per_s);
        assert!(
            (found.force.base[OMEGA] - 1.0).abs() < 0.3 && (found.force.base[GAIN] - 1.0).abs() < 0.02,
            "{:?}",
            found.force.base
        );
        assert!(found.wells.is_none());
    }

    // The negative controls: the same spring at a tenth of the force, where it is periodic, and no
    // cubic spring at all.
    #[test]
    fn periodic_responses_are_not_chaotic() {
        assert_eq!(chaos(&recorded([0.1, 1.0, 0.3], 7.08, 1.5)), None);
        assert_eq!(chaos(&recorded([0.1, 1.0, 0.0], 7.08, 1.5)), None);
    }

    // x″ + 0.25x′ − x + x³ = 0.4 cos t, chaotic across both wells (Guckenheimer & Holmes 1983): at
    // ±1, where the stiffness is 2.
    #[test]
    fn two_wells_are_seen_and_the_model_begins_in_one() {
        let found = chaos(&recorded([0.25, -1.0, 1.0], 0.4, 1.0)).expect("it is chaotic");
        let [a, b] = found.wells.expect("there are two");
        assert!((a + 1.0).abs() < 0.1 && (b - 1.0).abs() < 0.1, "{a} {b}");
        assert!((found.force.base[OMEGA] - 2f64.sqrt()).abs() < 0.15, "{:?}", found.force.base);
    }
}
