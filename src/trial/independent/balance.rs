//! States how much of an effect sweeps can show, and what each statement of the library leaves of it:
//! the oracle of cases of sweeps.
//!
//! The motion of a sweep satisfies Z·X = push with Z = 1 − ω² + iωΓ + N, of which N, the fundamental of
//! all laws for unit displacement, is known from the motion itself. A law that is left out changes the
//! reading by that of its own N, and so does each free number of the base model; what no combination of
//! these accounts for is what a fit of the base model leaves. Linear about the true motion: exact where
//! little is left.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::law::Law;
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
    /// Left by each statement in the place of the only effect.
    pub left: Vec<(&'static str, f64)>,
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
        let mut all: Vec<f64> = (0..self.steps.len()).map(of).flat_map(|y| [y.re, y.im]).collect();
        let size = all.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-300);
        all.iter_mut().for_each(|v| *v /= size);
        all
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

    /// Sum of squares of a change of the reading that the base model with these columns leaves.
    fn left(&self, more: &[Vec<f64>], change: &[Complex<f64>]) -> f64 {
        let columns: Vec<&[f64]> = self.base.iter().chain(more).map(Vec::as_slice).collect();
        let change: Vec<f64> = change.iter().flat_map(|y| [y.re, y.im]).collect();
        left_by(&columns, &change).iter().map(|v| v * v).sum()
    }

    /// Change of the readings where a law acts that has this N.
    fn change(&self, n: impl Fn(usize) -> Complex<f64>) -> Vec<Complex<f64>> {
        (0..self.steps.len()).map(|k| self.reading[k] * self.moved(k, n(k) / self.impedance[k][0])).collect()
    }

    /// N of everything that acts on the mass: of the motion.
    fn acting(&self, k: usize) -> Complex<f64> {
        let (w, damping) = (self.steps[k].omega, self.swept.resonator.damping());
        self.impedance[k][0] - Complex::new(1.0 - w * w, w * damping)
    }

    fn of_law(&self, law: &Law, k: usize) -> Complex<f64> {
        fundamental(law, self.motion[k].norm(), self.steps[k].omega)
    }
}

/// Sizes of what is in a recording of this motion.
pub(super) fn sizes(swept: &Swept, motion: &[Complex<f64>]) -> Sizes {
    let balance = Balance::new(swept, motion);
    let mut whole = balance.change(|k| balance.acting(k));
    for (k, change) in whole.iter_mut().enumerate() {
        *change += balance.reading[k] - motion[k];
    }
    let laws = &swept.resonator.laws;
    let each = |i: usize| {
        let others: Vec<Vec<f64>> = laws
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != i)
            .map(|(_, l)| balance.by(|k| balance.of_law(l, k)))
            .collect();
        balance.left(&others, &balance.change(|k| balance.of_law(&laws[i], k)))
    };
    let all = balance.left(&[], &whole);
    let each = if laws.len() > 1 { (0..laws.len()).map(each).collect() } else { vec![all] };
    let in_place = |forms: Vec<Law>| {
        let one = |form: Law| balance.left(&[balance.by(|k| balance.of_law(&form, k))], &whole);
        forms.into_iter().map(one).fold(f64::INFINITY, f64::min)
    };
    let mut left: Vec<(&str, f64)> = statements().into_iter().map(|(name, forms)| (name, in_place(forms))).collect();
    let late = balance.column(|k| balance.reading[k] * Complex::new(0.0, balance.steps[k].omega - 1.0));
    left.extend(["readout-delay", "readout-lowpass"].map(|name| (name, balance.left(&[late.clone()], &whole))));
    if swept.written.clock {
        let slow = balance.by(|k| Complex::from(balance.steps[k].when));
        left.push(("stiffness-drift", balance.left(&[slow], &whole)));
    }
    Sizes { whole: all, each, left }
}
