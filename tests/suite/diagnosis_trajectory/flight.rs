//! Flights as numbers, real and made up, which a test may alter before the tool sees them.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use libtest_mimic::Failed;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proofmass::control::Control;
use proofmass::diagnosis::answer::{Answer, Detail};
use proofmass::diagnosis::verdict::{Effect, Estimate};
use proofmass::diagnosis::{diagnose, model};
use proofmass::document;
use proofmass::motion::sources::{self, Section};
use proofmass::motion::{Earth, Sampling, Truth};
use proofmass::rng::{Philox, Stream};

/// Three numbers.
type Three = [f64; 3];

/// Readings and poses, each with its stamp.
#[derive(Debug, Clone)]
pub struct Flight {
    stamps_ns: Vec<i64>,
    /// rad/s.
    pub rate: Vec<Three>,
    /// m/s².
    pub force: Vec<Three>,
    poses: Vec<(i64, Vector3<f64>, UnitQuaternion<f64>)>,
}

fn numbers(path: &Path) -> Result<Vec<(i64, Vec<f64>)>, Failed> {
    let text = std::fs::read_to_string(path)?;
    let row = |line: &str| -> Option<(i64, Vec<f64>)> {
        let (stamp, rest) = line.split_once(',')?;
        Some((stamp.trim().parse().ok()?, rest.split(',').filter_map(|v| v.trim().parse().ok()).collect()))
    };
    Ok(text.lines().skip(1).filter_map(row).collect())
}

/// A recorded flight.
pub fn real(data: &Path, name: &str) -> Result<Flight, Failed> {
    let imu = numbers(&data.join(name).join("imu0.csv"))?;
    let poses = numbers(&data.join(name).join("ground_truth.csv"))?;
    let three = |v: &[f64], at: usize| [v[at], v[at + 1], v[at + 2]];
    Ok(Flight {
        stamps_ns: imu.iter().map(|r| r.0).collect(),
        rate: imu.iter().map(|r| three(&r.1, 0)).collect(),
        force: imu.iter().map(|r| three(&r.1, 3)).collect(),
        poses: poses
            .iter()
            .map(|(stamp, v)| {
                let attitude = UnitQuaternion::from_quaternion(Quaternion::new(v[3], v[4], v[5], v[6]));
                (*stamp, Vector3::new(v[0], v[1], v[2]), attitude)
            })
            .collect(),
    })
}

/// The reference file's own mean bias of the gyro, rad/s.
pub fn biases(data: &Path, name: &str) -> Result<Three, Failed> {
    let poses = numbers(&data.join(name).join("ground_truth.csv"))?;
    Ok(std::array::from_fn(|i| poses.iter().map(|(_, v)| v[10 + i]).sum::<f64>() / poses.len() as f64))
}

/// Biases of the made-up flights: gyro, rad/s, and accelerometer, m/s².
pub const PLANTED: [Three; 2] = [[0.01, -0.02, 0.005], [0.05, -0.03, 0.1]];

/// A drone's flight of ninety seconds, 200 readings and 100 poses per second: white noise of a fair
/// consumer sensor, constant biases, an exact reference.
pub fn made_up(seed: u64) -> Result<Flight, Failed> {
    Ok(read(&flown(seed)?, seed))
}

/// What a drone does on such a flight.
pub fn flown(seed: u64) -> Result<Truth, Failed> {
    let text = format!("kind = \"drone\"\nspeed_m_s = 3.0\nextent_m = 6.0\nstill_s = 3.0\nseed = {seed}\n");
    let section: Section = document::parse_toml("study.toml", &text)?;
    let trajectory = sources::trajectory(&section, 90.0)?;
    let sampling = Sampling { rate_hz: 200.0, duration_s: 90.0, lever_arm_m: Vector3::zeros() };
    Ok(trajectory.truth(&Earth::FLAT, sampling)?)
}

