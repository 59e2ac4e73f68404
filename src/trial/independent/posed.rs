//! States how well the errors of an IMU hand-rotated are seen in its poses and turns, each next to
//! all others: generalised least squares, linear in every error.
//!
//! Seen are the mean reading of both sensors in every pose and the angle that the gyro adds up from
//! pose to pose. What is not known of the true attitudes, of the base model (offsets, one scale per
//! sensor) and of the other effects is free.

use super::linear::left_by;
use super::still::relaxations;
use super::turned::{BodyMotion, Rotation, Sensor, Turned, Vector, apply, product, rotation};

const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Holds what one error adds to everything that is seen, three values after three.
#[derive(Debug, Clone)]
struct Shown {
    /// Mean specific force of each pose.
    force: Vec<Vector>,
    /// Mean rate of each pose.
    rate: Vec<Vector>,
    /// Angle of each turn, in the axes of its end.
    angle: Vec<Vector>,
}

/// A sensor's error per unit of what it senses, and how it goes with that.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Error {
    /// Readings of axis i per true value along j.
    Matrix(usize, usize),
    Offset(usize),
    Drift(usize),
    /// Of the square of the true value.
    Square(usize),
    /// Of |v|v.
    Bend(usize),
    /// Of the gyro's axis i per force along j.
    PerForce(usize, usize),
}

/// Which sensor has it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Of {
    Accelerometer,
    Gyro,
}

/// Evidence of each of these effects next to the others, and of all together.
pub(super) fn evidence(turned: &Turned, names: &[&str]) -> (Vec<f64>, f64) {
    let posed = Posed::of(turned);
    let noise = posed.noise();
    let shown = |of: Of, error: Error| noise.over(&posed.shown(of, error));
    let tilts = (0..turned.poses).flat_map(|pose| (0..3).map(move |axis| (pose, axis)));
    let mut base: Vec<Vec<f64>> = tilts.map(|(pose, axis)| noise.over(&posed.tilted(pose, axis))).collect();
    for of in [Of::Accelerometer, Of::Gyro] {
        base.extend((0..3).map(|i| shown(of, Error::Offset(i))));
        let scales: Vec<Vec<f64>> = (0..3).map(|i| shown(of, Error::Matrix(i, i))).collect();
        base.push(sum(scales[0].len(), &scales, &[1.0; 3]));
    }
    let rows = base[0].len();
    let effects: Vec<(Vec<Vec<f64>>, Vec<f64>)> = names
        .iter()
        .map(|name| {
            let errors = errors(turned, name);
            let columns: Vec<Vec<f64>> = errors.iter().map(|(of, error, _)| shown(*of, *error)).collect();
            let whole = sum(rows, &columns, &errors.iter().map(|e| e.2).collect::<Vec<f64>>());
            (columns, whole)
        })
        .collect();
    let left = |free: &[&[f64]], course: &[f64]| left_by(free, course).iter().map(|v| v * v).sum::<f64>();
    let each = (0..effects.len()).map(|n| {
        let others = effects.iter().enumerate().filter(|(k, _)| *k != n).flat_map(|(_, (columns, _))| columns);
        let free: Vec<&[f64]> = base.iter().chain(others).map(Vec::as_slice).collect();
        left(&free, &effects[n].1)
    });
    let each = each.collect();
    let wholes: Vec<Vec<f64>> = effects.into_iter().map(|(_, whole)| whole).collect();
    let all = sum(rows, &wholes, &vec![1.0; wholes.len()]);
    (each, left(&base.iter().map(Vec::as_slice).collect::<Vec<&[f64]>>(), &all))
}

/// A sum of columns of so many rows with weights.
fn sum(rows: usize, columns: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    (0..rows).map(|n| columns.iter().zip(weights).map(|(c, w)| w * c[n]).sum()).collect()
}

