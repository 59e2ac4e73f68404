//! States what the Earth adds to a sensor at rest at a known place: gravity, and its own turning. A
//! reference for the means of three channels.
//!
//! One pose shows one number, the length of the vector, against three biases, three scale factors
//! and the place itself: the difference is said with its interval, and nothing is named for it.

use std::ops::RangeInclusive;

use super::candidate::{EARTH_RATE, LOCAL_GRAVITY};
use super::statement::{Difference, Earth, Statement};
use crate::error::{Error, Result};
use crate::model::Static;
use crate::motion::earth::{self, Place, RATE_RAD_S};
use crate::numerics::special::{normal_cdf, normal_quantile};
use crate::recording::unit::{Quantity, Unit};
use crate::standing::{Gain, Note, Ranked};
use crate::units::DEGREE;
use crate::verdict::Estimate;

/// States how far gravity commonly is from that of the ellipsoid, m/s²: three times the rms of
/// free-air anomalies, 34 mGal (EGM2008; Pavlis et al., Journal of Geophysical Research 117, 2012).
const ANOMALY_M_S2: f64 = 1e-3;

/// Length over its largest standard deviation from which the direction of a vector is known.
const SURE: f64 = 10.0;

/// Heights at which a sensor lies at rest, from the Dead Sea's shore to a balloon, m.
const HEIGHTS_M: RangeInclusive<f64> = -500.0..=20_000.0;

/// Gravity of the WGS-84 ellipsoid, m/s².
fn gravity_m_s2(latitude_rad: f64, height_m: f64) -> f64 {
    let earth = earth::Earth { latitude_rad: Some(latitude_rad), height_m, rotation: true };
    earth.gravity_m_s2(Place { latitude_rad, height_m })
}

/// Checks whether the model states a place on the Earth, or none.
///
/// # Errors
/// A latitude beyond the poles, a height that is not on or near the Earth, or one without latitude.
pub(super) fn check(model: &Static) -> Result<()> {
    let refuse = |cause: String, hint: &str| Err(Error::new("could not use the model's place", cause, hint));
    match (model.latitude_deg, model.height_m) {
        (Some(latitude), _) if !(-90.0..=90.0).contains(&latitude) => {
            refuse(format!("latitude_deg = {latitude}: need -90 to 90"), "give degrees north of the equator")
        }
        (None, Some(_)) => refuse("height_m without latitude_deg".into(), "add latitude_deg, e.g. latitude_deg = 47.4"),
        (_, Some(height)) if !HEIGHTS_M.contains(&height) => {
            refuse(format!("height_m = {height}: need metres from -500 to 20000"), "give the height in metres")
        }
        _ => Ok(()),
    }
}

/// Gravity or the Earth's rate next to the length of three means; `None` where the place or the
/// unit is not known.
pub(super) fn reference(model: &Static, means: &[Estimate]) -> Option<Statement> {
    let latitude_deg = model.latitude_deg?;
    let [x, y, z] = means else { return None };
    let means = [x, y, z].map(|m| (m.value, 0.5 * (m.ci95[1] - m.ci95[0]) / normal_quantile(0.975)));
    let length = means.iter().map(|(m, _)| m * m).sum::<f64>().sqrt();
    if length <= 0.0 {
        return None;
    }
    let along = means.iter().map(|(mean, sd)| (mean / length * sd).powi(2)).sum::<f64>().sqrt();
    // Where the vector is no longer than its uncertainty, its direction is not known either.
    let worst = means.iter().fold(0.0, |most: f64, (_, sd)| most.max(*sd));
    let ci95 = interval(length, if length < SURE * worst { worst } else { along });
    let height_m = model.height_m.unwrap_or_default();
    let (earth, expected, difference) = if let Ok(unit) = Unit::parse(&model.unit, Quantity::Accelerometer) {
        let expected = gravity_m_s2(latitude_deg * DEGREE, height_m);
        let difference = of_gravity(length * unit.si, ci95.map(|v| v * unit.si), expected, height_m);
        (Earth::Gravity, expected / unit.si, difference)
    } else {
        let expected = RATE_RAD_S / Unit::parse(&model.unit, Quantity::Gyro).ok()?.si;
        let holds = (ci95[0]..=ci95[1]).contains(&expected);
        (Earth::Rate, expected, if holds { Difference::None } else { Difference::Sensor })
    };
    let height_m = model.height_m;
    Some(Statement::Reference { earth, length, ci95, expected, latitude_deg, height_m, difference })
}

