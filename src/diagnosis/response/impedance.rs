//! Motions that a push allows at one frequency.

use nalgebra::Complex;

use super::force::Oscillator;
use super::steady_state::{NODES, Table, amplitude};
use crate::numerics::golden;

/// Part of the squared push within which a parabola through three nodes must come, so that the stretch is searched.
const NEARLY: f64 = 0.25;
/// Times that a stretch of two nodes is cut by golden section at most.
const SECTIONS: usize = 24;

type Phasor = Complex<f64>;

/// Force over displacement at one frequency, as a function of amplitude.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impedance<'a> {
    pub table: &'a Table,
    /// Of the table's three frequencies.
    pub weights: [f64; 3],
    /// Of the oscillator and its linear laws.
    pub bare: Phasor,
}

impl Table {
    /// The table along one frequency; `linear` is the force of linear laws for unit amplitude.
    pub(super) fn along(&self, mass: &Oscillator, omega_rad_s: f64, linear: Phasor) -> Impedance<'_> {
        let [low, middle, high] = self.at_rad_s;
        let t = if high > low { (omega_rad_s - middle) / (high - middle) } else { 0.0 };
        let weights = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
        let bare =
            Phasor::new(mass.omega_rad_s.powi(2) - omega_rad_s.powi(2), omega_rad_s * mass.damping_per_s) - linear;
        Impedance { table: self, weights, bare }
    }
}

impl Impedance<'_> {
    fn force_at(&self, node: usize) -> Phasor {
        let [re, im] = self.table.parts.each_ref().map(|part| {
            part[0][node] * self.weights[0] + part[1][node] * self.weights[1] + part[2][node] * self.weights[2]
        });
        Phasor::new(re, im)
    }

    /// Z and dZ/da at an amplitude; constant beyond the table.
    pub(super) fn at(&self, a: f64) -> (Phasor, Phasor) {
        let nothing = Phasor::new(0.0, 0.0);
        if self.table.is_empty || a <= 0.0 {
            return (self.bare, nothing);
        }
        let most = self.table.most;
        if a >= most {
            return (self.bare - self.force_at(NODES - 1) / most, nothing);
        }
        let place = (a / most).sqrt() * (NODES - 1) as f64;
        let i = (place as usize).min(NODES - 2);
        let t = place - i as f64;
        let f = |j: usize| self.force_at(j);
        let (f1, f2) = (f(i), f(i + 1));
        // Slopes by the node's index; one-sided at both ends.
        let m1 = if i > 0 { (f2 - f(i - 1)) * 0.5 } else { f2 - f1 };
        let m2 = if i + 2 < NODES { (f(i + 2) - f1) * 0.5 } else { f2 - f1 };
        let (c2, c3) = ((f2 - f1) * 3.0 - m1 * 2.0 - m2, (f1 - f2) * 2.0 + m1 + m2);
        let force = f1 + (m1 + (c2 + c3 * t) * t) * t;
        let slope = (m1 + (c2 * 2.0 + c3 * (3.0 * t)) * t) * ((NODES - 1) as f64 / (2.0 * (a * most).sqrt()));
        (self.bare - force / a, (force / a - slope) / a)
    }

    /// |Z|²a² at each node of the table, less the square of a push.
    fn misses(&self, push: f64) -> [f64; NODES] {
        let ([re, im], [w0, w1, w2]) = (&self.table.parts, self.weights);
        let miss = |node: usize| {
            let a = amplitude(self.table.most, node);
            let along = self.bare.re * a - (re[0][node] * w0 + re[1][node] * w1 + re[2][node] * w2);
            let across = self.bare.im * a - (im[0][node] * w0 + im[1][node] * w1 + im[2][node] * w2);
            along * along + across * across - push * push
        };
        std::array::from_fn(miss)
    }

    /// Amplitudes of every stable motion under a push of this size, ascending.
    pub(super) fn stable(&self, push: f64) -> Vec<f64> {
        if self.table.is_empty {
            return vec![push / size(self.bare).max(1e-300)];
        }
        let amplitude = |node: usize| amplitude(self.table.most, node);
        let miss = self.misses(push);
        let mut found = Vec::new();
        for i in 1..NODES {
            if miss[i - 1] < 0.0 && miss[i] >= 0.0 {
                found.push(self.between([amplitude(i - 1), amplitude(i)], push));
            } else if i + 1 < NODES {
                found.extend(self.close(std::array::from_fn(|j| (amplitude(i + j - 1), miss[i + j - 1])), push));
            }
        }
        if miss[NODES - 1] < 0.0 {
            // Beyond the table the laws are held as they are at its end.
            let (end, _) = self.at(self.table.most);
            found.push(push / size(end).max(1e-300));
        }
        found
    }

    /// The stable one of two motions that are so close, near the end of a branch, that both lie between nodes: at
    /// three of them |Z|a misses the push to the same side, and comes nearest at the middle one.
    fn close(&self, [left, middle, right]: [(f64, f64); 3], push: f64) -> Option<f64> {
        let side = middle.1.signum();
        let is_nearest = |end: f64| end.signum() == side && end.abs() > middle.1.abs();
        let (rise, bend) = (right.1 - left.1, right.1 - 2.0 * middle.1 + left.1);
        // A parabola through them comes near enough.
        let reach = side * (middle.1 - rise * rise / (8.0 * bend));
        let is_near = is_nearest(left.1) && is_nearest(right.1) && reach < NEARLY * push * push;
        if !is_near {
            return None;
        }
        let miss = |a: f64| side * (size(self.at(a).0) * a - push);
        let (best, lowest) = golden::least(miss, [left.0, right.0], SECTIONS, |lowest| lowest < 0.0);
        let ends = if side > 0.0 { [best, right.0] } else { [left.0, best] };
        (lowest < 0.0).then(|| self.between(ends, push))
    }

    /// The root between two amplitudes, by Newton's step where that stays between them, else by bisection.
    fn between(&self, [mut low, mut high]: [f64; 2], push: f64) -> f64 {
        let mut a = 0.5 * (low + high);
        for _ in 0..60 {
            let (z, slope) = self.at(a);
            let size = size(z);
            let miss = size * a - push;
            if miss < 0.0 {
                low = a
            } else {
                high = a
            }
            if miss.abs() < 1e-12 * push || high - low < 1e-11 * high {
                break;
            }
            let rise = size + a * (z.conj() * slope).re / size;
            let next = a - miss / rise;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            // As close as the digits of Z allow.
            if (next - a).abs() < 1e-13 * a {
                break;
            }
            a = next;
        }
        a
    }
}

/// Size of a phasor: quicker than `norm`, which guards against numbers near the largest that there are.
fn size(z: Phasor) -> f64 {
    z.norm_sqr().sqrt()
}
