//! The motion of a body without a spring and the force that it takes, both below a twenty-fifth of
//! the sampling rate: what the equation of motion is compared on (filtered inverse dynamics;
//! Gautier, Janot & Vandanjon, IEEE Trans. Control Syst. Technol. 21, 2013).

use std::ops::Range;

use super::low_pass::{FORCE, POSITION, least_speed, slope};
use crate::driven::intake::data::Data;
use crate::driven::intake::several::Piece;
use crate::numerics::butterworth::zero_phase;

/// Samples left out at either end of a recording, where the low-passes still ring from a motion that began abruptly:
/// eight periods of the force's corner, after which e⁻¹⁹ of it is left. A short recording loses a twentieth at either end.
const CUT: usize = 200;
/// Fewest samples left out at either end.
const LEAST_CUT: usize = 50;

/// One part of the force that a body takes, as a function of its motion and of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Acceleration x″, output unit/s².
    Acceleration,
    /// Velocity x′, output unit/s.
    Velocity,
    /// A constant.
    Constant,
    /// Direction of motion, sgn x′.
    Direction,
    /// |x′|: what a drag that differs in both directions adds.
    Speed,
    /// Drag, |x′|x′.
    SquaredVelocity,
    /// Square of the input, −u².
    SquaredInput,
}

impl Part {
    /// At a velocity, an acceleration and an input.
    pub fn at(self, v: f64, a: f64, u: f64) -> f64 {
        match self {
            Self::Acceleration => a,
            Self::Velocity => v,
            Self::Constant => 1.0,
            Self::Direction if v == 0.0 => 0.0,
            Self::Direction => v.signum(),
            Self::Speed => v.abs(),
            Self::SquaredVelocity => v.abs() * v,
            Self::SquaredInput => -u * u,
        }
    }
}

/// All parts that are looked at.
pub(crate) const PARTS: [Part; 7] = [
    Part::Acceleration,
    Part::Velocity,
    Part::Constant,
    Part::Direction,
    Part::Speed,
    Part::SquaredVelocity,
    Part::SquaredInput,
];

/// Motion and force, sample by sample of the data.
#[derive(Debug, Clone)]
pub struct MotionAndForce {
    /// Position without what lies above its low-pass.
    pub x: Vec<f64>,
    /// Velocity, filtered, unit of the output per second.
    pub v: Vec<f64>,
    /// Input, filtered, in its own unit.
    pub force: Vec<f64>,
    /// The parts, filtered, as [`PARTS`].
    parts: Vec<Vec<f64>>,
    /// Samples that count, per recording.
    pub counting: Vec<Range<usize>>,
}

impl MotionAndForce {
    /// Motion and force of every recording; `None` without an input.
    pub fn of(data: &Data, pieces: &[Piece]) -> Option<Self> {
        let (input, n) = (data.input.as_ref()?.samples(), data.reading.len());
        let zeros = || vec![0.0; n];
        let mut all =
            Self { x: zeros(), v: zeros(), force: zeros(), parts: vec![zeros(); PARTS.len()], counting: Vec::new() };
        for range in pieces.iter().map(|p| p.range.clone()) {
            let smooth = |values: &[f64]| zero_phase(values, FORCE * data.rate_hz, data.rate_hz);
            let x = zero_phase(&data.reading[range.clone()], POSITION * data.rate_hz, data.rate_hz);
            let v = slope(&x, data.rate_hz);
            let (a, u) = (slope(&v, data.rate_hz), &input[range.clone()]);
            for (part, out) in PARTS.iter().zip(&mut all.parts) {
                let values: Vec<f64> = (0..range.len()).map(|k| part.at(v[k], a[k], u[k])).collect();
                out[range.clone()].copy_from_slice(&smooth(&values));
            }
            all.force[range.clone()].copy_from_slice(&smooth(u));
            all.x[range.clone()].copy_from_slice(&x);
            all.v[range.clone()].copy_from_slice(&v);
            let cut = CUT.min(range.len() / 20).max(LEAST_CUT);
            if range.len() > 2 * cut {
                let still = standing(&v, least_speed(&data.reading[range.clone()], &x, data.rate_hz));
                all.counting.extend(
                    between(cut..range.len() - cut, &still)
                        .map(|moving| range.start + moving.start..range.start + moving.end),
                );
            }
        }
        Some(all)
    }

    /// One part, sample by sample, filtered like the force.
    pub fn part(&self, part: Part) -> &[f64] {
        PARTS.iter().position(|p| *p == part).map_or(&[], |i| &self.parts[i])
    }

    /// The samples of these ranges that count.
    pub fn counted(&self, ranges: &[Range<usize>]) -> Vec<Range<usize>> {
        let pairs =
            ranges.iter().flat_map(|r| self.counting.iter().map(move |c| r.start.max(c.start)..r.end.min(c.end)));
        pairs.filter(|r| r.start < r.end).collect()
    }
}

/// Stretches in which it stands for longer than the low-pass of the force remembers, with twice as much to either side: dry
/// friction takes what it must there, and says nothing of its size.
fn standing(v: &[f64], least: f64) -> Vec<Range<usize>> {
    let memory = (1.0 / FORCE) as usize;
    let mut out: Vec<Range<usize>> = Vec::new();
    let mut from = None;
    for k in 0..=v.len() {
        match (v.get(k).is_some_and(|v| v.abs() < least), from) {
            (true, None) => from = Some(k),
            (false, Some(begun)) => {
                if k - begun > memory {
                    out.push(begun.saturating_sub(2 * memory)..(k + 2 * memory).min(v.len()));
                }
                from = None;
            }
            _ => {}
        }
    }
    out
}

/// Parts of a range that lie in none of these, which are in order.
fn between(range: Range<usize>, without: &[Range<usize>]) -> impl Iterator<Item = Range<usize>> {
    let ends = without.iter().map(|w| w.start).chain([range.end]);
    let starts = [range.start].into_iter().chain(without.iter().map(|w| w.end));
    let parts: Vec<Range<usize>> =
        starts.zip(ends).map(|(start, end)| start.max(range.start)..end.min(range.end)).collect();
    parts.into_iter().filter(|part| part.start < part.end)
}
