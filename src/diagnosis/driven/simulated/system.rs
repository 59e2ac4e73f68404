//! A proof mass as the engine sees it: sets of laws added to the oscillator, simulated over
//! segments of its recordings, under an input or free.

use std::ops::Range;

use crate::driven::base::{GAIN, OFFSET, OMEGA, OMEGAS_PER_SAMPLE, ZETA, ZETAS};
use crate::driven::simulation::filter::{Keep, Nothing};
use crate::driven::simulation::mover::have_room;
use crate::driven::simulation::run::{Run, innovations};
use crate::driven::simulation::structure::ModelStructure;
use crate::engine::kind::{Argument, Form, Kind, Layout, Linearised, Point};
use crate::physics::end_stop::EndStop;
use crate::physics::free_form::Freed;
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::ringing_mode::RingingMode;
use crate::physics::scales::{Coordinate, Scales};
use crate::physics::state::{LANES, Lanes};

use super::coordinates::{strengths, strong, value, z};
use super::rows::Rows;
use super::space::{self, Member};

/// Step in coordinates for derivatives: small next to any feature, large next to rounding.
const NUDGE: f64 = 1e-5;
/// Coordinate of a strength at which a law joins a model: its first derivative is what counts.
const JOINS: f64 = 1e-3;

/// A recording and the laws that it is held against.
#[derive(Clone)]
pub(in crate::driven) struct System {
    /// Rows, segments and blocks.
    pub rows: Rows,
    /// Sizes that coordinates are measured by.
    pub scales: Scales,
    /// The space of laws.
    pub members: Vec<Member>,
}

impl System {
    /// Terms of a set.
    pub(in crate::driven) fn terms(&self, set: &[usize]) -> Vec<Term> {
        set.iter().map(|law| self.members[*law].term).collect()
    }

    /// The model of a set over all segments.
    pub(in crate::driven) fn structure(&self, set: &[usize]) -> ModelStructure {
        ModelStructure::over(&self.terms(set), self.rows.layout.segments.len() - 1)
    }

    /// Places of the oscillator's shared parameters: the gain where an input drives it, and the offset
    /// where it is not each recording's own.
    pub(in crate::driven) fn oscillator(&self) -> Vec<usize> {
        let all = [GAIN, OMEGA, ZETA, OFFSET];
        let is_shared = |place: &usize| match *place {
            GAIN => self.rows.data.input.is_some(),
            OFFSET => !self.rows.own_offsets,
            _ => true,
        };
        all.into_iter().filter(is_shared).collect()
    }

    /// The oscillator's own parameter among shared values; zero where it is not shared.
    pub(in crate::driven) fn own(&self, place: usize, shared: &[f64]) -> f64 {
        self.oscillator().iter().position(|p| *p == place).map_or(0.0, |i| shared[i])
    }

    fn base_coordinates(&self) -> Vec<Coordinate> {
        let s = &self.scales;
        let of = |place: usize| match place {
            GAIN => Coordinate::Linear(0.1 * s.gain.abs().max(1e-300)),
            OMEGA => Coordinate::Log(OMEGAS_PER_SAMPLE[0] / s.interval_s, OMEGAS_PER_SAMPLE[1] / s.interval_s),
            ZETA => Coordinate::Bounded(s.zeta.max(1e-4), 0.0, ZETAS[1]),
            _ => Coordinate::Linear(0.1 * s.output),
        };
        self.oscillator().into_iter().map(of).collect()
    }

    /// Coordinates of the shared values of a set, Held ones included.
    pub(in crate::driven) fn shared_coordinates(&self, set: &[usize]) -> Vec<Coordinate> {
        let mut all = self.base_coordinates();
        for term in self.terms(set) {
            let own = term.coordinates(&self.scales);
            all.extend_from_slice(&own[..own.len() - term.unknown_beginnings()]);
        }
        all
    }

    /// Coordinates of a segment's start.
    fn start_coordinates(&self, set: &[usize]) -> Vec<Coordinate> {
        let (x, v) = (0.1 * self.scales.output, 0.1 * self.scales.output * self.scales.omega_rad_s);
        let mut all = vec![Coordinate::Linear(x), Coordinate::Linear(v)];
        all.extend(self.rows.own_offsets.then_some(Coordinate::Linear(x)));
        for term in self.terms(set) {
            let own = term.coordinates(&self.scales);
            all.extend_from_slice(&own[own.len() - term.unknown_beginnings()..]);
        }
        all
    }

