//! The linear error model of strapdown navigation in north-east-down: nine states, attitude (rad),
//! velocity (m/s) and position (m), driven by the readings' errors in body axes.
//!
//! Written from the perturbed navigation equations (Titterton & Weston, *Strapdown Inertial
//! Navigation Technology*, 2nd ed., §12.3; Groves, *Principles of GNSS, Inertial, and Multisensor
//! Integrated Navigation Systems*, 2nd ed., §14.2), apart from the kernels, which it is the oracle
//! of.

use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::kernel::flight::Vertical;
use crate::kernel::truth_step::{Passage, TimeFactor};

/// Attitude, velocity, position.
pub(super) type Square = SMatrix<f64, 9, 9>;
/// Effect of accelerometers (first three) and gyros on them.
pub(super) type Drive = SMatrix<f64, 9, 6>;

/// The model over some time: x′ = F x + B u.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// F: derivative of the errors by the errors.
    pub dynamics: Square,
    /// B: derivative of the errors by the inputs.
    pub drive: Drive,
    /// Motion that the sensor feels.
    pub felt: Felt,
}

/// Motion that a sensor feels, in body axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Felt {
    /// Specific force that is felt, m/s².
    pub force: Vector3<f64>,
    /// Angular rate, rad/s.
    pub rate: Vector3<f64>,
    /// Growth of the force, m/s³.
    pub force_change: Vector3<f64>,
    /// Growth of the rate, rad/s².
    pub rate_change: Vector3<f64>,
    /// Temperature of the sensor above its reference, K.
    pub warmer_k: f64,
}

impl Felt {
    /// Of the body at rest, before the motion.
    pub fn standing(course: &TimeFactor) -> Self {
        let [force, rate] = course.standing();
        Self { force, rate, warmer_k: course.standing_warmer_k(), ..Self::default() }
    }

    /// Adds a share of another.
    fn add(&mut self, other: &Self, share: f64) {
        self.force += other.force * share;
        self.rate += other.rate * share;
        self.force_change += other.force_change * share;
        self.rate_change += other.rate_change * share;
        self.warmer_k += other.warmer_k * share;
    }
}

/// Samples of a step at which the truth is asked.
const ASKED: u64 = 4;

impl Model {
    /// The mean model over samples `from` to `until` of a course.
    pub fn over(course: &TimeFactor, vertical: Vertical, from: u64, until: u64) -> Self {
        let count = (until - from).clamp(1, ASKED);
        let mut sum = Self { dynamics: Square::zeros(), drive: Drive::zeros(), felt: Felt::default() };
        for k in 0..count {
            let n = from + (2 * k + 1) * (until - from) / (2 * count);
            let one = Self::at(&course.passage(n), vertical);
            sum.dynamics += one.dynamics / count as f64;
            sum.drive += one.drive / count as f64;
            sum.felt.add(&one.felt, 1.0 / count as f64);
        }
        sum
    }

