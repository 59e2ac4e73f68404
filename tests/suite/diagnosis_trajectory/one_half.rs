//! References that know one half of a pose alone.

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::Outcome;
use proofmass::report::diagnosis::worded;

use std::collections::BTreeSet;
use std::path::Path;

use super::super::world::{check, data_test, near, test};
use super::flight::{Files, Flight, PLANTED, base, biases, effect, ids, made_up, real};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: attitude alone shows the gyro's scale and says what it cannot show", attitude),
        test("trajectory: of a file with both halves the model may take attitude alone", taken),
        test(
            "trajectory: positions alone show biases, clock, scale and lever arm, and nothing where none is",
            position,
        ),
        test("trajectory: of a file with both halves the model may take positions alone", taken_position),
        test("trajectory: readings that do not agree with positions alone are refused with what is mistaken", mistaken),
        data_test("trajectory: positions alone of two flights lead to the gyro's bias", recorded),
    ]
}

/// Headings of stamp and attitude.
const ATTITUDE: [&str; 2] = ["timestamp", "q_RS"];
const UNTOLD: &str = "a reference of attitude alone says nothing about lever-arm or scale-factor of the accelerometer or misalignment of the \
     accelerometer or accelerometer-bias of the accelerometer";

fn attitude() -> Result<(), Failed> {
    for seed in [1, 6] {
        let flight = made_up(seed)?;
        let none = flight.files().with_columns(&ATTITUDE).diagnosed()?;
        check(ids(&none).is_empty() && none.outcome == Outcome::Adequate, format!("seed {seed}: {:?}", ids(&none)))?;
        check(none.base.iter().all(|e| !e.name.starts_with("accelerometer")), "a bias of the accelerometer is stated")?;
        near("bias", base(&none, "gyro_bias_y")?.value, -0.02, 1e-4)?;
        let verdict = worded(none).verdict;
        check(verdict.findings.iter().any(|f| f.starts_with(UNTOLD)), format!("{:?}", verdict.findings))?;
        let scaled = flight.with_rate(|w| w.map(|v| v * 1.004)).files().with_columns(&ATTITUDE).diagnosed()?;
        let names = ids(&scaled);
        check(names.len() == 1 && names.contains("scale-factor"), format!("seed {seed}: {names:?}"))?;
        for p in &effect(&scaled, "scale-factor")?.parameters {
            near(&p.name, p.value, 4000.0, 500.0)?;
            check(p.ci95[0] < 4000.0 && p.ci95[1] > 4000.0, format!("{}: {:?}", p.name, p.ci95))?;
        }
    }
    let both = worded(made_up(1)?.diagnosed()?).verdict;
    check(!both.findings.iter().any(|f| f.starts_with(UNTOLD)), "a reference with both halves is said to lack one")
}

fn taken() -> Result<(), Failed> {
    let flight = made_up(1)?;
    let files = flight.files();
    // Positions that are of no use.
    let spoilt = flight.with_erring_reference(0.0, 0.05).files();
    let used = "file = \"reference.csv\"\nuse = \"attitude\"";
    let model = files.model.replace("file = \"reference.csv\"", used);
    let answer = Files { model, ..spoilt.clone() }.diagnosed()?;
    check(ids(&answer).is_empty() && answer.outcome == Outcome::Adequate, format!("{:?}", ids(&answer)))?;
    check(ids(&spoilt.diagnosed()?).contains("reference-noise"), "the positions are of use after all")
}

/// Headings of stamp and position.
const POSITION: [&str; 2] = ["timestamp", "p_RS"];
const NO_MOUNTING: &str = "a reference of position alone says nothing about mounting or readout-lowpass of the gyro; a reference that also has attitudes would";
/// White errors of each position, m: motion capture.
const CAPTURE_M: f64 = 1e-3;

/// A name, what is planted, the number that is to hold it and its size.
type Plant = (&'static str, fn(&Flight) -> Flight, &'static str, f64);

fn position() -> Result<(), Failed> {
    let plants: [Plant; 3] = [
        ("time-offset", |f| f.shifted(0.02), "offset", 0.02),
        ("scale-factor", |f| f.with_rate(|w| w.map(|v| v * 1.02)), "gyro_x", 2e4),
        ("lever-arm", |f| f.carried([0.0, 0.1, 0.0]), "y", -0.1),
    ];
    let mut held = 0;
    for seed in [1, 6] {
        let flight = made_up(seed)?;
        let none = flight.files().with_columns(&POSITION).diagnosed()?;
        check(ids(&none).is_empty() && none.outcome == Outcome::Adequate, format!("seed {seed}: {:?}", ids(&none)))?;
        let flight = flight.with_erring_reference(0.0, CAPTURE_M);
        let none = flight.files().with_columns(&POSITION).diagnosed()?;
        let errs = BTreeSet::from(["reference-noise".to_owned()]);
        check(ids(&none) == errs, format!("seed {seed}, positions that err: {:?}", ids(&none)))?;
        for (sensor, name) in ["gyro_bias", "accelerometer_bias"].into_iter().enumerate() {
            for (axis, planted) in ["x", "y", "z"].into_iter().zip(PLANTED[sensor]) {
                let [least, most] = base(&none, &format!("{name}_{axis}"))?.ci95;
                held += usize::from(least < planted && planted < most);
            }
        }
        near("bias", base(&none, "gyro_bias_y")?.value, PLANTED[0][1], 5e-4)?;
        let verdict = worded(none).verdict;
        check(verdict.findings.iter().any(|f| f == NO_MOUNTING), format!("{:?}", verdict.findings))?;
        for (id, plant, number, planted) in plants {
            let found = plant(&flight).files().with_columns(&POSITION).diagnosed()?;
            let names: BTreeSet<String> = ids(&found).difference(&errs).cloned().collect();
            check(names.len() == 1 && names.contains(id), format!("seed {seed}, {id} planted: {names:?}"))?;
            let found = effect(&found, id)?.parameters.iter().find(|p| p.name == number).ok_or("no such number")?;
            check(found.ci95[0] < planted && planted < found.ci95[1], format!("{id} {number}: {:?}", found.ci95))?;
            check(found.ci95[0] > 0.0 || found.ci95[1] < 0.0, format!("{id} {number} may be none: {:?}", found.ci95))?;
        }
    }
    // Of twelve intervals of 95 % fewer than ten hold twice in a hundred times.
    check(held >= 10, format!("{held} of 12 intervals of biases hold"))
}

