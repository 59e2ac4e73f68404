//! A study with a `[trajectory]`: the same sensor on each of three axes, each drawn apart, carried
//! over the Earth.

use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::aiding::{self, Aiding};
use super::check;
use super::draw::Drawer;
use super::file::{AlignmentKind, File, VerticalKind};
use super::flown::{self, Flown};
use super::mass_check::{self, Lasting};
use super::refusal::refuse;
use super::second::{MemberSeeds, Seeds};
use super::temperature;
use super::tolerances::Tolerances;
use crate::error::Result;
use crate::excitation::Waveform;
use crate::excitation::plan::Variation;
use crate::excitation::random::{RandomVibration, Spectrum};
use crate::kernel::environment::Follow;
use crate::kernel::flight::{Coupling, Flight, Misalignment, Vertical, axis_seed};
use crate::kernel::job::{Clock, Job};
use crate::kernel::truth_step::{Along, TimeFactor};
use crate::motion::{Earth, Integrator as Mechanisation, Sampling, sources};
use crate::number::short;
use crate::sensor::{ProofMass, coupling};
use crate::units::DEGREE;
use crate::units::key::Key;
use crate::units::number::Number;

/// Slower than this a body is taken to stand, m/s.
const STANDS_M_S: f64 = 0.05;
/// Members that are asked for the stiffest proof mass.
const ASKED: u64 = 1000;

/// Members and duration of a run.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// Seeds of every random number.
    pub seeds: &'a Seeds,
    /// Members to simulate.
    pub members: u64,
    /// Discrete time from the end of the still start.
    pub clock: &'a Clock,
    /// Samples of the still start.
    pub still_samples: u64,
}

/// The part of a study that only six axes have.
#[derive(Clone)]
pub struct InMotion {
    /// The numbers of each axis, without what it takes from the others.
    pub tolerances: [Tolerances; 3],
    /// The same with it.
    pub between: [Tolerances; 3],
    /// TimeFactor of the sensor over the Earth.
    pub course: Arc<TimeFactor>,
    /// Says whether the vertical channel runs free or is held by an aid.
    pub vertical: Vertical,
    /// Attitude errors at the start.
    pub misalignment: Misalignment,
    /// Treatment of motion within a sample by the navigator.
    pub mechanisation: Mechanisation,
    /// Measurements that aid the navigator.
    pub aiding: Option<Aiding>,
    /// The recorded flight to lay next to it.
    pub flown: Option<Flown>,
    /// Notes on how the study was read, for people.
    pub notes: Vec<String>,
    /// Vibration of each axis besides the motion.
    vibration: [Option<Arc<dyn Waveform>>; 3],
}

/// Reads what a file says about motion, checked; `None` for a study of one axis.
///
/// # Errors
/// Sections or lists that need a trajectory, sections that have no place next to one, values that
/// make no sense.
pub(super) fn read(name: &str, file: &File, clock: &Clock, seed: u64) -> Result<Option<InMotion>> {
    let Some(trajectory) = &file.trajectory else { return one_axis(name, file).map(|()| None) };
    if file.excitation.kind.is_some() {
        return Err(refuse(
            name,
            "[excitation] cannot be combined with [trajectory], which already defines the motion",
            "remove one of the two",
        ));
    }
    if file.compare.is_some() {
        return Err(refuse(
            name,
            "[compare] is for a log at rest, without a [trajectory]",
            "use a study of one axis for it",
        ));
    }
    let tolerances: Vec<Tolerances> = (0..3).map(|axis| check::tolerances(name, file, axis)).collect::<Result<_>>()?;
    let between: [Tolerances; 3] = tolerances.try_into().unwrap_or_default();
    let tolerances = alone(&between);
    let earth = earth(name, file)?;
    let (lever_arm_m, rotation) = mounting(name, file)?;
    let sampling = Sampling { rate_hz: 1.0 / clock.sample_s(), duration_s: clock.duration_s(), lever_arm_m };
    let trajectory = sources::trajectory(trajectory, clock.duration_s())?;
    let mut notes: Vec<String> = trajectory.findings.iter().map(ToString::to_string).collect();
    let truth = trajectory.truth(&earth, sampling)?;
    let alignment = file.alignment.clone().unwrap_or_default();
    let drawn = alignment.kind == Some(AlignmentKind::Drawn);
    let ideal = !drawn && alignment.kind != Some(AlignmentKind::Still);
    if ideal && alignment.heading_sd_deg.is_some() || !drawn && alignment.tilt_sd_deg.is_some() {
        return Err(refuse(
            name,
            "spreads of tilt and heading belong to kind = \"drawn\"; a still start takes heading_sd_deg alone",
            "e.g. kind = \"drawn\", tilt_sd_deg = 0.05, heading_sd_deg = 0.5",
        ));
    }
    let radians = |sd_deg: Option<f64>| sd_deg.unwrap_or(0.0) * DEGREE;
    let misalignment =
        Misalignment { tilt_sd_rad: radians(alignment.tilt_sd_deg), heading_sd_rad: radians(alignment.heading_sd_deg) };
    let first_m_s = truth.samples.first().map_or(0.0, |first| first.velocity_m_s.norm());
    if alignment.kind == Some(AlignmentKind::Still) && first_m_s > STANDS_M_S {
        notes.push(format!(
            "the motion begins at {} m/s, and the still start before it stands: the sensor jumps from one to the other, \
             which its errors do not feel",
            short(first_m_s)
        ));
    }
    let vertical = match file.earth.as_ref().and_then(|e| e.vertical) {
        Some(VerticalKind::Held) => Vertical::Held,
        _ => Vertical::Free,
    };
    let aiding = aiding::read(name, file.aiding.as_ref(), clock, &truth, vertical)?;
    one_clock(name, &between)?;
    let temperature = temperature::read(name, file.temperature.as_ref(), &between)?;
    let course = Arc::new(TimeFactor::new(truth, earth, rotation).with_temperature(temperature));
    let vibration = vibration(name, file, clock.duration_s(), seed)?;
    let mechanisation = file.navigator.as_ref().and_then(|n| n.integrator).unwrap_or_default();
    let flown = flown::read(name, file, lever_arm_m)?;
    Ok(Some(InMotion {
        tolerances,
        between,
        course,
        vertical,
        misalignment,
        vibration,
        mechanisation,
        aiding,
        flown,
        notes,
    }))
}

