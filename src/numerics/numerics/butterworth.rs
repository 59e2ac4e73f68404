//! Zero phase: a fourth-order Butterworth low-pass run over a sequence forwards and backwards.
//!
//! Not for readouts, which are causal (`physics::readout_lowpass`).

use std::f64::consts::PI;

/// Qualities of the two second-order sections: 1/(2 cos(π/8)), 1/(2 cos(3π/8)).
const QUALITIES: [f64; 2] = [0.541_196_100_146_197, 1.306_562_964_876_376_4];

/// Length of the lead-in times the corner frequency: the slower section forgets its beginning by
/// e⁻¹⁹ over it.
const LEAD: f64 = 8.0;

/// A sequence through the low-pass in both directions: amplitudes fall to one half at the corner.
/// Beyond its ends the sequence is taken to go on turned about them, and its first and last values
/// lead the filter in.
pub fn zero_phase(values: &[f64], corner_hz: f64, rate_hz: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return Vec::new() };
    let lead = ((LEAD * rate_hz / corner_hz) as usize).min(values.len() - 1);
    let before = (1..=lead).rev().map(|k| 2.0 * first - values[k]);
    let after = (1..=lead).map(|k| 2.0 * last - values[values.len() - 1 - k]);
    let mut all: Vec<f64> = before.chain(values.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        QUALITIES.iter().for_each(|q| section(&mut all, *q, (PI * corner_hz / rate_hz).tan()));
        all.reverse();
    }
    all[lead..lead + values.len()].to_vec()
}

/// One second-order section (bilinear transform, `k` the warped corner), begun as if the first
/// value had always been there.
fn section(values: &mut [f64], quality: f64, k: f64) {
    let scale = 1.0 / (1.0 + k / quality + k * k);
    let gain = k * k * scale;
    let (a1, a2) = (2.0 * (k * k - 1.0) * scale, (1.0 - k / quality + k * k) * scale);
    let first = values.first().copied().unwrap_or(0.0);
    let (mut s1, mut s2) = ((1.0 - gain) * first, (gain - a2) * first);
    for value in values {
        let x = *value;
        let y = gain * x + s1;
        s1 = 2.0 * gain * x - a1 * y + s2;
        s2 = gain * x - a2 * y;
        *value = y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // |H|² of a Butterworth low-pass of order n is 1/(1 + (f/f_c)^2n) at warped frequencies; both directions together give |H|².
    #[test]
    fn tones_fall_by_the_squared_response_without_a_shift() {
        let (rate_hz, corner_hz) = (1000.0, 100.0);
        let warped = |f: f64| (PI * f / rate_hz).tan();
        for hz in [20.0, 100.0, 180.0] {
            let tone = |k: usize| (2.0 * PI * hz * k as f64 / rate_hz + 0.4).cos();
            let values: Vec<f64> = (0..2000).map(tone).collect();
            let got = zero_phase(&values, corner_hz, rate_hz);
            let expected = 1.0 / (1.0 + (warped(hz) / warped(corner_hz)).powi(8));
            let worst = (500..1500).map(|k| (got[k] - expected * tone(k)).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{hz}: {worst}");
        }
        let line: Vec<f64> = (0..300).map(|k| 3.0 + 0.2 * f64::from(k)).collect();
        let got = zero_phase(&line, corner_hz, rate_hz);
        assert!(got.iter().zip(&line).all(|(a, b)| (a - b).abs() < 1e-6), "a straight line passes to its ends");
    }
}
