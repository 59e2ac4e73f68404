//! True motion over one sample, shared by all members: what the navigation errors are integrated
//! about.
//!
//! Tabulated in f64 from the samples of a [`Truth`] and rounded once. Attitude is that in the
//! middle of the sample, forces and rates are means of its two ends. Not for readings: the axes'
//! own force is a [`Waveform`], see [`Along`].

use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::excitation::Waveform;
use crate::motion::earth::Radii;
use crate::motion::temperature::Temperature;
use crate::motion::{Earth, Place, Truth};
use crate::numerics::elementary::Real;

/// One sample of the truth as the kernels read it. Twin of `Passage` in `shaders/navigate.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage<T> {
    /// From body axes to north-east-down, row by row.
    pub attitude: [T; 9],
    /// Specific force in north-east-down, m/s².
    pub force: [T; 3],
    /// Rate of the local level against inertial space in north-east-down, rad/s.
    pub level_rate: [T; 3],
    /// Coriolis rate, twice the Earth's and once the transport rate, rad/s.
    pub coriolis_rate: [T; 3],
    /// Velocity over the Earth in north-east-down, m/s.
    pub velocity: [T; 3],
    /// One over the radius of the meridian, and of the prime vertical, at height, 1/m.
    pub curvature: [T; 2],
    /// Tangent of latitude.
    pub tangent: T,
    /// Longitude rate over the cosine of latitude: what a latitude error adds to the level's rate
    /// about down, rad/s.
    pub convergence: T,
    /// The Earth's rate times the sine and the cosine of latitude, rad/s.
    pub earth_rate: [T; 2],
    /// Growth of gravity along down, 1/s², and per radian of latitude, m/s².
    pub gravity: [T; 2],
    /// Specific force in body axes, m/s².
    pub body_force: [T; 3],
    /// Angular rate against inertial space in body axes, rad/s.
    pub body_rate: [T; 3],
    /// Temperature of the sensor above its reference, K.
    pub warmer: T,
    /// Growth of the body force, m/s³.
    pub force_change: [T; 3],
    /// Growth of the body rate, rad/s².
    pub rate_change: [T; 3],
}

/// Numbers of a passage as `shaders/navigate.wgsl` has them: eleven vectors of four, the last two
/// numbers unused.
pub const NUMBERS: usize = 44;

/// A truth with its Earth, and the places it passes.
#[derive(Debug, Clone)]
pub struct TimeFactor {
    /// The motion, one sample more than the run has.
    pub truth: Arc<Truth>,
    /// The Earth under it.
    pub earth: Earth,
    /// From the sensor's axes to the body's.
    mounting: UnitQuaternion<f64>,
    /// Place at every sample.
    places: Vec<Place>,
    /// Temperature of the sensor on the way.
    temperature: Temperature,
}

impl TimeFactor {
    /// The course of a body over an Earth, as a sensor mounted at this turn from its axes feels it.
    pub fn new(mut truth: Truth, earth: Earth, mounting: UnitQuaternion<f64>) -> Self {
        for sample in &mut truth.samples {
            sample.attitude *= mounting;
            sample.specific_force_m_s2 = mounting.inverse() * sample.specific_force_m_s2;
            sample.rate_rad_s = mounting.inverse() * sample.rate_rad_s;
        }
        let mut place = earth.start();
        let mut places = Vec::with_capacity(truth.samples.len());
        for pair in truth.samples.windows(2) {
            places.push(place);
            // Height is known, latitude is summed: mean velocity at the latitude half-way.
            let mean = 0.5 * (pair[0].velocity_m_s + pair[1].velocity_m_s);
            let half = place.moved(earth.place_rates(place, mean), 0.5 * truth.interval_s);
            place = place.moved(earth.place_rates(half, mean), truth.interval_s);
        }
        places.push(place);
        Self { truth: Arc::new(truth), earth, mounting, places, temperature: Temperature::default() }
    }

    /// The same with a sensor that is so warm on the way.
    pub fn with_temperature(self, temperature: Temperature) -> Self {
        Self { temperature, ..self }
    }

