//! The steady motion of an oscillator with any laws of the library under a sine: harmonic balance.
//!
//! Along x = c + a cos θ (and further harmonics where the laws need them) the laws' own force has a
//! fundamental F̂(a, ω); the motion then satisfies (ω₀² − ω² + iωΓ − F̂/a) X = g·D. For each set of
//! parameters F̂ is tabulated over amplitude at three frequencies; every motion that the equation
//! allows follows from the sign changes of |Z|a − gD, those that are stable with it rising.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use nalgebra::Complex;

use crate::physics::free_form::Freed;
use crate::physics::library::Term;
use crate::physics::state::{Base, Instants, MOST_STAGED, MOST_VALUES};

/// Samples of a cycle.
const SAMPLES: usize = 32;
/// Amplitudes of a table.
const NODES: usize = 48;
/// Highest harmonic that is followed.
const HARMONICS: usize = 7;
/// Rounds in which the harmonics settle.
const ROUNDS: usize = 4;
/// Part of the squared push within which a parabola through three nodes must come, so that the stretch is searched.
const NEARLY: f64 = 0.25;
/// Golden section, and how often a stretch of two nodes is cut by it.
const GOLDEN: f64 = 0.618_033_988_749_895;
const SECTIONS: usize = 24;
/// Part of the largest force by which harmonics must change it to be followed.
const HEARD: f64 = 1e-3;

type Phasor = Complex<f64>;

/// Oscillator without its laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Oscillator {
    /// ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Γ = 2ζω₀, 1/s.
    pub damping_per_s: f64,
}

/// A law at its parameters.
#[derive(Debug, Clone)]
pub(super) struct Law {
    /// The law.
    pub term: Term,
    /// Its parameters, then zeros for unknown beginnings.
    pub values: Vec<f64>,
}

/// Holds what a law adds to the acceleration of N masses, and the rates of its states.
struct Answer<const N: usize> {
    force: [f64; N],
    rates: [[f64; N]; MOST_STAGED],
}

impl Law {
    /// Its force on N masses at these displacements and velocities.
    fn at<const N: usize>(&self, mass: &Oscillator, [x, v]: [[f64; N]; 2], time_s: f64, own: [f64; 2]) -> Answer<N> {
        let base = Base { gain: [1.0; N], stiffness: [mass.omega_rad_s.powi(2); N], damping: [mass.damping_per_s; N] };
        let at = Instants { time: time_s, step: 0.0, input: [0.0; N], x, v, base: &base, environment: &[] };
        let mut p = [[0.0; N]; MOST_VALUES];
        p.iter_mut().zip(&self.values).for_each(|(p, v)| *p = [*v; N]);
        let mut states = [[0.0; N]; MOST_STAGED];
        states.iter_mut().zip(own).for_each(|(state, z)| *state = [z; N]);
        let (mut rates, mut force) = ([[0.0; N]; MOST_STAGED], [0.0; N]);
        self.term.force::<f64, N, false>(&at, &p, &states, &mut rates, &mut force);
        Answer { force, rates }
    }

    /// Returns whether it is a force on the mass.
    pub(super) fn acts(&self) -> bool {
        self.term.role().acts_on_mass()
    }

    /// Returns whether its force is tabulated over amplitude.
    pub(super) fn is_tabulated(&self) -> bool {
        self.acts() && !self.is_linear()
    }

    /// Returns whether its force depends on velocity, at this motion.
    fn has_velocity(&self, mass: &Oscillator, a: f64) -> bool {
        let [still, moving] = [0.0, a * mass.omega_rad_s].map(|v| self.at::<1>(mass, [[a], [v]], 0.0, [0.0; 2]).force);
        still != moving
    }

    /// Returns whether its force is in proportion to the motion, whatever the amplitude.
    pub(super) fn is_linear(&self) -> bool {
        match self.term {
            Term::CoupledMode(_) | Term::StiffnessDrift(_) => true,
            Term::FreeForm(form) => form.law == Freed::Drift,
            _ => false,
        }
    }

