//! Lets a law, written for one mass, act on N masses side by side, lane by lane, in loops that
//! compile to vector instructions.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::numerics::elementary::Real;

use super::law::Law;
use super::state::{Instants, MOST_STAGED, Staged, Values};

/// Adds a law's force to the acceleration of N masses and writes the rates of its states: the first of
/// `rates`, as they are the first of `own`; zeros where it has none. Fixed numbers of rows, as slices of
/// them would be copied at every stage of every step.
#[inline(always)]
pub(crate) fn each<L: Law, T: Real, const N: usize, const FMA: bool>(
    law: &L,
    at: &Instants<'_, T, N>,
    p: &Values<T, N>,
    own: &Staged<T, N>,
    rates: &mut Staged<T, N>,
    acceleration: &mut [T; N],
) {
    let mut all = [[T::default(); N]; MOST_STAGED];
    for l in 0..N {
        let (at, p, z) = (at.lane(l), lane(p, l), lane(own, l));
        acceleration[l] = law.force::<T, FMA>(&at, &p, &z, acceleration[l]);
        let rate = law.rates::<T, FMA>(&at, &p, &z);
        for i in 0..MOST_STAGED {
            all[i][l] = rate[i];
        }
    }
    *rates = all;
}

/// Lets a law change the readings of N masses.
#[inline(always)]
pub(super) fn each_reading<L: Law, const N: usize>(
    law: &L,
    at: &Instants<'_, f64, N>,
    p: &Values<f64, N>,
    own: &[[f64; N]],
    y: &mut [f64; N],
) {
    let own = whole::<f64, N, MOST_STAGED>(own);
    for l in 0..N {
        y[l] = law.reading(&at.lane(l), &lane(p, l), &lane(&own, l), y[l]);
    }
}

/// Rows with zeros to the fixed number that a law is given: where a form of a law decides on their
/// number, the loop over lanes would otherwise gather them one by one.
#[inline(always)]
fn whole<T: Real, const N: usize, const MOST: usize>(rows: &[[T; N]]) -> [[T; N]; MOST] {
    let mut all = [[T::default(); N]; MOST];
    for i in 0..MOST {
        if i < rows.len() {
            all[i] = rows[i];
        }
    }
    all
}

/// One lane of all rows.
#[inline(always)]
fn lane<T: Real, const N: usize, const MOST: usize>(rows: &[[T; N]; MOST], l: usize) -> [T; MOST] {
    let mut out = [T::default(); MOST];
    for i in 0..MOST {
        out[i] = rows[i][l];
    }
    out
}
