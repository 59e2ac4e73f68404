//! Lets a law, written for one mass, act on N masses side by side, lane by lane, in loops that compile to vector instructions.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::numerics::elementary::Real;

use super::law::Law;
use super::state::{Instants, MOST_STAGED, MOST_VALUES};

/// Adds a law's force to the acceleration of N masses and writes the rates of its states.
#[inline(always)]
pub(crate) fn each<L: Law, T: Real, const N: usize, const FMA: bool>(
    law: &L,
    at: &Instants<'_, T, N>,
    p: &[[T; N]],
    own: &[[T; N]],
    rates: &mut [[T; N]],
    acceleration: &mut [T; N],
) {
    let (values, states) = (law.values(), law.states().min(MOST_STAGED));
    // Slices are opened before the loop: a bounds check inside keeps it from becoming vector code.
    let (Some(p), Some(own), Some(rates)) = (p.get(..values), own.get(..states), rates.get_mut(..states)) else {
        return;
    };
    for l in 0..N {
        let (at, p) = (at.lane(l), picked::<T, N, MOST_VALUES>(p, l));
        let z = picked::<T, N, MOST_STAGED>(own, l);
        acceleration[l] = law.force::<T, FMA>(&at, &p, &z, acceleration[l]);
        let rate = law.rates::<T, FMA>(&at, &p, &z);
        for (rates, rate) in rates.iter_mut().zip(rate) {
            rates[l] = rate;
        }
    }
}

/// Lets a law change the readings of N masses.
#[inline(always)]
pub(super) fn each_reading<L: Law, const N: usize>(
    law: &L,
    at: &Instants<'_, f64, N>,
    p: &[[f64; N]],
    own: &[[f64; N]],
    y: &mut [f64; N],
) {
    let (values, states) = (law.values(), law.states().min(MOST_STAGED));
    let (Some(p), Some(own)) = (p.get(..values), own.get(..states)) else { return };
    for l in 0..N {
        let (p, z) = (picked::<f64, N, MOST_VALUES>(p, l), picked::<f64, N, MOST_STAGED>(own, l));
        y[l] = law.reading(&at.lane(l), &p, &z, y[l]);
    }
}

/// One lane of some rows, zero beyond them.
#[inline(always)]
fn picked<T: Real, const N: usize, const MOST: usize>(rows: &[[T; N]], l: usize) -> [T; MOST] {
    let mut out = [T::default(); MOST];
    for (out, row) in out.iter_mut().zip(rows) {
        *out = row[l];
    }
    out
}
