//! One pass of a model over part of a recording, and where it begins.

use std::ops::Range;

use crate::driven::base::{BASE, GAIN, OMEGA, ZETA};
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Input;
use crate::physics::state::{BaseLanes, LANES, Lanes};

use super::filter::{Beginning, Keep, Pass};
use super::step::Parts;
use super::structure::ModelStructure;

/// Settings of a run.
#[derive(Debug, Clone)]
pub struct Run {
    /// Samples to simulate, half-open.
    pub range: Range<usize>,
    /// Integration steps per sample.
    pub steps: usize,
    /// States whether readings correct the state.
    pub corrected: bool,
}

/// Returns the innovations at up to [`LANES`] points, begun at these beginnings.
pub(crate) fn once<K: Keep>(
    data: &Data,
    structure: &ModelStructure,
    points: &[Vec<f64>],
    run: &Run,
    beginnings: Vec<Beginning>,
    keep: &mut K,
) -> Vec<Lanes> {
    let lane = |index: usize| lane(points, index);
    let (omega, zeta) = (lane(OMEGA), lane(ZETA));
    let mut base = BaseLanes { gain: lane(GAIN), stiffness: [0.0; LANES], damping: [0.0; LANES] };
    for l in 0..LANES {
        base.stiffness[l] = omega[l] * omega[l];
        base.damping[l] = 2.0 * zeta[l] * omega[l];
    }
    let parameters: Vec<Lanes> = (BASE..structure.parameters).map(lane).collect();
    let first: Vec<usize> = structure.first.iter().map(|f| f - BASE).collect();
    let gains = (run.corrected && structure.is_noisy()).then(|| {
        let mut gains = [[0.0; LANES]; 4];
        for l in 0..LANES {
            let gain = structure.gain(&points[l.min(points.len() - 1)], data.interval_s());
            for (g, k) in gains.iter_mut().zip(gain.k) {
                g[l] = k;
            }
        }
        gains
    });
    let pass = Pass {
        run: run.range.clone(),
        reading: &data.reading,
        grid: data.input.as_ref().map_or(&[], |i| i.grid(run.steps)),
        grid_end: data.input.as_ref().map_or(0, Input::end),
        environment: &data.environment,
        environments: data.environments,
        clock_s: &data.clock_s,
        parts: Parts {
            base,
            oscillator: [omega, zeta],
            terms: &structure.terms,
            parameters: &parameters,
            first: &first,
            interval_s: data.interval_s(),
            steps: run.steps,
            observed: data.observed,
        },
        beginnings,
        gains,
    };
    pass.innovations(keep)
}

/// Returns where the run begins, by the first recording's parameters wherever that is, and where
/// within it further recordings do.
pub(crate) fn beginnings(data: &Data, structure: &ModelStructure, points: &[Vec<f64>], run: &Run) -> Vec<Beginning> {
    let lane = |index: usize| lane(points, index);
    let at = |sample: usize, recording: usize| {
        let initial = structure.initial(recording);
        Beginning {
            sample,
            recording,
            offset: lane(structure.offset(recording)),
            initial: [lane(initial), lane(initial + 1)],
        }
    };
    let further = data.breaks.iter().enumerate().take(structure.further).map(|(i, sample)| (*sample, i + 1));
    let within = further.filter(|(sample, _)| run.range.start < *sample && *sample < run.range.end);
    std::iter::once((run.range.start, 0)).chain(within).map(|(sample, recording)| at(sample, recording)).collect()
}

/// One parameter in every lane; those without a point of their own have the last one's.
pub(crate) fn lane(points: &[Vec<f64>], index: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (l, value) in lanes.iter_mut().enumerate() {
        *value = points[l.min(points.len() - 1)][index];
    }
    lanes
}
