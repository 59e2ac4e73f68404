//! A recorded log cut into windows beside its prediction: planted noise lies inside as often as it
//! should, a wrong coefficient is seen, knocks and jumps are said, logs that cannot be cut are
//! refused; and a real sensor.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

use libtest_mimic::{Failed, Trial};
use proofmass::numerics::special::exact_interval;
use proofmass::rng::{Philox, Stream};
use serde_json::Value;

use super::world::{check, data_test, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("windows: planted noise lies inside its predicted bands, and half of its noise is seen", planted),
        test("windows: a knock and a jump are said, shown with and without", disturbed),
        test("windows: a log that is not there is said, and a still start needs no windows", absent),
        data_test("windows: a real ADIS16405 drifts as its Allan coefficients predict", adis),
    ];
    all.extend(REFUSED.iter().map(|case| test(&format!("windows: refused: {}", case.0), move || refused(case))));
    all
}

const RATE_HZ: f64 = 50.0;
const ROWS: usize = 60_000;
/// White noise of the planted accelerometer, m/s/√h, and of the gyro, °/√h.
const PLANTED: [f64; 2] = [0.3, 1.2];

/// Twenty minutes of `t_s,a_mg,g_deg_s`: white noise on the turn-on bias that a still start
/// removes.
fn log(change: impl Fn(usize, f64) -> f64) -> String {
    let mut rng = Philox::new(12, 0, Stream::Host);
    // σ = N√f: N in mg√s, and in °/√s.
    let root = RATE_HZ.sqrt();
    let (mg, deg_s) = (PLANTED[0] / 60.0 / 9.80665e-3 * root, PLANTED[1] / 60.0 * root);
    let mut text = String::from("t_s,a_mg,g_deg_s\n");
    for n in 0..ROWS {
        let (a, g) = (rng.normal(), rng.normal());
        let _ = writeln!(text, "{:.3},{:.6},{:.7}", n as f64 / RATE_HZ, change(n, 37.0 + mg * a), 0.4 + deg_s * g);
    }
    text
}

/// A study of the log beside it; `white` are the coefficients it is predicted with.
fn study(white: [f64; 2], still_s: f64, compare: &str) -> String {
    format!(
        "name = \"windows\"\nmembers = 4096\nduration_s = 10.0\n[alignment]\nkind = \"still\"\nstill_s = {still_s:?}\n\
         [accelerometer]\nbias_mg = {{ mean = 0.0, sd = 30.0 }}\n\
         [compare]\nfile = \"log.csv\"\n{compare}\n\
         [[compare.axis]]\ncolumn = \"a_mg\"\nscale_mg = 1.0\naccelerometer = {{ velocity_random_walk_m_s_rth = {} }}\n\
         [[compare.axis]]\ncolumn = \"g_deg_s\"\nscale_deg_s = 1.0\ngyro = {{ angle_random_walk_deg_rth = {} }}\n",
        white[0], white[1]
    )
}

fn run(log: Option<&str>, study: &str) -> Result<(Output, String), Failed> {
    let folder = tempfile::tempdir()?;
    if let Some(log) = log {
        std::fs::write(folder.path().join("log.csv"), log)?;
    }
    let path = folder.path().join("study.toml");
    std::fs::write(&path, study)?;
    let out = folder.path().join("out");
    let output = program().args(["--json", "study"]).arg(path).arg("--out").arg(&out).output()?;
    let page = std::fs::read_to_string(out.join("report.html")).unwrap_or_default();
    Ok((output, page))
}

fn document(log: Option<&str>, study: &str) -> Result<(Value, String), Failed> {
    let (output, page) = run(log, study)?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    Ok((serde_json::from_slice(&output.stdout)?, page))
}

fn number(row: &Value, key: &str) -> Result<f64, Failed> {
    row[key].as_f64().ok_or_else(|| format!("no number `{key}` in {row}").into())
}

fn rows<'a>(document: &'a Value, key: &str) -> Result<&'a Vec<Value>, Failed> {
    document[key].as_array().ok_or_else(|| format!("no `{key}`").into())
}

/// Fails where a share of windows is one that chance gives once in ten thousand, or less, at this
/// probability.
fn plausible(row: &Value) -> Result<(), Failed> {
    let count = number(row, "windows")?;
    for (key, share) in [("inside50", 0.5), ("inside90", 0.9), ("inside99", 0.99)] {
        let hits = (number(row, key)? * count).round() as u64;
        let [low, high] = exact_interval(hits, count as u64, 0.9999);
        check((low..=high).contains(&share), format!("{key} of {row}: {low} to {high} does not hold {share}"))?;
    }
    Ok(())
}

const BOTH: &str = "rate_hz = 50.0\nwindows_s = [5.0, 20.0]";

