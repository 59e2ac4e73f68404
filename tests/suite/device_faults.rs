//! Devices that fail: each kind of fault is an error with what was kept, or in `auto` a study that
//! the CPU finishes; never a panic.
//!
//! The faults are made by a small library of our own between the program and Vulkan
//! (`device_faults/vulkan.c`), compiled here. Ignored where there is no C compiler or no Vulkan
//! driver.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, program, test};

/// Kind of fault, and how many calls succeed before it. The first four come in the middle of a run: of
/// this study any card needs seven submissions, as they grow at most fourfold; the last two when the
/// device is opened.
const FAULTS: [&str; 6] = ["submit:5", "wait:12", "alloc:30", "hang:12", "device:0", "pipeline:0"];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let Some(vulkan) = vulkan().filter(|_| has_compiler()) else {
        let name = "device faults: a device that fails (needs cc and a Vulkan driver: install mesa-vulkan-drivers)";
        return vec![Trial::test(name, || Ok(())).with_ignored_flag(true)];
    };
    let of = |fault: &'static str, what: &str, body: fn(&World, &str) -> Result<(), Failed>| {
        let vulkan = vulkan.clone();
        test(&format!("device faults: {fault} {what}"), move || body(&World::new(&vulkan)?, fault))
    };
    let mut all = Vec::new();
    for fault in FAULTS {
        all.push(of(fault, "is an error, and the run goes on from what was kept", asked));
        all.push(of(fault, "in auto: the CPU finishes the study", automatic));
    }
    all.push(of("none", "(control): the device that poses as a card does the study", undisturbed));
    all
}

/// The real Vulkan loader, where it has a driver.
fn vulkan() -> Option<PathBuf> {
    let has_driver = proofmass::backend::gpu::list().iter().any(|adapter| adapter.driver.contains("ulkan"));
    let listed = Command::new("ldconfig").arg("-p").output().ok()?;
    let text = String::from_utf8_lossy(&listed.stdout).into_owned();
    let line = text.lines().find(|line| line.trim_start().starts_with("libvulkan.so.1 "))?;
    let path = PathBuf::from(line.split("=> ").nth(1)?.trim());
    (has_driver && path.exists()).then_some(path)
}

fn has_compiler() -> bool {
    Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success())
}

/// The library that makes faults, compiled once.
fn library() -> Result<&'static Path, Failed> {
    static LIBRARY: OnceLock<Result<tempfile::TempDir, String>> = OnceLock::new();
    let make = || -> Result<tempfile::TempDir, String> {
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/device_faults/vulkan.c");
        let mut compile = Command::new("cc");
        compile
            .args(["-shared", "-fPIC", "-O1", "-o"])
            .arg(folder.path().join("libvulkan.so.1"))
            .arg(source)
            .arg("-ldl");
        let output = compile.output().map_err(|e| e.to_string())?;
        if output.status.success() { Ok(folder) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
    };
    LIBRARY.get_or_init(make).as_ref().map(tempfile::TempDir::path).map_err(|e| e.clone().into())
}

/// A folder with a study, and the library before the real one.
struct World {
    folder: tempfile::TempDir,
    vulkan: PathBuf,
}

/// Work enough for a card, where the processor has one thread, and for some thirty submissions on a
/// software device.
const STUDY: &str = "name = \"faulty\"\nmembers = 4096\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 1000.0\n\
                     [accelerometer]\nnoise_density_ug_rthz = 100.0\nbias_mg = { mean = 0.0, sd = 1.0 }\n\
                     [report]\ntimes_s = [10.0, 60.0]\n";