/// One reading of a flight.
pub fn read(truth: &Truth, seed: u64) -> Flight {
    let mut random = Philox::new(seed, 7, Stream::Host);
    let mut noisy = |value: Vector3<f64>, bias: Three, deviation: f64| -> Three {
        std::array::from_fn(|i| value[i] + bias[i] + deviation * random.normal())
    };
    let stamp = |time_s: f64| 1_600_000_000_000_000_000 + (time_s * 1e9).round() as i64;
    let mut flight = Flight { stamps_ns: Vec::new(), rate: Vec::new(), force: Vec::new(), poses: Vec::new() };
    for (k, sample) in truth.samples.iter().enumerate() {
        flight.stamps_ns.push(stamp(sample.time_s));
        flight.rate.push(noisy(sample.rate_rad_s, PLANTED[0], 1.6968e-3));
        flight.force.push(noisy(sample.specific_force_m_s2, PLANTED[1], 2e-2));
        if k % 2 == 0 {
            // North-east-down to a reference with z up, as files have it.
            let up = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            flight.poses.push((stamp(sample.time_s), up * sample.position_m, up * sample.attitude));
        }
    }
    flight
}

/// A body turned by hand for a minute, about a point that stays where it is: these rates in its own
/// axes, rad/s, a hundred readings and poses per second, integrated here in steps of 0.5 ms, with
/// the noise of the made-up flights and no bias.
pub fn by_hand(rate_at: impl Fn(f64) -> Three, seed: u64) -> Flight {
    const STEPS: usize = 20;
    let mut random = Philox::new(seed, 13, Stream::Host);
    let mut flight = Flight { stamps_ns: Vec::new(), rate: Vec::new(), force: Vec::new(), poses: Vec::new() };
    let mut attitude = UnitQuaternion::identity();
    for k in 0..6000 {
        let time_s = 0.01 * f64::from(k);
        let stamp = 1_600_000_000_000_000_000 + i64::from(k) * 10_000_000;
        let up = attitude.inverse() * Vector3::z() * proofmass::units::STANDARD_GRAVITY_M_S2;
        let mut noise = |value: f64, deviation: f64| value + deviation * random.normal();
        flight.stamps_ns.push(stamp);
        flight.rate.push(rate_at(time_s).map(|w| noise(w, 1.2e-3)));
        flight.force.push([up.x, up.y, up.z].map(|a| noise(a, 1.4e-2)));
        flight.poses.push((stamp, Vector3::zeros(), attitude));
        for step in 0..STEPS {
            let h = 0.01 / STEPS as f64;
            let middle = rate_at(time_s + (step as f64 + 0.5) * h);
            attitude *= UnitQuaternion::from_scaled_axis(Vector3::from(middle) * h);
        }
    }
    flight
}

impl Flight {
    /// The IMU mounted so that this rotation makes body axes of its own.
    pub fn mounted(&self, body_of_imu: UnitQuaternion<f64>) -> Self {
        let turned = |v: &Three| -> Three { (body_of_imu.inverse() * Vector3::from(*v)).into() };
        let [rate, force] = [&self.rate, &self.force].map(|all| all.iter().map(turned).collect());
        Self { rate, force, ..self.clone() }
    }

    /// The IMU's stamps moved.
    pub fn shifted(&self, shift_s: f64) -> Self {
        let shift = (shift_s * 1e9).round() as i64;
        Self { stamps_ns: self.stamps_ns.iter().map(|s| s + shift).collect(), ..self.clone() }
    }

    /// The IMU's stamps later and later, by this part of the time since the first.
    pub fn gaining(&self, part: f64) -> Self {
        let first = self.stamps_ns.first().copied().unwrap_or_default();
        let later = |s: &i64| s + (part * (s - first) as f64).round() as i64;
        Self { stamps_ns: self.stamps_ns.iter().map(later).collect(), ..self.clone() }
    }

    /// Every rate altered.
    pub fn with_rate(&self, of: impl Fn(Three) -> Three) -> Self {
        self.with_rate_at(|_, w| of(w))
    }

    /// Every rate altered, by its place.
    pub fn with_rate_at(&self, of: impl Fn(usize, Three) -> Three) -> Self {
        Self { rate: self.rate.iter().enumerate().map(|(k, w)| of(k, *w)).collect(), ..self.clone() }
    }

