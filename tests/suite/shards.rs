//! Divided runs: shards in any number, order and place merge to the bits of one run, and what does
//! not belong together is refused by name.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::{Answer, run};
use super::world::{check, gpu_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("shards: any partition of a study, in any order, folder and thread count, merges to its bits", partitions),
        test("shards: a study beside a recorded log, with another key set, merges to its bits", beside_a_log),
        test("shards: a merge writes the report, and replaces its own", reports),
        test("shards: overlapping, missing, foreign, damaged and unfinished shards are refused by name", refused),
        test("shards: a shard replaces its own file and nobody else's, one process at a time", owned),
        test("shards: a shard that is not one of N is refused in a sentence", nonsense),
    ];
    if cfg!(unix) {
        all.push(test("shards: a shard that is killed again and again resumes and merges to the same bits", killed));
    }
    all.push(gpu_test("shards: shards of a GPU merge to the bits of that GPU's study", on_a_gpu));
    all
}

/// An ensemble whose last block is short, with an error budget and members of all kinds.
const STUDY: &str = "name = \"small\"\nmembers = 3000\nduration_s = 2.0\n[sensor]\nrange_g = 8.0\n[accelerometer]\n\
                     noise_density_ug_rthz = 100.0\nbias_mg = { mean = 0.0, sd = 1.0 }\n[gyro]\n\
                     angle_random_walk_deg_rth = 0.3\n[alignment]\nkind = \"still\"\nstill_s = 0.5\n\
                     [report]\ntimes_s = [1.0, 2.0]\n";

/// A folder with a study.
struct World {
    folder: tempfile::TempDir,
    more: Vec<String>,
}

impl World {
    fn new(text: &str, more: &[&str]) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("study.toml"), text)?;
        Ok(Self { folder, more: more.iter().map(|s| (*s).to_owned()).collect() })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The command on the study, into a folder.
    fn study(&self, out: &str, more: &[&str]) -> Command {
        let mut command = program();
        command.args(["--json", "study"]).arg(self.path("study.toml")).arg("--out").arg(self.path(out));
        command.args(["--backend", "cpu"]).args(&self.more).args(more);
        command
    }

    fn shard(&self, shard: &str, out: &str) -> Result<Answer, Failed> {
        let answer = run(&mut self.study(out, &["--shard", shard]))?;
        check(answer.code == Some(0), format!("shard {shard}: {}", answer.stderr))?;
        Ok(answer)
    }

    fn merge(&self, folders: &[&str]) -> Result<Answer, Failed> {
        run(program().args(["--json", "merge"]).args(folders.iter().map(|f| self.path(f))))
    }

    fn whole(&self) -> Result<Value, Failed> {
        fields(run(&mut self.study("whole", &[]))?)
    }
}

/// Everything that the contract wants to be the same.
fn fields(answer: Answer) -> Result<Value, Failed> {
    let mut document = answer.json()?;
    for field in ["seconds", "backend", "out", "shards"] {
        document.as_object_mut().and_then(|fields| fields.remove(field));
    }
    Ok(document)
}

fn same(what: &str, got: Value, expected: &Value) -> Result<(), Failed> {
    check(got == *expected, format!("{what}: other numbers than one run's\n{got}\n{expected}"))
}

fn partitions() -> Result<(), Failed> {
    let world = World::new(STUDY, &[])?;
    let whole = world.whole()?;
    for of in [1, 2, 5, 13, 40] {
        let out = format!("of-{of}");
        // From the last to the first, with as many threads as the number says.
        for number in (1..=of).rev() {
            let mut command = world.study(&out, &["--shard", &format!("{number}/{of}")]);
            let answer = run(command.env("RAYON_NUM_THREADS", (1 + number % 4).to_string()))?;
            let said = answer.json()?;
            check(said["shard"] == number && said["of"] == of, format!("{said}"))?;
        }
        let merged = world.merge(&[&out])?;
        check(merged.json()?["shards"] == of, "the number of shards is not stated")?;
        same(&out, fields(merged)?, &whole)?;
    }
    // Half of it as one of two, the rest as two of four, in another folder.
    world.shard("1/2", "left")?;
    world.shard("4/4", "right")?;
    world.shard("3/4", "right")?;
    same("a mixed partition", fields(world.merge(&["right", "left"])?)?, &whole)?;
    // Control: another seed is another answer.
    let other = fields(run(&mut world.study("other", &["--seed", "2"]))?)?;
    check(other["position_error_m"] != whole["position_error_m"], "the comparison is blind")
}

/// A log at rest of two axes, 100 s at 10 Hz: numbers of a linear congruential generator.
fn log() -> String {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    let rows: String = (0..1000).map(|_| format!("{},{}\n", next(), next())).collect();
    format!("ax,gz\n{rows}")
}

