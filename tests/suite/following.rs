//! Errors that follow temperature and stamps: each by its closed form, beside the linear
//! covariance, and on a GPU.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::flight::Quantity;
use proofmass::control::Control;
use proofmass::ensemble;
use proofmass::strapdown::answer::{Answer, LINEAR};
use proofmass::strapdown::backends::run_on;
use proofmass::strapdown::run::Ensemble;

use super::strapdown::{NOISE, answered, parsed, percentiles_apart, series};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("following: a bias that warms up moves by a sixth of its rate times t³", warming_bias),
        test("following: a scale factor that warms up reads gravity wrong", warming_scale),
        test("following: late stamps leave the navigator behind by the way of their delay", late),
        test("following: a clock that gains scales the time base of the way and of the turn", drifting),
        test("following: jitter is white noise by what the readings change by", jitter),
        test("following: what follows spreads as the linear covariance says", covariance),
        gpu_test("following: the GPU gives the CPU's percentiles", parity),
        test("following: keys without what they follow are refused in a sentence", refusals),
    ]
}

const G: f64 = 9.806_65;

fn last(answer: &Answer, quantity: Quantity) -> f64 {
    series(answer, quantity, |s| s.mean).last().copied().unwrap_or(f64::NAN)
}

fn warming(keys: &str, profile: &str) -> Result<Answer, Failed> {
    answered(&format!(
        "members = 64\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 100.0\n[trajectory]\nkind = \"rest\"\n[report]\n\
         times_s = [60.0]\n[temperature]\nprofile_s_deg_c = {profile}\n{keys}"
    ))
}

/// 30 K in 60 s at 10 µg/K: b′ = 5 µg/s, position b′ t³/6. A gyro's 2 °/h/K about east: tilt rate
/// ε′ t, north −g ε′ t⁴/24.
fn warming_bias() -> Result<(), Failed> {
    let ramp = "[[0.0, 20.0], [60.0, 50.0]]";
    let accelerometer = warming("[accelerometer]\nbias_temperature_ug_k = [10.0, 0.0, 0.0]\n", ramp)?;
    let expected_of = |kelvins_per_s: f64| 10e-6 * G * kelvins_per_s * 60.0f64.powi(3) / 6.0;
    let expected = expected_of(0.5);
    near("accelerometer", last(&accelerometer, Quantity::Position(0)), expected, 1e-3 * expected)?;
    check((expected - 2.0 * last(&accelerometer, Quantity::Position(0))).abs() > 1e-3 * expected, "any slope fits")?;
    let gyro = warming("[gyro]\nbias_temperature_deg_h_k = [0.0, 2.0, 0.0]\n", ramp)?;
    let expected = -G * 2.0 * std::f64::consts::PI / 180.0 / 3600.0 * 0.5 * 60.0f64.powi(4) / 24.0;
    near("gyro", last(&gyro, Quantity::Position(0)), expected, 1e-3 * expected.abs())?;
    // With a lag of 9 s the warmth stays 4.5 K (1 − e^(−t/9)) behind: b (t²/2 − 9 t + 81 (1 − e^(−t/9)))
    // less in position.
    let late = warming("[accelerometer]\nbias_temperature_ug_k = [10.0, 0.0, 0.0]\n", &format!("{ramp}\nlag_s = 9.0"))?;
    let behind = 1800.0 - 540.0 + 81.0 * (1.0 - (-60.0f64 / 9.0).exp());
    let lagging = expected_of(0.5) - 10e-6 * G * 4.5 * behind;
    near("with a lag", last(&late, Quantity::Position(0)), lagging, 1e-3 * lagging)?;
    // Of the square, c (t/2)²: c t⁴/48 of an accelerometer; of the cube of a gyro, −g c t⁶/960.
    let square = warming("[accelerometer]\nbias_temperature_ug_k2 = [0.0, 1.0, 0.0]\n", ramp)?;
    let expected = 1e-6 * G * 60.0f64.powi(4) / 48.0;
    near("square", last(&square, Quantity::Position(1)), expected, 1e-3 * expected)?;
    near("square of another axis", last(&square, Quantity::Position(0)), 0.0, 1e-9)?;
    let cube = warming("[gyro]\nbias_temperature_deg_h_k3 = [0.0, 0.01, 0.0]\n", ramp)?;
    let expected = -G * 0.01 * std::f64::consts::PI / 180.0 / 3600.0 * 60.0f64.powi(6) / 960.0;
    near("cube", last(&cube, Quantity::Position(0)), expected, 1e-3 * expected.abs())?;
    // Control: at the reference nothing follows.
    let all = "[accelerometer]\nbias_temperature_ug_k = [10.0, 0.0, 0.0]\nbias_temperature_ug_k2 = 10.0\n";
    let cold = warming(all, "[[0.0, 20.0]]")?;
    near("at the reference", last(&cold, Quantity::Position(0)), 0.0, 1e-9)
}

