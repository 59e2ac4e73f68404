//! The atlas of recordings: its pages say what the other commands say, a planted walk is found and
//! its absence too, and a list that cannot be used is refused.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::number::significant;
use proofmass::rng::{Philox, Stream};
use proofmass::trial::recording_atlas::recipe;
use rand::RngExt as _;
use rand_distr::StandardNormal;

use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "atlas: a planted walk is found in its interval, and where there is none or no telling, it says so",
            planted,
        ),
        test("atlas: a list that cannot be used is refused in a sentence", lists),
        data_test(
            "atlas: a log of two minutes has its own numbers on its page, and cannot tell of a walk",
            two_minutes,
        ),
    ]
}

const MODEL: &str = "kind = \"static\"\nunit = \"°/s\"\n[columns]\ntime = \"t_s\"\n\
                     channels = [\"wx_deg_s\", \"wy_deg_s\", \"wz_deg_s\"]\n";

/// A recipe with one set: logs at rest by name, each diagnosed.
fn list(files: &[(&str, &str)]) -> String {
    let mut text = "[[set]]\nid = \"gyro\"\ntitle = \"A gyro\"\nabout = \"It lies still.\"\nsource = \"drawn\"\n\
                    licence = \"none\"\n"
        .to_owned();
    for table in ["diagnosis", "rest"] {
        let last = if table == "rest" { "temperature = \"not-logged\"\n" } else { "model = \"model.toml\"\n" };
        for (name, file) in files {
            text += &format!("[[set.{table}]]\nname = \"{name}\"\nfile = \"{file}\"\n{last}");
        }
    }
    text
}

/// Makes the atlas of a list; returns its page of the set and that of the walk.
fn made(list: &str, data: &Path) -> Result<[String; 2], Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("list.toml"), list)?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    let out = folder.path().join("atlas");
    let run = program()
        .args(["trial", "--atlas"])
        .arg(folder.path().join("list.toml"))
        .arg("--out")
        .arg(&out)
        .env("PROOFMASS_DATA", data)
        .output()?;
    check(run.status.success(), String::from_utf8_lossy(&run.stderr))?;
    let index = std::fs::read_to_string(out.join("README.md"))?;
    check(index.contains("[A gyro](gyro.md)") && index.contains("(random-walk.md)"), &index)?;
    let pages = [std::fs::read_to_string(out.join("gyro.md"))?, std::fs::read_to_string(out.join("random-walk.md"))?];
    // No place of this machine is on any page.
    for place in [folder.path(), data] {
        let place = place.display().to_string();
        check(pages.iter().chain([&index]).all(|page| !page.contains(&place)), format!("{place} is on a page"))?;
    }
    Ok(pages)
}

/// The cells of a row of the first table that names this axis of this recording.
fn row(page: &str, recording: &str, axis: &str) -> Result<Vec<String>, Failed> {
    let is_row = |l: &&str| l.contains(&format!("[{recording}]")) && l.contains(&format!("| {axis} |"));
    let line = page.lines().find(is_row).ok_or(format!("no row of {axis} of {recording}"))?;
    Ok(line.split('|').map(|cell| cell.trim().to_owned()).collect())
}

/// Places of the columns "K" and "has a walk" among the cells of a row.
const K: usize = 4;
const ANSWER: usize = 5;

const RATE_HZ: f64 = 10.0;
/// White noise of a reading, °/s, and walk, °/s/√s: 216 °/h/√h, since K √s is 3600 °/h times 60 √s
/// to √h.
const WHITE_DEG_S: f64 = 0.05;
const WALK_DEG_S_RTS: f64 = 0.001;

/// x walks; y has the same white noise about the same bias; z is white about zero.
fn planted_log(path: &Path, rows: usize) -> Result<(), Failed> {
    let mut rng = Philox::new(5, 0, Stream::Host);
    let mut walk = 0.0;
    let mut text = "t_s,wx_deg_s,wy_deg_s,wz_deg_s\n".to_owned();
    for row in 0..rows {
        let mut normal = || rng.sample::<f64, _>(StandardNormal);
        walk += WALK_DEG_S_RTS / RATE_HZ.sqrt() * normal();
        let [x, y, z] = [0; 3].map(|_| WHITE_DEG_S * normal());
        text += &format!("{},{:.6},{:.6},{z:.6}\n", row as f64 / RATE_HZ, 1.5 + walk + x, 1.5 + y);
    }
    Ok(std::fs::write(path, text)?)
}

