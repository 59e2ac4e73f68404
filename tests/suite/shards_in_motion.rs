//! A study along a trajectory divided among machines: its shards merge to the bits of one run, and
//! what is no part of it is refused by name. Digits are stated of its horizontal error.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::{Answer, run};
use super::shards::done;
use super::world::{check, gpu_test, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "shards in motion: any partition, in any order and on any number of threads, merges to the bits of one run",
            || partitions("cpu"),
        ),
        gpu_test("shards in motion: shards of a GPU merge to the bits of that GPU's run", || partitions("gpu")),
        test("shards in motion: missing, foreign and damaged shards are refused by name, and one is resumed", refused),
        test("shards in motion: a shard that is killed half-way resumes and merges to the same bits", killed),
        test("shards in motion: poses of a file are those of the shards, from whatever folder they are merged", poses),
        test("shards in motion: digits are stated of the horizontal error, with as many members as they take", digits),
    ]
}

/// An ensemble whose last block is short.
const STUDY: &str = "name = \"drive\"\nmembers = 1700\nduration_s = 3.0\n[sensor]\nsample_rate_hz = 100.0\n[trajectory]\n\
                     kind = \"circle\"\n[earth]\nlatitude_deg = 47.4\nheight_m = 400.0\n[accelerometer]\n\
                     noise_density_ug_rthz = 100.0\nbias_mg = { mean = 0.0, sd = 1.0 }\n[gyro]\n\
                     bias_instability_deg_h = 8.0\nscale_factor_ppm = { mean = 0.0, sd = 500.0 }\n[alignment]\n\
                     kind = \"still\"\nstill_s = 1.0\n[report]\ntimes_s = [1.0, 3.0]\n";

struct World {
    folder: tempfile::TempDir,
    backend: &'static str,
}

impl World {
    fn new(backend: &'static str) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("study.toml"), STUDY)?;
        Ok(Self { folder, backend })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn study(&self, out: &str, more: &[&str]) -> Command {
        let mut command = program();
        command.args(["--json", "study"]).arg(self.path("study.toml")).arg("--out").arg(self.path(out));
        command.args(["--backend", self.backend]).args(more);
        command
    }

    fn merge(&self, folder: &str) -> Result<Answer, Failed> {
        run(program()
            .args(["--json", "merge"])
            .arg(self.path(folder))
            .arg("--out")
            .arg(self.path("merged"))
            .arg("--force"))
    }
}

/// Everything but where it ran and how long.
fn fields(answer: Answer) -> Result<Value, Failed> {
    let mut document = answer.json()?;
    for field in ["seconds", "backend", "shards"] {
        document.as_object_mut().and_then(|fields| fields.remove(field));
    }
    Ok(document)
}

fn partitions(backend: &'static str) -> Result<(), Failed> {
    let world = World::new(backend)?;
    let whole = fields(run(&mut world.study("whole", &[]))?)?;
    // Seven blocks: of nine shards, two have nothing to do.
    for of in [1, 3, 9] {
        let out = format!("of-{of}");
        for number in (1..=of).rev() {
            let mut command = world.study(&out, &["--shard", &format!("{number}/{of}")]);
            let said = run(command.env("RAYON_NUM_THREADS", (1 + number % 3).to_string()))?.json()?;
            check(said["shard"] == number && said["of"] == of, format!("{said}"))?;
        }
        let merged = world.merge(&out)?;
        check(merged.json()?["shards"] == of, "the number of shards is not stated")?;
        let merged = fields(merged)?;
        check(merged == whole, format!("of {of}: other numbers than one run's\n{merged}\n{whole}"))?;
        check(world.path("merged/report.html").exists(), "no page")?;
    }
    // Control: another seed is another answer.
    let other = fields(run(&mut world.study("other", &["--seed", "2"]))?)?;
    check(other["horizontal_error_m"] != whole["horizontal_error_m"], "the comparison is blind")
}

fn refused() -> Result<(), Failed> {
    let world = World::new("cpu")?;
    let shard = |k: &str, out: &str, more: &[&str]| run(&mut world.study(out, &[&["--shard", k], more].concat()));
    for k in ["1/3", "3/3"] {
        check(shard(k, "some", &[])?.code == Some(0), k)?;
    }
    world.merge("some")?.refuses("a gap", "shard-2-of-3.state")?;
    shard("2/3", "some", &["--resume"])?.refuses("nothing to resume", "no interrupted run")?;
    check(shard("2/3", "some", &["--seed", "5"])?.code == Some(0), "another seed")?;
    world.merge("some")?.refuses("another run", "belongs to another run")?;
    shard("2/3", "some", &["--resume"])?.refuses("another run", "belongs to another run")?;
    check(shard("2/3", "some", &[])?.code == Some(0), "the right seed")?;
    // One that is done has nothing left to do, and stays as it is.
    let state = world.path("some/shard-2-of-3.state");
    let before = fields(world.merge("some")?)?;
    check(shard("2/3", "some", &["--resume"])?.code == Some(0), "resumed")?;
    check(fields(world.merge("some")?)? == before, "a resumed shard has other numbers")?;
    let mut bytes = std::fs::read(&state)?;
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&state, bytes)?;
    world.merge("some")?.refuses("a flipped bit", "shard-2-of-3.state")
}

