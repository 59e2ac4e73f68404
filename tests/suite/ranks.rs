//! Several copies started at once: ranks of `mpirun` share a study where the program is built with
//! MPI, and are refused where it is not.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::run;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    if with_mpi().is_none() {
        return vec![
            test("ranks: a program without MPI refuses to do the same work once for each rank", refused),
            Trial::test("ranks: an MPI run (needs MPI: cargo test --features mpi)", || Ok(())).with_ignored_flag(true),
        ];
    }
    if !Command::new("mpirun").arg("--version").output().is_ok_and(|o| o.status.success()) {
        return vec![
            Trial::test("ranks: an MPI run (needs mpirun: install openmpi-bin)", || Ok(())).with_ignored_flag(true),
        ];
    }
    vec![
        test("ranks: any number of ranks gives one run's bits, and leaves states that merge", shared),
        test("ranks: an error is told once, with exit code 2", told_once),
        test("ranks: a rank that is killed ends the run, which goes on with another number of ranks", killed),
    ]
}

/// The program built with MPI: the one of this build, or the one named in `PROOFMASS_MPI`.
fn with_mpi() -> Option<PathBuf> {
    let own = cfg!(feature = "mpi").then(|| env!("CARGO_BIN_EXE_proofmass").into());
    own.or_else(|| std::env::var_os("PROOFMASS_MPI").map(PathBuf::from))
}

const STUDY: &str = "name = \"ranks\"\nmembers = 3000\nduration_s = 2.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n\
                     bias_mg = { mean = 0.0, sd = 1.0 }\n[gyro]\nangle_random_walk_deg_rth = 0.3\n";

fn refused() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("study.toml"), STUDY)?;
    let study = |size: [&str; 2], more: &[&str]| {
        let mut command = program();
        command.args(["--json", "study"]).arg(folder.path().join("study.toml")).args(["--backend", "cpu", "--out"]);
        run(command.arg(folder.path().join("out")).args(more).env(size[0], size[1]))
    };
    for launcher in ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"] {
        study([launcher, "4"], &[])?.refuses(launcher, "built without MPI")?;
        check(!folder.path().join("out").exists(), "a refused run left a folder behind")?;
    }
    // One rank is no reason, and shards are divided already.
    check(study(["OMPI_COMM_WORLD_SIZE", "1"], &[])?.code == Some(0), "one rank")?;
    check(study(["PMI_SIZE", "4"], &["--shard", "1/4"])?.code == Some(0), "a shard")
}

struct World {
    folder: tempfile::TempDir,
}

impl World {
    fn new(text: &str) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("study.toml"), text)?;
        Ok(Self { folder })
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn arguments(&self, out: &Path) -> Vec<String> {
        let study = self.folder.path().join("study.toml").display().to_string();
        let out = out.display().to_string();
        ["--json", "study", &study, "--backend", "cpu", "--out", &out].map(str::to_owned).into()
    }

    fn whole(&self) -> Result<Value, Failed> {
        let answer = run(program().args(self.arguments(&self.folder.path().join("whole"))))?;
        fields(answer.json()?)
    }

    fn ranks(&self, number: u32, more: &[&str]) -> Command {
        let mut command = Command::new("mpirun");
        command.args(["--oversubscribe", "--bind-to", "none", "-n", &number.to_string()]);
        command.arg(with_mpi().unwrap_or_default()).args(self.arguments(&self.out())).args(more);
        // Containers run tests as root.
        command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        command.env("RAYON_NUM_THREADS", "1");
        command
    }
}

fn fields(mut document: Value) -> Result<Value, Failed> {
    for field in ["seconds", "backend", "out", "shards"] {
        document.as_object_mut().and_then(|fields| fields.remove(field));
    }
    Ok(document)
}

fn answer(output: &Output) -> Result<Value, Failed> {
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    fields(serde_json::from_slice(&output.stdout)?)
}

