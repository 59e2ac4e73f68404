//! The three kinds of residual that poses leave, and the units that they are stated in.

use crate::units::DEGREE;

/// Kinds of residual that a set of poses leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// Magnitude of the specific force minus gravity, |f| − g.
    Gravity,
    /// Angular rate in a still pose.
    Still,
    /// Gravity's direction after a move.
    Turn,
}

/// All groups in order.
pub const GROUPS: [Group; 3] = [Group::Gravity, Group::Still, Group::Turn];

impl Group {
    /// Its place in `GROUPS`.
    pub fn place(self) -> usize {
        self as usize
    }

    /// The unit that it is stated in.
    pub fn unit(self) -> &'static str {
        match self {
            Group::Gravity => "mm/s²",
            Group::Still => "°/s",
            Group::Turn => "mrad",
        }
    }

    /// That unit, from SI.
    pub fn factor(self) -> f64 {
        match self {
            Group::Still => 1.0 / DEGREE,
            Group::Gravity | Group::Turn => 1e3,
        }
    }
}
