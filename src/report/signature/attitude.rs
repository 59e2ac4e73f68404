//! Pictures of an IMU in other attitudes, at other rates and over time: what a calibration without a fault makes
//! of the readings of a sensor that has it, by the calibration of `diagnosis`.
//!
//! A calibration undoes a fault, so that one with the opposite fault does it.

use std::f64::consts::PI;

use proofmass_diagnosis::tumble::calibration::{Calibration, Point, Slow, accelerometer, gyro};
use proofmass_physics::candidate::{Candidate, Kind};
use proofmass_physics::signature::{Axis, Curve, Picture, over_largest};

/// Size of a fault of which the shape is shown, over what it acts on: its square is nothing next to it.
const SMALL: f64 = 1e-4;
/// Size of a fault that is seen next to what it acts on.
const SEEN: f64 = 0.1;
/// Points of a curve.
const POINTS: usize = 181;

type Places = std::ops::Range<usize>;

/// Returns the picture of a candidate of an IMU, if a curve over one thing shows it.
pub(super) fn picture(candidate: &Candidate) -> Option<Picture> {
    Some(match (candidate.kind, candidate.id) {
        (Kind::Tumble, "scale-factor") => length(&[("one axis", accelerometer::AXIS_SCALE.start)]),
        (Kind::Tumble, "misalignment") => length(&[("two axes", accelerometer::MISALIGNMENT.start)]),
        (Kind::Tumble, "scale-nonlinearity") => length(&[
            ("k₂ of one axis", accelerometer::QUADRATIC.start),
            ("k₃ of one axis", accelerometer::CUBIC.start),
        ]),
        (Kind::Tumble, "local-gravity") => length(&[("all axes", accelerometer::SCALE.start)]),
        (Kind::Tumble, "temperature-sensitivity") => over_temperature(),
        (Kind::Tumble | Kind::Trajectory, "g-sensitivity") => gyro_at_rest(g_sensitive),
        (Kind::Tumble | Kind::Trajectory, "earth-rate") => gyro_at_rest(turned_by_the_earth),
        (Kind::Tumble, "slow-drift") => over_time(&["n = 1", "n = 2", "n = 3"]),
        (Kind::Trajectory, "gyro-bias" | "accelerometer-bias") => over_time(&["a₁", "a₂"]),
        (Kind::Trajectory, "scale-factor") => rate(gyro::AXIS_SCALE, "read about the same axis"),
        (Kind::Trajectory, "misalignment") => rate(gyro::MISALIGNMENT, "read about another axis"),
        _ => return None,
    })
}

/// A calibration without offsets, in units of what is measured, with a fault at these places.
fn calibration(places: Places, size: f64) -> Calibration {
    let mut point: Point = std::array::from_fn(|_| 0.0);
    (point[accelerometer::SCALE.start], point[gyro::SCALE.start]) = (1.0, 1.0);
    point[places].iter_mut().for_each(|value| *value -= size);
    Calibration::from_point(&point)
}

/// Angles of one turn about a horizontal axis, with the specific force, of length one, on x and y.
fn turn() -> impl Iterator<Item = (f64, [f64; 3])> {
    (0..POINTS).map(|i| 360.0 * i as f64 / (POINTS - 1) as f64).map(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        (angle, [sin, cos, 0.0])
    })
}

fn none(to: f64) -> Curve {
    Curve { name: "", is_guide: true, points: vec![(0.0, 0.0), (to, 0.0)] }
}

const TURN: Axis = Axis::linear("turn about a horizontal axis / °");