    /// Values of the shared coordinates of a point.
    pub(in crate::driven) fn shared_values(&self, set: &[usize], point: &Point) -> Vec<f64> {
        self.shared_coordinates(set).iter().zip(&point.shared).map(|(c, z)| value(*c, *z)).collect()
    }

    /// All parameters of the model of a set, in the order of its structure.
    pub(in crate::driven) fn parameters(&self, set: &[usize], point: &Point) -> Vec<f64> {
        let structure = self.structure(set);
        let shared = self.shared_values(set, point);
        let coordinates = self.start_coordinates(set);
        let starts: Vec<Vec<f64>> =
            point.starts.iter().map(|s| coordinates.iter().zip(s).map(|(c, z)| value(*c, *z)).collect()).collect();
        let mut all = vec![0.0; structure.parameters];
        all[GAIN] = 1.0;
        let oscillator = self.oscillator();
        oscillator.iter().zip(&shared).for_each(|(place, value)| all[*place] = *value);
        let offset = all[OFFSET];
        for (segment, start) in starts.iter().enumerate() {
            all[structure.offset(segment)] = if self.rows.own_offsets { start[2] } else { offset };
            all[structure.initial(segment)] = start[0];
            all[structure.initial(segment) + 1] = start[1];
        }
        let (mut next, mut own) = (oscillator.len(), self.beginning());
        for (i, term) in structure.terms.iter().enumerate() {
            let (unknown, first) = (term.unknown_beginnings(), structure.first[i]);
            let known = term.values() - unknown;
            all[first..first + known].copy_from_slice(&shared[next..next + known]);
            for (segment, start) in starts.iter().enumerate() {
                let to = first + known + segment * unknown;
                all[to..to + unknown].copy_from_slice(&start[own..own + unknown]);
            }
            (next, own) = (next + known, own + unknown);
        }
        all
    }

    /// Coordinates of where a segment begins, those of laws apart.
    fn beginning(&self) -> usize {
        2 + usize::from(self.rows.own_offsets)
    }

    /// The point of a set at these parameters, in the order of its structure.
    pub(in crate::driven) fn point(&self, set: &[usize], parameters: &[f64]) -> Point {
        let structure = self.structure(set);
        let known = |i: usize| structure.terms[i].values() - structure.terms[i].unknown_beginnings();
        let mut shared: Vec<f64> = self.oscillator().iter().map(|place| parameters[*place]).collect();
        for (i, first) in structure.first.iter().enumerate() {
            shared.extend_from_slice(&parameters[*first..first + known(i)]);
        }
        let begun = |segment: usize| {
            let initial = structure.initial(segment);
            let mut all = vec![parameters[initial], parameters[initial + 1]];
            all.extend(self.rows.own_offsets.then(|| parameters[structure.offset(segment)]));
            for (i, first) in structure.first.iter().enumerate() {
                let unknown = structure.terms[i].unknown_beginnings();
                let from = first + known(i) + segment * unknown;
                all.extend_from_slice(&parameters[from..from + unknown]);
            }
            all
        };
        let measured = |coordinates: &[Coordinate], values: &[f64]| -> Vec<f64> {
            coordinates.iter().zip(values).map(|(c, v)| z(*c, *v)).collect()
        };
        let coordinates = self.start_coordinates(set);
        let starts = (0..=structure.further).map(|s| measured(&coordinates, &begun(s))).collect();
        Point { shared: measured(&self.shared_coordinates(set), &shared), starts }
    }

    /// Steps per row that a model needs at these parameters.
    pub(in crate::driven) fn steps(&self, structure: &ModelStructure, point: &[f64]) -> usize {
        match self.rows.data.input {
            None => structure.free_steps(point, &self.scales),
            Some(_) => structure.steps(point, &self.scales),
        }
    }

    /// Residual of lane after lane, over all rows.
    fn simulated<S: Keep>(&self, structure: &ModelStructure, points: &[Vec<f64>], keep: &mut S) -> Vec<Vec<f64>> {
        let steps = points.iter().map(|p| self.steps(structure, p)).max().unwrap_or(1);
        let run = Run { range: self.rows.data.hull.clone(), steps, corrected: false };
        let lanes: Vec<Lanes> = innovations(&self.rows.data, structure, points, &run, keep);
        (0..points.len()).map(|l| lanes.iter().map(|e| e[l]).collect()).collect()
    }

