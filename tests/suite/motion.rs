//! A trajectory from a file is the motion that its IMU felt, and files that hold none are refused
//! by name.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};
use nalgebra::{UnitQuaternion, Vector3};
use proofmass::document;
use proofmass::error::Result as Answer;
use proofmass::motion::mechanisation::{Integrator, own_error};
use proofmass::motion::sources::{self, Section};
use proofmass::motion::{Earth, Sampling, Trajectory};

use super::world::{check, data_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("motion: a good file is read alike in every layout, and comes back from its own readings", layouts),
        test("motion: poses that are no motion are refused by name, the same file untouched is not", bad_input),
        data_test("motion: along two EuRoC flights the spline feels what the IMU felt", felt),
        data_test("motion: scalar-first and left-handed quaternions of a real flight are recognised", misread),
    ]
}

/// A row of a made-up flight: time, position with z up, attitude.
type Row = (f64, Vector3<f64>, UnitQuaternion<f64>);

/// A body that flies an eight, nose along the way and leaning into its turns, for twelve seconds at
/// 100 Hz; z up.
fn flight() -> Vec<Row> {
    let row = |k: u32| {
        let t = f64::from(k) * 0.01;
        let position = Vector3::new((0.6 * t).sin() * 8.0, (1.2 * t).sin() * 4.0, 1.0 + 0.3 * (0.9 * t).sin());
        let heading = (1.2 * t).cos().atan2((0.6 * t).cos());
        let attitude = UnitQuaternion::from_euler_angles(0.1 * (1.2 * t).sin(), 0.05, heading);
        (t, position, attitude)
    };
    (0..=1200).map(row).collect()
}

fn euroc(rows: &[Row]) -> String {
    let mut text =
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n".to_owned();
    for (t, p, q) in rows {
        let stamp = 1_403_715_524_907_143_168i64 + (t * 1e9).round() as i64;
        let _ = writeln!(
            text,
            "{stamp},{:.12},{:.12},{:.12},{:.12},{:.12},{:.12},{:.12}",
            p.x, p.y, p.z, q.w, q.i, q.j, q.k
        );
    }
    text
}

fn tum(rows: &[Row]) -> String {
    let mut text = String::new();
    for (t, p, q) in rows {
        let _ = writeln!(
            text,
            "{t:.6} {:.12} {:.12} {:.12} {:.12} {:.12} {:.12} {:.12}",
            p.x, p.y, p.z, q.i, q.j, q.k, q.w
        );
    }
    text
}

fn kitti(rows: &[Row]) -> (String, String) {
    let (mut text, mut times) = (String::new(), String::new());
    for (t, p, q) in rows {
        let r = q.to_rotation_matrix();
        for k in 0..3 {
            let end = if k == 2 { "\n" } else { " " };
            let _ = write!(text, "{:.12e} {:.12e} {:.12e} {:.12e}{end}", r[(k, 0)], r[(k, 1)], r[(k, 2)], p[k]);
        }
        let _ = writeln!(times, "{t:.6e}");
    }
    (text, times)
}

fn angles(rows: &[Row], heading: &str, unit: f64) -> String {
    let mut text = format!("t_s,x,y,z,{heading}\n");
    for (t, p, q) in rows {
        let (roll, pitch, yaw) = q.euler_angles();
        let _ = writeln!(
            text,
            "{t:.6},{:.12},{:.12},{:.12},{:.12},{:.12},{:.12}",
            p.x,
            p.y,
            p.z,
            roll * unit,
            pitch * unit,
            yaw * unit
        );
    }
    text
}

/// Writes files into a folder of their own and reads the section's trajectory there.
fn read(files: &[(&str, &str)], section: &str) -> Answer<Trajectory> {
    read_for(files, section, 10.0)
}

