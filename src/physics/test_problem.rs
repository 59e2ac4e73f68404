//! The problem that laws are tested on: a mass with one law, integrated finely by the classic
//! Runge–Kutta method.

use super::law::Law;
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// A mass; by default free, without spring or damping.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mass {
    pub omega: f64,
    pub zeta: f64,
    /// Gain of the input.
    pub gain: f64,
}

impl Mass {
    /// Displacement and velocity after `time_s` in this many steps, from `begin` on, under `law`
    /// and an input.
    pub(super) fn moved<L: Law>(
        &self,
        law: &L,
        p: &[f64],
        begin: [f64; 2],
        time_s: f64,
        steps: usize,
        input: impl Fn(f64) -> f64,
    ) -> [f64; 2] {
        let mut values = [0.0; MOST_VALUES];
        values[..p.len()].copy_from_slice(p);
        let h = time_s / steps as f64;
        let slope = |t: f64, [x, v]: [f64; 2]| {
            let (stiffness, gain, input) = (self.omega * self.omega, self.gain, input(t));
            let at = Instant { time: t, step: h, input, x, v, gain, stiffness, environment: &[] };
            let base = gain * input - stiffness * x - 2.0 * self.zeta * self.omega * v;
            [v, law.force::<f64, false>(&at, &values, &[0.0; MOST_STAGED], base)]
        };
        let add = |s: [f64; 2], k: [f64; 2], by: f64| [s[0] + by * k[0], s[1] + by * k[1]];
        (0..steps).fold(begin, |s, n| {
            let t = n as f64 * h;
            let k1 = slope(t, s);
            let k2 = slope(t + 0.5 * h, add(s, k1, 0.5 * h));
            let k3 = slope(t + 0.5 * h, add(s, k2, 0.5 * h));
            let k4 = slope(t + h, add(s, k3, h));
            std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
        })
    }
}
