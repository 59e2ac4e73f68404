//! An IMU hand-rotated through still poses: gravity and rate in closed form, what the sensors
//! make of them planted.
//!
//! Turns are about one body axis each with a minimum-jerk profile, so that attitude and rate are
//! exact at any time.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use super::catalogue::catalogue;
use super::plant::{log_uniform, sign, uniform};
use proofmass_numerics::rng::{Philox, Stream};

/// Length of gravity where all of them are recorded, m/s².
pub(super) const GRAVITY_M_S2: f64 = 9.81;
/// The earth's rate, rad/s.
const EARTH_RAD_S: f64 = 7.292e-5;

catalogue! {
    /// Holds what can be planted in an IMU that is turned: axes that differ in scale or are not
    /// orthogonal (or not the accelerometer's), a gyro that follows specific force, an
    /// accelerometer scale that bends, offsets that follow a temperature given as a column, the
    /// earth's turning.
    Fault
    library {
        ScaleFactor,
        Misalignment,
        GSensitivity,
        ScaleNonlinearity,
        TemperatureSensitivity,
        EarthRate,
    }
    foreign {
        PoseHysteresis = "an accelerometer offset that remembers from which side each axis came",
        CrossAxisNonlinearity = "an accelerometer axis that follows the product of the two others",
        StickyAxis = "accelerometer axes that stick near zero",
        BiasJump = "an accelerometer offset that changes once, suddenly",
        SquareGSensitivity = "a gyro that follows the square of the specific force",
    }
}

/// A sensor fault with its size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Planted {
    /// Kind of fault.
    pub fault: Fault,
    /// States whether the fault is in the gyro.
    pub in_gyro: bool,
    /// Its matrix, vector (first row) or scalar, in SI units of the sensor's reading.
    pub values: [[f64; 3]; 3],
    /// rms change of the readings after offsets and a common scale are refitted, over the noise per
    /// sample.
    pub visible: f64,
}

/// The numbers of a tumble case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Turned {
    /// Seed of poses, turns and noise.
    pub seed: u64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Number of still poses.
    pub poses: usize,
    /// Counts per m/s² and per rad/s.
    pub scale: [f64; 2],
    /// Counts at rest, accelerometer then gyro.
    pub offset: [[f64; 3]; 2],
    /// Noise per sample, m/s² and rad/s.
    pub noise: [f64; 2],
    /// Planted faults.
    pub planted: Vec<Planted>,
}

/// Columns as the file will hold them, in counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// Accelerometer x, y, z, gyro x, y, z.
    pub readings: [Vec<f64>; 6],
    /// Temperature at each row, °C.
    pub temperature: Vec<f64>,
}

/// Holds what acts on the IMU at one sample.
struct Instant {
    force: Vector3<f64>,
    rate: Vector3<f64>,
    attitude: Rotation3<f64>,
    temperature: f64,
    /// Share of the recording that has passed.
    progress: f64,
    /// ±1 per axis: the side from which gravity's share in it came to this pose.
    came_from: Vector3<f64>,
}

/// Specific force below which an axis sticks, m/s².
const STICK_M_S2: f64 = 1.5;

/// Progress of a turn and its slope: the minimum-jerk profile.
fn minimum_jerk(s: f64) -> (f64, f64) {
    (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * (1.0 - s) * (1.0 - s))
}

impl Turned {
    /// An IMU with nothing planted.
    pub fn bare(rng: &mut impl Rng) -> Self {
        let scale = [log_uniform(rng, 100.0, 2000.0), log_uniform(rng, 1000.0, 20_000.0)];
        let mut offset = [[0.0; 3]; 2];
        offset.iter_mut().flatten().for_each(|o| *o = uniform(rng, -2000.0, 2000.0).round());
        Self {
            seed: rng.random(),
            rate_hz: uniform(rng, 50.0, 100.0).round(),
            poses: rng.random_range(26..=40),
            scale,
            offset,
            noise: [log_uniform(rng, 0.008, 0.05), log_uniform(rng, 0.001, 0.008)],
            planted: Vec::new(),
        }
    }