fn shared() -> Result<(), Failed> {
    let world = World::new(STUDY)?;
    let whole = world.whole()?;
    for number in [4, 3] {
        let got = answer(&world.ranks(number, &[]).output()?)?;
        check(got == whole, format!("{number} ranks: another answer\n{got}\n{whole}"))?;
        check(world.out().join("report.html").exists(), "no report")?;
        let merged = fields(run(program().args(["--json", "merge"]).arg(world.out()))?.json()?)?;
        check(merged == whole, format!("{number} ranks: states of another answer"))?;
    }
    // Control: another seed is another answer.
    let other = answer(&world.ranks(3, &["--seed", "2"]).output()?)?;
    check(other != whole, "the comparison is blind")?;
    let resumed = world.ranks(2, &["--resume"]).output()?;
    let said = String::from_utf8_lossy(&resumed.stderr);
    check(!resumed.status.success() && said.contains("belongs to another run"), said)
}

fn told_once() -> Result<(), Failed> {
    let world = World::new("name = \"ranks\"\nmembrs = 3\n")?;
    let output = world.ranks(3, &[]).output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    check(output.status.code() == Some(2), format!("{:?} {said}", output.status))?;
    check(said.matches("error: ").count() == 1 && said.contains("did you mean `members`?"), said)
}

/// Members that the states in a folder hold.
fn done(folder: &Path) -> u64 {
    let number = |v: &Value| v.as_u64().unwrap_or(0);
    let of = |path: PathBuf| {
        let text = std::fs::read(path).unwrap_or_default();
        let header = text.split(|b| *b == b'\n').nth(1).unwrap_or_default();
        let header: Value = serde_json::from_slice(header).unwrap_or_default();
        let pieces = header["pieces"].as_array().cloned().unwrap_or_default();
        pieces.iter().map(|p| number(&p["next"]) - number(&p["units"]["start"])).sum::<u64>()
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    entries.filter(|path| path.extension().is_some_and(|e| e == "state")).map(of).sum()
}

fn killed() -> Result<(), Failed> {
    let longer = STUDY.replace("members = 3000", "members = 40000").replace("duration_s = 2.0", "duration_s = 60.0");
    let world = World::new(&longer)?;
    let whole = world.whole()?;
    let mut first = world.ranks(4, &[]);
    first.env("PROOFMASS_STATE_INTERVAL_S", "0.1").stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = first.spawn()?;
    let begun = Instant::now();
    while done(&world.out()) == 0 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(50));
    }
    let ranks = Command::new("pgrep").args(["-P", &child.id().to_string()]).output()?;
    let victim = String::from_utf8_lossy(&ranks.stdout).split_whitespace().last().map(str::to_owned);
    let victim = victim.ok_or("no rank is running")?;
    check(child.try_wait()?.is_none(), "no run was long enough to be killed")?;
    Command::new("kill").args(["-KILL", &victim]).status()?;
    let output = child.wait_with_output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    check(!output.status.success() && said.contains("signal 9"), format!("{:?} {said}", output.status))?;
    check(output.stdout.is_empty() && !world.out().join("report.html").exists(), "a killed run has an answer")?;
    let kept = done(&world.out());
    check(kept > 0, "nothing was kept")?;
    // Two ranks, killed too, then three: each takes its share of what is left.
    for (number, last) in [(2, false), (3, true)] {
        let mut command = world.ranks(number, &["--resume"]);
        command.env("PROOFMASS_STATE_INTERVAL_S", "0.1").stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        if !last {
            std::thread::sleep(Duration::from_millis(1500));
            if child.try_wait()?.is_none() {
                Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
            }
            child.wait_with_output()?;
            check(done(&world.out()) >= kept, "a resumed run lost members")?;
            continue;
        }
        let got = answer(&child.wait_with_output()?)?;
        check(got == whole, format!("another answer after kills\n{got}\n{whole}"))?;
    }
    let merged = fields(run(program().args(["--json", "merge"]).arg(world.out()))?.json()?)?;
    check(merged == whole, "states of another answer")
}
