//! `inspect` names the command that suits a file: small files, each with what it should name.

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand::RngExt as _;
use rand_distr::StandardNormal;
use serde_json::Value;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("inspect: each of many files gets the command that suits it", suited),
        test("inspect: what is no table of numbers is named, with a cell as example", no_table),
        test("inspect: what was assumed of units and surroundings is reported", assumed),
        test("diagnose: without a model a recording is read by its headings, and two readings are refused", unmodelled),
        test("diagnose, report, check: of two clocks --time names the one that is used", two_clocks),
    ]
}

const RATE_HZ: f64 = 50.0;
const GRAVITY_M_S2: f64 = 9.806_65;

/// Motion of an inertial sensor: seconds of rest in a direction, and of motion.
#[derive(Clone, Copy)]
enum Part {
    Rest(f64, [f64; 3]),
    Move(f64),
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const S: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn still() -> Vec<Part> {
    vec![Part::Rest(90.0, UP)]
}

fn flight() -> Vec<Part> {
    vec![Part::Move(90.0)]
}

fn flight_after_rest(seconds: f64) -> Vec<Part> {
    vec![Part::Rest(seconds, UP), Part::Move(150.0)]
}

/// A vehicle that stops at lights: always level.
fn stops() -> Vec<Part> {
    (0..12).flat_map(|_| [Part::Rest(5.0, UP), Part::Move(10.0)]).collect()
}

fn poses(rest_s: f64, move_s: f64) -> Vec<Part> {
    let faces = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], UP, [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let tilted = [[S, S, 0.0], [0.0, S, S], [S, 0.0, -S], [-S, S, 0.0]];
    faces.into_iter().chain(tilted).flat_map(|way| [Part::Rest(rest_s, way), Part::Move(move_s)]).collect()
}

/// Rates in rad/s and specific forces in m/s² along these parts, one row a sample.
fn inertial(parts: &[Part]) -> Vec<[f64; 6]> {
    let mut rng = Philox::new(33, 0, Stream::Host);
    let mut normal = |sd: f64| sd * rng.sample::<f64, _>(StandardNormal);
    let mut rows = Vec::new();
    for part in parts {
        let (seconds, way, [rate, force]) = match *part {
            Part::Rest(seconds, way) => (seconds, way, [1e-3, 0.02]),
            Part::Move(seconds) => (seconds, UP, [0.8, 2.0]),
        };
        for _ in 0..(seconds * RATE_HZ) as usize {
            let rates = [0, 1, 2].map(|_| normal(rate));
            let forces = way.map(|w| GRAVITY_M_S2 * w + normal(force));
            rows.push([rates[0], rates[1], rates[2], forces[0], forces[1], forces[2]]);
        }
    }
    rows
}

/// A text file with a clock in s and these numbers, scaled; `whole` rounds them to counts.
fn table(heading: &str, rows: &[[f64; 6]], [gyro, force]: [f64; 2], whole: bool, tail: &str) -> String {
    let number = |value: f64| if whole { format!("{}", value.round()) } else { format!("{value:.7}") };
    let mut text = format!("{heading}\n");
    for (k, row) in rows.iter().enumerate() {
        let cells: Vec<String> = (0..6).map(|i| number(row[i] / if i < 3 { gyro } else { force })).collect();
        text += &format!("{:.3},{}{tail}\n", k as f64 / RATE_HZ, cells.join(","));
    }
    text
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const SI: [f64; 2] = [1.0, 1.0];
const DEG_G: [f64; 2] = [DEGREE, GRAVITY_M_S2];
/// 131 counts per °/s, 4096 per g.
const COUNTS: [f64; 2] = [DEGREE / 131.0, GRAVITY_M_S2 / 4096.0];

/// Rows of poses: a circle with its attitude.
fn pose_rows(row: impl Fn(f64) -> String) -> String {
    (0..2000).map(|k| row(k as f64 * 0.01) + "\n").collect()
}

/// Two columns of an oscillator, or the second alone.
fn driven(heading: &str, with_input: bool) -> String {
    let mut rng = Philox::new(34, 0, Stream::Host);
    let mut text = format!("{heading}\n");
    let (mut x, mut v) = (if with_input { 0.0 } else { 1.0 }, 0.0);
    for k in 0..4000 {
        let u = if with_input { rng.sample::<f64, _>(StandardNormal) } else { 0.0 };
        let input = if with_input { format!("{u:.6},") } else { String::new() };
        text += &format!("{:.3},{input}{x:.8}\n", k as f64 * 0.01);
        for _ in 0..10 {
            v += 1e-3 * (u - 0.3 * v - 200.0 * x);
            x += 1e-3 * v;
        }
    }
    text
}

fn files() -> Vec<(&'static str, String, &'static str)> {
    const PLAIN: &str = "t_s,gx,gy,gz,ax,ay,az";
    const STATED: &str = "t_s,gx_deg_s,gy_deg_s,gz_deg_s,ax_g,ay_g,az_g";
    const LSB: &str = "t_s,gx_lsb,gy_lsb,gz_lsb,ax_lsb,ay_lsb,az_lsb";
    const WITH_TEMPERATURE: &str = "t_s,gx,gy,gz,ax,ay,az,temp_C";
    const ALLAN: &str = "allan FILE";
    const TUMBLE: &str = "kind = \"tumble\"";
    const FLIGHT: &str = "kind = \"trajectory\"";
    const PART: &str = "allan FILE --from-s";
    const DRIVEN: &str = "kind = \"driven\"";
    const REFERENCE: &str = "[reference] has file";
    const SWEEP: &str = "diagnose FILE, which chooses kind = \"response\", frequency = \"frequency_hz\"";
    const NAMED: &str = "of an inertial sensor, its axes: proofmass allan FILE --gyro X,Y,Z --accelerometer X,Y,Z";
    const AROUND: &str = "record these columns with the sensor's readings";
    let [rest, fly] = [inertial(&still()), inertial(&flight())];
    let [turned, long] = [inertial(&poses(6.0, 2.0)), inertial(&poses(30.0, 2.0))];
    let [after, soon, lights] =
        [inertial(&flight_after_rest(80.0)), inertial(&flight_after_rest(10.0)), inertial(&stops())];
    let turn = |t: f64| ((0.1 * t).cos(), (0.1 * t).sin());
    let only = |text: String, places: &[usize]| -> String {
        let cut =
            |line: &str| places.iter().map(|p| line.split(',').nth(*p).unwrap_or("")).collect::<Vec<_>>().join(",");
        text.lines().map(|line| cut(line) + "\n").collect()
    };
    // A column at 10 Hz, where a second's window holds few of its samples.
    let slow = |text: String, place: usize| -> String {
        only(text, &[0, place])
            .lines()
            .enumerate()
            .filter(|(k, _)| *k == 0 || k % 5 == 1)
            .map(|(_, l)| l.to_owned() + "\n")
            .collect()
    };
    let gyros = |rows: &[[f64; 6]], heading| only(table(heading, rows, SI, false, ""), &[0, 1, 2, 3]);
    let forces = |rows: &[[f64; 6]], heading, unit| only(table(heading, rows, unit, false, ""), &[0, 4, 5, 6]);
    vec![
        ("still in SI", table(PLAIN, &rest, SI, false, ""), ALLAN),
        ("still in deg/s and g without a unit", table(PLAIN, &rest, DEG_G, false, ""), ALLAN),
        ("still in deg/s and g", table(STATED, &rest, DEG_G, false, ""), ALLAN),
        ("still in counts", table(LSB, &rest, COUNTS, true, ""), ALLAN),
        ("still in counts without a unit", table(PLAIN, &rest, COUNTS, true, ""), ALLAN),
        ("still with a temperature", table(WITH_TEMPERATURE, &rest, SI, false, ",25.1"), ALLAN),
        ("still gyro alone", gyros(&rest, PLAIN), ALLAN),
        ("still accelerometer alone", forces(&rest, PLAIN, SI), ALLAN),
        ("still accelerometer in g without a unit", forces(&rest, PLAIN, DEG_G), ALLAN),
        ("still accelerometer in mg", forces(&rest, "t_s,x,y,z,ax_mg,ay_mg,az_mg", [1.0, 9.80665e-3]), ALLAN),
        ("one still gyro", only(table("t_s,gyro_rad_s,b,c,d,e,f", &rest, SI, false, ""), &[0, 1]), ALLAN),
        ("one still accelerometer", only(table("t_s,a,b,c,d,e,accel_m_s2", &rest, SI, false, ""), &[0, 6]), ALLAN),
        ("one axis of a gyro", slow(table("t_s,a,b,gz_rad_s,d,e,f", &rest, SI, false, ""), 3), ALLAN),
        ("one level axis", slow(table("t_s,a,b,c,acc_x_m_s2,e,f", &rest, SI, false, ""), 4), ALLAN),
        ("one axis without a unit", slow(table("t_s,a,gy,c,d,e,f", &rest, SI, false, ""), 2), ALLAN),
        ("a force alone decays", slow(table("t_s,a,b,c,force_x,e,f", &rest, SI, false, ""), 4), DRIVEN),
        ("one axis that decays", driven("t_s,gx_rad_s", false), DRIVEN),
        ("poses in SI", table(PLAIN, &turned, SI, false, ""), TUMBLE),
        ("poses in deg/s and g without a unit", table(PLAIN, &turned, DEG_G, false, ""), TUMBLE),
        ("poses in deg/s and g", table(STATED, &turned, DEG_G, false, ""), TUMBLE),
        ("poses in counts", table(LSB, &turned, COUNTS, true, ""), TUMBLE),
        ("poses in counts without a unit", table(PLAIN, &turned, COUNTS, true, ""), TUMBLE),
        ("long poses, nearly always still", table(PLAIN, &long, SI, false, ""), TUMBLE),
        ("long poses in counts", table(LSB, &long, COUNTS, true, ""), TUMBLE),
        ("poses of an accelerometer alone", forces(&turned, PLAIN, SI), TUMBLE),
        ("poses with a temperature", table(WITH_TEMPERATURE, &turned, SI, false, ",25.1"), TUMBLE),
        ("a flight in SI", table(PLAIN, &fly, SI, false, ""), FLIGHT),
        ("a flight in deg/s and g", table(STATED, &fly, DEG_G, false, ""), FLIGHT),
        ("a flight in deg/s and g without a unit", table(PLAIN, &fly, DEG_G, false, ""), FLIGHT),
        ("a flight in counts", table(LSB, &fly, COUNTS, true, ""), FLIGHT),
        ("a flight after a short rest", table(PLAIN, &soon, SI, false, ""), FLIGHT),
        ("a vehicle that stops level", table(PLAIN, &lights, SI, false, ""), FLIGHT),
        ("a flight after a long rest", table(PLAIN, &after, SI, false, ""), PART),
        ("a flight in deg/s after a long rest", table(PLAIN, &after, DEG_G, false, ""), PART),
        ("a flight in counts after a long rest", table(LSB, &after, COUNTS, true, ""), PART),
        (
            "EuRoC's ground truth",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
                .to_owned()
                + &pose_rows(|t| {
                    let (c, s) = turn(t);
                    format!("{},{c:.6},{s:.6},0.5,{c:.6},0,0,{s:.6}", (1.4e18 + t * 1e9) as i64)
                }),
            REFERENCE,
        ),
        (
            "TUM without headings",
            pose_rows(|t| {
                let (c, s) = turn(t);
                format!("{t:.3} {c:.6} {s:.6} 0.5 0 0 {s:.6} {c:.6}")
            }),
            REFERENCE,
        ),
        (
            "poses with a quaternion",
            "t_s,x,y,z,qw,qx,qy,qz\n".to_owned()
                + &pose_rows(|t| {
                    let (c, s) = turn(t);
                    format!("{t:.3},{c:.6},{s:.6},0.5,{c:.6},0,0,{s:.6}")
                }),
            REFERENCE,
        ),
        (
            "attitudes alone",
            "t_s,quat_w,quat_x,quat_y,quat_z\n".to_owned()
                + &pose_rows(|t| {
                    let (c, s) = turn(t);
                    format!("{t:.3},{c:.6},0,0,{s:.6}")
                }),
            REFERENCE,
        ),
        (
            "roll, pitch, yaw",
            "t_s,roll_deg,pitch_deg,yaw_deg\n".to_owned()
                + &pose_rows(|t| format!("{t:.3},{:.5},{:.5},{t:.5}", t.sin(), t.cos())),
            REFERENCE,
        ),
        (
            "positions",
            "t_s,north_m,east_m,down_m\n".to_owned()
                + &pose_rows(|t| format!("{t:.3},{:.5},{:.5},-1.5", t.sin(), t.cos())),
            REFERENCE,
        ),
        ("a shaken mass", driven("t_s,force_m_s2,x_um", true), DRIVEN),
        ("a circuit", driven("t_s,V1_V,V2_V", true), "diagnose FILE --input V1_V --output V2_V, or"),
        ("a ring-down", driven("t_s,x_um", false), DRIVEN),
        ("a ring-down in volts", driven("t_s,reading_V", false), DRIVEN),
        ("steps of a lock-in at an even pace", sweep(|k| 2.0 * k), SWEEP),
        // No one rate describes its clock, and none is needed.
        ("steps of a lock-in that slow down", sweep(|k| 2.0 * k + 0.01 * k * k), SWEEP),
        ("readings without headings", table("", &rest, SI, false, "").trim_start().to_owned(), NAMED),
        ("surroundings alone", "t_s,temp_C,pressure_hPa\n".to_owned() + &pose_rows(|t| format!("{t},{t},{t}")), AROUND),
    ]
}

/// A lock-in's record of one resonance: one step a row, at the times given.
fn sweep(time_s: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("t_s,frequency_hz,x_v,y_v,drive_v\n");
    for k in 0..200 {
        let (off, time_s) = (f64::from(k) * 0.1 - 10.0, time_s(f64::from(k)));
        let size = 1.0 / (1.0 + off * off);
        text += &format!("{time_s:.3},{:.1},{:.6},{:.6},0.1\n", 1000.0 + off, size, off * size);
    }
    text
}

/// Findings of a diagnosis without a model, or what it is refused with, and the names of the files that
/// it wrote.
fn diagnosed(text: &str, options: &[&str]) -> Result<(String, Vec<String>), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("file.csv"), text)?;
    let command = ["diagnose", "file.csv", "--json", "--out", "out"];
    let output = program().current_dir(folder.path()).args(command).args(options).output()?;
    if output.status.code() == Some(2) {
        return Ok((String::from_utf8_lossy(&output.stderr).into_owned(), Vec::new()));
    }
    let document: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("{error}: {}", String::from_utf8_lossy(&output.stderr)))?;
    let files = std::fs::read_dir(folder.path().join("out"))?.flatten();
    let files = files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    Ok((format!("{}: {}", document["kind"], document["findings"]), files))
}

