//! States where the search starts: the clocks laid on each other, the axes told apart, biases
//! roughly.
//!
//! Rates over short windows, of the reference by its attitudes and of the gyro by its integral, are
//! regressed on each other for every shift of the clocks: the shift that explains most is the one,
//! whatever the mounting. What is then left is a matrix: a rotation where the IMU is mounted at an
//! angle, a mirrored one where axes were exchanged.

use nalgebra::{Matrix3, Matrix3x4, Matrix4, Rotation3, UnitQuaternion, Vector3, Vector4};

use super::blocks::BLOCKS;
use super::integral::{Rule, between, cumulative, place};
use super::judgement::FALSE_NAME;
use super::log::{Log, Motion};
use super::permutation::{Permutation, SIGNED};
use super::rates::{Rates, SHIFTS_S, WINDOW_S};
use super::scatter::beyond;
use crate::numerics::order;

/// Most windows of specific forces that are compared.
const MOST: usize = 3000;
/// Square error by which the better of two ways to hold the axes must be smaller.
const BETTER: f64 = 0.5;

/// Weight of the axes as they are given, where an observation has one: what neither rates nor gravity
/// settle stays as it is given.
const SLIGHTLY: f64 = 1e-3;

/// An angle that the fit finds by itself, rad.
const SMALL_RAD: f64 = 0.2;

/// Part of a turn that the gyro reads, below which the rest of what the reference turns is its noise: a
/// regression on noise and as much of a signal has a slope of one half (Fuller, *Measurement error models*,
/// 1987, §1.1).
const SHOWN: f64 = 0.5;

/// States where the search starts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Start {
    /// By how much the IMU stamps late, s.
    pub offset_s: f64,
    /// Share of the gyro's variance that the reference explains at that shift.
    pub explained: f64,
    /// Holds what one unit of the gyro is in rad/s by the reference; 1 where all is well.
    pub gyro_unit: f64,
    /// Which axes the gyro's columns read.
    pub gyro: Permutation,
    /// Which axes the accelerometer's columns read.
    pub accelerometer: Permutation,
    /// From the IMU's axes to the reference's body axes.
    pub turned: UnitQuaternion<f64>,
    /// Chance that these axes fit so much better than those as given, corrected for the ways that
    /// were tried; 1 where as given.
    pub chance_exchanged: f64,
    /// The same of the rotation against none.
    pub chance_turned: f64,
    /// Mean square by which the specific force misses the reference's, in those axes, (m/s²)².
    pub force_square: f64,
    /// Bias of the gyro in its own axes, rad/s.
    pub gyro_bias: Vector3<f64>,
    /// Bias of the accelerometer in its own axes, m/s².
    pub force_bias: Vector3<f64>,
}

impl Start {
    /// With axes as they are given, and body axes that are the IMU's; biases of gyro and
    /// accelerometer.
    pub(super) fn as_given(offset_s: f64, explained: f64, [gyro_bias, force_bias]: [Vector3<f64>; 2]) -> Self {
        Self {
            offset_s,
            explained,
            gyro_unit: 1.0,
            gyro: Permutation::NONE,
            accelerometer: Permutation::NONE,
            turned: UnitQuaternion::identity(),
            chance_exchanged: 1.0,
            chance_turned: 1.0,
            force_square: 0.0,
            gyro_bias,
            force_bias,
        }
    }
}

/// Axes of gyro and accelerometer, and the mounting.
type Axes = (Permutation, Permutation, UnitQuaternion<f64>);

/// Mean vectors of both over the same windows.
struct Pairs {
    reference: Vec<Vector3<f64>>,
    read: Vec<Vector3<f64>>,
}

