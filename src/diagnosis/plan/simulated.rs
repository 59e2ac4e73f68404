//! An experiment under one truth, as a diagnosis would see it without noise: what the model without its
//! law leaves, and what the best of each rival leaves.

use crate::control::{Control, Stopped};
use crate::driven::base::{BASE, GAIN, OFFSET, OMEGA, ZETA};
use crate::driven::identification::fit::{Fit, Search, fit};
use crate::driven::identification::refined_scales::refined;
use crate::driven::identification::start::{first_scales, unaligned};
use crate::driven::intake::data::Data;
use crate::driven::intake::input::{Input, Interpolation, REACH};
use crate::driven::intake::observed::Observed;
use crate::driven::intake::stretches::{interleaved, loudest};
use crate::driven::intake::work::Work;
use crate::driven::selection::candidates_round::{round, screen};
use crate::driven::selection::earned::ITERATIONS;
use crate::driven::selection::identifiability::Identifiability;
use crate::driven::selection::judged::{Trial, judge};
use crate::driven::selection::rivals::alike;
use crate::driven::simulation::run::{Run, trace};
use crate::driven::simulation::structure::ModelStructure;
use crate::numerics::least_squares::Residuals;
use crate::parallel;
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::rng::{Philox, Stream};
use crate::trace::Trace;

use super::experiment::Experiment;
use super::limits::Limits;
use super::question::{Known, Sensor};

/// Iterations of the base model on a motion that it nearly follows.
const NEARLY: usize = 6;

/// A truth: the sensor with the laws that it follows.
pub(super) struct Truth<'a> {
    /// The sensor.
    pub sensor: &'a Sensor,
    /// Laws next to the one in question.
    pub common: &'a [Known],
    /// The law in question; none where there is nothing to be found.
    pub own: Option<&'a Known>,
}

/// Sum of squares over the variance of the noise, on the samples that are fitted and on those that judge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    /// On fitted samples.
    pub fitted: f64,
    /// On judging ones.
    pub judging: f64,
}

/// A rival and what the best of it leaves of the truth.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rival {
    /// Id of the law.
    pub id: &'static str,
    /// Number of its values.
    pub values: usize,
    /// Sum of squares that it leaves on fitted samples, over the variance of the noise.
    pub fitted: f64,
}

/// A motion under one truth, and the model without its law.
pub(super) struct Motion {
    data: Data,
    common: Fit,
    scales: Scales,
    variance: f64,
    own: Option<Known>,
}

/// Model of some laws next to a sensor's base.
fn model(sensor: &Sensor, laws: &[&Known]) -> (ModelStructure, Vec<f64>) {
    let terms: Vec<Term> = laws.iter().map(|k| k.term).collect();
    let structure = ModelStructure::new(&terms);
    let mut point = sensor.base.clone();
    laws.iter().for_each(|k| point.extend_from_slice(&k.values));
    (structure, point)
}

/// The recording before anything is read.
fn unread(experiment: &Experiment) -> Data {
    let input = experiment.input();
    let samples = input.len();
    let hull = REACH..samples.saturating_sub(REACH).max(REACH + 1);
    let (train, validation) = interleaved(std::slice::from_ref(&hull));
    Data {
        reading: vec![0.0; samples],
        observed: Observed::default(),
        input: Some(Input::new(input, Interpolation::BandLimited)),
        environment: Vec::new(),
        environments: 0,
        followed: Vec::new(),
        rate_hz: experiment.rate_hz,
        hull,
        breaks: Vec::new(),
        train,
        test: validation.clone(),
        validation,
        own_test: false,
        windows: None,
        clock_s: Vec::new(),
        work: Work::default(),
        trace: Trace::without(&[]),
    }
}

/// Sizes of a motion about which nothing but its sensor is known.
fn sizes(mut scales: Scales, sensor: &Sensor) -> Scales {
    scales.begun(&[sensor.base[GAIN], sensor.base[OMEGA], sensor.base[ZETA]]);
    scales.fineness = 1.0;
    scales
}

/// The readings of a truth without noise, from rest; `None` where the motion runs away.
pub(super) fn readings(truth: &Truth<'_>, experiment: &Experiment) -> Option<Vec<f64>> {
    read(truth, unread(experiment)).map(|data| data.reading)
}

fn read(truth: &Truth<'_>, mut data: Data) -> Option<Data> {
    let passed = |data: &Data, laws: &[&Known], scales: &Scales| -> Option<Vec<f64>> {
        let (structure, point) = model(truth.sensor, laws);
        let run = Run { range: 0..data.reading.len(), steps: structure.steps(&point, scales), corrected: false };
        let (errors, _) = trace(data, &structure, &point, &run);
        errors.iter().all(|e| e.is_finite() && e.abs() < 1e100).then(|| errors.iter().map(|e| -e).collect())
    };
    let without = passed(&data, &[], &Scales { output: 1.0, ..sizes(unaligned(&data), truth.sensor) })?;
    let scales = sizes(unaligned(&Data { reading: without, ..data.clone() }), truth.sensor);
    let laws: Vec<&Known> = truth.common.iter().chain(truth.own).collect();
    data.reading = passed(&data, &laws, &scales)?;
    Some(data)
}

