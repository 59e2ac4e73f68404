//! A low-pass behind the proof mass and a late reading, in a study: gain, phase and drift by closed forms, on every
//! integrator, on the GPU, along a trajectory.
//!
//! A low-pass τy′ + y = a and a delay τ have the gain 1 for what is steady: of a change of velocity Δv both keep the
//! position error −τΔv, the integral of what they held back. Closed forms are written out here; see Ljung, System
//! Identification, 1999, ch. 2 (first-order lag and time delay).

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::Backend;
use proofmass::backend::cpu::{self, Cpu, Precision};
use proofmass::backend::flight::Quantity;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::control::Control;
use proofmass::ensemble::{Choice, Options, run_on};
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::sensor::Sensor;
use proofmass::statistics::Statistics;
use proofmass::statistics::quantity::{ACCELERATION, POSITION, VELOCITY};
use proofmass::strapdown::backends::run_on as fly;
use proofmass::study::{self, Study};
use proofmass::validation::jobs::{Sine, job, masses};

use super::motion_keys::Rows;
use super::strapdown::{answered, parsed, percentiles_apart};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("readout: gain and phase of a sine are those of the mass, its low-pass and a delay", sine),
        test("readout: of a pulse a low-pass and a delay keep the position error −τΔv", pulse),
        test("readout: what passes the mass by is not late, and a cube reads as a bias", past_the_mass),
        test("readout: under a step both drift by their closed form", step),
        test("readout: noise of the force passes the low-pass, noise of the reading does not", noise),
        test("readout: every integrator feels the low-pass of the same linear mass", integrators),
        test("readout: tiles do not change a bit of it", tiles),
        test("readout: along a straight line the position error is −τ times the velocity", in_motion),
        test("readout: vibration that begins with the run leaves a late reading no drift", late_vibration),
        test(
            "readout: a delay that is drawn, or beside a drawn sine, and a spring that drifts away are refused by name",
            refused,
        ),
        gpu_test("readout: the GPU gives what the CPU does, for every integrator", parity),
        gpu_test("readout: the GPU gives the CPU's percentiles along a trajectory", parity_in_motion),
    ]
}

fn read(text: &str) -> Result<Study, Failed> {
    Ok(study::parse("readout", text, Path::new(""))?)
}

/// A study in double precision, with statistics at its report times.
fn run(text: &str) -> Result<Statistics, Failed> {
    let study = read(text)?;
    let job = study.job(study.integrator()?.integrator, study.clock.report_samples.clone());
    Ok(run_on(&job, &mut Cpu { precision: Precision::F64, ..Cpu::default() }, &Options::default())?)
}

fn means(text: &str, quantity: usize) -> Result<Vec<f64>, Failed> {
    Ok(run(text)?.at.iter().map(|at| at[quantity].mean).collect())
}

/// 1 kHz, with these keys in `[sensor]`, this excitation and these report times.
fn text(sensor: &str, excitation: &str, times_s: &[f64]) -> String {
    let last = times_s.last().copied().unwrap_or(1.0);
    format!(
        "members = 2\nduration_s = {last:?}\n[sensor]\nsample_rate_hz = 1000.0\n{sensor}\
         [excitation]\n{excitation}\n[report]\ntimes_s = {times_s:?}\n"
    )
}

const MASS: &str = "resonance_hz = 12.0\ndamping_ratio = 0.4\n";

