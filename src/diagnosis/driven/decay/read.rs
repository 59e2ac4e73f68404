//! Units of a recording whose reading may be velocity or acceleration: laws are measured by displacement,
//! what changes the reading by the reading.

use crate::driven::intake::observed::Observed;
use crate::driven::verdict::effects::{Channels, unit};

/// Columns of the recording, and what is read of the mass.
pub(super) struct Read {
    /// Columns, with the unit of the reading.
    pub channels: Channels,
    /// Quantity that is read.
    pub observed: Observed,
}

impl Read {
    /// The columns with the unit of displacement in place of that of the reading.
    pub(super) fn of_displacement(&self) -> Channels {
        let own = &self.channels.output_unit;
        let output_unit = match self.observed.output.derivatives() {
            0 => own.clone(),
            1 => unit("y s", &self.channels),
            _ => unit("y s^2", &self.channels),
        };
        Channels { output_unit, ..self.channels.clone() }
    }
}