    fn at(p: &Passage<f64>, vertical: Vertical) -> Self {
        let turn = Matrix3::from_row_slice(&p.attitude);
        let [north_m, east_m] = p.curvature;
        let v = Vector3::from(p.velocity);
        // Errors of latitude, of the Earth's rate and of the transport rate that follow from
        // velocity and position errors.
        let earth =
            Matrix3::new(-p.earth_rate[0] * north_m, 0.0, 0.0, 0.0, 0.0, 0.0, -p.earth_rate[1] * north_m, 0.0, 0.0);
        let by_velocity = Matrix3::new(0.0, east_m, 0.0, -north_m, 0.0, 0.0, 0.0, -east_m * p.tangent, 0.0);
        let by_height =
            Vector3::new(v.y * east_m * east_m, -v.x * north_m * north_m, -v.y * east_m * east_m * p.tangent);
        let mut by_position = Matrix3::zeros();
        by_position.set_column(2, &by_height);
        by_position[(2, 0)] -= p.convergence * north_m;
        let level = by_position + earth;
        let moving = v.cross_matrix();
        let mut gravity = Matrix3::zeros();
        gravity[(2, 2)] = p.gravity[0];
        gravity[(2, 0)] = p.gravity[1] * north_m;
        let mut dynamics = Square::zeros();
        let mut put = |row: usize, column: usize, block: Matrix3<f64>| {
            dynamics.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&block);
        };
        put(0, 0, -Vector3::from(p.level_rate).cross_matrix());
        put(0, 1, -by_velocity);
        put(0, 2, -level);
        // φ × f = −f × φ; an error e of the rate adds −e × v = v × e.
        put(1, 0, -Vector3::from(p.force).cross_matrix());
        put(1, 1, -Vector3::from(p.coriolis_rate).cross_matrix() + moving * by_velocity);
        put(1, 2, moving * (level + earth) + gravity);
        put(2, 1, Matrix3::identity());
        put(
            2,
            2,
            Matrix3::new(
                -v.z * north_m,
                0.0,
                v.x * north_m,
                v.y * p.tangent * north_m,
                -v.z * east_m - v.x * north_m * p.tangent,
                v.y * east_m,
                0.0,
                0.0,
                0.0,
            ),
        );
        let mut drive = Drive::zeros();
        drive.fixed_view_mut::<3, 3>(0, 3).copy_from(&turn);
        drive.fixed_view_mut::<3, 3>(3, 0).copy_from(&turn);
        if vertical == Vertical::Held {
            for down in [5, 8] {
                dynamics.row_mut(down).fill(0.0);
                drive.row_mut(down).fill(0.0);
            }
        }
        let felt = Felt {
            force: p.body_force.into(),
            rate: p.body_rate.into(),
            force_change: p.force_change.into(),
            rate_change: p.rate_change.into(),
            warmer_k: p.warmer,
        };
        Self { dynamics, drive, felt }
    }
}

/// A model stepped: x(t + Δ) = Φ x + Γ u, u held.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Φ: errors after the step per error before.
    pub transition: Square,
    /// Γ: errors after the step per constant input.
    pub response: Drive,
    /// Δ, s.
    pub seconds: f64,
    model: Model,
}

/// Terms of the exponential series: steps are short.
const TERMS: u32 = 8;

impl Step {
    /// A model over `seconds`.
    pub fn new(model: Model, seconds: f64) -> Self {
        let scaled = model.dynamics * seconds;
        let (mut power, mut transition, mut mean) = (Square::identity(), Square::identity(), Square::identity());
        for k in 1..=TERMS {
            power = power * scaled / f64::from(k);
            transition += power;
            mean += power / f64::from(k + 1);
        }
        Self { transition, response: mean * model.drive * seconds, seconds, model }
    }

    /// ∫ e^{Fs} B q Bᵀ e^{Fᵀs} ds over the step for white inputs of these densities, unit²·s: Van
    /// Loan's integral (*Computing integrals involving the matrix exponential*, 1978), by its
    /// series Σ Δᵏ/k! Lᵏ⁻¹ with L X = F X + X Fᵀ.
    pub fn white(&self, density: &[f64; 6]) -> Square {
        let mut scaled = self.model.drive;
        (0..6).for_each(|i| scaled.column_mut(i).scale_mut(density[i]));
        self.accumulated(scaled * self.model.drive.transpose() * self.seconds)
    }

    /// The same for one white input that acts on all six by this much each.
    pub fn white_along(&self, inputs: &SMatrix<f64, 6, 1>, density: f64) -> Square {
        let driven = self.model.drive * inputs;
        self.accumulated(driven * driven.transpose() * (density * self.seconds))
    }

    /// Returns what white inputs of this first term add up to over the step, carried on by the
    /// dynamics.
    fn accumulated(&self, mut power: Square) -> Square {
        let mut sum = power;
        for k in 2..=TERMS {
            let half = self.model.dynamics * power * (self.seconds / f64::from(k));
            power = half + half.transpose();
            sum += power;
        }
        sum
    }

    /// Motion that the sensor feels.
    pub fn felt(&self) -> &Felt {
        &self.model.felt
    }
}