fn planted() -> Result<(), Failed> {
    let log = log(|_, a| a);
    let (told, page) = document(Some(&log), &study(PLANTED, 5.0, BOTH))?;
    let windows = rows(&told, "windows")?;
    // 59,999 periods: 119 of 500 samples, 47 of 1250.
    let expected: [(&str, f64, u32); 4] =
        [("a_mg", 5.0, 119), ("a_mg", 20.0, 47), ("g_deg_s", 5.0, 119), ("g_deg_s", 20.0, 47)];
    check(windows.len() == expected.len(), format!("{windows:?}"))?;
    for (row, (axis, seconds, count)) in windows.iter().zip(expected) {
        check(row["axis"] == axis && row["seconds"] == seconds && row["windows"] == count, row.to_string())?;
        plausible(row)?;
        // The closed form after a still start, and 4096 members: 1.1 % of sd.
        let n = PLANTED[usize::from(axis == "g_deg_s")] / 60.0;
        let sd = match axis {
            "a_mg" => n * (seconds.powi(3) / 3.0 + seconds.powi(4) / 20.0).sqrt(),
            _ => (n * (seconds + seconds * seconds / 5.0).sqrt()).to_radians(),
        };
        near("sd_predicted over the closed form", number(row, "sd_predicted")? / sd, 1.0, 0.055)?;
        near(
            "sd_recorded over sd_predicted",
            number(row, "sd_recorded")? / sd,
            1.0,
            4.5 / (2.0 * f64::from(count)).sqrt(),
        )?;
        check(row.as_object().is_some_and(|o| o.len() == 8), format!("a field too many or too few: {row}"))?;
    }
    check(told.get("windows_undisturbed").is_none(), "noise alone counts as disturbed")?;
    check(page.contains("Predicted and recorded drift") && page.contains("log.csv"), "no section in the page")?;
    // Control: with half the noise the same windows do not lie inside.
    let (told, _) = document(Some(&log), &study(PLANTED.map(|n| 0.5 * n), 5.0, BOTH))?;
    for row in rows(&told, "windows")? {
        check(plausible(row).is_err(), format!("half the noise passed: {row}"))?;
    }
    Ok(())
}

fn disturbed() -> Result<(), Failed> {
    // A knock of 3 g for 40 ms in the window from 100 s on, a jump of 60 mg in that from 607 s on
    // (windows of 10 s).
    let log = log(|n, a| match n {
        5200..5202 => a + 3000.0,
        30_600.. => a + 60.0,
        _ => a,
    });
    let (told, page) = document(Some(&log), &study(PLANTED, 5.0, "rate_hz = 50.0\nwindows_s = [5.0]"))?;
    let (all, calm) = (&rows(&told, "windows")?[0], &rows(&told, "windows_undisturbed")?[0]);
    check(all["windows"] == 119 && all["axis"] == "a_mg", all.to_string())?;
    let kept = number(calm, "windows")?;
    check((116.0..=117.0).contains(&kept), format!("{kept} of 119 windows are called undisturbed"))?;
    plausible(calm)?;
    check(number(all, "sd_recorded")? > 3.0 * number(calm, "sd_recorded")?, "the disturbed windows do not show")?;
    let said =
        rows(&told, "findings")?.iter().any(|f| f.as_str().is_some_and(|f| f.contains("knock") && f.contains("jump")));
    check(said, format!("{}", told["findings"]))?;
    check(page.contains("without the windows that contain a knock"), "the page does not show both")
}

fn absent() -> Result<(), Failed> {
    let (told, page) = document(None, &study(PLANTED, 5.0, BOTH))?;
    check(rows(&told, "windows")?.is_empty(), "windows of a log that is not there")?;
    check(
        told["findings"][0].as_str().is_some_and(|f| f.contains("not on this machine")),
        told["findings"].to_string(),
    )?;
    check(page.contains("not on this machine"), "the page does not say so")?;
    let short = log(|_, a| a);
    let (told, _) = document(Some(&short), &study(PLANTED, 5.0, "time = \"t_s\""))?;
    check(told.get("windows").is_none(), "windows that nobody asked for")
}

/// Coefficients of the accelerometers as `allan` finds them in the log (N in m/s/√h, B in µg, K in
/// µg/√s), and those of the gyros (°/√h, °/h, °/h/√h; none where the log does not support it).
const ADIS: [(&str, [f64; 3]); 6] = [
    ("ax_lsb", [0.227, 379.0, 52.0]),
    ("ay_lsb", [0.214, 236.0, 55.0]),
    ("az_lsb", [0.272, 268.0, 36.0]),
    ("gx_lsb", [2.43, 23.2, 156.0]),
    ("gy_lsb", [2.53, 37.3, 0.0]),
    ("gz_lsb", [2.30, 23.3, 232.0]),
];