/// The errors that go by a name, with their true values.
fn errors(turned: &Turned, name: &str) -> Vec<(Of, Error, f64)> {
    let sensors = [(Of::Accelerometer, &turned.accelerometer), (Of::Gyro, &turned.gyro)];
    let pairs = || (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let mut found = Vec::new();
    for (of, sensor) in sensors {
        let mean = sensor.scale.iter().sum::<f64>() / 3.0;
        let axes = |error: fn(usize) -> Error, value: &Vector| -> Vec<(Of, Error, f64)> {
            (0..3).filter(|_| value.iter().any(|v| *v != 0.0)).map(|i| (of, error(i), value[i])).collect()
        };
        found.extend(match name {
            "scale-factor" => axes(|i| Error::Matrix(i, i), &sensor.scale.map(|s| s / mean - 1.0)),
            "misalignment" => {
                let off = pairs().filter(|(i, j)| i != j);
                off.map(|(i, j)| (of, Error::Matrix(i, j), sensor.skew[i][j])).collect()
            }
            "scale-nonlinearity" => [axes(Error::Square, &sensor.square), axes(Error::Bend, &sensor.bend)].concat(),
            "g-sensitivity" if of == Of::Gyro => {
                pairs().map(|(i, j)| (of, Error::PerForce(i, j), turned.g_sensitivity[i][j])).collect()
            }
            "g-sensitivity" => Vec::new(),
            _ => axes(Error::Drift, &sensor.drift),
        });
    }
    found
}

/// Poses and turns of a recording.
struct Posed<'a> {
    turned: &'a Turned,
    motion: BodyMotion,
    /// States how the body's axes turn over each row.
    over: Vec<Rotation>,
    /// Rows of each pose.
    rests: Vec<[usize; 2]>,
}

impl<'a> Posed<'a> {
    fn of(turned: &'a Turned) -> Self {
        let motion = turned.motion();
        let mut rests = vec![[usize::MAX, 0]; turned.poses];
        for (row, pose) in motion.pose.iter().enumerate() {
            if let Some(pose) = pose {
                rests[*pose] = [rests[*pose][0].min(row), row + 1];
            }
        }
        let over = motion.rate.iter().map(|rate| rotation(rate.map(|w| -w / turned.rate_hz))).collect();
        Self { turned, motion, over, rests }
    }

    /// Offsets' course, from nought to one.
    fn course(&self, row: f64) -> f64 {
        self.turned.course(row / self.motion.pose.len() as f64)
    }

    fn force(&self, pose: usize) -> Vector {
        self.motion.force[self.rests[pose][0]]
    }

    /// One value along an axis: how an error shows where force and rate are these.
    fn along(&self, of: Of, error: Error, row: f64, force: Vector, rate: Vector) -> Vector {
        let sensed = if of == Of::Gyro { rate } else { force };
        let (axis, value) = match error {
            Error::Matrix(i, j) => (i, sensed[j]),
            Error::Offset(i) => (i, 1.0),
            Error::Drift(i) => (i, self.course(row)),
            Error::Square(i) => (i, sensed[i] * sensed[i]),
            Error::Bend(i) => (i, sensed[i] * sensed[i].abs()),
            Error::PerForce(i, j) => (i, force[j]),
        };
        AXES[axis].map(|v| v * value)
    }

    fn shown(&self, of: Of, error: Error) -> Shown {
        let poses = 0..self.turned.poses;
        let at_rest = |pose: usize| {
            let [from, to] = self.rests[pose];
            self.along(of, error, 0.5 * (from + to) as f64, self.force(pose), [0.0; 3])
        };
        let none = vec![[0.0; 3]; self.turned.poses];
        let angle = (1..self.turned.poses).map(|end| match of {
            Of::Accelerometer => [0.0; 3],
            Of::Gyro => self
                .carried(end, |row| self.along(of, error, row as f64, self.motion.force[row], self.motion.rate[row])),
        });
        let (mut force, mut rate) = (none.clone(), none);
        match of {
            Of::Accelerometer => force = poses.map(at_rest).collect(),
            Of::Gyro => rate = poses.map(at_rest).collect(),
        }
        Shown { force, rate, angle: angle.collect() }
    }

    /// Rows of the turn into a pose.
    fn turn(&self, end: usize) -> std::ops::Range<usize> {
        self.rests[end - 1][1]..self.rests[end][0]
    }

    /// The angle that an error of the rate adds up to over the turn into a pose, in that pose's
    /// axes.
    fn carried(&self, end: usize, rate: impl Fn(usize) -> Vector) -> Vector {
        self.turn(end).fold([0.0; 3], |sum, row| {
            let (sum, more) = (apply(&self.over[row], sum), rate(row));
            std::array::from_fn(|i| sum[i] + more[i] / self.turned.rate_hz)
        })
    }