/// After two seconds nothing is left of the beginning. Within a step a line is tabulated: (ωh)²/12 off, 8e-5 at 5 Hz.
fn sine() -> Result<(), Failed> {
    let (amplitude, hertz) = (2.0, 5.0);
    let excitation = format!("kind = \"sine\"\namplitude_m_s2 = {amplitude:?}\nfrequency_hz = {hertz:?}");
    let times_s = [2.0, 2.03, 2.07, 2.11, 2.16];
    let omega = TAU * hertz;
    for (mass, resonance) in [("", None), (MASS, Some((TAU * 12.0, 0.4)))] {
        for (low_pass_s, delay_s) in [(0.02, 0.0), (0.0, 0.0137), (0.05, 0.021)] {
            let keys = format!("{mass}readout_lowpass_s = {low_pass_s:?}\nreadout_delay_s = {delay_s:?}\n");
            let got = means(&text(&keys, &excitation, &times_s), ACCELERATION)?;
            let expected = |low_pass_s: f64, delay_s: f64| {
                // 1/(1 + iωτ), ω₀²/(ω₀² − ω² + 2iζω₀ω): gain and phase of each.
                let (mut gain, mut phase) = (1.0 / omega.mul_add(low_pass_s, 0.0).hypot(1.0), omega * delay_s);
                phase += (omega * low_pass_s).atan();
                if let Some((w0, zeta)) = resonance {
                    let (real, imaginary) = (w0 * w0 - omega * omega, 2.0 * zeta * w0 * omega);
                    gain *= w0 * w0 / real.hypot(imaginary);
                    phase += imaginary.atan2(real);
                }
                let error = move |t: f64| amplitude * (gain * (omega * t - phase).sin() - (omega * t).sin());
                times_s.map(error)
            };
            let what = format!("{mass:?}, low-pass {low_pass_s} s, delay {delay_s} s");
            for (got, expected) in got.iter().zip(expected(low_pass_s, delay_s)) {
                near(&what, *got, expected, 2e-4 * amplitude)?;
            }
            // Control: a twentieth more of either is seen.
            let other = expected(1.05 * low_pass_s, 1.05 * delay_s);
            let apart = got.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            check(apart > 5e-3 * amplitude, format!("{what}: 5 % more differs by {apart}"))?;
        }
    }
    Ok(())
}

/// A pulse of 2 m/s² for one second.
const PULSE: &str = "kind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 1.0\nlength_s = 1.0";

fn pulse() -> Result<(), Failed> {
    let after = |keys: &str| -> Result<[f64; 2], Failed> {
        let all = run(&text(keys, PULSE, &[6.0]))?;
        Ok([POSITION, VELOCITY].map(|q| all.at[0][q].mean))
    };
    let bare = after("")?;
    for (keys, held_back_s) in [
        ("readout_lowpass_s = 0.05\n", 0.05),
        ("readout_delay_s = 0.05\n", 0.05),
        ("readout_lowpass_s = 0.05\nreadout_delay_s = 0.03\n", 0.08),
    ] {
        let [position, velocity] = after(keys)?;
        // The pulse is tabulated in steps of 1 ms, the same with and without.
        near(&format!("position after {keys}"), position - bare[0], -held_back_s * 2.0, 2e-6)?;
        near(&format!("velocity after {keys}"), velocity - bare[1], 0.0, 1e-6)?;
        // Control: a hundredth of it is seen.
        check((position - bare[0] + 1.01 * held_back_s * 2.0).abs() > 5e-4, "a hundredth more passes")?;
    }
    Ok(())
}

/// A part d of the force that passes the mass by adds d x to the position, late or not: the pulse
/// moves the sensor by 9 m. K₃ of a steady a reads as a bias K₃ a³: ½ K₃ a³ t².
fn past_the_mass() -> Result<(), Failed> {
    let at = |sensor: &str, accelerometer: &str, excitation: &str| -> Result<f64, Failed> {
        let text = text(sensor, excitation, &[6.0]);
        Ok(means(&format!("{text}[accelerometer]\n{accelerometer}\n"), POSITION)?[0])
    };
    let delay = "readout_delay_s = 0.05\n";
    let gained = at(delay, "feedthrough_ppm = 2000.0", PULSE)? - at(delay, "", PULSE)?;
    near("feedthrough beside a delay", gained, 2e-3 * 9.0, 2e-5)?;
    // A scale error is of the late reading: the same part of 2 m/s · 50 ms less.
    let scaled = at(delay, "scale_factor_ppm = 2000.0", PULSE)? - at(delay, "", PULSE)?;
    near("scale error beside a delay", scaled, 2e-3 * 8.9, 2e-5)?;
    check((gained - scaled).abs() > 1e-4, "late or not is the same (control)")?;
    let steady = "kind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 50.0";
    let k3 = 5000e-6 / (9.80665 * 9.80665);
    for low_pass in ["", "readout_lowpass_s = 0.01\n"] {
        let bent = at(low_pass, "k3_ug_per_g3 = 5000.0", steady)? - at(low_pass, "", steady)?;
        near("position of a cube", bent / (0.5 * k3 * 8.0 * 36.0), 1.0, 1e-3)?;
    }
    Ok(())
}

