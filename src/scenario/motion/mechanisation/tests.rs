//! The navigator against closed forms: coning, the round trip, Schuler's oscillation, the vertical
//! channel.

use super::*;
use crate::motion::sources::{self, Section};
use crate::motion::trajectory::Sampling;
use crate::motion::truth::Truth;
use crate::units::{DEGREE, DEGREE_PER_HOUR, MILLI_G};

const EARTH: Earth = Earth { latitude_rad: Some(47.4 * DEGREE), height_m: 400.0, rotation: true };

fn truth(toml: &str, earth: &Earth, rate_hz: f64, duration_s: f64) -> Truth {
    let section: Section = proofmass_base::document::parse_toml("study.toml", toml).expect("read");
    let sampling = Sampling { rate_hz, duration_s, lever_arm_m: Vector3::new(0.3, -0.2, 0.1) };
    sources::trajectory(&section, duration_s).and_then(|t| t.truth(earth, sampling)).expect("made")
}

/// A motion that cones: the axis of a tilt `a` goes round once in 2π/Ω (Savage, 1998, part 1, §VI;
/// Goodman & Robinson, 1958).
fn coning(tilt: f64, turning: f64, interval_s: f64, steps: usize) -> Truth {
    let samples = (0..=steps).map(|k| {
        let (t, half) = (k as f64 * interval_s, 0.5 * tilt);
        let (sin, cos) = (turning * t).sin_cos();
        let attitude = nalgebra::Quaternion::new(half.cos(), 0.0, half.sin() * cos, half.sin() * sin);
        let rate = Vector3::new(-2.0 * half.sin().powi(2), -tilt.sin() * sin, tilt.sin() * cos) * turning;
        Sample {
            time_s: t,
            attitude: UnitQuaternion::from_quaternion(attitude),
            velocity_m_s: Vector3::zeros(),
            position_m: Vector3::zeros(),
            specific_force_m_s2: Vector3::zeros(),
            rate_rad_s: rate,
        }
    });
    Truth { interval_s, samples: samples.collect() }
}

#[test]
fn coning_drifts_as_the_closed_form_says() {
    let (tilt, turning, interval, steps) = (2.0 * DEGREE, std::f64::consts::TAU * 8.0, 0.01, 4000);
    let motion = coning(tilt, turning, interval, steps);
    let drift = |integrator| {
        let last = own_error(&Earth::FLAT, integrator, &motion).last().expect("samples").attitude_rad.x;
        last / (interval * steps as f64)
    };
    // A polygon of rotation vectors encloses less than the cone: ½ sin²a Ω (1 − sin ΩT/ΩT) is
    // missed; the cross product of neighbouring increments gives back sin²a sin²(ΩT/2) sin ΩT / 3T
    // of it.
    let (swing, amplitude) = (turning * interval, tilt.sin().powi(2));
    let missed = 0.5 * amplitude * turning * (1.0 - swing.sin() / swing);
    let returned = amplitude * (0.5 * swing).sin().powi(2) * swing.sin() / (3.0 * interval);
    let (single, compensated) = (drift(Integrator::SingleSample), drift(Integrator::Compensated));
    assert!((single.abs() / missed - 1.0).abs() < 2e-3, "{single:e}, closed form {missed:e}");
    let left = missed - returned;
    assert!((compensated.abs() / left - 1.0).abs() < 2e-2, "{compensated:e}, closed form {left:e}");
    assert!(single.abs() > 15.0 * compensated.abs(), "the compensation is seen: {single:e} {compensated:e}");
}

/// Largest attitude and position errors on a motion.
fn strays(earth: &Earth, integrator: Integrator, truth: &Truth) -> [f64; 2] {
    let all = own_error(earth, integrator, truth);
    let largest = |of: fn(&Difference) -> f64| all.iter().map(of).fold(0.0, f64::max);
    [largest(|d| d.attitude_rad.norm()), largest(|d| d.position_m.norm())]
}

#[test]
fn a_round_trip_without_noise_comes_back() {
    for toml in [
        "kind = \"rest\"\nheading_deg = 30.0",
        "kind = \"circle\"",
        "kind = \"circle\"\nstill_s = 5.0",
        "kind = \"figure-eight\"",
        "kind = \"waypoints\"\npoints_m = [[0, 0, 0], [100, 0, 0], [100, 80, -20], [0, 80, 0]]",
        "kind = \"car\"",
        "kind = \"drone\"",
    ] {
        for earth in [Earth::FLAT, EARTH] {
            let [attitude, position] = strays(&earth, Integrator::Compensated, &truth(toml, &earth, 200.0, 60.0));
            assert!(attitude <= 1e-6 && position <= 1e-3, "{toml}, {earth:?}: {attitude:e} rad, {position:e} m");
        }
        // A navigator that leaves out the Earth's rate does not come back.
        let still = Earth { rotation: false, ..EARTH };
        let [attitude, position] = strays(&still, Integrator::Compensated, &truth(toml, &EARTH, 200.0, 60.0));
        assert!(attitude > 1e-3 && position > 1e-1, "{toml}: {attitude:e} rad, {position:e} m");
    }
}