    /// Force for a motion of unit amplitude of a law that is linear: its own matrices, found by
    /// probing it with each state.
    pub(super) fn linear(&self, mass: &Oscillator, omega_rad_s: f64, time_s: f64) -> Phasor {
        let j_omega = Phasor::new(0.0, omega_rad_s);
        let probe = |x: f64, v: f64, own: [f64; 2]| {
            let answer = self.at::<1>(mass, [[x], [v]], time_s, own);
            (answer.force[0], answer.rates.map(|r| r[0]))
        };
        let (x, v) = (probe(1.0, 0.0, [0.0; 2]), probe(0.0, 1.0, [0.0; 2]));
        let mut force = j_omega * v.0 + x.0;
        if self.term.states() == 2 {
            let (a, b) = (probe(0.0, 0.0, [1.0, 0.0]), probe(0.0, 0.0, [0.0, 1.0]));
            // (iω − A) s = B by Cramer's rule.
            let m = [[j_omega - a.1[0], Phasor::from(-b.1[0])], [Phasor::from(-a.1[1]), j_omega - b.1[1]]];
            let driven = [0, 1].map(|i| j_omega * v.1[i] + x.1[i]);
            let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
            let first = (driven[0] * m[1][1] - m[0][1] * driven[1]) / det;
            let second = (m[0][0] * driven[1] - m[1][0] * driven[0]) / det;
            force += first * a.0 + second * b.0;
        }
        force
    }
}

/// cos hθ and sin hθ of each sample of a cycle, for the harmonics h from zero.
struct Turns {
    cos: [[f64; SAMPLES]; HARMONICS + 1],
    sin: [[f64; SAMPLES]; HARMONICS + 1],
}

static TURNS: LazyLock<Turns> = LazyLock::new(|| {
    let at = |h: usize, k: usize| h as f64 * TAU * (k as f64 + 0.5) / SAMPLES as f64;
    let of = |f: fn(f64) -> f64| std::array::from_fn(|h| std::array::from_fn(|k| f(at(h, k))));
    Turns { cos: of(f64::cos), sin: of(f64::sin) }
});

/// Force of laws along a cycle, and its harmonics.
struct Cycle<'a> {
    mass: &'a Oscillator,
    laws: &'a [&'a Law],
    omega_rad_s: f64,
    turns: &'a Turns,
}

impl Cycle<'_> {
    /// Force along a motion whose harmonics, from zero, are these.
    fn force(&self, motion: &[Phasor]) -> [f64; SAMPLES] {
        let (mut x, mut v) = ([0.0; SAMPLES], [0.0; SAMPLES]);
        for (h, part) in motion.iter().enumerate().filter(|(_, part)| **part != Phasor::from(0.0)) {
            let (cos, sin, omega) = (&self.turns.cos[h], &self.turns.sin[h], self.omega_rad_s * h as f64);
            for k in 0..SAMPLES {
                x[k] += part.re * cos[k] - part.im * sin[k];
                v[k] -= omega * (part.im * cos[k] + part.re * sin[k]);
            }
        }
        let mut force = [0.0; SAMPLES];
        for law in self.laws {
            let own = law.at(self.mass, [x, v], 0.0, [0.0; 2]).force;
            force.iter_mut().zip(own).for_each(|(f, own)| *f += own);
        }
        force
    }

    /// Harmonic h of a force, of which zero is its mean.
    fn harmonic(&self, force: &[f64; SAMPLES], h: usize) -> Phasor {
        let along = |turn: &[f64; SAMPLES]| force.iter().zip(turn).map(|(f, t)| f * t).sum::<f64>();
        let size = if h == 0 { 1.0 } else { 2.0 } / SAMPLES as f64;
        Phasor::new(along(&self.turns.cos[h]) * size, -along(&self.turns.sin[h]) * size)
    }

    /// Returns whether the force along a sine of this amplitude has a mean.
    fn has_mean(&self, a: f64) -> bool {
        let force = self.force(&[Phasor::from(0.0), Phasor::from(a)]);
        self.harmonic(&force, 0).norm() > HEARD * force.iter().fold(0.0f64, |most, f| most.max(f.abs()))
    }

    /// Fundamental of the force along a motion of amplitude `a` with harmonics up to this one.
    fn fundamental(&self, a: f64, harmonics: usize) -> Phasor {
        let mut motion = vec![Phasor::from(0.0), Phasor::from(a)];
        let mut force = self.force(&motion);
        let (stiffness, damping) = (self.mass.omega_rad_s.powi(2), self.mass.damping_per_s);
        for _ in 0..if harmonics > 1 { ROUNDS } else { 0 } {
            let part = |h: usize| {
                let omega = self.omega_rad_s * h as f64;
                self.harmonic(&force, h) / Phasor::new(stiffness - omega * omega, omega * damping)
            };
            motion = (0..=harmonics).map(|h| if h == 1 { Phasor::from(a) } else { part(h) }).collect();
            force = self.force(&motion);
        }
        self.harmonic(&force, 1)
    }
}

