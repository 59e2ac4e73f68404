//! Every integrator converges with its order, keeps the static equilibrium, and f32 stays far below
//! the noise.

use libtest_mimic::Trial;
use proofmass::control::Control;
use proofmass::validation::{order, precision};

use super::law::all_hold;
use super::world::test;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("convergence: orders and static equilibrium", || all_hold(&order::rows()?)),
        test("convergence: f32 against f64 over 100 s", || all_hold(&precision::rows(&Control::silent())?)),
    ]
}