    /// Residuals of a point over all rows, keeping what passes.
    pub(in crate::driven) fn traced<S: Keep>(&self, set: &[usize], point: &Point, keep: &mut S) -> Vec<f64> {
        self.simulated(&self.structure(set), &[self.parameters(set, point)], keep).remove(0)
    }

    /// Returns where a law may begin: as its starts state, and where it has no strength there, with
    /// a little of each.
    fn beginnings(&self, term: &Term, scales: &Scales) -> Vec<Vec<f64>> {
        let starts = match term {
            Term::FreeForm(form) => {
                let none = vec![0.0; term.values()];
                match form.law {
                    Freed::Readout => vec![vec![0.0, 0.0, 0.0, 0.3 * self.scales.output]],
                    _ => vec![none],
                }
            }
            _ => term.starts(scales),
        };
        let coordinates = term.coordinates(scales);
        let mut all = Vec::new();
        for start in starts {
            let silent =
                |j: usize| start[j] == 0.0 && matches!(coordinates[j], Coordinate::Linear(_) | Coordinate::Bounded(..));
            let parameters = term.values() - term.unknown_beginnings();
            let strengths: Vec<usize> = if start.get(strengths(term).start) == Some(&0.0) {
                (0..parameters).filter(|j| silent(*j)).collect()
            } else {
                Vec::new()
            };
            let is_product = matches!(term, Term::FreeForm(form) if form.law != Freed::Readout);
            let strengths = if is_product { strengths.into_iter().take(1).collect() } else { strengths };
            if strengths.is_empty() {
                all.push(start);
                continue;
            }
            for j in strengths {
                let mut nudged = start.clone();
                nudged[j] = value(coordinates[j], JOINS);
                all.push(nudged);
            }
        }
        all
    }
}