/// Fundamental of the force over amplitude and frequency.
#[derive(Debug, Clone)]
pub(super) struct Table {
    most: f64,
    at_rad_s: [f64; 3],
    nodes: Vec<[Phasor; 3]>,
    /// Harmonics that were followed, the fundamental among them.
    pub harmonics: usize,
}

impl Table {
    /// Tabulates laws for amplitudes up to `most` over a band of frequencies.
    pub(super) fn new(mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        Self::up_to(HARMONICS, mass, laws, most, band_rad_s)
    }

    /// The same with the fundamental alone: a place to begin, some per cent off.
    pub(super) fn rough(mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        Self::up_to(1, mass, laws, most, band_rad_s)
    }

    fn up_to(harmonics: usize, mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        let acting: Vec<&Law> = laws.iter().filter(|law| law.is_tabulated()).collect();
        let [low, high] = band_rad_s;
        let at_rad_s = [low, 0.5 * (low + high), high];
        if acting.is_empty() {
            return Self { most, at_rad_s, nodes: Vec::new(), harmonics: 1 };
        }
        let cycle = |omega_rad_s: f64| Cycle { mass, laws: &acting, omega_rad_s, turns: &TURNS };
        let middle = cycle(at_rad_s[1]);
        // An even force acts by the mean and the second harmonic that it makes, and by them alone.
        let harmonics = if middle.has_mean(0.7 * most) { HARMONICS } else { harmonics };
        let [bare, full] = [1, harmonics].map(|h| middle.fundamental(0.7 * most, h));
        let harmonics = if (full - bare).norm() > HEARD * bare.norm() { harmonics } else { 1 };
        // A spring alone is the same at every frequency, but for its harmonics.
        let is_alike = harmonics == 1 && acting.iter().all(|law| !law.has_velocity(mass, 0.7 * most));
        let node = |i: usize| {
            let at = |omega: f64| cycle(omega).fundamental(amplitude(most, i), harmonics);
            if is_alike { [at(at_rad_s[1]); 3] } else { at_rad_s.map(at) }
        };
        Self { most, at_rad_s, nodes: (0..NODES).map(node).collect(), harmonics }
    }

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

fn amplitude(most: f64, node: usize) -> f64 {
    most * (node as f64 / (NODES - 1) as f64).powi(2)
}

/// Force over displacement at one frequency, as a function of amplitude.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impedance<'a> {
    table: &'a Table,
    weights: [f64; 3],
    bare: Phasor,
}

