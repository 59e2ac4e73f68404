//! The numbers of an excitation that may be drawn per member.

use crate::units::key::{Key, Sign};

/// The size of an excitation; its unit is that of the key it was read from.
pub const SIZE: Key = Key::new(26, "excitation.amplitude", "excitation amplitude", "", 1.0, Sign::Any);
/// Frequency of a member's own sine.
pub const FREQUENCY: Key = Key::new(27, "excitation.frequency_hz", "excitation frequency", "Hz", 1.0, Sign::Positive);
/// Phase of a member's own sine.
pub const PHASE: Key = Key::new(28, "excitation.phase_rad", "excitation phase", "rad", 1.0, Sign::Any);
