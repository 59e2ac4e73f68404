//! The CPU backend: lanes × threads. Members in groups of 64 go to the threads; time is cut into
//! tiles so that the table of the excitation stays small and Ctrl-C is heard.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::tile;
use super::{Backend, Batch, Partial, Ran, Unfinished};
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::kernel::cpu::lanes::{LANES, Level};
use crate::kernel::cpu::members::{Members, Shared, Snapshot};
use crate::kernel::cpu::reduce::{self, BLOCK};
use crate::kernel::cpu::simulate::{Seen, Simulate};
use crate::kernel::force;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::Job;
use crate::kernel::member::Column;
use crate::numerics::elementary::Real;
use crate::parallel;
use crate::statistics::{Bins, Histogram, Machine};

/// Precision of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// f32, the twin of the shader.
    #[default]
    F32,
    /// f64, the reference for f32.
    F64,
}

/// The CPU, with one instruction set and one precision.
#[derive(Debug, Clone, Copy)]
pub struct Cpu {
    /// Precision of the lanes: f32 or f64.
    pub precision: Precision,
    /// Instruction set of the kernels.
    pub level: Level,
    /// Most samples per tile.
    pub tile_samples: u64,
    /// Most members per batch.
    pub batch_members: u64,
}

impl Default for Cpu {
    fn default() -> Self {
        Self { precision: Precision::F32, level: Level::best(), tile_samples: 4096, batch_members: 32_768 }
    }
}

/// Member-steps per thread that a batch is to take: some seconds of the full path.
const WORK_PER_THREAD: u64 = 4_000_000_000;
/// Fewest members of a batch, however much work each is: the table of the excitation, which every
/// batch makes anew, then costs a hundredth of the steps (20 ns to 0.4 ns a member).
const FEWEST_MEMBERS: u64 = 4096;

/// Substeps tabulated at a time: 20 bytes each, so that the table stays in the second-level cache.
const MOST_SUBSTEPS: u64 = 16_384;

pub(super) fn machine(precision: Precision, level: Level, integrator: Integrator) -> Machine {
    Machine {
        kind: "cpu".to_owned(),
        name: processor_name(),
        driver: format!("{}, {} threads", level.name(), parallel::threads()),
        precision: if precision == Precision::F32 { f32::NAME } else { f64::NAME }.to_owned(),
        fused_multiply_add: if level.fused() { "yes" } else { "no" }.to_owned(),
        integrator: integrator.to_string(),
    }
}

impl Backend for Cpu {
    fn machine(&self, job: &Job) -> Machine {
        machine(self.precision, self.level, job.integrator)
    }

    fn batch_members(&self, job: &Job) -> Result<u64> {
        let threads = parallel::threads() as u64;
        let work = WORK_PER_THREAD.saturating_mul(threads) / job.steps_per_member().max(1);
        // Not fewer than give every thread its lanes, a few times over.
        let fewest = FEWEST_MEMBERS.max(4 * LANES as u64 * threads);
        Ok(work.max(fewest).min(self.batch_members).next_multiple_of(BLOCK as u64))
    }

    fn run(&mut self, batch: &Batch<'_>) -> Result<Ran> {
        match self.precision {
            Precision::F32 => self.integrate::<f32>(batch),
            Precision::F64 => self.integrate::<f64>(batch),
        }
    }
}

/// 64 members, wherever they are.
type Group<T> = Box<Members<T>>;

/// The 64 members from `first` on, below `end`, ready to integrate.
fn draw<T: Real>(job: &Job, first: u64, end: u64, flicker_terms: usize) -> Result<Group<T>> {
    let mut members = Members::new(job.seed, first..end, flicker_terms, |i| column(job, i))?;
    members.chain(job.chained.as_ref());
    members.tilt(job.level_rad_per_m_s2());
    Ok(members)
}

/// One member, drawn and checked.
///
/// # Errors
/// Its proof mass cannot be stepped by the job's integrator.
pub fn column(job: &Job, index: u64) -> Result<Column> {
    let member = (job.draw)(index);
    job.integrator.check(member.sensor.proof_mass.as_ref(), job.clock.step_s)?;
    let column = Column::of(&member, &job.clock, job.integrator);
    if column.values.iter().all(|v| v.is_finite()) {
        return Ok(column);
    }
    Err(Error::new(
        format!("could not prepare member {index}"),
        "its parameters, in the integrator's units, overflow",
        "check the exponents of the study and its tolerances: a drawn value may be unphysical",
    ))
}

