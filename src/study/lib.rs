//! study.toml → Study → Job: what the user asks, checked, in SI units, with its tolerances.
//!
//! Not for running anything: `ensemble` integrates the job, `drift` makes the answer of it.

#![warn(unreachable_pub)]

pub mod aiding;
pub mod alignment;
mod check;
mod compare;
mod draw;
pub mod file;
pub mod flown;
pub mod groups;
pub mod in_motion;
mod mass_check;
pub mod overrides;
mod per_axis;
mod preset;
mod refusal;
pub mod second;
pub mod section;
pub mod source;
pub mod surroundings;
pub mod sweep;
mod temperature;
pub mod tolerances;
mod unstated;

// The crates below, under the names by which files here call them.
use proofmass_base::{control, document, error, number, units};
use proofmass_kernel as kernel;
use proofmass_numerics::{numerics, rng};
use proofmass_physics as physics;
use proofmass_scenario::{excitation, motion, sensor};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::control::Control;
use crate::document::{from_table, hexadecimal, parse_toml, read_text};
use crate::error::{Error, Result};
use crate::excitation::plan::{Plan, Variation};
use crate::excitation::reader::Run;
use crate::kernel::chained::Chained;
use crate::kernel::flight::Flight;
use crate::kernel::integrator::Choice;
use crate::kernel::job::{Clock, Integrator, Job, Member};
use crate::motion::temperature::Temperature;
use crate::sensor::{ProofMass, SensorTerm};
use crate::units::STANDARD_GRAVITY_M_S2;
use alignment::Alignment;
pub use check::is_plausible;
use draw::Drawer;
use in_motion::InMotion;
use mass_check::Lasting;
pub use overrides::{Assignment, Overrides};
pub use preset::Preset;
use second::Second;
pub use source::{StudyText, read_default};
pub use surroundings::Surroundings;
pub use sweep::Axis;
use tolerances::Tolerances;

/// A study.toml, checked and in SI units.
#[derive(Clone)]
pub struct Study {
    /// Name of the report's folder.
    pub name: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Sensors in the ensemble.
    pub members: u64,
    /// Discrete time from the end of the still start, if there is one; `report_samples` are the
    /// user's report times.
    pub clock: Clock,
    /// Initial alignment: what is known of attitude and bias at the start.
    pub alignment: Alignment,
    /// Every number that may be drawn.
    pub tolerances: Tolerances,
    /// Excitation of the sensor.
    pub excitation: Plan,
    /// Temperature of the sensor along one axis; along a trajectory its course has it.
    pub temperature: Arc<Temperature>,
    /// A static log to compare with the simulation.
    pub compare: Option<file::Compare>,
    /// Motion that makes it one of six axes, where a trajectory carries it.
    pub in_motion: Option<InMotion>,
    /// Folder that relative paths start from.
    pub folder: PathBuf,
    /// SHA-256 of what was read, overrides included, and of the file that it replays: two studies
    /// with the same one give the same numbers.
    pub identity: String,
    /// Recordings that it reads.
    pub reads: Vec<PathBuf>,
    /// Keys that take several values, one after the other.
    pub sweep: Option<sweep::Sweep>,
    /// The document that it was read from, changes included but members and seed.
    pub text: String,
    /// Random numbers that come from a second sample.
    second: Option<Second>,
    /// Chain of which its members are, if they are of one.
    chained: Option<Arc<dyn Chained>>,
}

/// Reads and checks study.toml.
///
/// # Errors
/// A file that cannot be read, an unknown key (the nearest is named), a value that makes no sense
/// alone or next to the others, a replay that cannot be read, Ctrl-C.
pub fn read(path: &Path, overrides: &Overrides, control: &Control) -> Result<Study> {
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    parse_watched(&path.display().to_string(), &read_text(path)?, overrides, &Surroundings::new(folder, control))
}

/// A study from text, with paths relative to `folder`; nobody watches.
///
/// # Errors
/// As [`read`].
pub fn parse(name: &str, text: &str, folder: &Path) -> Result<Study> {
    parse_watched(name, text, &Overrides::default(), &Surroundings::new(folder, &Control::silent()))
}

