//! Units of named columns: every command takes the file's unit, refuses a contradiction with both
//! sides of it, and reports what it assumes.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand::RngExt as _;
use rand_distr::StandardNormal;
use serde_json::Value;

use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("units: seventy headings and rows of units give one scale, named or not", headings),
        test("units: Latin-1 bytes are units too", latin_1),
        test(
            "units: a scale that contradicts the heading is refused with both, one that agrees is used",
            contradiction,
        ),
        test("units: where nothing is stated the size decides or is reported", sizes),
        test("units: diagnose, compare and inspect keep the file's unit and refuse another", other_commands),
        test("units: a driven recording in m/s² or g has no broken unit", driven_units),
    ]
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const ROWS: usize = 2000;

/// White noise of unit size in three columns about these means, with a time column; headings, and a
/// row of units, if any.
fn log(path: &Path, headings: &[u8], units: Option<&str>, size: f64, means: [f64; 3]) -> Result<(), Failed> {
    let mut rng = Philox::new(31, 0, Stream::Host);
    let mut text = [headings, b"\n"].concat();
    if let Some(units) = units {
        text.extend_from_slice(format!("{units}\n").as_bytes());
    }
    for _ in 0..ROWS {
        let row = means.map(|mean| (mean + size * rng.sample::<f64, _>(StandardNormal)).to_string());
        text.extend_from_slice(format!("{}\n", row.join(",")).as_bytes());
    }
    Ok(std::fs::write(path, text)?)
}

struct Said {
    document: Value,
    error: String,
    code: Option<i32>,
}

fn run(arguments: &[&str]) -> Result<Said, Failed> {
    let output = program().args(arguments).arg("--json").output()?;
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    let document = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    Ok(Said { document, error, code: output.status.code() })
}

/// N of the first channel in its own words, as SI (rad/√s or m/s/√s), or in the file's unit.
fn walk(document: &Value) -> f64 {
    let channel = &document["channels"][0];
    let term = channel["terms"].as_array().into_iter().flatten().find(|t| t["symbol"] == "N").unwrap_or(&Value::Null);
    let value = term["value"].as_f64().unwrap_or(f64::NAN);
    match term["unit"].as_str() {
        Some("°/√h") => value * DEGREE / 60.0,
        Some("m/s/√h") => value / 60.0,
        _ => value,
    }
}

fn text(said: &Said) -> String {
    format!("{} {}", said.document["findings"], said.error)
}

fn headings() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("u.csv");
    let file = path.to_string_lossy().into_owned();
    log(&path, b"p,q,r", None, 1.0, [0.0; 3])?;
    let raw = walk(&run(&["allan", &file, "--rate-hz", "100", "--columns", "p,q,r"])?.document);
    check(raw > 0.0, "the reference without a unit has an N")?;
    let table = include_str!("units/headings.tsv");
    let rows: Vec<Vec<&str>> = table.lines().filter(|l| !l.starts_with('#')).map(|l| l.split('\t').collect()).collect();
    check(rows.len() >= 60, format!("{} headings", rows.len()))?;
    let mut wrong = Vec::new();
    for row in rows {
        let [heading, units, sensor, expected] = row[..] else { return Err(format!("{row:?}").into()) };
        let names = ["x", "y", "z"].map(|axis| heading.replace('%', axis));
        let units = (units != "-").then(|| [units; 3].join(","));
        log(&path, names.join(",").as_bytes(), units.as_deref(), 1.0, [0.0; 3])?;
        let named = run(&["allan", &file, "--rate-hz", "100", &format!("--{sensor}"), &names.join(",")])?;
        let bare = run(&["allan", &file, "--rate-hz", "100"])?;
        let seen = run(&["inspect", &file, "--rate-hz", "100"])?;
        let refused =
            named.code == Some(2) && named.error.contains(names[0].split([' ', '[', '(']).next().unwrap_or(""));
        let is_right = match expected {
            "refused" => refused,
            "assumed" => text(&named).contains("is not stated: taken as") && text(&bare).contains("taken as"),
            si => {
                let si: f64 = si.parse()?;
                let alike = |document: &Value| (walk(document) / raw / si - 1.0).abs() < 1e-6;
                let quantity = &seen.document["columns"][0]["quantity"];
                alike(&named.document)
                    && alike(&bare.document)
                    && quantity == sensor
                    && seen.document["columns"][0]["unit"] != Value::Null
            }
        };
        if !is_right {
            let [got, of_bare] = [&named, &bare].map(|said| walk(&said.document) / raw);
            wrong.push(format!(
                "{heading} {units:?}: need {expected}, got {got} named, {of_bare} not; inspect {}; {}",
                seen.document["columns"][0], named.error
            ));
        }
    }
    check(wrong.is_empty(), wrong.join("\n"))
}

