//! The three kinds of residual that poses leave.

/// Which residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// |f| − g.
    Gravity,
    /// Rate at rest.
    Still,
    /// Gravity's direction after a move.
    Turn,
}

/// All groups in order.
pub const GROUPS: [Group; 3] = [Group::Gravity, Group::Still, Group::Turn];
