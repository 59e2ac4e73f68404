//! Ensembles on a device: tiles of members × steps, state kept there between tiles, only sums read
//! back.
//!
//! Submissions are kept near 80 ms, so that no driver loses patience and Ctrl-C is heard; the next
//! one is prepared while the device works on the last.
//!
//! Nothing is read between them, so there is no read-back to overlap: sums stay on the device until
//! a batch ends or is asked to stop, 96 bytes for 256 members and a report, 6 MB for sixteen
//! reports of a million members.

mod ahead;
mod drawn;
mod tables;

use std::sync::Arc;

use bytemuck::{Zeroable, cast_slice};

use self::ahead::Ahead;
use self::drawn::Drawn;
use super::pace::Pace;
use super::{Buffer, Dispatch, Gpu, Kernel, Piece, Submission};
use crate::backend::{Backend, Batch, Partial, Ran, Unfinished, tile};
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::kernel::layout::{self, BLOCK, SIMULATE_WORKGROUP, state};
use crate::kernel::low_pass::WEIGHTS;
use crate::kernel::member::{COLUMNS, flicker_amplitudes};
use crate::kernel::source;
use crate::parallel;
use crate::physics::coefficients;
use crate::sensor::SensorTerm;
use crate::sensor::error_law::ErrorLaw;
use crate::statistics::histogram::BINS;
use crate::statistics::{Bins, Histogram, Machine, Moments};
use tables::{forces, per_sample};

/// Pieces that the kernel reads of a tile: the tile, its forces, and what is known of each sample.
pub(super) const PIECES: usize = 3;

/// Substeps tabulated at a time; the entry before the first holds where it begins.
const MOST_SUBSTEPS: u64 = layout::FORCES as u64 - 1;
/// Most samples per submission, so that Ctrl-C is heard whatever a clock said.
const MOST_SAMPLES: u64 = 1 << 20;
/// Members of a batch on hardware: enough to fill the largest cards several times over.
const MOST_MEMBERS: u64 = 1 << 20;
/// Members of a batch on a software adapter, so that its state stays in the cache.
const MOST_MEMBERS_SOFTWARE: u64 = 1 << 15;

/// Member-steps that a batch is to take: some seconds on a large card, half a minute on a small
/// one, whose batch is then kept half-way.
const WORK: u64 = 200_000_000_000;
/// The same on a software adapter.
const WORK_SOFTWARE: u64 = 2_000_000_000;
/// Fewest members of a batch, however much work each is: about as many as the largest cards have in
/// flight.
const FEWEST_MEMBERS: u64 = 1 << 16;
/// The same on a software adapter.
const FEWEST_MEMBERS_SOFTWARE: u64 = 1 << 12;

/// Ensembles on a GPU.
pub struct Ensembles {
    gpu: Arc<Gpu>,
    /// Most samples per tile.
    pub tile_samples: u64,
    ahead: Option<Ahead>,
}

impl Ensembles {
    /// On an open device.
    pub fn on(gpu: Arc<Gpu>) -> Self {
        Self { gpu, tile_samples: MOST_SUBSTEPS, ahead: None }
    }
}

impl Backend for Ensembles {
    fn machine(&self, job: &Job) -> Machine {
        self.gpu.machine(job.integrator)
    }

    fn batch_members(&self, job: &Job) -> Result<u64> {
        let substeps = job.steps_per_sample();
        if substeps > MOST_SUBSTEPS {
            let cause = format!("a sample has {substeps} substeps, and its table of forces {MOST_SUBSTEPS}");
            return Err(Error::new("could not simulate on the GPU", cause, "use --backend cpu, or a longer step_s"));
        }
        let terms = flicker_amplitudes(&job.clock).len();
        // Two sets of flicker terms at most; moments of every report stay on the device until the
        // end.
        let (of_laws, own_states) = (source::laws::columns(coefficients::laws()).len(), coefficients::own_states());
        let widest = 4 * ((COLUMNS + of_laws + WEIGHTS).max(state::TERMS + own_states + 2 * terms) as u64);
        let moments = (job.clock.report_samples.len() * 4 * size_of::<layout::Partial>()) as u64;
        let room = self.gpu.adapter.largest_binding;
        let counts = (job.clock.report_samples.len() * 4 * (BINS + 2) * 4) as u64;
        let fits = (room / widest).min(room / moments.max(1) * u64::from(BLOCK)) & !u64::from(BLOCK - 1);
        if fits == 0 || counts > room {
            return Err(Error::new(
                "could not simulate on the GPU",
                format!(
                    "{} report times do not fit its largest buffer of {} MB",
                    job.clock.report_samples.len(),
                    room >> 20
                ),
                "give fewer report times, or use --backend cpu",
            ));
        }
        let [work, fewest, most] = match self.gpu.adapter.hardware {
            true => [WORK, FEWEST_MEMBERS, MOST_MEMBERS],
            false => [WORK_SOFTWARE, FEWEST_MEMBERS_SOFTWARE, MOST_MEMBERS_SOFTWARE],
        };
        let by_work = (work / job.steps_per_member().max(1)).next_multiple_of(u64::from(BLOCK));
        Ok(by_work.clamp(fewest, most).min(fits))
    }