fn latin_1() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("u.csv");
    let file = path.to_string_lossy().into_owned();
    log(&path, b"a [m/s\xb2],w [\xb0/s],c [\xb5g]", None, 1.0, [0.0; 3])?;
    let seen = run(&["inspect", &file, "--rate-hz", "100"])?.document;
    for (place, quantity) in ["accelerometer", "gyro", "accelerometer"].into_iter().enumerate() {
        check(seen["columns"][place]["quantity"] == quantity, seen["columns"][place].to_string())?;
    }
    let named = run(&["allan", &file, "--rate-hz", "100", "--accelerometer", "a", "--gyro", "w"])?;
    check(named.code == Some(0) && !text(&named).contains("not stated"), text(&named))
}

fn contradiction() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("u.csv");
    let file = path.to_string_lossy().into_owned();
    log(&path, b"gx_deg_s,gy_deg_s,az_g", None, 1.0, [0.0; 3])?;
    let allan = |more: &[&str]| run(&[&["allan", &file, "--rate-hz", "100"], more].concat());
    for (more, both) in [
        (["--gyro", "gx_deg_s", "--gyro-scale", "rad/s"], ["°/s", "rad/s"]),
        (["--gyro", "gx_deg_s", "--gyro-scale", "0.05deg/s"], ["°/s", "0.05deg/s"]),
        (["--accelerometer", "az_g", "--accelerometer-scale", "m/s2"], [" g ", "m/s2"]),
    ] {
        let said = allan(&more)?;
        check(
            said.code == Some(2) && both.iter().all(|side| said.error.contains(side)),
            format!("{more:?}: {}", said.error),
        )?;
    }
    let swapped = allan(&["--accelerometer", "gx_deg_s"])?;
    check(swapped.code == Some(2) && swapped.error.contains("angular rate"), swapped.error)?;
    // Control: what agrees, by name or to within gravity's differences over the Earth.
    for more in [
        ["--gyro", "gx_deg_s", "--gyro-scale", "deg/s"],
        ["--gyro", "gx_deg_s", "--gyro-scale", "0.0174533rad/s"],
        ["--accelerometer", "az_g", "--accelerometer-scale", "9.81m/s2"],
    ] {
        check(allan(&more)?.code == Some(0), format!("{more:?}"))?;
    }
    Ok(())
}

fn sizes() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("u.csv");
    let file = path.to_string_lossy().into_owned();
    let said = |headings: &str, size: f64, means: [f64; 3]| -> Result<(f64, String), Failed> {
        log(&path, headings.as_bytes(), None, size, means)?;
        let said = run(&["allan", &file, "--rate-hz", "100"])?;
        Ok((walk(&said.document), text(&said)))
    };
    // White noise of σ at 100 Hz: N = σ/√100.
    let (n, words) = said("ax,ay,az", 1e-3, [0.6, 0.0, 0.8])?;
    check(words.contains("taken as g, because"), &words)?;
    near("N of a log in g", n, 1e-3 * 9.80665 / 10.0, 1e-4)?;
    let (n, words) = said("ax,ay,az", 1e-2, [5.9, 0.0, 7.8])?;
    check(words.contains("taken as m/s2, because"), &words)?;
    near("N of a log in m/s²", n, 1e-3, 1e-4)?;
    let (_, words) = said("ax,ay,az", 1e-2, [0.1, 0.0, 0.2])?;
    check(words.contains("gravity's in no unit"), &words)?;
    let (n, words) = said("ax,ay,az", 4.0, [9600.0, 0.0, 12800.0])?;
    check(words.contains("counts: gravity's length is 16000 of them"), &words)?;
    near("N of a log in counts", n, 4.0 * 9.80665 / 16000.0 / 10.0, 2e-5)?;
    // 0.2 °/√h: 0.0333 °/s at 100 Hz; as rad/s it is noisier than any gyro.
    let (_, words) = said("gx,gy,gz", 0.0333, [0.0; 3])?;
    check(words.contains("are they in deg/s?"), &words)?;
    // Control: the same in radians.
    let (_, words) = said("gx,gy,gz", 0.0333 * DEGREE, [0.0; 3])?;
    check(words.contains("taken as rad/s;") && !words.contains("deg/s?"), words)
}