fn unmodelled() -> Result<(), Failed> {
    let has = |said: &str, words: &str| check(said.contains(words), format!("need {words}, got {said}"));
    let (shaken, files) = diagnosed(&driven("t_s,force_m_s2,x_um", true), &[])?;
    has(&shaken, "driven")?;
    has(&shaken, "input = \\\"force_m_s2\\\"")?;
    check(files.iter().any(|f| f == "proposed.toml"), format!("{files:?}"))?;
    let circuit = driven("t_s,V1_V,V2_V", true);
    let (refused, _) = diagnosed(&circuit, &[])?;
    has(&refused, "--input V1_V --output V2_V, or proofmass diagnose file.csv --input V2_V --output V1_V")?;
    let (named, _) = diagnosed(&circuit, &["--input", "V1_V"])?;
    has(&named, "output = \\\"V2_V\\\"")?;
    let moving = table("t_s,gx,gy,gz,ax,ay,az", &inertial(&flight()), SI, false, "");
    has(&diagnosed(&moving, &[])?.0, "[reference]")?;
    // Hum on a sensor whose heading says nothing is no decay; a decay, the control, is.
    let mut rng = Philox::new(35, 0, Stream::Host);
    let hum = |k: usize| (314.0 * 0.002 * k as f64).sin();
    let rows =
        (0..4000).map(|k| format!("{:.3},{:.5}\n", k as f64 * 0.002, hum(k) + rng.sample::<f64, _>(StandardNormal)));
    let (steady, _) = diagnosed(&(String::from("t_s,output_V\n") + &rows.collect::<String>()), &[])?;
    has(&steady, "kind = \\\"static\\\"")?;
    let (decay, _) = diagnosed(&driven("t_s,output_V", false), &[])?;
    check(!decay.contains("picks up hum"), decay)?;
    // Control: with a model of one's own nothing is chosen.
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("file.csv"), &circuit)?;
    let model = "kind = \"driven\"\n[columns]\ninput = \"V1_V\"\noutput = \"V2_V\"\n";
    std::fs::write(folder.path().join("model.toml"), model)?;
    let command = ["diagnose", "file.csv", "--model", "model.toml"];
    let output = program().current_dir(folder.path()).args(command).output()?;
    check(!String::from_utf8_lossy(&output.stderr).contains("no model was given"), "a model was chosen")
}