/// Numbers of members: the first whose shard takes long enough to be killed here is taken.
const MEMBERS: [&str; 3] = ["60000", "240000", "960000"];

fn killed() -> Result<(), Failed> {
    for members in MEMBERS {
        let world = World::new("cpu")?;
        let state = world.path("halves/shard-1-of-2.state");
        let mut command = world.study("halves", &["--members", members, "--shard", "1/2"]);
        command.env("PROOFMASS_STATE_INTERVAL_S", "0.0").stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        while child.try_wait()?.is_none() && (!state.exists() || done(&state) == 0) {
            std::thread::sleep(Duration::from_millis(2));
        }
        child.kill()?;
        let kept = if child.wait()?.success() { 0 } else { done(&state) };
        let other = run(&mut world.study("halves", &["--members", members, "--shard", "2/2"]))?;
        check(other.code == Some(0), other.stderr)?;
        // Both halves have one size: a run that was finished before it was killed shows nothing.
        if kept == 0 || kept == done(&world.path("halves/shard-2-of-2.state")) {
            continue;
        }
        world.merge("halves")?.refuses("an unfinished shard", "shard-1-of-2.state")?;
        let resumed = run(&mut world.study("halves", &["--members", members, "--shard", "1/2", "--resume"]))?;
        check(resumed.code == Some(0), resumed.stderr)?;
        let whole = fields(run(&mut world.study("whole", &["--members", members]))?)?;
        return check(fields(world.merge("halves")?)? == whole, "a resumed shard has other numbers");
    }
    Err("no shard was long enough to be killed".into())
}

fn poses() -> Result<(), Failed> {
    let world = World::new("cpu")?;
    // Level, along a gentle curve: time, position, quaternion (TUM).
    let poses = |turn: f64| -> String {
        let pose = |i: i32| {
            let t = f64::from(i) * 0.02;
            format!("{t:.2} {:.9} {:.9} 0.0 0.0 0.0 0.0 1.0\n", 20.0 * (turn * t).sin(), 3.0 * (0.2 * t).cos())
        };
        (0..500).map(pose).collect()
    };
    let study =
        STUDY.replace("kind = \"circle\"", "kind = \"file\"\nfile = \"poses.txt\"\nformat = \"tum\"\nup = \"z\"");
    std::fs::write(world.path("study.toml"), study)?;
    std::fs::write(world.path("poses.txt"), poses(0.3))?;
    let whole = fields(run(&mut world.study("whole", &[]))?)?;
    for k in ["1/2", "2/2"] {
        let mut command = program();
        command.current_dir(world.folder.path()).args([
            "--json",
            "study",
            "study.toml",
            "--out",
            "halves",
            "--shard",
            k,
        ]);
        let answer = run(command.args(["--backend", "cpu"]))?;
        check(answer.code == Some(0), format!("{k}: {}", answer.stderr))?;
    }
    let merged = fields(world.merge("halves")?)?;
    check(merged == whole, format!("other numbers than one run's\n{merged}\n{whole}"))?;
    // Control: other poses are another study, which the shards do not belong to.
    std::fs::write(world.path("poses.txt"), poses(0.31))?;
    world.merge("halves")?.refuses("other poses", "poses.txt")
}

fn digits() -> Result<(), Failed> {
    let world = World::new("cpu")?;
    let document = run(&mut world.study("digits", &["--digits", "1"]))?.json()?;
    let stated = &document["jcgm101"];
    let number = |value: &Value| value.as_f64().ok_or_else(|| Failed::from(format!("no number: {stated}")));
    let members = number(&document["members"])?;
    // JCGM 101 7.9.4: blocks of ten thousand and more.
    check(members >= 10_240.0 && number(&stated["trials"])? == members, format!("{members} members: {stated}"))?;
    let last = |name: &str| number(&document["horizontal_error_m"][name][1]);
    let ends = &stated["interval95"]["symmetric"];
    check(number(&ends[0])? < last("cep50")? && last("cep50")? < number(&ends[1])?, format!("{stated}"))?;
    // The mean square of a distance is its squared mean and its variance; cep95 lies below the
    // interval's upper end, 97.5 %.
    check(last("cep95")? < number(&ends[1])?, format!("{stated}"))?;
    near("estimate over the median", number(&stated["estimate"])? / last("cep50")?, 1.0, 0.15)?;
    // Control: without digits nothing is stated.
    let plain = run(&mut world.study("plain", &[]))?.json()?;
    check(plain.get("jcgm101").is_none(), "stated without being asked")
}
