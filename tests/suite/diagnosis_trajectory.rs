//! An IMU in motion beside its reference: what is concealed in a log is found, and nothing else.
//!
//! Real logs: Burri et al., *The EuRoC micro aerial vehicle datasets*, IJRR 2016. The reference
//! file's own biases are read here and never by the tool. Made-up flights: the tool's own drone,
//! whose readings are exact but for what is planted.

mod bad_input;
mod coverage;
mod flight;
mod known;
mod lowpass;
mod of_force;
mod one_half;
mod open;
mod reference_motion;
mod repaired;
mod spoiled;

use std::collections::BTreeSet;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::Vector3;
use proofmass::diagnosis::answer::Answer;
use proofmass::diagnosis::verdict::Outcome;

use super::world::{check, data_test, near, test};
use flight::{Flight, PLANTED, base, biases, by_hand, effect, flown, ids, made_up, matrix, real};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    [
        data_test("trajectory: the gyro's bias on two flights is that of the reference file", gyro_bias),
        data_test("trajectory: a shifted clock is found to a tenth of a millisecond", shifted),
        data_test("trajectory: a scale of half a per cent and an axis askew are found and nothing else", sensor),
        data_test("trajectory: clipped readings are found with their limit", clipped),
        data_test("trajectory: exchanged axes are found", exchanged),
        data_test("trajectory: a lever arm of 5 cm is found to 5 mm", lever_arm),
        test("trajectory: neither curved rates nor a clock that gains pass for a scale factor", scale_alone),
        test("trajectory: made-up flights without effects name none", without),
        test("trajectory: each effect planted in a made-up flight is named alone", planted),
        test(
            "trajectory: a gyro that is good enough shows the Earth's rate, and one beside no Earth does not",
            earth_rate,
        ),
        test("trajectory: a reference that errs is said to, by what its means err by, and no sensor is blamed", noisy),
    ]
    .into_iter()
    .chain(bad_input::tests())
    .chain(lowpass::tests())
    .chain(of_force::tests())
    .chain(one_half::tests())
    .chain(open::tests())
    .chain(reference_motion::tests())
    .chain(repaired::tests())
    .chain(spoiled::tests())
    .chain(coverage::tests())
    .chain(known::tests())
    .collect()
}

const FLIGHTS: [&str; 2] = ["euroc_v102", "euroc_mh04"];

fn gyro_bias(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let answer = real(data, name)?.diagnosed()?;
        let expected = biases(data, name)?;
        for axis in 0..3 {
            let got = base(&answer, ["gyro_bias_x", "gyro_bias_y", "gyro_bias_z"][axis])?;
            near(&format!("{name} {axis}"), got.value, expected[axis], 2e-5)?;
            check((got.value - expected[axis] - 1e-4).abs() > 2e-5, "a bias 1e-4 off would pass")?;
        }
    }
    Ok(())
}

/// Nothing is named beyond what the untouched flight names, and `id` is.
fn named_alone(what: &str, touched: &Answer, untouched: &Answer, id: &str) -> Result<(), Failed> {
    let (all, known): (BTreeSet<String>, BTreeSet<String>) = (ids(touched), ids(untouched));
    check(all.contains(id), format!("{what}: {id} is not among {all:?}"))?;
    check(!known.contains(id), format!("{what}: the untouched flight has {id} as well: nothing is shown"))?;
    let more: Vec<&String> = all.iter().filter(|i| *i != id && !known.contains(*i)).collect();
    check(more.is_empty(), format!("{what}: also named: {more:?}; untouched {known:?}"))
}

fn shifted(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let flight = real(data, name)?;
        let untouched = flight.diagnosed()?;
        for shift_s in [0.005, -0.005] {
            let answer = flight.shifted(shift_s).diagnosed()?;
            let what = format!("{name} shifted by {shift_s}");
            named_alone(&what, &answer, &untouched, "time-offset")?;
            let change = base(&answer, "time_offset")?.value - base(&untouched, "time_offset")?.value;
            near(&what, change, shift_s, 1e-4)?;
            let half = 0.5 * (base(&answer, "time_offset")?.ci95[1] - base(&answer, "time_offset")?.ci95[0]);
            check(half < 1e-3 && (change - shift_s).abs() < half, format!("{what}: ±{half}"))?;
            check((change + shift_s).abs() > 1e-4, "the other sign would pass")?;
        }
    }
    Ok(())
}

