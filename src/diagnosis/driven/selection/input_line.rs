//! Decides whether an oscillation found in the reading follows from the input: at one of its lines
//! any error of the linear model shows, at its harmonics and mixed frequencies one of a law that
//! bends. What the input does not cause lies elsewhere; where it does not, this input cannot show
//! that it does not cause it.

use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Input;
use crate::driven::intake::lines::{HALF_WIDTH, power};
use crate::numerics::order;
use crate::physics::library::Term;

/// A line stands out of the bins next to it by this factor in power. Noise has as much in one bin
/// of 2³⁰.
const STANDS_OUT: f64 = 30.0;
/// Bins next to a line by which it is measured, beyond the width of the window.
const BESIDE: usize = 24;
/// Bins by which an oscillation must lie apart from a line to be resolved from it.
const RESOLVED: f64 = 1.5;
/// Bins by which it may lie next to a harmonic whose frequency is known to a part of a bin.
const ON_A_HARMONIC: f64 = 0.3;
/// Power of a line over the strongest one from which it makes harmonics.
const STRONG: f64 = 1e-2;
/// Lines that are few enough to have harmonics apart; with more, mixed frequencies are everywhere.
const FEW: usize = 4;
/// Highest order of a mixed frequency: of one line or two, and of more.
const ORDERS: [i32; 2] = [5, 3];

/// Returns whether one term of a model is an oscillation that may follow from the input.
pub(crate) fn follows_input(data: &Data, fit: &Fit, index: usize) -> bool {
    if !matches!(fit.structure.terms[index], Term::PeriodicDisturbance(_)) {
        return false;
    }
    let frequency_hz = fit.structure.of(index, &fit.point).get(2).copied();
    frequency_hz.is_some_and(|f| InputLines::of(data).is_some_and(|lines| lines.may_cause(f)))
}

/// Lines of an input, in bins.
#[derive(Debug, Clone, PartialEq)]
struct InputLines {
    power: Vec<f64>,
    /// The strong ones, where they are few and carry the input.
    strong: Vec<f64>,
    samples: usize,
    rate_hz: f64,
}

impl InputLines {
    /// Finds the lines of the recording's input; `None` where there is none.
    fn of(data: &Data) -> Option<Self> {
        let input = data.input.as_ref()?;
        Some(Self::of_samples(&Input::samples(input)[data.hull.clone()], data.rate_hz))
    }

    fn of_samples(u: &[f64], rate_hz: f64) -> Self {
        let power = power(u);
        let mut lines = Self { strong: Vec::new(), samples: u.len(), rate_hz, power };
        lines.strong = lines.few();
        lines
    }

    /// Bins of the strong lines, to a part of a bin; empty where there are many, or none.
    fn few(&self) -> Vec<f64> {
        let mut remaining = self.power.clone();
        remaining.iter_mut().take(HALF_WIDTH).for_each(|p| *p = 0.0);
        let mut found = Vec::new();
        let mut strongest: f64 = 0.0;
        while let Some((bin, most)) = remaining.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) {
            strongest = strongest.max(most);
            if most <= STRONG * strongest || most <= 0.0 {
                return found;
            }
            if found.len() == FEW || !self.stands_out(bin) {
                return Vec::new();
            }
            found.push(self.refined(bin));
            let end = (bin + HALF_WIDTH + 1).min(remaining.len());
            remaining[bin.saturating_sub(HALF_WIDTH)..end].fill(0.0);
        }
        found
    }

    /// The top of a line, by a parabola through the logarithms of three bins.
    fn refined(&self, bin: usize) -> f64 {
        let at = |k: usize| self.power.get(k).map_or(f64::NEG_INFINITY, |p| p.max(1e-300).ln());
        let (left, middle, right) = (at(bin - 1), at(bin), at(bin + 1));
        let bend = left - 2.0 * middle + right;
        let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
        bin as f64 + shift.clamp(-0.5, 0.5)
    }

    /// Returns whether a bin holds more than those next to it by far.
    fn stands_out(&self, bin: usize) -> bool {
        let left = bin.saturating_sub(HALF_WIDTH + BESIDE)..bin.saturating_sub(HALF_WIDTH);
        let right = bin + HALF_WIDTH + 1..(bin + HALF_WIDTH + 1 + BESIDE).min(self.power.len());
        let beside: Vec<f64> = left.chain(right).filter_map(|k| self.power.get(k).copied()).collect();
        let least = order::median(beside).unwrap_or(0.0);
        self.power.get(bin).is_some_and(|p| *p > STANDS_OUT * least && *p > 0.0)
    }

    /// Returns whether an oscillation at this frequency may follow from the input.
    fn may_cause(&self, frequency_hz: f64) -> bool {
        let bins = self.samples as f64;
        let at = frequency_hz / self.rate_hz * bins;
        self.has_line(at) || self.mixed().any(|k| (folded(k, bins) - at).abs() <= ON_A_HARMONIC)
    }

    /// Returns whether the input has a line from which this place, in bins, is not resolved.
    fn has_line(&self, at: f64) -> bool {
        let near = (at - RESOLVED).ceil().max(0.0) as usize..=(at + RESOLVED).floor().max(0.0) as usize;
        let top = near.filter(|k| *k > HALF_WIDTH).max_by(|a, b| {
            let of = |k: &usize| self.power.get(*k).copied().unwrap_or(0.0);
            of(a).total_cmp(&of(b))
        });
        // A line to the side reaches in by its width: its own top must be here.
        let is_top = |k: usize| {
            let of = |k: usize| self.power.get(k).copied().unwrap_or(0.0);
            of(k) >= of(k.saturating_sub(1)) && of(k) >= of(k + 1)
        };
        top.is_some_and(|k| is_top(k) && self.stands_out(k))
    }

    /// Sums and differences of the strong lines and their multiples, in bins.
    fn mixed(&self) -> impl Iterator<Item = f64> {
        let highest = if self.strong.len() > 2 { ORDERS[1] } else { ORDERS[0] };
        let mut sums: Vec<(f64, i32)> = vec![(0.0, 0)];
        for line in &self.strong {
            sums = sums
                .iter()
                .flat_map(|&(at, order)| {
                    let rest = highest - order;
                    (-rest..=rest).map(move |n| (at + f64::from(n) * line, order + n.abs()))
                })
                .collect();
        }
        sums.into_iter().filter(|(at, order)| *order > 0 && *at > 0.0).map(|(at, _)| at)
    }
}

