//! The members of a batch as the kernel reads them, and which parts of the kernel they need: the
//! rest is compiled away.
//!
//! Members are drawn a chunk at a time and kept as the 32-bit numbers that the device takes: a
//! million of them in double precision are a gigabyte, which every pass over them would move.

use std::ops::Range;

use bytemuck::cast_slice;

use super::super::{Buffer, Gpu};
use crate::backend::cpu::column;
use crate::error::{Error, Result};
use crate::kernel::integrator::Capability;
use crate::kernel::job::Job;
use crate::kernel::low_pass::WEIGHTS;
use crate::kernel::member::{COLUMNS, Column, NOTHING, WAVES, column};
use crate::kernel::places::Places;
use crate::kernel::source;
use crate::parallel;
use crate::physics::coefficients::{self, StudyLaw};
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{Sense, SensorTerm};

/// Members of the whole job that are asked which parts of the kernel it needs.
const ASKED: u64 = 256;
/// Members of a chunk: few enough for a core's own cache, many enough to be worth a turn, and no
/// power of two, so that the numbers of a member do not all fall on the same lines of that cache.
const CHUNK: u64 = 1000;
/// Whole numbers of a member: phases and steps of its excitation and of the sinusoids of its readings.
const TURNS: usize = 2 + WAVES;

/// A batch of members.
pub(super) struct Drawn {
    chunks: Vec<Chunk>,
    numbers: Vec<Number<'static>>,
    present: Present,
}

/// Some members, number by number: of those that all have alike one is kept.
struct Chunk {
    members: usize,
    /// Real numbers, then whole ones, by their bits.
    columns: Vec<Stretch>,
    kept: Vec<u32>,
}

/// A number of the members of a chunk.
#[derive(Clone, Copy)]
enum Stretch {
    /// The same for all.
    Same(u32),
    /// Those kept from here on.
    Each(usize),
}

/// Says which numbers are not what a member has that lacks them, in some member.
#[derive(Clone)]
struct Present {
    values: [bool; COLUMNS],
    laws: [bool; coefficients::MOST],
}

impl Drawn {
    /// Draws members of a job, and asks some from all over it which numbers they have, so that every
    /// batch of a job runs the same kernel: two compilations may round differently.
    ///
    /// # Errors
    /// A member that the job's integrator cannot step; it was asked to stop.
    pub(super) fn of(job: &Job, members: Range<u64>, stop: &(dyn Fn() -> bool + Sync)) -> Result<Self> {
        let mut present = Present { values: [false; COLUMNS], laws: [false; coefficients::MOST] };
        let asked = job.members.min(ASKED);
        for i in 0..asked {
            present.note(&column(job, i * (job.members / asked))?);
        }
        let numbers = numbers(job);
        let starts: Vec<u64> = members.clone().step_by(CHUNK as usize).collect();
        let draw = |first: &u64| {
            if stop() {
                return Err(Error::new("could not draw the members", "it was stopped", "run it again"));
            }
            let mut present = present.clone();
            Chunk::of(job, *first..members.end.min(first + CHUNK), &numbers, &mut present).map(|chunk| (chunk, present))
        };
        let drawn = parallel::map(&starts, draw).into_iter().collect::<Result<Vec<_>>>()?;
        drawn.iter().for_each(|(_, of_chunk)| present.add(of_chunk));
        Ok(Self { chunks: drawn.into_iter().map(|(chunk, _)| chunk).collect(), numbers, present })
    }

    /// The parts of the kernel that the job needs, as its constants.
    pub(super) fn constants(&self, job: &Job) -> Vec<(String, f64)> {
        let some = |wanted: &dyn Fn(SensorTerm) -> bool| SensorTerm::ALL.into_iter().any(|t| wanted(t) && self.has(t));
        let flag = |on: bool| f64::from(u8::from(on));
        let reading = |t: SensorTerm| matches!(t.law(), ErrorLaw::Proportional(_));
        let mut constants = vec![
            ("INTEGRATOR".to_owned(), job.integrator.method().code() as f64),
            ("SUBSTEPS".to_owned(), job.steps_per_sample() as f64),
            ("HAS_FORCE".to_owned(), flag(self.present.values[column::FORCE])),
            ("HAS_SINE".to_owned(), flag(self.present.values[column::SINE])),
            ("HAS_GYRO".to_owned(), flag(some(&|t| t.sense() == Sense::Gyro))),
            ("HAS_READING".to_owned(), flag(some(&reading))),
            ("HAS_STILL".to_owned(), flag(job.clock.still_samples > 0)),
        ];
        constants.extend(SensorTerm::ALL.map(|term| (source::terms::switch(term), flag(self.has(term)))));
        constants
    }

