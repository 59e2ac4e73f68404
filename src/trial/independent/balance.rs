//! States how much of an effect sweeps can show, and what each statement of the library leaves of it:
//! the oracle of cases of sweeps.
//!
//! The motion of a sweep satisfies Z·X = push with Z = 1 − ω² + iωΓ + N, of which N, the fundamental of
//! all laws for unit displacement, is known from the motion itself. Leaving out a law
//! changes the reading as its own N does, and each free parameter of the base model changes it in its own
//! way; what no combination of these changes reproduces is what a fit of the base model leaves. Linear about the true motion: exact where
//! little is left.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::law::{Course, Law};
use super::linear::left_by;
use super::stepped::Step;
use super::swept::Swept;

/// Samples of a cycle in a describing function.
const SAMPLES: usize = 96;
/// Least slope of the push with amplitude, in that of a linear spring: near a fold no line holds.
const LEAST_SLOPE: f64 = 0.3;

/// Names of laws of the mass for sweeps, each with the forces of unit size that its statement may mean.
fn statements() -> Vec<(&'static str, Vec<Law>)> {
    let springs = [1.2, 1.5, 1.8, 2.0, 2.2, 2.5, 2.8, 3.0, 3.3, 3.7, 4.0, 4.5, 5.0, 6.0, 8.0];
    let drags = [0.2, 0.35, 0.5, 0.7, 1.3, 1.5, 1.7, 2.0, 2.3, 2.6, 3.0, 3.5, 4.0, 5.0, 6.0];
    let drag = |p: f64| Law::Drag { size: 1.0, p };
    vec![
        ("cubic-stiffness", vec![Law::OddSpring { size: 1.0, p: 3.0 }]),
        ("power-law-stiffness", springs.map(|p| Law::OddSpring { size: 1.0, p }).to_vec()),
        ("quadratic-damping", vec![drag(2.0)]),
        ("power-law-damping", drags.map(drag).to_vec()),
        ("squeeze-film-damping", vec![Law::Squeeze { size: 1.0 }]),
        ("coulomb-friction", vec![drag(0.0)]),
    ]
}

/// Fundamental of a law's force for a displacement of this amplitude, over that amplitude.
pub(super) fn fundamental(law: &Law, amplitude: f64, omega: f64) -> Complex<f64> {
    let sample = |j: usize| {
        let turn = Complex::from_polar(1.0, TAU * (j as f64 + 0.5) / SAMPLES as f64);
        turn.conj() * law.plain(amplitude * turn.re, -amplitude * omega * turn.im, 1.0)
    };
    (0..SAMPLES).map(sample).sum::<Complex<f64>>() * (2.0 / (SAMPLES as f64 * amplitude.max(1e-12)))
}