    /// Returns the temperature on the way.
    pub fn temperature(&self) -> &Temperature {
        &self.temperature
    }

    /// Returns the temperature of the sensor above its reference at the start, K.
    pub fn standing_warmer_k(&self) -> f64 {
        self.temperature.above_reference_k(0.0)
    }

    /// From the sensor's axes to the body's.
    pub fn mounting(&self) -> UnitQuaternion<f64> {
        self.mounting
    }

    /// Heading of the body at a sample, the last one if it is beyond, rad.
    pub fn heading_rad(&self, sample: u64) -> f64 {
        let at = (sample as usize).min(self.truth.samples.len().saturating_sub(1));
        self.truth.samples.get(at).map_or(0.0, |s| (s.attitude * self.mounting.inverse()).euler_angles().2)
    }

    /// Returns what accelerometers that stand still at the start read, without error, m/s², and
    /// what gyros do, rad/s.
    pub fn standing(&self) -> [Vector3<f64>; 2] {
        let place = self.place(0);
        let up = Vector3::new(0.0, 0.0, -self.earth.gravity_m_s2(place));
        let back = self.truth.samples.first().map_or_else(UnitQuaternion::identity, |s| s.attitude.inverse());
        [back * up, back * self.earth.rate_rad_s(place)]
    }

    /// Returns the place at a sample, the last one if it is beyond.
    pub fn place(&self, sample: u64) -> Place {
        self.places[(sample as usize).min(self.places.len() - 1)]
    }

    /// Returns the growth of gravity per metre along down, 1/s², and per radian of latitude, m/s².
    fn gravity_gradient(&self, at: Place) -> [f64; 2] {
        const METRES: f64 = 100.0;
        const RADIANS: f64 = 1e-4;
        let of = |latitude_rad: f64, height_m: f64| {
            let moved = Place { latitude_rad: at.latitude_rad + latitude_rad, height_m: at.height_m + height_m };
            self.earth.gravity_m_s2(moved)
        };
        let along = (of(0.0, -METRES) - of(0.0, METRES)) / (2.0 * METRES);
        [along, (of(RADIANS, 0.0) - of(-RADIANS, 0.0)) / (2.0 * RADIANS)]
    }

    /// Sample `n` in f64.
    pub fn passage(&self, n: u64) -> Passage<f64> {
        let last = self.truth.samples.len() - 1;
        let [before, after] = [n as usize, n as usize + 1].map(|i| &self.truth.samples[i.min(last)]);
        let mean = |of: fn(&crate::motion::Sample) -> Vector3<f64>| 0.5 * (of(before) + of(after));
        // Half-way along the shorter arc: consecutive quaternions may differ in sign.
        let half = before.attitude.try_slerp(&after.attitude, 0.5, 1e-9).unwrap_or(before.attitude);
        let attitude: Matrix3<f64> = half.to_rotation_matrix().into_inner();
        let force = 0.5 * (before.attitude * before.specific_force_m_s2 + after.attitude * after.specific_force_m_s2);
        let velocity = mean(|s| s.velocity_m_s);
        let (here, next) = (self.place(n), self.place(n + 1));
        let place = Place {
            latitude_rad: 0.5 * (here.latitude_rad + next.latitude_rad),
            height_m: 0.5 * (here.height_m + next.height_m),
        };
        let earth_rate = self.earth.rate_rad_s(place);
        let transport_rate = self.earth.transport_rate_rad_s(place, velocity);
        let round = self.earth.latitude_rad.is_some();
        let radii = Radii::at(place.latitude_rad);
        let curvature =
            [radii.meridian_m, radii.prime_vertical_m].map(|r| if round { 1.0 / (r + place.height_m) } else { 0.0 });
        let cosine = place.latitude_rad.cos();
        let tangent = place.latitude_rad.tan();
        Passage {
            attitude: std::array::from_fn(|i| attitude[(i / 3, i % 3)]),
            force: force.into(),
            level_rate: (earth_rate + transport_rate).into(),
            coriolis_rate: (2.0 * earth_rate + transport_rate).into(),
            velocity: velocity.into(),
            curvature,
            tangent,
            convergence: velocity.y * curvature[1] / (cosine * cosine),
            earth_rate: [-earth_rate.z, earth_rate.x],
            gravity: self.gravity_gradient(place),
            body_force: mean(|s| s.specific_force_m_s2).into(),
            body_rate: mean(|s| s.rate_rad_s).into(),
            warmer: self.temperature.above_reference_k((n as f64 + 0.5) * self.truth.interval_s),
            force_change: ((after.specific_force_m_s2 - before.specific_force_m_s2) / self.truth.interval_s).into(),
            rate_change: ((after.rate_rad_s - before.rate_rad_s) / self.truth.interval_s).into(),
        }
    }