fn other_commands() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("u.csv");
    let file = path.to_string_lossy().into_owned();
    log(&path, b"ax_g,ay_g,az_g", None, 1e-3, [0.0, 0.0, 1.0])?;
    let model = folder.path().join("model.toml");
    let diagnose = |kind: &str| {
        std::fs::write(&model, kind)?;
        run(&["diagnose", &file, "--model", &model.to_string_lossy()])
    };
    let still = |unit: &str| {
        diagnose(&format!(
            "kind = \"static\"\nrate_hz = 100.0\n{unit}\n[columns]\nchannels = [\"ax_g\", \"ay_g\", \"az_g\"]\n"
        ))
    };
    let own = still("")?;
    check(own.code == Some(0) && own.document["fit"]["unit"] == "g", format!("{} {}", own.document["fit"], own.error))?;
    let wrong = still("unit = \"m/s2\"")?;
    check(wrong.code == Some(2) && wrong.error.contains("m/s2") && wrong.error.contains(" g "), wrong.error)?;
    check(still("unit = \"g\"")?.code == Some(0), "the same unit twice")?;
    let tumble = "kind = \"tumble\"\nrate_hz = 100.0\ngravity_m_s2 = 9.81\n[columns]\naccelerometer = [\"ax_g\", \"ay_g\", \"az_g\"]\n";
    let swapped = tumble.replace("accelerometer = ", "accelerometer = [\"p\", \"q\", \"r\"]\ngyro = ");
    let three = std::fs::read_to_string(&path)?;
    let with_rates = |(k, line): (usize, &str)| match k {
        0 => format!("{line},p,q,r\n"),
        _ => format!("{line},{line}\n"),
    };
    std::fs::write(&path, three.lines().enumerate().map(with_rates).collect::<String>())?;
    let said = diagnose(&swapped)?;
    check(said.code == Some(2) && said.error.contains("specific force"), said.error)?;
    // A study's log: the unit of its heading, with both where a scale contradicts it.
    let study = folder.path().join("study.toml");
    let compare = |scale: &str| {
        let axis = format!("[[compare.axis]]\ncolumn = \"az_g\"\n{scale}");
        let text = format!(
            "name = \"c\"\nmembers = 64\nduration_s = 1.0\n[sensor]\nsample_rate_hz = 100.0\n[accelerometer]\n\
             velocity_random_walk_m_s_rth = 0.06\n[compare]\nfile = \"u.csv\"\nrate_hz = 100.0\n{axis}\n"
        );
        std::fs::write(&study, text)?;
        Ok::<_, Failed>(
            program().current_dir(folder.path()).arg("study").arg(&study).args(["--backend", "cpu"]).output()?,
        )
    };
    let about = |output: &std::process::Output| -> Vec<String> {
        String::from_utf8_lossy(&output.stdout).lines().filter(|l| l.contains("az_g")).map(str::to_owned).collect()
    };
    let [own, given] = [compare("")?, compare("scale_mg = 1000.0")?];
    let words = String::from_utf8_lossy(&own.stderr).into_owned();
    check(own.status.success() && about(&own) == about(&given) && !about(&own).is_empty(), words)?;
    let wrong = compare("scale_mg = 3.33")?;
    let words = String::from_utf8_lossy(&wrong.stderr).into_owned();
    check(wrong.status.code() == Some(2) && words.contains("3.33") && words.contains(" g "), words)
}

fn driven_units() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("d.csv");
    let model = folder.path().join("model.toml");
    // x″ + 2·0.05·ω₀x′ + ω₀²x = u, ω₀ = 2π·5 rad/s, by the midpoint rule at 4 kHz, read at 200 Hz.
    let (omega, zeta) = (std::f64::consts::TAU * 5.0, 0.05);
    let mut rng = Philox::new(32, 0, Stream::Host);
    let (mut x, mut v) = (0.0f64, 0.0f64);
    let mut rows = String::new();
    for k in 0..6000 {
        let u = 20.0 * rng.sample::<f64, _>(StandardNormal);
        rows += &format!("{},{},{}\n", k as f64 * 0.005, u, x + 1e-6 * rng.sample::<f64, _>(StandardNormal));
        for _ in 0..20 {
            let h = 0.005 / 20.0;
            let pull = |x: f64, v: f64| u - 2.0 * zeta * omega * v - omega * omega * x;
            let (xm, vm) = (x + 0.5 * h * v, v + 0.5 * h * pull(x, v));
            (x, v) = (x + h * vm, v + h * pull(xm, vm));
        }
    }
    for (input, output, gain, relation) in
        [("force_m_s2", "x_m", "1", None), ("force_g", "x_um", "um/(g s^2)", Some("9.80665 m/s²"))]
    {
        std::fs::write(&path, format!("t_s,{input},{output}\n{rows}"))?;
        std::fs::write(
            &model,
            format!("kind = \"driven\"\n[columns]\ntime = \"t_s\"\ninput = \"{input}\"\noutput = \"{output}\"\n"),
        )?;
        let out = folder.path().join(input);
        let said = run(&[
            "diagnose",
            &path.to_string_lossy(),
            "--model",
            &model.to_string_lossy(),
            "--out",
            &out.to_string_lossy(),
        ])?;
        let base = said.document["base"].as_array().into_iter().flatten();
        let unit = base.clone().find(|e| e["name"] == "gain").map(|e| e["unit"].clone());
        check(unit == Some(Value::from(gain)), format!("{input}: {unit:?} {}", said.error))?;
        let page = std::fs::read_to_string(out.join("report.html"))?;
        check(!page.contains("s2 s²") && !said.document.to_string().contains("s2 s^2"), "a broken unit")?;
        if let (Some(relation), Ok(study)) = (relation, std::fs::read_to_string(out.join("repaired.toml"))) {
            check(study.contains(relation), study)?;
        }
    }
    Ok(())
}
