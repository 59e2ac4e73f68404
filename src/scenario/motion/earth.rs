//! The Earth under a trajectory: gravity, radii of curvature, and the rates at which the local
//! level turns.
//!
//! WGS-84 (NIMA TR8350.2, third edition, amendment 1): Somigliana's normal gravity, continued
//! upwards to second order in height. Local level is north-east-down. Not for deflections of the
//! vertical or geoid models: they are errors of tens of µg that a study may add as a bias.

use nalgebra::Vector3;

use crate::units::STANDARD_GRAVITY_M_S2;

/// Semi-major axis, m.
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;
/// Flattening of the ellipsoid, dimensionless.
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Rate of the Earth against inertial space, rad/s.
pub const RATE_RAD_S: f64 = 7.292_115e-5;
/// Normal gravity at the equator, m/s².
const EQUATOR_M_S2: f64 = 9.780_325_335_9;
/// Somigliana's constant k = bγₚ/(aγₑ) − 1.
const SOMIGLIANA: f64 = 0.001_931_852_652_41;
/// Centrifugal acceleration at the equator over attraction, m = ω²a²b/GM.
const CENTRIFUGAL: f64 = 0.003_449_786_506_84;
/// First eccentricity squared.
const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);

/// Shape, gravity and rotation of the Earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Geodetic latitude of the start, rad; none: the Earth is flat and still, with standard
    /// gravity.
    pub latitude_rad: Option<f64>,
    /// Height of the start over the ellipsoid, m.
    pub height_m: f64,
    /// Says whether it turns; if not, gravity and transport rate stay as they are.
    pub rotation: bool,
}

/// A place on the Earth; its longitude changes nothing. On a flat Earth it means nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Height over the ellipsoid, m.
    pub height_m: f64,
}

impl Place {
    /// The place reached after `seconds` at this rate of latitude, rad/s, and of height, m/s.
    pub fn moved(self, [latitude_rad_s, climb_m_s]: [f64; 2], seconds: f64) -> Self {
        Self {
            latitude_rad: self.latitude_rad + latitude_rad_s * seconds,
            height_m: self.height_m + climb_m_s * seconds,
        }
    }
}

/// Radii of curvature of the ellipsoid at a latitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radii {
    /// Radius of the meridian, m.
    pub meridian_m: f64,
    /// Radius of the prime vertical, m.
    pub prime_vertical_m: f64,
}

impl Radii {
    /// Radii at a geodetic latitude.
    pub fn at(latitude_rad: f64) -> Self {
        let root = (1.0 - ECCENTRICITY_SQUARED * latitude_rad.sin().powi(2)).sqrt();
        Self {
            meridian_m: SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / root.powi(3),
            prime_vertical_m: SEMI_MAJOR_AXIS_M / root,
        }
    }
}

impl Earth {
    /// A flat Earth without rotation, g = 9.80665 m/s².
    pub const FLAT: Self = Self { latitude_rad: None, height_m: 0.0, rotation: false };

    /// Place at which a trajectory starts.
    pub fn start(&self) -> Place {
        Place { latitude_rad: self.latitude_rad.unwrap_or_default(), height_m: self.height_m }
    }

    /// Gravity, attraction and centrifugal acceleration together, along down, m/s².
    pub fn gravity_m_s2(&self, at: Place) -> f64 {
        if self.latitude_rad.is_some() { normal_gravity_m_s2(at) } else { STANDARD_GRAVITY_M_S2 }
    }

    /// Rate of the Earth against inertial space in north-east-down, rad/s.
    pub fn rate_rad_s(&self, at: Place) -> Vector3<f64> {
        if self.latitude_rad.is_none() || !self.rotation {
            return Vector3::zeros();
        }
        let (sin, cos) = at.latitude_rad.sin_cos();
        RATE_RAD_S * Vector3::new(cos, 0.0, -sin)
    }

    /// Rate of the local level against the Earth, for a velocity over it, both in north-east-down;
    /// rad/s.
    pub fn transport_rate_rad_s(&self, at: Place, velocity_m_s: Vector3<f64>) -> Vector3<f64> {
        if self.latitude_rad.is_none() {
            return Vector3::zeros();
        }
        let radii = Radii::at(at.latitude_rad);
        let east = velocity_m_s.y / (radii.prime_vertical_m + at.height_m);
        let north = velocity_m_s.x / (radii.meridian_m + at.height_m);
        Vector3::new(east, -north, -east * at.latitude_rad.tan())
    }

