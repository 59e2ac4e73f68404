//! The search engine: models of one driven recording per second, each a candidate with its parameters.

use crate::backend::gpu::{self, Gpu};
use crate::backend::misfits::evaluate;
use crate::error::Result;
use crate::kernel::misfit::{Job, Point, Units};

use super::row::{Row, row};

/// Samples of the recording.
const SAMPLES: usize = 4000;
/// Runge–Kutta steps per sample.
const STEPS: usize = 4;
/// Points on the CPU.
const POINTS: usize = 2048;
/// Points on a card, which more keep busy.
const POINTS_HARDWARE: usize = 1 << 17;
/// Name of these rows.
const WORK: &str = "misfit: points × samples, cubic spring and end stop, four steps a sample";
const UNIT: &str = "point-samples";

fn points(count: usize) -> Vec<Point> {
    let point = |i: usize| Point {
        gain: 1.0,
        omega_rad_s: 0.5 + 0.1 * i as f64 / count as f64,
        zeta: 0.05,
        cubic: 0.01,
        stop_above: 1.0,
        gap_above: 2.0,
        ..Point::default()
    };
    (0..count).map(point).collect()
}

/// What all points are compared with: one sample a second, tones in, a tone out.
struct Recording {
    reading: Vec<f64>,
    grid: Vec<f64>,
}

impl Recording {
    fn new() -> Self {
        let input = |t: f64| 0.2 * ((0.41 * t).sin() + (0.67 * t).cos());
        Self {
            reading: (0..SAMPLES).map(|k| (0.5 * k as f64).sin()).collect(),
            grid: (0..2 * STEPS * SAMPLES).map(|j| input(j as f64 / (2 * STEPS) as f64)).collect(),
        }
    }

    fn job(&self) -> Job<'_> {
        Job {
            reading: &self.reading,
            grid: &self.grid,
            grid_end: 0,
            steps: STEPS,
            run: 0..SAMPLES,
            blocks: vec![0..SAMPLES / 2, SAMPLES / 2..SAMPLES],
            directions: &[],
            units: Units { output: 1.0, input: 1.0, interval_s: 1.0 },
        }
    }
}

/// On the CPU, in both precisions.
///
/// # Errors
/// Ctrl-C.
pub fn cpu() -> Result<Vec<Row>> {
    let (recording, points) = (Recording::new(), points(POINTS));
    let (job, units) = (recording.job(), (POINTS * SAMPLES) as f64);
    Ok(vec![
        row(WORK, "f32", POINTS as u64, units, UNIT, || evaluate::<f32>(&job, &points).map(drop))?,
        row(WORK, "f64", POINTS as u64, units, UNIT, || evaluate::<f64>(&job, &points).map(drop))?,
    ])
}

/// On a device.
///
/// # Errors
/// As the device; Ctrl-C.
pub fn gpu(gpu: &Gpu) -> Result<Row> {
    let count = if gpu.adapter.hardware { POINTS_HARDWARE } else { POINTS };
    let (recording, points) = (Recording::new(), points(count));
    let (job, units) = (recording.job(), (count * SAMPLES) as f64);
    let work = || gpu::misfits::evaluate(gpu, &job, &points).map(drop);
    let mut measured = row(WORK, "f32", count as u64, units, UNIT, work)?;
    measured.place = gpu.adapter.name.clone();
    Ok(measured)
}