    /// Every specific force altered.
    pub fn with_force(&self, of: impl Fn(Three) -> Three) -> Self {
        self.with_force_at(|_, a| of(a))
    }

    /// Every specific force altered, by its place.
    pub fn with_force_at(&self, of: impl Fn(usize, Three) -> Three) -> Self {
        Self { force: self.force.iter().enumerate().map(|(k, a)| of(k, *a)).collect(), ..self.clone() }
    }

    /// The gyro's x reads so much of the specific force along z, which a drone's thrust changes,
    /// rad/s per m/s².
    pub fn with_g_sensitivity(&self, size: f64) -> Self {
        self.with_rate_at(|k, w| [w[0] + size * self.force[k][2], w[1], w[2]])
    }

    /// The reference follows a point that lies so far from where it was, body axes, m.
    pub fn carried(&self, arm_m: Three) -> Self {
        let moved = self.poses.iter().map(|(s, p, q)| (*s, p + q * Vector3::from(arm_m), *q));
        Self { poses: moved.collect(), ..self.clone() }
    }

    /// Next to a reference that errs by 1 mrad and 0.5 mm a pose, as motion capture does.
    pub fn captured(&self) -> Self {
        self.with_erring_reference(1e-3, 5e-4)
    }

    /// Every pose errs by itself: attitude, rad, and position, m, about and along each axis.
    pub fn with_erring_reference(&self, attitude_rad: f64, position_m: f64) -> Self {
        let mut random = Philox::new(3, 9, Stream::Host);
        let mut three = |size: f64| Vector3::from_fn(|_, _| size * random.normal());
        let poses = self.poses.iter().map(|(stamp, p, q)| {
            (*stamp, p + three(position_m), q * UnitQuaternion::from_scaled_axis(three(attitude_rad)))
        });
        Self { poses: poses.collect(), ..self.clone() }
    }

    /// Every pose errs, by what a process of this correlation time makes, s (none: by itself), of
    /// this size in attitude, rad, and position, m.
    pub fn with_coloured_reference(&self, seed: u64, correlation_s: f64, [attitude_rad, position_m]: [f64; 2]) -> Self {
        let mut random = Philox::new(seed, 11, Stream::Host);
        let keeps = if correlation_s > 0.0 { (-0.01 / correlation_s).exp() } else { 0.0 };
        let mut state = [Vector3::zeros(), Vector3::zeros()].map(|v: Vector3<f64>| v.map(|_| random.normal()));
        let poses = self.poses.iter().map(|(stamp, p, q)| {
            for error in &mut state {
                *error = *error * keeps + Vector3::from_fn(|_, _| (1.0f64 - keeps * keeps).sqrt() * random.normal());
            }
            let turned = q * UnitQuaternion::from_scaled_axis(state[0] * attitude_rad);
            (*stamp, p + state[1] * position_m, turned)
        });
        Self { poses: poses.collect(), ..self.clone() }
    }

    fn imu(&self) -> String {
        let mut text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],\
                        a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
            .to_owned();
        for ((stamp, w), a) in self.stamps_ns.iter().zip(&self.rate).zip(&self.force) {
            let _ = writeln!(text, "{stamp},{},{},{},{},{},{}", w[0], w[1], w[2], a[0], a[1], a[2]);
        }
        text
    }

    fn reference(&self) -> String {
        let mut text =
            "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
                .to_owned();
        for (stamp, p, q) in &self.poses {
            let _ = writeln!(text, "{stamp},{},{},{},{},{},{},{}", p.x, p.y, p.z, q.w, q.i, q.j, q.k);
        }
        text
    }

    /// What the tool says.
    pub fn diagnosed(&self) -> Result<Answer, Failed> {
        self.files().diagnosed()
    }

    /// As the files that the tool reads.
    pub fn files(&self) -> Files {
        // The static figures of the flights' own sensor.yaml; the made-up flights are given the
        // same.
        let model = "kind = \"trajectory\"\n[columns]\ntime = \"#timestamp [ns]\"\n[reference]\nfile = \"reference.csv\"\n\
                     [noise.gyro]\ndensity = 1.6968e-4\n[noise.accelerometer]\ndensity = 2.0e-3\n";
        Files { imu: self.imu(), reference: self.reference(), model: model.into() }
    }

    /// Some of the poses alone, by their place.
    pub fn with_poses(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let poses = self.poses.iter().enumerate().filter(|(k, _)| wanted(*k)).map(|(_, pose)| *pose);
        Self { poses: poses.collect(), ..self.clone() }
    }

    /// Every pose altered, by its place.
    pub fn with_pose_at(&self, of: impl Fn(usize, Vector3<f64>, [f64; 4]) -> (Vector3<f64>, [f64; 4])) -> Self {
        let poses = self.poses.iter().enumerate().map(|(k, (stamp, p, q))| {
            let (p, [w, x, y, z]) = of(k, *p, [q.w, q.i, q.j, q.k]);
            (*stamp, p, UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
        });
        Self { poses: poses.collect(), ..self.clone() }
    }
}