impl Pairs {
    /// read = M reference + b in least squares, with the fraction of the variance of `read` that
    /// this explains.
    fn regression(&self) -> (Matrix3<f64>, Vector3<f64>, f64) {
        let count = self.read.len().max(1) as f64;
        let mean = self.read.iter().sum::<Vector3<f64>>() / count;
        let (mut normal, mut cross) = (Matrix4::zeros(), Matrix3x4::zeros());
        for (x, y) in self.reference.iter().zip(&self.read) {
            let x = Vector4::new(x.x, x.y, x.z, 1.0);
            normal += x * x.transpose();
            cross += y * x.transpose();
        }
        let ridge = Matrix4::from_diagonal(&Vector4::new(1e-9, 1e-9, 1e-9, 0.0)) * count;
        let Some(inverse) = (normal + ridge).try_inverse() else { return (Matrix3::identity(), mean, 0.0) };
        let both = cross * inverse;
        let (matrix, bias) = (both.fixed_view::<3, 3>(0, 0).into_owned(), both.column(3).into_owned());
        let (mut unexplained, mut all) = (0.0, 0.0);
        for (x, y) in self.reference.iter().zip(&self.read) {
            unexplained += (y - matrix * x - bias).norm_squared();
            all += (y - mean).norm_squared();
        }
        (matrix, bias, 1.0 - unexplained / f64::max(all, f64::MIN_POSITIVE))
    }

    /// The axis of most of the reference's turns, where turns about another one do not show in what is read:
    /// the regression errs there by more than an angle that the fit finds by itself, or what the reference
    /// turns there is its own noise, of which the gyro reads nothing.
    fn open_but_for(&self, matrix: &Matrix3<f64>) -> Option<Vector3<f64>> {
        let mean = self.reference.iter().sum::<Vector3<f64>>() / self.reference.len().max(1) as f64;
        let spread: Matrix3<f64> = self.reference.iter().map(|x| (x - mean) * (x - mean).transpose()).sum();
        let eigen = spread.symmetric_eigen();
        let first = eigen.eigenvalues.imax();
        let axis = |i: usize| eigen.eigenvectors.column(i).into_owned();
        let others = || (0..3).filter(|i| *i != first);
        let second = others().map(|i| eigen.eigenvalues[i]).fold(0.0, f64::max);
        // Of one axis of what is read, the residual is a third.
        let variance = self.residual(matrix).0 / 3.0;
        let whole = (matrix * axis(first)).norm();
        let unread = others().any(|i| (matrix * axis(i)).norm() < SHOWN * whole);
        (unread || variance > SMALL_RAD * SMALL_RAD * second).then(|| axis(first))
    }

    /// Attitude profile of Wahba's problem (SIAM Review 7 (1965) 409): read times reference, of length one at
    /// most.
    fn profile(&self) -> Matrix3<f64> {
        let pairs = || self.read.iter().zip(&self.reference);
        let size: f64 = pairs().map(|(y, x)| y.norm() * x.norm()).sum();
        pairs().map(|(y, x)| y * x.transpose()).sum::<Matrix3<f64>>() / size.max(f64::MIN_POSITIVE)
    }

    /// Chance that one matrix fits by so much better than another: ratios of the squares of blocks
    /// of time, Student's t.
    fn better(&self, one: &Matrix3<f64>, other: &Matrix3<f64>) -> f64 {
        let biases = [one, other].map(|m| self.residual(m).1);
        let mut blocks = vec![[f64::MIN_POSITIVE; 2]; BLOCKS];
        for (k, (x, y)) in self.reference.iter().zip(&self.read).enumerate() {
            let block = &mut blocks[k * BLOCKS / self.read.len()];
            block[0] += (y - one * x - biases[0]).norm_squared();
            block[1] += (y - other * x - biases[1]).norm_squared();
        }
        // Of ratios, so that the quickest motion does not drown the rest.
        let blocks: Vec<f64> = blocks.iter().map(|[one, other]| (other / one).ln()).collect();
        let n = BLOCKS as f64;
        let mean = blocks.iter().sum::<f64>() / n;
        let variance = blocks.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (n - 1.0);
        beyond(mean, (variance / n).sqrt(), n)
    }

    /// Mean square that a fixed matrix leaves, with the best bias, and that bias.
    fn residual(&self, matrix: &Matrix3<f64>) -> (f64, Vector3<f64>) {
        let count = self.read.len().max(1) as f64;
        let differences: Vec<Vector3<f64>> =
            self.reference.iter().zip(&self.read).map(|(x, y)| y - matrix * x).collect();
        let bias = Vector3::from_fn(|i, _| order::median(differences.iter().map(|d| d[i]).collect()).unwrap_or(0.0));
        (differences.iter().map(|d| (d - bias).norm_squared()).sum::<f64>() / count, bias)
    }
}

