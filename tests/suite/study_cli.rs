//! `proofmass study` on the command line: refusals leave nothing behind, Ctrl-C leaves what
//! `--resume` continues from, and the JSON is the contract's.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("study command: --json is the contract's document", document),
        test("study command: same seed, same answer; another seed, another", seeds),
        test("study command: --set changes a key, also in a draw, as the file would", set),
        test("study command: --preset gives a grade's sensor, under what the study says itself", preset),
        test("study command: a temperature that no coefficient follows is said, and one that is followed is not", idle),
        test("study command: a folder that cannot be written is refused before the work", unwritable),
        test("study command: --resume without an interrupted run is refused", nothing_to_resume),
    ];
    all.extend(
        LOGS.iter().map(|case| test(&format!("study command: replay of {} is refused", case.0), move || replay(case))),
    );
    #[cfg(unix)]
    all.push(test("study command: Ctrl-C stops at once and --resume gives the same answer", interrupt));
    all
}

const SMALL: &str = "name = \"small\"\nmembers = 512\nduration_s = 2.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n\
                     bias_mg = { mean = 0.0, sd = 1.0 }\n[report]\ntimes_s = [1.0, 2.0]\n";

fn study(folder: &Path, text: &str) -> Result<Command, Failed> {
    let path = folder.join("study.toml");
    std::fs::write(&path, text)?;
    let mut command = program();
    command.args(["--json", "study"]).arg(path).arg("--out").arg(folder.join("out"));
    Ok(command)
}

fn json(command: &mut Command) -> Result<Value, Failed> {
    let output = command.output()?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Everything but how long it took.
fn timeless(mut document: Value) -> Value {
    if let Some(fields) = document.as_object_mut() {
        fields.remove("seconds");
    }
    document
}

fn document() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let document = json(&mut study(folder.path(), SMALL)?)?;
    check(document["schema"] == "proofmass.study/1", "schema")?;
    check(document["members"] == 512 && document["failed"] == 0, "members")?;
    for quantity in ["position_error_m", "velocity_error_m_s", "acceleration_error_m_s2", "tilt_error_rad"] {
        for row in ["mean", "sd", "p01", "p05", "p50", "p95", "p99"] {
            check(document[quantity][row].as_array().is_some_and(|v| v.len() == 2), format!("{quantity}.{row}"))?;
        }
    }
    let sd = |at: &Value| at["sd"][1].as_f64().unwrap_or(f64::NAN);
    let (got, closed) = (sd(&document["position_error_m"]), sd(&document["closed_form"]["position_error_m"]));
    near("sd over closed form", got / closed, 1.0, 0.16)?;
    for key in ["backend", "time_s", "member_steps", "seconds"] {
        check(!document[key].is_null(), key)?;
    }
    let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
    check(page.contains("<svg"), "no figure in report.html")?;
    check(!page.contains("src=\"http") && !page.contains("<script src"), "the report loads something from outside")
}

/// A key that is set gives the numbers of a file that holds it; one that is not there names the
/// nearest.
fn set() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let wider = SMALL.replace("sd = 1.0 }", "sd = 3.0 }");
    check(wider != SMALL, "the study has no such draw")?;
    let written = timeless(json(&mut study(folder.path(), &wider)?)?);
    let set = |arguments: &[&str]| -> Result<Command, Failed> {
        let mut command = study(folder.path(), SMALL)?;
        command.args(arguments);
        Ok(command)
    };
    let by_path = timeless(json(&mut set(&["--set", "accelerometer.bias_mg.sd=3.0"])?)?);
    check(by_path == written, "the path into a draw")?;
    let whole = timeless(json(&mut set(&["--set", "accelerometer.bias_mg={ mean = 0.0, sd = 3.0 }"])?)?);
    check(whole == written, "the whole draw")?;
    let unchanged = timeless(json(&mut set(&[])?)?);
    check(unchanged != written, "the setting makes no difference (control)")?;
    for (wrong, word) in [
        ("accelerometer.bias_mgg=1", "did you mean `bias_mg`?"),
        ("accelerometer.bias_mg", "need KEY=VALUE"),
        ("name=mine", "need quotes"),
        ("name.of=1", "not a section"),
    ] {
        let output = set(&["--set", wrong])?.output()?;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(2) && said.contains(word), format!("{wrong}: {said}"))?;
    }
    Ok(())
}