impl Motion {
    /// Simulates it, and fits the model without the law in question; `None` where it runs away or leaves
    /// what the sensor can read.
    pub(super) fn of(truth: &Truth<'_>, experiment: &Experiment, limits: &Limits) -> Option<Self> {
        let sensor = truth.sensor;
        let data = read(truth, unread(experiment))?;
        let largest = data.reading.iter().fold(0.0f64, |a, y| a.max((y - sensor.base[OFFSET]).abs()));
        if limits.largest_reading.is_some_and(|most| largest > most) {
            return None;
        }
        // A long recording is searched on a stretch of it.
        let data = loudest(&data).unwrap_or(data);
        let scales = Scales { fineness: 0.5, ..sizes(first_scales(&data), sensor) };
        let (structure, mut point) = model(sensor, &truth.common.iter().collect::<Vec<_>>());
        point[BASE - 2] = data.reading[data.hull.start] - sensor.base[OFFSET];
        let common = fit(&data, &structure, &point, &scales, NEARLY)?;
        let scales = refined(&data, &common, &scales);
        Some(Self { data, common, scales, variance: sensor.noise.powi(2), own: truth.own.cloned() })
    }

    /// Number of fitted samples.
    pub(super) fn rows(&self) -> f64 {
        self.data.train.iter().map(|r| r.len()).sum::<usize>() as f64
    }

    /// Returns whether the input tells laws apart at all: under one line or two a diagnosis holds every law
    /// against the free forms of the others, and so leaves the question open.
    pub(super) fn tells_apart(&self) -> bool {
        let mut rng = Philox::new(1, 0, Stream::Host);
        let deviation = self.variance.sqrt();
        let reading = self.data.reading.iter().map(|y| y + deviation * rng.normal()).collect();
        let common = Fit { variance: self.common.variance + self.variance, ..self.common.clone() };
        let reach = Identifiability::of(&Data { reading, ..self.data.clone() }, &common);
        reach.few_cycles.is_none() && !reach.tells_nothing_linear_apart()
    }

    /// Returns what the model without the law leaves.
    pub(super) fn without(&self) -> Left {
        let (errors, _) =
            trace(&self.data, &self.common.structure, &self.common.point, &self.common.run(&self.data, false));
        let start = self.data.hull.start;
        let sum = |ranges: &[std::ops::Range<usize>]| {
            let rows = ranges.iter().flat_map(|r| r.clone());
            rows.map(|k| errors[k - start].powi(2)).sum::<f64>() / self.variance
        };
        Left { fitted: sum(&self.data.train), judging: sum(&self.data.validation) }
    }

    /// Returns what one linear step of each of these laws leaves.
    pub(super) fn nearly(&self, laws: &[Known]) -> Vec<Rival> {
        let others = laws.iter().filter(|k| self.own.as_ref().is_none_or(|own| own.term.id() != k.term.id()));
        let stepped = |k: &Known| {
            let promised = screen(&self.data, &self.common, None, k.term, &self.scales);
            let fitted = promised.first()?.0 / self.variance;
            Some(Rival { id: k.term.id(), values: k.term.values(), fitted })
        };
        others.filter_map(stepped).collect()
    }

    /// Returns what the best of every law of the library with such an id leaves, by the search of a diagnosis.
    ///
    /// # Errors
    /// Stopped.
    pub(super) fn best(
        &self,
        is_asked: impl Fn(&'static str) -> bool,
        control: &Control,
    ) -> Result<Vec<Rival>, Stopped> {
        let own = self.own.as_ref().map(|k| k.term.id());
        let has = |t: &Term| self.common.structure.terms.iter().any(|c| c.id() == t.id());
        let open = |t: &Term| {
            let is_law = t.noise().is_none() && t.role() != Role::Lattice;
            is_law && Some(t.id()) != own && !has(t) && is_asked(t.id())
        };
        let laws: Vec<Term> = Term::tried(0, true).into_iter().filter(open).collect();
        let model = judge(&self.data, self.common.clone(), &self.scales);
        // Those that the law can be mistaken for are fitted apart from the others, as a diagnosis does: where
        // there is no noise, what one step of another promises would keep them out.
        let mistaken = |t: &Term| self.own.as_ref().is_some_and(|k| alike(t, &k.term));
        let (near, far): (Vec<Term>, Vec<Term>) = laws.into_iter().partition(mistaken);
        let mut tried = Vec::new();
        for laws in [near, far] {
            tried.extend(round(&self.data, &model, &laws, &self.scales, laws.len(), &control.without_stages())?);
        }
        let rows = self.rows();
        // One that ends at a bound without noise need not with it: it stays a rival.
        let rival = |t: &Trial| {
            let found = &t.judged.as_ref()?.fit;
            let further = || fit(&self.data, &found.structure, &found.point, &self.scales, ITERATIONS);
            let variance = (!found.converged).then(further).flatten().map_or(found.variance, |f| f.variance);
            Some(Rival { id: t.term.id(), values: t.term.values(), fitted: variance * rows / self.variance })
        };
        Ok(parallel::filter_map(&tried, rival))
    }

    /// Half the width of the 95 % interval that the law's first parameter would have.
    pub(super) fn half_width(&self) -> Option<f64> {
        let own = self.own.as_ref()?;
        let (structure, point) = self.common.with(own.term, &own.values);
        let fitted = fit(&self.data, &structure, &point, &self.scales, ITERATIONS)?;
        let search = Search::all(&self.data, &structure, &fitted.point, &self.scales);
        let inverse = search.linearise(&search.z(&fitted.point))?.normal().inverse(1e-9)?;
        let place = structure.first[structure.terms.len() - 1];
        let index = search.free.iter().position(|f| *f == place)?;
        let slope = search.slope(place, &fitted.point).abs();
        Some(1.96 * slope * (self.variance * inverse[(index, index)]).sqrt())
    }

    /// Largest displacement from rest.
    pub(super) fn largest(&self) -> f64 {
        let offset = self.common.point[OFFSET];
        self.data.reading.iter().fold(0.0, |a, y| a.max((y - offset).abs()))
    }

    /// Sizes of the motion.
    pub(super) fn scales(&self) -> &Scales {
        &self.scales
    }

    /// Ids of the laws that a diagnosis would try.
    pub(super) fn tried() -> usize {
        Term::tried(0, true).len()
    }
}
