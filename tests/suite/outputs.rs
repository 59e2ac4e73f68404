//! Folders of results: a run replaces its own files and nobody else's, one run at a time, each file
//! whole.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};
use proofmass::document::hexadecimal;
use proofmass::rng::{Philox, Stream};
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::bench::{Answer, Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("outputs: a run replaces its own results, whatever was edited in its input", own_results),
        test("outputs: two studies of one name do not replace each other", one_name),
        test("outputs: a file that proofmass did not write is refused before the work, and forced over", not_ours),
        test("outputs: a generated study with a bias added by hand is the user's", edited_by_hand),
        test("outputs: what a run reads is never replaced, forced or not", inputs),
        test("outputs: what a run no longer finds goes away", stale),
        test("outputs: a verdict is printed though its report cannot be written", printed_all_the_same),
        test("outputs: one run at a time in a folder; half-written files of a killed one are swept", locked),
        test("outputs: committed reports count as written by their commands", committed),
        test("outputs: a trial begins anew over its own files only, and resumes only what is there", trials),
    ];
    #[cfg(unix)]
    all.extend([
        test("outputs: files follow the umask", unix::umask),
        test("outputs: a killed run leaves no lock", unix::killed),
        test("outputs: a stopped run ends with 128 and its signal", unix::signals),
        test(
            "outputs: a signal ends what looks at nothing, a file that is being opened, within two seconds",
            unix::opening,
        ),
        test("outputs: more files than a process may have open", unix::many),
        test("outputs: documents that are pipes or devices are refused", unix::pipes),
        test("outputs: help that cannot be printed is an error", unix::full),
    ]);
    all
}

const STUDY: &str = "name = \"small\"\nmembers = 256\nduration_s = 1.0\n[accelerometer]\nbias_mg = 1.0\n";

/// 2000 rows of white noise in two columns, `ax` and `gz`.
fn log() -> String {
    let mut rng = Philox::new(5, 0, Stream::Host);
    let mut row = || format!("{:.6},{:.6}\n", rng.normal(), rng.normal());
    "ax,gz\n".to_owned() + &(0..2000).map(|_| row()).collect::<String>()
}

/// Every file of a folder with its content, but for what proofmass keeps about it.
fn content(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Failed> {
    let mut out = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_file() && name != ".proofmass.json" {
            out.insert(name, fs::read(entry.path())?);
        }
    }
    Ok(out)
}

fn study(bench: &Bench, file: &str, more: &[&str]) -> Result<Answer, Failed> {
    run(program().arg("study").arg(bench.path(file)).arg("--out").arg(bench.path("out")).args(more))
}

fn allan(bench: &Bench, more: &[&str]) -> Result<Answer, Failed> {
    let scaled = ["--rate-hz", "100", "--accelerometer", "ax", "--accelerometer-scale", "mg"];
    run(program().arg("allan").arg(bench.path("log.csv")).args(scaled).arg("--out").arg(bench.path("out")).args(more))
}

fn accepted(what: &str, answer: &Answer) -> Result<(), Failed> {
    check(answer.code == Some(0), format!("{what}: exit {:?} {}", answer.code, answer.stderr))
}

fn own_results() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("study.toml", STUDY)?;
    accepted("first", &study(&bench, "study.toml", &[])?)?;
    let first = content(&bench.path("out"))?;
    bench.file("study.toml", &STUDY.replace("1.0", "2.0"))?;
    accepted("edited and seeded", &study(&bench, "study.toml", &["--seed", "7", "--members", "512"])?)?;
    let second = content(&bench.path("out"))?;
    check(first.keys().eq(second.keys()), format!("{:?} became {:?}", first.keys(), second.keys()))?;
    check(first["report.html"] != second["report.html"], "the report was not replaced")?;
    // Study and results moved together are still each other's; the study alone is not.
    fs::create_dir(bench.path("moved"))?;
    for name in ["study.toml", "out"] {
        fs::rename(bench.path(name), bench.path("moved").join(name))?;
    }
    let again =
        |file: &str| run(program().arg("study").arg(bench.path(file)).arg("--out").arg(bench.path("moved/out")));
    accepted("moved", &again("moved/study.toml")?)?;
    fs::rename(bench.path("moved/study.toml"), bench.path("study.toml"))?;
    again("study.toml")?.refuses("moved away from its results", "moved/study.toml")
}

