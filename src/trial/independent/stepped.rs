//! Motion of a resonator from step to step of a sweep, as a laboratory has it, and its fundamental as a
//! lock-in amplifier takes it.
//!
//! Fourth-order Runge–Kutta over whole cycles; the motion is carried on from one step to the next, so
//! that history decides which of two stable motions there is. In units of 1/ω₀ and of the largest
//! amplitude that the linear resonator has.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::law::Law;

/// Runge–Kutta steps of a cycle; more where a force switches.
const CYCLE: [usize; 2] = [32, 64];
/// Time at each frequency in 1/Γ: transients die with Γ/2, to a thousandth of what a step changes.
const DWELL: f64 = 14.0;
/// Cycles that the lock-in takes.
const TAKEN: usize = 2;
/// Displacement, velocity, and the states of all laws.
const STATES: usize = 8;

/// One step of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Frequency in ω₀.
    pub omega: f64,
    /// Drive as a part of the largest.
    pub part: f64,
    /// Place in the band, from −1 to 1.
    pub along: f64,
    /// Part of the recording that is over.
    pub when: f64,
    /// States whether the drive was changed before it.
    pub begins: bool,
}

/// A resonator with ω₀ = 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Resonator {
    /// ω₀/Γ.
    pub quality: f64,
    /// Laws next to the linear one.
    pub laws: Vec<Law>,
    /// Stiffness per squared amplitude that its own power changes, and the steps in which it warms.
    pub warms: [f64; 2],
}

impl Resonator {
    /// Γ in ω₀.
    pub fn damping(&self) -> f64 {
        1.0 / self.quality
    }

    /// Complex amplitude of the displacement at each step.
    pub fn motion(&self, steps: &[Step]) -> Vec<Complex<f64>> {
        let switches = |l: &Law| matches!(l, Law::SmoothFriction { .. } | Law::Stribeck { .. } | Law::Stop { .. });
        let cycle = CYCLE[usize::from(self.laws.iter().any(switches))];
        let cosines: Vec<f64> = (0..=2 * cycle).map(|j| (PI * j as f64 / cycle as f64).cos()).collect();
        let turns: Vec<Complex<f64>> =
            (0..cycle).map(|j| Complex::from_polar(2.0, -TAU * j as f64 / cycle as f64)).collect();
        let (mut state, mut warmth) = ([0.0; STATES], 0.0);
        let one = |step: &Step| {
            let h = TAU / step.omega / cycle as f64;
            let force = step.part * self.damping();
            let softer = self.warms[0] * warmth + self.drift(step);
            let rates = |s: &[f64; STATES], cosine: f64| self.rates(s, force * cosine, softer);
            let waits = (DWELL * self.quality * step.omega / TAU).ceil() as usize;
            let mut taken = Complex::from(0.0);
            for turn in 0..waits + TAKEN {
                for j in 0..cycle {
                    if turn >= waits {
                        taken += turns[j] * self.read(&state);
                    }
                    let k1 = rates(&state, cosines[2 * j]);
                    let k2 = rates(&moved(&state, &k1, 0.5 * h), cosines[2 * j + 1]);
                    let k3 = rates(&moved(&state, &k2, 0.5 * h), cosines[2 * j + 1]);
                    let k4 = rates(&moved(&state, &k3, h), cosines[2 * j + 2]);
                    state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
                }
            }
            let amplitude = taken / (TAKEN * cycle) as f64;
            if self.warms[0] != 0.0 {
                warmth += (amplitude.norm_sqr() - warmth) * (1.0 - (-1.0 / self.warms[1]).exp());
            }
            amplitude
        };
        steps.iter().map(one).collect()
    }

    /// Stiffness that time adds.
    pub fn drift(&self, step: &Step) -> f64 {
        let of =
            |law: &Law| if let Law::SpringDrift { size, course } = law { size * course.at(step.when) } else { 0.0 };
        self.laws.iter().map(of).sum()
    }

    fn read(&self, s: &[f64; STATES]) -> f64 {
        let mut own = 2;
        let mut all = s[0];
        for law in &self.laws {
            if matches!(law, Law::Beside { .. }) {
                all += s[own];
            }
            own += law.states();
        }
        all
    }

    fn rates(&self, s: &[f64; STATES], force: f64, stiffer: f64) -> [f64; STATES] {
        let (x, v) = (s[0], s[1]);
        let mut rates = [0.0; STATES];
        (rates[0], rates[1]) = (v, force - x * (1.0 + stiffer) - v * self.damping());
        let mut first = 2;
        for law in &self.laws {
            let own = first..first + law.states();
            first = own.end;
            rates[1] -= law.plain(x, v, 1.0) + law.from_states(x, v, &s[own.clone()], 1.0);
            match *law {
                Law::Beside { size, omega, zeta } => {
                    let [z, w] = [s[own.start], s[own.start + 1]];
                    rates[own.start] = w;
                    rates[own.start + 1] = size * force - 2.0 * zeta * omega * w - omega * omega * z;
                }
                _ => law.inner(x, v, &s[own.clone()], 1.0, &mut rates[own]),
            }
        }
        rates
    }
}

fn moved(s: &[f64; STATES], by: &[f64; STATES], h: f64) -> [f64; STATES] {
    std::array::from_fn(|i| s[i] + h * by[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn up_and_down(count: usize, half: f64) -> Vec<Step> {
        let along = |k: usize| -1.0 + 2.0 * k as f64 / (count - 1) as f64;
        let step = |along: f64| Step { omega: 1.0 + half * along, part: 1.0, along, when: 0.0, begins: false };
        (0..count).chain((0..count).rev()).map(|k| step(along(k))).collect()
    }

    // The linear response is known; and a spring that bends the peak by six widths jumps, at another
    // frequency up than down.
    #[test]
    fn a_linear_resonance_is_its_own_and_a_bent_one_remembers() {
        let linear = Resonator { quality: 40.0, laws: Vec::new(), warms: [0.0; 2] };
        let steps = up_and_down(15, 0.1);
        for (step, x) in steps.iter().zip(linear.motion(&steps)) {
            let w = step.omega;
            let known = Complex::from(0.025) / Complex::new(1.0 - w * w, 0.025 * w);
            // 14/Γ leave e⁻⁷ of a change from step to step, and fourth order moves the frequency by
            // (2π/32)⁴/120 of itself, a thousandth of half this width.
            assert!((x - known).norm() < 2e-3, "{w}: {x} {known}");
        }
        let bent = Resonator { laws: vec![Law::OddSpring { size: 0.4, p: 3.0 }], ..linear.clone() };
        let steps = up_and_down(41, 0.25);
        let apart = |r: &Resonator| {
            let all = r.motion(&steps);
            (0..41).map(|k| (all[k] - all[81 - k]).norm()).fold(0.0, f64::max)
        };
        assert!(apart(&bent) > 0.3 && apart(&linear) < 1e-2, "{} {}", apart(&bent), apart(&linear));
    }
}
