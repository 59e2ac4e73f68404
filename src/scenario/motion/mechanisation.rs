//! The strapdown navigator in f64: increments of rotation and velocity to attitude, velocity and
//! position over the Earth.
//!
//! Local-level mechanisation with attitude as a quaternion (Savage, *Strapdown inertial navigation
//! integration algorithm design*, J. Guidance, Control and Dynamics 21, 1998; Groves, §5.5). The
//! sensors integrate: an increment is the exact integral of rate or specific force over a sampling
//! interval. Not for errors of sensors: what this navigator errs on perfect increments is its [own
//! error](`own_error`).

mod increments;
mod own_error;

use nalgebra::{UnitQuaternion, Vector3};

pub use increments::{Increment, increments, integrals};
pub use own_error::{Correction, Run, own_error};

use super::earth::{Earth, Place};
use super::truth::Sample;

/// Treatment of motion within a sampling interval.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Assumes a constant axis of rotation and direction of force within it.
    SingleSample,
    /// Corrects coning and sculling from this increment and the one before (Savage's two-sample
    /// terms).
    #[default]
    Compensated,
}

/// Error of a navigator against the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Attitude as a rotation vector in north-east-down, rad.
    pub attitude_rad: Vector3<f64>,
    /// Velocity error, north-east-down, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Position error, north-east-down, m.
    pub position_m: Vector3<f64>,
}

impl Difference {
    /// Error of a state against a sample of the truth.
    pub fn of(state: &State, truth: &Sample) -> Self {
        Self {
            attitude_rad: (state.attitude * truth.attitude.inverse()).scaled_axis(),
            velocity_m_s: state.velocity_m_s - truth.velocity_m_s,
            position_m: state.position_m - truth.position_m,
        }
    }
}

/// A navigator's estimate of attitude, velocity and position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Rotation from body axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// Velocity over the Earth in north-east-down, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Position in north-east-down from the start, m.
    pub position_m: Vector3<f64>,
    /// Latitude and height, for gravity and the turning of the level.
    pub place: Place,
}

impl State {
    /// The truth at the start of a motion.
    pub fn at_start(earth: &Earth, truth: &Sample) -> Self {
        Self {
            attitude: truth.attitude,
            velocity_m_s: truth.velocity_m_s,
            position_m: truth.position_m,
            place: earth.start(),
        }
    }

    /// Takes off what an aid finds wrong with attitude, velocity and position.
    fn correct(&mut self, earth: &Earth, error: &Difference) {
        self.attitude = UnitQuaternion::from_scaled_axis(-error.attitude_rad) * self.attitude;
        self.velocity_m_s -= error.velocity_m_s;
        self.position_m -= error.position_m;
        // As far as a velocity goes in a second.
        self.place = self.place.moved(earth.place_rates(self.place, -error.position_m), 1.0);
    }

    /// Puts the vertical channel where the truth is: a navigator whose height is aided.
    pub fn hold_vertical(&mut self, earth: &Earth, truth: &Sample) {
        self.velocity_m_s.z = truth.velocity_m_s.z;
        self.position_m.z = truth.position_m.z;
        self.place.height_m = earth.height_m - truth.position_m.z;
    }
}

/// A navigator at work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Navigator {
    /// Its current estimate of attitude, velocity and position.
    pub state: State,
    earth: Earth,
    integrator: Integrator,
    interval_s: f64,
    /// Increment of the interval before.
    before: Option<Increment>,
    /// Change of velocity over the interval before, m/s.
    gained_m_s: Vector3<f64>,
}

impl Navigator {
    /// Begins at a state, with increments of one length.
    pub fn new(earth: Earth, integrator: Integrator, interval_s: f64, state: State) -> Self {
        Self { state, earth, integrator, interval_s, before: None, gained_m_s: Vector3::zeros() }
    }

    /// Rotation vector and change of velocity, in the body axes at the start of the interval.
    fn in_starting_axes(&self, now: Increment) -> (Vector3<f64>, Vector3<f64>) {
        let turned = now.velocity_m_s + 0.5 * now.rotation_rad.cross(&now.velocity_m_s);
        match (self.integrator, self.before) {
            (Integrator::Compensated, Some(before)) => {
                let coning = before.rotation_rad.cross(&now.rotation_rad) / 12.0;
                let sculling = (before.rotation_rad.cross(&now.velocity_m_s)
                    + before.velocity_m_s.cross(&now.rotation_rad))
                    / 12.0;
                // The rotation of a constant direction of force, beyond its first order.
                let rotation = now.rotation_rad;
                let bent = rotation.cross(&rotation.cross(&now.velocity_m_s)) / 6.0;
                (rotation + coning, turned + sculling + bent)
            }
            _ => (now.rotation_rad, turned),
        }
    }

    /// Goes on by one increment.
    pub fn step(&mut self, now: Increment) {
        let (earth, dt, start) = (self.earth, self.interval_s, self.state);
        let (rotation, velocity) = self.in_starting_axes(now);
        // Earth and level in the middle of the interval, with the velocity that goes on as it did.
        let middle = start.velocity_m_s + 0.5 * self.gained_m_s;
        let place = start.place.moved(earth.place_rates(start.place, middle), 0.5 * dt);
        let (earth_rate, transport) = (earth.rate_rad_s(place), earth.transport_rate_rad_s(place, middle));
        let level_turn = (earth_rate + transport) * dt;
        let pushed = start.attitude * velocity;
        let gravity = Vector3::new(0.0, 0.0, earth.gravity_m_s2(place));
        let gained =
            pushed - 0.5 * level_turn.cross(&pushed) + (gravity - (2.0 * earth_rate + transport).cross(&middle)) * dt;
        let mut attitude =
            UnitQuaternion::from_scaled_axis(-level_turn) * start.attitude * UnitQuaternion::from_scaled_axis(rotation);
        attitude.renormalize();
        let end = start.velocity_m_s + gained;
        let mean = 0.5 * (start.velocity_m_s + end);
        self.state = State {
            attitude,
            velocity_m_s: end,
            position_m: start.position_m + mean * dt,
            place: start.place.moved(earth.place_rates(start.place, mean), dt),
        };
        (self.before, self.gained_m_s) = (Some(now), gained);
    }
}

#[cfg(test)]
mod tests;
