//! Six-axis ensembles on a device: three one-axis ensembles that write every reading's errors, and
//! the navigation that reads them, tile by tile.

use std::sync::Arc;

use bytemuck::{Zeroable, cast_slice};

use super::pace::Pace;
use super::simulate::{PIECES, Plan, Shape};
use super::{Buffer, Dispatch, Gpu, Kernel, Piece, Submission};
use crate::backend::flight::{FlightBackend, FlightBatch, QUANTITIES, Sums};
use crate::backend::{Batch, tile};
use crate::error::{Error, Result};
use crate::kernel::aiding;
use crate::kernel::environment::FOLLOWED;
use crate::kernel::flight::{COUPLINGS, Flight, Vertical};
use crate::kernel::layout::{
    self, BLOCK, NAVIGATE_ATTITUDE, NAVIGATE_STATE, NAVIGATE_WORKGROUP, SIMULATE_WORKGROUP, state,
};
use crate::kernel::source;
use crate::parallel;
use crate::statistics::histogram::BINS;
use crate::statistics::{Bins, Machine};

/// Samples of a tile: what the three axes write of it stays in the cache of a software adapter.
const TILE: u64 = 64;
/// Members of a batch on hardware, where the readings of a tile fit twice over: twice what the largest
/// cards have in flight.
const MOST_MEMBERS: u64 = 1 << 19;
/// The same on a software adapter.
const MOST_MEMBERS_SOFTWARE: u64 = 1 << 12;
/// Samples summed before they are added to totals, as `navigate` does it.
const CHUNK: u64 = 64;
/// Pieces of a tile that the axes share: flight, passages, fix and report.
const SHARED: usize = 4;
/// Members whose beginnings are found in one go.
const AT_ONCE: usize = 1024;
/// Most samples of a submission.
const MOST_SAMPLES: u64 = 1 << 14;
/// Numbers that a member is given: what is taken off its readings, couplings, what follows, and
/// what the axes' own kernels have taken off the gyros.
const GIVEN: usize = 9 + COUPLINGS + FOLLOWED;
/// Groups of four quantities, as the reduction takes them.
const GROUPS: usize = QUANTITIES / 4;

/// Six-axis ensembles on a GPU.
pub struct Flights {
    gpu: Arc<Gpu>,
}

impl Flights {
    /// On an open device.
    pub fn on(gpu: Arc<Gpu>) -> Self {
        Self { gpu }
    }
}

impl FlightBackend for Flights {
    fn machine(&self, flight: &Flight) -> Machine {
        self.gpu.machine(flight.axes[0].integrator)
    }

    fn batch_members(&self) -> u64 {
        if !self.gpu.adapter.hardware {
            return MOST_MEMBERS_SOFTWARE;
        }
        (self.gpu.adapter.largest_binding / (16 * TILE)).min(MOST_MEMBERS) & !u64::from(BLOCK - 1)
    }

    fn run(&mut self, batch: &FlightBatch<'_>) -> Result<Option<Vec<Sums>>> {
        Carried::new(&self.gpu, batch)?.run(&self.gpu)
    }

    fn has_failed(&self) -> bool {
        self.gpu.has_failed()
    }
}

/// Sums of one group of quantities.
struct Group {
    errors: Buffer,
    bins: Buffer,
    each: Vec<[Bins; 4]>,
    partials: Buffer,
    counts: Buffer,
}

impl Group {
    fn new(gpu: &Gpu, batch: &FlightBatch<'_>, stride: u32, group: usize) -> Result<Self> {
        let reports = batch.flight.clock().report_samples.len() as u64;
        let each: Vec<[Bins; 4]> = batch.bins.iter().map(|bins| std::array::from_fn(|q| bins[4 * group + q])).collect();
        let mut bins: Vec<layout::Bins> =
            each.iter().flatten().map(|b| layout::Bins { begin: b.from, per_unit: b.per_unit }).collect();
        bins.resize(reports as usize * 4, layout::Bins { begin: 0.0, per_unit: 0.0 });
        let blocks = u64::from(stride / BLOCK);
        Ok(Self {
            errors: gpu.zeros(4 * u64::from(stride) * 5)?,
            bins: gpu.upload(cast_slice(&bins))?,
            partials: gpu.zeros(reports * blocks * 4 * size_of::<layout::Partial>() as u64)?,
            counts: gpu.zeros(if each.is_empty() { 4 } else { reports * 4 * 4 * (BINS as u64 + 2) })?,
            each,
        })
    }
}

