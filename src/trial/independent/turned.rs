//! An IMU hand-rotated as the second generator has it: still poses joined by turns about two axes
//! at once, in closed form.

use serde::{Deserialize, Serialize};

use super::columns::table;
use super::draw::Draw;
use super::readout::Noise;
use super::truth::Parameter;

/// Gravity where it is turned, m/s².
pub(super) const GRAVITY: f64 = 9.80665;

pub(super) type Vector = [f64; 3];
pub(super) type Rotation = [[f64; 3]; 3];

/// Errors of one three-axis sensor: counts = offset + scale·(v + k₂v² + k₂ₐ|v|v), v = M·true.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Counts per m/s² or rad/s.
    pub scale: Vector,
    /// M with ones on its diagonal.
    pub skew: Rotation,
    /// Offset, counts.
    pub offset: Vector,
    /// Second-order scale error k₂ per axis, 1/unit.
    pub square: Vector,
    /// k of |v|v per unit.
    pub bend: Vector,
    /// White noise per sample, counts.
    pub sigma: f64,
    /// Flicker (bias instability), over sigma.
    pub flicker: f64,
    /// Offset drift over the recording, in units of the quantity.
    pub drift: Vector,
}

/// Recipe of a recording of an IMU hand-rotated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Turned {
    /// Seed of poses and noise.
    pub seed: u64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Number of still poses.
    pub poses: usize,
    /// Shortest and longest rest, s.
    pub rest_s: [f64; 2],
    /// Errors of the accelerometer, m/s².
    pub accelerometer: Sensor,
    /// Errors of the gyro, rad/s.
    pub gyro: Sensor,
    /// Gyro bias per specific force, rad/s per m/s².
    pub g_sensitivity: Rotation,
    /// Law of the white noise.
    pub noise: Noise,
    /// A pose in which it was knocked, and by how much, m/s².
    pub knock: Option<(usize, f64)>,
    /// States whether readings are whole counts.
    pub whole: bool,
    /// States whether a temperature column is written, which drives the drift.
    pub temperature: bool,
}

pub(super) fn apply(m: &Rotation, v: Vector) -> Vector {
    std::array::from_fn(|i| (0..3).map(|j| m[i][j] * v[j]).sum())
}

pub(super) fn product(a: &Rotation, b: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(m: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// Rotation by a vector (Rodrigues).
pub(super) fn rotation(v: Vector) -> Rotation {
    let angle = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (a, b) = if angle < 1e-8 { (1.0, 0.5) } else { (angle.sin() / angle, (1.0 - angle.cos()) / (angle * angle)) };
    let k = [[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]];
    let kk = product(&k, &k);
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) + a * k[i][j] + b * kk[i][j]))
}

/// The rotation Q that makes A·Q upper triangular with a positive diagonal (rows of A from the last
/// one up, Gram–Schmidt).
fn upper_gauge(a: &Rotation) -> Rotation {
    let mut axes: [Vector; 3] = [[0.0; 3]; 3];
    for i in (0..3).rev() {
        let mut v = a[i];
        for other in &axes[i + 1..] {
            let along: f64 = v.iter().zip(other).map(|(x, y)| x * y).sum();
            v.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
        }
        let size = v.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300);
        axes[i] = v.map(|x| x / size);
    }
    transposed(&axes)
}

/// Minimum-jerk course from 0 to 1 and its rate, over a span.
fn course(t: f64, from: f64, to: f64) -> [f64; 2] {
    let s = ((t - from) / (to - from)).clamp(0.0, 1.0);
    let rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / (to - from);
    [s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), rate]
}

/// A turn: R(t) = R₀·exp(a·s₁(t))·exp(b·s₂(t)).
struct Turn {
    from: f64,
    to: f64,
    begin: Rotation,
    first: Vector,
    second: Vector,
}

impl Turn {
    fn parts(&self) -> [[f64; 2]; 2] {
        let length = self.to - self.from;
        [[self.from, self.from + 0.75 * length], [self.from + 0.25 * length, self.to]]
    }