fn sensor(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let flight = real(data, name)?;
        let untouched = flight.diagnosed()?;
        let scaled = flight.with_rate(|w| [w[0] * 1.005, w[1] * 1.005, w[2] * 1.005]).diagnosed()?;
        named_alone(name, &scaled, &untouched, "scale-factor")?;
        let askew = flight.with_rate(|w| [w[0] + 5e-3 * w[1], w[1], w[2]]).diagnosed()?;
        named_alone(name, &askew, &untouched, "misalignment")?;
        for axis in 0..3 {
            // calibrated = matrix · (reading − bias): a reading that is too large has a smaller
            // entry.
            let of = |answer: &Answer| matrix(answer).map(|m| 1.0 / m[axis][axis] - 1.0);
            near(&format!("{name} scale {axis}"), of(&scaled)? - of(&untouched)?, 5e-3, 5e-4)?;
            near(&format!("{name} scale {axis}, untouched"), of(&askew)? - of(&untouched)?, 0.0, 5e-4)?;
        }
        let of = |answer: &Answer| matrix(answer).map(|m| -m[0][1]);
        near(&format!("{name} xy"), of(&askew)? - of(&untouched)?, 5e-3, 5e-4)?;
        check((of(&scaled)? - of(&untouched)? - 5e-3).abs() > 5e-4, "a straight axis would pass for an askew one")?;
    }
    Ok(())
}

fn clipped(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let flight = real(data, name)?;
        let untouched = flight.diagnosed()?;
        let peak: [f64; 3] = std::array::from_fn(|i| flight.rate.iter().fold(0.0, |p: f64, w| p.max(w[i].abs())));
        let limit = peak.map(|p| 0.6 * p);
        let answer = flight.with_rate(|w| std::array::from_fn(|i| w[i].clamp(-limit[i], limit[i]))).diagnosed()?;
        named_alone(name, &answer, &untouched, "readout-saturation")?;
        let found = effect(&answer, "readout-saturation")?;
        check(found.parameters.len() >= 2, format!("{name}: of three clipped axes only {:?}", found.channels))?;
        for p in &found.parameters {
            let axis = ["gyro_x", "gyro_y", "gyro_z"].iter().position(|n| *n == p.name).unwrap_or(9);
            near(&format!("{name} {}", p.name), p.value, limit[axis], 1e-9)?;
        }
    }
    Ok(())
}

fn exchanged(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let flight = real(data, name)?;
        let untouched = flight.diagnosed()?;
        for (map, answer) in [
            ("y x z", flight.with_rate(|w| [w[1], w[0], w[2]]).diagnosed()?),
            ("x y -z", flight.with_rate(|w| [w[0], w[1], -w[2]]).diagnosed()?),
        ] {
            let what = format!("{name} {map}");
            named_alone(&what, &answer, &untouched, "axis-swap")?;
            let found = effect(&answer, "axis-swap")?;
            check(found.equation.ends_with(&format!("read {map}")), format!("{what}: {}", found.equation))?;
        }
    }
    Ok(())
}

fn lever_arm(data: &Path) -> Result<(), Failed> {
    for name in FLIGHTS {
        let flight = real(data, name)?;
        let untouched = flight.diagnosed()?;
        // The reference follows a point 5 cm before the IMU: from it to the IMU it is as far back.
        let answer = flight.carried([0.05, 0.0, 0.0]).diagnosed()?;
        named_alone(name, &answer, &untouched, "lever-arm")?;
        for (axis, expected) in [("x", -0.05), ("y", 0.0), ("z", 0.0)] {
            let of = |answer: &Answer| base(answer, &format!("lever_arm_{axis}")).map(|e| e.value);
            near(&format!("{name} {axis}"), of(&answer)? - of(&untouched)?, expected, 5e-3)?;
        }
    }
    Ok(())
}

fn without() -> Result<(), Failed> {
    for seed in [1, 6, 11, 12] {
        let none = made_up(seed)?.diagnosed()?;
        let said = format!("seed {seed}, without effects: {:?} ({:?})", ids(&none), none.outcome);
        check(ids(&none).is_empty() && none.outcome == Outcome::Adequate, said)?;
    }
    Ok(())
}

