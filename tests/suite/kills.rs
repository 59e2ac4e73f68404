//! Kills and stops at any instant: a run goes on from what was kept, comes further every time, and
//! ends with the bits of a run that nobody disturbed.
//!
//! `PROOFMASS_KILLS=200` makes a campaign of the twelve kills that every run of the suite makes.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Mutex;
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    if !cfg!(unix) {
        return Vec::new();
    }
    let mut all = vec![test("kills: a study that is killed again and again ends with the same bits", killed)];
    for burst in BURSTS {
        let name = format!("kills: {} within milliseconds keep what was done", burst.join(" and "));
        all.push(test(&name, move || stopped(burst)));
    }
    all.push(test("kills: SIGTERM and Ctrl-C end what reads and what diagnoses within two seconds", ended_at_once));
    if Command::new("timeout").arg("--version").output().is_ok_and(|o| o.status.success()) {
        all.push(test("kills: timeout, which signals twice, keeps what was done", timed_out));
    }
    all
}

/// Signals sent one right after the other: what a closing terminal, a batch system and an impatient
/// script send.
const BURSTS: [&[&str]; 4] = [&["TERM", "HUP"], &["HUP", "TERM", "TERM"], &["INT", "INT"], &["INT", "TERM"]];

/// Some seconds of work in several parts: an ensemble with mechanics, and its error budget.
const STUDY: &str = "name = \"long\"\nmembers = 9000\nduration_s = 30.0\n[sensor]\nsample_rate_hz = 1000.0\n\
                     resonance_hz = 300.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\nbias_instability_ug = 40.0\n\
                     acceleration_random_walk_ug_rts = 5.0\n[gyro]\nangle_random_walk_deg_rth = 0.2\n\
                     bias_instability_deg_h = 5.0\n[excitation]\nkind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 3.0\n";

/// Work between two states: short, but long beside what it takes to write some megabytes.
const INTERVAL_S: &str = "0.15";

/// A folder with the study.
struct World(tempfile::TempDir);

impl World {
    fn new() -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("study.toml"), STUDY)?;
        Ok(Self(folder))
    }

    fn out(&self) -> PathBuf {
        self.0.path().join("out")
    }

    fn arguments(&self, resume: bool) -> Vec<String> {
        let [study, out] = [self.0.path().join("study.toml"), self.out()].map(|path| path.display().to_string());
        let mut arguments = ["--json", "study", &study, "--out", &out, "--backend", "cpu"].map(str::to_owned).to_vec();
        arguments.extend(resume.then(|| "--resume".to_owned()));
        arguments
    }

    fn start(&self, resume: bool) -> Result<Child, Failed> {
        let mut command = program();
        command.args(self.arguments(resume)).env("PROOFMASS_STATE_INTERVAL_S", INTERVAL_S);
        Ok(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?)
    }

    /// Whether there is something to go on from.
    fn has_state(&self) -> bool {
        self.out().join("interrupted-1.json").exists()
    }

    /// Member-samples that the states hold, over all parts.
    fn done(&self) -> Result<u64, Failed> {
        let mut done = 0;
        for part in 1..100 {
            let Ok(bytes) = std::fs::read(self.out().join(format!("interrupted-{part}.json"))) else { break };
            let state: Value = serde_json::from_slice(&bytes).map_err(|e| format!("half a state: {e}"))?;
            let number = |value: &Value| value.as_u64().unwrap_or(0);
            let batch = &state["under_way"][1];
            let members = number(&batch["members"]["end"]) - number(&batch["members"]["start"]);
            // The pilot counts by itself: its members are integrated once more.
            let pilot = if state["bins"].as_array().is_some_and(|b| !b.is_empty()) { 1024 * 30_000 } else { 0 };
            done += pilot + number(&state["next_member"]) * 30_000 + members * number(&batch["samples"]);
        }
        Ok(done)
    }
}

fn ended(output: &Output) -> Result<Value, Failed> {
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    document.as_object_mut().and_then(|fields| fields.remove("seconds"));
    Ok(document)
}