/// A study from text.
///
/// # Errors
/// As [`read`].
pub fn parse_watched(name: &str, text: &str, overrides: &Overrides, surroundings: &Surroundings) -> Result<Study> {
    // As written first, so that its own mistakes are placed by line.
    let file: file::File = parse_toml(name, text)?;
    if overrides.is_empty() {
        return Study::new(name, text.to_owned(), file, overrides, surroundings);
    }
    Study::from_document(name, parse_toml(name, text)?, overrides, surroundings)
}

/// A study that was never text, with paths relative to the folder of the process.
///
/// # Errors
/// As [`read`], without a place in a file.
pub fn of_table(name: &str, table: toml::Table, overrides: &Overrides, control: &Control) -> Result<Study> {
    let surroundings = Surroundings::new("", control);
    if !overrides.is_empty() {
        return Study::from_document(name, table, overrides, &surroundings);
    }
    let text = table.to_string();
    Study::new(name, text, from_table(name, table)?, overrides, &surroundings)
}

/// The numbers of a sensor that stands in a study.toml or alone in a sensor.toml, axis by axis, and
/// its readings per second. Recordings that the file names are not read.
///
/// # Errors
/// As [`read`], of what concerns the sensor.
pub fn sensor(name: &str, text: &str) -> Result<([Tolerances; 3], f64)> {
    let file: file::File = parse_toml(name, text)?;
    let axis = |axis: usize| check::tolerances(name, &file, axis);
    Ok(([axis(0)?, axis(1)?, axis(2)?], check::rate_hz(name, &file)?))
}

impl Study {
    fn from_document(name: &str, mut document: toml::Table, overrides: &Overrides, at: &Surroundings) -> Result<Self> {
        overrides.apply(&mut document)?;
        let source = format!("{name} {}", overrides.words());
        let text = document.to_string();
        Self::new(&source, text, from_table(&source, document)?, overrides, at)
    }

    fn new(source: &str, text: String, mut file: file::File, overrides: &Overrides, at: &Surroundings) -> Result<Self> {
        let folder = &at.folder;
        file.members = overrides.members.or(file.members);
        let seed = overrides.seed.or(file.seed).unwrap_or(1);
        let members = check::members(source, &file)?;
        let clock = check::clock(source, &file)?;
        let mut tolerances = check::tolerances(source, &file, 0)?;
        // The identity knows a path as it was written: the same study is the same from any folder.
        let as_written = file.trajectory.clone();
        file.trajectory = file.trajectory.take().map(|section| section.in_folder(folder));
        let in_motion = in_motion::read(source, &file, &clock, seed)?;
        let alignment = alignment::alignment(source, file.alignment.as_ref(), clock.sample_s(), in_motion.is_some())?;
        if in_motion.is_none()
            && let Some(tilt) = alignment::tilt(source, file.alignment.as_ref())?
        {
            tolerances[&SensorTerm::InitialTilt.row().keys[0]] = Some(tilt);
        }
        let temperature = match in_motion {
            Some(_) => Temperature::default(),
            None => temperature::read(
                source,
                file.temperature.as_ref(),
                &with_compared(&tolerances, file.compare.as_ref()),
            )?,
        };
        compare::check(source, &file, alignment)?;
        let compared = file.compare.as_ref().map(|c| c.file.as_path());
        let recordings = file.excitation.file().map(Path::new).into_iter().chain(compared);
        let mut reads: Vec<PathBuf> = recordings.map(|recording| folder.join(recording)).collect();
        let flown = file.trajectory.as_ref().and_then(|t| t.compare.as_ref());
        reads.extend(flown.into_iter().flat_map(|compare| compare.reads()).map(Path::to_path_buf));
        reads.extend(file.trajectory.iter().flat_map(|t| [&t.file, &t.times]).flatten().cloned());
        let run = Run { source, duration_s: clock.duration_s(), seed, folder, control: &at.control };
        let excitation = excitation::plan(&file.excitation, run)?;
        excitation.drawn.iter().for_each(|(key, number)| tolerances[key] = Some(*number));
        check::signs(source, &tolerances)?;
        mass_check::delayed_force(source, &tolerances, excitation.variation)?;
        let still_s = alignment.still_samples() as f64 * clock.sample_s();
        let duration_s = clock.duration_s();
        match &in_motion {
            Some(motion) => motion.lasting_springs(source, [still_s, duration_s])?,
            None => {
                let run = Lasting { still_s, duration_s, temperature: &temperature };
                mass_check::lasting_spring(source, &tolerances, &run)?;
            }
        }
        let excitation = excitation.resolved(source, clock.step_s)?;
        let sweep = file.sweep.as_ref().map(sweep::Sweep::read).transpose().map_err(|cause| {
            let hint = "e.g. [sweep] with gyro.bias_deg_h = \"1:20:log8\"";
            Error::new(format!("could not use {source}"), format!("[sweep]: {cause}"), hint)
        })?;
        (file.members, file.seed, file.trajectory) = (Some(members), Some(seed), as_written);
        // Debug writes every key that serde reads, and every digit of its numbers.
        let identity = hexadecimal(&Sha256::digest(format!("{file:?} {:?}", excitation.replayed_sha256)));
        Ok(Self {
            name: checked_name(source, file.name)?,
            seed,
            members,
            clock,
            alignment,
            tolerances,
            excitation,
            temperature: Arc::new(temperature),
            compare: file.compare,
            in_motion,
            folder: folder.clone(),
            identity,
            reads,
            sweep,
            text,
            second: None,
            chained: None,
        })
    }

