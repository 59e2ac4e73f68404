//! Low-passes and differences between a reading and its motion: what they are, and what they leave of the
//! reading's noise.

use crate::numerics::butterworth::zero_phase;
use crate::numerics::order;

/// Corner of the low-pass that the position goes through before it is differentiated, over the
/// sampling rate.
pub(super) const POSITION: f64 = 0.1;
/// Corner of the low-pass that both sides of the equation of motion go through, over the sampling
/// rate.
pub(super) const FORCE: f64 = 0.04;
/// Samples of an impulse response: many times the length of the low-passes.
const LENGTH: usize = 1024;

/// Traces of one reading that is off by one: in the reading less the position, and in the
/// position and its derivatives as the force is compared.
pub(super) struct Impulse {
    pub(super) above: Vec<f64>,
    /// Of the position's own velocity.
    pub(super) speed: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
}

impl Impulse {
    /// At a sampling rate.
    pub(super) fn of(rate_hz: f64) -> Self {
        let mut reading = vec![0.0; LENGTH];
        reading[LENGTH / 2] = 1.0;
        let x = zero_phase(&reading, POSITION * rate_hz, rate_hz);
        let v = slope(&x, rate_hz);
        let a = slope(&v, rate_hz);
        let smooth = |values: &[f64]| zero_phase(values, FORCE * rate_hz, rate_hz);
        let above = reading.iter().zip(&x).map(|(y, x)| y - x).collect();
        Self { above, velocity: smooth(&v), acceleration: smooth(&a), speed: v }
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

/// Speed below which a body may as well stand: four standard deviations of the noise of its velocity, by what of the
/// reading lies above the low-pass of the position.
pub(super) fn least_speed(reading: &[f64], x: &[f64], rate_hz: f64) -> f64 {
    let above: Vec<f64> = reading.iter().zip(x).map(|(y, x)| y - x).collect();
    4.0 * of_velocity(&above, rate_hz)
}

/// Standard deviation of the noise of the velocity, from the reading above the low-pass of the position.
fn of_velocity(above: &[f64], rate_hz: f64) -> f64 {
    let impulse = Impulse::of(rate_hz);
    let middle = order::median(above.iter().map(|e| e.abs()).collect()).unwrap_or_default();
    // The ends of the recording are no noise: a median is 0.6745 standard deviations.
    middle / 0.6745 * (power(&impulse.speed) / power(&impulse.above)).sqrt()
}

/// Sum of the squares of a response.
pub(super) fn power(response: &[f64]) -> f64 {
    response.iter().map(|h| h * h).sum()
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