/// A file stamped by its host and by the sensor: refused with the option that chooses, which each
/// command takes.
fn two_clocks() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let rows = inertial(&still()).into_iter().enumerate();
    let stamp = |(k, row): (usize, [f64; 6])| {
        let t = k as f64 / RATE_HZ;
        format!("{},{t},{},{},{}\n", t * 1.0001 + 0.3, row[0], row[1], row[2])
    };
    let text: String = rows.map(stamp).collect();
    let heading = "host_time_s,sensor_time_s,gx_rad_s,gy_rad_s,gz_rad_s\n";
    std::fs::write(folder.path().join("file.csv"), format!("{heading}{text}"))?;
    let said = |arguments: &[&str]| -> Result<[String; 2], Failed> {
        let output = program().current_dir(folder.path()).args(arguments).output()?;
        Ok([output.stdout, output.stderr].map(|words| String::from_utf8_lossy(&words).into_owned()))
    };
    let [_, refused] = said(&["diagnose", "file.csv"])?;
    check(refused.contains("--time NAME"), &refused)?;
    for (clock, rate_hz) in [("sensor_time_s", RATE_HZ), ("host_time_s", RATE_HZ / 1.0001)] {
        let [verdict, _] = said(&["diagnose", "file.csv", "--time", clock, "--json"])?;
        let verdict: Value = serde_json::from_str(&verdict)?;
        let used = verdict["recording"]["rate_hz"].as_f64().unwrap_or(f64::NAN);
        check((used / rate_hz - 1.0).abs() < 1e-6, format!("{clock}: {used} Hz"))?;
    }
    for command in ["diagnose", "report", "check"] {
        let [answer, model] = said(&[command, "file.csv", "--time", "sensor_time_s"])?;
        check(model.contains("time = \"sensor_time_s\"") && !answer.is_empty(), format!("{command}: {answer}{model}"))?;
    }
    let [_, absent] = said(&["diagnose", "file.csv", "--time", "time"])?;
    check(absent.contains("there is no column `time`") && absent.contains("sensor_time_s"), absent)
}

