//! The response of a linear law with the mass: its matrices are read off the law, one unit at a time.

use nalgebra::{Complex, DMatrix, DVector};

use super::acting::{Acting, At, HIGHEST, Own, ZETA};
use super::picture::{Axis, Curve, POINTS, Picture};
use crate::state::MOST_STAGED;

type Phasor = Complex<f64>;

/// Displacement, velocity and the law's own states.
const MOST: usize = 2 + MOST_STAGED;
/// Largest part of itself by which sums may differ that rounding alone sets apart.
const ROUNDING: f64 = 1e-9;

/// Says what moves the mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moved {
    /// The input, against its spring and damper.
    Driven,
    /// It follows the input: what is read is known from elsewhere.
    Prescribed,
}

/// Rates of all states and the reading, for states and an input.
fn system(acting: Option<&Acting>, time_s: f64, state: &[f64; MOST], u: f64) -> ([f64; MOST], f64) {
    let [x, v, own @ ..] = *state;
    let at = At { time_s, x, v, u };
    let (extra, own_rates): (f64, Own) = acting.map_or_else(Default::default, |law| law.force(&at, &own));
    let mut rates = [0.0; MOST];
    rates[0] = v;
    rates[1] = u - x - 2.0 * ZETA * v + extra;
    rates[2..].copy_from_slice(&own_rates);
    (rates, acting.map_or(x, |law| law.reading(&at, &own, x)))
}

fn unit(i: usize) -> [f64; MOST] {
    std::array::from_fn(|j| f64::from(u8::from(i == j)))
}

/// Matrices of a linear system: rates = a·states + b·input, reading = c·states + d·input.
struct Matrices {
    a: [[f64; MOST]; MOST],
    b: [f64; MOST],
    c: [f64; MOST],
    d: f64,
    size: usize,
}

impl Matrices {
    /// Those of a law at one time, if it is linear there.
    fn of(acting: Option<&Acting>, time_s: f64) -> Option<Self> {
        let size = 2 + acting.map_or(0, Acting::states);
        let (b, d) = system(acting, time_s, &[0.0; MOST], 1.0);
        let mut all = Self { a: [[0.0; MOST]; MOST], b, c: [0.0; MOST], d, size };
        for i in 0..size {
            let (column, read) = system(acting, time_s, &unit(i), 0.0);
            (0..MOST).for_each(|row| all.a[row][i] = column[row]);
            all.c[i] = read;
        }
        // Sums of many units, of both signs: what is linear follows from the units alone.
        let alike = |one: f64, other: f64, size: f64| (one - other).abs() <= ROUNDING * size.max(1.0);
        let states =
            [[1.7, -0.4, 0.9, -1.3, 0.6], [0.7, 1.1, 0.8, -0.5, -0.9], [-0.8, 1.2, -1.9, 0.3, 1.1], [0.0; MOST]];
        let holds = states.iter().all(|state| {
            let mut state = *state;
            state[size..].fill(0.0);
            let u = state[0] - 0.3 * state[1];
            let (rates, read) = system(acting, time_s, &state, u);
            let sum = |row: &[f64; MOST], by_input: f64| {
                row.iter().zip(&state).map(|(a, s)| a * s).sum::<f64>() + by_input * u
            };
            alike(read, sum(&all.c, all.d), read.abs())
                && (0..size).all(|i| alike(rates[i], sum(&all.a[i], all.b[i]), rates[i].abs()))
        });
        holds.then_some(all)
    }

    /// Reading over input at an angular frequency.
    fn response(&self, omega_rad_s: f64, moved: Moved) -> Option<Phasor> {
        let s = Phasor::new(0.0, omega_rad_s);
        // Displacement and velocity are known where they are prescribed.
        let first = if moved == Moved::Prescribed { 2 } else { 0 };
        let n = self.size - first;
        let known = |i: usize| match moved {
            Moved::Prescribed => s * self.a[i][1] + self.a[i][0],
            Moved::Driven => Phasor::from(self.b[i]),
        };
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            let own = if i == j { s } else { Phasor::from(0.0) };
            own - self.a[first + i][first + j]
        });
        let push = DVector::from_fn(n, |i, _| known(first + i));
        let states = matrix.lu().solve(&push)?;
        let read: Phasor = states.iter().enumerate().map(|(i, state)| state * self.c[first + i]).sum();
        let direct = match moved {
            Moved::Prescribed => s * self.c[1] + self.c[0],
            Moved::Driven => Phasor::from(self.d),
        };
        Some(read + direct)
    }
}

