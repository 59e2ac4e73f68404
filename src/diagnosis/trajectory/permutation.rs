//! The 48 ways to exchange three axes and turn them round.

use nalgebra::Matrix3;

/// Which axis each column reads, and whether turned round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Permutation {
    /// Axis of each column.
    pub axis: [usize; 3],
    /// States whether it is turned round.
    pub turned: [bool; 3],
}

impl Permutation {
    /// Every column reads its own axis.
    pub(super) const NONE: Self = Self { axis: [0, 1, 2], turned: [false; 3] };

    /// Columns read = P · axes.
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let sign = |row: usize| if self.turned[row] { -1.0 } else { 1.0 };
        Matrix3::from_fn(|row, column| if self.axis[row] == column { sign(row) } else { 0.0 })
    }

    /// Returns it as "y x −z".
    pub(super) fn map(&self) -> String {
        let one =
            |row: usize| format!("{}{}", if self.turned[row] { "-" } else { "" }, ["x", "y", "z"][self.axis[row]]);
        [0, 1, 2].map(one).join(" ")
    }
}

/// All 48: six orders of the axes, eight choices of sign.
pub(super) static SIGNED: [Permutation; 48] = signed();

const fn signed() -> [Permutation; 48] {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let mut all = [Permutation::NONE; 48];
    let mut n = 0;
    while n < 48 {
        let signs = n % 8;
        all[n] = Permutation { axis: ORDERS[n / 8], turned: [signs & 1 == 1, signs & 2 == 2, signs & 4 == 4] };
        n += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_different_and_orthogonal_and_half_are_mirrored() {
        let mirrored = SIGNED.iter().filter(|p| p.matrix().determinant() < 0.0).count();
        assert_eq!(mirrored, 24);
        for (n, p) in SIGNED.iter().enumerate() {
            assert_eq!(p.matrix() * p.matrix().transpose(), Matrix3::identity());
            assert!(!SIGNED[..n].contains(p));
        }
        let swapped = Permutation { axis: [1, 0, 2], turned: [false, false, true] };
        assert_eq!((swapped.map().as_str(), Permutation::NONE.map().as_str()), ("y x -z", "x y z"));
    }
}
