//! Evaluates one law at one instant, on the mass that all pictures share.

use std::f64::consts::{PI, SQRT_2};

use crate::law::{Order, Role};
use crate::library::Term;
use crate::scales::{Coordinate, Scales};
use crate::state::{Base, Instants, LANES, Lanes, MOST_STAGED, MOST_VALUES, Values};

/// Damping ratio of the mass: a quality factor of ten. Its resonance is at 1 rad/s, its gain and the standard
/// deviation of displacement and input are one.
pub(super) const ZETA: f64 = 0.05;
/// Largest displacement, velocity and input: those of a sine whose standard deviation is one.
pub(super) const LARGEST: f64 = SQRT_2;
/// Highest frequency of a picture, over that of the resonance; the lowest is its inverse.
pub(super) const HIGHEST: f64 = 10.0;
/// Periods of the resonance that a recording lasts.
const PERIODS: f64 = 20.0;
/// Periods of an oscillation that the input does not cause.
const PERIODS_OF_A_LINE: f64 = 5.0;
/// Units of a coordinate in what a recording makes typical: laws state a tenth of it.
const UNITS: f64 = 10.0;

/// States of a law's own.
pub(super) type Own = [f64; MOST_STAGED];

/// The one thing that a force depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Argument {
    Displacement,
    Velocity,
    Input,
}

/// One instant of the mass.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct At {
    pub(super) time_s: f64,
    pub(super) x: f64,
    pub(super) v: f64,
    pub(super) u: f64,
}

impl At {
    /// Nothing but this.
    pub(super) fn only(argument: Argument, value: f64) -> Self {
        match argument {
            Argument::Displacement => Self { x: value, ..Self::default() },
            Argument::Velocity => Self { v: value, ..Self::default() },
            Argument::Input => Self { u: value, ..Self::default() },
        }
    }
}

/// A law on the mass.
pub(super) struct Acting {
    pub(super) term: Term,
    pub(super) scales: Scales,
    p: Values<f64, 1>,
}

/// Sizes of the recording that all pictures are of.
fn scales() -> Scales {
    let duration_s = PERIODS * 2.0 * PI;
    Scales {
        output: 1.0,
        output_range: (-LARGEST, LARGEST),
        velocity: 1.0,
        input: 1.0,
        omega_rad_s: 1.0,
        zeta: ZETA,
        gain: 1.0,
        interval_s: PI / HIGHEST,
        duration_s,
        residual: 1.0,
        highest_hz: HIGHEST / (2.0 * PI),
        lines_hz: vec![PERIODS_OF_A_LINE / duration_s],
        environment: Vec::new(),
        centre: 0.0,
        fineness: 1.0,
        lag_samples: 0.0,
        at_once: false,
    }
}

/// Values with which a law is well seen: those in the middle of where a fit of it begins, and what is next to
/// nothing there as large as the recording makes typical.
fn typical(term: &Term, scales: &Scales) -> Values<f64, 1> {
    let starts = term.starts(scales);
    let start = starts.get(starts.len() / 2).cloned().unwrap_or_default();
    let mut p = [[0.0]; MOST_VALUES];
    let parameters = term.candidate().parameters.len();
    for ((p, value), coordinate) in p.iter_mut().zip(start).zip(term.coordinates(scales)).take(parameters) {
        p[0] = match coordinate {
            Coordinate::Linear(unit) if value.abs() < unit => UNITS * unit,
            Coordinate::Bounded(unit, low, high) if value.abs() < unit => (UNITS * unit).clamp(low, high),
            _ => value,
        };
    }
    p
}

impl Acting {
    pub(super) fn new(term: Term) -> Self {
        let scales = scales();
        let p = typical(&term, &scales);
        Self { term, scales, p }
    }

    /// The law this many times as strong: parameter 0 is its strength.
    pub(super) fn stronger(&self, factor: f64) -> Self {
        let mut p = self.p;
        p[0][0] *= factor;
        Self { term: self.term, scales: self.scales.clone(), p }
    }

    /// A parameter of the law.
    pub(super) fn value(&self, parameter: usize) -> f64 {
        self.p[parameter][0]
    }

    /// Number of states that the law adds to those of the mass.
    pub(super) fn states(&self) -> usize {
        self.term.states().min(MOST_STAGED)
    }

    fn instants<'a>(at: &At, base: &'a Base<f64, 1>) -> Instants<'a, f64, 1> {
        // No step: nothing is smoothed over one.
        let (input, x, v) = ([at.u], [at.x], [at.v]);
        Instants { input, x, v, time: at.time_s, step: 0.0, base, environment: &[] }
    }

    /// The acceleration that the law adds, and the rates of its states.
    pub(super) fn force(&self, at: &At, own: &Own) -> (f64, Own) {
        let base = base();
        let (mut rates, mut acceleration) = ([[0.0]; MOST_STAGED], [0.0]);
        let own = own.map(|state| [state]);
        self.term.force::<f64, 1, false>(&Self::instants(at, &base), &self.p, &own, &mut rates, &mut acceleration);
        let rates = match self.term.role() {
            Role::Filter(_) => self.filter_rates(at, &own),
            _ => rates.map(|rate| rate[0]),
        };
        (acceleration[0], rates)
    }

    /// Rates of what a filter holds.
    fn filter_rates(&self, at: &At, own: &[[f64; 1]; MOST_STAGED]) -> Own {
        let (x, v): (Lanes, Lanes) = ([at.x; LANES], [at.v; LANES]);
        let (p, own) = (self.p.map(|value| [value[0]; LANES]), own.map(|state| [state[0]; LANES]));
        let mut rates = [0.0; MOST_STAGED];
        for (rate, order) in rates.iter_mut().zip([Order::First, Order::Second]).take(self.states()) {
            *rate = self.term.smoothed(order, [&x, &v], &p, &own)[0];
        }
        rates
    }

    /// The reading of a displacement.
    pub(super) fn reading(&self, at: &At, own: &Own, x: f64) -> f64 {
        let (base, mut y) = (base(), [x]);
        let own: Vec<[f64; 1]> = own.iter().take(self.states()).map(|state| [*state]).collect();
        self.term.reading(&Self::instants(at, &base), &self.p, &own, &mut y);
        y[0]
    }

    /// Returns what the force depends on, where that is one thing and no memory.
    pub(super) fn argument(&self) -> Option<Argument> {
        let sizes = [-LARGEST, -0.3 * LARGEST, 0.7 * LARGEST, LARGEST];
        let all = |argument| sizes.iter().map(move |size| At::only(argument, *size));
        let acts = |argument| all(argument).any(|at| self.force(&at, &[0.0; MOST_STAGED]).0 != 0.0);
        let one = [Argument::Displacement, Argument::Velocity, Argument::Input].into_iter().find(|a| acts(*a))?;
        // Any of the others next to it must change nothing.
        let alone = |at: &At| {
            let force = self.force(at, &[0.0; MOST_STAGED]).0;
            sizes.iter().all(|size| {
                let other = At {
                    x: if one == Argument::Displacement { at.x } else { *size },
                    v: if one == Argument::Velocity { at.v } else { *size },
                    u: if one == Argument::Input { at.u } else { *size },
                    time_s: self.scales.duration_s,
                };
                self.force(&other, &[0.0; MOST_STAGED]).0 == force
            })
        };
        (self.states() == 0 && all(one).all(|at| alone(&at))).then_some(one)
    }
}

/// The mass of all pictures.
fn base() -> Base<f64, 1> {
    Base { gain: [1.0], stiffness: [1.0], damping: [2.0 * ZETA] }
}
