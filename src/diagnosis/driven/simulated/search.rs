//! Searches a recording under an input with the engine: the laws that it follows besides its base
//! model, and what laws that others have named are worth in free simulation.

use std::f64::consts::TAU;

use crate::driven::base::{BASE, GAIN, OFFSET, OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::intake::reading_noise::{Sample, reading_noise};
use crate::driven::simulation::run::trace;
use crate::driven::simulation::structure::ModelStructure;
use crate::engine::evidence::Gain;
use crate::engine::fit::Fitted;
use crate::engine::kind::{Form, Point, Set};
use crate::engine::names::{self, Dependence, Found};
use crate::engine::search::Search;
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::space::Member;
use super::system::System;
use super::{space, under_input};

/// A recording with all laws that it is held against.
pub(in crate::driven) struct Simulated {
    /// The recording and its laws.
    pub system: System,
    /// Variance of the noise of a reading.
    pub variance: f64,
    /// The base model.
    base: Point,
}

/// A model's laws in free simulation.
#[derive(Debug, Clone, Default)]
pub(in crate::driven) struct Worth {
    /// Gain of each law over the model without it, by its place in the model; those of noise have
    /// none.
    pub each: Vec<(usize, Gain)>,
    /// Gain of all of them over the base model.
    pub together: Option<Gain>,
    /// Dependences of the rest, the largest share first.
    pub rest: Vec<Dependence>,
}

impl Simulated {
    /// A recording with its base model and these laws next to those that it is tried against;
    /// `None` where its noise cannot be measured.
    pub(in crate::driven) fn of(data: &Data, base: &Fit, further: &[Term], scales: &Scales) -> Option<Self> {
        let noise = reading_noise(&Sample::of(data))?;
        // What rounding adds is not smoothed away below a thousandth of the motion.
        let variance = noise.deviation.max(1e-6 * scales.output).powi(2);
        let rows = under_input::rows(data, TAU / (base.point[OMEGA] * data.interval_s()), None);
        let mut members = space::members(data.environments, data.input.is_some(), scales);
        // Under an input a line is part of the noise, which is named after the search.
        members.retain(|m| data.input.is_none() || !matches!(m.term, Term::PeriodicDisturbance(_)));
        for term in further {
            if members.iter().all(|m| m.term != *term) {
                members.push(Member { term: *term, form: Form::Stated });
            }
        }
        let system = System { rows, scales: scales.clone(), members };
        let base = begun(&system, data, base, &[]);
        Some(Self { system, variance, base })
    }

    /// Returns what the engine finds; `None` where no free simulation of the base model comes to
    /// rest.
    pub(in crate::driven) fn search(&self) -> Option<Found> {
        let (search, base) = Search::begin(&self.system, self.variance, &self.base)?;
        Some(names::names(&search, base, None))
    }

    /// Returns what the laws at these places of a model are worth, with what the rest depends on
    /// where that is asked; `None` where no free simulation of it comes to rest.
    pub(in crate::driven) fn worth(&self, data: &Data, model: &Fit, places: &[usize], rest: bool) -> Option<Worth> {
        let (search, base) = Search::begin(&self.system, self.variance, &self.base)?;
        let terms = &model.structure.terms;
        let places: Vec<usize> = places.iter().copied().filter(|i| terms[*i].noise().is_none()).collect();
        let member = |i: &usize| self.system.members.iter().position(|m| m.term == terms[*i]);
        let set: Set = places.iter().map(member).collect::<Option<_>>()?;
        let model = search.at(&set, &begun(&self.system, data, model, &places))?;
        let gain =
            |(place, i): (usize, &usize)| Some((*i, search.gain(search.without(&model, place)?.as_ref(), &model)));
        Some(Worth {
            each: places.iter().enumerate().filter_map(gain).collect(),
            together: (!set.is_empty()).then(|| search.gain(&base, &model)),
            rest: if rest { names::dependences(&search, &model) } else { Vec::new() },
        })
    }

    /// The model of a fitted set in the order that fits know, to be fitted on from there: it begins as
    /// the base model does.
    pub(in crate::driven) fn model(&self, fitted: &Fitted, base: &Fit) -> (ModelStructure, Vec<f64>) {
        let (own, parameters) =
            (self.system.structure(&fitted.set), self.system.parameters(&fitted.set, &fitted.point));
        let structure = ModelStructure::over(&self.system.terms(&fitted.set), base.structure.further);
        let mut point = base.point.clone();
        point.resize(structure.parameters, 0.0);
        [GAIN, OMEGA, ZETA].into_iter().for_each(|i| point[i] = parameters[i]);
        for (i, term) in structure.terms.iter().enumerate() {
            let known = term.values() - term.unknown_beginnings();
            let from = own.first[i];
            point[structure.first[i]..structure.first[i] + known].copy_from_slice(&parameters[from..from + known]);
        }
        (structure, point)
    }
}

/// A model over all segments with its laws at these places: each segment begins where the model passes
/// through.
fn begun(system: &System, data: &Data, model: &Fit, places: &[usize]) -> Point {
    let terms: Vec<Term> = places.iter().map(|i| model.structure.terms[*i]).collect();
    let structure = ModelStructure::over(&terms, system.rows.layout.segments.len() - 1);
    let (_, passed) = trace(data, &model.structure, &model.point, &model.run(data, true));
    let recordings = data.recordings();
    let mut all = vec![0.0; structure.parameters];
    all[..BASE].copy_from_slice(&model.point[..BASE]);
    for (segment, rows) in system.rows.layout.segments.iter().enumerate() {
        let row = system.rows.at[rows.start];
        let recording = recordings.iter().position(|r| r.contains(&row)).unwrap_or(0);
        let state = match &data.windows {
            Some(windows) => {
                let [level, slope] = windows.state(row);
                [level - model.point[OFFSET], slope]
            }
            None => [passed.x[row - data.hull.start], passed.v[row - data.hull.start]],
        };
        all[structure.offset(segment)] = model.point[model.structure.offset(recording)];
        let initial = structure.initial(segment);
        all[initial..initial + 2].copy_from_slice(&state);
    }
    let is_whole = structure.further == model.structure.further;
    for (i, place) in places.iter().enumerate() {
        let values = &model.point[model.structure.block(*place)];
        let known = if is_whole { values.len() } else { terms[i].values() - terms[i].unknown_beginnings() };
        all[structure.first[i]..structure.first[i] + known].copy_from_slice(&values[..known]);
    }
    let member = |t: &Term| system.members.iter().position(|m| m.term == *t);
    let set: Set = terms.iter().filter_map(member).collect();
    system.point(&set, &all)
}