    /// Rates of latitude, rad/s, and of height, m/s, at a velocity in north-east-down.
    pub fn place_rates(&self, at: Place, velocity_m_s: Vector3<f64>) -> [f64; 2] {
        let north = match self.latitude_rad {
            Some(_) => velocity_m_s.x / (Radii::at(at.latitude_rad).meridian_m + at.height_m),
            None => 0.0,
        };
        [north, -velocity_m_s.z]
    }
}

/// Normal gravity along down, m/s²: TR8350.2 equations 4-1 and 4-3. The second of them leaves out
/// terms of the order of the flattening squared: it departs from the closed form by 1.3·10⁻⁷ m/s²
/// per kilometre of height at most, up to 10 km.
fn normal_gravity_m_s2(at: Place) -> f64 {
    let sin_squared = at.latitude_rad.sin().powi(2);
    let surface = EQUATOR_M_S2 * (1.0 + SOMIGLIANA * sin_squared) / (1.0 - ECCENTRICITY_SQUARED * sin_squared).sqrt();
    let height = at.height_m / SEMI_MAJOR_AXIS_M;
    let slope = 1.0 + FLATTENING + CENTRIFUGAL - 2.0 * FLATTENING * sin_squared;
    surface * (1.0 - 2.0 * slope * height + 3.0 * height * height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DEGREE;

    const EARTH: Earth = Earth { latitude_rad: Some(0.0), height_m: 0.0, rotation: true };

    fn at(latitude_deg: f64, height_m: f64) -> Place {
        Place { latitude_rad: latitude_deg * DEGREE, height_m }
    }

    /// Normal gravity in closed form, through ellipsoidal coordinates (Heiskanen &
    /// Moritz, *Physical geodesy*, §2-8; TR8350.2 equations 4-5 to 4-19): the component along the
    /// ellipsoid's normal, down.
    fn closed_form_m_s2(place: Place) -> f64 {
        const GM: f64 = 3.986_004_418e14;
        let (a, b) = (SEMI_MAJOR_AXIS_M, SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING));
        let linear = (a * a - b * b).sqrt();
        let normal = a / (1.0 - ECCENTRICITY_SQUARED * place.latitude_rad.sin().powi(2)).sqrt();
        let axis = (normal + place.height_m) * place.latitude_rad.cos();
        let pole = (normal * (1.0 - ECCENTRICITY_SQUARED) + place.height_m) * place.latitude_rad.sin();
        let excess = axis * axis + pole * pole - linear * linear;
        let u = (0.5 * excess * (1.0 + (1.0 + 4.0 * (linear * pole / excess).powi(2)).sqrt())).sqrt();
        let beta = (pole * (u * u + linear * linear).sqrt() / (u * axis)).atan();
        let w = ((u * u + (linear * beta.sin()).powi(2)) / (u * u + linear * linear)).sqrt();
        let q = |u: f64| 0.5 * ((1.0 + 3.0 * (u / linear).powi(2)) * (linear / u).atan() - 3.0 * u / linear);
        let slope = 3.0 * (1.0 + (u / linear).powi(2)) * (1.0 - u / linear * (linear / u).atan()) - 1.0;
        let turn = RATE_RAD_S.powi(2);
        let reach = u * u + linear * linear;
        let along_u =
            -(GM / reach + turn * a * a * linear / reach * slope / q(b) * (0.5 * beta.sin().powi(2) - 1.0 / 6.0)) / w
                + turn * u * beta.cos().powi(2) / w;
        let along_beta =
            (turn * a * a / reach.sqrt() * q(u) / q(b) - turn * reach.sqrt()) * beta.sin() * beta.cos() / w;
        let (sin_b, cos_b) = beta.sin_cos();
        let out = along_u * u / (w * reach.sqrt()) * cos_b - along_beta * sin_b / w;
        let up = along_u * sin_b / w + along_beta * u / (w * reach.sqrt()) * cos_b;
        -(out * place.latitude_rad.cos() + up * place.latitude_rad.sin())
    }

    #[test]
    fn gravity_is_the_published_one() {
        // TR8350.2, table 3.4: theoretical gravity at the poles.
        assert!((EARTH.gravity_m_s2(at(90.0, 0.0)) - 9.832_184_937_8).abs() < 5e-10);
        // Theoretical gravity on the average over the ellipsoid, by its area: γ = 9.7976432222
        // m/s².
        let (mut sum, mut area) = (0.0, 0.0);
        for k in 0..20_000 {
            let latitude_deg = (f64::from(k) + 0.5) / 20_000.0 * 90.0;
            let radii = Radii::at(latitude_deg * DEGREE);
            let ring = radii.meridian_m * radii.prime_vertical_m * (latitude_deg * DEGREE).cos();
            sum += ring * EARTH.gravity_m_s2(at(latitude_deg, 0.0));
            area += ring;
        }
        assert!((sum / area - 9.797_643_222_2).abs() < 1e-9, "{}", sum / area);
        // The check sees a wrong Earth.
        assert!((Earth::FLAT.gravity_m_s2(at(90.0, 0.0)) - 9.832_184_937_8).abs() > 1e-2);
    }

    #[test]
    fn gravity_falls_with_height_as_the_closed_form() {
        for latitude_deg in [1.0, 30.0, 47.4, 60.0, 89.0] {
            for height_m in [0.0, 400.0, 10_000.0] {
                // What equation 4-3 leaves out: Bruns' gradient −γ(1/M + 1/N) − 2ω² differs from
                // its by 1.1e-10 1/s².
                let tolerance = 1e-8 + 1.3e-10 * height_m;
                let place = at(latitude_deg, height_m);
                let (got, expected) = (EARTH.gravity_m_s2(place), closed_form_m_s2(place));
                assert!((got - expected).abs() < tolerance, "{place:?}: {got}, closed form {expected}");
            }
        }
        // The first order in height alone would be wrong by 3 (h/a)² g at 10 km.
        let (low, mid, high) = (at(47.4, 0.0), at(47.4, 5_000.0), at(47.4, 10_000.0));
        let bend = EARTH.gravity_m_s2(low) + EARTH.gravity_m_s2(high) - 2.0 * EARTH.gravity_m_s2(mid);
        assert!(bend > 3e-6, "{bend}");
    }

    #[test]
    fn radii_are_the_published_ones() {
        // Torge & Müller, *Geodesy*, §4.1: at the pole both are a²/b = 6399593.6258 m, at the
        // equator b²/a = 6335439.3273 m.
        let (pole, equator) = (Radii::at(90.0 * DEGREE), Radii::at(0.0));
        assert!(
            (pole.meridian_m - 6_399_593.625_8).abs() < 1e-4 && (pole.prime_vertical_m - pole.meridian_m).abs() < 1e-6
        );
        assert!((equator.meridian_m - 6_335_439.327_3).abs() < 1e-4 && equator.prime_vertical_m == SEMI_MAJOR_AXIS_M);
        // The meridian's quadrant is 10001965.7293 m long.
        let step = std::f64::consts::FRAC_PI_2 / 10_000.0;
        let quadrant: f64 = (0..10_000).map(|k| Radii::at((f64::from(k) + 0.5) * step).meridian_m * step).sum();
        assert!((quadrant - 10_001_965.729_3).abs() < 1e-2, "{quadrant}");
    }

    #[test]
    fn the_level_turns_with_the_earth_and_with_the_way() {
        let rate = EARTH.rate_rad_s(at(30.0, 0.0));
        assert!((rate - RATE_RAD_S * Vector3::new(0.75f64.sqrt(), 0.0, -0.5)).norm() < 1e-18);
        // Once round the equator eastward in a day turns the level once about north.
        let speed = std::f64::consts::TAU * SEMI_MAJOR_AXIS_M / 86_400.0;
        let turn = EARTH.transport_rate_rad_s(at(0.0, 0.0), Vector3::new(0.0, speed, 0.0)) * 86_400.0;
        assert!((turn - Vector3::new(std::f64::consts::TAU, 0.0, 0.0)).norm() < 1e-12);
        // A degree of latitude at 45° is 111131.8 m long (Rapp, Geometric geodesy, §3.6).
        let [latitude, climb] = EARTH.place_rates(at(45.0, 0.0), Vector3::new(111_131.8, 0.0, -2.0));
        assert!((latitude / DEGREE - 1.0).abs() < 1e-5 && climb == 2.0);
        let still = Earth { rotation: false, ..EARTH };
        assert_eq!(still.rate_rad_s(at(30.0, 0.0)), Vector3::zeros());
        assert!(still.transport_rate_rad_s(at(30.0, 0.0), Vector3::x()).norm() > 1e-8);
        assert_eq!(Earth::FLAT.transport_rate_rad_s(at(30.0, 0.0), Vector3::x()), Vector3::zeros());
    }
}
