//! Spectral lines of an input: their powers, and whether it has little else.
//!
//! By the four-term window of Blackman and Harris (Harris, Proc. IEEE 66, 1978), whose own lines
//! lie 92 dB down.

use std::f64::consts::TAU;

use crate::numerics::fourier;
use crate::numerics::moments::mean_sd;

/// Half the width of a line in bins, by the window.
pub(crate) const HALF_WIDTH: usize = 5;
/// Lines that are few.
const FEW: usize = 3;
/// Part of an input's power outside its lines that is nothing.
const NOTHING: f64 = 1e-4;
/// Part of a recording at either end in which a transient input must be at rest to need no window,
/// and its size there.
const AT_REST: (f64, f64) = (0.02, 1e-3);

/// Mean square of each bin's line: a sine of amplitude A in one bin is A²/2. Empty where nothing
/// moves. Without a window where the input begins and ends at rest.
pub(crate) fn power(u: &[f64]) -> Vec<f64> {
    let n = u.len();
    let (centre, size) = mean_sd(u);
    let largest = u.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let edge = ((AT_REST.0 * n as f64) as usize).max(1).min(n);
    let rests = |part: &[f64]| part.iter().all(|v| v.abs() <= AT_REST.1 * largest);
    let transient = rests(&u[..edge]) && rests(&u[n - edge..]);
    let window = |k: usize| {
        let phase = TAU * k as f64 / n as f64;
        0.35875 - 0.48829 * phase.cos() + 0.14128 * (2.0 * phase).cos() - 0.01168 * (3.0 * phase).cos()
    };
    let (mean, sum) = if transient { (0.0, n as f64) } else { (centre, 0.35875 * n as f64) };
    let weigh = |k: usize| if transient { 1.0 } else { window(k) };
    let mut values: Vec<f64> = u.iter().enumerate().map(|(k, v)| (v - mean) * weigh(k)).collect();
    let plan = fourier::forward(n);
    let mut bins = plan.make_output_vec();
    if size == 0.0 || plan.process(&mut values, &mut bins).is_err() {
        return Vec::new();
    }
    bins.iter().map(|b| 2.0 * b.norm_sqr() / (sum * sum)).collect()
}

/// Returns whether a few lines carry all of an input's power: any response follows from it at
/// those, and it follows from any response that holds them, so that nothing shows which is the
/// cause and by how much it comes early.
pub(super) fn are_all(u: &[f64]) -> bool {
    let mut remaining = power(u);
    remaining.iter_mut().take(HALF_WIDTH).for_each(|p| *p = 0.0);
    let total: f64 = remaining.iter().sum();
    for _ in 0..FEW {
        let Some((bin, _)) = remaining.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let end = (bin + HALF_WIDTH + 1).min(remaining.len());
        remaining[bin.saturating_sub(HALF_WIDTH)..end].fill(0.0);
    }
    total > 0.0 && remaining.iter().sum::<f64>() < NOTHING * total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_sines_are_all_lines_and_noise_a_pulse_and_many_sines_are_not() {
        let sines = |count: i32| -> Vec<f64> {
            let one = |k: usize, i: i32| (0.01 * f64::from(3 * i + 2) * k as f64 + f64::from(i)).sin();
            (0..3000).map(|k| (0..count).map(|i| one(k, i)).sum()).collect()
        };
        let mut rng = crate::rng::Philox::new(1, 0, crate::rng::Stream::Host);
        let noise: Vec<f64> = (0..3000).map(|_| rng.normal()).collect();
        let pulse: Vec<f64> = (0..3000).map(|k| f64::from(u8::from((200..204).contains(&k)))).collect();
        assert!(are_all(&sines(1)) && are_all(&sines(3)));
        assert!(!are_all(&sines(8)) && !are_all(&noise) && !are_all(&pulse));
        // Half a per cent of noise, in power 2.5e-5 of ½, is that of a measured sine; five per cent
        // are not.
        let with = |part: f64| -> Vec<f64> { sines(1).iter().zip(&noise).map(|(s, e)| s + part * e).collect() };
        assert!(are_all(&with(0.005)) && !are_all(&with(0.05)));
    }

    // A sine of amplitude 2 carries 2 in its line, between the bins too (the window's scalloping is
    // below 0.9 dB).
    #[test]
    fn the_power_of_a_line_is_half_its_amplitude_squared() {
        for cycles in [100.0, 100.5] {
            let u: Vec<f64> = (0..4000).map(|k| 2.0 * (TAU * cycles * f64::from(k) / 4000.0).sin()).collect();
            let most = power(&u).into_iter().fold(0.0, f64::max);
            assert!(most < 2.001 && most > 2.0 * 0.8, "{cycles}: {most}");
        }
    }
}
