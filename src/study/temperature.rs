//! `[temperature]`: how warm the sensor is over time, the same section along one axis and along a
//! trajectory.

use super::file;
use super::refusal::refuse;
use super::tolerances::Tolerances;
use crate::error::Result;
use crate::motion::temperature::{POSSIBLE_DEG_C, Temperature};
use crate::physics::warm_stiffness;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{SensorTerm, coupling};
use crate::units::key::Key;

/// The keys of all that follows the temperature.
fn over_temperature() -> impl Iterator<Item = &'static Key> {
    let curved = SensorTerm::ALL.into_iter().filter(|term| matches!(term.law(), ErrorLaw::WarmPower(_)));
    let springs = warm_stiffness::GIVEN.iter().map(|given| &given.key);
    coupling::OVER_TEMPERATURE.into_iter().chain(curved.flat_map(|term| term.row().keys)).chain(springs)
}

/// Returns whether a sensor whose axes have these numbers is warmed or cooled and none of them
/// follows it.
pub(super) fn is_idle(temperature: &Temperature, axes: &[Tolerances]) -> bool {
    let follows = |axis: &Tolerances| over_temperature().any(|key| axis.moments(key) != (0.0, 0.0));
    !temperature.points.is_empty() && !axes.iter().any(follows)
}

/// Temperature of a sensor whose axes have these numbers; always the reference without a section.
///
/// # Errors
/// A temperature coefficient without a `[temperature]` section; times of the profile that are below
/// zero or do not increase; temperatures, or a reference, that no sensor sees; a lag below zero.
pub(super) fn read(name: &str, section: Option<&file::Temperature>, axes: &[Tolerances]) -> Result<Temperature> {
    let given = |key: &&Key| axes.iter().any(|axis| axis[key].is_some());
    let Some(section) = section else {
        return match over_temperature().find(given) {
            None => Ok(Temperature::default()),
            Some(key) => Err(refuse(
                name,
                format!("`{}` needs a [temperature]", key.path),
                "e.g. profile_s_deg_c = [[0.0, 20.0], [600.0, 45.0]]",
            )),
        };
    };
    let points = section.profile_s_deg_c.clone();
    let rises = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    let sound =
        points.iter().all(|[time_s, deg_c]| *time_s >= 0.0 && time_s.is_finite() && POSSIBLE_DEG_C.contains(deg_c));
    if points.is_empty() || !rises || !sound {
        return Err(refuse(
            name,
            "`temperature.profile_s_deg_c` needs pairs of time and temperature: times not below 0 and increasing, in °C",
            "e.g. profile_s_deg_c = [[0.0, 20.0], [600.0, 45.0]]",
        ));
    }
    let reference_deg_c = section.reference_deg_c.unwrap_or(points[0][1]);
    if !POSSIBLE_DEG_C.contains(&reference_deg_c) {
        let cause = format!("`temperature.reference_deg_c` = {reference_deg_c:?}: no sensor is calibrated there");
        return Err(refuse(name, cause, "give °C, e.g. 25.0"));
    }
    let lag_s = section.lag_s.unwrap_or(0.0);
    if !(0.0..f64::INFINITY).contains(&lag_s) {
        let cause = format!("`temperature.lag_s` = {lag_s:?}: a time constant is a number of seconds from 0 on");
        return Err(refuse(name, cause, "e.g. lag_s = 30.0"));
    }
    Ok(Temperature::new(points, reference_deg_c).with_lag(lag_s))
}
