//! Random numbers and error growth follow their laws on the CPU, and the controls of these checks
//! fail.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::validation::jobs::Place;
use proofmass::validation::{Row, closed_form, randomness};

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("law: random numbers have their distribution", || all_hold(&randomness::rows())),
        test("law: every error source grows by its closed form on the CPU", || {
            all_hold(&closed_form::rows(&mut Place::cpu(&Control::silent()))?)
        }),
    ]
}

/// Fails with the first row that does not hold.
pub fn all_hold(rows: &[Row]) -> Result<(), Failed> {
    check(!rows.is_empty(), "no rows")?;
    match rows.iter().find(|r| !r.holds) {
        None => Ok(()),
        Some(r) => Err(format!("{}: got {:e}, expected {:e} ± {:e}", r.what, r.got, r.expected, r.tolerance).into()),
    }
}