/// Error of the length of the specific force over one turn, for each of some faults.
fn length(faults: &[(&'static str, usize)]) -> Picture {
    let error = |place: usize| {
        let calibration = calibration(place..place + 1, SMALL);
        let length = move |f| calibration.specific_force_m_s2(f, &Slow::default()).norm();
        over_largest(turn().map(|(angle, f)| (angle, length(f) - 1.0)).collect())
    };
    let curves = faults.iter().map(|(name, place)| Curve { name, is_guide: false, points: error(*place) });
    let curves = std::iter::once(none(360.0)).chain(curves).collect();
    Picture { x: TURN, y: Axis::linear("error of the specific force / largest"), curves }
}

/// Reading of a gyro at rest over one turn.
fn gyro_at_rest(read: impl Fn([f64; 3]) -> f64) -> Picture {
    let points = over_largest(turn().map(|(angle, along)| (angle, read(along))).collect());
    let law = Curve { name: "", is_guide: false, points };
    Picture { x: TURN, y: Axis::linear("rate read at rest / largest"), curves: vec![none(360.0), law] }
}

/// Rate that the specific force makes.
fn g_sensitive(force: [f64; 3]) -> f64 {
    let (sound, faulty) =
        (calibration(0..0, 0.0), calibration(gyro::G_SENSITIVITY.start..gyro::G_SENSITIVITY.start + 1, SMALL));
    let force = sound.specific_force_m_s2(force, &Slow::default());
    faulty.rate_rad_s([0.0; 3], &force, &Slow::default()).x
}

/// The Earth's rate about one axis; it stands across the axis of the turn.
fn turned_by_the_earth(along: [f64; 3]) -> f64 {
    let sound = calibration(0..0, 0.0);
    sound.rate_rad_s(along, &(sound.g_sensitivity.column(0) * 0.0), &Slow::default()).x
}

/// Offset over the temperature.
pub(super) fn over_temperature() -> Picture {
    let faulty = calibration(accelerometer::TEMPERATURE.start..accelerometer::TEMPERATURE.start + 1, SMALL);
    let read = |covariate: f64| faulty.specific_force_m_s2([0.0; 3], &Slow { covariate, ..Slow::default() }).x;
    let part = |i: usize| 2.0 * i as f64 / (POINTS - 1) as f64 - 1.0;
    let points = over_largest((0..POINTS).map(part).map(|t| (t, read(t))).collect());
    let guide = Curve { name: "", is_guide: true, points: vec![(-1.0, 0.0), (1.0, 0.0)] };
    let law = Curve { name: "", is_guide: false, points };
    let x = Axis::linear("temperature from its mean / largest");
    Picture { x, y: Axis::linear("offset / largest"), curves: vec![guide, law] }
}

/// Readings over a rate about one axis, y.
fn rate(places: Places, name: &'static str) -> Picture {
    let is_scale = places == gyro::AXIS_SCALE;
    let faulty = calibration(places, SEEN);
    let read = |rate: f64| {
        let read = faulty.rate_rad_s([0.0, rate, 0.0], &(faulty.g_sensitivity.column(0) * 0.0), &Slow::default());
        if is_scale { read.y } else { read.x }
    };
    let points = (0..POINTS).map(|i| 2.0 * i as f64 / (POINTS - 1) as f64 - 1.0).map(|rate| (rate, read(rate)));
    let law = Curve { name, is_guide: false, points: points.collect() };
    let (x, y) = (Axis::linear("true rate / largest"), Axis::linear("reading / largest true rate"));
    let guide = Curve { name: "true", is_guide: true, points: vec![(-1.0, -1.0), (1.0, 1.0)] };
    Picture { x, y, curves: vec![guide, law] }
}

/// Parts of an offset that changes slowly over the recording.
fn over_time(names: &[&'static str]) -> Picture {
    let part = |n: usize| {
        let calibration = calibration(accelerometer::DRIFT.start + n..accelerometer::DRIFT.start + n + 1, SMALL);
        let read = |u: f64| {
            let cosines = std::array::from_fn(|k| ((k + 1) as f64 * PI * u).cos());
            calibration.specific_force_m_s2([0.0; 3], &Slow { covariate: 0.0, cosines }).x
        };
        let points = (0..POINTS).map(|i| i as f64 / (POINTS - 1) as f64).map(|u| (u, read(u)));
        over_largest(points.collect())
    };
    let curves = names.iter().enumerate().map(|(n, name)| Curve { name, is_guide: false, points: part(n) });
    let curves = std::iter::once(none(1.0)).chain(curves).collect();
    Picture { x: Axis::linear("time / length of the recording"), y: Axis::linear("offset / largest"), curves }
}
