//! Layouts of files of poses, and which way up they are.

use nalgebra::{Matrix3, Quaternion};
use serde::Deserialize;

/// Known layouts of a file of poses.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Time in ns, position, quaternion with its scalar first: Burri et al., *The EuRoC micro
    /// aerial vehicle datasets*, IJRR 2016.
    Euroc,
    /// Time in s, position, quaternion with its scalar last: Sturm et al., *A benchmark for the
    /// evaluation of RGB-D SLAM systems*, IROS 2012.
    Tum,
    /// The upper three rows of a pose matrix, times apart: Geiger et al., *Vision meets robotics:
    /// the KITTI dataset*, IJRR 2013.
    Kitti,
    /// Columns by their headings.
    Csv,
}

impl Format {
    /// Name of the layout.
    pub fn name(self) -> &'static str {
        match self {
            Self::Euroc => "EuRoC",
            Self::Tum => "TUM",
            Self::Kitti => "KITTI",
            Self::Csv => "CSV",
        }
    }
}

/// Place of the scalar in a quaternion.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// w x y z.
    ScalarFirst,
    /// x y z w.
    ScalarLast,
}

impl Order {
    /// Returns what the same four numbers mean with the scalar at the other end, where they were
    /// taken in this order.
    pub fn at_other_end(self, q: &Quaternion<f64>) -> Quaternion<f64> {
        match self {
            Self::ScalarLast => Quaternion::new(q.i, q.j, q.k, q.w),
            Self::ScalarFirst => Quaternion::new(q.k, q.w, q.i, q.j),
        }
    }
}

/// The axis of the file's reference that points up.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Up {
    /// z, as most robots have it.
    #[serde(rename = "z")]
    Z,
    /// −z: north, east, down already.
    #[serde(rename = "-z")]
    MinusZ,
    /// y, as computer graphics has it.
    #[serde(rename = "y")]
    Y,
    /// −y, as cameras have it: x right, y down, z ahead.
    #[serde(rename = "-y")]
    MinusY,
}

impl Up {
    /// Returns its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Z => "z",
            Self::MinusZ => "-z",
            Self::Y => "y",
            Self::MinusY => "-y",
        }
    }

    /// The axis, with a proper minus.
    pub fn axis(self) -> &'static str {
        match self {
            Self::Z => "z",
            Self::MinusZ => "−z",
            Self::Y => "y",
            Self::MinusY => "−y",
        }
    }

    /// Says what became of the axes.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Z => "north = x, east = −y, down = −z",
            Self::MinusZ => "north = x, east = y, down = z",
            Self::Y => "north = −z, east = x, down = −y",
            Self::MinusY => "north = z, east = x, down = y",
        }
    }

    /// From the file's reference to north, east and down.
    pub fn to_level(self) -> Matrix3<f64> {
        match self {
            Self::Z => Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0),
            Self::MinusZ => Matrix3::identity(),
            Self::Y => Matrix3::new(0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0),
            Self::MinusY => Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_up_is_a_rotation_that_brings_up_to_up() {
        for (up, axis) in [
            (Up::Z, [0.0, 0.0, 1.0]),
            (Up::MinusZ, [0.0, 0.0, -1.0]),
            (Up::Y, [0.0, 1.0, 0.0]),
            (Up::MinusY, [0.0, -1.0, 0.0]),
        ] {
            assert!((up.to_level().determinant() - 1.0).abs() < 1e-15);
            assert_eq!(up.to_level() * nalgebra::Vector3::from(axis), -nalgebra::Vector3::z(), "{up:?}");
        }
    }
}