fn read_for(files: &[(&str, &str)], section: &str, duration_s: f64) -> Answer<Trajectory> {
    let folder = tempfile::tempdir().map_err(|e| proofmass::error::Error::io("make", Path::new("folder"), &e))?;
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, text).map_err(|e| proofmass::error::Error::io("write", &path, &e))?;
    }
    let section: Section = document::parse_toml("study.toml", section)?;
    sources::trajectory(&section.in_folder(folder.path()), duration_s)
}

const STILL: Sampling = Sampling { rate_hz: 200.0, duration_s: 10.0, lever_arm_m: Vector3::new(0.0, 0.0, 0.0) };

fn layouts() -> Result<(), Failed> {
    let rows = flight();
    let (matrices, times) = kitti(&rows);
    let degrees = 180.0 / std::f64::consts::PI;
    let written = [
        ("kind = \"file\"\nfile = \"a.csv\"", vec![("a.csv", euroc(&rows))]),
        ("kind = \"file\"\nfile = \"a.txt\"\nformat = \"tum\"", vec![("a.txt", tum(&rows))]),
        (
            "kind = \"file\"\nfile = \"a.txt\"\ntimes = \"times.txt\"\nup = \"z\"",
            vec![("a.txt", matrices), ("times.txt", times)],
        ),
        ("kind = \"file\"\nfile = \"a.csv\"", vec![("a.csv", angles(&rows, "roll_deg,pitch_deg,yaw_deg", degrees))]),
        ("kind = \"file\"\nfile = \"a.csv\"", vec![("a.csv", angles(&rows, "roll,pitch,yaw", 1.0))]),
    ];
    let mut first = None;
    for (section, files) in written {
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let trajectory = read(&files, section)?;
        let said: Vec<String> = trajectory.findings.iter().map(ToString::to_string).collect();
        check(said.iter().any(|s| s.contains("north = x, east = −y, down = −z")), format!("{section}: {said:?}"))?;
        check(said.iter().any(|s| s.contains("knot every")), format!("{section}: {said:?}"))?;
        check(trajectory.departure.largest_m < 1e-3, format!("{section}: {:?}", trajectory.departure))?;
        let truth = trajectory.truth(&Earth::FLAT, STILL)?;
        // The flight itself, z up: north = x, east = −y, down = −z.
        let (sample, (_, position, _)) = (truth.samples[800], rows[400]);
        let way = position - rows[0].1;
        let expected = Vector3::new(way.x, -way.y, -way.z);
        near(&format!("{section}: position"), (sample.position_m - expected).norm(), 0.0, 1e-3)?;
        let first = first.get_or_insert_with(|| truth.clone());
        let apart = truth
            .samples
            .iter()
            .zip(&first.samples)
            .map(|(a, b)| (a.specific_force_m_s2 - b.specific_force_m_s2).norm());
        near(&format!("{section}: specific force"), apart.fold(0.0, f64::max), 0.0, 1e-3)?;
        let strays = own_error(&Earth::FLAT, Integrator::Compensated, &truth);
        let largest = strays.iter().map(|d| d.position_m.norm()).fold(0.0, f64::max);
        check(largest < 1e-3, format!("{section}: it comes back within {largest} m"))?;
    }
    Ok(())
}

/// What a change of the flight is refused with, or mentioned by.
fn said(answer: &Answer<Trajectory>) -> String {
    match answer {
        Ok(trajectory) => trajectory.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        Err(error) => error.to_string(),
    }
}

