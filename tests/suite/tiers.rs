//! Three tiers of tests, and what each test takes.
//!
//! T0 are the unit tests of each crate, T1 the laws, files, commands and pages of this suite, T2 its
//! campaigns: many verdicts each. Of T2 a plain `cargo test` runs a quarter, chosen by name and so
//! always the same one; `PROOFMASS_ALL=1`, or a filter that asks for tests by name, runs all. A
//! defect that fails a share p of the campaigns' tests is missed by n of them with probability
//! (1 - p)ⁿ: with n = 40, one that fails a tenth in 1.5 % of runs.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};

/// One test in this many of a campaign runs unasked.
const SAMPLE: u64 = 4;

/// Time after which a test is called slow, with two busy cores.
const BUDGET: Duration = Duration::from_secs(60);

static TAKEN: Mutex<BTreeMap<String, Duration>> = Mutex::new(BTreeMap::new());

/// A test whose time is kept.
pub fn timed(name: String, body: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    let of = name.clone();
    Trial::test(name, move || {
        let begun = Instant::now();
        let result = body();
        if let Ok(mut taken) = TAKEN.lock() {
            taken.insert(of, begun.elapsed());
        }
        result
    })
}

/// The tests of campaigns, of which all but a sample are ignored unless `all` are asked for.
pub fn campaigns(tests: Vec<Trial>, all: bool) -> Vec<Trial> {
    let is_kept = |name: &str| hash(name).is_multiple_of(SAMPLE);
    tests
        .into_iter()
        .map(|test| if all || is_kept(test.name()) { test } else { test.with_ignored_flag(true) })
        .collect()
}

/// The FNV-1a hash of a name (Fowler, Noll, Vo).
fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)) >> 16
}

/// The slowest tests of this run, slowest first, and those beyond the budget.
pub fn slowest() -> String {
    let taken = TAKEN.lock().map(|t| t.clone()).unwrap_or_default();
    let mut all: Vec<(&String, &Duration)> = taken.iter().collect();
    all.sort_by(|a, b| b.1.cmp(a.1));
    let lines = all.iter().take(10).map(|(name, time)| {
        let over = if **time > BUDGET { " over the budget of 60 s" } else { "" };
        format!("{:7.1} s  {name}{over}\n", time.as_secs_f64())
    });
    format!("\nthe slowest tests:\n{}", lines.collect::<String>())
}
