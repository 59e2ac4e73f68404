//! The oscillator that effects are put on: resonance, quality, rate, rows, input, noise, units, all
//! over wide ranges.

use std::f64::consts::{PI, TAU};

use super::columns::Columns;
use super::draw::Draw;
use super::driven::{Driven, rms};
use super::oscillator::Oscillator;
use super::readout::Noise;
use super::simulate;
use super::wave::Shape;

/// Kind of input that a family needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// Any input.
    Any,
    /// One that excites the resonance from many sides: no single sine, no ring-down.
    Rich,
    /// Free ring-down.
    RingDown,
    /// One sine.
    Sine,
    /// With a static force of the size of the vibration.
    OperatingPoint,
}

/// Limit on the length of recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Rows of the longest recording.
    pub rows: usize,
}

fn input(draw: &mut Draw, wish: Wish, f0: f64, rate_hz: f64, rows: usize, seed: u64) -> Shape {
    let length_s = rows as f64 / rate_hz;
    let top = (3.0 * f0).min(0.4 * rate_hz);
    let bottom = (0.1 * f0).max(2.0 / length_s).min(0.5 * top);
    let sine = |draw: &mut Draw, low: f64, high: f64| {
        [1.0, (f0 * draw.log_between(low, high)).min(0.4 * rate_hz), TAU * draw.unit()]
    };
    let which = match wish {
        Wish::RingDown => return Shape::None,
        Wish::Sine => 8,
        Wish::Any => draw.below(11),
        Wish::Rich | Wish::OperatingPoint => draw.below(8),
    };
    match which {
        0 | 1 => {
            let periods = draw.one_of(&[1.0, 1.0, 2.0, 4.0, 8.0]);
            let count = 8 + draw.below(60);
            Shape::Lines { count, from_hz: bottom, to_hz: top, of_hz: periods / length_s, odd_only: which == 1, seed }
        }
        2 | 3 => {
            let to_hz = top * draw.between(0.6, 1.0);
            Shape::Lines {
                count: 150,
                from_hz: bottom,
                to_hz: to_hz.max(2.0 * bottom),
                of_hz: 0.0,
                odd_only: false,
                seed,
            }
        }
        4 | 5 => {
            let times = draw.one_of(&[1.0, 1.0, 3.0]);
            let ends = if draw.chance(0.3) { [top, bottom] } else { [bottom, top] };
            Shape::Sweep { from_hz: ends[0], to_hz: ends[1], length_s: length_s / times, exponential: draw.chance(0.5) }
        }
        6 => {
            let count = 6 + draw.below(20);
            let mut at_s: Vec<f64> = (0..count).map(|_| length_s * draw.between(0.0, 0.98)).collect();
            at_s.sort_by(f64::total_cmp);
            let levels = (0..count).map(|_| draw.normal()).collect();
            Shape::Steps { at_s, levels, rise_s: (0.08 / f0).max(3.0 / rate_hz) }
        }
        7 => {
            let count = 1 + draw.below(6);
            let at_s = (0..count).map(|k| length_s * (k as f64 + draw.between(0.02, 0.3)) / count as f64).collect();
            let peaks = (0..count).map(|_| draw.sign() * draw.between(0.5, 2.0)).collect();
            Shape::Shocks { at_s, peaks, length_s: (draw.log_between(0.25, 1.5) / f0).max(7.0 / rate_hz) }
        }
        8 => Shape::Sines { lines: vec![sine(draw, 0.3, 1.6)] },
        9 => Shape::Sines { lines: vec![sine(draw, 0.4, 0.95), sine(draw, 1.05, 1.8)] },
        _ => Shape::None,
    }
}

/// A linear oscillator with noise, its reading of rms one. None when the draw was unlucky.
fn attempt(draw: &mut Draw, wish: Wish, size: Size) -> Option<Driven> {
    let rows = draw.log_between(2000.0f64.min(size.rows as f64), size.rows as f64) as usize;
    let per_cycle = draw.log_between(2.5, 500.0);
    let cycles = rows as f64 / per_cycle;
    if cycles < 10.0 {
        return None;
    }
    let f0 = draw.log_between(0.5, 20_000.0);
    let rate_hz = f0 * per_cycle;
    let seed = draw.bits() >> 12;
    let input = input(draw, wish, f0, rate_hz, rows, seed);
    let ring = input == Shape::None;
    let quality = match ring {
        true => (PI * cycles / draw.between(1.5, 8.0)).clamp(3.0, 3000.0),
        false => draw.log_between(3.0, 3000.0),
    };
    if ring && PI * cycles / quality > 30.0 {
        // Most of the recording would be noise.
        return None;
    }
    let begins_at_rest = matches!(input, Shape::Steps { .. } | Shape::Shocks { .. }) || ring || draw.chance(0.4);
    let settling = draw.between(0.0, 3.0 * quality).min(100.0) * per_cycle;
    let before = if begins_at_rest { 0 } else { settling.min(5000.0) as usize };
    let phase = TAU * draw.unit();
    let omega = TAU * f0;
    let held = matches!(input, Shape::Lines { .. } | Shape::Steps { .. }) && draw.chance(0.3);
    let mut oscillator = Oscillator {
        seed,
        rate_hz,
        rows,
        omega,
        zeta: 0.5 / quality,
        gain: omega * omega,
        start: if ring { [2.0 * phase.cos(), 2.0 * omega * phase.sin()] } else { [0.0; 2] },
        before,
        input,
        held,
        constant: 0.0,
        hidden: 0.0,
        laws: Vec::new(),
        readout: Vec::new(),
        environment: None,
        input_lag_s: 0.0,
        input_noise: 0.0,
        jitter: 0.0,
        slip: None,
    };
    let signal = simulate::run(&oscillator, rows)?.signal;
    let loud = rms(&signal);
    if !ring {
        oscillator.gain /= loud;
    } else if loud < 0.02 {
        return None;
    } else {
        oscillator.start.iter_mut().for_each(|s| *s /= loud);
    }
    if wish == Wish::OperatingPoint {
        let sag = draw.log_between(0.5, 4.0) * draw.sign();
        if draw.chance(0.5) {
            oscillator.constant = sag * omega * omega / oscillator.gain;
        } else {
            oscillator.hidden = sag * omega * omega;
        }
        // It has hung there before the recording begins.
        oscillator.start = [sag, 0.0];
    }
    let sigma = 10f64.powf(-draw.between(10.0, 80.0) / 20.0);
    let mut columns = Columns::draw(draw);
    if columns.step > 0.0 && columns.output_scale.abs() * sigma < 1.0 {
        // Counts as coarse as the noise would be an effect of their own.
        columns.step = 0.0;
    }
    Some(Driven { oscillator, noise: Noise::Gauss, sigma, columns, hint: draw.chance(0.25) })
}

/// Draws until something sensible stands.
pub(crate) fn stage(draw: &mut Draw, wish: Wish, size: Size) -> Driven {
    loop {
        if let Some(driven) = attempt(draw, wish, size) {
            return driven;
        }
    }
}
