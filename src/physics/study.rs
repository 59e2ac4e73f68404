//! Declares the keys that give the parameters of a law in a study.

use crate::units::key::Key;

/// One parameter of a law as a study gives it; a law that a study can run has one for each
/// parameter, in their order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given {
    /// Key, unit, sign and random-number slot.
    pub key: Key,
    /// Says whether it changes its sign when the axis is turned round, as that of a one-sided
    /// spring does.
    pub turns: bool,
}

impl Given {
    /// A parameter that is the same seen from either end of the axis.
    pub const fn new(key: Key) -> Self {
        Self { key, turns: false }
    }

    /// A parameter that changes its sign when the axis is turned round.
    pub const fn turning(key: Key) -> Self {
        Self { key, turns: true }
    }
}