/// A step of a from 1 s on: a delay d makes the velocity error −a d and the position error −a d (s −
/// d/2) after s > d seconds; a low-pass −aτ(1 − e^(−s/τ)) and −aτ(s − τ(1 − e^(−s/τ))).
fn step() -> Result<(), Failed> {
    let excitation = "kind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 1.0\nlength_s = 50.0";
    let (a, tau) = (2.0, 0.4);
    let times_s = [1.5, 2.0, 3.0, 6.0];
    let left = |s: f64| 1.0 - (-s / tau).exp();
    let delay: fn(f64, f64, f64) -> [f64; 2] = |a, d, s| [-a * d, -a * d * (s - 0.5 * d)];
    for (key, law) in [
        ("readout_delay_s", &(|s: f64| delay(a, tau, s)) as &dyn Fn(f64) -> [f64; 2]),
        ("readout_lowpass_s", &|s: f64| [-a * tau * left(s), -a * tau * (s - tau * left(s))]),
    ] {
        let all = run(&text(&format!("{key} = {tau:?}\n"), excitation, &times_s))?;
        let bare = run(&text("", excitation, &times_s))?;
        for ((with, without), t) in all.at.iter().zip(&bare.at).zip(times_s) {
            let expected = law(t - 1.0);
            let of = |q: usize| with[q].mean - without[q].mean;
            // The edge falls within a step of 1 ms, half of which counts.
            near(&format!("{key}: velocity at {t} s"), of(VELOCITY), expected[0], 1.1e-3 * a)?;
            near(&format!("{key}: position at {t} s"), of(POSITION), expected[1], 1.1e-3 * a * (t - 1.0) + 1e-3)?;
        }
        // Control: at 1.5 s it is far from the other law.
        let other = if key == "readout_delay_s" { -a * tau * left(0.5) } else { -a * tau };
        let found = all.at[0][VELOCITY].mean - bare.at[0][VELOCITY].mean;
        check((found - other).abs() > 0.2, format!("{key}: {found} m/s is that of the other law too"))?;
    }
    Ok(())
}

/// White noise N through a low-pass, integrated: N²(t − 2τ(1 − e^(−t/τ)) + τ/2 (1 − e^(−2t/τ))). The
/// sd of 4096 members scatters by 1.1 %; of a mass at 40 Hz nothing is left at 5 s.
fn noise() -> Result<(), Failed> {
    let (tau, t) = (5.0, 5.0_f64);
    let n = 1e-3 * 9.80665 / 2f64.sqrt();
    let filtered = n * (t - 2.0 * tau * (1.0 - (-t / tau).exp()) + 0.5 * tau * (1.0 - (-2.0 * t / tau).exp())).sqrt();
    let text = |of: &str| {
        format!(
            "members = 4096\nduration_s = 5.0\n[sensor]\nsample_rate_hz = 200.0\nresonance_hz = 40.0\n\
             damping_ratio = 0.7\nreadout_lowpass_s = 5.0\n{of}[report]\ntimes_s = [5.0]\n"
        )
    };
    let sd = |of: &str| -> Result<f64, Failed> { Ok(run(&text(of))?.at[0][VELOCITY].sd) };
    let (force, reading) =
        (sd("force_noise_density_ug_rthz = 1000.0\n")?, sd("[accelerometer]\nnoise_density_ug_rthz = 1000.0\n")?);
    near("velocity noise of the force, filtered", force / filtered, 1.0, 0.06)?;
    near("velocity noise of the reading", reading / (n * t.sqrt()), 1.0, 0.06)?;
    // Control: the noise of the force is not what it is without the low-pass.
    check(force < 0.7 * n * t.sqrt(), "a low-pass of 5 s leaves the noise as it is")
}