    /// A small rotation of the true attitude of one pose about one of its axes.
    fn tilted(&self, pose: usize, axis: usize) -> Shown {
        let poses = self.turned.poses;
        let mut shown =
            Shown { force: vec![[0.0; 3]; poses], rate: vec![[0.0; 3]; poses], angle: vec![[0.0; 3]; poses - 1] };
        let (f, e) = (self.force(pose), AXES[axis]);
        shown.force[pose] = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            f[j] * e[k] - f[k] * e[j]
        });
        if pose > 0 {
            shown.angle[pose - 1] = e;
        }
        if pose + 1 < poses {
            let over = self.turn(pose + 1).fold(AXES, |sum, row| product(&self.over[row], &sum));
            shown.angle[pose] = apply(&over, e).map(|v| -v);
        }
        shown
    }

    /// Covariance of the means of one axis over windows of rows: white noise, and 1/f noise as the
    /// generator makes it.
    fn covariance(&self, sensor: &Sensor, windows: &[[usize; 2]]) -> Vec<Vec<f64>> {
        let sigma = sensor.sigma / sensor.scale[0];
        let flicker = sensor.flicker * sigma;
        let terms: Vec<[f64; 2]> = match sensor.flicker > 0.0 {
            true => relaxations(self.motion.pose.len(), 1.0).collect(),
            false => Vec::new(),
        };
        let length = |w: &[usize; 2]| (w[1] - w[0]) as f64;
        let of = |n: usize, a: &[usize; 2], m: usize, b: &[usize; 2]| {
            let white = if n == m { sigma * sigma / length(a) } else { 0.0 };
            let slow: f64 = terms.iter().map(|[tau, size]| size * size * mean_of_memory(*tau, a, b)).sum();
            white + flicker * flicker * slow
        };
        let row = |(n, a): (usize, &[usize; 2])| windows.iter().enumerate().map(|(m, b)| of(n, a, m, b)).collect();
        windows.iter().enumerate().map(row).collect()
    }

    /// Factors that make the noise of everything seen white.
    fn noise(&self) -> Noise {
        let turns: Vec<[usize; 2]> =
            (1..self.turned.poses).map(|end| [self.turn(end).start, self.turn(end).end]).collect();
        let gyro = &self.turned.gyro;
        let angle = turns.iter().map(|turn| {
            let seconds = (turn[1] - turn[0]) as f64 / self.turned.rate_hz;
            seconds * self.covariance(gyro, &[*turn])[0][0].sqrt()
        });
        Noise {
            force: root(self.covariance(&self.turned.accelerometer, &self.rests)),
            rate: root(self.covariance(gyro, &self.rests)),
            angle: angle.collect(),
        }
    }
}

/// The mean of exp(−|t − s|/τ) with t and s in two windows.
fn mean_of_memory(tau: f64, a: &[usize; 2], b: &[usize; 2]) -> f64 {
    // Its second antiderivative, even in x.
    let second = |x: f64| tau * tau * (-x.abs() / tau).exp() + tau * x.abs();
    let [a, b] = [a, b].map(|w| w.map(|row| row as f64));
    let sum = second(a[0] - b[1]) - second(a[0] - b[0]) - second(a[1] - b[1]) + second(a[1] - b[0]);
    sum / ((a[1] - a[0]) * (b[1] - b[0]))
}

/// Lower Cholesky factor.
fn root(covariance: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut lower = covariance;
    for i in 0..lower.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = lower[i][j] - known;
            lower[i][j] = if i == j { rest.max(1e-300).sqrt() } else { rest / lower[j][j] };
        }
    }
    lower
}

/// Roots of the covariances of what is seen; axes are independent and alike.
struct Noise {
    force: Vec<Vec<f64>>,
    rate: Vec<Vec<f64>>,
    angle: Vec<f64>,
}