/// Returns where a frequency appears among samples, both in bins.
fn folded(at: f64, samples: f64) -> f64 {
    let within = at.rem_euclid(samples);
    within.min(samples - within)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 1000.0;
    const ROWS: usize = 5000;

    fn lines(hz: &[f64]) -> InputLines {
        let at = |k: usize| hz.iter().map(|f| (TAU * f * k as f64 / RATE_HZ + f).sin()).sum();
        InputLines::of_samples(&(0..ROWS).map(at).collect::<Vec<f64>>(), RATE_HZ)
    }

    // A bin is 0.2 Hz.
    #[test]
    fn lines_harmonics_and_mixed_frequencies_are_the_inputs_and_others_are_not() {
        let one = lines(&[63.37]);
        // The line, next to it by less than a bin, its third harmonic, its ninth folded at 500 Hz
        // is beyond the order.
        for (hz, is) in [(63.37, true), (63.55, true), (190.11, true), (191.0, false), (50.0, false), (429.67, false)] {
            assert_eq!(one.may_cause(hz), is, "{hz}");
        }
        let two = lines(&[40.13, 61.71]);
        // f₂ − f₁, 2f₁ + f₂, and an oscillation next to both.
        for (hz, is) in [(21.58, true), (141.97, true), (50.0, false), (44.0, false)] {
            assert_eq!(two.may_cause(hz), is, "{hz}");
        }
        // 4 · 230 Hz is seen at 80 Hz in samples at 1000 Hz.
        assert!(lines(&[230.0]).may_cause(80.0));
    }

    // Two lines have 30 sums and differences up to the fifth order, 0.6 bins wide, themselves among
    // them, which are 3 bins wide: 22.8 of 2500 bins, 18 of 2000 frequencies with a standard
    // deviation of 4.
    #[test]
    fn few_frequencies_are_the_inputs() {
        let mut rng = Philox::new(3, 0, Stream::Host);
        let two = lines(&[40.13, 61.71]);
        let everywhere = || (0..2000).map(|k| 0.1 + 0.25 * f64::from(k));
        let count = everywhere().filter(|hz| two.may_cause(*hz)).count();
        assert!((4..=34).contains(&count), "{count} of 2000");
        // Noise has no line, a sine inside it has one.
        let noise: Vec<f64> = (0..ROWS).map(|_| rng.normal()).collect();
        let of = InputLines::of_samples(&noise, RATE_HZ);
        assert_eq!(everywhere().filter(|hz| of.may_cause(*hz)).count(), 0);
        let mixed: Vec<f64> =
            noise.iter().enumerate().map(|(k, n)| n + (TAU * 77.0 * k as f64 / RATE_HZ).sin()).collect();
        let of = InputLines::of_samples(&mixed, RATE_HZ);
        assert!(of.may_cause(77.0) && !of.may_cause(80.0));
    }
}
