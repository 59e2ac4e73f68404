//! The motion of a body without a spring and the force that it takes, both below a twenty-fifth of
//! the sampling rate: what the equation of motion is compared on (filtered inverse dynamics;
//! Gautier, Janot & Vandanjon, IEEE Trans. Control Syst. Technol. 21, 2013).

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::intake::several::Piece;
use crate::numerics::butterworth::zero_phase;

/// Corner of the low-pass that the position goes through before it is differentiated, over the
/// sampling rate.
pub(super) const POSITION: f64 = 0.1;
/// Corner of the low-pass that both sides of the equation of motion go through, over the sampling
/// rate.
pub(super) const FORCE: f64 = 0.04;
/// Samples left out at either end of a recording, where a motion that begins at once is still in the low-passes: an
/// e⁻¹⁹ of it after so many; at most a twentieth of the recording, and at least so few.
const CUT: usize = 200;
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
                all.counting.push(range.start + cut..range.end - cut);
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

/// Weights of the differences over one, two and three samples to either side: exact to the sixth order (Fornberg, Math.
/// Comp. 51, 1988). Of the second one, 1 − (ωT)²/6 of the slope would be left.
const WIDE: [f64; 3] = [0.75, -0.15, 1.0 / 60.0];

/// Central differences; near either end shorter ones, and at it those of a parabola through the last three
/// values.
pub(super) fn slope(values: &[f64], rate_hz: f64) -> Vec<f64> {
    let (mut out, n) = (vec![0.0; values.len()], values.len());
    for k in 1..n.saturating_sub(1) {
        let of = |reach: usize| rate_hz * (values[k + reach] - values[k - reach]);
        out[k] = match k >= WIDE.len() && k + WIDE.len() < n {
            true => WIDE.iter().zip(1..).map(|(weight, reach)| weight * of(reach)).sum(),
            false => 0.5 * of(1),
        };
    }
    if let [a, b, c, ..] = values {
        out[0] = 0.5 * rate_hz * (4.0 * b - 3.0 * a - c);
    }
    if let ([.., c, b, a], Some(last)) = (values, out.last_mut()) {
        *last = 0.5 * rate_hz * (3.0 * a - 4.0 * b + c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    // Differences of this order are exact on a parabola: of 3 + 2t − t², 2 − 2t.
    #[test]
    fn a_parabola_has_its_slope_everywhere() {
        let t = |k: usize| k as f64 / 50.0;
        let values: Vec<f64> = (0..40).map(|k| 3.0 + 2.0 * t(k) - t(k) * t(k)).collect();
        assert!(slope(&values, 50.0).iter().enumerate().all(|(k, s)| (s - (2.0 - 2.0 * t(k))).abs() < 1e-9));
        // A sine of 25 samples a turn, as fast as the force's low-pass lets pass, keeps its slope to (ωT)⁶/140.
        let turn = std::f64::consts::TAU / 25.0;
        let sine: Vec<f64> = (0..100).map(|k| (turn * k as f64).sin()).collect();
        let off = (slope(&sine, 1.0)[50] - turn * (turn * 50.0).cos()).abs() / turn;
        assert!(off < turn.powi(6) / 100.0, "{off}");
    }
}
