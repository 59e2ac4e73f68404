//! Mistakes of a newcomer: each is refused with exit code 2 and a sentence that says what was
//! tried, what was wrong (where) and what to do, at every command and at every level of every file.

use std::path::Path;
use std::process::Output;

use libtest_mimic::{Failed, Trial};

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("mistakes: a command line is answered with attempt, cause and hint", command_lines),
        test("mistakes: every wrong key of a model.toml has its line and column", models),
        test("mistakes: a study that no sensor can follow is refused, not answered", studies),
        test("mistakes: each slip of a first hour has the sentence that helps", first_hour),
        test("mistakes: a full disk under stdout, a pipe as recording and a file as folder", places),
        test("mistakes: a map beyond arithmetic is refused", maps),
        test("mistakes: a log with an open quotation mark, without headings or with impossible numbers", logs),
    ]
}

/// Refused as the contract says, with these words somewhere.
fn refused(what: &str, output: &Output, words: &[&str]) -> Result<(), Failed> {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(2), format!("{what}: {:?}, {said}", output.status))?;
    check(output.stdout.is_empty(), format!("{what}: something on stdout"))?;
    check(said.starts_with("error: could not ") && !said.contains("panicked"), format!("{what}: {said}"))?;
    for part in ["\n  cause: ", "\n  hint:  "].iter().chain(words) {
        check(said.contains(part), format!("{what}: no {part:?} in {said}"))?;
    }
    Ok(())
}

fn command_lines() -> Result<(), Failed> {
    let cases: [(&[&str], &str); 7] = [
        (&["diagnoze"], "'diagnose'"),
        (&["diagnose", "absent.csv"], "absent.csv"),
        (&["study", "--members", "-1"], "-1"),
        (&["study", "--backend", "tpu"], "auto, gpu, cpu"),
        (&["allan", "log.csv", "--rate-hz", "fast"], "fast"),
        (&["study", "absent.toml"], "absent.toml"),
        (&["trial", "--resume"], "--out"),
    ];
    cases
        .into_iter()
        .try_for_each(|(arguments, word)| refused(&arguments.join(" "), &program().args(arguments).output()?, &[word]))
}

fn run_on(folder: &Path, file: &str, text: &str, arguments: &[&str]) -> Result<Output, Failed> {
    std::fs::write(folder.join(file), text)?;
    Ok(program().current_dir(folder).args(arguments).output()?)
}

fn first_hour() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let study = |value: &str| format!("name = \"s\"\nmembers = 64\nduration_s = 1.0\n[gyro]\nbias_deg_h = {value}\n");
    let model = "kind = \"static\"\nrate_hz = 100.0\n[columns]\nchannels = [\"x\"]\n";
    let log = "t_s,x\n0.02,1.0\n0.00,1.5\n0.03,1.2\n0.01,1.1\n0.05,1.3\n0.04,1.0\n";
    let require = ["require", "f", "--limit", "p90(position_error_m, 1) < 1", "--vary", "gyro.bias_deg_h"];
    let cases: [(&str, String, &[&str], &str); 12] = [
        ("a model as a study", model.into(), &["study", "f"], "diagnose LOG --model f"),
        ("a study as a model", study("1.0"), &["diagnose", "log.csv", "--model", "f"], "proofmass study f"),
        ("a log to export", log.into(), &["export", "f", "--to", "px4"], "proofmass allan f --to"),
        ("a log as a study", log.into(), &["study", "f"], "this is a recording"),
        ("a decimal comma", study("3,5"), &["study", "f"], "3.5"),
        ("one inside a draw", study("{ mean = 0.0, sd = 3,5 }"), &["study", "f"], "3.5"),
        ("a typographic minus", study("−3.0"), &["study", "f"], "hyphen"),
        ("a negative spread", study("{ mean = 0.0, sd = -3.0 }"), &["study", "f"], "a spread has no sign"),
        (
            "a key without its unit",
            study("1.0"),
            &["study", "f", "--set", "gyro.bias.sd=3"],
            "did you mean `bias_deg_h`?",
        ),
        ("a percentile that is none", study("1.0"), &require, "did you mean `p95`?"),
        ("ROS as a target", study("1.0"), &["export", "f", "--to", "ros"], "of sensor_msgs/Imu give ros-covariance"),
        ("a clock out of order", log.into(), &["allan", "f"], "time runs backwards in data row 1"),
    ];
    for (what, text, arguments, word) in cases {
        refused(what, &run_on(folder.path(), "f", &text, arguments)?, &[word])?;
    }
    // The old name of a template, and what the other is called now.
    let printed = |kind: &str| program().args(["template", kind]).output();
    check(printed("flight")?.stdout == printed("trajectory")?.stdout, "`flight` is `trajectory`")?;
    let text = String::from_utf8_lossy(&printed("trajectory-study")?.stdout).into_owned();
    check(text.contains("[trajectory]") && text.contains("duration_s"), text)
}