/// 10 K above the reference at 100 ppm/K reads gravity, −g along z, a thousandth wrong: down −½ ·
/// 1e-3 g t².
fn warming_scale() -> Result<(), Failed> {
    let keys = "reference_deg_c = 20.0\n[accelerometer]\nscale_temperature_ppm_k = 100.0\n";
    let answer = warming(keys, "[[0.0, 30.0]]")?;
    let expected = -0.5 * 1e-3 * G * 3600.0;
    near("down", last(&answer, Quantity::Position(2)), expected, 1e-3 * expected.abs())?;
    near("north", last(&answer, Quantity::Position(0)), 0.0, 1e-6)?;
    check(last(&warming(keys, "[[0.0, 25.0]]")?, Quantity::Position(2)) > 0.6 * expected, "any temperature fits")?;
    let gyro = "reference_deg_c = 20.0\n[gyro]\nscale_temperature_ppm_k = 100.0\n";
    near("a gyro at rest", last(&warming(gyro, "[[0.0, 30.0]]")?, Quantity::Attitude(2)), 0.0, 1e-9)
}

/// What is stamped τ late is where the vehicle was: position −v τ, heading −ω τ (first order).
fn late() -> Result<(), Failed> {
    let at = |offset_us: f64| {
        answered(&format!(
            "members = 64\nduration_s = 40.0\n[sensor]\nsample_rate_hz = 200.0\ntime_offset_us = {offset_us:?}\n\
             [trajectory]\nkind = \"car\"\n[report]\ntimes_s = [5.0, 12.0, 20.0, 27.0, 33.0, 40.0]\n"
        ))
    };
    let answer = at(1000.0)?;
    let truth = &answer.flight.course.truth;
    let fastest = truth.samples.iter().map(|s| s.velocity_m_s.norm()).fold(0.0, f64::max);
    let all = |answer: &Answer, tau_s: f64| -> Result<(), Failed> {
        for axis in 0..2 {
            for (got, time_s) in
                series(answer, Quantity::Position(axis), |s| s.mean).iter().zip(answer.report_times_s())
            {
                let speed = truth.samples[(time_s * 200.0).round() as usize].velocity_m_s[axis];
                near(&format!("axis {axis} after {time_s} s"), *got, -tau_s * speed, 0.02 * tau_s * fastest)?;
            }
        }
        Ok(())
    };
    check(fastest > 3.0, "the car hardly moves")?;
    all(&answer, 1e-3)?;
    check(all(&answer, 2e-3).is_err() && all(&answer, -1e-3).is_err(), "any offset fits")
}