impl Cpu {
    fn integrate<T: Real>(&self, batch: &Batch<'_>) -> Result<Ran> {
        let (job, members) = (batch.job, &batch.members);
        let shared = Shared::<T>::of(job);
        let starts: Vec<u64> = members.clone().step_by(LANES).collect();
        let mut groups = parallel::map(&starts, |first| draw::<T>(job, *first, members.end, shared.flicker.len()))
            .into_iter()
            .collect::<Result<Vec<Group<T>>>>()?;
        let sample_s = job.clock.sample_s();
        let size = members.end - members.start;
        let mut partials = Vec::with_capacity(job.clock.report_samples.len());
        let mut from = 0;
        if let Some(before) = batch.resume.filter(|before| before.members == *members)
            && set_state(&mut groups, &before.state)
        {
            from = before.samples;
            partials.clone_from(&before.partials);
        }
        let samples = self.tiles(job, &shared, &mut groups, from, batch.stop, |tile, groups| {
            (batch.progress)((tile.samples.end - tile.samples.start) * size);
            if let Some(report) = tile.report {
                let bins = batch.bins.get(report);
                partials.push(partial(groups, size as usize, tile.samples.end, sample_s, bins));
            }
        });
        if samples == job.clock.samples {
            return Ok(Ran::Whole(partials));
        }
        Ok(Ran::Part(Unfinished { members: members.clone(), samples, partials, state: state(&mut groups) }))
    }

    /// Takes the groups through the run, tile by tile from sample `from` on, until its end or until
    /// a tile after which it is asked to `stop`; returns the samples done.
    fn tiles<T: Real>(
        &self,
        job: &Job,
        shared: &Shared<T>,
        groups: &mut [Group<T>],
        mut from: u64,
        stop: &(dyn Fn() -> bool + Sync),
        mut after: impl FnMut(&tile::Tile, &[Group<T>]),
    ) -> u64 {
        let most = self.tile_samples.min(MOST_SUBSTEPS / u64::from(shared.substeps)).max(4);
        while let Some(tile) = tile::next(&job.clock, from, most) {
            let count = tile.samples.end - from;
            let (table, warmer) = (force::table::<T>(job, from, count), job.warmer_k::<T>(from, count));
            let late = force::late::<T>(job, from, count);
            parallel::for_each_mut(groups, |_, members| {
                let (force, warmer, late) = (&table[..], &warmer[..], &late[..]);
                Simulate { shared, members, force, warmer, late, first: from, count, observer: None }.run(self.level);
            });
            from = tile.samples.end;
            after(&tile, groups);
            if stop() {
                break;
            }
        }
        from
    }
}

/// All numbers of the groups that tiles change, eight bytes each.
fn state<T: Real>(groups: &mut [Group<T>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for group in groups {
        group.exchange(&mut |v| {
            bytes.extend_from_slice(&v.to_le_bytes());
            v
        });
    }
    bytes
}

/// Sets them; `false` where they are not as many as these groups have, which then stay as they are.
fn set_state<T: Real>(groups: &mut [Group<T>], bytes: &[u8]) -> bool {
    let mut count = 0;
    for group in &mut *groups {
        group.exchange(&mut |v| {
            count += 1;
            v
        });
    }
    let (numbers, rest) = bytes.as_chunks::<8>();
    if numbers.len() != count || !rest.is_empty() {
        return false;
    }
    let mut numbers = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes));
    for group in groups {
        group.exchange(&mut |v| numbers.next().unwrap_or(v));
    }
    true
}