/// A batch on the device.
struct Carried<'a> {
    batch: &'a FlightBatch<'a>,
    axes: Vec<Plan>,
    traces: Vec<Buffer>,
    navigate: Kernel,
    reduce: Kernel,
    given: Buffer,
    state: Buffer,
    groups: Vec<Group>,
    members: u32,
    stride: u32,
}

impl<'a> Carried<'a> {
    fn new(gpu: &Gpu, batch: &'a FlightBatch<'a>) -> Result<Self> {
        let flight = batch.flight;
        if flight.axes.iter().any(|job| job.steps_per_sample() * TILE >= layout::FORCES as u64) {
            return Err(Error::new(
                "could not simulate on the GPU",
                format!("a sample has more than {} substeps", layout::FORCES as u64 / TILE),
                "use --backend cpu, or a longer step_s",
            ));
        }
        let plan = |axis: usize| Plan::new(gpu, &Batch::whole(&flight.axes[axis], batch.members.clone()), true);
        let axes: Vec<Plan> = (0..3).map(plan).collect::<Result<_>>()?;
        let (members, stride) = (axes[0].members, axes[0].stride);
        let flags = [
            ("ROUND", flight.course.earth.latitude_rad.is_some()),
            ("COUPLED", flight.coupling.is_some()),
            ("TAKEN", flight.clock().still_samples > 0 || !flight.fixes.is_empty()),
            ("FOLLOWS", flight.follow.is_some()),
            ("JITTERS", flight.jitters),
            ("AIDED", !flight.fixes.is_empty()),
        ];
        let constants = flags.map(|(name, on)| (name, f64::from(u8::from(on))));
        let trace = || gpu.zeros(4 * 2 * TILE * u64::from(stride));
        let carried = Self {
            batch,
            traces: (0..3).map(|_| trace()).collect::<Result<_>>()?,
            navigate: gpu.kernel(&source::navigate(gpu.adapter.int64), &constants)?,
            reduce: gpu.kernel(&source::reduce(), &[])?,
            given: gpu.zeros(4 * u64::from(stride) * GIVEN as u64)?,
            state: gpu.zeros(4 * u64::from(stride) * NAVIGATE_STATE as u64)?,
            groups: (0..GROUPS).map(|g| Group::new(gpu, batch, stride, g)).collect::<Result<_>>()?,
            axes,
            members,
            stride,
        };
        if flight.clock().still_samples == 0 {
            carried.begin(gpu, None)?;
        }
        Ok(carried)
    }

    /// Sends what the members begin to navigate with; `means`: what the still start of each axis
    /// has found, accelerometers and gyros, member by member.
    fn begin(&self, gpu: &Gpu, means: Option<&[Vec<(f32, f32)>]>) -> Result<()> {
        let (flight, stride) = (self.batch.flight, u64::from(self.stride));
        let numbers_of = |member: usize| {
            let (mut given, mut attitude) = ([0.0_f32; GIVEN], [0.0_f32; 6]);
            let index = self.batch.members.start + member as u64;
            let begin = match means {
                None => flight.begin(index, None),
                Some(means) => {
                    let of = |axis: usize| (f64::from(means[axis][member].0), f64::from(means[axis][member].1));
                    let begin = flight.aligned(index, std::array::from_fn(of));
                    for axis in 0..3 {
                        // The readings come without their means: what is taken off instead is the
                        // difference.
                        let (accelerometer, gyro) = of(axis);
                        given[axis] = (begin.accelerometer[axis] - accelerometer) as f32;
                        given[3 + axis] = (begin.gyro[axis] - gyro) as f32;
                        given[6 + COUPLINGS + FOLLOWED + axis] = gyro as f32;
                    }
                    begin
                }
            };
            for (axis, value) in begin.attitude.into_iter().enumerate() {
                attitude[axis] = value as f32;
                attitude[3 + axis] = (value - f64::from(value as f32)) as f32;
            }
            if let Some(coupling) = &flight.coupling {
                given[6..].iter_mut().zip(coupling(index).numbers()).for_each(|(to, from)| *to = from as f32);
            }
            if let Some(follow) = &flight.follow {
                given[6 + COUPLINGS..].iter_mut().zip(follow(index).numbers()).for_each(|(to, from)| *to = from as f32);
            }
            (given, attitude)
        };
        let starts: Vec<usize> = (0..self.members as usize).step_by(AT_ONCE).collect();
        let chunks = parallel::map(&starts, |first| {
            let all: Vec<_> = (*first..(self.members as usize).min(first + AT_ONCE)).map(numbers_of).collect();
            let given = std::array::from_fn::<Vec<f32>, GIVEN, _>(|k| all.iter().map(|(given, _)| given[k]).collect());
            let attitude = std::array::from_fn::<Vec<f32>, 6, _>(|k| all.iter().map(|(_, of)| of[k]).collect());
            (given, attitude)
        });
        let given =
            |k: usize, take: &mut dyn FnMut(&[u8])| chunks.iter().for_each(|(given, _)| take(cast_slice(&given[k])));
        let state = |k: usize, take: &mut dyn FnMut(&[u8])| {
            if let Some(place @ 0..6) = k.checked_sub(NAVIGATE_ATTITUDE) {
                chunks.iter().for_each(|(_, attitude)| take(cast_slice(&attitude[place])));
            }
        };
        gpu.write_columns(&self.given, 4 * stride, GIVEN, &given)?;
        gpu.write_columns(&self.state, 4 * stride, NAVIGATE_STATE, &state)
    }

