//! Turns positions stated as latitude, longitude and height into distances from the first of them.
//!
//! Distances north and east are summed along the meridians and parallels that the body crosses (Groves, *Principles of GNSS,
//! inertial and multisensor navigation*, §2.4.3), so that they keep to the level in which attitudes are stated. Not for
//! the frame of a study: a closed path of many kilometres need not close.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector3;

use super::layout::Axes;
use super::read::Row;
use super::refusal::{Refusal, refusal};
use crate::motion::earth::{Place, Radii};
use crate::number::rounded;

/// Replaces latitude, longitude (both in units of `unit_rad`, rad) and height by distances from the first row, m; returns
/// the place of that row.
///
/// # Errors
/// A latitude beyond the poles.
pub(super) fn unroll(rows: &mut [Row], unit_rad: f64, axes: Axes) -> Result<Option<Place>, Refusal> {
    let beyond = rows.iter().find(|row| (row.position_m.x * unit_rad).abs() > FRAC_PI_2);
    if let Some(row) = beyond {
        let cause = format!("row {} has a latitude of {}", row.row, rounded(row.position_m.x, 9));
        return Err(refusal(
            cause,
            "state it in degrees from −90 to 90, or in radians with _rad at the end of the heading",
        ));
    }
    let Some(first) = rows.first().map(|row| row.position_m) else { return Ok(None) };
    let (mut last, mut way) = (first, Vector3::zeros());
    for row in rows {
        let here = row.position_m;
        let latitude_rad = 0.5 * (here.x + last.x) * unit_rad;
        let height_m = 0.5 * (here.z + last.z);
        let radii = Radii::at(latitude_rad);
        let turn_rad = ((here.y - last.y) * unit_rad + PI).rem_euclid(TAU) - PI;
        way.x += (here.x - last.x) * unit_rad * (radii.meridian_m + height_m);
        way.y += turn_rad * (radii.prime_vertical_m + height_m) * latitude_rad.cos();
        way.z = first.z - here.z;
        last = here;
        row.position_m = if axes == Axes::EastNorthUp { Vector3::new(way.y, way.x, -way.z) } else { way };
    }
    Ok(Some(Place { latitude_rad: first.x * unit_rad, height_m: first.z }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(positions: &[[f64; 3]]) -> Vec<Row> {
        let row = |(row, position): (usize, &[f64; 3])| Row {
            row,
            time_s: row as f64,
            position_m: Vector3::from(*position),
            attitude: Vec::new(),
        };
        positions.iter().enumerate().map(row).collect()
    }

    // A minute of arc of the meridian at 45° is 1852.2 m long: M(45°) = 6 367 381.8 m (WGS-84), and a degree of
    // longitude at the equator is a π/180 = 111 319.5 m.
    #[test]
    fn a_minute_of_latitude_and_a_degree_of_longitude_are_as_long_as_the_ellipsoid_says() {
        let degree = PI / 180.0;
        let mut north = rows(&[[45.0 - 1.0 / 120.0, 8.0, 0.0], [45.0 + 1.0 / 120.0, 8.0, 10.0]]);
        let place = unroll(&mut north, degree, Axes::NorthEastDown).expect("a latitude").expect("a row");
        assert!((north[1].position_m - Vector3::new(1852.2, 0.0, -10.0)).norm() < 0.05, "{:?}", north[1].position_m);
        assert!((place.latitude_rad - (45.0 - 1.0 / 120.0) * degree).abs() < 1e-12);
        let mut across = rows(&[[0.0, 179.5, 0.0], [0.0, -179.5, 0.0]]);
        unroll(&mut across, degree, Axes::EastNorthUp).expect("a latitude");
        assert!((across[1].position_m - Vector3::new(111_319.5, 0.0, 0.0)).norm() < 0.1, "{:?}", across[1].position_m);
        assert!(unroll(&mut rows(&[[490_000_000.0, 0.0, 0.0]]), degree, Axes::NorthEastDown).is_err());
    }
}
