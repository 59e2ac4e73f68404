//! The resonance of a mass with a law at three drives, by the first harmonic of the force.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::acting::{Acting, At, Own, ZETA};
use super::linear;
use super::picture::{Axis, Curve, Picture};

/// Drives, by the amplitude that each would have without the law at the resonance.
const DRIVES: [(f64, &str); 3] = [(0.5, "half the drive"), (1.0, "the drive"), (2.0, "twice the drive")];
/// Force of the law at the middle drive, over that of the damper: a dry friction then holds no mass, and a spring
/// bends the resonance of the largest drive.
const STRENGTH: f64 = 0.25;
/// Instants of one period over which the first harmonic is taken.
const INSTANTS: usize = 64;
/// Amplitudes of one curve, and the largest there may be, over that of the mass alone.
const AMPLITUDES: usize = 48;
const REACH: f64 = 2.0;
/// Halvings in which the largest amplitude of a curve is found.
const HALVINGS: usize = 20;
/// Frequencies over that of the resonance, and how many.
const BAND: (f64, f64) = (0.6, 1.8);
const FREQUENCIES: usize = 240;
/// Force below which a first harmonic is none, over that of the spring.
const NONE: f64 = 1e-9;

/// First harmonic of the force over the motion at an amplitude and a frequency, as its parts with and a
/// quarter of a period after the displacement: a damping force is −s sin φ where x = a cos φ.
fn harmonic(acting: &Acting, amplitude: f64, omega_rad_s: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for n in 0..INSTANTS {
        let (sin, cos) = (TAU * (n as f64 + 0.5) / INSTANTS as f64).sin_cos();
        let at = At { x: amplitude * cos, v: -amplitude * omega_rad_s * sin, ..At::default() };
        let force = acting.force(&at, &Own::default()).0;
        sum = [sum[0] + force * cos, sum[1] + force * sin];
    }
    sum.map(|s| 2.0 * s / (INSTANTS as f64 * amplitude))
}

/// Push that keeps up an amplitude at a frequency.
fn push(acting: Option<&Acting>, amplitude: f64, omega: f64) -> f64 {
    let [with, after] = acting.map_or([0.0; 2], |law| harmonic(law, amplitude, omega));
    amplitude * (1.0 - omega * omega - with).hypot(2.0 * ZETA * omega + after)
}

/// Frequencies at which a drive has this amplitude, from the lowest.
fn crossings(acting: Option<&Acting>, amplitude: f64, drive: f64) -> Vec<f64> {
    let frequency = |i: usize| BAND.0 + (BAND.1 - BAND.0) * i as f64 / (FREQUENCIES - 1) as f64;
    let (mut found, mut before) = (Vec::new(), push(acting, amplitude, BAND.0) - drive);
    for i in 1..FREQUENCIES {
        let now = push(acting, amplitude, frequency(i)) - drive;
        if before * now < 0.0 {
            found.push(frequency(i - 1) + (frequency(i) - frequency(i - 1)) * before / (before - now));
        }
        before = now;
    }
    found
}

/// Amplitude over frequency for a drive that would reach `most` in a linear resonance, up one side and down the other.
fn up_and_down(acting: Option<&Acting>, most: f64) -> Vec<(f64, f64)> {
    let all = |part: f64| crossings(acting, part * most, 2.0 * ZETA * most);
    let (mut top, mut above) = (0.0, REACH);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (top + above);
        if all(middle).is_empty() { above = middle } else { top = middle }
    }
    let (mut up, mut down) = (Vec::new(), Vec::new());
    // Closer together towards the top, where the curve is round.
    for part in (1..=AMPLITUDES).map(|i| top * (FRAC_PI_2 * i as f64 / AMPLITUDES as f64).sin()) {
        match all(part).as_slice() {
            [first, .., last] => {
                up.push((*first, part));
                down.push((*last, part));
            }
            // Below the lowest frequency the curve is not shown.
            [only] if up.is_empty() => down.push((*only, part)),
            _ => {}
        }
    }
    up.extend(down.into_iter().rev());
    up
}

/// The resonance at three drives; nothing for a law that is linear, has a memory or has no first harmonic.
pub(super) fn at_three_drives(acting: &Acting) -> Option<Picture> {
    let is_force = acting.term.role().acts_on_mass() && acting.states() == 0;
    if !is_force || linear::of(acting).is_some() {
        return None;
    }
    let [with, after] = harmonic(acting, 1.0, 1.0);
    let size = with.hypot(after);
    if size < NONE {
        return None;
    }
    let acting = acting.stronger(2.0 * ZETA * STRENGTH / size);
    let guide = Curve { name: "without it", is_guide: true, points: up_and_down(None, 1.0) };
    let law = DRIVES.map(|(most, name)| Curve { name, is_guide: false, points: up_and_down(Some(&acting), most) });
    let curves = std::iter::once(guide).chain(law).collect();
    let (x, y) = (Axis::linear("frequency / resonance"), Axis::linear("amplitude / that of the mass alone"));
    Some(Picture { x, y, curves })
}
