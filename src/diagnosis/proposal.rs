//! Propose the model of a recording from a first look at its file: its kind, its columns, what is
//! assumed.
//!
//! `inspect` suggests the next command by it, and `diagnose` without a model runs on it. A proposal
//! is withheld where two readings of the file are as likely; the error then names both.

mod driven;
mod parts;
mod sweeps;

pub use parts::Named;

use std::path::Path;

use super::model::{self, Model};
use crate::document::toml_string;
use crate::error::Result;
use crate::escape::word;
use crate::number::rounded;
use crate::recording::inspection::{Inspection, Rows, Stretch};
use driven::driven;
use parts::{environment, list, refused};

/// Share of its time that a sensor at rest is still.
const AT_REST: f64 = 0.8;
/// Directions of gravity in which a sensor rests that is turned on purpose: the faces of a box.
const FACES: usize = 6;
/// Rests shorter than this tell little of noise, s.
pub const WORTHWHILE_S: f64 = 60.0;
/// Standard gravity (CGPM 1901), where nobody said what it is at the place of the recording.
const GRAVITY_M_S2: f64 = 9.806_65;

/// Holds what a recording suits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Suited {
    /// Input and output of one proof mass, or a free decay.
    Driven,
    /// A sensor at rest.
    Rest,
    /// A sensor that moves, after or before a rest that is long enough to judge its noise.
    RestFor(Stretch),
    /// An IMU in many still poses.
    Poses,
    /// An IMU in motion: a reference must tell where it went.
    Motion,
    /// Positions or attitudes: the reference of a motion.
    Reference,
    /// Stepped-sine sweeps of a resonator.
    Sweeps,
}

/// The time that a sensor lay still, s.
pub fn total_s(still: &[Stretch]) -> f64 {
    still.iter().map(|s| s.to_s - s.from_s).sum()
}

/// The longest rest.
pub fn longest(still: &[Stretch]) -> Option<&Stretch> {
    still.iter().max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)))
}

/// Returns whether a sensor rests with gravity in so many directions that it was turned on purpose.
pub fn is_turned(rows: &Rows) -> bool {
    rows.poses >= FACES
}

/// Decides what a recording suits; `None` without a clock, or where a single sensor moves, which
/// says nothing of itself.
pub fn suited(rows: &Rows) -> Option<Suited> {
    if sweeps::columns(rows).is_some() {
        return Some(Suited::Sweeps);
    }
    let whole_s = rows.samples as f64 / rows.rate_hz?;
    let [gyros, accelerometers] = [0, 1].map(|sensor| rows.sensors[sensor].len());
    match longest(&rows.still) {
        _ if gyros + accelerometers == 0 && rows.is_pose => Some(Suited::Reference),
        _ if gyros + accelerometers == 0 || rows.given.is_some() => Some(Suited::Driven),
        _ if is_turned(rows) => Some(Suited::Poses),
        Some(_) if total_s(&rows.still) >= AT_REST * whole_s => Some(Suited::Rest),
        Some(rest) if rest.to_s - rest.from_s >= WORTHWHILE_S => Some(Suited::RestFor(*rest)),
        _ if gyros == 3 && accelerometers == 3 => Some(Suited::Motion),
        // A single axis that moves by itself decays.
        _ if gyros + accelerometers == 1 => Some(Suited::Driven),
        _ => None,
    }
}

/// Writes the model.toml that a recording suits; `file` stands for it in commands.
///
/// # Errors
/// A file without rows or clock, poses, a sensor in motion, and columns of which nothing says which
/// is the input.
pub fn proposed(file: &str, seen: &Inspection, named: &Named) -> Result<String> {
    let mut text = of_kind(file, seen, named)?;
    // Steps have neither rate nor clock.
    if text.starts_with("kind = \"response\"") {
        return Ok(text);
    }
    if let (Some(rate_hz), Some((kind, rest))) = (named.rate_hz, text.split_once('\n')) {
        text = format!("{kind}\nrate_hz = {rate_hz:?}\n{rest}");
    }
    if let Some(time) = &named.time {
        text = text.replacen("[columns]\n", &format!("[columns]\ntime = {}\n", toml_string(time)), 1);
    }
    Ok(text)
}

