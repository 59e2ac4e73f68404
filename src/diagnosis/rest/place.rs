//! What the Earth adds to a sensor at rest at a known place: gravity, and its own turning. A
//! reference for the means of three channels; the directions of the axes are not known, so only
//! lengths are compared.

use super::channel::{Channel, Fitted};
use super::statement::{Earth, Statement};
use crate::diagnosis::model::Static;
use crate::diagnosis::verdict::Estimate;
use crate::numerics::special::normal_quantile;
use crate::recording::unit::{Quantity, Unit};
use crate::units::DEGREE;

/// Rate at which the Earth turns against the stars, rad/s (WGS 84).
const EARTH_RAD_S: f64 = 7.292_115e-5;
/// Normal gravity at the equator, m/s²; Somigliana's constant; squared eccentricity (WGS 84, NIMA
/// TR8350.2, table 3.4).
const EQUATOR_M_S2: f64 = 9.780_325_335_9;
const SOMIGLIANA: f64 = 0.001_931_852_652_41;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_14;
/// Fall of normal gravity with height, 1/s² (free-air gradient, same source, to first order).
const FREE_AIR_PER_S2: f64 = 3.086e-6;

/// Normal gravity, m/s², at a geodetic latitude and a height above the ellipsoid.
fn gravity_m_s2(latitude_rad: f64, height_m: f64) -> f64 {
    let sine = latitude_rad.sin().powi(2);
    EQUATOR_M_S2 * (1.0 + SOMIGLIANA * sine) / (1.0 - ECCENTRICITY_SQUARED * sine).sqrt() - FREE_AIR_PER_S2 * height_m
}

/// The mean of every channel with its 95 % interval: its variance is that of the slowest cosine
/// coefficient.
pub(super) fn means(channels: &[Channel], finals: &[Fitted], unit: &str) -> Vec<Estimate> {
    let of = |(channel, fitted): (&Channel, &Fitted)| {
        let mean = channel.mean;
        let count = channel.values.len() as f64;
        let slowest = fitted.variances.first().copied().unwrap_or(0.0);
        let half = normal_quantile(0.975) * (slowest / count).sqrt() * channel.scale;
        Estimate {
            name: format!("mean of {}", channel.name),
            value: mean,
            unit: unit.into(),
            ci95: [mean - half, mean + half],
        }
    };
    channels.iter().zip(finals).map(of).collect()
}

/// Gravity or the Earth's rate beside the length of three means; `None` where the place or the unit
/// is not known.
pub(super) fn reference(model: &Static, means: &[Estimate]) -> Option<Statement> {
    let latitude_rad = model.latitude_deg? * DEGREE;
    let [x, y, z] = means else { return None };
    let length = (x.value.powi(2) + y.value.powi(2) + z.value.powi(2)).sqrt();
    // To first order in the errors of the means.
    let half = [x, y, z].map(|m| m.value / length * 0.5 * (m.ci95[1] - m.ci95[0]));
    let half = half.iter().map(|h| h * h).sum::<f64>().sqrt();
    let statement = |earth, expected: f64, unit: &Unit| Statement::Place {
        earth,
        length,
        ci95: [length - half, length + half],
        expected: expected / unit.si,
        latitude_deg: model.latitude_deg.unwrap_or(0.0),
    };
    if let Ok(unit) = Unit::parse(&model.unit, Quantity::Accelerometer) {
        let expected = gravity_m_s2(latitude_rad, model.height_m.unwrap_or(0.0));
        return Some(statement(Earth::Gravity, expected, &unit));
    }
    let unit = Unit::parse(&model.unit, Quantity::Gyro).ok()?;
    Some(statement(Earth::Rate, EARTH_RAD_S, &unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal gravity of the World Geodetic System 1984 (TR8350.2): 9.7803253359 at the equator,
    /// 9.8321849378 m/s² at a pole. At 45° that of the Geodetic Reference System 1980 (Moritz),
    /// 9.806199203, from which it differs in the sixth decimal.
    #[test]
    fn normal_gravity_is_the_tabulated_one() {
        for (latitude, tabulated) in [(0.0f64, 9.780_325_335_9), (45.0, 9.806_199_203), (90.0, 9.832_184_937_8)] {
            let got = gravity_m_s2(latitude * DEGREE, 0.0);
            assert!((got - tabulated).abs() < 2e-6, "{latitude}: {got}");
        }
        assert!((gravity_m_s2(0.8, 0.0) - gravity_m_s2(0.8, 1000.0) - 3.086e-3).abs() < 1e-9);
    }
}