/// Frequencies of a picture, over that of the resonance.
fn frequencies() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|i| HIGHEST.powf(2.0 * i as f64 / (POINTS - 1) as f64 - 1.0))
}

const FREQUENCY: Axis = Axis::log("frequency / resonance");
const GAIN: Axis = Axis::log("reading / that of a steady input");
const WITHOUT: &str = "without it";

fn gain(name: &'static str, is_guide: bool, of: impl Fn(f64) -> Option<Phasor>) -> Option<Curve> {
    let points: Option<Vec<_>> = frequencies().map(|f| Some((f, of(f)?.norm()))).collect();
    Some(Curve { name, is_guide, points: points? })
}

/// The gain of a linear law with the mass; at the beginning, half way and at the end where it changes with time.
pub(super) fn of(acting: &Acting) -> Option<Picture> {
    let length_s = acting.scales.duration_s;
    let [begin, middle, end] = [0.0, 0.5, 1.0].map(|part| Matrices::of(Some(acting), part * length_s));
    let (begin, middle, end) = (begin?, middle?, end?);
    let with = |matrices: &Matrices, name| gain(name, false, |f| matrices.response(f, Moved::Driven));
    if begin.a != end.a {
        let curves = [with(&begin, "at the beginning")?, with(&middle, "half way")?, with(&end, "at the end")?];
        return Some(Picture { x: FREQUENCY, y: GAIN, curves: curves.into() });
    }
    let base = Matrices::of(None, 0.0)?;
    let curves = vec![gain(WITHOUT, true, |f| base.response(f, Moved::Driven))?, with(&begin, "with it")?];
    Some(Picture { x: FREQUENCY, y: GAIN, curves })
}

/// The gain of a readout whose true value is known; frequencies are over that of its corner, as there is no resonance.
pub(super) fn of_prescribed(acting: &Acting) -> Option<Picture> {
    let (law, corner_rad_s) = (Matrices::of(Some(acting), 0.0)?, 1.0 / acting.value(0));
    let curve = gain("", false, |f| law.response(f * corner_rad_s, Moved::Prescribed))?;
    let none = Curve { name: "", is_guide: true, points: vec![(1.0 / HIGHEST, 1.0), (HIGHEST, 1.0)] };
    let (x, y) = (Axis::log("frequency / corner"), Axis::log("reading / true value"));
    Some(Picture { x, y, curves: vec![none, curve] })
}

/// The phase of a mass whose reading is late by parameter 0, or early with a `sign` of −1.
pub(super) fn late(acting: &Acting, sign: f64) -> Option<Picture> {
    let (base, late_s) = (Matrices::of(None, 0.0)?, sign * acting.value(0));
    let phase = |name, is_guide, late_s: f64| -> Option<Curve> {
        let of = |f: f64| Some((f, (base.response(f, Moved::Driven)?.arg() - f * late_s).to_degrees()));
        let points: Option<Vec<_>> = frequencies().map(of).collect();
        Some(Curve { name, is_guide, points: points? })
    };
    let curves = vec![phase(WITHOUT, true, 0.0)?, phase("with it", false, late_s)?];
    Some(Picture { x: FREQUENCY, y: Axis::linear("phase of the reading / °"), curves })
}

/// Reading of the mass alone over an input of this frequency, over that of the resonance.
pub(super) fn alone() -> Option<Curve> {
    let base = Matrices::of(None, 0.0)?;
    gain("", false, |f| base.response(f, Moved::Driven))
}

/// The axis of frequencies of a mass.
pub(super) const fn frequency() -> Axis {
    FREQUENCY
}