fn taken_position() -> Result<(), Failed> {
    // Attitudes that are of no use.
    let spoilt = made_up(1)?.with_erring_reference(0.01, CAPTURE_M).files();
    let used = "file = \"reference.csv\"\nuse = \"position\"";
    let model = spoilt.model.replace("file = \"reference.csv\"", used);
    let answer = Files { model, ..spoilt.clone() }.diagnosed()?;
    let noise = effect(&answer, "reference-noise")?;
    check(ids(&answer).len() == 1 && noise.parameters.len() == 1, format!("{:?}", ids(&answer)))?;
    let both = spoilt.diagnosed()?;
    check(effect(&both, "reference-noise")?.parameters.len() == 2, "the attitudes are of use after all")
}

fn mistaken() -> Result<(), Failed> {
    type Altered = (fn(&Flight) -> Flight, &'static str);
    let hand = "only with its sign reversed, or with one axis of the positions mirrored";
    let mistakes: [Altered; 4] = [
        (|f| f.with_force(|a| a.map(|v| -v)), hand),
        (|f| f.with_rate(|w| w.map(f64::to_degrees)), "degrees per second"),
        (|f| f.with_pose_at(|_, p, q| (nalgebra::Vector3::new(p.x, -p.y, p.z), q)), hand),
        (|f| f.with_pose_at(|_, p, q| (nalgebra::Vector3::new(p.x, -p.y, -p.z), q)), "their up points down"),
    ];
    let flight = made_up(1)?;
    for (of, said) in mistakes {
        let error = of(&flight).files().with_columns(&POSITION).diagnosed().err().ok_or("it was taken")?;
        let text = error.message().unwrap_or_default().to_owned();
        check(text.contains(said), format!("need `{said}`, got {text}"))?;
    }
    // Positions of another flight, evenly spaced and by turns 80 and 120 ms apart.
    let spacings: [fn(usize) -> bool; 2] = [|_| true, |k| k % 20 == 0 || k % 20 == 8];
    for wanted in spacings {
        let refused = |reference: &Flight| -> Result<Option<String>, Failed> {
            let reference = reference.with_poses(wanted).files().with_columns(&POSITION).reference;
            let answer = Files { reference, ..flight.files() }.diagnosed();
            Ok(answer.err().map(|e| e.message().unwrap_or_default().to_owned()))
        };
        let other = refused(&made_up(6)?)?.ok_or("another flight's positions were taken")?;
        check(other.contains("do not move alike"), other)?;
        check(refused(&flight)?.is_none(), "its own positions were refused")?;
    }
    // Two positions a second.
    let few = flight.with_poses(|k| k % 50 == 0).files().with_columns(&POSITION).diagnosed();
    let text = few.err().ok_or("180 positions were taken")?.message().unwrap_or_default().to_owned();
    check(text.contains("need 10 s and 300 poses"), text)
}

/// The reference file's own biases, which come from its attitudes too: held by the intervals, which
/// are a few times as wide as with attitudes. However many positions there are, no sensor is blamed.
///
/// The slow part of MH_04's positions comes from a laser tracker whose stamps are its own: in the
/// weak form of p'' = R f − g, with the file's attitudes and sin⁴ windows, they are late by
/// 0.1 ± 0.6 ms over windows of 0.1 s and by 19 ± 3 ms over windows of 1.6 s (V1_02: early by
/// 0.2 ± 0.2 and 2.6 ± 2.4 ms). So a clock is a name that five positions a second may have.
fn recorded(data: &Path) -> Result<(), Failed> {
    for name in ["euroc_v102", "euroc_mh04"] {
        // 200, 50 and 5 positions a second.
        for every in [1, 4, 40] {
            let what = format!("{name}, every {every}th position");
            let answer =
                real(data, name)?.with_poses(|k| k % every == 0).files().with_columns(&POSITION).diagnosed()?;
            let tracker = name == "euroc_mh04" && every == 40;
            let there = |id: &String| id == "vibration" || tracker && id == "time-offset";
            let names: Vec<String> = ids(&answer).into_iter().filter(|id| !there(id)).collect();
            check(names.is_empty(), format!("{what}: {names:?}"))?;
            if tracker && ids(&answer).contains("time-offset") {
                let [least, most] = effect(&answer, "time-offset")?.parameters[0].ci95;
                check(-0.032 < least && most < -0.01, format!("{what}: {least} to {most} s"))?;
            }
            for (axis, expected) in ["gyro_bias_x", "gyro_bias_y", "gyro_bias_z"].into_iter().zip(biases(data, name)?) {
                let [least, most] = base(&answer, axis)?.ci95;
                check(least < expected && expected < most, format!("{what} {axis}: {least}, {most}; {expected}"))?;
                // MH_04 hardly turns; its z reads 77 mrad/s too much.
                check(most - least < 4e-2, format!("{what} {axis}: {least}, {most} says nothing"))?;
            }
        }
    }
    Ok(())
}
