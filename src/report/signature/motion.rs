//! Pictures of an IMU in motion next to a reference: clocks, mounting, and the noise of both, by the equations of
//! their candidates.

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation3, Vector3};
use proofmass_physics::signature::{Axis, Curve, Picture, over_largest};

/// Points of a curve.
const POINTS: usize = 201;
/// Size of a fault that is seen next to what it acts on.
const SEEN: f64 = 0.1;
/// Frequency of a vibration, in lines of the spectrum, and the amplitude of its line over the noise.
const VIBRATION: (f64, f64) = (60.0, 30.0);
/// Lines of that spectrum.
const LINES: f64 = 100.0;
/// Frequency at which the noise of a reference is as large as that of the IMU, over the sampling rate.
const EQUAL: f64 = 0.02;

/// Returns the picture of a candidate of a flight, if a curve over one thing shows it.
pub(super) fn picture(id: &str) -> Option<Picture> {
    Some(match id {
        "time-offset" => late(),
        "clock-drift" => later_and_later(),
        "mounting" => {
            let read = |along: Vector3<f64>| Rotation3::from_scaled_axis(Vector3::z() * -SEEN) * along;
            let (of_x, of_y) = (read(Vector3::x()).y, read(Vector3::y()).x);
            rates(&[("read about y, of a turn about x", of_x), ("read about x, of a turn about y", of_y)])
        }
        "axis-swap" => rates(&[("read about y of a turn about x, and the reverse", 1.0)]),
        "lever-arm" => on_an_arm(),
        "vibration" => line(),
        "reference-noise" => differenced(),
        _ => return None,
    })
}

fn parts() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|i| i as f64 / (POINTS - 1) as f64)
}

fn both_ways() -> impl Iterator<Item = f64> {
    parts().map(|part| 2.0 * part - 1.0)
}

fn curve(name: &'static str, points: Vec<(f64, f64)>) -> Curve {
    Curve { name, is_guide: false, points }
}

fn guide(name: &'static str, points: Vec<(f64, f64)>) -> Curve {
    Curve { name, is_guide: true, points }
}

/// A rate that swings, by the reference and by an IMU whose stamps are late.
fn late() -> Picture {
    let swing = |late: f64| parts().map(|t| (t, (TAU * (t - late)).sin())).collect();
    let (x, y) = (Axis::linear("time / period"), Axis::linear("rate / largest"));
    Picture { x, y, curves: vec![guide("reference", swing(0.0)), curve("IMU", swing(SEEN))] }
}

/// Time between the clocks over the recording.
fn later_and_later() -> Picture {
    let apart = parts().map(|t| (t, 2.0 * (t - 0.5))).collect();
    let (x, y) = (Axis::linear("time / length of the recording"), Axis::linear("time between the clocks / largest"));
    Picture { x, y, curves: vec![guide("", vec![(0.0, 0.0), (1.0, 0.0)]), curve("", apart)] }
}

/// Rates that are read across the axis of the turn, by their part of the true one.
fn rates(read: &[(&'static str, f64)]) -> Picture {
    let of = |part: f64| both_ways().map(|rate| (rate, part * rate)).collect();
    let (x, y) = (Axis::linear("true rate / largest"), Axis::linear("reading / largest true rate"));
    let none = guide("true", vec![(-1.0, 0.0), (1.0, 0.0)]);
    let curves = read.iter().map(|(name, part)| curve(name, of(*part)));
    Picture { x, y, curves: std::iter::once(none).chain(curves).collect() }
}

/// Specific force along an arm, ω × (ω × l), over a steady rate across it.
fn on_an_arm() -> Picture {
    let force = |rate: f64| {
        let (turn, arm) = (Vector3::z() * rate, Vector3::x());
        turn.cross(&turn.cross(&arm)).x
    };
    let points = over_largest(both_ways().map(|rate| (rate, force(rate))).collect());
    let (x, y) = (Axis::linear("rate across the arm / largest"), Axis::linear("extra force along it / largest"));
    Picture { x, y, curves: vec![guide("", vec![(-1.0, 0.0), (1.0, 0.0)]), curve("", points)] }
}

/// A line in the spectrum of white noise, as a Hann window shows it.
fn line() -> Picture {
    let sinc = |d: f64| if d == 0.0 { 1.0 } else { (PI * d).sin() / (PI * d) };
    let window = |d: f64| sinc(d) + 0.5 * (sinc(d - 1.0) + sinc(d + 1.0));
    let density = |f: f64| (1.0 + (VIBRATION.1 * window(f - VIBRATION.0)).powi(2)).sqrt();
    let frequencies = (1..=4 * LINES as usize).map(|i| 0.25 * i as f64);
    let points = frequencies.map(|f| (f / LINES, density(f))).collect();
    let (x, y) = (Axis::linear("frequency / half the sampling rate"), Axis::log("amplitude density / noise"));
    Picture { x, y, curves: vec![guide("at rest", vec![(0.0, 1.0), (1.0, 1.0)]), curve("in motion", points)] }
}

/// Density of a rate that is differenced from orientations with white noise, next to white noise of the gyro.
fn differenced() -> Picture {
    let size = |f: f64| 2.0 * (PI * f).sin();
    let frequencies = || parts().map(|part| 0.5 * 1000f64.powf(part - 1.0));
    let both = |f: f64| (1.0 + (size(f) / size(EQUAL)).powi(2)).sqrt();
    let points = frequencies().map(|f| (f, both(f))).collect();
    let (x, y) = (Axis::log("frequency / sampling rate"), Axis::log("difference of the rates / noise of the gyro"));
    let alone = guide("gyro alone", vec![(0.0005, 1.0), (0.5, 1.0)]);
    Picture { x, y, curves: vec![alone, curve("with the reference's", points)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(picture: &Picture, which: usize, x: f64) -> f64 {
        let near = picture.curves[which].points.iter().min_by(|a, b| (a.0 - x).abs().total_cmp(&(b.0 - x).abs()));
        near.expect("a curve has points").1
    }

    #[test]
    fn a_turned_imu_reads_two_axes_with_opposite_signs_and_a_swap_with_the_same() {
        let [turned, swapped] = ["mounting", "axis-swap"].map(|id| picture(id).expect("it has a picture"));
        assert!((at(&turned, 1, 1.0) + SEEN.sin()).abs() < 1e-12 && (at(&turned, 2, 1.0) - SEEN.sin()).abs() < 1e-12);
        assert!(at(&swapped, 1, 1.0) == 1.0 && swapped.curves.len() == 2, "control");
    }

    // ω²l towards the axis; the control is a force in proportion.
    #[test]
    fn an_arm_pulls_inwards_with_the_square_of_the_rate() {
        let arm = picture("lever-arm").expect("it has a picture");
        let [full, half] = [1.0, 0.5].map(|rate| at(&arm, 1, rate));
        assert!((full + 1.0).abs() < 1e-12 && (half + 0.25).abs() < 1e-12 && at(&arm, 1, -1.0) == full);
        assert!((half - 0.5 * full).abs() > 0.2);
    }

    #[test]
    fn the_noise_of_a_reference_grows_with_frequency_and_is_equal_where_it_should_be() {
        let noise = picture("reference-noise").expect("it has a picture");
        assert!((at(&noise, 1, EQUAL) / 2f64.sqrt() - 1.0).abs() < 0.02);
        assert!(at(&noise, 1, 0.5) > 10.0 && at(&noise, 1, 0.0005) < 1.01);
    }
}