    /// The mean errors of an axis over the still start, as its kernel takes them off.
    fn means(&self, gpu: &Gpu, axis: usize) -> Result<Vec<(f32, f32)>> {
        let (plan, stride) = (&self.axes[axis], self.stride as usize);
        let bytes = gpu.read(&plan.state, 4 * u64::from(self.stride) * state::TERMS as u64)?;
        let numbers: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        let at = |place: usize, i: usize| numbers[place * stride + i];
        let fraction = self.batch.flight.clock().still_share() as f32;
        let mean = |total: usize, part: usize, i: usize| fraction * (at(total, i) + (at(part, i) + at(total + 1, i)));
        let of = |i: usize| (mean(state::VELOCITY_TOTAL, state::VELOCITY, i), mean(state::RATE_TOTAL, state::RATE, i));
        Ok((0..self.members as usize).map(of).collect())
    }

    /// All of it; nothing where it was stopped.
    fn run(&self, gpu: &Gpu) -> Result<Option<Vec<Sums>>> {
        let clock = self.batch.flight.clock();
        let (mut from, mut pace) = (0, Pace::of(3 * u64::from(self.members), MOST_SAMPLES));
        while from < clock.samples {
            let still = from < clock.still_samples;
            let samples = pace.samples.max(TILE);
            let budget = if still { samples.min(clock.still_samples - from) } else { samples };
            let tiles = self.tiles(from, budget);
            let Some(last) = tiles.last() else { break };
            if from == clock.still_samples && from > 0 {
                let means = (0..3).map(|axis| self.means(gpu, axis)).collect::<Result<Vec<_>>>()?;
                self.begin(gpu, Some(&means))?;
            }
            let count = last.samples.end - from;
            from = last.samples.end;
            pace.follow(gpu, self.submit(gpu, &tiles)?, count)?;
            (self.batch.progress)(count * u64::from(self.members));
            if from < clock.samples && (self.batch.stop)() {
                pace.finish(gpu)?;
                return Ok(None);
            }
        }
        pace.finish(gpu)?;
        self.sums(gpu).map(Some)
    }

    /// The tiles from a sample on: none of them passes the end of the still start, a multiple of
    /// [`CHUNK`] after it, a fix or a report.
    fn tiles(&self, mut from: u64, budget: u64) -> Vec<tile::Tile> {
        let (clock, fixes) = (self.batch.flight.clock(), &self.batch.flight.fixes);
        let (mut tiles, until) = (Vec::new(), from + budget);
        while from < until {
            let room = match from.checked_sub(clock.still_samples) {
                Some(passed) => {
                    let due = fixes.get(aiding::next(fixes, passed)).map_or(CHUNK, |fix| fix.sample - passed);
                    due.min(CHUNK - passed % CHUNK)
                }
                None => TILE,
            };
            let Some(next) = tile::next(clock, from, TILE.min(room)) else { break };
            if next.samples.start < clock.still_samples && next.samples.end == clock.still_samples {
                tiles.push(next);
                break;
            }
            from = next.samples.end;
            tiles.push(next);
        }
        tiles
    }

