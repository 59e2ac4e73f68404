//! Headings, units, study names and paths of any text: what is written of them is read back,
//! parses, and steers nothing.

use std::fs;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::document::toml_string;
use proofmass::rng::{Philox, Stream};
use serde_json::Value;

use super::bench::{Bench, run};
use super::pages::without_own_script;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("hostile names: as headings, in the noise of a log and the study made of it", headings),
        test("hostile names: as headings and unit, in a diagnosis and its repaired model", diagnosis),
        test("hostile names: as the name of a study", study_names),
        test("hostile names: as the name of a recording, its folder and the results'", paths),
        test("hostile names: headings that a file name cannot tell apart have figures of their own", figures),
        test("hostile names: the oracles see what is wrong", oracles),
    ]
}

/// Each stands between two letters, so that no reader trims it away.
const STRINGS: [&str; 36] = [
    "\u{a0}",
    "\u{ad}",
    "\u{200b}",
    "\u{feff}",
    "e\u{301}u\u{308}",
    "\u{2028}",
    "\u{2029}",
    "\u{85}",
    "\u{1}",
    "\u{7}\u{8}",
    "\u{b}\u{c}",
    "\u{1b}[31mred\u{1b}[0m",
    "\u{1b}]0;title\u{7}",
    "\u{9b}2J",
    "\u{7f}",
    "\u{1f}",
    "\u{fffe}\u{ffff}",
    "\"",
    "\"\"\"",
    "'",
    "'''",
    "\\",
    "\\u{a0}\\n",
    "\\\"",
    "\u{202e}txet\u{202c}",
    "\u{2066}\u{2069}",
    "שלום",
    "加速度",
    "🚀👩‍🔬",
    "𝒳\u{10ffff}",
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "]]>&amp;<!--",
    "fill=\"#0072B2\" stroke='#C84E00'>",
    "# = [table]",
    "%s %n {} {{}} $(id) `id` ; rm",
];

fn hostile() -> Vec<String> {
    let long = ["n".repeat(300), "é".repeat(150), "\u{1b}".repeat(300)];
    STRINGS.iter().map(|s| format!("a{s}b")).chain(long.iter().map(|s| format!("a{s}b"))).collect()
}

/// White noise under these headings, one sample a row, as a spreadsheet would write it.
fn csv(headings: &[String], rows: usize) -> String {
    let mut rng = Philox::new(11, 0, Stream::Host);
    let quoted: Vec<String> = headings.iter().map(|h| format!("\"{}\"", h.replace('"', "\"\""))).collect();
    let mut row = || headings.iter().map(|_| format!("{:.5}", rng.normal())).collect::<Vec<_>>().join(",") + "\n";
    quoted.join(",") + "\n" + &(0..rows).map(|_| row()).collect::<String>()
}

/// Nothing that would move a cursor, ring, hide or turn round what follows.
fn harmless(text: &str) -> Result<(), Failed> {
    let steers = |c: char| {
        (c.is_control() && c != '\n' && c != '\t') || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let found = text.chars().find(|c| steers(*c));
    check(found.is_none(), format!("{found:?} reaches the terminal"))
}

fn well_formed(svg: &str) -> Result<(), Failed> {
    roxmltree::Document::parse(svg).map(drop).map_err(|e| Failed::from(format!("not well-formed: {e}")))
}

/// A page without any script but its own, whose figures are XML; how many it has.
fn page(text: &str) -> Result<usize, Failed> {
    let lower = without_own_script(text)?.to_lowercase();
    for word in ["<script", "<img", "<!--", "javascript:"] {
        check(!lower.contains(word), format!("the page holds {word}"))?;
    }
    let figures: Vec<&str> =
        text.split("<figure>").skip(1).map(|part| part.split("<figcaption>").next().unwrap_or_default()).collect();
    figures.iter().try_for_each(|svg| well_formed(svg))?;
    Ok(figures.len())
}

/// Every file of a folder by the oracle of its kind; how many were looked at.
fn files(folder: &Path) -> Result<usize, Failed> {
    let mut seen = 0;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Ok(text) = fs::read_to_string(&path) else { continue };
        let of = |e: Failed| Failed::from(format!("{}: {}", path.display(), e.message().unwrap_or_default()));
        match path.extension().and_then(|e| e.to_str()) {
            Some("svg") => well_formed(&text).map_err(of)?,
            Some("html") => page(&text).map(drop).map_err(of)?,
            Some("json") => drop(serde_json::from_str::<Value>(&text)?),
            Some("toml") => drop(toml::from_str::<toml::Table>(&text).map_err(|e| of(e.to_string().into()))?),
            _ => continue,
        }
        seen += 1;
    }
    Ok(seen)
}