    /// Plants a fault of the size asked; see [`Planted::visible`]. The earth's rate is what it is.
    pub fn plant(&mut self, rng: &mut impl Rng, fault: Fault, size: f64) {
        let in_gyro = match fault {
            Fault::GSensitivity | Fault::EarthRate | Fault::SquareGSensitivity => true,
            Fault::ScaleFactor | Fault::Misalignment | Fault::TemperatureSensitivity => rng.random::<bool>(),
            _ => false,
        };
        let mut values = [[0.0; 3]; 3];
        for (i, row) in values.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                let used = match fault {
                    Fault::ScaleFactor => i == j,
                    // The accelerometer's own frame has z along its z axis: a rotation of all is no
                    // fault.
                    Fault::Misalignment => {
                        if in_gyro {
                            i != j
                        } else {
                            i < j
                        }
                    }
                    Fault::GSensitivity => true,
                    Fault::EarthRate => false,
                    _ => i == 0,
                };
                *value = if used { sign(rng) * uniform(rng, 0.4, 1.0) } else { 0.0 };
            }
        }
        if fault == Fault::EarthRate {
            // North and up at some latitude.
            let latitude = uniform(rng, 0.3, 1.2);
            values[0] = [EARTH_RAD_S * latitude.cos(), 0.0, EARTH_RAD_S * latitude.sin()];
            // Only a good gyro sees it, and a good one counts finely enough to show its own noise.
            self.noise[1] = log_uniform(rng, 2e-5, 2e-4);
            self.scale[1] = uniform(rng, 2.0, 20.0) / self.noise[1];
        }
        let mut planted = Planted { fault, in_gyro, values, visible: 0.0 };
        planted.visible = self.visible(&planted);
        if fault != Fault::EarthRate {
            let factor = size / planted.visible;
            planted.values.iter_mut().flatten().for_each(|v| *v *= factor);
            // Each fault is linear in its values.
            planted.visible = size;
        }
        self.planted.push(planted);
    }

    fn instants(&self) -> Vec<Instant> {
        let mut rng = Philox::new(self.seed, 1, Stream::Host);
        let mut own = Philox::new(self.seed, 2, Stream::Host);
        let mut normal = || own.normal();
        let mut attitude = Rotation3::identity();
        let mut came_from = Vector3::repeat(1.0);
        let mut instants = Vec::new();
        for pose in 0..self.poses {
            let still_s = if pose == 0 { 12.0 } else { uniform(&mut rng, 2.0, 4.0) };
            let turn_s = uniform(&mut rng, 0.8, 1.6);
            let axis = Unit::new_normalize(Vector3::from_fn(|_, _| normal()));
            let angle = uniform(&mut rng, 0.6, 2.4);
            let shove = Vector3::from_fn(|_, _| 0.6 * normal());
            let last = pose + 1 == self.poses;
            let count = ((still_s + if last { 0.0 } else { turn_s }) * self.rate_hz).round() as usize;
            let next = attitude * Rotation3::from_axis_angle(&axis, angle);
            let down = |attitude: &Rotation3<f64>| attitude.inverse() * Vector3::z();
            let goes = (down(&next) - down(&attitude)).map(f64::signum);
            for n in 0..count {
                let s = ((n as f64 / self.rate_hz - still_s) / turn_s).clamp(0.0, 1.0);
                let (progress, slope) = minimum_jerk(s);
                let here = attitude * Rotation3::from_axis_angle(&axis, angle * progress);
                // The hand also shoves it: there and back, at rest before and after.
                let push = shove * (std::f64::consts::TAU * s).sin();
                instants.push(Instant {
                    force: here.inverse() * (Vector3::new(0.0, 0.0, GRAVITY_M_S2) + push),
                    rate: axis.into_inner() * (angle * slope / turn_s),
                    attitude: here,
                    temperature: 0.0,
                    progress: 0.0,
                    came_from: if s < 0.5 { came_from } else { goes },
                });
            }
            (attitude, came_from) = (next, goes);
        }
        let total = instants.len() as f64;
        for (n, instant) in instants.iter_mut().enumerate() {
            let t = n as f64 / total;
            instant.progress = t;
            instant.temperature = (1.7 * std::f64::consts::PI * t).sin() + t;
        }
        instants
    }

    /// Returns what a fault adds to the readings of the two sensors, SI.
    fn added(planted: &Planted, at: &Instant) -> [Vector3<f64>; 2] {
        let matrix = Matrix3::from_fn(|i, j| planted.values[i][j]);
        let row = Vector3::from(planted.values[0]);
        let sensed = if planted.in_gyro { at.rate } else { at.force };
        let extra = match planted.fault {
            Fault::ScaleFactor | Fault::Misalignment => matrix * sensed,
            Fault::GSensitivity => matrix * at.force,
            Fault::ScaleNonlinearity => row.component_mul(&sensed.component_mul(&sensed)),
            Fault::TemperatureSensitivity => row * at.temperature,
            Fault::EarthRate => at.attitude.inverse() * row,
            Fault::PoseHysteresis => row.component_mul(&at.came_from),
            Fault::CrossAxisNonlinearity => {
                let f = at.force;
                row.component_mul(&Vector3::new(f.y * f.z, f.z * f.x, f.x * f.y))
            }
            Fault::StickyAxis => row.component_mul(&at.force.map(|f| -f * (-(f / STICK_M_S2).powi(2)).exp())),
            Fault::BiasJump => row * f64::from(u8::from(at.progress > 0.55)),
            Fault::SquareGSensitivity => row.component_mul(&at.force.component_mul(&at.force)),
        };
        if planted.in_gyro { [Vector3::zeros(), extra] } else { [extra, Vector3::zeros()] }
    }

    fn visible(&self, planted: &Planted) -> f64 {
        let sensor = usize::from(planted.in_gyro);
        let (mut added, mut sensed): (Vec<Vector3<f64>>, Vec<Vector3<f64>>) = self
            .instants()
            .iter()
            .map(|at| (Self::added(planted, at)[sensor], if planted.in_gyro { at.rate } else { at.force }))
            .unzip();
        let centre = |values: &mut Vec<Vector3<f64>>| {
            let mean = values.iter().sum::<Vector3<f64>>() / values.len() as f64;
            values.iter_mut().for_each(|v| *v -= mean);
        };
        centre(&mut added);
        centre(&mut sensed);
        let dot = |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let common = dot(&added, &sensed) / dot(&sensed, &sensed);
        let residual: f64 = added.iter().zip(&sensed).map(|(a, s)| (a - s * common).norm_squared()).sum();
        (residual / (3 * added.len()) as f64).sqrt() / self.noise[sensor]
    }

    /// Makes the recording, rounded to counts.
    pub fn render(&self) -> Counts {
        let mut rng = Philox::new(self.seed, 3, Stream::Host);
        let instants = self.instants();
        let mut readings: [Vec<f64>; 6] = Default::default();
        for at in &instants {
            let mut sensed = [at.force, at.rate];
            for planted in &self.planted {
                let added = Self::added(planted, at);
                sensed.iter_mut().zip(added).for_each(|(s, a)| *s += a);
            }
            for sensor in 0..2 {
                for axis in 0..3 {
                    let value = sensed[sensor][axis] + self.noise[sensor] * rng.normal();
                    let counts = self.offset[sensor][axis] + self.scale[sensor] * value;
                    readings[3 * sensor + axis].push(counts.round());
                }
            }
        }
        Counts { readings, temperature: instants.iter().map(|at| 25.0 + 2.0 * at.temperature).collect() }
    }

    /// A planted value by the library's symbol, where the frame that it refers to is the
    /// generator's own.
    pub fn parameter(&self, id: &str, name: &str) -> Option<f64> {
        let planted = self.planted.iter().find(|p| p.fault.id() == id)?;
        // K's entries, °/s/g, named by axes: k_xy is the y force in the x rate.
        let axes = name.strip_prefix("k_").filter(|_| planted.fault == Fault::GSensitivity)?;
        let mut index = axes.chars().map(|c| "xyz".find(c));
        let (i, j) = (index.next()??, index.next()??);
        Some(planted.values[i][j].to_degrees() * GRAVITY_M_S2)
    }

    /// Returns whether the temperature goes into the file.
    pub fn has_temperature(&self) -> bool {
        self.planted.iter().any(|p| p.fault == Fault::TemperatureSensitivity)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;

    #[test]
    fn gravity_keeps_its_length_in_every_pose_and_the_rate_integrates_to_the_attitude() {
        let case = Turned::bare(&mut Philox::new(6, 0, Stream::Host));
        let instants = case.instants();
        let still: Vec<&Instant> = instants.iter().filter(|at| at.rate.norm() == 0.0).collect();
        assert!(still.len() > instants.len() / 2);
        assert!(still.iter().all(|at| (at.force.norm() - GRAVITY_M_S2).abs() < 1e-9));
        // Steps of the attitude against the mean rate over the step: second order in the step.
        for pair in instants.windows(2) {
            // By quaternion: the angle of a nearly unit matrix is lost to rounding.
            let step = UnitQuaternion::from_rotation_matrix(&(pair[0].attitude.inverse() * pair[1].attitude));
            let mean = (pair[0].rate + pair[1].rate) / (2.0 * case.rate_hz);
            assert!((step.scaled_axis() - mean).norm() < 2e-3, "{} {}", step.scaled_axis(), mean);
        }
    }

    #[test]
    fn a_fault_has_the_size_asked_and_a_common_scale_is_none() {
        for &fault in Fault::LIBRARY.iter().chain(Fault::FOREIGN) {
            let mut rng = Philox::new(2, fault as u64, Stream::Host);
            let mut case = Turned::bare(&mut rng);
            case.plant(&mut rng, fault, 0.5);
            let planted = case.planted[0].clone();
            assert!((case.visible(&planted) / planted.visible - 1.0).abs() < 1e-9, "{fault:?}");
        }
        let case = Turned::bare(&mut Philox::new(3, 0, Stream::Host));
        let mut common = Planted { fault: Fault::ScaleFactor, in_gyro: false, values: [[0.0; 3]; 3], visible: 0.0 };
        (0..3).for_each(|i| common.values[i][i] = 0.01);
        assert!(case.visible(&common) < 1e-9);
    }
}
