//! How a study gives a parameter of a law: its key, its unit, the sign that physics allows, its random-number slot.

/// Which values make sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Any.
    Any,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
}

/// A parameter of a law as `[sensor]` of a study has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key {
    /// Which parameter of the law.
    pub parameter: usize,
    /// Key in `[sensor]`; its unit is SI.
    pub key: &'static str,
    /// Name in a sensor table.
    pub name: &'static str,
    /// Unit in a sensor table.
    pub unit: &'static str,
    /// Which values make sense.
    pub sign: Sign,
    /// Slot in the tolerance stream: never given to another, so that old studies draw the same members.
    pub slot: u32,
    /// Whether it changes its sign when the axis is turned round, as a one-sided spring does.
    pub turns: bool,
}