/// The entry of the library that a reference speaks of: never fitted, never named.
pub(super) fn ranked(statement: &Statement, channels: Vec<String>) -> Option<Ranked> {
    let Statement::Reference { earth, .. } = statement else { return None };
    let entry = match earth {
        Earth::Gravity => LOCAL_GRAVITY,
        Earth::Rate => EARTH_RATE,
    };
    let gain = Gain::HeldOut { value: 0.0, ci95: None };
    Some(Ranked { id: entry.id, channels, gain, p_value: 1.0, named: false, note: Note::OnePose })
}

/// Returns what may lie behind a length that is not gravity's; all in m/s².
fn of_gravity(length: f64, [low, high]: [f64; 2], expected: f64, height_m: f64) -> Difference {
    let off = |value: f64| (value - expected).abs();
    let holds = low <= expected && expected <= high;
    if holds {
        Difference::None
    } else if off(low).min(off(high)) < ANOMALY_M_S2 {
        Difference::Anomaly
    } else {
        let [equator, pole] = [0.0, 90.0].map(|degrees: f64| gravity_m_s2(degrees * DEGREE, height_m));
        let elsewhere = high > equator - ANOMALY_M_S2 && low < pole + ANOMALY_M_S2;
        if elsewhere { Difference::Latitude(latitude_deg(length, height_m)) } else { Difference::Sensor }
    }
}

/// Returns where gravity is nearest to this, degrees from the equator: it grows from there to the
/// poles.
fn latitude_deg(gravity: f64, height_m: f64) -> f64 {
    let [mut from, mut to] = [0.0, 90.0];
    for _ in 0..40 {
        let middle: f64 = 0.5 * (from + to);
        *(if gravity_m_s2(middle * DEGREE, height_m) < gravity { &mut from } else { &mut to }) = middle;
    }
    0.5 * (from + to)
}

/// 95 % interval of a vector's length, from the length as found and the standard deviation along
/// it. Noise across it lengthens a short vector: the distribution of the length of three normal
/// numbers of one standard deviation is inverted.
fn interval(found: f64, sd: f64) -> [f64; 2] {
    if sd <= 0.0 || found > 1e3 * sd {
        let half = normal_quantile(0.975) * sd;
        return [found - half, found + half];
    }
    [0.975, 0.025].map(|probability| {
        let [mut from, mut to] = [0.0, found + 10.0 * sd];
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            *(if shorter(found / sd, middle / sd) > probability { &mut from } else { &mut to }) = middle;
        }
        0.5 * (from + to)
    })
}

/// Probability that a vector of true length `length` is found shorter than `found`, both in
/// standard deviations of each of its three components.
fn shorter(found: f64, length: f64) -> f64 {
    let bell = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    let length = length.max(1e-4);
    let [near, far] = [found - length, found + length];
    normal_cdf(near) + normal_cdf(far) - 1.0 - (bell(near) - bell(far)) / length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn the_interval_of_a_length_holds_it_whatever_the_noise() {
        let mut rng = Philox::new(71, 0, Stream::Host);
        for (truth, sd) in
            [([0.6, 0.0, 0.8], [0.01; 3]), ([0.15, 0.0, 0.2], [0.5; 3]), ([0.2, -0.3, 0.1], [0.1, 0.2, 0.15])]
        {
            let length = truth.iter().map(|v: &f64| v * v).sum::<f64>().sqrt();
            let (mut held, mut plain) = (0, 0);
            for _ in 0..2000 {
                let means: [f64; 3] = std::array::from_fn(|i| truth[i] + sd[i] * rng.normal());
                let found = means.iter().map(|v| v * v).sum::<f64>().sqrt();
                let along = means.iter().zip(sd).map(|(m, s)| (m / found * s).powi(2)).sum::<f64>().sqrt();
                let [low, high] = interval(found, along);
                held += usize::from(low <= length && length <= high);
                plain += usize::from((found - length).abs() < 1.96 * along);
            }
            // 95 % of 2000, less and more three standard errors and half a per cent for unequal
            // axes.
            assert!((1860..=1955).contains(&held), "{truth:?} ± {sd:?}: {held} of 2000");
            // Control: a symmetric interval is too short where noise lengthens the vector.
            assert!(sd[0] < 0.4 || plain < 1800, "{plain}");
        }
    }

    #[test]
    fn gravity_differs_by_place_within_the_earths_range_and_by_the_sensor_beyond() {
        let here = gravity_m_s2(47.4 * DEGREE, 400.0);
        let around = |value: f64| of_gravity(value, [value - 1e-4, value + 1e-4], here, 400.0);
        assert_eq!(around(here), Difference::None);
        assert_eq!(around(here + 5e-4), Difference::Anomaly);
        let there = around(gravity_m_s2(60.0 * DEGREE, 400.0));
        assert!(matches!(there, Difference::Latitude(found) if (found - 60.0).abs() < 0.01), "{there:?}");
        assert_eq!(around(here * 1.01), Difference::Sensor);
    }
}