    /// Attitude (body to level) and body rate.
    fn at(&self, t: f64) -> (Rotation, Vector) {
        let [one, two] = self.parts();
        let ([s1, r1], [s2, r2]) = (course(t, one[0], one[1]), course(t, two[0], two[1]));
        let second = rotation(self.second.map(|x| x * s2));
        let attitude = product(&self.begin, &product(&rotation(self.first.map(|x| x * s1)), &second));
        let carried = apply(&transposed(&second), self.first.map(|x| x * r1));
        (attitude, std::array::from_fn(|i| carried[i] + self.second[i] * r2))
    }
}

/// Specific force and rate of the body at each row, and the pose of each row, none in a turn.
pub struct BodyMotion {
    /// Specific force in body axes at each row, m/s².
    pub force: Vec<Vector>,
    /// Angular rate in body axes at each row, rad/s.
    pub rate: Vec<Vector>,
    /// Number of the still pose.
    pub pose: Vec<Option<usize>>,
}

fn random_axis(draw: &mut Draw) -> Vector {
    let v: Vector = std::array::from_fn(|_| draw.normal());
    let size = v.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
    v.map(|x| x / size)
}

impl Turned {
    /// Motion in closed form, sampled at the rows.
    pub fn motion(&self) -> BodyMotion {
        let mut draw = Draw::new(self.seed, 0, 51);
        let mut turns: Vec<Turn> = Vec::new();
        let mut attitude = rotation(random_axis(&mut draw).map(|x| x * draw.between(0.0, 3.0)));
        let mut t = 0.0;
        let mut rests = Vec::new();
        for _ in 0..self.poses {
            let end = t + draw.between(self.rest_s[0], self.rest_s[1]);
            rests.push([t, end]);
            let (first, second) = (random_axis(&mut draw), random_axis(&mut draw));
            let (a, b) = (draw.between(0.5, 1.8), draw.between(0.2, 1.4));
            let turn = Turn {
                from: end,
                to: end + draw.between(1.0, 2.5),
                begin: attitude,
                first: first.map(|x| x * a),
                second: second.map(|x| x * b),
            };
            (attitude, _) = turn.at(turn.to);
            t = turn.to;
            turns.push(turn);
        }
        // It ends in its last rest.
        let rows = (rests.last().map_or(0.0, |r| r[1]) * self.rate_hz) as usize;
        let mut motion = BodyMotion { force: Vec::new(), rate: Vec::new(), pose: Vec::new() };
        let mut now = 0;
        for row in 0..rows {
            let t = row as f64 / self.rate_hz;
            while now + 1 < turns.len() && t >= turns[now].to {
                now += 1;
            }
            let (attitude, rate) = turns[now].at(t);
            motion.force.push(apply(&transposed(&attitude), [0.0, 0.0, GRAVITY]));
            motion.rate.push(rate);
            motion.pose.push((t < rests[now][1]).then_some(now));
        }
        motion
    }

    /// Temperature at a part of the recording.
    fn temperature(part: f64) -> f64 {
        24.0 + 6.0 * (1.0 - (-2.5 * part).exp())
    }

    /// Returns how far the offsets have drifted at a part of the recording.
    pub(super) fn course(&self, part: f64) -> f64 {
        if self.temperature { (Self::temperature(part) - 24.0) / 6.0 } else { part }
    }

    fn counts(&self, sensor: &Sensor, truth: &[Vector], purpose: u64) -> [Vec<f64>; 3] {
        let rows = truth.len();
        let flat = vec![0.0; rows];
        std::array::from_fn(|axis| {
            let mut draw = Draw::new(self.seed, purpose * 3 + axis as u64, 52);
            let noise = self.noise.series(&flat, &mut draw);
            let slow = if sensor.flicker > 0.0 { super::still::flicker(rows, 1.0, &mut draw) } else { flat.clone() };
            (0..rows)
                .map(|n| {
                    let course = self.course(n as f64 / rows as f64);
                    let v: f64 = (0..3).map(|j| sensor.skew[axis][j] * truth[n][j]).sum();
                    let bent =
                        v + sensor.square[axis] * v * v + sensor.bend[axis] * v.abs() * v + sensor.drift[axis] * course;
                    let counts = sensor.offset[axis]
                        + sensor.scale[axis] * bent
                        + sensor.sigma * (noise[n] + sensor.flicker * slow[n]);
                    if self.whole { counts.round() } else { counts }
                })
                .collect()
        })
    }