fn models() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("log.csv"), "a,b\n1,2\n2,3\n")?;
    let driven = "# a comment\nkind = \"driven\" # another\nrate_hz = 10.0\n[columns]\ninput = \"a\"\noutput = \"b\"\n";
    let cases = [
        (driven.replace("rate_hz", "rate"), "model.toml:3:1: ", "did you mean `rate_hz`?"),
        (driven.replace("output", "outptu"), "model.toml:6:1: ", "did you mean `output`?"),
        (driven.replace("10.0", "\"10\""), "model.toml:3:11: ", "expected a number"),
        (driven.replace("\"driven\"", "\"drivn\""), "model.toml:2:8: ", "did you mean `driven`?"),
        (driven.to_owned() + "[split]\ntrain = [[0, -4]]\n", "model.toml:8:14: ", "whole number"),
        (driven.to_owned() + "[start]\nresonance = 4\n", "model.toml:8:1: ", "did you mean `resonance_hz`?"),
        ("kind = \"static\"\n[columns]\nchannel = [\"a\"]\n".into(), "model.toml:3:1: ", "did you mean `channels`?"),
        (
            "rate_hz = 1.0\nkind = \"static\"\n[columns]\nchannels = [\"a\"]\n[noise]\ndensty = 1.0\n".into(),
            "model.toml:6:1: ",
            "did you mean `density`?",
        ),
        ("kind = \"tumble\"\ngravity = 9.8\n".into(), "model.toml:2:1: ", "did you mean `gravity_m_s2`?"),
        (
            "kind = \"trajectory\"\n[reference]\nfile = \"r.csv\"\nuse = \"poses\"\n".into(),
            "model.toml:4:7: ",
            "expected `attitude`",
        ),
    ];
    for (text, place, word) in cases {
        let output = run_on(folder.path(), "model.toml", &text, &["diagnose", "log.csv", "--model", "model.toml"])?;
        refused(&text, &output, &[place, word])?;
    }
    Ok(())
}

fn studies() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let study = |more: &str| format!("members = 64\nduration_s = 1.0\nstep_s = 0.01\n{more}\n");
    let sine = |amplitude: &str, hz: &str| {
        study(&format!(
            "[accelerometer]\nscale_factor_ppm = 1.0\n[excitation]\nkind = \"sine\"\namplitude_m_s2 = {amplitude}\nfrequency_hz = {hz}"
        ))
    };
    let cases = [
        // All members lost in a float's range is no "exact" sensor.
        (sine("1e300", "3.0"), "64 of 64 members"),
        // Sampled at its own multiple a sine is nothing at all.
        (sine("1.0", "500.0"), "cannot be represented"),
        (study("[gyro]\nbias_deg_h = 1e300"), "implausible for any sensor"),
        (study("[sensor]\nresonance_hz = 1e-300"), "too small"),
        (study("[sensor]\nsample_rate_hz = 1e-300"), "1.0e302 times"),
        ("duration_s = 1e300\nstep_s = 0.01\n".into(), "1e300 s"),
        (study("[accelerometer]\nbias_mg = \"much\""), "study.toml:5:11: "),
        (
            study(
                "[accelerometer]\nbias_temperature_ug_k = 1.0\n[temperature]\nprofile_s_deg_c = [[-10.0, 15.0], [10.0, 40.0]]",
            ),
            "times not below 0",
        ),
        (
            study(
                "[compare]\nfile = \"log.csv\"\n[[compare.axis]]\ncolumn = \"ax\"\n[compare.axis.accelerometer]\n\
                 bias_temperature_ug_k = 1.0",
            ),
            "needs a [temperature]",
        ),
    ];
    for (text, word) in cases {
        let output = run_on(folder.path(), "study.toml", &text, &["study", "study.toml", "--out", "out"])?;
        refused(&text, &output, &[word])?;
        check(output.stderr.len() < 600, format!("{text}: a number of hundreds of digits"))?;
    }
    // A spectrum that reaches beyond the steps is survived and said.
    let random = study(
        "[accelerometer]\nbias_mg = 1.0\n[excitation]\nkind = \"random\"\npsd_g2_hz = [[20.0, 0.01], [2000.0, 0.01]]",
    );
    let output = run_on(folder.path(), "study.toml", &random, &["study", "study.toml", "--out", "out"])?;
    let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
    check(output.status.success() && page.contains("is aliased"), "an excitation beyond half the rate of the steps")
}