    fn run(&mut self, batch: &Batch<'_>) -> Result<Ran> {
        let job = batch.job;
        let drawn = self.ahead.take().and_then(|ahead| ahead.taken(job, &batch.members));
        let drawn = drawn.map_or_else(|| Drawn::of(job, batch.members.clone(), &|| false), Ok)?;
        let mut plan = Plan::sent(&self.gpu, batch, &drawn, false)?;
        drop(drawn);
        let before = plan.resumed(&self.gpu, batch)?;
        let from = before.map_or(0, |before| before.samples);
        // A software adapter needs the processor itself.
        let ahead = || if self.gpu.adapter.hardware { Ahead::after(job, &batch.members, batch.stop) } else { None };
        let integrate = || plan.integrate(&self.gpu, batch, from, self.tile_samples);
        let (samples, ahead) = parallel::join(integrate, ahead);
        let samples = samples?;
        self.ahead = ahead;
        let mut partials = before.map_or_else(Vec::new, |before| before.partials.clone());
        partials.extend(plan.partials(&self.gpu, batch)?.into_iter().skip(partials.len()));
        if samples == batch.job.clock.samples {
            return Ok(Ran::Whole(partials));
        }
        partials.truncate(batch.job.clock.report_samples.iter().filter(|&&r| r <= samples).count());
        let state = self.gpu.read(&plan.state, plan.state_bytes)?;
        Ok(Ran::Part(Unfinished { members: batch.members.clone(), samples, partials, state }))
    }

    fn has_failed(&self) -> bool {
        self.gpu.has_failed()
    }
}

/// A batch on the device.
pub(super) struct Plan {
    pub members: u32,
    pub stride: u32,
    pub simulate: Kernel,
    reduce: Kernel,
    pub tile: layout::Tile,
    pub columns: Buffer,
    pub turns: Buffer,
    pub state: Buffer,
    state_bytes: u64,
    pub errors: Buffer,
    bins: Buffer,
    partials: Buffer,
    counts: Buffer,
}

impl Plan {
    /// Members drawn and sent; `traced`: every reading's errors are written as well.
    pub(super) fn new(gpu: &Gpu, batch: &Batch<'_>, traced: bool) -> Result<Self> {
        Self::sent(gpu, batch, &Drawn::of(batch.job, batch.members.clone(), &|| false)?, traced)
    }

