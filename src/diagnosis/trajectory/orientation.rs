//! Checks against the IMU that the reference's quaternions were read in the right convention. Every
//! other convention in use is tried too; where one fits far better, the error names it.
//!
//! The gyro tells the order of a quaternion's numbers and the sense of its rotation; the specific
//! force tells whether attitudes and positions are of one frame. A reference that is mirrored as a
//! whole turns like one that is not, with the body on its head and gravity pulling up.

use nalgebra::{Quaternion, UnitQuaternion};

use super::faults;
use super::log::{Log, Motion};
use super::permutation::Permutation;
use super::start::{Start, start};
use crate::motion::file::format::Order;

/// Holds what is wrong with how attitudes were read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// The scalar stands at the other end than was taken.
    Order {
        /// States where it was taken to stand.
        taken: Order,
    },
    /// The rotations go from world to body.
    Inverse,
    /// Quaternions of a left-handed system, or of another frame than the positions.
    LeftHanded,
    /// Positions and attitudes alike are mirrored.
    Mirrored,
}

/// Unexplained share of the gyro, and square error of the specific force, over those of the reading
/// at hand, below which another one fits far better: a wrong convention leaves most of the error,
/// the right one noise.
const FAR_BETTER: f64 = 0.25;
/// Share of the gyro's variance that the better reading explains.
const EXPLAINS: f64 = 0.5;
/// Explained share above which axes as they are given raise no suspicion.
const SOUND: f64 = 0.9;
/// By how much less of the gyro a reading may explain that the specific force prefers.
const AS_WELL: f64 = 0.02;

/// Signs of x, y and z of a quaternion, other than as they are.
const SIGNS: [[f64; 3]; 7] = [
    [-1.0, -1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
];

/// The other readings, each with what is wrong where it is the right one.
fn others(motion: &Motion) -> Vec<(Fault, Motion)> {
    let read = |of: &dyn Fn(&Quaternion<f64>) -> Quaternion<f64>| {
        let one = |q: &UnitQuaternion<f64>| {
            motion.turn * UnitQuaternion::from_quaternion(of((motion.turn.inverse() * q).quaternion()))
        };
        Motion { attitude: motion.attitude.iter().map(one).collect(), ..motion.clone() }
    };
    let signed = |s: [f64; 3]| read(&|q| Quaternion::new(q.w, s[0] * q.i, s[1] * q.j, s[2] * q.k));
    let mut all: Vec<(Fault, Motion)> = Vec::new();
    if let Some(taken) = motion.quaternion {
        all.push((Fault::Order { taken }, read(&|q| taken.at_other_end(q))));
    }
    let fault = |n: usize| if n == 0 { Fault::Inverse } else { Fault::LeftHanded };
    all.extend(SIGNS.iter().enumerate().map(|(n, s)| (fault(n), signed(*s))));
    all
}

/// Returns what is wrong with the reference's attitudes, if another reading of them fits far
/// better.
///
/// `motion` is all of the reference; `said` is what its sound part, so much of it, says as given: a
/// wrong convention may agree for a while.
pub(super) fn fault(
    (log, masked, motion): (&Log, &[bool], &Motion),
    (said, kept): (&Start, f64),
    gravity_m_s2: f64,
) -> Option<Fault> {
    let upside_down = said.turned.angle() > 3.0;
    let all_against = said.accelerometer == Permutation { axis: [0, 1, 2], turned: [true; 3] };
    if upside_down && all_against {
        return Some(Fault::Mirrored);
    }
    let as_given = [said.gyro, said.accelerometer].iter().all(|p| *p == Permutation::NONE);
    if kept * said.explained > SOUND && as_given && said.turned.angle() == 0.0 {
        return None;
    }
    let of = |(fault, motion): &(Fault, Motion)| {
        let faults = faults::find(log, masked, motion).map_or_else(Vec::new, |found| found.0);
        let sound = faults::sound(&faults, motion);
        let kept = sound.time_s.len() as f64 / motion.time_s.len() as f64;
        (*fault, start(log, masked, &sound, gravity_m_s2), kept)
    };
    let read: Vec<(Fault, Start, f64)> = others(motion).iter().map(of).collect();
    let by_gyro = |s: &Start, part: f64| {
        s.explained > EXPLAINS && 1.0 - part * s.explained < FAR_BETTER * (1.0 - kept * said.explained)
    };
    let by_force = |s: &Start| {
        motion.halves.position
            && s.explained > EXPLAINS.max(said.explained - AS_WELL)
            && s.force_square < FAR_BETTER * said.force_square
    };
    let better = read.iter().filter(|(_, s, part)| by_gyro(s, *part) || by_force(s));
    // Readings that turn alike are told apart by the specific force.
    better.min_by(|a, b| a.1.force_square.total_cmp(&b.1.force_square)).map(|(fault, ..)| *fault)
}

impl Fault {
    /// Returns what is wrong, and what to do.
    pub(super) fn words(self) -> (String, String) {
        match self {
            Self::Order { taken } => {
                let [is, key] = match taken {
                    Order::ScalarLast => ["first", "scalar-first"],
                    Order::ScalarFirst => ["last", "scalar-last"],
                };
                (
                    format!(
                        "its quaternions are {key}: only with the scalar {is} does the reference turn as the gyro does"
                    ),
                    format!("set quaternion = \"{key}\" under [reference]"),
                )
            }
            Self::Inverse => (
                "its quaternions are world to body: only inverted does the reference turn as the gyro does".into(),
                "negate their x, y and z: need body to world".into(),
            ),
            Self::LeftHanded => (
                "its quaternions are left-handed, or of another frame than its positions: only with other signs of \
                 their x, y or z does the reference move as the IMU does"
                    .into(),
                "need right-handed quaternions, body to world, in the frame of the positions".into(),
            ),
            Self::Mirrored => (
                "it is left-handed: it moves as the IMU does only with one axis of its positions and quaternions \
                 mirrored"
                    .into(),
                "mirror the axis back (y: negate y of the position, and x and z of the quaternion); if the IMU is \
                 mounted upside down, negate its accelerometer's columns instead"
                    .into(),
            ),
        }
    }
}
