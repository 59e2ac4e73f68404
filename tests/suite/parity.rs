//! CPU and GPU agree, and both follow the closed forms.

use libtest_mimic::Trial;
use proofmass::backend::gpu::Gpu;
use proofmass::validation::jobs::Place;
use proofmass::validation::{closed_form, parity};

use super::law::all_hold;
use super::world::{check, gpu_test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        gpu_test("parity: percentiles of every integrator, CPU and GPU", || {
            all_hold(&parity::rows(&mut Place::gpu()?)?)
        }),
        gpu_test("parity: every error source grows by its closed form on the GPU", || {
            all_hold(&closed_form::rows(&mut Place::gpu()?)?)
        }),
        gpu_test("parity: compensated sums are alive on this adapter", || {
            let got = Gpu::open(false)?.compensation()?;
            check(got[0] == 0.0, format!("a plain sum kept what f32 must lose: {got:?}"))?;
            check(got[1] == 1.0, format!("the compensated sum lost it: {got:?}"))
        }),
    ]
}