/// The same without rate and clock.
fn of_kind(file: &str, seen: &Inspection, named: &Named) -> Result<String> {
    let fail = |cause: String, hint: String| Err(refused(file, cause, hint));
    // A sweep's steps need no clock.
    let is_sweep = seen.rows.as_ref().and_then(suited) == Some(Suited::Sweeps);
    if let Some([frequency, half]) = seen.rows.as_ref().filter(|rows| rows.rate_hz.is_none()).and_then(sweeps::halved) {
        return fail(
            format!("`{frequency}` and `{half}` look like a sweep of a resonator, of which half of the reading is missing"),
            "a sweep needs X and Y, or amplitude and phase, at each frequency: record both, or name the columns in a model \
             (`proofmass template response`)"
                .into(),
        );
    }
    if let Some(obstacle) = seen.obstacle.as_ref().filter(|_| !is_sweep) {
        return fail(obstacle.cause.clone(), obstacle.hint.clone());
    }
    let Some(rows) = &seen.rows else {
        return fail("no rows of numbers were found in it".into(), format!("see `proofmass inspect {file}`"));
    };
    if named.input.is_some() || named.output.is_some() {
        return driven(file, rows, named);
    }
    let subject = word(file);
    let trajectory = format!(
        "proofmass diagnose {subject} --model model.toml, with kind = \"trajectory\" and a [reference] (`proofmass template \
         trajectory`)"
    );
    match suited(rows) {
        Some(Suited::Driven) => driven(file, rows, named),
        Some(Suited::Sweeps) => Ok(sweeps::model(rows, seen.clock.as_deref())),
        Some(Suited::Rest) => Ok(at_rest(rows)),
        Some(Suited::RestFor(_)) if named.is_cut => Ok(at_rest(rows)),
        Some(Suited::Poses) => poses(file, rows),
        Some(Suited::RestFor(rest)) => {
            let [from, to] = [rest.from_s, rest.to_s].map(|t| rounded(t, 4));
            let motion = match rows.sensors.concat()[..] {
                [one] => format!("a decay: proofmass diagnose {subject} --output {}", word(&rows.columns[one].name)),
                _ => format!("its motion by a reference: {trajectory}"),
            };
            fail(
                format!("the sensor lies still from {from} to {to} s and moves in the other time"),
                format!(
                    "judge its noise by the rest: proofmass diagnose {subject} --from-s {from} --to-s {to}; or {motion}"
                ),
            )
        }
        Some(Suited::Motion) => fail(
            "the sensor moves, and without a reference its motion and its errors look the same".into(),
            format!("with a reference motion: {trajectory}; without one, record the sensor at rest or in still poses"),
        ),
        Some(Suited::Reference) => fail(
            "its rows are poses, and no sensor's readings".into(),
            "diagnose the IMU's recording with this file as [reference] file (`proofmass template trajectory`)".into(),
        ),
        None if rows.rate_hz.is_none() => fail("it has no clock".into(), "give its sampling rate: --rate-hz F".into()),
        None => fail(
            "one sensor alone, in motion, says nothing of itself".into(),
            "record it at rest, or with the other sensors of its IMU and a reference".into(),
        ),
    }
}

/// Parses a proposal.
///
/// # Errors
/// As `model::parse`.
pub fn parsed(text: &str) -> Result<Model> {
    model::parse("the proposed model", text)
}

fn at_rest(rows: &Rows) -> String {
    let channels = rows.sensors.iter().flatten().map(|place| &rows.columns[*place]);
    format!("kind = \"static\"\n[columns]\nchannels = {}\n{}", list(channels), environment(rows))
}

