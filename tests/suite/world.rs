//! What this machine offers to tests: the data folder, the binary, and how absence is shown.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::tiers::timed;

/// A plain test.
pub fn test(name: &str, body: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    timed(name.to_owned(), body)
}

/// The folder of real recordings: `PROOFMASS_DATA`, else `../shared/data` beside the checkout.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("PROOFMASS_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// A test on real recordings: ignored where the folder is absent, a failure where
/// `PROOFMASS_REQUIRE_DATA=1` demands it.
pub fn data_test(name: &str, body: impl FnOnce(&Path) -> Result<(), Failed> + Send + 'static) -> Trial {
    match data() {
        Some(folder) => timed(name.to_owned(), move || body(&folder)),
        None if std::env::var_os("PROOFMASS_REQUIRE_DATA").is_some() => Trial::test(name, || {
            Err("PROOFMASS_REQUIRE_DATA is set and there is no data folder (PROOFMASS_DATA)".into())
        }),
        None => {
            Trial::test(format!("{name} (needs recordings: set PROOFMASS_DATA)"), || Ok(())).with_ignored_flag(true)
        }
    }
}

/// A test on a GPU adapter, software ones included: ignored where there is none, a failure where
/// `PROOFMASS_REQUIRE_GPU=1` demands one.
pub fn gpu_test(name: &str, body: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    static PRESENT: std::sync::OnceLock<bool> = std::sync::OnceLock::new();
    let present = *PRESENT.get_or_init(|| !proofmass::backend::gpu::list().is_empty());
    if present || std::env::var_os("PROOFMASS_REQUIRE_GPU").is_some() {
        return timed(name.to_owned(), body);
    }
    Trial::test(format!("{name} (needs an adapter: install mesa-vulkan-drivers)"), || Ok(())).with_ignored_flag(true)
}

/// Fails with a sentence unless `holds`.
pub fn check(holds: bool, sentence: impl Into<String>) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(sentence.into().into()) }
}

/// Fails unless `got` is within `tolerance` of `expected`; NaN fails.
pub fn near(what: &str, got: f64, expected: f64, tolerance: f64) -> Result<(), Failed> {
    check((got - expected).abs() <= tolerance, format!("{what}: got {got:e}, expected {expected:e} ± {tolerance:e}"))
}

/// Tests of this module: the helpers that every other test leans on fail where they must.
pub fn tests() -> Vec<Trial> {
    vec![test("world: `near` and `check` pass what holds and fail what does not, NaN included", helpers)]
}

fn helpers() -> Result<(), Failed> {
    let (nan, infinity) = (f64::NAN, f64::INFINITY);
    near("inside", 1.05, 1.0, 0.1)?;
    near("on the edge", 1.5, 1.0, 0.5)?;
    near("exact", 0.0, -0.0, 0.0)?;
    check(true, "holds")?;
    let refused = [
        ("outside", near("", 1.2, 1.0, 0.1)),
        ("outside, below", near("", 0.8, 1.0, 0.1)),
        ("just outside", near("", 1.5f64.next_up(), 1.0, 0.5)),
        ("got NaN", near("", nan, 1.0, 0.1)),
        ("expected NaN", near("", 1.0, nan, 0.1)),
        ("NaN met by NaN", near("", nan, nan, infinity)),
        ("a tolerance of NaN", near("", 1.0, 1.0, nan)),
        ("a negative tolerance", near("", 1.0, 1.0, -0.1)),
        ("infinity met by infinity", near("", infinity, infinity, infinity)),
        ("what does not hold", check(false, "")),
    ];
    match refused.iter().find(|(_, result)| result.is_ok()) {
        Some((what, _)) => Err(format!("{what} passes").into()),
        None => Ok(()),
    }
}

/// The built program.
pub fn program() -> std::process::Command {
    std::process::Command::new(env!("CARGO_BIN_EXE_proofmass"))
}