/// A grade under a file gives the numbers of the file with the grade's terms written out; alone it
/// is a study of its own name.
fn preset() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    // The tactical grade beside the file's own bias and noise: what is left is written here from
    // its datasheet.
    let written = SMALL.replace("[report]", "scale_factor_ppm = { mean = 0.0, sd = 300.0 }\nbias_instability_ug = 75.3\n\
        [gyro]\nbias_deg_h = { mean = 0.0, sd = 4.0 }\nangle_random_walk_deg_rth = 0.15\nbias_instability_deg_h = 0.753\n[report]");
    let by_hand = timeless(json(&mut study(folder.path(), &written)?)?);
    let under = |grade: &str| -> Result<Value, Failed> {
        let mut command = study(folder.path(), SMALL)?;
        Ok(timeless(json(command.args(["--preset", grade]))?))
    };
    check(under("tactical")? == by_hand, "the grade is not what its datasheet says")?;
    check(under("consumer")? != by_hand, "another grade makes no difference (control)")?;
    let alone = |grade: &str, out: &str| -> Result<Value, Failed> {
        let mut command = program();
        command.current_dir(folder.path()).args([
            "--json",
            "study",
            "--members",
            "256",
            "--out",
            out,
            "--preset",
            grade,
        ]);
        json(&mut command)
    };
    let last = |document: &Value| document["position_error_m"]["sd"].as_array().and_then(|all| all.last()?.as_f64());
    let worst_first: Vec<_> = ["consumer", "industrial", "tactical", "navigation"]
        .into_iter()
        .map(|grade| Ok(last(&alone(grade, grade)?)))
        .collect::<Result<_, Failed>>()?;
    let [Some(consumer), .., Some(navigation)] = worst_first[..] else { return Err("no position error".into()) };
    check(navigation < 0.1 * consumer, format!("{worst_first:?}"))?;
    let mut unknown = study(folder.path(), SMALL)?;
    let output = unknown.args(["--preset", "tactcal"]).output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(2) && said.contains("tactical"), said)
}

fn seeds() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let first = timeless(json(&mut study(folder.path(), SMALL)?)?);
    check(first == timeless(json(&mut study(folder.path(), SMALL)?)?), "the same study gave two answers")?;
    let other = timeless(json(study(folder.path(), SMALL)?.args(["--seed", "2"]))?);
    check(first["position_error_m"] != other["position_error_m"], "another seed gave the same answer")
}

fn refused(command: &mut Command, word: &str) -> Result<(), Failed> {
    let output = command.output()?;
    let message = String::from_utf8_lossy(&output.stderr);
    check(output.status.code() == Some(2), format!("exit {:?}: {message}", output.status.code()))?;
    check(message.contains("cause:") && message.contains("hint:"), message.clone())?;
    check(message.contains(word), format!("no '{word}' in: {message}"))?;
    check(!message.contains("panicked"), message.clone())?;
    check(output.stdout.is_empty(), "something was printed as a result")
}

