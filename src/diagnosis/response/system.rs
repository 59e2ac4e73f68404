//! Sweeps as the engine sees them: coordinates, laws and what each set of them predicts.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::Complex;

use crate::engine::fit::{Fitted, MOST_STEPS, nearer};
use crate::engine::kind::{Argument, Form, Kind, Layout, Linearised, Point};
use crate::numerics::order;
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::scales::Coordinate;

use super::balance::balanced;
use super::force::{Law, Oscillator};
use super::intake::Sweeps;
use super::laws;
use super::places::place;
use super::predicted::{Amplitude, Predicted, predicted};
use super::space::{self, Member};
use super::thinned::thinned;
use super::unsettled;
use super::values::{Sizes, Values};

/// Shared coordinates of the resonator and its lock-in: ω₀, Γ, size and angle of the gain,
/// settling.
pub(super) const OWN: usize = 5;
/// Steps of a block.
const BLOCK: usize = 3;
/// Coordinate of a strength at which a law joins a model.
const JOINS: f64 = 0.05;
/// Beginnings of a law that are followed.
const FOLLOWED: usize = 2;
/// Part of the distance between two frequencies below which the width of a resonance between them shows in no step.
const NARROWEST: f64 = 0.1;
/// Part of a reading that the step before may hold.
const SETTLING: [f64; 2] = [-0.3, 0.9];

/// Sweeps and the laws that they are held against.
#[derive(Clone)]
pub(super) struct System<'a> {
    /// The steps.
    pub sweeps: &'a Sweeps,
    /// Each step twice: X, then Y.
    pub layout: Layout,
    /// Sizes of the coordinates.
    pub sizes: Sizes,
    /// The space of laws.
    pub members: Vec<Member>,
    /// States where the amplitude of a motion comes from.
    pub amplitude: Amplitude,
    /// Complex numbers of the background.
    pub backgrounds: usize,
    /// Steps next to a large change of the reading.
    steep: Vec<bool>,
}

impl<'a> System<'a> {
    /// Sweeps with no law next to the base model yet.
    pub(super) fn new(sweeps: &'a Sweeps, sizes: Sizes) -> Self {
        let twice = |r: &Range<usize>| 2 * r.start..2 * r.end;
        let counts = sweeps.counts.iter().flat_map(|c| [*c; 2]).collect();
        let layout = Layout::new(sweeps.sweeps.iter().map(twice).collect(), 2 * BLOCK, counts);
        let backgrounds = if sweeps.drives() > 1 { 4 } else { 2 };
        let steep = unsettled::steep(sweeps);
        Self { sweeps, layout, sizes, members: Vec::new(), amplitude: Amplitude::Nearest, backgrounds, steep }
    }