/// An IMU's log, its reference and their model, as text.
#[derive(Debug, Clone)]
pub struct Files {
    pub imu: String,
    pub reference: String,
    pub model: String,
}

impl Files {
    /// The columns of the reference with these headings alone.
    pub fn with_columns(&self, wanted: &[&str]) -> Self {
        let heading = self.reference.lines().next().unwrap_or_default();
        let places: Vec<usize> = heading
            .split(',')
            .enumerate()
            .filter(|(_, name)| wanted.iter().any(|w| name.contains(w)))
            .map(|(place, _)| place)
            .collect();
        let row = |line: &str| -> String {
            let cells: Vec<&str> = line.split(',').collect();
            places.iter().filter_map(|place| cells.get(*place).copied()).collect::<Vec<_>>().join(",")
        };
        Self { reference: self.reference.lines().map(|line| row(line) + "\n").collect(), ..self.clone() }
    }

    /// Every row of the reference, without its heading, as another line.
    pub fn with_rows(&self, of: impl Fn(usize, &str) -> String) -> Self {
        let mut lines = self.reference.lines();
        let heading = lines.next().unwrap_or_default();
        let rows: String = lines.enumerate().map(|(k, line)| of(k, line) + "\n").collect();
        Self { reference: format!("{heading}\n{rows}"), ..self.clone() }
    }

    /// Puts them into a folder: the paths of log and model.
    pub fn write(&self, folder: &Path) -> Result<[PathBuf; 2], Failed> {
        let [imu, model] = ["imu.csv", "model.toml"].map(|name| folder.join(name));
        std::fs::write(&imu, &self.imu)?;
        std::fs::write(folder.join("reference.csv"), &self.reference)?;
        std::fs::write(&model, &self.model)?;
        Ok([imu, model])
    }

    /// What the tool says.
    pub fn diagnosed(&self) -> Result<Answer, Failed> {
        let folder = tempfile::tempdir()?;
        let [imu, model] = self.write(folder.path())?;
        let model = model::read(&model)?;
        let recording = model::read_recording(&imu, &model, &Control::silent())?;
        Ok(diagnose(&recording, &model, &Control::silent())?)
    }
}

/// Ids of all that is named.
pub fn ids(answer: &Answer) -> BTreeSet<String> {
    answer.effects.iter().map(|e| e.id.clone()).collect()
}

/// A named effect.
pub fn effect<'a>(answer: &'a Answer, id: &str) -> Result<&'a Effect, Failed> {
    answer.effects.iter().find(|e| e.id == id).ok_or_else(|| format!("{id} is not named: {:?}", ids(answer)).into())
}

/// A number of the base model.
pub fn base<'a>(answer: &'a Answer, name: &str) -> Result<&'a Estimate, Failed> {
    answer.base.iter().find(|e| e.name == name).ok_or_else(|| format!("no {name} among the base's numbers").into())
}

/// The gyro's calibration.
pub fn matrix(answer: &Answer) -> Result<[[f64; 3]; 3], Failed> {
    let Detail::Trajectory(detail) = &answer.detail else { return Err("another kind".into()) };
    let gyro = detail.published.as_ref().and_then(|p| p.gyro.as_ref());
    gyro.map(|g| g.matrix).ok_or_else(|| "no calibration of the gyro".into())
}
