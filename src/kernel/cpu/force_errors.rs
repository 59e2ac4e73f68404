//! Laws of a reading's errors that follow what the sensor feels: the specific force along its axis,
//! its square, and its temperature. Next to each stands its WGSL.

use super::lanes::{Kernel, LANES, Lane};
use crate::fragment::Fragment;
use crate::numerics::elementary::{Real, fma};

/// A law in the shader that takes a column of the member, and adds this to each reading.
const fn of_column(add: &'static str) -> Fragment {
    Fragment { begin: "\n    let $term_share = column(i, $TERM);\n", block: "", draw: "", add, end: "" }
}

/// Fragment of what follows the specific force.
pub(crate) const FORCE: Fragment = of_column(
    "
                if HAS_$TERM {
                    $out = fma($term_share, felt, $out);
                }
",
);

/// Fragment of what follows its square.
pub(crate) const FORCE_SQUARED: Fragment = of_column(
    "
                if HAS_$TERM {
                    $out = fma($term_share * felt, felt, $out);
                }
",
);

/// Adds what follows the specific force or its square.
pub(super) struct AddForce<'a, T> {
    /// Error per force, or per its square.
    pub scale: &'a Lane<T>,
    pub felt: &'a [Lane<T>],
    pub squared: bool,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddForce<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, felt) in self.out.iter_mut().zip(self.felt) {
            for l in 0..LANES {
                let gain = if self.squared { self.scale[l] * felt[l] } else { self.scale[l] };
                out[l] = fma::<T, FMA>(gain, felt[l], out[l]);
            }
        }
    }
}

/// Fragment of what follows the temperature.
pub(crate) const WARM: Fragment = of_column(
    "
                if HAS_$TERM {
                    $out = fma($term_share, warmer[n - tile.first_sample], $out);
                }
",
);

/// Fragment of what follows the temperature and the specific force.
pub(crate) const WARM_FORCE: Fragment = of_column(
    "
                if HAS_$TERM {
                    $out = fma($term_share * felt, warmer[n - tile.first_sample], $out);
                }
",
);

/// Fragment of what follows the square of the temperature.
pub(crate) const WARM_SQUARED: Fragment = of_column(
    "
                if HAS_$TERM {
                    let kelvins = warmer[n - tile.first_sample];
                    $out = fma($term_share * kelvins, kelvins, $out);
                }
",
);

/// Fragment of what follows its cube.
pub(crate) const WARM_CUBED: Fragment = of_column(
    "
                if HAS_$TERM {
                    let kelvins = warmer[n - tile.first_sample];
                    $out = fma($term_share * kelvins * kelvins, kelvins, $out);
                }
",
);

/// Adds what follows a power of the temperature.
pub(super) struct AddWarmPower<'a, T> {
    /// Error per kelvin to this power.
    pub scale: &'a Lane<T>,
    pub power: u32,
    /// Temperature of the sensor above its reference, K; empty where it is not.
    pub warmer: &'a [T],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWarmPower<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, kelvins) in self.out.iter_mut().zip(self.warmer) {
            let mut share = *self.scale;
            for _ in 1..self.power {
                for l in 0..LANES {
                    share[l] = share[l] * *kelvins;
                }
            }
            for l in 0..LANES {
                out[l] = fma::<T, FMA>(share[l], *kelvins, out[l]);
            }
        }
    }
}

/// Adds what follows the temperature, with or without the specific force.
pub(super) struct AddWarm<'a, T> {
    /// Error per kelvin, and per force where there is one.
    pub scale: &'a Lane<T>,
    pub felt: Option<&'a [Lane<T>]>,
    /// Temperature of the sensor above its reference, K; empty where it is not.
    pub warmer: &'a [T],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWarm<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (i, (out, warmer)) in self.out.iter_mut().zip(self.warmer).enumerate() {
            let mut share = *self.scale;
            if let Some(felt) = self.felt {
                for l in 0..LANES {
                    share[l] = share[l] * felt[i][l];
                }
            }
            for l in 0..LANES {
                out[l] = fma::<T, FMA>(share[l], *warmer, out[l]);
            }
        }
    }
}
