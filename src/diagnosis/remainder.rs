//! States what a repaired model leaves, in the words that all kinds share: every test of the
//! residual, with the probability that noise alone would do as much and the size of what was found.
//!
//! How a residual is tested differs by kind (bands of a spectrum at rest, innovations of a filter
//! when driven, poses of an IMU hand-rotated). What counts as real, and what counts as white, is
//! defined here once. Not for the verdict that follows: see `ruling`.

use super::verdict::Whiteness;

/// A mismatch is real where noise alone would show as much with less than this probability,
/// corrected for all tests and channels of the diagnosis.
pub(super) const REAL: f64 = 0.004;
/// The residual is called coloured by a test whose probability, corrected for all tests and
/// channels, is below this, if what it found is more than negligible: in enough rows every test
/// finds something.
pub const WHITE: f64 = 0.05;

/// States how much was found, against what the noise model of the kind can promise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Size {
    /// Within what the model of the noise can be trusted.
    Negligible,
    /// More than that, and too little to say that the library fails.
    Faint,
    /// Enough to say that something is missing.
    Material,
}

impl Size {
    /// Of a measure that is negligible up to `tolerated` and material from `material` on.
    pub fn of(measure: f64, tolerated: f64, material: f64) -> Self {
        if measure >= material {
            Self::Material
        } else if measure > tolerated {
            Self::Faint
        } else {
            Self::Negligible
        }
    }
}

/// A test of the residual for structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Test {
    /// Probability of as much by chance, corrected for all tests and channels of the diagnosis; may
    /// exceed one.
    pub p_value: f64,
    /// Size of the structure that the test sees.
    pub size: Size,
}

impl Test {
    /// Its size where chance does not account for it, negligible where it does.
    pub fn found(&self) -> Size {
        if self.p_value < REAL { self.size } else { Size::Negligible }
    }

    /// Returns whether it shows that the residual is not white.
    pub fn is_coloured(&self) -> bool {
        self.p_value < WHITE && self.size > Size::Negligible
    }
}

/// Every test of a residual, with its probability under noise alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder {
    /// The smallest corrected probability, at most one.
    pub p_value: f64,
    /// The largest size that chance does not account for.
    pub size: Size,
    /// States whether no test found more than a negligible departure from white noise.
    pub white: bool,
}

impl Remainder {
    /// The worst of these tests; noise where there is none.
    pub fn of(tests: impl IntoIterator<Item = Test>) -> Self {
        let noise = Self { p_value: 1.0, size: Size::Negligible, white: true };
        tests.into_iter().fold(noise, |worst, test| Self {
            p_value: worst.p_value.min(test.p_value.max(0.0)),
            size: worst.size.max(test.found()),
            white: worst.white && !test.is_coloured(),
        })
    }

    /// The worse of both in each respect.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            p_value: self.p_value.min(other.p_value),
            size: self.size.max(other.size),
            white: self.white && other.white,
        }
    }

    /// The test as the verdict states it.
    pub fn whiteness(&self) -> Whiteness {
        Whiteness { white: self.white, p_value: self.p_value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_counts_only_where_chance_does_not_account_for_it() {
        let test = |p_value, size| Test { p_value, size };
        // Probability, size, what is found. The first row of each pair is the control of the
        // second.
        let rows = [
            (0.1, Size::Material, Size::Negligible),
            (1e-9, Size::Material, Size::Material),
            (0.1, Size::Faint, Size::Negligible),
            (1e-9, Size::Faint, Size::Faint),
            (1e-9, Size::Negligible, Size::Negligible),
        ];
        for (p_value, size, found) in rows {
            assert_eq!(test(p_value, size).found(), found, "{p_value} {size:?}");
        }
        let both = Remainder::of([test(1e-9, Size::Faint), test(0.2, Size::Material)]);
        assert_eq!(both, Remainder { p_value: 1e-9, size: Size::Faint, white: false });
        assert_eq!(Remainder::of([]), Remainder { p_value: 1.0, size: Size::Negligible, white: true });
    }

    #[test]
    fn white_is_five_per_cent_after_correction_unless_what_was_found_is_negligible() {
        let white = |p_value, size| Remainder::of([Test { p_value, size }]).whiteness().white;
        assert_eq!([0.0, 0.049, 0.05, 0.9, 7.0].map(|p| white(p, Size::Faint)), [false, false, true, true, true]);
        // In a recording twice as long the same departure has a smaller probability and the same
        // size.
        assert_eq!([0.2, 1e-3, 1e-30].map(|p| white(p, Size::Negligible)), [true; 3]);
    }

    #[test]
    fn sizes_are_ordered_and_their_limits_belong_to_the_side_stated() {
        let of = |measure| Size::of(measure, 0.02, 0.05);
        assert_eq!([0.0, 0.02, 0.021, 0.05].map(of), [Size::Negligible, Size::Negligible, Size::Faint, Size::Material]);
        assert_eq!(Size::of(f64::NAN, 0.02, 0.05), Size::Negligible);
    }
}