fn bad_input() -> Result<(), Failed> {
    let rows = flight();
    let section = "kind = \"file\"\nfile = \"a.csv\"";
    let as_tum = "kind = \"file\"\nfile = \"a.csv\"\nformat = \"tum\"";
    let good = read(&[("a.csv", &euroc(&rows))], section);
    check(good.is_ok(), format!("untouched: {}", said(&good)))?;
    let words = said(&good);
    let changed = |change: &dyn Fn(&mut Vec<Row>)| {
        let mut rows = rows.clone();
        change(&mut rows);
        rows
    };
    let swapped: Vec<Row> = changed(&|rows| {
        // Written w x y z where x y z w belongs.
        for (_, _, q) in rows {
            *q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q.k, q.w, q.i, q.j));
        }
    });
    let inverse = changed(&|rows| rows.iter_mut().for_each(|r| r.2 = r.2.inverse()));
    let jumped = changed(&|rows| rows[600..].iter_mut().for_each(|r| r.1.x += 0.5));
    let slow = changed(&|rows| *rows = rows.iter().step_by(50).copied().collect());
    let backwards = changed(&|rows| rows[600..].iter_mut().for_each(|r| r.0 -= 1.0));
    let holed = euroc(&rows).lines().enumerate().fold(String::new(), |text, (k, line)| {
        let line = if k == 300 { "1403715527897143168,nan,nan,nan,nan,nan,nan,nan" } else { line };
        text + line + "\n"
    });
    let degrees = 180.0 / std::f64::consts::PI;
    let cases = [
        ("poses at 2 Hz", euroc(&slow), section, "the poses come at 2 Hz"),
        ("a jump", euroc(&jumped), section, "position jumps by 0.5"),
        ("a row of NaN", holed, section, "1 rows of the trajectory hold no pose"),
        ("quaternions scalar first in a TUM file", tum(&swapped), as_tum, "the quaternions are scalar-first"),
        ("left-handed quaternions", euroc(&inverse), section, "the quaternions are left-handed"),
        ("degrees for radians", angles(&rows, "roll,pitch,yaw", degrees), section, "degrees for radians"),
        ("stamps that run backwards", euroc(&backwards), section, "the stamps run backwards"),
        ("a file of KITTI without times", kitti(&rows).0, section, "has no times"),
    ];
    for (what, text, section, expected) in cases {
        let answer = read(&[("a.csv", &text)], section);
        check(said(&answer).contains(expected), format!("{what}: {}", said(&answer)))?;
        check(!words.contains(expected), format!("{what}: the untouched file says so too: {words}"))?;
    }
    // Angles of zero are a level body; a quaternion of zeros is none.
    let level = changed(&|rows| rows.iter_mut().for_each(|r| r.2 = UnitQuaternion::identity()));
    let answer = read(&[("a.csv", &angles(&level, "roll,pitch,yaw", 1.0))], section);
    check(answer.is_ok() && !said(&answer).contains("hold no pose"), said(&answer))?;
    let none = |line: &str| line.split(',').take(4).collect::<Vec<_>>().join(",") + ",0,0,0,0";
    let text = euroc(&rows);
    let zeros = text.lines().enumerate().map(|(k, line)| if k == 300 { none(line) } else { line.to_owned() });
    let answer = read(&[("a.csv", &(zeros.collect::<Vec<_>>().join("\n") + "\n"))], section);
    check(said(&answer).contains("1 rows of the trajectory hold no pose"), said(&answer))
}

fn flight_of(data: &Path, set: &str, [from_s, duration_s]: [f64; 2]) -> Answer<Trajectory> {
    let text = format!("kind = \"file\"\nfile = \"{set}/ground_truth.csv\"\nfrom_s = {from_s:?}");
    let section: Section = document::parse_toml("study.toml", &text)?;
    sources::trajectory(&section.in_folder(data), duration_s)
}

/// Rows of a table of numbers.
fn table(path: PathBuf) -> Result<Vec<Vec<f64>>, Failed> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().unwrap_or(f64::NAN)).collect();
    Ok(text.lines().filter(|l| !l.starts_with('#')).map(row).collect())
}