fn maps() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let map = |amplitude: &str, from: &str| {
        format!(
            "[oscillator]\ndamping_kg_s = 0.1\nstiffness_n_m = 1.0\ncubic_n_m3 = 0.3\n[drive]\namplitude_n = {amplitude}\n\
             omega_rad_s = 1.5\n[[bifurcation]]\ntitle = \"x\"\nfrom_n = {from}\nto_n = 10.0\npoints = 2\n"
        )
    };
    for (text, word) in [(map("1e300", "0.1"), "1e300"), (map("1.0", "20.0"), "less than `to_n`")] {
        refused(&text, &run_on(folder.path(), "map.toml", &text, &["map", "map.toml"])?, &[word])?;
    }
    Ok(())
}

fn logs() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let rows = |cell: &str| format!("ax,ay\n{}1,{cell}\n{}", "1,2\n2,1\n".repeat(50), "3,1\n".repeat(50));
    let cases = [
        (rows("\"2"), "quotation mark in line 102"),
        (format!("\"{}", rows("2")), "quotation mark in line 1 "),
        (rows("1e300"), "line 102, column 2: `1e300` is larger than any reading"),
        (rows("2,5"), "line 102 has 3 cells"),
        (rows("2").replacen("ax,ay\n", "", 1), "called 1 to 2"),
        (rows("2").replace(',', "_"), "commas, semicolons or tabs"),
        (rows("2").replacen('\n', "\nx,y\n", 1), "one line of units"),
    ];
    for (text, word) in cases {
        let output =
            run_on(folder.path(), "log.csv", &text, &["allan", "log.csv", "--rate-hz", "100", "--columns", "ax,ay"])?;
        refused(word, &output, &[word])?;
        check(output.stderr.len() < 600, format!("{word}: the file is in the message"))?;
    }
    let output = run_on(folder.path(), "log.csv", &rows("2"), &["allan", "log.csv", "--rate-hz", "1e300"])?;
    refused("a rate of 1e300 Hz", &output, &["1e300 Hz"])
}

/// Linux only where a device stands for a full disk.
fn places() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    if cfg!(target_os = "linux") {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full")?;
        let output = program().arg("candidates").stdout(full).output()?;
        refused("a full disk", &output, &["could not print the result"])?;
        let output = program().args(["allan", "/dev/zero", "--rate-hz", "1"]).output()?;
        refused("a device", &output, &["a pipe or a device"])?;
        // A pipe that nobody writes to is refused too, not waited for.
        let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status()?;
        check(made.success(), "mkfifo failed")?;
        let output = program().current_dir(folder.path()).args(["allan", "pipe", "--rate-hz", "1"]).output()?;
        refused("a pipe without a writer", &output, &["a pipe or a device"])?;
    }
    std::fs::write(folder.path().join("taken"), "")?;
    for command in ["study", "bench", "paper"] {
        let output = program().current_dir(folder.path()).args([command, "--out", "taken"]).output()?;
        refused(command, &output, &["there is a file where a folder should be"])?;
    }
    Ok(())
}
