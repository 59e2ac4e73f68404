//! Folders of results that somebody else has laid out: with links, pipes and a manifest that claims
//! the user's files. Nothing is written or removed outside, or that this program did not write.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};
use proofmass::document::hexadecimal;
use serde_json::json;
use sha2::{Digest, Sha256};

use super::bench::{Answer, Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("outputs: a manifest of another's making removes no file, in the folder or beyond a link", manifests),
        test("outputs: a lock or a state that is a link, a pipe or a device is refused at once", special),
        test("outputs: numbers are not written through a link, forced or not", numbers),
    ]
}

const STUDY: &str = "name = \"small\"\nmembers = 256\nduration_s = 1.0\n[accelerometer]\nbias_mg = 1.0\n";
const PRECIOUS: &str = "precious";

fn study(bench: &Bench, more: &[&str]) -> Result<Answer, Failed> {
    run(program().arg("study").arg(bench.path("study.toml")).arg("--out").arg(bench.path("out")).args(more))
}

/// A folder `out` with a link `d` to the folder `home`, and files of the user's in both.
fn laid_out() -> Result<Bench, Failed> {
    let bench = Bench::new()?;
    bench.file("study.toml", STUDY)?;
    fs::create_dir(bench.path("out"))?;
    fs::create_dir(bench.path("home"))?;
    symlink(bench.path("home"), bench.path("out/d"))?;
    bench.file("home/rc.svg", PRECIOUS)?;
    bench.file("out/thesis.tex", PRECIOUS)?;
    bench.file("out/rc.svg", PRECIOUS)?;
    Ok(bench)
}

fn manifests() -> Result<(), Failed> {
    let right = hexadecimal(&Sha256::digest(PRECIOUS));
    let none: [&str; 0] = [];
    // The name of a file, its hash, states, and what the program has to say of it; without a word,
    // the run is accepted.
    for (name, sha256, states, words) in [
        ("d/rc.svg", "x", &["*"][..], "is a link to another place"),
        ("d/rc.svg", right.as_str(), &none, "is a link to another place"),
        ("thesis.tex", "x", &["*"], "it lists the state `*`"),
        ("thesis.tex", "x", &["*.tex"], "it lists the state `*.tex`"),
        ("thesis.tex", &right, &none, ""),
        ("rc.svg", "x", &none, "rc.svg: changed since proofmass wrote it"),
    ] {
        let what = format!("{name} {sha256} {states:?}");
        let bench = laid_out()?;
        let files = json!({ name: sha256 });
        let entry = json!({ "command": "study", "inputs": ["../study.toml"], "files": files, "states": states });
        bench.file("out/.proofmass.json", &json!({ "schema": "proofmass.outputs/1", "runs": [entry] }).to_string())?;
        let answer = study(&bench, &[])?;
        match words {
            "" => check(answer.code == Some(0), format!("{what}: {}", answer.stderr))?,
            words => answer.refuses(&what, words)?,
        }
        // Forced, the manifest is set aside, and the files are nobody's results.
        let forced = study(&bench, &["--force"])?;
        check(forced.code == Some(0), format!("{what}, forced: {}", forced.stderr))?;
        for kept in ["home/rc.svg", "out/thesis.tex", "out/rc.svg"] {
            let text = fs::read_to_string(bench.path(kept)).unwrap_or_default();
            check(text == PRECIOUS, format!("{what}: {kept} is gone"))?;
        }
    }
    // The control: a result of the program's own, known by name and content, does go.
    let bench = laid_out()?;
    let files = json!({ "rc.svg": right });
    let entry = json!({ "command": "study", "inputs": ["../study.toml"], "files": files });
    bench.file("out/.proofmass.json", &json!({ "schema": "proofmass.outputs/1", "runs": [entry] }).to_string())?;
    let answer = study(&bench, &[])?;
    check(answer.code == Some(0) && !bench.path("out/rc.svg").exists(), "a stale figure of the run's own stayed")
}

fn special() -> Result<(), Failed> {
    for name in [".proofmass.lock", "interrupted-1.json"] {
        for kind in ["link", "loose link", "pipe", "folder"] {
            let what = format!("{name} as a {kind}");
            let bench = Bench::new()?;
            bench.file("study.toml", STUDY)?;
            bench.file("target", PRECIOUS)?;
            fs::create_dir(bench.path("out"))?;
            let path = bench.path("out").join(name);
            match kind {
                "link" => symlink(bench.path("target"), &path)?,
                "loose link" => symlink(bench.path("nothing"), &path)?,
                "pipe" => check(Command::new("mkfifo").arg(&path).status()?.success(), "no mkfifo")?,
                _ => fs::create_dir(&path)?,
            }
            let begun = Instant::now();
            for force in [&[][..], &["--force"]] {
                let answer = study(&bench, force)?;
                check(answer.code == Some(2), format!("{what}, {force:?}: {:?} {}", answer.code, answer.stderr))?;
            }
            check(begun.elapsed() < Duration::from_secs(20), format!("{what}: it was waited for"))?;
            check(fs::read_to_string(bench.path("target"))? == PRECIOUS, format!("{what}: the target was written"))?;
            check(!bench.path("nothing").exists(), format!("{what}: a file was made elsewhere"))?;
        }
    }
    Ok(())
}

fn numbers() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("study.toml", STUDY)?;
    fs::create_dir(bench.path("out"))?;
    fs::create_dir(bench.path("home"))?;
    symlink(bench.path("home"), bench.path("out/numbers"))?;
    for force in [&[][..], &["--force"]] {
        study(&bench, force)?
            .refuses(&format!("numbers elsewhere, {force:?}"), "its folder is a link to another place")?;
    }
    check(fs::read_dir(bench.path("home"))?.count() == 0, "numbers were written elsewhere")?;
    // The control: with a folder of that name, they are written there.
    fs::remove_file(bench.path("out/numbers"))?;
    let answer = study(&bench, &[])?;
    check(answer.code == Some(0), answer.stderr)?;
    check(fs::read_dir(bench.path("out/numbers"))?.count() > 0, "no numbers in a folder of their own")
}
