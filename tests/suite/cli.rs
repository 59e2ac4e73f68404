//! The commands answer as the contract says.

use libtest_mimic::Trial;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("cli: help shows examples", || {
        let output = program().arg("--help").output()?;
        check(String::from_utf8_lossy(&output.stdout).contains("Examples:"), "no examples in --help")
    })]
}