fn poses(file: &str, rows: &Rows) -> Result<String> {
    let [gyro, accelerometer] = &rows.sensors;
    if accelerometer.len() != 3 {
        let cause = format!("a calibration in still poses needs three accelerometers, got {}", accelerometer.len());
        let hint = "name them under [columns] of a model.toml (`proofmass template tumble`)";
        return Err(refused(file, cause, hint.into()));
    }
    super::tumble::enough(Path::new(file), rows.still.len().max(rows.poses))?;
    let of = |places: &[usize]| list(places.iter().map(|p| &rows.columns[*p]));
    let gyro = if gyro.len() == 3 { format!("gyro = {}\n", of(gyro)) } else { String::new() };
    Ok(format!(
        "kind = \"tumble\"\ngravity_m_s2 = {GRAVITY_M_S2} # assumed: standard gravity\n[columns]\n{gyro}accelerometer = {}\n{}",
        of(accelerometer),
        environment(rows)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::inspection::Column;
    use crate::recording::unit::Quantity;

    fn column(name: &str) -> Column {
        Column {
            name: name.into(),
            stated: None,
            quantity: Quantity::Unknown,
            is_environment: name.starts_with("temp"),
            lowest: -1.0,
            highest: 1.0,
            mean: 0.0,
            deviation: 0.5,
            step: None,
        }
    }

    fn seen(names: &[&str], sensors: [Vec<usize>; 2], still: Vec<Stretch>, poses: usize) -> Inspection {
        let columns = names.iter().map(|n| column(n)).collect();
        let rows = Rows {
            sha256: String::new(),
            rows: 10_000,
            samples: 10_000,
            rate_hz: Some(100.0),
            dropped: Vec::new(),
            findings: Vec::new(),
            columns,
            sensors,
            given: None,
            is_pose: false,
            still,
            poses,
        };
        Inspection { format: "text", parts: Vec::new(), part: None, clock: None, rows: Some(rows), obstacle: None }
    }

    pub(super) fn model(names: &[&str]) -> Result<Model> {
        let seen = seen(names, [Vec::new(), Vec::new()], Vec::new(), 0);
        parsed(&proposed("log.csv", &seen, &Named::default())?)
    }

    #[test]
    fn headings_say_which_column_drives_and_a_pair_that_says_nothing_is_refused_with_both_commands() {
        for (names, input, output) in [
            (&["force_N", "position_m"][..], Some("force_N"), "position_m"),
            (&["position_m", "control_V"], Some("control_V"), "position_m"),
            (&["drive", "V2_V"], Some("drive"), "V2_V"),
            (&["V1_V", "response_V", "temp_C"], Some("V1_V"), "response_V"),
            (&["roll_rad"], None, "roll_rad"),
            (&["Kraft [N]", "Weg [mm]"], Some("Kraft [N]"), "Weg [mm]"),
        ] {
            let Ok(Model::Driven(found)) = model(names) else { panic!("{names:?}") };
            assert_eq!((found.columns.input.as_deref(), found.columns.output.as_str()), (input, output));
        }
        for (names, is) in [
            (&["force_N", "velocity_mm_s"][..], model::Output::Velocity),
            (&["velocity_rad_s"], model::Output::Velocity),
            (&["force_N", "accel_out"], model::Output::Acceleration),
            (&["drive_V", "accel_out"], model::Output::Displacement),
            (&["force_N", "position_m"], model::Output::Displacement),
            (&["input_accel_m_s2", "output_accel"], model::Output::Displacement),
        ] {
            let Ok(Model::Driven(found)) = model(names) else { panic!("{names:?}") };
            assert_eq!(found.output_is, is, "{names:?}");
        }
        let refused = model(&["V1_V", "V2_V"]).expect_err("either may be the input").to_string();
        assert!(refused.contains("--input V1_V --output V2_V") && refused.contains("--input V2_V --output V1_V"));
        let refused = model(&["a1", "b1", "c1"]).expect_err("nothing says").to_string();
        assert!(refused.contains("--input"), "{refused}");
    }

    #[test]
    fn a_still_imu_is_at_rest_a_turned_one_in_poses_and_one_in_motion_asks_for_a_reference() {
        let names = ["gx", "gy", "gz", "ax", "ay", "az", "temp_C"];
        let sensors = [vec![0, 1, 2], vec![3, 4, 5]];
        let rest = |to_s: f64| vec![Stretch { from_s: 0.0, to_s }];
        let of = |still, poses| proposed("log.csv", &seen(&names, sensors.clone(), still, poses), &Named::default());
        let Ok(Ok(Model::Static(still))) = of(rest(99.0), 1).as_deref().map(parsed) else { panic!("at rest") };
        assert!(still.columns.channels == names[..6] && still.columns.environment == ["temp_C"]);
        let Ok(Ok(Model::Tumble(turned))) = of(rest(99.0), 8).as_deref().map(parsed) else { panic!("in poses") };
        assert!(turned.columns.accelerometer == ["ax", "ay", "az"]);
        let both = of(rest(65.0), 1).expect_err("rest or motion").to_string();
        assert!(both.contains("--from-s 0 --to-s 65") && both.contains("[reference]"), "{both}");
        assert!(of(Vec::new(), 0).expect_err("motion alone").to_string().contains("[reference]"));
        // One axis that moves decays; at rest in part, the user says which is meant.
        let one = |still| proposed("log.csv", &seen(&["gz_rad_s"], [vec![0], Vec::new()], still, 0), &Named::default());
        assert!(matches!(one(rest(99.0)).as_deref().map(parsed), Ok(Ok(Model::Static(_)))));
        assert!(matches!(one(Vec::new()).as_deref().map(parsed), Ok(Ok(Model::Driven(_)))));
        let both = one(rest(65.0)).expect_err("rest or decay").to_string();
        assert!(both.contains("--to-s 65") && both.contains("--output gz_rad_s"), "{both}");
    }
}
