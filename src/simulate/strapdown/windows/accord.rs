//! Checks whether readings can be those of the reference's motion: units, the sign of gravity, the
//! axes.

use nalgebra::Vector3;

use super::finding::Finding;
use crate::motion::Trajectory;
use crate::number::rounded;
use crate::study::flown::Flown;
use crate::study::in_motion::InMotion;
use crate::units::DEGREE;

/// Readings looked at.
const LOOKED_AT: usize = 4000;
/// A reference that turns less than this tells nothing about the gyros, rad/s.
const TURNS_RAD_S: f64 = 0.02;
/// Correlation of the rates below which they are not of one motion, and below which it is said.
const CORRELATION: [f64; 2] = [0.3, 0.9];
/// Angle by which the mean specific force may point away from up, rad, and its size depart from
/// gravity, as a share.
const TILT_RAD: f64 = 20.0 * DEGREE;
const SIZE: f64 = 0.15;

/// Readings next to the reference.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    /// Motion of the reference.
    pub trajectory: &'a Trajectory,
    /// Stamps on its clock, s.
    pub time_s: &'a [f64],
    /// Angular rates, rad/s.
    pub rate_rad_s: &'a [Vector3<f64>],
    /// Specific forces, m/s².
    pub force_m_s2: &'a [Vector3<f64>],
}

/// Sums over the readings looked at.
#[derive(Default)]
struct Sums {
    count: f64,
    recorded: Vector3<f64>,
    reference: Vector3<f64>,
    squares: [f64; 3],
    force_level: Vector3<f64>,
    force_size: f64,
}

/// Checks a flight; gives what is to be said.
///
/// # Errors
/// Cause and hint: degrees, rates of another motion, gravity of the wrong sign, size or direction.
pub(super) fn check(
    recorded: Beside<'_>,
    flown: &Flown,
    motion: &InMotion,
) -> Result<Vec<Finding>, (String, &'static str)> {
    let mounting = motion.course.mounting();
    let mut sums = Sums::default();
    let stride = (recorded.time_s.len() / LOOKED_AT).max(1);
    for k in (0..recorded.time_s.len()).step_by(stride) {
        let body = recorded.trajectory.at(recorded.time_s[k], flown.lever_arm_m);
        let (reference, read) = (mounting.inverse() * body.rate_rad_s, recorded.rate_rad_s[k]);
        sums.count += 1.0;
        sums.recorded += read;
        sums.reference += reference;
        let products = [read.dot(&reference), reference.norm_squared(), read.norm_squared()];
        sums.squares.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        sums.force_level += body.pose.attitude * (mounting * recorded.force_m_s2[k]);
        sums.force_size += recorded.force_m_s2[k].norm();
    }
    let mut findings = Vec::new();
    rates(&sums, &mut findings)?;
    gravity(&sums, motion)?;
    Ok(findings)
}

fn rates(sums: &Sums, findings: &mut Vec<Finding>) -> Result<(), (String, &'static str)> {
    let n = sums.count;
    let [cross, reference, recorded] = sums.squares;
    let cross = cross - sums.recorded.dot(&sums.reference) / n;
    let reference = reference - sums.reference.norm_squared() / n;
    let recorded = recorded - sums.recorded.norm_squared() / n;
    if (reference / n).sqrt() < TURNS_RAD_S || recorded <= 0.0 {
        return Ok(());
    }
    let (slope, correlation) = (cross / reference, cross / (reference * recorded).sqrt());
    if correlation < CORRELATION[0] {
        return Err((
            format!("their angular rates are not of one motion (correlation {})", rounded(correlation, 2)),
            "other axes (give [mounting] rotation_deg), a clock that is off by more than a turn lasts, or another flight",
        ));
    }
    if (slope * DEGREE - 1.0).abs() < 0.3 {
        return Err((
            format!("the gyros read {} times what the reference turns: degrees, not radians", rounded(slope, 3)),
            "name the unit in the headings, e.g. `gx [deg/s]`",
        ));
    }
    if (slope - 1.0).abs() > 0.3 {
        return Err((
            format!("the gyros read {} times what the reference turns", rounded(slope, 3)),
            "scale the gyros to rad/s, or name their unit in the headings",
        ));
    }
    if correlation < CORRELATION[1] {
        findings.push(Finding::Follows { correlation });
    }
    Ok(())
}

fn gravity(sums: &Sums, motion: &InMotion) -> Result<(), (String, &'static str)> {
    let earth = motion.course.earth;
    let expected = earth.gravity_m_s2(earth.start());
    let mean = sums.force_level / sums.count;
    let size = sums.force_size / sums.count;
    let shown = rounded(size, 3);
    if (size - 1.0).abs() < SIZE {
        let cause = format!("the mean specific force is {shown}: readings in g, not in m/s²");
        return Err((cause, "name the unit in the headings, e.g. `ax [g]`"));
    }
    if size < 0.3 * expected {
        let cause = format!("the mean specific force is {shown} m/s²: gravity has been taken out of the readings");
        return Err((cause, "give what the accelerometers read, at rest 9.8 m/s² upwards"));
    }
    // Motion makes readings longer, and its mean in the reference's axes is still gravity's.
    if (size / expected - 1.0).abs() > SIZE && (mean.z.abs() / expected - 1.0).abs() > SIZE {
        let cause = format!("the mean specific force is {shown} m/s², gravity {} m/s²", rounded(expected, 4));
        return Err((cause, "scale the accelerometers to m/s², or name their unit in the headings"));
    }
    // Axes that are turned about level ones spread it over all headings: what is left along up
    // tells by how much.
    let tilt = (-mean.z / size.min(expected)).clamp(-1.0, 1.0).acos();
    if tilt > std::f64::consts::PI - TILT_RAD {
        let cause =
            "gravity has the wrong sign: the readings are acceleration against free fall downwards, or the reference \
                     has its axis of `up` the other way"
                .to_owned();
        return Err((
            cause,
            "negate the accelerometers, so that one at rest reads 9.8 m/s² upwards, or set trajectory.up",
        ));
    }
    if tilt > TILT_RAD {
        let cause = format!("the mean specific force points {}° away from up", rounded(tilt / DEGREE, 2));
        return Err((cause, "set trajectory.up, or the sensor's axes by [mounting] rotation_deg"));
    }
    Ok(())
}