/// Along one axis and along a trajectory, on stderr and on the page.
fn idle() -> Result<(), Failed> {
    let warm = "[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [2.0, 40.0]]\n";
    let still = "members = 64\nduration_s = 2.0\n[gyro]\nbias_deg_h = 1.0\n[trajectory]\nkind = \"rest\"\n";
    let words = "[temperature] has no effect: no temperature coefficient is set";
    for (text, coefficient, expected) in [
        (format!("{SMALL}{warm}"), "gyro.angle_random_walk_deg_rth=0.1", true),
        (format!("{SMALL}{warm}"), "accelerometer.bias_temperature_ug_k=0.0", true),
        (format!("{SMALL}{warm}"), "accelerometer.bias_temperature_ug_k=5.0", false),
        (format!("{still}{warm}"), "gyro.bias_deg_h=2.0", true),
        (format!("{still}{warm}"), "gyro.scale_temperature_ppm_k={ mean = 0.0, sd = 1.0 }", false),
        (SMALL.to_owned(), "gyro.bias_deg_h=2.0", false),
    ] {
        let folder = tempfile::tempdir()?;
        let output = study(folder.path(), &text)?.args(["--set", coefficient]).output()?;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.success(), said.clone())?;
        check(said.contains(words) == expected, format!("{coefficient}: {said}"))?;
        let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
        check(page.contains(words) == expected, format!("{coefficient}: the page"))?;
    }
    Ok(())
}

fn unwritable() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("out"), "a file where the folder should go")?;
    refused(&mut study(folder.path(), SMALL)?, "folder")
}

fn nothing_to_resume() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    refused(study(folder.path(), SMALL)?.arg("--resume"), "no interrupted run")
}

/// What is wrong, the file (none: it is missing), a word of the message.
type Log = (&'static str, Option<&'static str>, &'static str);

const LOGS: &[Log] = &[
    ("a missing file", None, "log.csv"),
    ("an empty file", Some(""), "log.csv"),
    ("a file without rows", Some("t_s,a\n"), "log.csv"),
    ("ragged rows", Some("t_s,a\n0,1\n1\n2,3,4\n3,1\n"), "log.csv"),
    ("NaN", Some("t_s,a\n0,nan\n1,nan\n2,nan\n3,nan\n"), "log.csv"),
    ("time that runs backwards", Some("t_s,a\n0,1\n2,1\n1,1\n0,1\n"), "log.csv"),
    ("another column", Some("t_s,acc\n0,1\n1,1\n2,1\n3,1\n"), "acc"),
    ("a recording too short", Some("t_s,a\n0,1\n0.5,1\n"), "duration_s"),
];

fn replay((_, text, word): &Log) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    if let Some(text) = text {
        std::fs::write(folder.path().join("log.csv"), text)?;
    }
    let section = "[excitation]\nkind = \"replay\"\nfile = \"log.csv\"\ncolumn = \"a\"\ntime = \"t_s\"\n";
    refused(&mut study(folder.path(), &format!("{SMALL}{section}"))?, word)?;
    check(!folder.path().join("out").exists(), "a refused study left a folder behind")
}

#[cfg(unix)]
fn interrupt() -> Result<(), Failed> {
    // Long enough to be caught in the act on any machine: the first size that is.
    for members in [200_000u64, 2_000_000, 20_000_000] {
        let folder = tempfile::tempdir()?;
        let text = "name = \"long\"\nduration_s = 10.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n";
        let ask = || -> Result<Command, Failed> {
            let mut command = study(folder.path(), text)?;
            command.args(["--members", &members.to_string(), "--backend", "cpu"]);
            Ok(command)
        };
        let mut child = ask()?.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        // Signals are heard before the folder is locked.
        while !folder.path().join("out/.proofmass.json").exists() && child.try_wait()?.is_none() {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(400));
        if child.try_wait()?.is_some() {
            continue;
        }
        Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
        let asked = Instant::now();
        let output = child.wait_with_output()?;
        let waited = asked.elapsed();
        if output.status.success() {
            continue;
        }
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(130) && message.contains("Ctrl-C"), message)?;
        // One second on a quiet machine; tests run beside others, on machines that are not quiet.
        check(waited < Duration::from_secs(20), format!("it took {waited:?} to stop"))?;
        check(!folder.path().join("out/report.html").exists(), "an interrupted run left a report")?;
        let resumed = timeless(json(ask()?.arg("--resume"))?);
        check(resumed == timeless(json(&mut ask()?)?), "resumed and uninterrupted answers differ")?;
        return check(!folder.path().join("out/interrupted-1.json").exists(), "the state file was left behind");
    }
    Err("no run was long enough to be interrupted".into())
}