fn inspected(text: &str) -> Result<(String, Value), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("file.csv"), text)?;
    let output = program().current_dir(folder.path()).args(["inspect", "file.csv", "--json"]).output()?;
    let document: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("{error}: {}", String::from_utf8_lossy(&output.stderr)))?;
    Ok((document["next"].as_str().unwrap_or("nothing").to_owned(), document))
}

fn suited() -> Result<(), Failed> {
    let mut wrong = Vec::new();
    for (name, text, expected) in files() {
        let (next, document) = inspected(&text)?;
        let expected = expected.replace("FILE", "file.csv");
        let exact = !expected.starts_with("allan") || expected.contains("--from-s") || !next.contains("--from-s");
        if !(next.contains(&expected) && exact) {
            wrong.push(format!(
                "{name}: need {expected}, got {next}; {}, still {}",
                document["findings"], document["still"]
            ));
        }
    }
    check(wrong.is_empty(), wrong.join("\n"))
}

fn no_table() -> Result<(), Failed> {
    let problem = |text: &str| -> Result<String, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("file.csv"), text)?;
        let output = program().current_dir(folder.path()).args(["inspect", "file.csv"]).output()?;
        Ok(String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
    };
    for (text, words) in [
        ("{\"t\": 0.1, \"gx\": 0.2}\n{\"t\": 0.2, \"gx\": 0.1}\n", "this is JSON, not a table"),
        ("t_s,gx,gy\n0.1,0x3E8,0x3E9\n0.2,0x3E8,0x3E9\n", "the first cell of `gx` is `0x3E8`"),
        ("version: 9\nstorage: mcap\nfiles: 3\n", "no column holds numbers"),
    ] {
        let said = problem(text)?;
        check(said.contains(words), format!("need {words}, got {said}"))?;
    }
    // Control: a table has no such problem.
    check(!problem("t_s,gx\n0.1,0.2\n0.2,0.3\n0.3,0.1\n")?.contains("no column holds"), "a table")
}