/// The numbers of each axis without what it takes from the others.
fn alone(between: &[Tolerances; 3]) -> [Tolerances; 3] {
    let mut alone = between.clone();
    for axis in &mut alone {
        coupling::KEYS.into_iter().for_each(|key| axis[key] = None);
    }
    alone
}

/// Refuses what a study of one axis has no place for.
fn one_axis(name: &str, file: &File) -> Result<()> {
    let sections = [Some(&file.sensor.numbers), file.accelerometer.as_ref(), file.gyro.as_ref()];
    if let Some(key) = sections.into_iter().flatten().find_map(|numbers| numbers.by_axis()) {
        let cause = format!("`{}` is a list of three, and the study has one axis", key.path);
        return Err(refuse(name, cause, "give one number, or add a [trajectory], e.g. kind = \"rest\""));
    }
    let all = check::tolerances(name, file, 0)?;
    if let Some(key) = coupling::IN_MOTION.into_iter().find(|key| all[key].is_some()) {
        let cause = match coupling::OF_ROTATION.contains(&key) {
            true => format!("`{}` acts on a rate of rotation, and a study of one axis does not rotate", key.path),
            false => format!("`{}` follows the motion, and the study has no trajectory", key.path),
        };
        return Err(refuse(name, cause, "add a [trajectory], e.g. kind = \"rest\""));
    }
    let sections = [
        ("earth", file.earth.is_some()),
        ("aiding", file.aiding.is_some()),
        ("mounting", file.mounting.is_some()),
        ("vibration", file.vibration.is_some()),
        ("navigator", file.navigator.is_some()),
    ];
    match sections.into_iter().find(|(_, given)| *given) {
        Some((section, _)) => {
            Err(refuse(name, format!("[{section}] needs a [trajectory]"), "add one, e.g. kind = \"rest\""))
        }
        None => Ok(()),
    }
}

fn earth(name: &str, file: &File) -> Result<Earth> {
    let Some(section) = &file.earth else { return Ok(Earth::FLAT) };
    match section.latitude_deg {
        // At a pole north has no direction; beyond this the tangent of latitude leaves the range of
        // f32 sums.
        Some(latitude) if latitude.is_nan() || latitude.abs() > 89.0 => Err(refuse(
            name,
            format!("`earth.latitude_deg` = {latitude:?}: need -89 to 89"),
            "north-east-down has no direction at a pole",
        )),
        None if section.height_m.is_some() || section.rotation == Some(true) => Err(refuse(
            name,
            "[earth] has no `latitude_deg`, and without it the Earth is flat and still",
            "add latitude_deg, e.g. latitude_deg = 47.4",
        )),
        latitude_deg => match section.height_m.unwrap_or(0.0) {
            height_m if !(-1e4..=1e5).contains(&height_m) => Err(refuse(
                name,
                format!("`earth.height_m` = {height_m:?} m: need -10 km to 100 km"),
                "give the height over the ellipsoid in metres",
            )),
            height_m => Ok(Earth {
                latitude_rad: latitude_deg.map(|d| d * DEGREE),
                height_m,
                rotation: section.rotation.unwrap_or(true) && latitude_deg.is_some(),
            }),
        },
    }
}