    /// The same sensor lying still for a number of samples, with what is special about one axis of
    /// it.
    ///
    /// # Errors
    /// The axis' own sections make no sense.
    pub fn at_rest(&self, axis: &file::Axis, sample_s: f64, samples: u64, members: u64) -> Result<Self> {
        let name = format!("compare.axis {}", axis.column);
        let mut still = self.clone();
        still.tolerances = axis.over(&self.tolerances);
        check::numbers(&name, &still.tolerances)?;
        still.members = members;
        still.alignment = Alignment::Ideal;
        still.clock =
            Clock { step_s: sample_s, steps_per_sample: 1, samples, report_samples: vec![samples], still_samples: 0 };
        still.excitation = excitation::rest::plan();
        Ok(still)
    }

    /// Returns whether it has a `[temperature]` that no coefficient of its sensor follows.
    pub fn temperature_is_idle(&self) -> bool {
        match &self.in_motion {
            Some(motion) => temperature::is_idle(motion.course.temperature(), &motion.between),
            None => temperature::is_idle(&self.temperature, &with_compared(&self.tolerances, self.compare.as_ref())),
        }
    }

    /// Length of the run, s, from the end of the still start.
    pub fn duration_s(&self) -> f64 {
        self.clock.duration_s()
    }

    /// Time between readings, s.
    pub fn sample_s(&self) -> f64 {
        self.clock.sample_s()
    }

    /// Member `index` as drawn.
    pub fn member(&self, index: u64) -> Member {
        self.drawer().member(index)
    }

    fn drawer(&self) -> Drawer {
        Drawer::new(&self.tolerances, self.excitation.variation, self.seeds())
    }

    /// A proof mass as hard to step as any of the members': highest resonance, strongest further
    /// terms; of a thousand members, where mechanics are drawn. `None` without mechanics.
    pub fn stiffest(&self) -> Option<ProofMass> {
        let (drawer, run_s) = (self.drawer(), self.still_s() + self.duration_s());
        let warmer_k = self.temperature.range_above_reference_k();
        let masses = (0..self.members.min(1000)).filter_map(|m| drawer.member(m).sensor.proof_mass);
        masses.map(|mass| mass.at_its_stiffest(run_s, warmer_k)).reduce(|a, b| a.stiffer(&b))
    }

    /// Returns the integrator of its proof masses along one axis.
    ///
    /// # Errors
    /// A proof mass that no integrator can step.
    pub fn integrator(&self) -> Result<Choice> {
        let stiffest = self.stiffest();
        let choice = self.tolerances.integrator(stiffest.as_ref(), self.clock.step_s)?;
        let (mean, variance) = self.tolerances.moments(&excitation::SIZE);
        let largest = mean.abs() + 2.0 * variance.sqrt();
        let (gain, own_sine_m_s2) = match self.excitation.variation {
            Variation::None => (1.0, 0.0),
            Variation::Gain => (largest, 0.0),
            Variation::Sine => (1.0, largest),
        };
        mass_check::followed_memory(
            &self.name,
            &mass_check::Moved {
                stiffest: stiffest.as_ref(),
                waveform: self.excitation.waveform.as_ref(),
                gain,
                own_sine_m_s2,
                duration_s: self.clock.duration_s(),
                substep_s: self.clock.step_s / f64::from(choice.integrator.substeps()),
            },
        )?;
        Ok(choice)
    }