fn assumed() -> Result<(), Failed> {
    let rest = inertial(&still());
    let said = |text: String| -> Result<String, Failed> { Ok(inspected(&text)?.1.to_string()) };
    let plain = "t_s,gx,gy,gz,ax,ay,az";
    let degrees = said(table(plain, &rest, DEG_G, false, ""))?;
    check(degrees.contains("are they in deg/s?") && degrees.contains("taken as g, because"), &degrees)?;
    let counts = said(table("t_s,gx_lsb,gy_lsb,gz_lsb,ax_lsb,ay_lsb,az_lsb", &rest, COUNTS, true, ""))?;
    check(counts.contains("length is 409") || counts.contains("length is 410"), &counts)?;
    let (_, warm) = inspected(&table("t_s,gx,gy,gz,ax,ay,az,temp_C", &rest, SI, false, ",25.1"))?;
    let column = warm["columns"].as_array().into_iter().flatten().find(|c| c["name"] == "temp_C").cloned();
    check(column.is_some_and(|c| c["quantity"] == "environment"), warm["columns"].to_string())?;
    // Control: what states its units has nothing to be assumed.
    let stated = said(table("t_s,gx_deg_s,gy_deg_s,gz_deg_s,ax_g,ay_g,az_g", &rest, DEG_G, false, ""))?;
    check(!stated.contains("taken as") && !stated.contains("counts:"), stated)
}