/// Errors at each second of a navigator at rest whose increments are disturbed, with the vertical
/// held or free.
fn disturbed(earth: &Earth, seconds: usize, [rate, force]: [Vector3<f64>; 2], held: bool) -> Vec<Difference> {
    let interval = 0.1;
    let motion = truth("kind = \"rest\"", earth, 1.0 / interval, 1.0);
    let (sample, increment) = (motion.samples[0], increments(&motion)[0]);
    let start = State::at_start(earth, &sample);
    let mut navigator = Navigator::new(*earth, Integrator::Compensated, interval, start);
    let increment = Increment {
        rotation_rad: increment.rotation_rad + rate * interval,
        velocity_m_s: increment.velocity_m_s + force * interval,
    };
    let mut step = || {
        for _ in 0..10 {
            navigator.step(increment);
            if held {
                navigator.state.hold_vertical(earth, &sample);
            }
        }
        Difference::of(&navigator.state, &sample)
    };
    (0..seconds).map(|_| step()).collect()
}

/// Largest departure from a law over two hours, as a share of the law's largest value.
fn departs(errors: &[Difference], of: fn(&Difference) -> f64, law: impl Fn(f64) -> f64) -> f64 {
    let laws: Vec<f64> = (1..=errors.len()).map(|k| law(k as f64)).collect();
    let amplitude = laws.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    errors.iter().zip(&laws).map(|(e, law)| (of(e) - law).abs()).fold(0.0, f64::max) / amplitude
}

#[test]
fn schuler_holds_biases_as_the_closed_forms_say() {
    // Level axes, vertical held, the Earth not turning: Titterton & Weston, §12.4, table 12.1.
    let still = Earth { rotation: false, ..EARTH };
    let radii = crate::motion::earth::Radii::at(47.4 * DEGREE);
    let gravity = still.gravity_m_s2(still.start());
    let (bias, drift, seconds) = (0.1 * MILLI_G, 0.01 * DEGREE_PER_HOUR, 7200);
    for (axis, radius) in [(0, radii.meridian_m + 400.0), (1, radii.prime_vertical_m + 400.0)] {
        let omega = (gravity / radius).sqrt();
        let of: fn(&Difference) -> f64 = if axis == 0 { |d| d.position_m.x } else { |d| d.position_m.y };
        let mut force = Vector3::zeros();
        force[axis] = bias;
        let errors = disturbed(&still, seconds, [Vector3::zeros(), force], true);
        let law = |t: f64| bias / omega.powi(2) * (1.0 - (omega * t).cos());
        assert!(departs(&errors, of, law) < 1e-3, "bias on axis {axis}: {}", departs(&errors, of, law));
        // Without Schuler's restoring force it is half b t².
        assert!(departs(&errors, of, |t| 0.5 * bias * t * t) > 0.5);

        // A rate about east tilts the north axis down, so that gravity pushes south; about north,
        // east.
        let mut rate = Vector3::zeros();
        rate[1 - axis] = drift;
        let errors = disturbed(&still, seconds, [rate, Vector3::zeros()], true);
        let sign = if axis == 0 { -1.0 } else { 1.0 };
        let law = |t: f64| sign * radius * drift * (t - (omega * t).sin() / omega);
        assert!(departs(&errors, of, law) < 1e-3, "rate on axis {}: {}", 1 - axis, departs(&errors, of, law));
        assert!(departs(&errors, of, |t| -law(t)) > 1.5);
    }
}

#[test]
fn the_free_vertical_channel_diverges_as_gravity_falls_with_height() {
    let still = Earth { rotation: false, ..EARTH };
    // Less than a kilometre in an hour: gravity falls in proportion.
    let (bias, seconds) = (1e-3 * MILLI_G, 3600);
    let up = Vector3::new(0.0, 0.0, -bias);
    let errors = disturbed(&still, seconds, [Vector3::zeros(), up], false);
    // h″ = b + λ²h with λ² = −dg/dh ≈ 2g/R.
    let at = |height_m| still.gravity_m_s2(Place { height_m, ..still.start() });
    let lambda = ((at(300.0) - at(500.0)) / 200.0).sqrt();
    let law = |t: f64| -bias / lambda.powi(2) * ((lambda * t).cosh() - 1.0);
    let departure = departs(&errors, |d| d.position_m.z, law);
    assert!(departure < 2e-3, "{departure}");
    assert!(departs(&errors, |d| d.position_m.z, |t| -0.5 * bias * t * t) > 0.5);
    // Held, it stays.
    let held = disturbed(&still, 600, [Vector3::zeros(), up], true);
    assert!(held.iter().all(|d| d.position_m.z == 0.0));
}