fn one_name() -> Result<(), Failed> {
    let bench = Bench::new()?;
    for folder in ["a", "b"] {
        fs::create_dir(bench.path(folder))?;
        bench.file(&format!("{folder}/study.toml"), STUDY)?;
    }
    // Without --out, into reports/small of the folder that both are run from.
    let study = |folder: &str, more: &[&str]| {
        let file = format!("{folder}/study.toml");
        run(program().current_dir(bench.path(".")).args(["study", &file]).args(more))
    };
    accepted("the first", &study("a", &[])?)?;
    let first = content(&bench.path("reports/small"))?;
    study("b", &[])?
        .refuses("the second", "report.html, envelope.svg, numbers/ (4 files): written by `proofmass study` for ")?;
    check(content(&bench.path("reports/small"))? == first, "the refused study changed something")?;
    accepted("the first again", &study("a", &[])?)?;
    accepted("the second, forced", &study("b", &["--force"])?)?;
    study("a", &[])?.refuses("the first, whose files they are no longer", "b/study.toml")
}

fn not_ours() -> Result<(), Failed> {
    let bench = Bench::new()?;
    fs::create_dir(bench.path("out"))?;
    bench.file("out/report.html", "precious")?;
    bench.file("out/notes.txt", "of no concern")?;
    bench.file("study.toml", STUDY)?;
    let before = content(&bench.path("out"))?;
    let refused = study(&bench, "study.toml", &["--members", "4000000000"])?;
    refused.refuses("a report of another's", "report.html: not written by proofmass")?;
    check(content(&bench.path("out"))? == before, "a refused run left something behind")?;
    check(!bench.path("out/.proofmass.json").exists(), "a refused run left its manifest")?;
    accepted("forced", &study(&bench, "study.toml", &["--force"])?)?;
    let after = content(&bench.path("out"))?;
    check(after["report.html"] != before["report.html"], "--force replaced nothing")?;
    check(after["notes.txt"] == before["notes.txt"], "--force touched a file that is no output")?;
    accepted("after it was forced, the report is ours", &study(&bench, "study.toml", &[])?)
}

fn edited_by_hand() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("log.csv", &log())?;
    accepted("first", &allan(&bench, &[])?)?;
    accepted("untouched", &allan(&bench, &[])?)?;
    let path = bench.path("out/study.toml");
    let text = fs::read_to_string(&path)?;
    check(text.contains("name = \"log\""), format!("the study is not named after the recording: {text}"))?;
    fs::write(&path, text.replace("[accelerometer]\n", "[accelerometer]\nbias_mg = 1.5\n"))?;
    let before = content(&bench.path("out"))?;
    allan(&bench, &[])?.refuses("edited", "study.toml: changed since proofmass wrote it")?;
    check(content(&bench.path("out"))? == before, "a refused run changed something")?;
    accepted("forced", &allan(&bench, &["--force"])?)?;
    check(!fs::read_to_string(&path)?.contains("bias_mg = 1.5"), "--force replaced nothing")
}

const MODEL: &str = "kind = \"static\"\nrate_hz = 100.0\nunit = \"mg\"\n[columns]\nchannels = [\"ax\", \"gz\"]\n";

fn inputs() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("log.csv", &log())?;
    for (name, force) in [("model.toml", false), ("repaired.toml", true), ("verdict.json", true)] {
        bench.file(name, MODEL)?;
        let mut command = program();
        command.current_dir(bench.path(".")).args(["diagnose", "log.csv", "--model", name, "--out", "."]);
        if force {
            run(command.arg("--force"))?.refuses(name, &format!("{name}: an input of this run"))?;
        } else {
            accepted(name, &run(&mut command)?)?;
            check(bench.path("report.html").is_file(), "no report")?;
        }
        check(fs::read_to_string(bench.path(name))? == MODEL, format!("{name} was overwritten"))?;
        check(fs::read_to_string(bench.path("log.csv"))? == log(), "the recording was overwritten")?;
        fs::remove_file(bench.path(name))?;
    }
    Ok(())
}

fn stale() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("log.csv", &log())?;
    accepted("with a scale", &allan(&bench, &[])?)?;
    check(bench.path("out/study.toml").is_file(), "no study where a scale was given")?;
    bench.file("out/mine.toml", "of no concern")?;
    let unscaled = || {
        run(program()
            .arg("allan")
            .arg(bench.path("log.csv"))
            .args(["--rate-hz", "100", "--out"])
            .arg(bench.path("out")))
    };
    accepted("without a scale", &unscaled()?)?;
    check(!bench.path("out/study.toml").exists(), "a study of the run before stands beside the new report")?;
    check(bench.path("out/mine.toml").is_file() && bench.path("out/sensor.toml").is_file(), "too much went")
}