/// Runs a command; if it answers, on a terminal and with `--json`, the answers are harmless and its
/// folder is in order. `false` where it refuses, in words that are harmless too.
fn answers(command: &dyn Fn() -> std::process::Command, out: &Path) -> Result<bool, Failed> {
    let plain = run(&mut command())?;
    harmless(&plain.stdout)?;
    harmless(&plain.stderr)?;
    if plain.code != Some(0) {
        plain.refuses("a hostile name", "cause")?;
        return Ok(false);
    }
    let json = run(command().arg("--json"))?;
    harmless(&json.stdout)?;
    json.json()?;
    check(files(out)? > 0, "nothing was written")?;
    Ok(true)
}

/// A generated study runs: one member for each lane, so that it takes no time.
fn runs(study: &Path, out: &Path) -> Result<(), Failed> {
    let command = || {
        let mut command = program();
        command.arg("study").arg(study).args(["--members", "64", "--out"]).arg(out);
        command
    };
    check(answers(&command, out)?, format!("{} does not run: {}", study.display(), run(&mut command())?.stderr))
}

fn headings() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let names = hostile();
    let log = bench.file("log.csv", &csv(&names, 400))?;
    let all = names.join(",");
    for (n, more) in [&[][..], &["--accelerometer", &all, "--accelerometer-scale", "mg"]].into_iter().enumerate() {
        let out = bench.path(&format!("out-{n}"));
        let command = || {
            let mut command = program();
            command.arg("allan").arg(&log).args(["--rate-hz", "100"]).args(more).arg("--out").arg(&out);
            command
        };
        check(answers(&command, &out)?, format!("all headings: {}", run(&mut command())?.stderr))?;
    }
    runs(&bench.path("out-1/study.toml"), &bench.path("study"))
}

fn diagnosis() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut repaired = 0;
    for (n, name) in hostile().iter().enumerate() {
        let log = bench.file(&format!("log-{n}.csv"), &csv(std::slice::from_ref(name), 300))?;
        let quoted = toml_string(name);
        // A study of the repaired model needs a unit that it knows.
        for (kind, unit) in [("unit", quoted.as_str()), ("g", "\"g\"")] {
            let text = format!("kind = \"static\"\nrate_hz = 100.0\nunit = {unit}\n[columns]\nchannels = [{quoted}]\n");
            let model = bench.file(&format!("model-{n}-{kind}.toml"), &text)?;
            let out = bench.path(&format!("out-{n}-{kind}"));
            let command = || {
                let mut command = program();
                command.arg("diagnose").arg(&log).arg("--model").arg(&model).arg("--out").arg(&out);
                command
            };
            check(answers(&command, &out)?, format!("{name:?}: {}", run(&mut command())?.stderr))?;
            let study = out.join("repaired.toml");
            if study.exists() {
                runs(&study, &bench.path(&format!("study-{n}-{kind}")))?;
                repaired += 1;
            }
        }
    }
    check(repaired > 0, "no repaired model was written")
}