    /// The same laws over steps of which fewer count.
    pub(super) fn over<'b>(&self, sweeps: &'b Sweeps) -> System<'b> {
        let bare = System::new(sweeps, self.sizes.clone());
        System { members: self.members.clone(), ..bare }
    }

    /// Returns which steps had not settled, by a model.
    pub(super) fn unsettled(&self, model: &Fitted) -> Vec<bool> {
        let predicted = self.predicted(&model.set, &model.point, self.amplitude);
        (0..self.sweeps.len()).map(|k| self.is_unsettled(&predicted, k)).collect()
    }

    /// Returns whether a motion takes too long, or has just jumped to where the model has none.
    fn is_unsettled(&self, predicted: &Predicted, k: usize) -> bool {
        predicted.is_slow[k] || (self.steep[k] && !predicted.is_there[k])
    }

    /// Shared coordinates of the base model.
    pub(super) fn own(&self) -> usize {
        OWN + 2 * self.backgrounds
    }

    /// Laws of a set.
    pub(super) fn terms(&self, set: &[usize]) -> Vec<Term> {
        set.iter().map(|law| self.members[*law].term).collect()
    }

    /// Returns whether two laws are one in another form: a mode coupled to the mass, and one read with it.
    pub(super) fn is_same(&self, law: usize, other: usize) -> bool {
        let is_mode = |law: usize| matches!(self.members[law].term, Term::CoupledMode(_) | Term::ParasiticMode(_));
        is_mode(law) && is_mode(other)
    }

    /// Coordinate of the least width of a resonance at a coordinate.
    fn narrowest(&self, at: f64) -> f64 {
        let s = &self.sizes;
        let spacing_rad_s = TAU * self.sweeps.spacing_hz((s.laws.omega_rad_s + at * s.damping_per_s) / TAU);
        (NARROWEST * spacing_rad_s / s.damping_per_s).ln().clamp(-7.0, 6.9)
    }

    /// Coordinates of a law's parameters.
    pub(super) fn law_coordinates(&self, term: &Term) -> Vec<Coordinate> {
        laws::coordinates(&self.sizes, term)
    }

    /// The model of a set at a point.
    pub(super) fn values(&self, set: &[usize], point: &Point) -> Values {
        let (z, s) = (&point.shared, &self.sizes);
        let background =
            (0..self.backgrounds).map(|i| Complex::new(z[OWN + 2 * i], z[OWN + 2 * i + 1]) * 0.1 * s.reading).collect();
        let laws = set.iter().enumerate().map(|(place, law)| {
            let term = self.members[*law].term;
            let own = &z[self.coordinates(set, place)];
            let mut values: Vec<f64> =
                self.law_coordinates(&term).iter().zip(own).map(|(c, z)| value(*c, *z)).collect();
            values.resize(term.values(), 0.0);
            Law { term, values }
        });
        Values {
            mass: Oscillator {
                omega_rad_s: s.laws.omega_rad_s + z[0] * s.damping_per_s,
                damping_per_s: s.damping_per_s * z[1].exp(),
            },
            gain: z[2].exp() * s.amplitude * s.laws.omega_rad_s * s.damping_per_s / s.drive,
            angle_rad: z[3],
            settling: z[4],
            background,
            laws: laws.collect(),
        }
    }

    /// Returns what a set predicts at a point.
    pub(super) fn predicted(&self, set: &[usize], point: &Point, amplitude: Amplitude) -> Predicted {
        predicted(self.sweeps, &self.sizes, &self.values(set, point), amplitude)
    }

    /// Coordinates of a model whose laws have these forms.
    fn point(&self, set: &[usize], values: &Values, like: &Point) -> Point {
        let (s, mut point) = (&self.sizes, like.clone());
        point.shared[0] = (values.mass.omega_rad_s - s.laws.omega_rad_s) / s.damping_per_s;
        point.shared[1] = (values.mass.damping_per_s / s.damping_per_s).ln();
        let unit = s.amplitude * s.laws.omega_rad_s * s.damping_per_s / s.drive;
        point.shared[2] = (values.gain / unit).max(1e-9).ln();
        (point.shared[3], point.shared[4]) = (values.angle_rad, values.settling);
        let background = values.background.iter().flat_map(|b| [b.re, b.im]);
        point.shared[OWN..].iter_mut().zip(background).for_each(|(z, b)| *z = b / (0.1 * s.reading));
        for (place, law) in values.laws.iter().enumerate() {
            let first = self.coordinates(set, place).start;
            point.shared[first] = coordinate(self.law_coordinates(&law.term)[0], law.values[0]);
        }
        self.confine(set, &mut point);
        point
    }

    /// Returns what a prediction leaves; nothing at steps that had not settled by it.
    fn residual(&self, predicted: &Predicted) -> Vec<f64> {
        let left = |k: usize| match self.is_unsettled(predicted, k) {
            true => Complex::from(0.0),
            false => self.sweeps.reading[k] - predicted.reading[k],
        };
        (0..self.sweeps.len()).map(left).flat_map(|e| [e.re, e.im]).collect()
    }

    /// Returns where a law may begin: as its starts say, and where it has no strength there, with a
    /// little.
    fn beginnings(&self, term: &Term) -> Vec<Vec<f64>> {
        let starts = laws::starts(&self.sizes, term);
        let coordinates = self.law_coordinates(term);
        let of = |start: Vec<f64>| {
            let mut own: Vec<f64> = coordinates.iter().zip(&start).map(|(c, v)| coordinate(*c, *v)).collect();
            if start[0] == 0.0 {
                own[0] = JOINS;
            }
            own
        };
        starts.into_iter().map(of).collect()
    }
}

/// The value at a coordinate.
pub(super) fn value(coordinate: Coordinate, z: f64) -> f64 {
    match coordinate {
        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => z * scale,
        Coordinate::Log(..) => z.exp(),
        Coordinate::Held => z,
    }
}

/// The coordinate of a value.
fn coordinate(coordinate: Coordinate, value: f64) -> f64 {
    match coordinate {
        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => value / scale,
        Coordinate::Log(low, high) => value.clamp(low, high).ln(),
        Coordinate::Held => value,
    }
}