    /// The members of the batch, which are drawn, sent.
    fn sent(gpu: &Gpu, batch: &Batch<'_>, drawn: &Drawn, traced: bool) -> Result<Self> {
        let job = batch.job;
        let members = batch.members.end - batch.members.start;
        let stride = members.next_multiple_of(u64::from(BLOCK));
        let (laws, places, constants) = (drawn.laws(), drawn.places(), drawn.constants(job));
        let own_states: usize = laws.iter().map(|law| law.term.states()).sum();
        let named: Vec<(&str, f64)> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let amplitudes = flicker_amplitudes(&job.clock);
        let sample_s = job.clock.sample_s();
        let mut flicker = [0.0; 16];
        flicker.iter_mut().zip(&amplitudes).for_each(|(f, a)| *f = *a as f32);
        let tile = layout::Tile {
            seed: [job.seed as u32, (job.seed >> 32) as u32],
            first_member: [batch.members.start as u32, (batch.members.start >> 32) as u32],
            members: members as u32,
            stride: stride as u32,
            first_sample: 0,
            samples: 0,
            flicker_terms: amplitudes.len() as u32,
            tilt_gain: (job.gravity_m_s2 * sample_s) as f32,
            sample_s: sample_s as f32,
            zero: 0,
            still_samples: job.clock.still_samples as u32,
            still_share: job.clock.still_share() as f32,
            level: job.level_rad_per_m_s2() as f32,
            padding: 0,
            flicker,
        };
        let flickers = SensorTerm::ALL.into_iter().filter(|term| matches!(term.law(), ErrorLaw::Flicker(_)));
        let sets = flickers.filter(|term| drawn.has(*term)).count();
        let reports = job.clock.report_samples.len() as u64;
        let mut bins: Vec<layout::Bins> =
            batch.bins.iter().flatten().map(|b| layout::Bins { begin: b.from, per_unit: b.per_unit }).collect();
        bins.resize(reports as usize * 4, layout::Bins::zeroed());
        let blocks = stride / u64::from(BLOCK);
        let shader = if traced { source::simulate_traced } else { source::simulate };
        let state_bytes = 4 * stride * (state::TERMS + own_states + sets * amplitudes.len()) as u64;
        Ok(Self {
            members: members as u32,
            stride: stride as u32,
            simulate: gpu.kernel(&shader(gpu.adapter.int64, &laws, &places), &named)?,
            reduce: gpu.kernel(&source::reduce(), &[])?,
            tile,
            columns: drawn.send_numbers(gpu, &laws, &places, stride)?,
            turns: drawn.send_turns(gpu, stride)?,
            state: gpu.zeros(state_bytes)?,
            state_bytes,
            errors: gpu.zeros(4 * stride * 5)?,
            bins: gpu.upload(cast_slice(&bins))?,
            partials: gpu.zeros(reports * blocks * 4 * size_of::<layout::Partial>() as u64)?,
            counts: gpu.zeros(if batch.bins.is_empty() { 4 } else { reports * 4 * 4 * (BINS as u64 + 2) })?,
        })
    }

    /// Sets the members to where the batch was stopped, if it was, on this kind of device.
    fn resumed<'a>(&mut self, gpu: &Gpu, batch: &Batch<'a>) -> Result<Option<&'a Unfinished>> {
        let fits =
            |before: &&Unfinished| before.members == batch.members && before.state.len() as u64 == self.state_bytes;
        let before = batch.resume.filter(fits);
        if let Some(before) = before {
            self.state = gpu.upload(&before.state)?;
        }
        Ok(before)
    }

    /// All tiles from sample `from` on, or until it is asked to stop; returns the samples done.
    fn integrate(&self, gpu: &Gpu, batch: &Batch<'_>, mut from: u64, most: u64) -> Result<u64> {
        let job = batch.job;
        let most = most.min(MOST_SUBSTEPS / job.steps_per_sample());
        let mut pace = Pace::of(u64::from(self.members) * job.steps_per_sample(), MOST_SAMPLES);
        loop {
            let tiles = tile::submission(&job.clock, from, pace.samples, most);
            let Some(last) = tiles.last() else { break };
            let count = last.samples.end - from;
            from = last.samples.end;
            pace.follow(gpu, self.submit(gpu, batch, &tiles)?, count)?;
            (batch.progress)(count * u64::from(self.members));
            if (batch.stop)() {
                break;
            }
        }
        pace.finish(gpu)?;
        Ok(from)
    }

    /// Hands tiles to the device, each followed by the sums of the report it ends with.
    fn submit(&self, gpu: &Gpu, batch: &Batch<'_>, tiles: &[tile::Tile]) -> Result<Submission> {
        let pieces = |next: &tile::Tile| {
            let report = layout::Report {
                members: self.members,
                stride: self.stride,
                number: next.report.unwrap_or(0) as u32,
                blocks: self.stride / BLOCK,
                counts: u32::from(!batch.bins.is_empty()),
                padding: [0; 3],
            };
            self.pieces(batch.job, next).into_iter().chain([Piece::of(&report)])
        };
        let read = gpu.pack(&tiles.iter().flat_map(pieces).collect::<Vec<_>>())?;
        let mut work = Vec::with_capacity(2 * tiles.len());
        for (tile, read) in tiles.iter().zip(read.chunks_exact(PIECES + 1)) {
            let workgroups = self.stride / SIMULATE_WORKGROUP;
            work.push(Dispatch { kernel: &self.simulate, buffers: self.bound(read), workgroups });
            if tile.report.is_some() {
                let buffers = vec![&read[PIECES], &self.errors, &self.bins, &self.partials, &self.counts];
                work.push(Dispatch { kernel: &self.reduce, buffers, workgroups: self.stride / BLOCK });
            }
        }
        gpu.submit(&work)
    }

    /// The pieces that the kernel reads of a tile.
    pub(super) fn pieces(&self, job: &Job, next: &tile::Tile) -> [Piece; PIECES] {
        let (first, count) = (next.samples.start, next.samples.end - next.samples.start);
        let tile = layout::Tile { first_sample: first as u32, samples: count as u32, ..self.tile };
        [
            Piece::of(&tile),
            Piece::begin(&forces(job, first, count), layout::FORCES * size_of::<[f32; 4]>()),
            Piece::begin(&per_sample(job, first, count), 0),
        ]
    }

    /// Its buffers, in the order of the kernel's bindings.
    pub(super) fn bound<'a>(&'a self, read: &'a [Buffer]) -> Vec<&'a Buffer> {
        vec![&read[0], &self.columns, &self.turns, &self.state, &read[1], &self.errors, &read[2]]
    }

    fn partials(&self, gpu: &Gpu, batch: &Batch<'_>) -> Result<Vec<Partial>> {
        let shape = Shape {
            reports: batch.job.clock.report_samples.len(),
            blocks: (self.stride / BLOCK) as usize,
            members: self.members,
        };
        shape.partials(gpu, [&self.partials, &self.counts], batch.bins)
    }
}