fn printed_all_the_same() -> Result<(), Failed> {
    let bench = Bench::new()?;
    fs::create_dir(bench.path("out"))?;
    // Which figures there will be is not known before the diagnosis.
    bench.file("out/allan-ax.svg", "precious")?;
    let out = bench.path("out").display().to_string();
    let answer = bench.diagnose(&log(), MODEL, &["--json", "--out", &out])?;
    answer.refuses("a figure of another's", "allan-ax.svg: not written by proofmass")?;
    let verdict: Value = serde_json::from_str(&answer.stdout)?;
    check(verdict["schema"] == "proofmass.verdict/1", "no verdict on stdout")?;
    check(content(&bench.path("out"))?.len() == 1, "some of the files were written all the same")
}

fn locked() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("study.toml", STUDY)?;
    fs::create_dir(bench.path("out"))?;
    for name in ["out/.proofmass-x1Y2z3", "out/.proofmassx"] {
        bench.file(name, "half of a fi")?;
    }
    let held = fs::File::create(bench.path("out/.proofmass.lock"))?;
    held.try_lock()?;
    study(&bench, "study.toml", &["--force"])?.refuses("locked", "another run of proofmass is writing there")?;
    check(bench.path("out/.proofmass-x1Y2z3").exists(), "the files of a run that goes on were swept")?;
    drop(held);
    accepted("free", &study(&bench, "study.toml", &[])?)?;
    check(!bench.path("out/.proofmass-x1Y2z3").exists(), "half-written files were left")?;
    check(bench.path("out/.proofmassx").exists(), "a file of the user's was swept")?;
    check(!cfg!(unix) || !bench.path("out/.proofmass.lock").exists(), "the lock was left behind")
}

/// Results that are kept in the repository, by folder, with the files that their command is made
/// from.
fn committed() -> Result<(), Failed> {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    for (folder, command, inputs, files) in [
        ("proof", "trial", vec![], &["summary.md", "power.svg", "limits.svg"][..]),
        ("bench", "bench", vec![], &["summary.md", "sizes.svg", "lengths.svg"][..]),
        ("adis16405", "study", vec![Value::from("study.toml")], &["windows.svg"][..]),
    ] {
        let manifest: Value = serde_json::from_str(&fs::read_to_string(reports.join(folder).join(".proofmass.json"))?)?;
        let runs = manifest["runs"].as_array().cloned().unwrap_or_default();
        let run = runs.iter().find(|r| r["command"] == command && r["inputs"] == Value::Array(inputs.clone()));
        for file in files {
            let known = run.and_then(|r| r["files"][*file].as_str()).unwrap_or_default();
            let sha256 = hexadecimal(&Sha256::digest(fs::read(reports.join(folder).join(file))?));
            check(known == sha256, format!("reports/{folder}/{file} is not known to be of `proofmass {command}`"))?;
        }
    }
    Ok(())
}