/// Lays one on the other; masked readings are left out.
pub(super) fn start(log: &Log, masked: &[bool], motion: &Motion, gravity_m_s2: f64) -> Start {
    let rates = Rates::some(log, masked, motion);
    let at = |shift_s: f64| -> Pairs {
        let both = rates.windows.iter().filter_map(|w| Some((w.rate, rates.read(w, shift_s)?)));
        let (reference, read) = both.unzip();
        Pairs { reference, read }
    };
    let score = |shift_s: f64| at(shift_s).regression().2;
    let count = (SHIFTS_S.0 / SHIFTS_S.1) as i32;
    let scores: Vec<(f64, f64)> =
        (-count..=count).map(|k| f64::from(k) * SHIFTS_S.1).map(|shift| (shift, score(shift))).collect();
    let best = scores.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, 0.0));
    let offset_s = refined(best.0, SHIFTS_S.1, score);
    let pairs = at(offset_s);
    let (regressed, _, explained) = pairs.regression();
    let forces = forces(log, motion, offset_s, gravity_m_s2);
    let (matrix, gyro_unit) = match pairs.open_but_for(&regressed) {
        // About one axis the rates leave a turn about it open, and about two a mirror: gravity settles both.
        Some(axis) => {
            (nearest(&(pairs.profile() + forces.profile() + SLIGHTLY * Matrix3::identity())), (regressed * axis).norm())
        }
        None => (regressed, regressed.determinant().abs().cbrt()),
    };
    let expected = |(gyro, accelerometer, turned): &Axes| {
        [gyro, accelerometer].map(|p| p.matrix() * turned.inverse().to_rotation_matrix().matrix())
    };
    // By either sensor, of all ways to exchange three axes.
    let chance = |one: &Axes, other: &Axes| {
        let (one, other) = (expected(one), expected(other));
        let least = pairs.better(&one[0], &other[0]).min(forces.better(&one[1], &other[1]));
        (2.0 * SIGNED.len() as f64 * least).min(1.0)
    };
    let none = Permutation::NONE;
    let as_given = (none, none, of_matrix(&nearest(&matrix).transpose()));
    let mut found = axes(&matrix, &forces);
    let mut chance_exchanged = 1.0;
    if (found.0, found.1) != (none, none) {
        chance_exchanged = chance(&found, &as_given);
        if chance_exchanged >= FALSE_NAME {
            (found, chance_exchanged) = (as_given, 1.0);
        }
    }
    let chance_turned = chance(&found, &(found.0, found.1, UnitQuaternion::identity()));
    let matrices = expected(&found);
    let (gyro, accelerometer, turned) = found;
    let gyro_bias = gyro.matrix().transpose() * pairs.residual(&matrices[0]).1;
    let (force_square, bias) = forces.residual(&matrices[1]);
    let force_bias = accelerometer.matrix().transpose() * bias;
    Start {
        offset_s,
        explained,
        gyro_unit,
        gyro,
        accelerometer,
        turned,
        chance_exchanged,
        chance_turned,
        force_square,
        gyro_bias,
        force_bias,
    }
}

/// The top of a score near a place, by halving the step.
pub(super) fn refined(mut at: f64, mut step: f64, score: impl Fn(f64) -> f64) -> f64 {
    let mut best = score(at);
    while step > 2e-4 {
        step *= 0.5;
        for trial in [at - step, at + step] {
            let value = score(trial);
            if value > best {
                (at, best) = (trial, value);
            }
        }
    }
    at
}

/// A window of time: how the reference's positions accelerate in it, and what the accelerometer reads.
pub(super) struct Accelerated {
    /// The pose in its middle.
    pub pose: usize,
    /// North, east and down, m/s².
    pub acceleration: Vector3<f64>,
    /// Mean specific force in the IMU's axes, m/s².
    pub read: Vector3<f64>,
}