impl Kind for System {
    fn layout(&self) -> &Layout {
        &self.rows.layout
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

    fn are_alike(&self, law: usize, other: usize) -> bool {
        self.members[law].term.id() == self.members[other].term.id()
    }

    fn joined(&self, set: &[usize], point: &Point, law: usize) -> Vec<Point> {
        let mut larger = set.to_vec();
        larger.push(law);
        let terms = self.terms(&larger);
        let frictions = terms.iter().filter(|t| t.role() == Role::Friction).count();
        if !have_room(&terms) || frictions > 1 {
            return Vec::new();
        }
        let term = self.members[law].term;
        // Modes are alike: the next one joins those that are there.
        let alike =
            |id: &str| set.iter().filter_map(|l| space::place(&self.members[*l].term)).filter(|p| p.0 == id).count();
        if space::place(&term).is_some_and(|(id, place)| place != RingingMode::ANY.0 && place > alike(id)) {
            return Vec::new();
        }
        let coordinates = term.coordinates(&self.scales);
        let known = term.values() - term.unknown_beginnings();
        let joined = |start: Vec<f64>| {
            let own: Vec<f64> = coordinates.iter().zip(&start).map(|(c, v)| z(*c, *v)).collect();
            let mut point = point.clone();
            point.shared.extend_from_slice(&own[..known]);
            point.starts.iter_mut().for_each(|s| s.extend_from_slice(&own[known..]));
            point
        };
        let scales = self.scales_for(&term, set, point);
        self.beginnings(&term, &scales).into_iter().map(joined).collect()
    }

    fn strengthened(&self, set: &[usize], point: &Point, factor: f64) -> Option<Point> {
        let place = set.len().checked_sub(1)?;
        let coordinates = self.shared_coordinates(set);
        let mut point = point.clone();
        for i in strong(&self.members[set[place]].term, self.coordinates(set, place)) {
            match coordinates[i] {
                Coordinate::Log(..) if factor > 0.0 => point.shared[i] += factor.ln(),
                Coordinate::Bounded(_, low, _) if factor < 0.0 && low >= 0.0 => return None,
                Coordinate::Linear(_) | Coordinate::Bounded(..) => point.shared[i] *= factor,
                Coordinate::Log(..) | Coordinate::Held => return None,
            }
        }
        self.confine(set, &mut point);
        Some(point)
    }

    fn without(&self, set: &[usize], point: &Point, place: usize) -> Point {
        let mut reduced = point.clone();
        reduced.shared.drain(self.coordinates(set, place));
        let unknown = |t: &Term| t.unknown_beginnings();
        let terms = self.terms(set);
        let before = self.beginning() + terms[..place].iter().map(unknown).sum::<usize>();
        reduced.starts.iter_mut().for_each(|s| {
            s.drain(before..before + terms[place].unknown_beginnings());
        });
        reduced
    }

    fn residuals(&self, set: &[usize], points: &[Point]) -> Vec<Option<Vec<f64>>> {
        let structure = self.structure(set);
        let all: Vec<Vec<f64>> = points.iter().map(|p| self.parameters(set, p)).collect();
        let columns = all.chunks(LANES).flat_map(|group| self.simulated(&structure, group, &mut Nothing));
        let stands =
            |(c, p): (Vec<f64>, &Point)| (self.stands_alone(set, p) && c.iter().all(|v| v.is_finite())).then_some(c);
        columns.zip(points).map(stands).collect()
    }

    fn linearise(&self, set: &[usize], point: &Point) -> Option<Linearised> {
        let (shared, starts) = (point.shared.len(), point.starts.first().map_or(0, Vec::len));
        let mut points = vec![point.clone()];
        for i in 0..shared {
            let mut moved = point.clone();
            moved.shared[i] += NUDGE;
            points.push(moved);
        }
        for i in 0..starts {
            let mut moved = point.clone();
            moved.starts.iter_mut().for_each(|s| s[i] += NUDGE);
            points.push(moved);
        }
        let held: Vec<bool> = self.shared_coordinates(set).iter().map(|c| *c == Coordinate::Held).collect();
        let mut columns = self.residuals(set, &points).into_iter().collect::<Option<Vec<_>>>()?.into_iter();
        let residual = columns.next()?;
        let mut derivative = |held: bool| -> Option<Vec<f64>> {
            let moved = columns.next()?;
            Some(residual.iter().zip(&moved).map(|(e, m)| if held { 0.0 } else { (e - m) / NUDGE }).collect())
        };
        let shared = held.into_iter().map(&mut derivative).collect::<Option<Vec<_>>>()?;
        let starts = (0..starts).map(|_| derivative(false)).collect::<Option<Vec<_>>>()?;
        Some(Linearised { residual, shared, starts })
    }

    fn confine(&self, set: &[usize], point: &mut Point) {
        let confine = |c: &Coordinate, z: &mut f64| {
            match *c {
                Coordinate::Log(low, high) => *z = z.clamp(low.ln(), high.ln()),
                Coordinate::Bounded(scale, low, high) => *z = z.clamp(low / scale, high / scale),
                Coordinate::Linear(_) | Coordinate::Held => {}
            }
            if !z.is_finite() {
                *z = 0.0;
            }
        };
        self.shared_coordinates(set).iter().zip(&mut point.shared).for_each(|(c, z)| confine(c, z));
        let coordinates = self.start_coordinates(set);
        for start in &mut point.starts {
            coordinates.iter().zip(start).for_each(|(c, z)| confine(c, z));
        }
    }

    fn at_bound(&self, set: &[usize], point: &Point) -> Vec<bool> {
        let coordinates = self.shared_coordinates(set);
        let values = self.shared_values(set, point);
        let on_bound = |(c, v): (&Coordinate, &f64)| match *c {
            Coordinate::Log(low, high) | Coordinate::Bounded(_, low, high) => {
                *v <= low + 0.01 * low.abs() || *v >= high - 0.01 * high.abs()
            }
            Coordinate::Linear(_) | Coordinate::Held => false,
        };
        let mut all: Vec<bool> = coordinates.iter().zip(&values).map(on_bound).collect();
        let terms = self.terms(set);
        let bends =
            |t: &Term| matches!(t, Term::CubicStiffness(_) | Term::QuadraticStiffness(_) | Term::PowerLawStiffness(_));
        for (place, term) in terms.iter().enumerate() {
            let own = self.coordinates(set, place);
            let is_soft =
                matches!(term, Term::EndStop(_)) && EndStop::may_be_a_bend(&values[own.clone()], &self.scales);
            all[own.start] |= is_soft && terms.iter().any(bends);
        }
        all
    }

    fn coordinates(&self, set: &[usize], place: usize) -> Range<usize> {
        let known = |t: &Term| t.values() - t.unknown_beginnings();
        let terms = self.terms(set);
        let first = self.oscillator().len() + terms[..place].iter().map(known).sum::<usize>();
        first..first + known(&terms[place])
    }

    fn strengths(&self, set: &[usize], place: usize) -> Vec<usize> {
        let coordinates = self.shared_coordinates(set);
        let has_zero = |i: &usize| matches!(coordinates[*i], Coordinate::Linear(_) | Coordinate::Bounded(..));
        strong(&self.members[set[place]].term, self.coordinates(set, place)).filter(has_zero).collect()
    }
}