/// A clock that gains d stretches the time base: what is stamped t was read at t − d t. So a way q
/// from rest is computed as q(t − d t)/(1 − d)², a turn ψ as ψ(t − d t)/(1 − d): to first order the
/// errors are d (2q − t q′) and d (ψ − t ψ′). Full speed, 10 m/s, is reached smoothly from 1 s to
/// 11 s; from there on q = 10 t − 60, along a line and around a circle of 30 m.
fn drifting() -> Result<(), Failed> {
    let times_s = [14.0, 27.0, 40.0];
    let at = |drift_ppm: f64, motion: &str| {
        answered(&format!(
            "members = 64\nduration_s = 40.0\n[sensor]\nsample_rate_hz = 200.0\nclock_drift_ppm = {drift_ppm:?}\n\
             [trajectory]\n{motion}\nspeed_m_s = 10.0\nstill_s = 1.0\n[report]\ntimes_s = {times_s:?}\n"
        ))
    };
    let line = at(500.0, "kind = \"waypoints\"\npoints_m = [[0.0, 0.0, 0.0], [240.0, 320.0, 0.0]]")?;
    let circle = at(500.0, "kind = \"circle\"\nradius_m = 30.0")?;
    let fits = |drift: f64| -> Result<(), Failed> {
        for (k, time_s) in times_s.into_iter().enumerate() {
            for (axis, share) in [0.6, 0.8].into_iter().enumerate() {
                let law = drift * share * (2.0 * (10.0 * time_s - 60.0) - 10.0 * time_s);
                let got = series(&line, Quantity::Position(axis), |s| s.mean)[k];
                near(&format!("axis {axis} after {time_s} s"), got, law, 1e-3 * 500e-6 * 280.0)?;
            }
            let law = drift * -60.0 / 30.0;
            let got = series(&circle, Quantity::Attitude(2), |s| s.mean)[k];
            near(&format!("heading after {time_s} s"), got, law, 1e-3 * 1e-3)?;
        }
        Ok(())
    };
    fits(500e-6)?;
    check(fits(505e-6).is_err() && fits(-500e-6).is_err() && fits(0.0).is_err(), "any drift fits")?;
    // Its row in the error budget, of the linear model, is the same way.
    let row = line.parts().find(|part| part.cause.name() == "clock drift").ok_or("no row in the error budget")?;
    for axis in 0..2 {
        let ensemble = series(&line, Quantity::Position(axis), |s| s.mean);
        for (k, place) in line.report.iter().enumerate() {
            near("row of the budget", row.mean[*place][axis], ensemble[k], 0.01 * ensemble[k].abs() + 1e-4)?;
        }
    }
    Ok(())
}

/// Samples a time τₙ late read −τₙ ḟ: a sum of independent errors, whose velocity has the variance
/// Σ σ² |ḟₙ|² Δt² along an axis that keeps its direction.
fn jitter() -> Result<(), Failed> {
    let members = 4096;
    let at = |jitter_us: f64| {
        answered(&format!(
            "members = {members}\nduration_s = 8.0\n[sensor]\nsample_rate_hz = 100.0\ntime_jitter_us = {jitter_us:?}\n\
             [trajectory]\nkind = \"car\"\nstill_s = 1.0\n[report]\ntimes_s = [8.0]\n"
        ))
    };
    let answer = at(2000.0)?;
    let samples = &answer.flight.course.truth.samples;
    let force = |n: usize| samples[n].specific_force_m_s2.x;
    let square = |sigma_s: f64| (0..800).map(|n| (sigma_s * (force(n + 1) - force(n))).powi(2)).sum::<f64>();
    let heading = samples[0].attitude.euler_angles().2;
    check(samples[..=800].iter().all(|s| (s.attitude.euler_angles().2 - heading).abs() < 1e-6), "the car turns")?;
    let variance = |q: usize| answer.ensemble.summary(answer.report[0], Quantity::Velocity(q)).sd.powi(2);
    let ratio = |sigma_s: f64| ((variance(0) + variance(1)) / square(sigma_s)).sqrt();
    let four = 4.0 / (2.0 * f64::from(members)).sqrt();
    near("velocity", ratio(2e-3), 1.0, four)?;
    check((ratio(2.2e-3) - 1.0).abs() > four, "any jitter fits")
}

const DRIVE: &str = "members = 4096\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 50.0\n\
    time_offset_us = { mean = 0.0, sd = 5000.0 }\ntime_jitter_us = 3000.0\nclock_drift_ppm = { mean = 0.0, sd = 500.0 }\n[trajectory]\nkind = \"car\"\n[earth]\nlatitude_deg = 47.4\n\
    [temperature]\nprofile_s_deg_c = [[0.0, 20.0], [30.0, 60.0]]\nreference_deg_c = 25.0\n\
    [report]\ntimes_s = [10.0, 30.0, 60.0]\n";
const FOLLOWING: [&str; 2] = [
    "bias_temperature_ug_k = { mean = 0.0, sd = 30.0 }\nbias_temperature_ug_k2 = { mean = 0.0, sd = 2.0 }\n\
     bias_temperature_ug_k3 = { mean = 0.0, sd = 0.1 }\nscale_temperature_ppm_k = { mean = 0.0, sd = 50.0 }\n",
    "bias_temperature_deg_h_k = { mean = 0.0, sd = 1.0 }\nbias_temperature_deg_h_k2 = { mean = 0.0, sd = 0.05 }\n\
     scale_temperature_ppm_k = { mean = 0.0, sd = 50.0 }\n",
];