/// Windows of the reference, of three poses each, where the IMU stamps so much later.
pub(super) fn accelerated(log: &Log, motion: &Motion, offset_s: f64) -> Vec<Accelerated> {
    let reach = ((2.0 * WINDOW_S / motion.interval_s).round() as usize).max(1);
    let velocity = cumulative(&log.time_s, &log.force, Rule::Straight);
    let (first, last) = (log.time_s[0], log.time_s[log.time_s.len() - 1]);
    let count = motion.time_s.len();
    let every = (count / MOST).max(reach / 2).max(1);
    let mut all = Vec::new();
    for pose in (reach..count.saturating_sub(reach)).step_by(every) {
        let (before, middle, after) = (motion.time_s[pose - reach], motion.time_s[pose], motion.time_s[pose + reach]);
        let half = 0.5 * (after - before);
        let [from, to] = [middle - 0.5 * half, middle + 0.5 * half].map(|t| t + offset_s);
        if from < first || to > last || half > 3.0 * reach as f64 * motion.interval_s {
            continue;
        }
        let way = motion.position[pose + reach] + motion.position[pose - reach] - motion.position[pose] * 2.0;
        let end = |t: f64| between(&log.time_s, &velocity, &log.force, place(&log.time_s, t));
        all.push(Accelerated { pose, acceleration: way / (half * half), read: (end(to) - end(from)) / (to - from) });
    }
    all
}

/// Mean specific forces over windows: the reference's, in its body axes, and those read.
fn forces(log: &Log, motion: &Motion, offset_s: f64, gravity_m_s2: f64) -> Pairs {
    let felt = |window: &Accelerated| {
        let force = window.acceleration - Vector3::new(0.0, 0.0, gravity_m_s2);
        (motion.attitude[window.pose].inverse_transform_vector(&force), window.read)
    };
    let (reference, read) = accelerated(log, motion, offset_s).iter().map(felt).unzip();
    Pairs { reference, read }
}

/// Which axes each sensor's columns read, and how the IMU is mounted.
fn axes(matrix: &Matrix3<f64>, forces: &Pairs) -> Axes {
    let none = Permutation::NONE;
    let rotation = |of: &Matrix3<f64>| nearest(of).transpose();
    // A gyro whose axes are held as they are, or exchanged: the one of 48 ways that comes nearest
    // to a small mounting, where nothing but an exchange makes a mirrored matrix of it.
    let (gyro, turned) = if matrix.determinant() >= 0.0 {
        (none, rotation(matrix))
    } else {
        let closest = SIGNED.iter().filter(|p| p.matrix().determinant() < 0.0);
        let apart = |p: &&Permutation| (p.matrix() - matrix).norm();
        let best = closest.min_by(|a, b| apart(a).total_cmp(&apart(b))).copied().unwrap_or(none);
        (best, rotation(&(best.matrix().transpose() * matrix)))
    };
    // The accelerometer with that mounting: as it is, or exchanged.
    let square = |p: &Permutation, turned: &Matrix3<f64>| forces.residual(&(p.matrix() * turned.transpose())).0;
    let best_of = |turned: &Matrix3<f64>| {
        let best =
            SIGNED.iter().copied().min_by(|a, b| square(a, turned).total_cmp(&square(b, turned))).unwrap_or(none);
        if square(&best, turned) < BETTER * square(&none, turned) { best } else { none }
    };
    let accelerometer = best_of(&turned);
    // Both exchanged alike is a mounting; a gyro turned by right angles that the accelerometer
    // denies is an exchange.
    let right = SIGNED.iter().copied().find(|p| *p != none && (p.matrix() - turned.transpose()).norm() < 0.3);
    if let (Some(right), true) = (right, gyro == none && accelerometer != none) {
        let rest = rotation(&(right.matrix().transpose() * matrix));
        if best_of(&rest) == none {
            return (right, none, of_matrix(&rest));
        }
    }
    (gyro, accelerometer, of_matrix(&turned))
}

/// The rotation that comes nearest to a matrix.
pub(super) fn nearest(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    let sign = (u * v).determinant().signum();
    u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v
}

/// A mounting that is no small angle: right angles where it comes near to them, itself else. Small
/// angles are for the fit, which tells them from misalignment.
fn of_matrix(matrix: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let right = SIGNED.iter().map(Permutation::matrix).filter(|p| p.determinant() > 0.0);
    let near = right.into_iter().find(|p| angle(&(p.transpose() * matrix)) < SMALL_RAD);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(near.unwrap_or(*matrix)))
}

/// Angle of a rotation, rad.
fn angle(matrix: &Matrix3<f64>) -> f64 {
    (0.5 * (matrix.trace() - 1.0)).clamp(-1.0, 1.0).acos()
}