/// Sizes for noise of unit variance: sums of squares.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Sizes {
    /// Of all effects together.
    pub whole: f64,
    /// Of each law next to the others.
    pub each: Vec<f64>,
    /// Sum that the law that acts leaves in its own form: no statement can be asked to leave less.
    pub floor: f64,
    /// Sum that each statement leaves where it stands in for the only effect, beyond what the true law leaves.
    pub alone: Vec<(&'static str, f64)>,
    /// The same by two together.
    pub paired: Vec<([&'static str; 2], f64)>,
}

/// A recording about its true motion.
struct Balance<'a> {
    swept: &'a Swept,
    steps: Vec<Step>,
    motion: &'a [Complex<f64>],
    /// Reading for the displacement of each step.
    reading: Vec<Complex<f64>>,
    /// Z, and its slope with the logarithm of the amplitude.
    impedance: Vec<[Complex<f64>; 2]>,
    base: Vec<Vec<f64>>,
}

impl<'a> Balance<'a> {
    fn new(swept: &'a Swept, motion: &'a [Complex<f64>]) -> Self {
        let (steps, damping) = (swept.taken(), swept.resonator.damping());
        let impedance = |(step, x): (&Step, &Complex<f64>)| {
            let a = x.norm();
            let of = |a: f64| -> Complex<f64> {
                swept.resonator.laws.iter().map(|law| fundamental(law, a, step.omega)).sum()
            };
            [Complex::from(step.part * damping) / x, (of(1.02 * a) - of(0.98 * a)) / 0.04]
        };
        let impedance = steps.iter().zip(motion).map(impedance).collect();
        let reading = steps.iter().zip(motion).map(|(step, x)| swept.gain(step, x.norm()) * x).collect();
        let mut all = Self { swept, steps, motion, reading, impedance, base: Vec::new() };
        all.base = all.base_columns();
        all
    }

    /// Change of a reading, over itself, where Z changes by a part of itself.
    fn moved(&self, k: usize, part: Complex<f64>) -> Complex<f64> {
        let [z, slope] = self.impedance[k];
        let steep = Complex::from(1.0) + slope / z;
        let grows = -part.re / steep.re.max(LEAST_SLOPE);
        Complex::new(grows, -part.im - grows * steep.im)
    }

    /// Numbers of a column, X and Y of each step.
    fn column(&self, of: impl Fn(usize) -> Complex<f64>) -> Vec<f64> {
        (0..self.steps.len()).map(of).flat_map(|y| [y.re, y.im]).collect()
    }

    /// Column of a stiffness or damping N.
    fn by(&self, n: impl Fn(usize) -> Complex<f64>) -> Vec<f64> {
        self.column(|k| self.reading[k] * self.moved(k, n(k) / self.impedance[k][0]))
    }

    fn base_columns(&self) -> Vec<Vec<f64>> {
        let i = Complex::new(0.0, 1.0);
        let mut all = vec![
            self.by(|_| Complex::from(1.0)),
            self.by(|k| i * self.steps[k].omega),
            self.by(|k| self.impedance[k][0]),
            self.column(|k| self.reading[k] * i),
            self.column(|k| match self.steps[k].begins {
                true => Complex::from(0.0),
                false => self.reading[k - 1] - self.reading[k],
            }),
        ];
        for unit in [Complex::from(1.0), i] {
            all.extend([self.column(|_| unit), self.column(|k| unit * self.steps[k].along)]);
            if self.swept.drives.len() > 1 {
                let of = |k: usize| unit * self.steps[k].part;
                all.extend([self.column(of), self.column(|k| of(k) * self.steps[k].along)]);
            }
        }
        all
    }

    /// Returns what the base model cannot imitate of a change of the reading.
    fn beyond_base(&self, change: &[f64]) -> Vec<f64> {
        let columns: Vec<&[f64]> = self.base.iter().map(Vec::as_slice).collect();
        left_by(&columns, change)
    }

    /// N of everything that acts on the mass: of the motion.
    fn acting(&self, k: usize) -> Complex<f64> {
        let (w, damping) = (self.steps[k].omega, self.swept.resonator.damping());
        self.impedance[k][0] - Complex::new(1.0 - w * w, w * damping)
    }

    /// Change of the reading by a law, as far as the base model cannot imitate it.
    fn by_law(&self, law: &Law) -> Vec<f64> {
        self.beyond_base(&self.by(|k| match law {
            Law::SpringDrift { size, course } => Complex::from(size * course.at(self.steps[k].when)),
            _ => fundamental(law, self.motion[k].norm(), self.steps[k].omega),
        }))
    }
}

/// Sum of squares that a combination of columns leaves of a change.
fn left(columns: &[&[f64]], change: &[f64]) -> f64 {
    left_by(columns, change).iter().map(|v| v * v).sum()
}

/// Sizes of what is in a recording of this motion.
pub(super) fn sizes(swept: &Swept, motion: &[Complex<f64>]) -> Sizes {
    let balance = Balance::new(swept, motion);
    let acting = balance.by(|k| balance.acting(k));
    let read = balance.column(|k| balance.reading[k] - motion[k]);
    let change: Vec<f64> = acting.iter().zip(read).map(|(a, r)| a + r).collect();
    let change = balance.beyond_base(&change);
    let laws = &swept.resonator.laws;
    let own: Vec<Vec<f64>> = laws.iter().map(|law| balance.by_law(law)).collect();
    let without = |i: usize| -> Vec<&[f64]> { (0..own.len()).filter(|j| *j != i).map(|j| &own[j][..]).collect() };
    let whole = left(&[], &change);
    let each = if laws.len() < 2 { vec![whole] } else { (0..laws.len()).map(|i| left(&without(i), &own[i])).collect() };
    // Of a law of x and v alone its own form leaves harmonics, folds and what has not settled.
    let is_known = |law: &Law| law.states() == 0 && !matches!(law, Law::EvenSpring { .. });
    let floor = match !laws.is_empty() && laws.iter().all(is_known) {
        true => left(&without(laws.len()), &change),
        false => 0.0,
    };
    let left = |columns: &[&[f64]]| (left(columns, &change) - floor).max(0.0);
    let columns: Vec<(&str, Vec<Vec<f64>>)> = statements()
        .into_iter()
        .map(|(name, forms)| (name, forms.iter().map(|law| balance.by_law(law)).collect()))
        .collect();
    let least = |of: &mut dyn Iterator<Item = f64>| of.fold(f64::INFINITY, f64::min);
    let mut alone: Vec<(&str, f64)> =
        columns.iter().map(|(name, forms)| (*name, least(&mut forms.iter().map(|f| left(&[f]))))).collect();
    let late = balance.column(|k| balance.reading[k] * Complex::new(0.0, balance.steps[k].omega - 1.0));
    let late = balance.beyond_base(&late);
    alone.extend(["readout-delay", "readout-lowpass"].map(|name| (name, left(&[&late]))));
    if swept.written.clock {
        let slow = balance.by_law(&Law::SpringDrift { size: 1.0, course: Course::Linear });
        alone.push(("stiffness-drift", left(&[&slow])));
    }
    let mut paired = Vec::new();
    for (i, (first, a)) in columns.iter().enumerate() {
        for (second, b) in &columns[i + 1..] {
            let mut pairs = a.iter().flat_map(|a| b.iter().map(|b| left(&[a, b])));
            paired.push(([*first, *second], least(&mut pairs)));
        }
    }
    Sizes { whole, each, floor, alone, paired }
}
