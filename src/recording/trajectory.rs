//! Trajectories in text files without headings, told by their numbers: TUM and KITTI.

/// A kind of trajectory file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trajectory {
    /// Time, position, quaternion with its scalar last: Sturm et al., *A benchmark for the
    /// evaluation of RGB-D SLAM systems*, IROS 2012.
    Tum,
    /// The upper three rows of a pose matrix: Geiger et al., *Vision meets robotics: the KITTI
    /// dataset*, IJRR 2013.
    Kitti,
}

impl Trajectory {
    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tum => "TUM",
            Self::Kitti => "KITTI",
        }
    }

    /// Its columns.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Tum => &["timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"],
            Self::Kitti => &["r11", "r12", "r13", "tx", "r21", "r22", "r23", "ty", "r31", "r32", "r33", "tz"],
        }
    }
}

/// Rounding of printed numbers in a unit vector.
const ROUNDING: f64 = 1e-3;

/// Which one a row of numbers begins, if any: a unit quaternion behind a time and a position, or a
/// rotation matrix.
pub(super) fn recognised(row: &[f64]) -> Option<Trajectory> {
    let unit = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < ROUNDING;
    match row {
        [_, _, _, _, quaternion @ ..] if row.len() == 8 && unit(quaternion) => Some(Trajectory::Tum),
        _ if row.len() == 12 => {
            let rows = [&row[0..3], &row[4..7], &row[8..11]];
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let turned = [(0, 1), (0, 2), (1, 2)].iter().all(|(i, j)| dot(rows[*i], rows[*j]).abs() < ROUNDING);
            (rows.iter().all(|r| unit(r)) && turned).then_some(Trajectory::Kitti)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trajectories_are_told_by_their_rotations_and_other_tables_left_alone() {
        assert_eq!(recognised(&[1.4e9, 1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.5]), Some(Trajectory::Tum));
        assert_eq!(recognised(&[1.4e9, 1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.4]), None);
        let turn = [0.0, -1.0, 0.0, 5.0, 1.0, 0.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0];
        assert_eq!(recognised(&turn), Some(Trajectory::Kitti));
        let mut sheared = turn;
        sheared[0] = 0.1;
        assert_eq!((recognised(&sheared), recognised(&[0.0; 12]), recognised(&[])), (None, None, None));
    }
}