impl Noise {
    /// Returns what is seen, over its noise.
    fn over(&self, shown: &Shown) -> Vec<f64> {
        let mut out = Vec::new();
        for (values, lower) in [(&shown.force, &self.force), (&shown.rate, &self.rate)] {
            for axis in 0..3 {
                let mut solved: Vec<f64> = Vec::with_capacity(values.len());
                for (value, row) in values.iter().zip(lower) {
                    let known: f64 = row.iter().zip(&solved).map(|(l, s)| l * s).sum();
                    solved.push((value[axis] - known) / row[solved.len()]);
                }
                out.extend(solved);
            }
        }
        let angles = shown.angle.iter().zip(&self.angle);
        out.extend(angles.flat_map(|(angle, deviation)| angle.map(|v| v / deviation)));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::independent::readout::Noise as Law;
    use crate::independent::truth::SEEN;

    fn sensor(scale: f64, sigma: f64) -> Sensor {
        Sensor {
            scale: [scale; 3],
            skew: AXES,
            offset: [0.0; 3],
            square: [0.0; 3],
            bend: [0.0; 3],
            sigma: scale * sigma,
            flicker: 0.0,
            drift: [0.0; 3],
        }
    }

    fn turned() -> Turned {
        Turned {
            seed: 5,
            rate_hz: 50.0,
            poses: 24,
            rest_s: [3.0, 6.0],
            accelerometer: sensor(1000.0, 0.03),
            gyro: sensor(4000.0, 0.002),
            g_sensitivity: [[0.0; 3]; 3],
            noise: Law::Gauss,
            knock: None,
            whole: false,
            temperature: false,
        }
    }

    const DRIFT: &str = "slow-drift";

    // A sensor of three times the size has nine times the evidence; what is free leaves none of
    // itself.
    #[test]
    fn evidence_goes_as_the_square_and_a_common_scale_is_the_base_model_s() {
        let scaled = |by: f64| {
            let mut turned = turned();
            turned.accelerometer.scale = [1000.0 * (1.0 + by), 1000.0, 1000.0];
            evidence(&turned, &["scale-factor"])
        };
        let ((one, all), (three, _)) = (scaled(0.002), scaled(0.006));
        assert!((three[0] / one[0] - 9.0).abs() < 0.1 && one[0] > SEEN, "{one:?} {three:?}");
        assert!((all / one[0] - 1.0).abs() < 1e-6, "alone it is all there is");
        let mut common = turned();
        common.accelerometer.scale = [1010.0; 3];
        assert!(evidence(&common, &["scale-factor"]).0[0] < 1e-3);
    }

    #[test]
    fn one_over_f_noise_hides_what_white_noise_shows() {
        let mut quiet = turned();
        quiet.accelerometer.scale = [1002.0, 1000.0, 999.0];
        let mut wandering = quiet.clone();
        wandering.accelerometer.flicker = 0.6;
        let of = |turned: &Turned| evidence(turned, &["scale-factor"]).0[0];
        assert!(of(&wandering) < SEEN && SEEN < 0.5 * of(&quiet), "{} {}", of(&wandering), of(&quiet));
        wandering.accelerometer.scale = [1100.0, 1000.0, 950.0];
        assert!(of(&wandering) > SEEN, "what is large shows beside it: control");
    }

    // Gravity's length hangs on an offset that drifts by its part along gravity, |d|²/36 in mean
    // square; scale and misalignment take up some of it in two dozen poses, and not all.
    #[test]
    fn a_drift_is_seen_less_beside_scale_and_misalignment() {
        let mut turned = turned();
        turned.accelerometer.drift = [0.02, -0.03, 0.01];
        let alone = evidence(&turned, &[DRIFT]).0[0];
        let beside = evidence(&turned, &[DRIFT, "scale-factor", "misalignment"]).0[0];
        assert!(beside < alone && beside > 0.05 * alone, "{beside} of {alone}");
        turned.accelerometer.drift = [0.0; 3];
        assert!(evidence(&turned, &[DRIFT]).1 < 1e-6, "no drift: control");
    }

    // Windows of one row, and of the same ten, of a process of long and of short memory.
    #[test]
    fn a_mean_over_windows_remembers_as_the_exponential_does() {
        assert!((mean_of_memory(100.0, &[0, 1], &[50, 51]) - (-0.5f64).exp()).abs() < 1e-3);
        assert!((mean_of_memory(1e4, &[0, 10], &[0, 10]) - 1.0).abs() < 1e-3);
        let short = mean_of_memory(1.0, &[0, 1000], &[0, 1000]);
        assert!((short / 0.002 - 1.0).abs() < 0.01, "2τ/T: {short}");
    }
}