    /// The columns of their numbers on the device.
    pub(super) fn places(&self) -> Places {
        Places::of(&self.present.values)
    }

    /// Returns whether some member has this term.
    pub(super) fn has(&self, term: SensorTerm) -> bool {
        self.present.values[column::of(term)]
    }

    /// The laws that some member follows.
    pub(super) fn laws(&self) -> Vec<StudyLaw> {
        coefficients::laws().iter().filter(|law| self.present.laws[law.first]).copied().collect()
    }

    /// Sends the numbers that the kernel reads at these places, and behind them those of these laws: one
    /// column each, `stride` members long.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn send_numbers(&self, gpu: &Gpu, laws: &[StudyLaw], places: &Places, stride: u64) -> Result<Buffer> {
        let weights = if self.has(SensorTerm::ReadoutLowPass) { WEIGHTS } else { 0 };
        let place = |number: Number<'_>| self.numbers.iter().position(|n| *n == number);
        let columns: Vec<usize> = wanted(places.shown(), laws, weights).into_iter().filter_map(place).collect();
        gpu.upload_columns(4 * stride, columns.len(), &|k, take| self.column(columns[k], take))
    }

    /// Sends their whole numbers in the same way.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn send_turns(&self, gpu: &Gpu, stride: u64) -> Result<Buffer> {
        gpu.upload_columns(4 * stride, TURNS, &|k, take| self.column(self.numbers.len() + k, take))
    }

    fn column(&self, place: usize, take: &mut dyn FnMut(&[u8])) {
        for chunk in &self.chunks {
            match chunk.columns[place] {
                Stretch::Same(bits) => take(cast_slice(&vec![bits; chunk.members])),
                Stretch::Each(begin) => take(cast_slice(&chunk.kept[begin..begin + chunk.members])),
            }
        }
    }
}

impl Chunk {
    fn of(job: &Job, members: Range<u64>, numbers: &[Number<'_>], present: &mut Present) -> Result<Self> {
        let count = (members.end - members.start) as usize;
        let mut all = vec![0; (numbers.len() + TURNS) * count];
        for (i, member) in members.enumerate() {
            let drawn = column(job, member)?;
            present.note(&drawn);
            let mut place = i;
            let mut put = |bits: u32| {
                all[place] = bits;
                place += count;
            };
            drawn.values.iter().for_each(|value| put((*value as f32).to_bits()));
            numbers[COLUMNS..].iter().for_each(|number| put((number.of(&drawn) as f32).to_bits()));
            drawn.turns.iter().chain(&drawn.waves).for_each(|turn| put(*turn));
        }
        let mut kept = Vec::new();
        let stretch = |column: &[u32]| {
            let first = column[0];
            if column.iter().all(|bits| *bits == first) {
                return Stretch::Same(first);
            }
            kept.extend_from_slice(column);
            Stretch::Each(kept.len() - count)
        };
        let columns = all.chunks_exact(count).map(stretch).collect();
        Ok(Self { members: count, columns, kept })
    }
}

impl Present {
    fn note(&mut self, column: &Column) {
        let values = self.values.iter_mut().zip(&column.values).zip(&NOTHING);
        values.for_each(|((present, value), nothing)| *present |= value != nothing);
        self.laws.iter_mut().zip(&column.laws).for_each(|(present, value)| *present |= *value != 0.0);
    }

    fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(other.values).for_each(|(a, b)| *a |= b);
        self.laws.iter_mut().zip(other.laws).for_each(|(a, b)| *a |= b);
    }
}

/// Place of a number of a member on the host.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number<'a> {
    Value(usize),
    /// Among the numbers of its laws.
    Law(source::laws::Number<'a>),
    /// Among the weights of its low-pass.
    LowPass(usize),
}

/// All that members of a job can have.
fn numbers(job: &Job) -> Vec<Number<'static>> {
    let takes_laws = job.integrator.method().reach == Capability::General;
    let laws = if takes_laws { coefficients::laws() } else { &[] };
    wanted(Places::all().shown(), laws, WEIGHTS)
}

/// These numbers of members that follow these laws, in the order of their columns.
fn wanted<'a>(values: &[usize], laws: &'a [StudyLaw], weights: usize) -> Vec<Number<'a>> {
    let of_laws = source::laws::columns(laws).into_iter().map(Number::Law);
    values.iter().map(|place| Number::Value(*place)).chain(of_laws).chain((0..weights).map(Number::LowPass)).collect()
}

impl Number<'_> {
    fn of(self, column: &Column) -> f64 {
        match self {
            Self::Value(place) => column.values[place],
            Self::Law(number) => number.of(column),
            Self::LowPass(place) => column.low_pass[place],
        }
    }
}