fn beside_a_log() -> Result<(), Failed> {
    let compared = "[compare]\nfile = \"log.csv\"\nrate_hz = 10.0\nwindows_s = [2.0, 5.0]\n[[compare.axis]]\ncolumn = \"ax\"\n\
                    scale_mg = 1.0\n[[compare.axis]]\ncolumn = \"gz\"\nscale_deg_s = 0.1\n";
    let text = STUDY.replace("[report]", &format!("{compared}[report]"));
    let world = World::new(&text, &["--set", "accelerometer.bias_mg.sd=2", "--members", "700", "--seed", "9"])?;
    std::fs::write(world.path("log.csv"), log())?;
    let whole = world.whole()?;
    check(whole["windows"].as_array().is_some_and(|w| w.len() == 4), format!("windows: {}", whole["windows"]))?;
    (1..=4).try_for_each(|k| world.shard(&format!("{k}/4"), "shards").map(drop))?;
    same("a study beside a log", fields(world.merge(&["shards"])?)?, &whole)?;
    // A log of another length is another study.
    std::fs::write(world.path("log.csv"), log().lines().take(900).collect::<Vec<_>>().join("\n"))?;
    world.merge(&["shards"])?.refuses("a log that was cut", "log")
}

fn reports() -> Result<(), Failed> {
    let world = World::new(STUDY, &[])?;
    (1..=2).try_for_each(|k| world.shard(&format!("{k}/2"), "shards").map(drop))?;
    let merge = |out: &str| run(program().arg("merge").arg(world.path("shards")).arg("--out").arg(world.path(out)));
    for _ in 0..2 {
        let answer = merge("report")?;
        check(answer.code == Some(0) && answer.stdout.contains("report.html"), answer.stderr)?;
    }
    let page = std::fs::read_to_string(world.path("report/report.html"))?;
    check(page.contains("<svg") && world.path("report/envelope.svg").exists(), "no figure")?;
    // Among the shards is a place for it too.
    check(merge("shards")?.code == Some(0), "a report among the shards")?;
    std::fs::write(world.path("report/report.html"), "mine")?;
    merge("report")?.refuses("a page that was edited", "report.html")
}

fn refused() -> Result<(), Failed> {
    let world = World::new(STUDY, &[])?;
    (1..=3).try_for_each(|k| world.shard(&format!("{k}/3"), "good").map(drop))?;
    let names: Vec<String> = (1..=3).map(|k| format!("shard-{k}-of-3.state")).collect();
    let copy = |to: &str, which: &[usize]| -> Result<(), Failed> {
        std::fs::create_dir_all(world.path(to))?;
        for k in which {
            std::fs::copy(world.path("good").join(&names[*k]), world.path(to).join(&names[*k]))?;
        }
        Ok(())
    };
    check(world.merge(&["good"])?.code == Some(0), "the good ones")?;
    copy("gap", &[0, 2])?;
    world.merge(&["gap"])?.refuses("a gap", &names[1])?;
    // The same shard twice, and one of another partition.
    world.merge(&["good", "gap"])?.refuses("twice", "overlap")?;
    world.shard("1/2", "wide")?;
    world.merge(&["gap", "wide"])?.refuses("overlapping", "shard-1-of-2.state")?;
    // Another seed, another number of members, another study.
    for (nth, more) in [["--seed", "2"], ["--members", "3001"], ["--set", "sensor.range_g=4"]].iter().enumerate() {
        let out = format!("foreign-{nth}");
        copy(&out, &[0, 2])?;
        let answer = run(&mut world.study(&out, &[&["--shard", "2/3"], &more[..]].concat()))?;
        check(answer.code == Some(0), answer.stderr)?;
        let merged = world.merge(&[&out])?;
        merged.refuses("another run", &names[1])?;
        merged.refuses("another run", "belongs to another run")?;
    }
    // A flipped bit anywhere.
    let good = std::fs::read(world.path("good").join(&names[1]))?;
    let header = good.iter().position(|b| *b == b'\n').ok_or("no line")?;
    for at in [0, 30, header + 40, good.len() / 2, good.len() - 1] {
        copy("damaged", &[0, 1, 2])?;
        let mut bad = good.clone();
        bad[at] ^= 1;
        std::fs::write(world.path("damaged").join(&names[1]), bad)?;
        world.merge(&["damaged"])?.refuses(&format!("byte {at} of {}", good.len()), &names[1])?;
    }
    std::fs::write(world.path("damaged").join(&names[1]), &good[..good.len() / 2])?;
    world.merge(&["damaged"])?.refuses("half a file", &names[1])?;
    std::fs::create_dir(world.path("empty"))?;
    world.merge(&["empty"])?.refuses("an empty folder", "no file shard-K-of-N.state")?;
    world.merge(&["nowhere"])?.refuses("no folder", "No such file")
}