fn planted() -> Result<(), Failed> {
    let data = tempfile::tempdir()?;
    planted_log(&data.path().join("long.csv"), 40_000)?;
    planted_log(&data.path().join("short.csv"), 600)?;
    let [page, walk] = made(&list(&[("long", "long.csv"), ("short", "short.csv")]), data.path())?;
    check(page.contains("40000") && page.contains("10 Hz"), &page)?;
    let first = walk.lines().nth(2).unwrap_or_default();
    check(first.starts_with("**Yes, in 1 of the 2 gyro axes whose logs can tell:** `wx_deg_s` of long"), first)?;
    let x = row(&walk, "long", "wx_deg_s")?;
    check(x[ANSWER] == "yes", format!("{x:?}"))?;
    // "216 (180 – 250) °/h/√h"
    let ends: Vec<f64> = x[K].split(['(', '–', ')']).skip(1).filter_map(|end| end.trim().parse().ok()).collect();
    let planted = WALK_DEG_S_RTS * 3600.0 * 60.0;
    check(ends.len() == 2 && ends[0] <= planted && planted <= ends[1], format!("{planted} is planted: {x:?}"))?;
    // Negative controls: no walk, no bias, no time.
    for (recording, axis, answer) in [
        ("long", "wy_deg_s", "none seen"),
        ("long", "wz_deg_s", "cannot tell: bias taken off"),
        ("short", "wx_deg_s", "cannot tell"),
        ("short", "wy_deg_s", "cannot tell"),
    ] {
        let cells = row(&walk, recording, axis)?;
        check(cells[ANSWER] == answer && cells[K].starts_with("< "), format!("{recording}, {answer}: {cells:?}"))?;
    }
    Ok(())
}

fn lists() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("list.toml");
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    let read = |text: &str| -> Result<String, Failed> {
        std::fs::write(&path, text)?;
        Ok(recipe::read(&path).map_or_else(|error| error.to_string(), |_| "read".into()))
    };
    let one = list(&[("a", "a.csv")]);
    // Control: as it stands it is read.
    check(read(&one)? == "read", read(&one)?)?;
    for (text, words) in [
        (one.replace("\"gyro\"", "\"../gyro\""), "cannot name a page"),
        (one.replace("\"gyro\"", "\"random-walk\""), "cannot name a page"),
        (format!("{one}{one}"), "another set has the same id"),
        (format!("{one}rows = [50, 20]\n"), "end before they begin"),
        (format!("{one}rows = [20, 50]\n"), "nothing diagnoses the log at rest `a`"),
        (one.replace("model.toml", "absent.toml"), "absent.toml"),
    ] {
        let said = read(&text)?;
        check(said.contains(words), format!("{words}: {said}"))?;
    }
    // Recordings that are not there are named before any work, and nothing is written.
    std::fs::write(&path, &one)?;
    let out = folder.path().join("atlas");
    let mut run = program();
    let run = run.args(["trial", "--atlas"]).arg(&path).arg("--out").arg(&out).env("PROOFMASS_DATA", folder.path());
    let run = run.output()?;
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    check(run.status.code() == Some(2) && said.contains("a.csv is not in"), said)?;
    check(!out.join("README.md").exists(), "pages were written")
}

// The README of the data says of it: Xsens DOT at 120 Hz, two minutes, levelled by hand.
fn two_minutes(data: &Path) -> Result<(), Failed> {
    let [page, walk] = made(&list(&[("unit 1", "fleet/unit_1.csv")]), data)?;
    check(page.contains("| 120 Hz | 2.01 min |"), &page)?;
    let first = walk.lines().nth(2).unwrap_or_default();
    check(first.starts_with("**These logs cannot tell whether gyros have a random walk.**"), first)?;
    let allan = program().arg("allan").arg(data.join("fleet/unit_1.csv")).arg("--json").output()?;
    let allan: serde_json::Value = serde_json::from_slice(&allan.stdout)?;
    let channels = allan["channels"].as_array().ok_or("channels")?;
    check(channels.len() == 6, format!("{} channels", channels.len()))?;
    for channel in channels {
        let name = channel["name"].as_str().ok_or("a name")?;
        let k = channel["terms"].as_array().and_then(|t| t.iter().find(|t| t["symbol"] == "K")).ok_or("K")?;
        check(k["supported"] == false, format!("{name} has a walk"))?;
        let limit = format!("< {} ", significant(k["ci95"][1].as_f64().ok_or("an end")?, 2));
        let cells = row(&walk, "unit 1", name)?;
        check(cells[K].starts_with(&limit) && cells[ANSWER] == "cannot tell", format!("{limit}: {cells:?}"))?;
    }
    // No reading of the file is on its page: the first row's have seven digits and more.
    let text = std::fs::read_to_string(data.join("fleet/unit_1.csv"))?;
    let mut readings = text.lines().skip(1).take(100).flat_map(|l| l.split(',').skip(1)).filter(|r| r.len() > 6);
    check(readings.all(|reading| !page.contains(reading)), "a reading is on the page")
}