/// Counts what `reduce` has summed.
pub(super) struct Shape {
    pub reports: usize,
    pub blocks: usize,
    pub members: u32,
}

impl Shape {
    /// Reads what it has written to partials and counts.
    pub(super) fn partials(
        &self,
        gpu: &Gpu,
        [partials, counts]: [&Buffer; 2],
        bins: &[[Bins; 4]],
    ) -> Result<Vec<Partial>> {
        let Self { reports, blocks, members } = *self;
        let bytes = gpu.read(partials, (reports * blocks * 4 * size_of::<layout::Partial>()) as u64)?;
        let moments: Vec<layout::Partial> = bytemuck::pod_collect_to_vec(&bytes);
        let counts: Vec<u32> = if bins.is_empty() {
            Vec::new()
        } else {
            bytemuck::pod_collect_to_vec(&gpu.read(counts, (reports * 4 * (BINS + 2) * 4) as u64)?)
        };
        let partial = |report: usize| {
            let of_report = &moments[report * blocks * 4..(report + 1) * blocks * 4];
            let blocks: Vec<[Moments; 4]> =
                of_report.chunks(4).map(|b| std::array::from_fn(|q| finish(&b[q]))).collect();
            let counted: u64 = blocks.iter().map(|b| b[0].count).sum();
            let histograms = bins.get(report).map_or_else(Vec::new, |bins| {
                let counts = counts[report * 4 * (BINS + 2)..].chunks(BINS + 2);
                let histogram = |(bins, counts): (_, &[u32])| Histogram {
                    bins,
                    counts: counts.iter().map(|c| u64::from(*c)).collect(),
                };
                bins.iter().copied().zip(counts).map(histogram).collect()
            });
            Partial { blocks, histograms, failed: u64::from(members) - counted }
        };
        Ok((0..reports).map(partial).collect())
    }
}

/// The moments behind what a workgroup summed: its rounded mean put right.
fn finish(p: &layout::Partial) -> Moments {
    if p.count == 0 {
        return Moments::default();
    }
    let (n, off) = (f64::from(p.count), f64::from(p.correction));
    Moments {
        count: u64::from(p.count),
        mean: f64::from(p.mean) + off / n,
        squares: (f64::from(p.squares) - off * off / n).max(0.0),
        min: f64::from(p.least),
        max: f64::from(p.greatest),
    }
}