impl Kind for System<'_> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn laws(&self) -> usize {
        self.members.len()
    }

    fn argument(&self, law: usize) -> Argument {
        space::argument(&self.members[law].term)
    }

    fn form(&self, law: usize) -> Form {
        self.members[law].form
    }

    fn excludes(&self, law: usize, other: usize) -> bool {
        space::excludes(&self.members[law].term, &self.members[other].term)
    }

    fn widened(&self, set: &[usize], point: &Point, place: usize, law: usize) -> Option<Point> {
        let wide = self.members[law].term;
        let exponent = laws::exponent(&self.members[set[place]].term, &wide)?;
        let coordinates = self.law_coordinates(&wide);
        let stated = self.values(set, point).laws.swap_remove(place);
        // The size at which the strength is stated is held: a fit keeps that of the law's starts.
        let size = laws::starts(&self.sizes, &wide).first()?[1];
        let values = [stated.values[0] * size.powf(exponent - 1.0), size, exponent];
        let mut widened = self.without(set, point, place);
        widened.shared.extend(coordinates.iter().zip(values).map(|(c, v)| coordinate(*c, v)));
        Some(widened)
    }

    /// Returns where the law fits best with the amplitudes that were read: a fit without branches,
    /// from which the motion itself is followed.
    fn joined(&self, set: &[usize], point: &Point, law: usize) -> Vec<Point> {
        let mut larger = set.to_vec();
        larger.push(law);
        let role = self.members[law].term.role();
        let amplitude = if role.acts_on_mass() { Amplitude::Read } else { self.amplitude };
        let some = thinned(self.sweeps);
        let read = match &some {
            Some((some, kept)) => {
                let steep = kept.iter().map(|k| self.steep[*k]).collect();
                System { amplitude, steep, ..self.over(some) }
            }
            None => Self { amplitude, ..self.clone() },
        };
        let left = |residual: &[f64]| {
            residual.iter().zip(&read.layout.counts).filter(|(_, c)| **c).map(|(e, _)| e * e).sum::<f64>()
        };
        let best = |starts: Vec<Point>| {
            let residuals = read.residuals(&larger, &starts);
            let pairs = starts.into_iter().zip(residuals).filter_map(|(p, e)| Some((left(&e?), p)));
            pairs.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let again = |values: &Values| balanced(self.sweeps, &self.sizes, values);
        let is_readout = matches!(role, Role::Filter(_) | Role::InputDelay);
        let is_placed = role.acts_on_mass() || is_readout;
        let begin = |own: Vec<f64>| {
            let mut point = point.clone();
            point.shared.extend(own);
            let values = self.values(&larger, &point);
            let placed = |values: &Values| self.point(&larger, values, &point);
            let near = best(std::iter::once(point.clone()).chain(again(&values).map(|v| placed(&v))).collect());
            // Where the model is far off, so are its mass and background.
            let far = is_placed.then(|| place(self.sweeps, &self.sizes, &values)).flatten();
            let far = best(far.iter().map(placed).collect());
            let far = far.filter(|far| near.as_ref().is_none_or(|near| far.0 < near.0));
            near.into_iter().chain(far)
        };
        let mut starts: Vec<_> = self.beginnings(&self.members[law].term).into_iter().flat_map(begin).collect();
        if is_readout {
            // A filter or a delay has its gain and background where it is placed already.
            order::sort_by_key(&mut starts, |s| s.0);
            starts.truncate(FOLLOWED);
        }
        let fitted = starts.iter().filter_map(|(_, start)| nearer(&read, &larger, start, MOST_STEPS));
        let mut fits: Vec<_> = fitted.collect();
        order::sort_by_key(&mut fits, |f| f.1);
        fits.truncate(FOLLOWED);
        fits.into_iter().map(|f| f.0).collect()
    }

    /// Returns none: a beginning is fitted already.
    fn strengthened(&self, _: &[usize], point: &Point, _: f64) -> Option<Point> {
        Some(point.clone())
    }

    fn without(&self, set: &[usize], point: &Point, place: usize) -> Point {
        let mut reduced = point.clone();
        reduced.shared.drain(self.coordinates(set, place));
        reduced
    }

    fn residuals(&self, set: &[usize], points: &[Point]) -> Vec<Option<Vec<f64>>> {
        let of = |point: &Point| {
            let residual = self.residual(&self.predicted(set, point, self.amplitude));
            residual.iter().all(|v| v.is_finite()).then_some(residual)
        };
        points.iter().map(of).collect()
    }

    fn linearise(&self, set: &[usize], point: &Point) -> Option<Linearised> {
        let values = self.values(set, point);
        let at = predicted(self.sweeps, &self.sizes, &values, self.amplitude);
        let moved = |place: usize, i: usize| {
            let mut moved = point.clone();
            let coordinates = self.coordinates(set, place);
            moved.shared[coordinates.start + i] += super::predicted::NUDGE;
            (place, self.values(set, &moved))
        };
        let nudged: Vec<Option<(usize, Values)>> = (0..set.len())
            .flat_map(|place| {
                let coordinates = self.law_coordinates(&self.members[set[place]].term);
                (0..coordinates.len()).map(move |i| (place, i, coordinates[i])).collect::<Vec<_>>()
            })
            .map(|(place, i, c)| (c != Coordinate::Held).then(|| moved(place, i)))
            .collect();
        let columns = at.derivatives(self.sweeps, &self.sizes, &values, &nudged);
        let apart = |c: Vec<Complex<f64>>| c.iter().flat_map(|v| [v.re, v.im]).collect::<Vec<f64>>();
        let shared: Vec<Vec<f64>> = columns.into_iter().map(apart).collect();
        let residual = self.residual(&at);
        let finite = shared.iter().chain([&residual]).all(|c| c.iter().all(|v| v.is_finite()));
        finite.then_some(Linearised { residual, shared, starts: Vec::new() })
    }

    fn may_be_whole(&self, set: &[usize], place: usize, point: &Point, deviations: &[f64]) -> bool {
        let term = self.members[set[place]].term;
        let (Term::PowerLawStiffness(_), Some(c)) = (term, self.law_coordinates(&term).pop()) else { return false };
        let exponent = self.coordinates(set, place).end - 1;
        let reach = 1.96 * deviations[exponent].min(1e3);
        let [low, high] = [-reach, reach].map(|r| value(c, point.shared[exponent] + r));
        (2..=4).map(|k| f64::from(2 * k + 1)).any(|whole| low < whole && whole < high)
    }

    fn confine(&self, set: &[usize], point: &mut Point) {
        let s = &self.sizes;
        let [low, high] = s.band_hz.map(|f| TAU * f);
        let reach = 0.5 * (high - low);
        let own = &mut point.shared;
        let at = |omega: f64| (omega - s.laws.omega_rad_s) / s.damping_per_s;
        own[0] = own[0].clamp(at((low - reach).max(0.1 * low)), at(high + reach));
        own[1] = own[1].clamp(self.narrowest(own[0]), 7.0);
        own[2] = own[2].clamp(-30.0, 30.0);
        own[4] = if self.sweeps.is_ordered { own[4].clamp(SETTLING[0], SETTLING[1]) } else { 0.0 };
        for place in 0..set.len() {
            let coordinates = self.law_coordinates(&self.members[set[place]].term);
            let range = self.coordinates(set, place);
            for (c, z) in coordinates.iter().zip(&mut point.shared[range]) {
                match *c {
                    Coordinate::Log(low, high) => *z = z.clamp(low.ln(), high.ln()),
                    Coordinate::Bounded(scale, low, high) => *z = z.clamp(low / scale, high / scale),
                    Coordinate::Linear(_) | Coordinate::Held => {}
                }
            }
        }
        point.shared.iter_mut().filter(|z| !z.is_finite()).for_each(|z| *z = 0.0);
    }

    fn at_bound(&self, set: &[usize], point: &Point) -> Vec<bool> {
        let mut all = vec![false; point.shared.len()];
        all[1] = point.shared[1] <= self.narrowest(point.shared[0]);
        all[4] = !self.sweeps.is_ordered || point.shared[4] <= SETTLING[0] || point.shared[4] >= SETTLING[1];
        for place in 0..set.len() {
            let coordinates = self.law_coordinates(&self.members[set[place]].term);
            for (i, c) in self.coordinates(set, place).zip(coordinates) {
                let v = value(c, point.shared[i]);
                all[i] = match c {
                    Coordinate::Log(low, high) | Coordinate::Bounded(_, low, high) => {
                        v <= low + 0.01 * low.abs() || v >= high - 0.01 * high.abs()
                    }
                    Coordinate::Linear(_) | Coordinate::Held => false,
                };
            }
        }
        all
    }

    fn coordinates(&self, set: &[usize], place: usize) -> Range<usize> {
        let known = |t: &Term| t.values() - t.unknown_beginnings();
        let terms = self.terms(&set[..=place]);
        let first = self.own() + terms[..place].iter().map(known).sum::<usize>();
        first..first + known(&terms[place])
    }

    fn strengths(&self, set: &[usize], place: usize) -> Vec<usize> {
        let first = self.coordinates(set, place).start;
        let has_zero = matches!(
            self.law_coordinates(&self.members[set[place]].term)[0],
            Coordinate::Linear(_) | Coordinate::Bounded(..)
        );
        if has_zero { vec![first] } else { Vec::new() }
    }
}