    /// The pieces that the kernels read of a tile: three axes, then flight, passages, fix and report.
    fn pieces(&self, next: &tile::Tile) -> Vec<Piece> {
        let flight = self.batch.flight;
        let clock = flight.clock();
        let (first, count) = (next.samples.start, next.samples.end - next.samples.start);
        let passed = first.saturating_sub(clock.still_samples);
        let heading_rad = flight.heading_rad(passed + count);
        let own = flight.own_at(first + count);
        let three = |from: usize| std::array::from_fn(|i| if i < 3 { own[from + i] as f32 } else { 0.0 });
        let shared = layout::Flight {
            members: self.members,
            stride: self.stride,
            samples: count as u32,
            since: (passed % CHUNK) as u32,
            sample_s: clock.sample_s() as f32,
            free: if flight.vertical == Vertical::Free { 1.0 } else { 0.0 },
            zero: 0,
            cosine: heading_rad.cos() as f32,
            sine: heading_rad.sin() as f32,
            first_sample: first as u32,
            passed: passed as u32,
            padding: 0,
            own_place: three(0),
            own_speed: three(3),
            own_turn: three(6),
        };
        let passages: Vec<f32> = if first >= clock.still_samples {
            (0..count).flat_map(|n| flight.course.passage(passed + n).numbers()).map(|number| number as f32).collect()
        } else {
            Vec::new()
        };
        let report = layout::Report {
            members: self.members,
            stride: self.stride,
            number: next.report.unwrap_or(0) as u32,
            blocks: self.stride / BLOCK,
            counts: u32::from(!self.batch.bins.is_empty()),
            padding: [0; 3],
        };
        let axes = (0..3).flat_map(|axis| self.axes[axis].pieces(&flight.axes[axis], next));
        axes.chain([
            Piece::of(&shared),
            Piece::begin(&passages, layout::PASSAGES * size_of::<[f32; 4]>()),
            Piece::of(&self.fix(passed + count)),
            Piece::of(&report),
        ])
        .collect()
    }

    /// The fix that a tile ends with after this many samples, if one is due.
    fn fix(&self, passed: u64) -> layout::Fix {
        let tile = &self.axes[0].tile;
        let mut all = layout::Fix { seed: tile.seed, first_member: tile.first_member, ..layout::Fix::zeroed() };
        let Some((number, fix)) = aiding::at(&self.batch.flight.fixes, passed) else { return all };
        (all.number, all.present) = (number as u32, 1);
        for (k, sd) in fix.sd.iter().enumerate() {
            all.sd[k / 3][k % 3] = sd.unwrap_or(0.0) as f32;
            fix.gain.iter().enumerate().for_each(|(row, of)| all.gain[2 * row + k / 3][k % 3] = of[k] as f32);
        }
        all
    }

    /// Hands tiles to the device: three axes, then the navigation, then the sums of the report that
    /// a tile ends with.
    fn submit(&self, gpu: &Gpu, tiles: &[tile::Tile]) -> Result<Submission> {
        let still_samples = self.batch.flight.clock().still_samples;
        let read = gpu.pack(&tiles.iter().flat_map(|tile| self.pieces(tile)).collect::<Vec<_>>())?;
        let mut work: Vec<Dispatch<'_>> = Vec::new();
        for (tile, read) in tiles.iter().zip(read.chunks_exact(3 * PIECES + SHARED)) {
            let (axes, shared) = read.split_at(3 * PIECES);
            for (axis, read) in axes.chunks_exact(PIECES).enumerate() {
                let plan = &self.axes[axis];
                let mut buffers = plan.bound(read);
                buffers.push(&self.traces[axis]);
                work.push(Dispatch { kernel: &plan.simulate, buffers, workgroups: self.stride / SIMULATE_WORKGROUP });
            }
            if tile.samples.start < still_samples {
                continue;
            }
            let [flight, passages, fix, report] = shared else { continue };
            let [x, y, z] = [&self.traces[0], &self.traces[1], &self.traces[2]];
            let errors = self.groups.iter().map(|group| &group.errors);
            let buffers = [flight, passages, x, y, z, &self.given, &self.state].into_iter().chain(errors);
            work.push(Dispatch {
                kernel: &self.navigate,
                buffers: buffers.chain([fix]).collect(),
                workgroups: self.stride / NAVIGATE_WORKGROUP,
            });
            if tile.report.is_some() {
                for group in &self.groups {
                    let buffers = vec![report, &group.errors, &group.bins, &group.partials, &group.counts];
                    work.push(Dispatch { kernel: &self.reduce, buffers, workgroups: self.stride / BLOCK });
                }
            }
        }
        gpu.submit(&work)
    }

    fn sums(&self, gpu: &Gpu) -> Result<Vec<Sums>> {
        let reports = self.batch.flight.clock().report_samples.len();
        let shape = Shape { reports, blocks: (self.stride / BLOCK) as usize, members: self.members };
        let groups = self.groups.iter().map(|g| shape.partials(gpu, [&g.partials, &g.counts], &g.each));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        let report = |k: usize| {
            let blocks = groups[0][k].blocks.iter().enumerate();
            let blocks = blocks.map(|(b, _)| std::array::from_fn(|q| groups[q / 4][k].blocks[b][q % 4])).collect();
            let histograms = groups.iter().flat_map(|g| g[k].histograms.clone()).collect();
            Sums { blocks, histograms, failed: groups[0][k].failed }
        };
        Ok((0..reports).map(report).collect())
    }
}
