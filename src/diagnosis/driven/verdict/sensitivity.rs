//! The reading over a steady input, g/ω₀², where it is all that is known of both: the scale factor of a
//! gyro on a turntable.

use super::conclude::Conclusion;
use super::effects::{Channels, unit};
use crate::driven::base::{GAIN, OMEGA};
use crate::driven::identification::interval;
use crate::driven::simulation::structure::coordinates;
use crate::physics::scales::{Coordinate, Scales};
use crate::verdict::Estimate;

/// Its value and interval, where ω₀ is held.
pub(super) fn sensitivity(c: &Conclusion, scales: &Scales, channels: &Channels) -> Option<Estimate> {
    let (fit, spread) = (&c.model.fit, &c.spread);
    let index = fit.free.iter().position(|f| *f == GAIN)?;
    let Coordinate::Linear(scale) = coordinates(&fit.structure, scales)[GAIN] else { return None };
    let per_gain = fit.point[OMEGA].powi(-2);
    let (value, reach) = (fit.point[GAIN] * per_gain, interval::reach() * spread.deviation[index] * scale * per_gain);
    let ci95 = [value - reach, value + reach];
    reach.is_finite().then(|| Estimate { name: "sensitivity".into(), value, unit: unit("y/u", channels), ci95 })
}
