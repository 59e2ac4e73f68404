//! An outage of GNSS in the public document.

use serde::Serialize;

use crate::backend::flight::Quantity;
use crate::strapdown::answer::Answer;
use crate::strapdown::outages::Outage;
use crate::strapdown::spreads::{At, Axes, Circular, NorthEastDown, Spherical};

/// One outage; lists run along its own `time_s`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Entry {
    from_s: f64,
    until_s: f64,
    time_s: Vec<f64>,
    position_error_ned_m: NorthEastDown,
    velocity_error_ned_m_s: NorthEastDown,
    horizontal_error_m: Circular,
    spherical_error_m: Spherical,
    covariance: Linear,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Linear {
    position_error_ned_m: Axes,
    velocity_error_ned_m_s: Axes,
}

/// All outages of an answer.
pub(super) fn entries(answer: &Answer) -> Vec<Entry> {
    let entry = |outage: &Outage| {
        let at = At { answer, places: &outage.places };
        Entry {
            from_s: outage.from_s,
            until_s: outage.until_s,
            time_s: outage.places.iter().map(|k| answer.ensemble.time_s[*k]).collect(),
            position_error_ned_m: at.north_east_down(Quantity::Position),
            velocity_error_ned_m_s: at.north_east_down(Quantity::Velocity),
            horizontal_error_m: at.circular(),
            spherical_error_m: at.spherical(),
            covariance: Linear { position_error_ned_m: at.linear_axes(0), velocity_error_ned_m_s: at.linear_axes(3) },
        }
    };
    answer.outages.iter().map(entry).collect()
}