/// One linear mass under a sine, as every integrator steps it; the cubic ones with a spring too weak
/// to act.
fn integrators() -> Result<(), Failed> {
    let sine = Sine { amplitude_m_s2: 2.0, frequency_hz: 5.0, offset_m_s2: 0.5 };
    let (mut mass, _) = masses()[0];
    (mass.natural_frequency_rad_s, mass.damping_ratio) = (TAU * 12.0, 0.4);
    let mut f64s = Cpu { precision: Precision::F64, ..Cpu::default() };
    let mut at = |integrator: Integrator, low_pass_s: f64| -> Result<Vec<f64>, Failed> {
        let mut sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
        sensor.accelerometer.readout_lowpass_s = low_pass_s;
        let job = job(sensor, 2, &[0.31, 0.52, 2.0], sine, integrator);
        Ok(run_on(&job, &mut f64s, &Options::default())?.at.iter().map(|at| at[ACCELERATION].mean).collect())
    };
    let exact = at(Integrator::ExactHold, 0.03)?;
    let without = at(Integrator::ExactHold, 0.0)?;
    for integrator in [
        Integrator::RungeKutta4 { substeps: 2 },
        Integrator::RungeKutta4General { substeps: 2 },
        Integrator::ExponentialRk2 { substeps: 2 },
        Integrator::RosenbrockEuler { substeps: 2 },
    ] {
        // The force within a step of 1 ms is a straight line for one, two or a parabola for others.
        for (a, b) in at(integrator, 0.03)?.iter().zip(&exact) {
            near(&format!("{integrator}"), *a, *b, 4e-4)?;
        }
    }
    let apart = exact.iter().zip(&without).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    check(apart > 0.1, format!("the low-pass moves the reading by {apart} (control)"))
}

/// A job with both, noise, and a member's own gain, for this integrator's mass.
fn everything(number: usize) -> Job {
    let (mass, integrator) = masses()[number];
    let mut sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
    sensor.accelerometer.readout_lowpass_s = 0.02;
    sensor.accelerometer.readout_delay_s = 0.013;
    sensor.accelerometer.scale_factor = 1e-3;
    sensor.accelerometer.range_m_s2 = 4.9;
    sensor.excitation_gain = 1.2;
    if let Some(mass) = &mut sensor.proof_mass {
        mass.force_noise_m_s_rts = 1e-3;
    }
    job(sensor, 512, &[0.5, 3.0], Sine { amplitude_m_s2: 5.0, frequency_hz: 3.0, offset_m_s2: 0.3 }, integrator)
}

fn tiles() -> Result<(), Failed> {
    for number in 0..masses().len() {
        let job = everything(number);
        let on = |tile_samples: u64| run_on(&job, &mut Cpu { tile_samples, ..Cpu::default() }, &Options::default());
        let (long, short) = (on(4096)?, on(17)?);
        check(long.at == short.at, format!("{}: tiles of 17 samples change it", job.integrator))?;
    }
    Ok(())
}