/// What a plain program outside this project got from the same log: windows of 10 and 60 s after 10
/// s still, sd of position recorded and predicted, m, and the share inside the 90 % band.
const PLAIN: [[(f64, f64, f64); 3]; 2] = [
    [(0.22, 0.21, 0.91), (0.17, 0.15, 0.91), (0.17, 0.17, 0.93)],
    [(7.3, 7.7, 0.96), (5.5, 6.1, 0.95), (5.9, 5.9, 0.93)],
];

/// The study of the six axes with these coefficients times a factor.
fn adis_study(data: &Path, factor: f64) -> Result<String, Failed> {
    let axis = |(column, coefficients): &(&str, [f64; 3])| {
        let [n, b, k] = coefficients.map(|c| factor * c);
        if column.starts_with('a') {
            format!(
                "[[compare.axis]]\ncolumn = \"{column}\"\nscale_mg = 3.33\naccelerometer = {{ velocity_random_walk_m_s_rth = \
                 {n}, bias_instability_ug = {b}, acceleration_random_walk_ug_rts = {k} }}\n"
            )
        } else {
            format!(
                "[[compare.axis]]\ncolumn = \"{column}\"\nscale_deg_s = 0.05\ngyro = {{ angle_random_walk_deg_rth = {n}, \
                 bias_instability_deg_h = {b}, rate_random_walk_deg_h_rth = {k} }}\n"
            )
        }
    };
    Ok(format!(
        "duration_s = 1.0\n[sensor]\nsample_rate_hz = 100.0\n[alignment]\nkind = \"still\"\nstill_s = 10.0\n\
         [compare]\nfile = {:?}\nrate_hz = 100.0\nwindows_s = [10.0, 60.0]\n{}",
        std::path::absolute(data.join("adis16405/run1_counts.csv"))?,
        ADIS.iter().map(axis).collect::<String>()
    ))
}

fn adis(data: &Path) -> Result<(), Failed> {
    let (told, _) = document(None, &adis_study(data, 1.0)?)?;
    let windows = rows(&told, "windows")?;
    check(windows.len() == 12, format!("{} rows", windows.len()))?;
    for (place, row) in windows.iter().enumerate() {
        let (axis, length) = (place / 2, place % 2);
        check(row["axis"] == ADIS[axis].0 && row["windows"] == [374, 107][length], row.to_string())?;
        let (recorded, predicted) = (number(row, "sd_recorded")?, number(row, "sd_predicted")?);
        if let Some((r, p, inside)) = PLAIN[length].get(axis) {
            // As printed: half a unit of the last digit, and 2 % for the spread of the members and
            // of the plain program's own.
            near("sd_recorded", recorded, *r, 0.05 * r)?;
            near("sd_predicted", predicted, *p, 0.06 * p)?;
            near("inside90", number(row, "inside90")?, *inside, 0.015)?;
        } else {
            // Gyros: four in five to nineteen in twenty of the windows or more; tilts of the
            // predicted size.
            near("sd_recorded over sd_predicted of a tilt", recorded / predicted, 1.0, 0.25)?;
            check(number(row, "inside90")? > 0.8, row.to_string())?;
        }
    }
    // Control: a sensor of half the noise has not drifted so, on any axis or length.
    let (told, _) = document(None, &adis_study(data, 0.5)?)?;
    for row in rows(&told, "windows")? {
        check(plausible(row).is_err(), format!("half the noise predicts the same log: {row}"))?;
    }
    Ok(())
}

/// What is wrong, still start, keys of [compare], a word of the cause, a word of the hint.
type Wrong = (&'static str, f64, &'static str, &'static str, &'static str);

const REFUSED: &[Wrong] = &[
    (
        "a log shorter than one window",
        5.0,
        "rate_hz = 50.0\nwindows_s = [5.0, 2000.0]",
        "shorter than one window of 2000 s",
        "at most 594",
    ),
    ("a log of one window", 5.0, "rate_hz = 50.0\nwindows_s = [700.0]", "only one window long", "at most 594"),
    (
        "a still start longer than the log",
        1300.0,
        "rate_hz = 50.0\nwindows_s = [5.0]",
        "longer than the log, which lasts 1199.98 s",
        "still_s",
    ),
    ("a window below a sample", 5.0, "rate_hz = 50.0\nwindows_s = [0.001]", "less than one sample", "0.02"),
    ("a rate that the stamps disagree with", 5.0, "rate_hz = 100.0\ntime = \"t_s\"\nwindows_s = [5.0]", "Hz", ""),
];

fn refused((_, still_s, compare, cause, hint): &Wrong) -> Result<(), Failed> {
    let (output, page) = run(Some(&log(|_, a| a)), &study(PLANTED, *still_s, compare))?;
    let said = String::from_utf8_lossy(&output.stderr);
    check(output.status.code() == Some(2), format!("exit {:?}: {said}", output.status.code()))?;
    check(said.contains(cause) && said.contains(hint), format!("not '{cause}', '{hint}': {said}"))?;
    check(page.is_empty(), "a report was written")
}