/// What is planted, and the id that is to be named.
type Plant = (&'static str, fn(&Flight) -> Flight);

fn planted() -> Result<(), Failed> {
    let flight = made_up(1)?;
    let plants: [Plant; 7] = [
        ("time-offset", |f| f.shifted(0.004)),
        ("scale-factor", |f| f.with_rate(|w| w.map(|v| v * 1.004))),
        ("misalignment", |f| f.with_rate(|w| [w[0], w[1] + 4e-3 * w[2], w[2]])),
        ("g-sensitivity", |f| f.with_g_sensitivity(1e-3)),
        ("axis-swap", |f| f.with_force(|a| [a[0], a[2], a[1]])),
        ("lever-arm", |f| f.carried([0.0, 0.1, 0.0])),
        ("readout-saturation", |f| f.with_rate(|w| w.map(|v| v.clamp(-0.6, 0.6)))),
    ];
    for (id, plant) in plants {
        let all = ids(&plant(&flight).diagnosed()?);
        check(all.len() == 1 && all.contains(id), format!("{id} planted: {all:?}"))?;
    }
    Ok(())
}

/// Rates of 2 rad/s at 0.7 Hz, a hundred readings a second: straight lines between them cut (ωh)²/12 = 1.6e-4 of
/// every turn, and a clock that gains 3e-4 would add as much to every rate. A scale of half a per cent is known to a
/// few parts in 10⁵.
fn scale_alone() -> Result<(), Failed> {
    let rate = |t: f64| [4.4, 4.1, 4.7].map(|turn| 2.0 * (turn * t + turn).sin());
    for (gained, names) in [(0.0, vec!["scale-factor"]), (3e-4, vec!["clock-drift", "scale-factor", "time-offset"])] {
        for seed in [1, 2] {
            let flight = by_hand(rate, seed).with_rate(|w| w.map(|v| v * 1.005)).gaining(gained);
            let answer = flight.diagnosed()?;
            let named = names.iter().map(|id| (*id).to_owned()).collect();
            check(ids(&answer) == named, format!("{gained}, seed {seed}: {:?}", ids(&answer)))?;
            for scale in effect(&answer, "scale-factor")?.parameters.iter().filter(|p| p.name.starts_with("gyro")) {
                let [low, high] = scale.ci95;
                let what = format!("{gained}, seed {seed}: {} {} {:?}", scale.name, scale.value, scale.ci95);
                // Four standard errors.
                check((scale.value - 5000.0).abs() < 1.02 * (high - low), what)?;
                check(high - low < 110.0, format!("{} {:?} says little", scale.name, scale.ci95))?;
            }
        }
    }
    Ok(())
}

/// The Earth's rate of rotation, WGS 84, at 47.4° of latitude: Ω (cos φ, 0, −sin φ).
fn earth_rate() -> Result<(), Failed> {
    let truth = flown(1)?;
    let flight = made_up(1)?;
    let latitude = 47.4f64.to_radians();
    let earth = Vector3::new(latitude.cos(), 0.0, -latitude.sin()) * 7.292_115e-5;
    // A twentieth of the noise: 6e-6 rad/√s, 0.02 °/√h, as a tactical sensor has.
    let seen = |turns: f64| {
        let of = |k: usize, w: [f64; 3]| {
            let sample = &truth.samples[k];
            let felt = sample.attitude.inverse_transform_vector(&(earth * turns));
            std::array::from_fn(|i| {
                let ideal = sample.rate_rad_s[i] + PLANTED[0][i];
                ideal + 0.05 * (w[i] - ideal) + felt[i]
            })
        };
        flight.with_rate_at(of).diagnosed()
    };
    let names = ids(&seen(0.0)?);
    check(names.is_empty(), format!("no Earth: {names:?}"))?;
    let answer = seen(1.0)?;
    check(ids(&answer) == BTreeSet::from(["earth-rate".to_owned()]), format!("{:?}", ids(&answer)))?;
    for (p, expected) in effect(&answer, "earth-rate")?.parameters.iter().zip(earth.iter()) {
        // rad/s in °/h.
        let expected = expected.to_degrees() * 3600.0;
        check(p.ci95[0] < expected && expected < p.ci95[1], format!("{}: {expected} in {:?}", p.name, p.ci95))?;
        check(p.ci95[1] - p.ci95[0] < 5.0, format!("{}: {:?} says little", p.name, p.ci95))?;
    }
    Ok(())
}

/// White errors of 2 mrad and 3 mm of each pose: means over 0.05 s and 0.1 s at 100 poses per
/// second err by 1/√5 and 1/√10 of them. 85 s hold 1700 and 850 means, 3 axes each: 1/√(2n) of the
/// deviation is 1.0 % and 1.4 %, held to five of them, and to half as much again for what the
/// largest of six spans is above their mean.
fn noisy() -> Result<(), Failed> {
    for seed in [1, 6] {
        let answer = made_up(seed)?.with_erring_reference(2e-3, 3e-3).diagnosed()?;
        let names = ids(&answer);
        check(names.len() == 1 && names.contains("reference-noise"), format!("seed {seed}: {names:?}"))?;
        let found = effect(&answer, "reference-noise")?;
        check(found.equation.contains("attitude over 0.0500 s, position over 0.100 s"), found.equation.clone())?;
        for (p, (each, poses)) in found.parameters.iter().zip([(2.0, 5.0f64), (3.0, 10.0)]) {
            let expected = each / poses.sqrt();
            near(&format!("seed {seed} {}", p.name), p.value, expected, 0.1 * expected)?;
            check((p.value - each).abs() > 0.1 * expected, "the error of a single pose would pass")?;
        }
    }
    Ok(())
}