    /// Intervals are held against these, in the gauge in which the accelerometer's z axis is exact
    /// and its y axis lies in the y–z plane: misalignment m_xy, m_xz, m_yz of the accelerometer,
    /// all six of the gyro against it.
    pub fn parameters(&self) -> Vec<Parameter> {
        let scaled = |sensor: &Sensor| -> Rotation {
            std::array::from_fn(|i| std::array::from_fn(|j| sensor.scale[i] * sensor.skew[i][j]))
        };
        let body = upper_gauge(&scaled(&self.accelerometer));
        let mut found = Vec::new();
        for (sensor, heading) in [(&self.accelerometer, "ax"), (&self.gyro, "gx")] {
            let turned = product(&scaled(sensor), &body);
            // A rate by specific force is read as any other rate is, through all three axes.
            let follows = product(&product(&scaled(sensor), &self.g_sensitivity), &body);
            let mut add = |id: &str, name: String, value: f64| {
                found.push(Parameter { id: id.into(), channel: Some(heading.into()), name, value });
            };
            for (i, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
                add("scale-factor", format!("scale_{axis}"), turned[i][i]);
                for (j, other) in ['x', 'y', 'z'].into_iter().enumerate() {
                    if i != j && (heading == "gx" || j > i) {
                        add("misalignment", format!("m_{axis}{other}"), turned[i][j] / turned[i][i]);
                    }
                    if heading == "gx" && self.g_sensitivity != [[0.0; 3]; 3] {
                        let k = follows[i][j] / turned[i][i];
                        add("g-sensitivity", format!("k_{axis}{other}"), k.to_degrees() * GRAVITY);
                    }
                }
            }
        }
        found
    }