fn drive(start: &str) -> String {
    let noise = NOISE.replace("[gyro]\n", &format!("{}[gyro]\n{}", FOLLOWING[0], FOLLOWING[1]));
    format!("{DRIVE}{noise}[alignment]\n{start}")
}

fn covariance() -> Result<(), Failed> {
    for start in ["kind = \"ideal\"\n", "kind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.5\n"] {
        let answer = answered(&drive(start))?;
        let four = 4.0 / (2.0 * answer.ensemble.members as f64).sqrt();
        check(answer.apart.is_empty(), format!("{:?}", answer.apart))?;
        let ratio = |other: &Answer, q: usize| {
            let last = answer.report[2];
            answer.ensemble.summary(last, LINEAR[q]).sd / other.covariance.variance(last, q).sqrt()
        };
        (0..9).try_for_each(|q| near(&format!("{:?}", LINEAR[q]), ratio(&answer, q), 1.0, four))?;
        // Control: another profile is seen.
        let other = answered(&drive(start).replace("[30.0, 60.0]", "[30.0, 100.0]"))?;
        check((0..9).any(|q| (ratio(&other, q) - 1.0).abs() > four), "any profile spreads alike")?;
    }
    Ok(())
}

fn parity() -> Result<(), Failed> {
    let text = drive("kind = \"still\"\nstill_s = 3.1\n").replace("4096", "1024");
    let on = |choice, text: &str| -> Result<Ensemble, Failed> {
        let study = parsed(text)?;
        let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![7, 1500, 3000])?;
        Ok(run_on(choice, &flight, &Control::silent())?)
    };
    let (cpu, gpu) = (on(ensemble::Choice::Cpu, &text)?, on(ensemble::Choice::Gpu, &text)?);
    let other = on(ensemble::Choice::Cpu, &text.replace("sd = 30.0", "sd = 33.0"))?;
    let apart = |to: &Ensemble| percentiles_apart(&cpu, to, 3);
    check(gpu.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    check(apart(&gpu) < 5e-3, format!("percentiles {} sd apart", apart(&gpu)))?;
    check(apart(&other) > 5e-3, "a tenth more over temperature is not seen: the comparison is blind")
}

fn refusals() -> Result<(), Failed> {
    let rest = "[trajectory]\nkind = \"rest\"\n";
    let cases = [
        (String::new(), "[gyro]\nbias_temperature_deg_h_k = 1.0\n", "needs a [temperature]"),
        (String::new(), "[gyro]\nscale_temperature_ppm_k = 1.0\n", "does not rotate"),
        (String::new(), "[gyro]\nscale_factor_ppm = 1.0\n", "does not rotate"),
        (String::new(), "[sensor]\ntime_offset_us = 1.0\n", "has no trajectory"),
        (String::new(), "[sensor]\nclock_drift_ppm = 1.0\n", "has no trajectory"),
        (rest.to_owned(), "[gyro]\nbias_temperature_deg_h_k = 1.0\n", "needs a [temperature]"),
        (rest.to_owned(), "[gyro]\nbias_temperature_deg_h_k2 = 1.0\n", "`gyro.bias_temperature_deg_h_k2` needs a"),
        (rest.to_owned(), "[sensor]\ntime_offset_us = [1.0, 2.0, 3.0]\n", "one clock"),
        (rest.to_owned(), "[sensor]\nclock_drift_ppm = [1.0, 2.0, 3.0]\n", "one clock"),
        (
            rest.to_owned(),
            "[temperature]\nprofile_s_deg_c = [[5.0, 20.0], [1.0, 30.0]]\n",
            "times not below 0 and increasing",
        ),
        (rest.to_owned(), "[temperature]\nprofile_s_deg_c = [[-5.0, 20.0], [1.0, 30.0]]\n", "times not below 0"),
        (rest.to_owned(), "[temperature]\nprofile_s_deg_c = [[0.0, -300.0]]\n", "in °C"),
        (rest.to_owned(), "[temperature]\nprofile_s_deg_c = [[0.0, 20.0]]\nlag_s = -1.0\n", "`temperature.lag_s`"),
    ];
    for (first, text, expected) in cases {
        match parsed(&format!("duration_s = 1.0\n{first}{text}")) {
            Ok(_) => return Err(format!("accepted: {text}").into()),
            Err(error) => {
                let words = error.message().unwrap_or_default().to_owned();
                check(words.contains(expected), format!("{text}: {words}"))?;
            }
        }
    }
    Ok(())
}