fn trials() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let trial = |more: &[&str]| {
        let small = ["trial", "--cases", "1", "--samples", "500", "--out"];
        run(program().args(small).arg(bench.path("out")).args(more))
    };
    trial(&["--resume"])?.refuses("nothing to resume", "no trial in")?;
    check(!bench.path("out").exists(), "a refused trial left a folder")?;
    fs::create_dir(bench.path("out"))?;
    bench.file("out/verdicts.jsonl", "precious")?;
    trial(&[])?.refuses("verdicts of another's", "verdicts.jsonl: not written by proofmass")?;
    check(fs::read_to_string(bench.path("out/verdicts.jsonl"))? == "precious", "they were overwritten")?;
    fs::remove_file(bench.path("out/verdicts.jsonl"))?;
    accepted("first", &trial(&[])?)?;
    accepted("anew", &trial(&["--seed", "2"])?)?;
    accepted("resumed", &trial(&["--seed", "2", "--resume"])?)?;
    trial(&["--seed", "3", "--resume"])?.refuses("another trial", "its seed, cases, samples or campaign differ")?;
    let path = bench.path("out/verdicts.jsonl");
    let edited = fs::read_to_string(&path)? + "\n";
    fs::write(&path, edited)?;
    trial(&["--seed", "2"])?.refuses("changed by hand", "verdicts.jsonl: changed since proofmass wrote it")
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::PermissionsExt;
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    use super::*;

    pub fn umask() -> Result<(), Failed> {
        for (umask, expected) in [("022", 0o644), ("077", 0o600), ("002", 0o664)] {
            let bench = Bench::new()?;
            let file = bench.file("study.toml", STUDY)?;
            let script = format!("umask {umask}; exec \"$0\" study \"$1\" --out \"$2\"");
            let binary = program();
            let mut shell = Command::new("sh");
            shell.args(["-c", &script]).arg(binary.get_program()).arg(file).arg(bench.path("out"));
            accepted(umask, &run(&mut shell)?)?;
            for name in ["report.html", "envelope.svg", ".proofmass.json"] {
                let mode = fs::metadata(bench.path("out").join(name))?.permissions().mode() & 0o777;
                check(mode == expected, format!("umask {umask}: {name} has {mode:o}, expected {expected:o}"))?;
            }
        }
        Ok(())
    }

    /// A study that takes long enough to be met in the act; it is when its lock stands.
    fn long(bench: &Bench) -> Result<Child, Failed> {
        bench.file("long.toml", "name = \"long\"\nmembers = 4000000000\nduration_s = 10.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n")?;
        let mut command = program();
        command.arg("study").arg(bench.path("long.toml")).args(["--backend", "cpu", "--out"]).arg(bench.path("out"));
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        let begun = Instant::now();
        while !bench.path("out/.proofmass.json").exists() {
            check(begun.elapsed() < Duration::from_secs(60), "the study never began")?;
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(child)
    }

    fn send(child: &Child, signal: &str) -> Result<(), Failed> {
        let sent = Command::new("kill").args([signal, &child.id().to_string()]).status()?;
        check(sent.success(), format!("could not send {signal}"))
    }

    pub fn killed() -> Result<(), Failed> {
        let bench = Bench::new()?;
        bench.file("study.toml", STUDY)?;
        let mut child = long(&bench)?;
        let second = study(&bench, "study.toml", &["--force"]);
        send(&child, "-KILL")?;
        child.wait()?;
        second?.refuses("a second run", "another run of proofmass is writing there")?;
        accepted("after the first was killed", &study(&bench, "study.toml", &[])?)
    }

    pub fn signals() -> Result<(), Failed> {
        for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
            let bench = Bench::new()?;
            let mut child = long(&bench)?;
            send(&child, signal)?;
            let ended = child.wait()?;
            check(ended.code() == Some(code), format!("{signal}: {ended:?}, expected {code}"))?;
        }
        Ok(())
    }

    pub fn opening() -> Result<(), Failed> {
        for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
            // Standard input that never ends is waited for, where nothing looks at the flag.
            let mut child = program()
                .args(["inspect", "-"])
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()?;
            std::thread::sleep(Duration::from_millis(500));
            check(child.try_wait()?.is_none(), "it ended before its input did")?;
            send(&child, signal)?;
            let asked = Instant::now();
            while child.try_wait()?.is_none() && asked.elapsed() < Duration::from_secs(10) {
                std::thread::sleep(Duration::from_millis(20));
            }
            // A little more than two seconds, on a machine that is busy.
            let took = asked.elapsed();
            check(took < Duration::from_secs(3), format!("{signal}: {took:?}"))?;
            check(child.wait()?.code() == Some(code), format!("{signal}: not {code}"))?;
        }
        Ok(())
    }

    pub fn many() -> Result<(), Failed> {
        let bench = Bench::new()?;
        let mut rng = Philox::new(6, 0, Stream::Host);
        let names: Vec<String> = (0..16).map(|n| format!("c{n}")).collect();
        let mut row = || names.iter().map(|_| format!("{:.5}", rng.normal())).collect::<Vec<_>>().join(",") + "\n";
        let log = bench.file("log.csv", &(names.join(",") + "\n" + &(0..300).map(|_| row()).collect::<String>()))?;
        let model = bench
            .file("model.toml", &format!("kind = \"static\"\nrate_hz = 100.0\n[columns]\nchannels = {names:?}\n"))?;
        let binary = program();
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -n 32; exec \"$0\" diagnose \"$1\" --model \"$2\" --out \"$3\""]);
        accepted("32 open files", &run(shell.arg(binary.get_program()).arg(log).arg(model).arg(bench.path("out")))?)?;
        // Three figures of each channel.
        let written = content(&bench.path("out"))?.len();
        check(written >= 48, format!("{written} files"))
    }

    pub fn pipes() -> Result<(), Failed> {
        let bench = Bench::new()?;
        let pipe: PathBuf = bench.path("pipe.toml");
        check(Command::new("mkfifo").arg(&pipe).status()?.success(), "no mkfifo")?;
        for path in [pipe, PathBuf::from("/dev/zero")] {
            let lines: [&[&str]; 3] = [&["study"], &["map"], &["diagnose", "log.csv", "--model"]];
            for line in lines {
                let answer = run(program().args(line).arg(&path))?;
                answer.refuses(&format!("{line:?} {}", path.display()), "it is a pipe or a device")?;
            }
        }
        Ok(())
    }

    pub fn full() -> Result<(), Failed> {
        if !Path::new("/dev/full").exists() {
            return Ok(());
        }
        for line in ["--help", "--version"] {
            let full = fs::OpenOptions::new().write(true).open("/dev/full")?;
            let output = program().arg(line).stdout(full).output()?;
            check(output.status.code() == Some(2), format!("{line}: {:?}", output.status))?;
        }
        Ok(())
    }
}