impl Impedance<'_> {
    fn force_at(&self, node: usize) -> Phasor {
        let row = &self.table.nodes[node];
        row[0] * self.weights[0] + row[1] * self.weights[1] + row[2] * self.weights[2]
    }

    /// Z and dZ/da at an amplitude; constant beyond the table.
    pub(super) fn at(&self, a: f64) -> (Phasor, Phasor) {
        let nothing = Phasor::new(0.0, 0.0);
        if self.table.nodes.is_empty() || a <= 0.0 {
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

    /// Square of |Z|a at a node of the table.
    fn push_squared(&self, node: usize) -> f64 {
        (self.bare * amplitude(self.table.most, node) - self.force_at(node)).norm_sqr()
    }

    /// Amplitudes of every stable motion under a push of this size, ascending.
    pub(super) fn stable(&self, push: f64) -> Vec<f64> {
        if self.table.nodes.is_empty() {
            return vec![push / self.bare.norm().max(1e-300)];
        }
        let amplitude = |node: usize| amplitude(self.table.most, node);
        let miss: [f64; NODES] = std::array::from_fn(|node| self.push_squared(node) - push * push);
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
            found.push(push / end.norm().max(1e-300));
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
        let miss = |a: f64| side * (self.at(a).0.norm() * a - push);
        let (mut low, mut high) = (left.0, right.0);
        let at = |low: f64, high: f64, part: f64| low + part * (high - low);
        let [mut a, mut b] = [1.0 - GOLDEN, GOLDEN].map(|part| at(low, high, part));
        let (mut at_a, mut at_b) = (miss(a), miss(b));
        for _ in 0..SECTIONS {
            if at_a < at_b {
                (high, b, at_b) = (b, a, at_a);
                a = at(low, high, 1.0 - GOLDEN);
                at_a = miss(a);
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = at(low, high, GOLDEN);
                at_b = miss(b);
            }
            let (best, lowest) = if at_a < at_b { (a, at_a) } else { (b, at_b) };
            if lowest < 0.0 {
                let ends = if side > 0.0 { [best, right.0] } else { [left.0, best] };
                return Some(self.between(ends, push));
            }
        }
        None
    }

    /// The root between two amplitudes, by bisection and secant in turn.
    fn between(&self, [mut low, mut high]: [f64; 2], push: f64) -> f64 {
        let miss = |a: f64| self.at(a).0.norm() * a - push;
        let (mut at_low, mut at_high) = (miss(low), miss(high));
        for step in 0..40 {
            let chord = high - at_high * (high - low) / (at_high - at_low);
            let middle = if step % 3 == 2 || !(chord > low && chord < high) { 0.5 * (low + high) } else { chord };
            let value = miss(middle);
            if value < 0.0 {
                (low, at_low) = (middle, value)
            } else {
                (high, at_high) = (middle, value)
            }
            if high - low < 1e-11 * high || value.abs() < 1e-12 * push {
                return middle;
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::cubic_stiffness::CubicStiffness;

    // Of a spring βx³ under a sine, (ω₀² + κa² − ω²)² + Γ²ω² = (push/a)² with κ = 3β/4 (Nayfeh & Mook, Nonlinear
    // Oscillations, 1979, ch. 4): for each amplitude below the peak the branch that is jumped from is at the smaller
    // of two ω². The peak lies ten and thirty widths of the line above ω₀.
    #[test]
    fn the_upper_branch_is_followed_to_its_end() {
        let (mass, push) = (Oscillator { omega_rad_s: 1.0, damping_per_s: 0.01 }, 0.01);
        for widths in [10.0, 30.0] {
            let kappa = 2.0 * widths * mass.damping_per_s;
            let law = Law { term: Term::CubicStiffness(CubicStiffness), values: vec![kappa / 0.75] };
            let highest: f64 = 1.0 + kappa;
            let most = 1.2 / highest.sqrt();
            let table = Table::rough(&mass, &[law], most, [0.8, 1.2 * highest.sqrt()]);
            // Γωa = push at the peak.
            let peak = 1.0 / (1.0 + kappa).sqrt();
            for part in [0.5, 0.8, 0.9, 0.95, 0.97, 0.98, 0.985, 0.99] {
                let a = part * peak;
                let spring = 1.0 + kappa * a * a;
                let (half, whole) = (spring - 0.5 * mass.damping_per_s.powi(2), spring * spring - (push / a).powi(2));
                let squared = half - (half * half - whole).max(0.0).sqrt();
                let found = table.along(&mass, squared.sqrt(), Phasor::new(0.0, 0.0)).stable(push);
                let last = found.last().copied().unwrap_or(f64::NAN);
                assert!((last / a - 1.0).abs() < 2e-3, "{widths} {part}: {found:?} for {a}");
            }
        }
    }
}