fn felt(data: &Path) -> Result<(), Failed> {
    // The reference of MH_04 finds its bearings again at 45 s: by second differences of the file it
    // leaps 5202.7 m/s² × (5 ms)².
    let leaps = said(&flight_of(data, "euroc_mh04", [5.0, 60.0]));
    check(leaps.contains("position jumps by 0.13 m") && leaps.contains("(at 40 s of the study)"), leaps)?;
    for (set, from_s, duration_s) in [("euroc_v102", 5.0, 60.0), ("euroc_mh04", 10.0, 25.0)] {
        let trajectory = flight_of(data, set, [from_s, duration_s])?;
        check(!said(&Ok(trajectory.clone())).contains("jumps"), said(&Ok(trajectory.clone())))?;
        let sampling = Sampling { duration_s, ..STILL };
        let truth = trajectory.truth(&Earth::FLAT, sampling)?;
        let (poses, readings) =
            (table(data.join(set).join("ground_truth.csv"))?, table(data.join(set).join("imu0.csv"))?);
        // The body axes are the IMU's, so what the spline feels, averaged over a tenth of a second,
        // is what the IMU read but for its biases, which the set's authors give.
        let start_s = poses[0][0] * 1e-9 + from_s;
        let bias = &poses[poses.len() / 2];
        let (mut rate, mut force, mut wrong, mut count) = (0.0, 0.0, 0.0, 0.0);
        for window in readings.chunks_exact(20) {
            let at = window[0][0] * 1e-9 - start_s;
            let k = (at * 200.0).round();
            if at < 0.5 || at > duration_s - 0.5 {
                continue;
            }
            let felt = &truth.samples[k as usize..k as usize + 20];
            let mean = |column: usize| window.iter().map(|r| r[column]).sum::<f64>() / 20.0;
            for axis in 0..3 {
                let spun = felt.iter().map(|s| s.rate_rad_s[axis]).sum::<f64>() / 20.0;
                let pushed = felt.iter().map(|s| s.specific_force_m_s2[axis]).sum::<f64>() / 20.0;
                rate += (mean(1 + axis) - bias[11 + axis] - spun).powi(2);
                force += (mean(4 + axis) - bias[14 + axis] - pushed).powi(2);
                wrong += (mean(4 + axis) - bias[14 + axis] + pushed).powi(2);
                count += 1.0;
            }
        }
        let [rate, force, wrong] = [rate, force, wrong].map(|sum: f64| (sum / count).sqrt());
        check(count > 700.0, format!("{set}: {count} comparisons"))?;
        check(rate < 0.01, format!("{set}: rate differs by {rate} rad/s (rms)"))?;
        check(force < 0.15, format!("{set}: specific force differs by {force} m/s² (rms)"))?;
        check(wrong > 5.0, format!("{set}: upside down it would differ by {wrong}"))?;
        check(trajectory.departure.rms_m < 5e-3, format!("{set}: {:?}", trajectory.departure))?;
    }
    Ok(())
}

fn misread(data: &Path) -> Result<(), Failed> {
    for set in ["euroc_v102", "euroc_mh04"] {
        let poses = table(data.join(set).join("ground_truth.csv"))?;
        let start = poses[0][0];
        let rows: Vec<Row> = poses
            .iter()
            .map(|r| {
                let q = nalgebra::Quaternion::new(r[4], r[5], r[6], r[7]);
                let position = Vector3::new(r[1], r[2], r[3]);
                ((r[0] - start) * 1e-9, position, UnitQuaternion::from_quaternion(q))
            })
            .collect();
        let section = "kind = \"file\"\nfile = \"a.csv\"\nfrom_s = 5.0\nformat = \"tum\"";
        let good = read_for(&[("a.csv", &tum(&rows))], section, 60.0);
        check(good.is_ok(), format!("{set}: {}", said(&good)))?;
        for (what, change) in [
            (
                "scalar-first",
                (|q| UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q.k, q.w, q.i, q.j))) as Change,
            ),
            ("left-handed", |q| q.inverse()),
        ] {
            let changed: Vec<Row> = rows.iter().map(|(t, p, q)| (*t, *p, change(*q))).collect();
            let answer = read_for(&[("a.csv", &tum(&changed))], section, 60.0);
            check(
                said(&answer).contains(&format!("quaternions are {what}")),
                format!("{set}, {what}: {}", said(&answer)),
            )?;
        }
    }
    Ok(())
}

type Change = fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>;