    /// `count` samples from `first` on.
    pub fn table<T: Real>(&self, first: u64, count: u64) -> Vec<Passage<T>> {
        (first..first + count).map(|n| self.passage(n).rounded()).collect()
    }
}

impl Passage<f64> {
    /// In the order of its fields.
    pub fn numbers(&self) -> [f64; NUMBERS] {
        let parts: [&[f64]; 15] = [
            &self.attitude,
            &self.force,
            &self.level_rate,
            &self.coriolis_rate,
            &self.velocity,
            &self.curvature,
            &[self.tangent, self.convergence],
            &self.earth_rate,
            &self.gravity,
            &self.body_force,
            &self.body_rate,
            &[self.warmer],
            &self.force_change,
            &self.rate_change,
            &[0.0; 2],
        ];
        let mut all = parts.into_iter().flatten();
        std::array::from_fn(|_| all.next().copied().unwrap_or_default())
    }

    /// In the precision of a kernel.
    fn rounded<T: Real>(&self) -> Passage<T> {
        fn of<T: Real, const N: usize>(values: [f64; N]) -> [T; N] {
            values.map(T::of)
        }
        Passage {
            attitude: of(self.attitude),
            force: of(self.force),
            level_rate: of(self.level_rate),
            coriolis_rate: of(self.coriolis_rate),
            velocity: of(self.velocity),
            curvature: of(self.curvature),
            tangent: T::of(self.tangent),
            convergence: T::of(self.convergence),
            earth_rate: of(self.earth_rate),
            gravity: of(self.gravity),
            body_force: of(self.body_force),
            body_rate: of(self.body_rate),
            warmer: T::of(self.warmer),
            force_change: of(self.force_change),
            rate_change: of(self.rate_change),
        }
    }
}

/// The specific force along one body axis of a truth, straight between its samples. What a reading
/// at the end of a sample sees is the force in its middle: a reading is the mean over its sample,
/// and the attitude that turns it is the middle's.
pub struct Along {
    /// True motion of the flight.
    pub truth: Arc<Truth>,
    /// Which axis: 0, 1, 2.
    pub axis: usize,
    /// Specific force while it stands still before the motion, m/s².
    pub standing_m_s2: f64,
    /// Added to the motion: vibration.
    pub vibration: Option<Arc<dyn Waveform>>,
}

impl Along {
    fn without_vibration_m_s2(&self, time_s: f64) -> f64 {
        let samples = &self.truth.samples;
        let place = (time_s / self.truth.interval_s - 0.5).clamp(0.0, (samples.len() - 1) as f64);
        let before = (place as usize).min(samples.len().saturating_sub(2));
        let share = place - before as f64;
        let at = |i: usize| samples[i.min(samples.len() - 1)].specific_force_m_s2[self.axis];
        (1.0 - share) * at(before) + share * at(before + 1)
    }
}

impl Waveform for Along {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let vibration = self.vibration.as_ref().map_or(0.0, |v| v.specific_force_m_s2(time_s));
        self.without_vibration_m_s2(time_s) + vibration
    }

    fn before_m_s2(&self) -> f64 {
        self.without_vibration_m_s2(0.0)
    }

    fn standing_m_s2(&self) -> f64 {
        self.standing_m_s2
    }
}