/// The answer of a run that nobody disturbs, made once.
fn undisturbed() -> Result<Value, Failed> {
    static ANSWER: Mutex<Option<Value>> = Mutex::new(None);
    let mut answer = ANSWER.lock().map_err(|e| e.to_string())?;
    if let Some(known) = &*answer {
        return Ok(known.clone());
    }
    let output = program().args(World::new()?.arguments(false)).output()?;
    Ok(answer.insert(ended(&output)?).clone())
}

/// Nothing half-written stands where a reader looks.
fn whole(folder: &Path) -> Result<(), Failed> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let text = std::fs::read_to_string(&path)?;
        let is_whole = match path.extension().and_then(|e| e.to_str()) {
            _ if name.starts_with('.') => true,
            Some("json") => serde_json::from_str::<Value>(&text).is_ok(),
            Some("html") => text.trim_end().ends_with("</html>"),
            Some("svg") => text.trim_end().ends_with("</svg>"),
            _ => true,
        };
        check(is_whole, format!("{name} is half-written"))?;
    }
    Ok(())
}

fn killed() -> Result<(), Failed> {
    let expected = undisturbed()?;
    let wanted: usize = std::env::var("PROOFMASS_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let (mut kills, mut chains, mut delay_ms) = (0, 0, 40);
    while kills < wanted {
        let (world, mut before) = (World::new()?, 0);
        let mut grown = 0;
        loop {
            let mut child = world.start(world.has_state())?;
            // Instants spread over the run: the golden section of 400 ms, and what a machine under
            // load adds.
            delay_ms = (delay_ms + 247) % 400;
            std::thread::sleep(Duration::from_millis(60 + delay_ms));
            if kills >= wanted || child.try_wait()?.is_some() {
                let output = child.wait_with_output()?;
                check(ended(&output)? == expected, format!("other numbers after {kills} kills"))?;
                check(!world.has_state(), "a finished run leaves its state behind")?;
                break;
            }
            child.kill()?;
            child.wait()?;
            kills += 1;
            if !world.out().exists() {
                continue;
            }
            whole(&world.out())?;
            // It was finished in the instant before it was killed: its state is gone as its report
            // stands.
            if before > 0 && !world.has_state() {
                check(world.out().join("report.html").exists(), "neither a state nor a report")?;
                break;
            }
            let now = world.done()?;
            check(now >= before, format!("{before} member-samples were kept, and after another kill {now}"))?;
            grown += u32::from(now > before);
            before = now;
        }
        chains += 1;
        check(grown > 0 || before == 0, "no run came further than the one before")?;
    }
    eprintln!("{kills} kills in {chains} chains, each finished with the same bits");
    Ok(())
}

/// Waits until something is kept that can be lost.
fn begun(world: &World, child: &mut Child) -> Result<(), Failed> {
    for _ in 0..12_000 {
        if world.has_state() {
            return Ok(());
        }
        check(child.try_wait()?.is_none(), "it ended before anything was kept")?;
        std::thread::sleep(Duration::from_millis(5));
    }
    Err("nothing was kept for a minute".into())
}

fn code_of(signal: &str) -> i32 {
    match signal {
        "INT" => 130,
        "TERM" => 143,
        _ => 129,
    }
}

fn goes_on(world: &World, code: Option<i32>, expected_code: i32, message: &str) -> Result<(), Failed> {
    check(code == Some(expected_code), format!("exit {code:?}, not {expected_code}: {message}"))?;
    check(message.contains("--resume"), format!("it does not say how to go on: {message}"))?;
    check(world.done()? > 0, "nothing was kept")?;
    whole(&world.out())?;
    let resumed = ended(&world.start(true)?.wait_with_output()?)?;
    check(resumed == undisturbed()?, "resumed and undisturbed answers differ")
}

fn stopped(burst: &[&str]) -> Result<(), Failed> {
    let world = World::new()?;
    let mut child = world.start(false)?;
    begun(&world, &mut child)?;
    let process = child.id();
    let kills: Vec<String> = burst.iter().map(|signal| format!("kill -{signal} {process}")).collect();
    Command::new("sh").args(["-c", &kills.join("; sleep 0.002; ")]).status()?;
    let output = child.wait_with_output()?;
    // The first one that the process hears is the one it answers to.
    let code = output.status.code();
    let expected = burst.iter().map(|signal| code_of(signal)).find(|c| code == Some(*c)).unwrap_or(-1);
    goes_on(&world, code, expected, &String::from_utf8_lossy(&output.stderr))
}

fn timed_out() -> Result<(), Failed> {
    // The first time limit in which something is kept, on a machine of any speed.
    for limit_s in ["0.7", "1.5", "4", "12"] {
        let world = World::new()?;
        let mut command = Command::new("timeout");
        command.arg(limit_s).arg(env!("CARGO_BIN_EXE_proofmass")).args(world.arguments(false));
        let output = command.env("PROOFMASS_STATE_INTERVAL_S", INTERVAL_S).output()?;
        if world.has_state() {
            // 124: what `timeout` says of a command that it has stopped.
            return goes_on(&world, output.status.code(), 124, &String::from_utf8_lossy(&output.stderr));
        }
        check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    }
    Err("no time limit caught the run in the act".into())
}

/// Longest time from a signal to the end of the process.
const AT_ONCE: Duration = Duration::from_secs(2);

/// A mass on two wells that is driven to chaos (Duffing's equation, by the classical method of Runge
/// and Kutta): force and position, ten rows a second.
fn chaos() -> String {
    let rates = |t: f64, [x, v]: [f64; 2]| [v, -0.3 * v + x - x.powi(3) + 0.5 * (1.2 * t).cos()];
    let (step, mut t, mut state) = (0.01, 0.0f64, [0.1, 0.0]);
    let mut text = String::from("force,position\n");
    for _ in 0..6000 {
        text += &format!("{:.9},{:.9}\n", 0.5 * (1.2 * t).cos(), state[0]);
        for _ in 0..10 {
            let moved = |rate: [f64; 2], share: f64| [0, 1].map(|i| state[i] + share * step * rate[i]);
            let a = rates(t, state);
            let b = rates(t + step / 2.0, moved(a, 0.5));
            let c = rates(t + step / 2.0, moved(b, 0.5));
            let d = rates(t + step, moved(c, 1.0));
            state = [0, 1].map(|i| state[i] + step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            t += step;
        }
    }
    text
}

/// Commands in the midst of their work: on standard input that does not end, and in a search that
/// takes minutes.
fn ended_at_once() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [log, model, out] = ["chaos.csv", "model.toml", "out"].map(|name| folder.path().join(name));
    std::fs::write(&log, chaos())?;
    let columns = "[columns]\ninput = \"force\"\noutput = \"position\"\n";
    std::fs::write(&model, format!("kind = \"driven\"\nrate_hz = 10.0\n{columns}"))?;
    let [log, model, out] = [&log, &model, &out].map(|path| path.display().to_string());
    let diagnose = ["diagnose", &log, "--model", &model, "--out", &out];
    let commands: [&[&str]; 3] = [&["inspect", "-"], &["allan", "-", "--rate-hz", "10"], &diagnose];
    for (words, (signal, code)) in
        commands.into_iter().flat_map(|words| [("TERM", 143), ("INT", 130)].map(|signal| (words, signal)))
    {
        let mut command = program();
        let mut child =
            command.args(words).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        // Standard input stays open.
        let input = child.stdin.take();
        std::thread::sleep(Duration::from_secs(1));
        check(child.try_wait()?.is_none(), format!("{words:?} has ended before it was stopped"))?;
        let sent = std::time::Instant::now();
        check(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status()?.success(), "kill")?;
        let ended = child.wait()?;
        let took = sent.elapsed();
        drop(input);
        check(ended.code() == Some(code), format!("{words:?}: SIG{signal} ends it with {ended}, expected {code}"))?;
        check(took < AT_ONCE, format!("{words:?}: SIG{signal} ends it after {took:?}"))?;
    }
    Ok(())
}