impl World {
    fn new(vulkan: &Path) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("study.toml"), STUDY)?;
        Ok(Self { folder, vulkan: vulkan.to_owned() })
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Runs the study with a fault.
    fn run(&self, fault: &str, arguments: &[&str]) -> Result<Output, Failed> {
        let mut command = program();
        command.args(["--json", "study"]).arg(self.folder.path().join("study.toml")).arg("--out").arg(self.out());
        command
            .args(arguments)
            .env("LD_LIBRARY_PATH", library()?)
            .env("FAULT_VULKAN", &self.vulkan)
            .env("FAULT", fault);
        command.env("PROOFMASS_GPU_PATIENCE_S", "5").env("PROOFMASS_STATE_INTERVAL_S", "0.2");
        command.env("RAYON_NUM_THREADS", "1");
        if arguments.contains(&"auto") {
            command.env("FAULT_POSE", "1");
        }
        Ok(command.output()?)
    }

    /// The numbers of a run without faults on a backend, made once.
    fn undisturbed(&self, backend: &'static str) -> Result<Value, Failed> {
        static NUMBERS: Mutex<BTreeMap<&str, Value>> = Mutex::new(BTreeMap::new());
        let mut known = NUMBERS.lock().map_err(|e| e.to_string())?;
        if let Some(numbers) = known.get(backend) {
            return Ok(numbers.clone());
        }
        let other = Self::new(&self.vulkan)?;
        let numbers = numbers(other.document("none", &["--backend", backend])?.0);
        Ok(known.entry(backend).or_insert(numbers).clone())
    }

    fn document(&self, fault: &str, arguments: &[&str]) -> Result<(Value, String), Failed> {
        let output = self.run(fault, arguments)?;
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(0), format!("exit {:?}: {message}", output.status.code()))?;
        check(!message.contains("panicked"), message.clone())?;
        Ok((serde_json::from_slice(&output.stdout)?, message))
    }
}

/// All numbers, without where and how long.
fn numbers(mut document: Value) -> Value {
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|name, _| !["seconds", "backend"].contains(&name.as_str()));
    }
    document
}

fn asked(world: &World, fault: &str) -> Result<(), Failed> {
    let output = world.run(fault, &["--backend", "gpu"])?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(2), format!("exit {:?}: {message}", output.status.code()))?;
    check(message.contains("cause:") && !message.contains("panicked"), message.clone())?;
    check(output.stdout.is_empty(), "something was printed as a result")?;
    let kept = world.out().join("interrupted-1.json");
    check(message.contains("--resume") == kept.exists(), format!("kept: {}, but it says: {message}", kept.exists()))?;
    if fault.ends_with(":0") {
        // Nothing was done that could be kept; what an earlier run has left survives a device that
        // cannot be opened.
        check(!kept.exists(), "a state of nothing")?;
        world.run("wait:12", &["--backend", "gpu"])?;
        check(
            world.run(fault, &["--backend", "gpu", "--resume"])?.status.code() == Some(2),
            "it went on without a device",
        )?;
    }
    check(kept.exists(), "no state was left")?;
    let resumed = world.document("none", &["--backend", "gpu", "--resume"])?.0;
    check(numbers(resumed) == world.undisturbed("gpu")?, "the run that went on has other numbers")?;
    check(!kept.exists(), "the finished run left its state behind")
}

fn automatic(world: &World, fault: &str) -> Result<(), Failed> {
    let (got, message) = world.document(fault, &["--backend", "auto"])?;
    check(message.contains("note: ") && message.contains("CPU"), format!("nothing is said of the CPU: {message}"))?;
    // A card gets so few members in one batch, so that all of them come from the CPU: bit for bit.
    check(numbers(got.clone()) == world.undisturbed("cpu")?, "the numbers are not those of the CPU")?;
    let parts = got["backend"]["parts"].as_array().ok_or("the document does not say where members come from")?;
    check(parts.len() == 1 && parts[0]["kind"] == "cpu", format!("{parts:?}"))?;
    check(parts[0]["reason"].as_str().is_some_and(|reason| !reason.is_empty()), "no reason is given")?;
    let page = std::fs::read_to_string(world.out().join("report.html"))?;
    check(page.contains("members by backend"), "the report does not say where members come from")
}

fn undisturbed(world: &World, fault: &str) -> Result<(), Failed> {
    let (got, message) = world.document(fault, &["--backend", "auto"])?;
    check(
        got["backend"]["kind"] == "gpu" && got["backend"]["name"] == "Faulty 1",
        format!("{}: {message}", got["backend"]),
    )?;
    check(numbers(got) != world.undisturbed("cpu")?, "device and CPU give the same bits: the comparison is blind")
}