fn study_names() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut accepted = 0;
    for (n, name) in hostile().iter().enumerate() {
        let text =
            format!("name = {}\nmembers = 64\nduration_s = 1.0\n[accelerometer]\nbias_mg = 1.0\n", toml_string(name));
        let study = bench.file(&format!("study-{n}.toml"), &text)?;
        let out = bench.path(&format!("out-{n}"));
        let command = || {
            let mut command = program();
            command.arg("study").arg(&study).arg("--out").arg(&out);
            command
        };
        accepted += usize::from(answers(&command, &out)?);
    }
    // Letters of any script are a name; nothing else of the list is.
    check(accepted >= 2, format!("{accepted} names were accepted"))
}

fn paths() -> Result<(), Failed> {
    let bench = Bench::new()?;
    for name in hostile() {
        // What no Unix folder may be called, or is too long for one.
        let name: String = name.replace('/', "").chars().take(80).collect();
        let folder = bench.path(&name);
        if fs::create_dir(&folder).is_err() {
            continue;
        }
        let log = folder.join(format!("{name}.csv"));
        fs::write(&log, csv(&["x".into(), "y".into()], 400))?;
        let out = folder.join("out");
        let command = || {
            let mut command = program();
            command
                .arg("allan")
                .arg(&log)
                .args(["--rate-hz", "100", "--gyro", "x", "--gyro-scale", "deg/s", "--out"])
                .arg(&out);
            command
        };
        check(answers(&command, &out)?, format!("{name:?}: {}", run(&mut command())?.stderr))?;
        let study = fs::read_to_string(out.join("study.toml"))?;
        let file = toml::from_str::<toml::Table>(&study)?["compare"]["file"].as_str().map(str::to_owned);
        check(file.as_deref().map(Path::new) == Some(&log.canonicalize()?), format!("{name:?} became {file:?}"))?;
        runs(&out.join("study.toml"), &folder.join("simulated"))?;
    }
    Ok(())
}

fn figures() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let long = "n".repeat(300);
    let names = ["a/b", "a b", "a-b", "A-B", "a-b-2", &long, &format!("{long}m"), "ü", "ö"].map(String::from);
    let channels: Vec<String> = names.iter().map(|n| toml_string(n)).collect();
    let model = format!("kind = \"static\"\nrate_hz = 100.0\n[columns]\nchannels = [{}]\n", channels.join(", "));
    let out = bench.path("out");
    let answer = bench.diagnose(&csv(&names, 1000), &model, &["--json", "--out", &out.display().to_string()])?;
    answer.json()?;
    let svg: Vec<String> = fs::read_dir(&out)?
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().to_lowercase()))
        .filter(|name| name.ends_with(".svg"))
        .collect();
    let different: std::collections::BTreeSet<&String> = svg.iter().collect();
    // Allan deviation, density and trace of each.
    check(different.len() == 3 * names.len(), format!("{} figures: {svg:?}", different.len()))?;
    check(svg.iter().all(|name| name.len() <= 120 && name.is_ascii()), format!("{svg:?}"))
}

fn oracles() -> Result<(), Failed> {
    check(harmless("a\u{1b}[31m").is_err() && harmless("a\u{202e}").is_err(), "the terminal's oracle is blind")?;
    check(harmless("µg/√Hz\n").is_ok(), "the terminal's oracle refuses units")?;
    let figure = |text: &str| format!("<figure><svg><text>{text}</text></svg><figcaption>");
    check(page(&figure("a")).is_ok_and(|n| n == 1), "the page's oracle finds no figure")?;
    for text in ["\u{1b}", "<", "&", "a<script>b</script>"] {
        check(page(&figure(text)).is_err(), format!("the page's oracle is blind to {text:?}"))?;
    }
    check(toml::from_str::<toml::Table>("name = \"\\u{a0}\"").is_err(), "TOML takes Rust's escapes")?;
    check(STRINGS.iter().all(|s| !s.contains('\0') && !s.contains('\n')), "a string that no row of a file holds")
}