    /// Texts of recording.csv and model.toml.
    pub fn texts(&self) -> [String; 2] {
        let mut motion = self.motion();
        if let Some((pose, size)) = self.knock {
            // It is pushed while it rests: a force that is not gravity, for the second half of the
            // rest.
            let rows: Vec<usize> = (0..motion.pose.len()).filter(|n| motion.pose[*n] == Some(pose)).collect();
            for n in rows.iter().skip(rows.len() / 2) {
                motion.force[*n][pose % 3] += size;
            }
        }
        let force = self.counts(&self.accelerometer, &motion.force, 1);
        let rate: Vec<Vector> = motion
            .rate
            .iter()
            .zip(&motion.force)
            .map(|(w, f)| {
                let k = apply(&self.g_sensitivity, *f);
                std::array::from_fn(|i| w[i] + k[i])
            })
            .collect();
        let rate = self.counts(&self.gyro, &rate, 2);
        let mut columns: Vec<(&str, &[f64])> = vec![
            ("ax", &force[0]),
            ("ay", &force[1]),
            ("az", &force[2]),
            ("gx", &rate[0]),
            ("gy", &rate[1]),
            ("gz", &rate[2]),
        ];
        let rows = force[0].len();
        let temperature: Vec<f64> = (0..rows).map(|n| Self::temperature(n as f64 / rows as f64)).collect();
        let mut model = format!("kind = \"tumble\"\nrate_hz = {}\ngravity_m_s2 = {GRAVITY}\n[columns]\n", self.rate_hz);
        model += "gyro = [\"gx\", \"gy\", \"gz\"]\naccelerometer = [\"ax\", \"ay\", \"az\"]\n";
        if self.temperature {
            columns.push(("temp_C", &temperature));
            model += "environment = [\"temp_C\"]\n";
        }
        [table(&columns), model]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // R′ = R·[ω]×: the attitude a small step later is R·exp(ω·dt) up to dt³; |f| stays g.
    #[test]
    fn rates_carry_one_attitude_into_the_next() {
        let turn = Turn {
            from: 0.0,
            to: 2.0,
            begin: rotation([0.3, -0.2, 1.0]),
            first: [1.0, 0.4, -0.2],
            second: [-0.3, 0.9, 0.5],
        };
        let dt = 1e-3;
        let mut worst: [f64; 2] = [0.0; 2];
        for n in 0..1990 {
            let t = f64::from(n) * 1e-3;
            let (now, _) = turn.at(t);
            let (next, _) = turn.at(t + dt);
            let (_, rate) = turn.at(t + 0.5 * dt);
            for (sign, worst) in [1.0, -1.0].into_iter().zip(&mut worst) {
                let carried = product(&now, &rotation(rate.map(|w| sign * w * dt)));
                let off = carried.iter().flatten().zip(next.iter().flatten()).map(|(a, b)| (a - b).abs());
                *worst = off.fold(*worst, f64::max);
            }
        }
        assert!(worst[0] < 1e-7, "{worst:?}");
        assert!(worst[1] > 1e-3, "turned the wrong way is seen: control {worst:?}");
    }

    #[test]
    fn a_gauge_makes_a_sensor_upper_triangular_and_keeps_lengths() {
        let a = [[1.02, 0.0, 0.0], [0.013, 0.99, 0.0], [-0.02, 0.007, 1.01]];
        let q = upper_gauge(&a);
        let turned = product(&a, &q);
        assert!([turned[1][0], turned[2][0], turned[2][1]].iter().all(|v| v.abs() < 1e-14));
        let unit = product(&q, &transposed(&q));
        assert!((0..3).all(|i| (0..3).all(|j| (unit[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14)));
        assert!(a[1][0].abs() > 1e-3, "it was not before: control");
    }

    // At rest the gyro reads K f along its axes: in the gauge of the parameters, force by force.
    #[test]
    fn a_gyro_at_rest_reads_its_g_sensitivity() {
        let sensor = |scale: f64, skew: Rotation| Sensor {
            scale: [scale, 1.02 * scale, 0.97 * scale],
            skew,
            offset: [0.0; 3],
            square: [0.0; 3],
            bend: [0.0; 3],
            sigma: 0.0,
            flicker: 0.0,
            drift: [0.0; 3],
        };
        let turned = Turned {
            seed: 3,
            rate_hz: 50.0,
            poses: 8,
            rest_s: [1.0, 2.0],
            accelerometer: sensor(400.0, [[1.0, 0.0, 0.0], [0.03, 1.0, 0.0], [-0.02, 0.05, 1.0]]),
            gyro: sensor(900.0, [[1.0, 0.04, -0.03], [0.02, 1.0, 0.05], [-0.05, 0.01, 1.0]]),
            g_sensitivity: [[1e-4, -2e-4, 3e-4], [2e-4, 1e-4, -1e-4], [-3e-4, 2e-4, 2e-4]],
            noise: Noise::Gauss,
            knock: None,
            whole: false,
            temperature: false,
        };
        let parameters = turned.parameters();
        let value = |id: &str, heading: &str, name: String| {
            let of = |p: &&Parameter| p.id == id && p.channel.as_deref() == Some(heading) && p.name == name;
            parameters.iter().find(of).map_or(0.0, |p| p.value)
        };
        let motion = turned.motion();
        let rest = |n: &usize| motion.pose[*n].is_some() && motion.rate[*n] == [0.0; 3];
        let rows: Vec<usize> = (0..motion.pose.len()).filter(rest).collect();
        let rates: Vec<Vector> = rows.iter().map(|n| apply(&turned.g_sensitivity, motion.force[*n])).collect();
        let forces: Vec<Vector> = rows.iter().map(|n| motion.force[*n]).collect();
        let (gyro, force) = (turned.counts(&turned.gyro, &rates, 2), turned.counts(&turned.accelerometer, &forces, 1));
        let axes = ['x', 'y', 'z'];
        let mut worst: f64 = 0.0;
        for n in 0..rows.len() {
            // Force in the gauge, from the readings: upper triangular, from the last axis up.
            let along: Vector =
                std::array::from_fn(|i| force[i][n] / value("scale-factor", "ax", format!("scale_{}", axes[i])));
            let skew = |i: usize, j: usize| value("misalignment", "ax", format!("m_{}{}", axes[i], axes[j]));
            let y = along[1] - skew(1, 2) * along[2];
            let f = [along[0] - skew(0, 1) * y - skew(0, 2) * along[2], y, along[2]];
            for (i, axis) in axes.into_iter().enumerate() {
                let k = |j: usize| value("g-sensitivity", "gx", format!("k_{axis}{}", axes[j])).to_radians() / GRAVITY;
                let said =
                    value("scale-factor", "gx", format!("scale_{axis}")) * (0..3).map(|j| k(j) * f[j]).sum::<f64>();
                worst = worst.max((said - gyro[i][n]).abs());
            }
        }
        // A reading is about one count.
        assert!(rows.len() > 300 && worst < 1e-6, "{} rows: {worst}", rows.len());
    }
}
