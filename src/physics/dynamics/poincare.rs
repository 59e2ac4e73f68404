//! Orbits for the eye: the phase portrait, and the clipping of a strobed cloud to a window.
//!
//! Not for large clouds: those come from the lanes of `kernel::cpu::poincare`.

use super::duffing::{Drive, Oscillator, State};

/// A rectangle in the plane of displacement and velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Displacement from, to; m.
    pub x_m: (f64, f64),
    /// Velocity from, to; m/s.
    pub v_m_s: (f64, f64),
}

impl Window {
    /// The smallest window around all points.
    pub fn around(points: &[[f32; 2]]) -> Self {
        let limits = |i: usize| {
            points
                .iter()
                .map(|p| f64::from(p[i]))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
        };
        Self { x_m: limits(0), v_m_s: limits(1) }
    }

    /// A window `factor` times as large in both directions, around a point.
    pub fn scaled(&self, centre: [f32; 2], factor: f64) -> Self {
        let part = |limits: (f64, f64), at: f32| {
            let half = 0.5 * factor * (limits.1 - limits.0);
            (f64::from(at) - half, f64::from(at) + half)
        };
        Self { x_m: part(self.x_m, centre[0]), v_m_s: part(self.v_m_s, centre[1]) }
    }

    /// Returns whether a point lies inside.
    pub fn holds(&self, point: &[f32; 2]) -> bool {
        let within = |v: f32, limits: (f64, f64)| f64::from(v) >= limits.0 && f64::from(v) < limits.1;
        within(point[0], self.x_m) && within(point[1], self.v_m_s)
    }

    /// The point in the window's own coordinates, 0 to 1 in both directions.
    pub fn unit(&self, point: &[f32; 2]) -> [f64; 2] {
        let part = |v: f32, limits: (f64, f64)| (f64::from(v) - limits.0) / (limits.1 - limits.0);
        [part(point[0], self.x_m), part(point[1], self.v_m_s)]
    }
}

/// The orbit after `skip` periods, `steps` points per period for `periods` periods.
pub fn portrait(oscillator: &Oscillator, drive: &Drive, steps: u32, skip: u32, periods: u32) -> Vec<State> {
    let table = drive.table_n(steps);
    let h = drive.period_s() / f64::from(steps);
    let mut state = State::default();
    let mut orbit = Vec::with_capacity((periods * steps) as usize + 1);
    for period in 0..skip + periods {
        for j in 0..steps as usize {
            if period >= skip {
                orbit.push(state);
            }
            state = oscillator.step(state, h, [table[2 * j], table[2 * j + 1], table[2 * j + 2]]);
        }
    }
    orbit.push(state);
    orbit
}