/// Refuses clocks that differ from axis to axis.
fn one_clock(name: &str, between: &[Tolerances; 3]) -> Result<()> {
    match coupling::OF_THE_CLOCK.into_iter().find(|key| between.iter().any(|axis| axis[*key] != between[0][*key])) {
        Some(key) => {
            let cause = format!("`{}` is a list of three, and all axes share one clock", key.path);
            Err(refuse(name, cause, "give one number"))
        }
        None => Ok(()),
    }
}

/// Returns the mounting of the sensor: lever arm, m, and the turn from its axes to the body's.
fn mounting(name: &str, file: &File) -> Result<(Vector3<f64>, UnitQuaternion<f64>)> {
    let mounting = file.mounting.clone().unwrap_or_default();
    let (arm, angles) = (mounting.lever_arm_m.unwrap_or_default(), mounting.rotation_deg.unwrap_or_default());
    if !arm.iter().chain(&angles).all(|v| v.is_finite()) {
        return Err(refuse(name, "[mounting] holds a number that is not finite", "give metres and degrees"));
    }
    let [roll, pitch, yaw] = angles.map(|a| a * DEGREE);
    Ok((arm.into(), UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
}

/// Returns the vibration of each axis.
fn vibration(name: &str, file: &File, duration_s: f64, seed: u64) -> Result<[Option<Arc<dyn Waveform>>; 3]> {
    let section = file.vibration.clone().unwrap_or_default();
    let mut axes = [None, None, None];
    let given = [("x_g2_hz", section.x_g2_hz), ("y_g2_hz", section.y_g2_hz), ("z_g2_hz", section.z_g2_hz)];
    for (axis, (key, points)) in given.into_iter().enumerate() {
        let Some(points) = points else { continue };
        let spectrum = Spectrum { points: points.iter().map(|p| (p[0], p[1])).collect() };
        if !spectrum.is_sound() {
            return Err(refuse(
                name,
                format!("`vibration.{key}` needs two points or more, frequencies increasing, all numbers above zero"),
                format!("e.g. {key} = [[20.0, 0.001], [80.0, 0.001]] in Hz and g²/Hz"),
            ));
        }
        let waveform = RandomVibration::new(&spectrum, duration_s, axis_seed(seed, axis as u64));
        axes[axis] = Some(Arc::new(waveform) as Arc<dyn Waveform>);
    }
    Ok(axes)
}

impl InMotion {
    /// Says whether an axis vibrates besides the motion.
    pub fn vibrates(&self) -> bool {
        self.vibration.iter().any(Option::is_some)
    }

    /// The same study along another course.
    pub fn along(&self, course: Arc<TimeFactor>) -> Self {
        Self { course, ..self.clone() }
    }

    /// The same study with another sensor.
    pub fn with_sensor(&self, axes: &[Tolerances; 3]) -> Self {
        Self { tolerances: alone(axes), between: axes.clone(), ..self.clone() }
    }

    /// A proof mass of one axis as hard to step as any of the members'.
    fn stiffest(&self, drawer: &Drawer, members: u64, run_s: f64) -> Option<ProofMass> {
        let warmer_k = self.course.temperature().range_above_reference_k();
        let masses = (0..members.min(ASKED)).filter_map(|m| drawer.member(m).sensor.proof_mass);
        masses.map(|mass| mass.at_its_stiffest(run_s, warmer_k)).reduce(|a, b| a.stiffer(&b))
    }

    /// Refuses an axis with a spring of which nothing is left at some time of the run.
    pub(super) fn lasting_springs(&self, name: &str, [still_s, duration_s]: [f64; 2]) -> Result<()> {
        let run = Lasting { still_s, duration_s, temperature: self.course.temperature() };
        self.tolerances.iter().try_for_each(|axis| mass_check::lasting_spring(name, axis, &run))
    }

    /// Returns what one member's readings take from other axes and instruments.
    fn coupling(all: &[Tolerances; 3], seeds: MemberSeeds<'_>) -> Coupling {
        // Each element is drawn apart: under a seed of its own, which no axis has.
        let draw = |key, axis: usize, element: usize| {
            all[axis].draw(key, |key| seeds.probability(key, (3 + 3 * element + axis) as u64))
        };
        let below = |axis: usize, from: usize| {
            if from < axis { draw(&coupling::ACCELEROMETER_MISALIGNMENT, axis, from) } else { 0.0 }
        };
        let turned = |axis: usize, from: usize| match axis == from {
            true => draw(&coupling::GYRO_SCALE_FACTOR, axis, axis),
            false => draw(&coupling::GYRO_MISALIGNMENT, axis, from),
        };
        Coupling {
            force_to_force: Matrix3::from_fn(below),
            rate_to_rate: Matrix3::from_fn(turned),
            force_to_rate: Matrix3::from_fn(|axis, from| draw(&coupling::G_SENSITIVITY, axis, from)),
        }
    }

    /// Returns what one member's readings take from the temperature and from late stamps, and where
    /// its gyros end.
    fn follow(all: &[Tolerances; 3], seeds: MemberSeeds<'_>) -> Follow {
        let of_axis = |axis: usize| move |key: &Key| seeds.probability(key, axis as u64);
        let draw = |key, axis: usize| all[axis].draw(key, of_axis(axis));
        let bias_then_scale = coupling::OVER_TEMPERATURE.map(|key| std::array::from_fn(|axis| draw(key, axis)));
        let [late_s, jitter_s, drift] = coupling::OF_THE_CLOCK.map(|key| draw(key, 0));
        let endless = Number::Fixed(f64::INFINITY);
        let range = &coupling::GYRO_RANGE;
        let gyro_range_rad_s = std::array::from_fn(|axis| all[axis].draw_or(range, endless, of_axis(axis)));
        Follow { per_kelvin: bias_then_scale, late_s, jitter_s, drift, gyro_range_rad_s }
    }

    /// The ensemble of a run, with statistics at `report_samples` after the end of the still start.
    ///
    /// # Errors
    /// A proof mass that no integrator can step.
    pub fn flight(&self, run: Run<'_>, mut report_samples: Vec<u64>) -> Result<Flight> {
        let still_samples = run.still_samples;
        report_samples.iter_mut().for_each(|sample| *sample += still_samples);
        let clock =
            Clock { samples: run.clock.samples + still_samples, report_samples, still_samples, ..run.clock.clone() };
        let axis = |axis: usize| -> Result<Job> {
            let seeds = run.seeds.along(axis);
            let (seed, chained) = (seeds.in_run(), seeds.chained());
            let tolerances = &self.tolerances[axis];
            let drawer = Drawer::new(tolerances, Variation::None, seeds);
            let stiffest = self.stiffest(&drawer, run.members, clock.duration_s());
            let integrator = tolerances.integrator(stiffest.as_ref(), clock.step_s)?.integrator;
            let waveform = Arc::new(Along {
                truth: self.course.truth.clone(),
                axis,
                standing_m_s2: self.course.standing()[0][axis],
                vibration: self.vibration[axis].clone(),
            });
            let moved = mass_check::Moved {
                stiffest: stiffest.as_ref(),
                waveform: waveform.as_ref(),
                gain: 1.0,
                own_sine_m_s2: 0.0,
                duration_s: run.clock.duration_s(),
                substep_s: clock.step_s / f64::from(integrator.substeps()),
            };
            mass_check::followed_memory("the study", &moved)?;
            Ok(Job {
                seed,
                members: run.members,
                clock: clock.clone(),
                draw: Arc::new(move |member| drawer.member(member)),
                waveform,
                integrator,
                // What follows it along a straight line is added where the axes are coupled.
                temperature: Arc::new(self.course.temperature().clone()),
                // Tilt and gravity are the navigation's.
                gravity_m_s2: 0.0,
                chained,
            })
        };
        let (seeds, all) = (run.seeds.clone(), self.between.clone());
        let has = |keys: &[&Key]| all.iter().any(|t| keys.iter().any(|key| t[*key].is_some_and(|n| !n.is_zero())));
        let couples = has(&coupling::COUPLINGS);
        let jitters = has(&[&coupling::TIME_JITTER]);
        let follows = has(&coupling::OVER_TEMPERATURE) || has(&coupling::OF_THE_CLOCK) || has(&[&coupling::GYRO_RANGE]);
        let (again, same) = (all.clone(), seeds.clone());
        let followed = move |member: u64| Self::follow(&again, same.member(member));
        let draws = move |member: u64| Self::coupling(&all, seeds.member(member));
        Ok(Flight {
            axes: [axis(0)?, axis(1)?, axis(2)?],
            coupling: couples.then(|| Arc::new(draws) as Arc<dyn Fn(u64) -> Coupling + Send + Sync>),
            follow: follows.then(|| Arc::new(followed) as Arc<dyn Fn(u64) -> Follow + Send + Sync>),
            jitters,
            course: self.course.clone(),
            vertical: self.vertical,
            misalignment: self.misalignment,
            fixes: Arc::default(),
            own: Arc::default(),
        })
    }
}
