//! `[trajectory]` of study.toml: where poses come from.
//!
//! # Adding a kind
//! One file with its `SOURCE` (name, keys, poses), its name in [`Kind`] and its line in
//! [`source()`]; foreign keys are refused by it, misspelt ones by [`Section`]. Positions are metres
//! north, east and down from some origin.

pub mod car;
pub mod circle;
pub mod compare;
pub mod drone;
pub mod figure_eight;
pub mod file;
pub mod ramp;
pub mod rest;
pub mod section;
pub mod source;
pub mod track;
pub mod waypoints;

pub use compare::{Bias, Compare};
pub use section::{Kind, Section};
pub use source::Source;

use super::spline::{Departure, Knots, fit};
use super::trajectory::Trajectory;
use crate::error::Result;
use source::{POSES, fail};

/// Every kind of trajectory, in the order of the documentation.
pub const KINDS: [Kind; 7] =
    [Kind::Rest, Kind::Circle, Kind::FigureEight, Kind::Waypoints, Kind::Car, Kind::Drone, Kind::File];

/// Name, keys and poses of a kind.
pub fn source(kind: Kind) -> &'static Source {
    match kind {
        Kind::Rest => &rest::SOURCE,
        Kind::Circle => &circle::SOURCE,
        Kind::FigureEight => &figure_eight::SOURCE,
        Kind::Waypoints => &waypoints::SOURCE,
        Kind::Car => &car::SOURCE,
        Kind::Drone => &drone::SOURCE,
        Kind::File => &file::SOURCE,
    }
}

/// The motion that a section describes, for at least this many seconds.
///
/// # Errors
/// A key of another kind, a value that makes no sense, a file of poses that cannot be used.
pub fn trajectory(section: &Section, duration_s: f64) -> Result<Trajectory> {
    let own = source(section.kind);
    if let Some(foreign) = section.given().into_iter().find(|key| !own.keys.contains(key)) {
        let owners: Vec<_> =
            KINDS.iter().map(|k| source(*k)).filter(|s| s.keys.contains(&foreign)).map(|s| s.name).collect();
        return Err(fail(
            format!("`{foreign}` belongs to {}, not to a trajectory of kind `{}`", owners.join(", "), own.name),
            format!("keys of this kind: {}", own.keys.join(", ")),
        ));
    }
    let Some(computed) = own.poses else { return file::trajectory(section, duration_s) };
    let poses = computed(section, duration_s)?;
    let last = poses.last().map_or(0.0, |pose| pose.time_s);
    let knot_s = if poses.len() > 2 { POSES.0 * POSES.1 } else { last };
    let spline = fit(&poses, Knots::over(0.0, last, knot_s)).ok_or_else(|| {
        fail("its poses are too far apart to interpolate a motion", "are the radius, the speed and the times sensible?")
    })?;
    let departure = Departure::of(&spline, &poses);
    Ok(Trajectory::new(spline, departure, Vec::new()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_of_another_kind_is_refused_by_name() {
        let section: Section =
            proofmass_base::document::parse_toml("study.toml", "kind = \"rest\"\nradius_m = 3.0").expect("read");
        let error = trajectory(&section, 1.0).expect_err("foreign");
        assert!(error.cause.contains("`radius_m` belongs to circle, figure-eight"), "{error}");
        let misspelt = proofmass_base::document::parse_toml::<Section>("study.toml", "kind = \"figure-eigth\"");
        assert_eq!(misspelt.expect_err("misspelt").hint, "did you mean `figure-eight`?");
    }
}
