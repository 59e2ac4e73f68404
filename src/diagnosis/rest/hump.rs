//! Humps in the spectrum that are wider than a line and narrower than a band: a pickup whose
//! frequency wanders.
//!
//! In a long recording a band a third wide holds thousands of coefficients and averages a hump of
//! thirty away; a line covers only one. Windows of 8, 32 and 128 coefficients, each overlapping the
//! next by half, are tested for excess power. Not for humps of a law of noise: those are wide.

use std::f64::consts::PI;

use super::channel::{Channel, Fitted};
use crate::numerics::special::chi_squared_survival;
use crate::verdict::Stretch;

/// Coefficients in a window.
const WIDTHS: [usize; 3] = [8, 32, 128];
/// Wider than a line: fewer coefficients from the lowest are drift.
const SLOWEST: usize = 16;
/// Windows named at most.
const MOST: usize = 8;

/// Holds what stands out.
#[derive(Debug, Clone)]
pub(super) struct Humps {
    /// Smallest probability of a window by chance, corrected for the number of windows.
    pub(super) p_value: f64,
    /// Angles θ = πk/(2N) at which windows stand out, the strongest first.
    pub(super) centres: Vec<f64>,
    /// The same in frequency.
    pub(super) at_hz: Vec<Stretch>,
}

/// Looks for windows with more power than modelled, beyond a `tolerance`; of `spread` times as many
/// coefficients one is independent.
pub(super) fn find(channel: &Channel, fitted: &Fitted, spread: f64, tolerance: f64) -> Humps {
    let count = fitted.residual.len();
    // Sums of squares over the model's variance up to each coefficient.
    let mut sums = vec![0.0; count + 1];
    for (bin, variance) in fitted.bins.iter().zip(fitted.safe_variances()) {
        for k in bin.from..bin.to {
            sums[k + 1] = sums[k] + fitted.residual[k].powi(2) / variance;
        }
    }
    let widths = WIDTHS.into_iter().filter(|w| 8 * w < count);
    let windows = widths.flat_map(|w| (SLOWEST..count - w).step_by(w / 2).map(move |from| [from, from + w]));
    let mut all: Vec<(f64, [usize; 2], f64)> = windows
        .map(|[from, to]| {
            let (power, degrees_of_freedom) = (sums[to] - sums[from], (to - from) as f64 / spread);
            let mean = power / (to - from) as f64;
            let p_value = chi_squared_survival(mean * degrees_of_freedom / (1.0 + tolerance), degrees_of_freedom);
            (p_value, [from, to], mean)
        })
        .collect();
    let tests = all.len() as f64;
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.truncate(MOST);
    let to_hz = channel.rate_hz / (2 * count) as f64;
    let at = |[from, to]: [usize; 2]| (from + to - 1) as f64 / 2.0 * PI / (2 * count) as f64;
    let stretch = |(_, [from, to], excess): &(f64, [usize; 2], f64)| Stretch {
        from: *from as f64 * to_hz,
        to: *to as f64 * to_hz,
        excess: *excess,
    };
    let p_value = all.first().map_or(1.0, |w| (w.0 * tests).min(1.0));
    Humps {
        p_value,
        centres: all.iter().filter(|w| w.0 * tests < 0.01).map(|w| at(w.1)).collect(),
        at_hz: all.first().map(stretch).into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::rng::{Philox, Stream};

    fn p_value(member: u64, chirp: f64, growth: f64) -> f64 {
        let mut rng = Philox::new(51, member, Stream::Host);
        let count = 20_000;
        let values: Vec<f64> = (0..count)
            .map(|n| {
                let part = f64::from(n) / f64::from(count);
                let cycles = 0.137 * f64::from(n) * (1.0 + 0.5 * chirp * part);
                let size = if chirp > 0.0 { 0.25 } else { 0.0 };
                size * (TAU * cycles).sin() + (1.0 + growth * part) * rng.normal()
            })
            .collect();
        let channel = Channel::new("x", &values, 1.0);
        let spread = if growth > 0.0 { 1.4 } else { 1.0 };
        find(&channel, &channel.fit(Vec::new()), spread, 0.05).p_value
    }

    #[test]
    fn a_wandering_pickup_stands_out_and_noise_does_not() {
        let (mut found, mut alarms) = (0, 0);
        for member in 0..100 {
            // A quarter of the noise, over ten cycles of the recording.
            found += usize::from(p_value(member, 10.0 / (0.137 * 20_000.0), 0.0) < 1e-6);
            alarms += usize::from(p_value(1000 + member, 0.0, 0.0) < 0.01);
            // Noise that grows fourfold: mean fourth power over the squared mean square is 1.39.
            alarms += usize::from(p_value(2000 + member, 0.0, 3.0) < 0.01);
        }
        assert!(found == 100, "{found} of 100 found");
        // 1 % of 200, and five more by chance less than once in a hundred.
        assert!(alarms <= 6, "{alarms} alarms in 200");
    }
}