    /// Refuses a study in six axes where one of a single axis is meant.
    ///
    /// # Errors
    /// It has a trajectory.
    pub fn along_one_axis(&self) -> Result<()> {
        match &self.in_motion {
            None => Ok(()),
            Some(_) => Err(Error::new(
                format!("could not simulate {} along one axis", self.name),
                "it has a [trajectory]",
                "samples and ranks of MPI are for one axis: run it without them, or remove the [trajectory]",
            )),
        }
    }

    /// The ensemble of six axes to integrate, with statistics at `report_samples` after the end of
    /// the still start.
    ///
    /// # Errors
    /// A proof mass that no integrator can step.
    pub fn flight(&self, motion: &InMotion, report_samples: Vec<u64>) -> Result<Flight> {
        let still_samples = self.alignment.still_samples();
        let seeds = &self.seeds();
        let run = in_motion::Run { seeds, members: self.members, clock: &self.clock, still_samples };
        motion.flight(run, report_samples)
    }

    /// Length of the still start, s; 0 without one.
    pub fn still_s(&self) -> f64 {
        self.alignment.still_samples() as f64 * self.sample_s()
    }

    /// The ensemble to integrate, with statistics at `report_samples` after the end of the still
    /// start.
    pub fn job(&self, integrator: Integrator, mut report_samples: Vec<u64>) -> Job {
        let still_samples = self.alignment.still_samples();
        report_samples.iter_mut().for_each(|sample| *sample += still_samples);
        let samples = self.clock.samples + still_samples;
        let drawer = self.drawer();
        Job {
            seed: self.seeds().in_run(),
            members: self.members,
            clock: Clock { samples, report_samples, still_samples, ..self.clock.clone() },
            draw: Arc::new(move |index| drawer.member(index)),
            waveform: self.excitation.waveform.clone(),
            integrator,
            temperature: self.temperature.clone(),
            gravity_m_s2: STANDARD_GRAVITY_M_S2,
            chained: self.chained.clone(),
        }
    }
}

/// The sensor's numbers, and those of each axis that a log is compared with.
fn with_compared(tolerances: &Tolerances, compare: Option<&file::Compare>) -> Vec<Tolerances> {
    let axes = compare.into_iter().flat_map(|compare| &compare.axis);
    std::iter::once(tolerances.clone()).chain(axes.map(|axis| axis.over(tolerances))).collect()
}

/// Longest name of a study, bytes: a folder's, with room for what a file system adds.
const LONGEST_NAME_BYTES: usize = 100;

/// Returns whether a study's name may hold a character.
fn plain(c: char) -> bool {
    c.is_alphanumeric() || "-_. ".contains(c)
}

/// The name of a study about a file of this name: what no folder may be called becomes a hyphen,
/// and accents that stand for themselves, as in file names on a Mac, go.
pub fn name_for(stem: &str) -> String {
    let accents = '\u{300}'..='\u{36f}';
    let kept = stem.chars().filter(|c| !accents.contains(c)).map(|c| if plain(c) { c } else { '-' });
    let mut name: String = kept.skip_while(|c| *c == '.' || *c == ' ').collect();
    name.truncate(name.floor_char_boundary(LONGEST_NAME_BYTES - 20));
    let name = name.trim_end();
    if name.is_empty() { "recording".into() } else { name.into() }
}

/// A name that can be a folder's.
fn checked_name(source: &str, name: Option<String>) -> Result<String> {
    let name = name.unwrap_or_else(|| "study".into());
    match !name.is_empty() && name.len() <= LONGEST_NAME_BYTES && name.chars().all(plain) && !name.starts_with('.') {
        true => Ok(name),
        false => Err(Error::new(
            format!("could not use {source}"),
            format!("name = \"{name}\" cannot be the name of a folder"),
            "use letters, digits, - and _",
        )),
    }
}