fn parity() -> Result<(), Failed> {
    let mut gpu = Ensembles::on(Arc::new(Gpu::open()?));
    for number in 0..masses().len() {
        let job = everything(number);
        let mut both = |job: &Job| -> Result<[Statistics; 2], Failed> {
            let options = Options::default();
            let on = |backend: &mut dyn Backend| run_on(job, backend, &options);
            Ok([on(&mut Cpu::default())?, on(&mut gpu)?])
        };
        let [here, there] = both(&job)?;
        let mut late = job.clone();
        let draw = job.draw.clone();
        late.draw = Arc::new(move |index| {
            let mut member = draw(index);
            member.sensor.accelerometer.readout_delay_s = 0.014;
            member
        });
        let [_, other] = both(&late)?;
        let apart = |a: &Statistics, b: &Statistics, q: usize| {
            let pairs = a.at.iter().zip(&b.at);
            pairs.map(|(a, b)| (a[q].mean - b[q].mean).abs() / (1.0 + a[q].mean.abs())).fold(0.0, f64::max)
        };
        for q in [ACCELERATION, VELOCITY, POSITION] {
            check(apart(&here, &there, q) < 2e-4, format!("{}: {} of {q}", job.integrator, apart(&here, &there, q)))?;
        }
        // Control: a delay longer by a millisecond is seen.
        let seen = apart(&here, &other, VELOCITY).max(apart(&here, &other, ACCELERATION));
        check(seen > 1e-3, format!("{}: another delay differs by {seen}", job.integrator))?;
    }
    Ok(())
}

/// Straight north with a smooth start; at the end the speed is steady, and what the readings held
/// back is −τ times the velocity that was gained.
fn straight(keys: &str) -> String {
    format!(
        "members = 64\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 200.0\n{keys}\
         [trajectory]\nkind = \"waypoints\"\npoints_m = [[0.0, 0.0, 0.0], [400.0, 0.0, 0.0]]\nspeed_m_s = 10.0\n\
         still_s = 2.0\n[report]\ntimes_s = [20.0]\n"
    )
}

fn in_motion() -> Result<(), Failed> {
    let north = |keys: &str| -> Result<(f64, f64, Rows), Failed> {
        let answer = answered(&straight(keys))?;
        let last = *answer.report.last().ok_or("no report")?;
        let mean = |quantity| answer.ensemble.summary(last, quantity).mean;
        let named = answer.simulated.iter().map(|part| (part.cause.name(), part.mean[last][0])).collect();
        Ok((mean(Quantity::Position(0)), mean(Quantity::Velocity(0)), named))
    };
    let (bare, _, none) = north("")?;
    check(none.is_empty(), format!("without either, {none:?} is left out"))?;
    for (keys, held_back_s, name) in
        [("readout_lowpass_s = 0.05\n", 0.05, "readout low-pass"), ("readout_delay_s = 0.05\n", 0.05, "readout delay")]
    {
        let (position, velocity, left_out) = north(keys)?;
        near(&format!("north after {keys}"), position - bare, -held_back_s * 10.0, 5e-3)?;
        near(&format!("velocity after {keys}"), velocity, 0.0, 1e-3)?;
        check((position - bare + 1.05 * held_back_s * 10.0).abs() > 0.02, "5 % more passes (control)")?;
        let [(left_out, row)] = left_out[..] else { return Err(format!("simulated: {left_out:?}").into()) };
        check(left_out == name, left_out)?;
        near(&format!("row of the {name}, north"), row, -held_back_s * 10.0, 5e-3)?;
    }
    Ok(())
}

/// A late velocity is short of the force of the last τ, which the vibration's own swing bounds: 0.01 g²/Hz from 20 to 80
/// Hz swings by v² = 0.01 g²/(2π)² (1/20 − 1/80) Hz⁻¹, 30 mm/s rms, and five times that for τ is 8 mm. The first force
/// held before the run would bring 0.05 s · 0.77 g · 60 s = 23 m rms.
fn late_vibration() -> Result<(), Failed> {
    let down_m = |delay_s: f64| -> Result<f64, Failed> {
        let answer = answered(&format!(
            "members = 64\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 400.0\n{MASS}readout_delay_s = {delay_s:?}\n\
             [trajectory]\nkind = \"rest\"\n[vibration]\nz_g2_hz = [[20.0, 0.01], [80.0, 0.01]]\n[report]\ntimes_s = [60.0]\n"
        ))?;
        let last = *answer.report.last().ok_or("no report")?;
        Ok(answer.ensemble.summary(last, Quantity::Position(2)).mean)
    };
    near("down after a delay, m", down_m(0.05)?, down_m(0.0)?, 5.0 * 0.030 * 0.05)
}