/// Sums up all groups at a report time.
fn partial<T: Real>(
    groups: &[Group<T>],
    members: usize,
    samples: u64,
    sample_s: f64,
    bins: Option<&[Bins; 4]>,
) -> Partial {
    let empty = || bins.map(|b| b.map(Histogram::new));
    // Counting is by threads in stretches of blocks; counts are integers, so their order is free.
    let stretch = 16;
    let parts: Vec<Partial> = parallel::map_chunks(groups, stretch * BLOCK / LANES, |i, groups| {
        let mut part = Partial::default();
        let mut histograms = empty();
        for (j, block) in groups.chunks(BLOCK / LANES).enumerate() {
            let size = (members - (i * stretch + j) * BLOCK).min(BLOCK);
            let snapshots: Vec<Snapshot> = block.iter().map(|m| m.snapshot(samples, sample_s)).collect();
            let moments = reduce::moments(&snapshots, size);
            part.failed += size as u64 - moments[0].count;
            part.blocks.push(moments);
            if let Some(histograms) = &mut histograms {
                reduce::count(&snapshots, size, histograms);
            }
        }
        part.histograms = histograms.map_or_else(Vec::new, Vec::from);
        part
    });
    let mut whole = Partial { histograms: empty().map_or_else(Vec::new, Vec::from), ..Partial::default() };
    for part in parts {
        whole.failed += part.failed;
        whole.blocks.extend(part.blocks);
        for (mine, theirs) in whole.histograms.iter_mut().zip(&part.histograms) {
            mine.merge(&theirs.counts);
        }
    }
    whole
}

/// The four errors of every member at the end of a run that fits the memory, for comparisons member
/// by member.
///
/// # Errors
/// A member that the integrator cannot step; stopped.
pub fn outcomes<T: Real>(job: &Job, control: &Control) -> Result<Vec<[f64; 4]>> {
    outcomes_at::<T>(job, 0..job.members, job.clock.samples, control)
}

/// The four errors of some members, which begin at a multiple of 256, after `samples`: a report
/// time of the job, or its end. Members that have failed by then are NaN. The members must fit the
/// memory together.
///
/// # Errors
/// A member that the integrator cannot step; stopped.
pub fn outcomes_at<T: Real>(job: &Job, range: Range<u64>, samples: u64, control: &Control) -> Result<Vec<[f64; 4]>> {
    let shared = Shared::<T>::of(job);
    let starts: Vec<u64> = range.clone().step_by(LANES).collect();
    let mut groups = parallel::map(&starts, |first| draw::<T>(job, *first, range.end, shared.flicker.len()))
        .into_iter()
        .collect::<Result<Vec<Group<T>>>>()?;
    let cpu = Cpu::default();
    let reached = AtomicU64::new(0);
    let stop = || control.cancelled() || reached.load(Ordering::Relaxed) >= samples;
    let after = |tile: &tile::Tile, _: &[Group<T>]| reached.store(tile.samples.end, Ordering::Relaxed);
    if cpu.tiles(job, &shared, &mut groups, 0, &stop, after) < samples {
        control.go_on().map_err(stopped)?;
    }
    let sample_s = job.clock.sample_s();
    let all = groups.iter().flat_map(|group| {
        let s = group.snapshot(samples, sample_s);
        (0..LANES).map(move |l| if s.failed[l] { [f64::NAN; 4] } else { std::array::from_fn(|q| s.values[q][l]) })
    });
    Ok(all.take((range.end - range.start) as usize).collect())
}

/// Readings of 64 members, from the multiple of 64 at or below `member` on, sample by sample.
///
/// # Errors
/// A member that the integrator cannot step; stopped.
pub fn readings<T: Real>(job: &Job, member: u64, control: &Control, mut sink: impl FnMut(&Seen<'_, T>)) -> Result<()> {
    let first = member / LANES as u64 * LANES as u64;
    let shared = Shared::<T>::of(job);
    let mut members = draw::<T>(job, first, job.members.max(first + 1), shared.flicker.len())?;
    let mut from = 0;
    let most = (MOST_SUBSTEPS / u64::from(shared.substeps)).max(4);
    while let Some(tile) = tile::next(&job.clock, from, most) {
        control.go_on().map_err(stopped)?;
        let count = tile.samples.end - from;
        let force = force::table::<T>(job, from, count);
        let work = Simulate {
            shared: &shared,
            members: &mut members,
            force: &force,
            warmer: &job.warmer_k::<T>(from, count),
            late: &force::late::<T>(job, from, count),
            first: from,
            count,
            observer: Some(&mut sink),
        };
        work.run(Level::best());
        from = tile.samples.end;
    }
    Ok(())
}

fn stopped(stopped: Stopped) -> Error {
    stopped.during("could not finish the simulation", "run it again")
}

/// The processor's name, as the system gives it.
pub fn processor_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name =
        info.lines().find_map(|l| l.strip_prefix("model name")?.split_once(": ").map(|(_, n)| n.trim().to_owned()));
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}
