//! Adds the force of one term, compiled for each instruction set.
//!
//! A call, and not inlined: in the loop over the terms of a stage the compiler would otherwise prepare,
//! at every stage of every step, what any of the laws might need.

use crate::physics::state::{Instants, LANES, Lanes, Staged};

use super::mover::Mover;

/// States of one term, or their rates.
type Rows = Staged<f64, LANES>;

/// The function that adds a term's force to the acceleration and writes the rates of its states.
#[derive(Clone, Copy)]
pub(super) struct Force(unsafe fn(&Mover<'_>, &Instants<'_, f64, LANES>, &Rows, &mut Rows, &mut Lanes));

macro_rules! compiled {
    ($(#[$feature:meta])* $name:ident, $doc:literal) => {
        #[doc = $doc]
        $(#[$feature])*
        pub(super) fn $name() -> Self {
            $(#[$feature])*
            fn add(m: &Mover<'_>, at: &Instants<'_, f64, LANES>, own: &Rows, rate: &mut Rows, sum: &mut Lanes) {
                m.term.force::<f64, LANES, false>(at, &m.values, own, rate, sum);
            }
            Self(add)
        }
    };
}

impl Force {
    #[cfg(target_arch = "x86_64")]
    compiled!(
        #[target_feature(enable = "avx512f")]
        wide,
        "For a processor with AVX-512F."
    );

    #[cfg(target_arch = "x86_64")]
    compiled!(
        #[target_feature(enable = "avx2,fma")]
        middle,
        "For a processor with AVX2 and FMA."
    );

    compiled!(plain, "For any processor.");

    /// Adds the force of a term and writes the rates of its states.
    #[inline(always)]
    pub(super) fn add(
        self,
        m: &Mover<'_>,
        at: &Instants<'_, f64, LANES>,
        own: &Rows,
        rate: &mut Rows,
        sum: &mut Lanes,
    ) {
        // SAFETY: `wide` and `middle` can be called only where the processor has what their functions need.
        unsafe { (self.0)(m, at, own, rate, sum) }
    }
}