fn owned() -> Result<(), Failed> {
    let world = World::new(STUDY, &[])?;
    for more in [&["--shard", "1/2"][..], &["--shard", "1/2", "--seed", "3"]] {
        check(run(&mut world.study("out", more))?.code == Some(0), "the same command on the same input")?;
    }
    let state = world.path("out/shard-1-of-2.state");
    let before = std::fs::read(&state)?;
    std::fs::write(world.path("other.toml"), STUDY)?;
    let mut other = program();
    other.arg("study").arg(world.path("other.toml")).arg("--out").arg(world.path("out")).args(["--shard", "1/2"]);
    run(&mut other)?.refuses("another study", "study.toml")?;
    check(std::fs::read(&state)? == before, "a state was replaced")?;
    check(run(other.arg("--force"))?.code == Some(0), "forced")?;
    std::fs::write(&state, "mine")?;
    run(&mut world.study("out", &["--shard", "1/2"]))?.refuses("a file of the user's", "shard-1-of-2.state")?;
    run(&mut world.study("out", &["--shard", "2/2", "--resume"]))?.refuses("nothing to resume", "no interrupted run")
}

fn nonsense() -> Result<(), Failed> {
    let world = World::new(STUDY, &[])?;
    for wrong in ["0/4", "5/4", "3", "a/b", "1/0"] {
        run(&mut world.study("out", &["--shard", wrong]))?.refuses(wrong, "need K/N")?;
    }
    check(!world.path("out").exists(), "a refused shard left a folder behind")
}

/// How much of a shard its file holds.
pub fn done(state: &Path) -> u64 {
    let text = std::fs::read(state).unwrap_or_default();
    let header = text.split(|b| *b == b'\n').nth(1).unwrap_or_default();
    let header: Value = serde_json::from_slice(header).unwrap_or_default();
    let pieces = header["pieces"].as_array().cloned().unwrap_or_default();
    let number = |v: &Value| v.as_u64().unwrap_or(0);
    pieces.iter().map(|p| number(&p["next"]) - number(&p["units"]["start"])).sum()
}

fn killed() -> Result<(), Failed> {
    // Long enough to be killed more than once on any machine: the first size that is.
    for members in [20_000u64, 100_000, 500_000] {
        if killed_often(members)? {
            return Ok(());
        }
    }
    Err("no run was long enough to be killed".into())
}

/// Kills a shard of a study of this size again and again; `false` where it ended before the second kill.
fn killed_often(members: u64) -> Result<bool, Failed> {
    let text = STUDY.replace("members = 3000", &format!("members = {members}"));
    let text = text.replace("duration_s = 2.0", "duration_s = 20.0");
    let text = text.replace("[alignment]", "bias_instability_deg_h = 4.0\n[alignment]");
    let world = World::new(&text, &[])?;
    world.shard("1/2", "shards")?;
    world.shard("2/2", "undisturbed")?;
    let all = done(&world.path("undisturbed/shard-2-of-2.state"));
    let state = world.path("shards/shard-2-of-2.state");
    let (mut kills, mut seen) = (0, 0);
    for attempt in 0u64.. {
        let mut command = world.study("shards", &["--shard", "2/2"]);
        command.env("PROOFMASS_STATE_INTERVAL_S", "0.05").env("RAYON_NUM_THREADS", "1");
        if state.exists() {
            command.arg("--resume");
        }
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        std::thread::sleep(Duration::from_millis(120 + 67 * (attempt % 7)));
        if child.try_wait()?.is_some() || kills >= 12 {
            let output = child.wait_with_output()?;
            check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
            break;
        }
        child.kill()?;
        child.wait()?;
        kills += 1;
        if state.exists() {
            let now = done(&state);
            check(now >= seen, format!("from {seen} to {now} members: a resumed shard lost some"))?;
            seen = now;
            // It may have been finished in the instant before it was killed.
            if now == all {
                break;
            }
            world.merge(&["shards"])?.refuses("an unfinished shard", "shard-2-of-2.state")?;
        }
    }
    if kills < 2 {
        return Ok(false);
    }
    same("a shard that was killed", fields(world.merge(&["shards"])?)?, &world.whole()?)?;
    Ok(true)
}

fn on_a_gpu() -> Result<(), Failed> {
    let world = World::new(STUDY, &["--backend", "gpu"])?;
    let command = |out: &str, more: &[&str]| {
        let mut command = program();
        command.args(["--json", "study"]).arg(world.path("study.toml")).arg("--out").arg(world.path(out));
        command.args(["--backend", "gpu", "--members", "700"]).args(more);
        run(&mut command)
    };
    let whole = fields(command("whole", &[])?)?;
    for k in 1..=3 {
        let answer = command("shards", &["--shard", &format!("{k}/3")])?;
        check(answer.code == Some(0), answer.stderr)?;
    }
    let merged = world.merge(&["shards"])?;
    check(merged.json()?["backend"]["kind"] == "gpu", "the backend is not stated")?;
    same("shards of a GPU", fields(merged)?, &whole)
}