fn parity_in_motion() -> Result<(), Failed> {
    let text = |delay: &str| {
        format!(
            "members = 1024\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 200.0\n{MASS}readout_lowpass_s = 0.04\n\
             readout_delay_s = {delay}\n[accelerometer]\nvelocity_random_walk_m_s_rth = 0.01\n[gyro]\n\
             angle_random_walk_deg_rth = 0.01\n[trajectory]\nkind = \"figure-eight\"\nradius_m = 30.0\nspeed_m_s = 5.0\n\
             [alignment]\nkind = \"still\"\nstill_s = 3.0\n[report]\ntimes_s = [0.1, 5.0, 20.0]\n"
        )
    };
    let on = |choice, text: &str| -> Result<_, Failed> {
        let study = parsed(text)?;
        let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![20, 1000, 4000])?;
        Ok(fly(choice, &flight, &Control::silent())?)
    };
    let (here, there) = (on(Choice::Cpu, &text("0.03"))?, on(Choice::Gpu, &text("0.03"))?);
    let other = on(Choice::Cpu, &text("0.035"))?;
    check(there.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    let apart = percentiles_apart(&here, &there, 3);
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    check(percentiles_apart(&here, &other, 3) > 5e-3, "another delay gave the same percentiles")
}

fn refused() -> Result<(), Failed> {
    let parse = |text: &str| study::parse("readout", text, Path::new(""));
    let said = |text: &str| parse(text).err().map(|error| error.to_string()).unwrap_or_default();
    let rest = "kind = \"rest\"";
    let drawn = said(&text("readout_delay_s = { min = 0.0, max = 0.01 }\n", rest, &[1.0]));
    check(drawn.contains("sensor.readout_delay_s") && drawn.contains("drawn"), drawn.clone())?;
    let sine = "kind = \"sine\"\namplitude_m_s2 = 1.0\nfrequency_hz = 3.0\nphase_rad = { min = 0.0, max = 6.0 }";
    let beside = said(&text("readout_delay_s = 0.01\n", sine, &[1.0]));
    check(beside.contains("sensor.readout_delay_s") && beside.contains("sine"), beside.clone())?;
    let below = said(&text("readout_lowpass_s = -0.01\n", rest, &[1.0]));
    check(below.contains("sensor.readout_lowpass_s"), below.clone())?;
    // 1 − 0.6 · 2 < 0: no spring is left at 2 s, and there is one at 1 s.
    let spring = |last_s: f64| text(&format!("{MASS}stiffness_drift_per_s = -0.6\n"), rest, &[last_s]);
    let gone = said(&spring(2.0));
    check(gone.contains("sensor.stiffness_drift_per_s") && gone.contains("1.67 s"), gone.clone())?;
    check(said(&spring(1.0)).is_empty(), said(&spring(1.0)))?;
    // Controls: the same without the clash, and a drawn low-pass.
    let fixed = sine.replace("{ min = 0.0, max = 6.0 }", "1.0");
    for good in [
        text("readout_delay_s = 0.01\n", &fixed, &[1.0]),
        text("readout_lowpass_s = { min = 0.001, max = 0.01 }\n", sine, &[1.0]),
    ] {
        check(said(&good).is_empty(), said(&good))?;
    }
    // A drawn low-pass gives members of their own: their velocities spread.
    let study =
        read(&text("readout_lowpass_s = { min = 0.01, max = 0.4 }\n", PULSE, &[2.0]).replace("= 2\n", "= 64\n"))?;
    let job = study.job(study.integrator()?.integrator, vec![1500]);
    let outcomes = cpu::outcomes::<f64>(&job, &Control::silent())?;
    check(outcomes.iter().any(|o| (o[VELOCITY] - outcomes[0][VELOCITY]).abs() > 1e-2), "members are alike")
}
