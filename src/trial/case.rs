//! One blind case: its truth, and the two files that the diagnosis gets.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::ask::Files;
use super::driven::Driven;
use super::standstill::Still;
use super::turning::{GRAVITY_M_S2, Turned};
use proofmass_base::error::{Error, Result};
use proofmass_diagnosis::candidate::Kind;

/// States how an effect is concealed, or what else a case is for. Each is a row of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Nothing planted: linear, white noise.
    Null,
    /// Nothing but noise that enters as a force.
    ForceNoiseOnly,
    /// One effect at 1 % of the output.
    SingleOnePercent,
    /// One effect at 5 % of the output.
    SingleFivePercent,
    /// Two effects of similar size.
    Pair,
    /// Driven, physics that no candidate describes.
    UnknownPhysics,
    /// Smaller than the noise.
    UnderTheNoise,
    /// A narrow band at one amplitude: the base parameters take most of it.
    AbsorbedByBase,
    /// The amplitudes that show it are not in the recording.
    AmplitudesNotRecorded,
    /// One of a group of look-alikes.
    LookAlikes,
    /// A small effect behind one ten times larger.
    BehindALarger,
    /// A few contacts with a stop.
    RareInTime,
    /// One effect at a size drawn around the detection limit.
    AroundTheLimit,
    /// A free ring-down, with or without an effect.
    RingDown,
    /// At rest, white noise only.
    StillNull,
    /// At rest, one process planted.
    StillPlanted,
    /// At rest, temperature acts and its column is withheld.
    WithheldColumn,
    /// At rest, physics that no candidate describes.
    StillUnknown,
    /// Hand-rotated, nothing planted.
    TurnedNull,
    /// Hand-rotated, one fault.
    TurnedPlanted,
    /// Hand-rotated, something that no candidate describes.
    TurnedUnknown,
    /// One law in a form that the library holds and does not search for: a second mass that pulls
    /// back, friction that differs by direction.
    Unsearched,
}

impl Family {
    /// Every family, in the order of the report.
    pub const ALL: [Family; 22] = [
        Self::Null,
        Self::ForceNoiseOnly,
        Self::SingleOnePercent,
        Self::SingleFivePercent,
        Self::Pair,
        Self::UnknownPhysics,
        Self::UnderTheNoise,
        Self::AbsorbedByBase,
        Self::AmplitudesNotRecorded,
        Self::LookAlikes,
        Self::BehindALarger,
        Self::RareInTime,
        Self::AroundTheLimit,
        Self::RingDown,
        Self::StillNull,
        Self::StillPlanted,
        Self::WithheldColumn,
        Self::StillUnknown,
        Self::TurnedNull,
        Self::TurnedPlanted,
        Self::TurnedUnknown,
        Self::Unsearched,
    ];

    /// Returns whether its cases come behind those of all other families, which keep their numbers,
    /// and so their draws, as they were before it was added.
    pub fn is_drawn_last(self) -> bool {
        self == Self::Unsearched
    }

    /// Name of its row in the report.
    pub fn name(self) -> &'static str {
        match self {
            Self::Null => "nothing planted",
            Self::ForceNoiseOnly => "force noise only",
            Self::SingleOnePercent => "one effect, 1 % of the output",
            Self::SingleFivePercent => "one effect, 5 % of the output",
            Self::Pair => "two effects",
            Self::UnknownPhysics => "driven, unknown physics",
            Self::UnderTheNoise => "under the noise",
            Self::AbsorbedByBase => "absorbed by base parameters",
            Self::AmplitudesNotRecorded => "amplitudes not in the recording",
            Self::LookAlikes => "look-alikes",
            Self::BehindALarger => "behind a larger effect",
            Self::RareInTime => "rare in time (end stop)",
            Self::AroundTheLimit => "around the detection limit",
            Self::RingDown => "free ring-down",
            Self::StillNull => "at rest, nothing planted",
            Self::StillPlanted => "at rest, one process",
            Self::WithheldColumn => "at rest, temperature withheld",
            Self::StillUnknown => "at rest, unknown physics",
            Self::TurnedNull => "turned by hand, nothing planted",
            Self::TurnedPlanted => "turned by hand, one fault",
            Self::TurnedUnknown => "turned by hand, unknown physics",
            Self::Unsearched => "a law's form that is not searched for",
        }
    }
}

/// Recipe of the recording, by kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// One proof mass, driven or ringing.
    Driven(Box<Driven>),
    /// A sensor at rest.
    Still(Box<Still>),
    /// An IMU in many poses.
    Turned(Box<Turned>),
}

/// A case with its truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Number of the case in the trial.
    pub number: usize,
    /// Family that the case counts in.
    pub family: Family,
    /// Recipe of the recording.
    pub body: Body,
}

fn table(headings: &[&str], columns: &[&[f64]]) -> String {
    let mut text = headings.join(",") + "\n";
    for n in 0..columns[0].len() {
        for (c, column) in columns.iter().enumerate() {
            // Nine digits: finer than any noise planted, so that the file itself adds nothing.
            let _ = write!(text, "{}{:.8e}", if c > 0 { "," } else { "" }, column[n]);
        }
        text.push('\n');
    }
    text
}

impl Case {
    /// Kind of recording, as in model.toml.
    pub fn kind(&self) -> Kind {
        match self.body {
            Body::Driven(_) => Kind::Driven,
            Body::Still(_) => Kind::Static,
            Body::Turned(_) => Kind::Tumble,
        }
    }

    /// Ids of what is planted, sorted; foreign physics by its own name.
    pub fn planted(&self) -> Vec<String> {
        let mut ids: Vec<String> = match &self.body {
            Body::Driven(d) => d.planted.iter().map(|p| p.term.physics.id()).collect(),
            Body::Still(s) => s.planted.iter().map(|p| p.slow.id()).collect(),
            Body::Turned(t) => t.planted.iter().map(|p| p.fault.id()).collect(),
        };
        ids.sort();
        ids
    }

    /// For each planted effect the ids that are right for it.
    pub fn names(&self) -> Vec<Vec<String>> {
        match &self.body {
            Body::Driven(d) => d.planted.iter().map(|p| p.term.physics.names()).collect(),
            Body::Still(s) => s.planted.iter().map(|p| p.slow.names()).collect(),
            Body::Turned(t) => t.planted.iter().map(|p| p.fault.names()).collect(),
        }
    }

    /// Returns whether the library has a candidate for everything planted.
    pub fn in_library(&self) -> bool {
        self.foreign_words().is_empty()
    }

    /// Returns what is planted that no candidate describes, in words.
    pub fn foreign_words(&self) -> Vec<&'static str> {
        let mut words: Vec<&str> = match &self.body {
            Body::Driven(d) => d.planted.iter().map(|p| p.term.physics.foreign_words()).collect(),
            Body::Still(s) => s.planted.iter().map(|p| p.slow.foreign_words()).collect(),
            Body::Turned(t) => t.planted.iter().map(|p| p.fault.foreign_words()).collect(),
        };
        words.retain(|w| !w.is_empty());
        words
    }

    /// Visible size of each effect over the noise, with its id.
    pub fn sizes_over_noise(&self) -> Vec<(String, f64)> {
        match &self.body {
            Body::Driven(d) => {
                let ids = d.planted.iter().map(|p| p.term.physics.id());
                ids.enumerate().map(|(n, id)| (id, d.over_noise(n))).collect()
            }
            Body::Still(s) => s.planted.iter().map(|p| (p.slow.id(), p.visible())).collect(),
            Body::Turned(t) => t.planted.iter().map(|p| (p.fault.id(), p.visible)).collect(),
        }
    }

    /// Planted value of a parameter by its symbol, where the library's symbol means just that.
    pub fn parameter(&self, id: &str, channel: &str, name: &str) -> Option<f64> {
        let pick = |values: Vec<(&str, f64)>| values.into_iter().find(|(n, _)| *n == name).map(|(_, v)| v);
        match &self.body {
            Body::Driven(d) => {
                let planted = d.planted.iter().find(|p| p.term.physics.id() == id)?;
                pick(planted.term.parameters(&d.scales))
            }
            Body::Still(s) => {
                let planted = s.planted.iter().find(|p| p.slow.id() == id)?;
                let channel = ["x", "y", "z"].iter().position(|c| *c == channel)?;
                pick(s.parameters(planted, channel))
            }
            Body::Turned(t) => t.parameter(id, name),
        }
    }

    /// Symbol and value of the last planted effect's first parameter that is not zero, in the
    /// channel that shows it most.
    pub fn strength(&self) -> Option<(&'static str, f64)> {
        match &self.body {
            Body::Driven(d) => d.planted.last()?.term.parameters(&d.scales).into_iter().find(|p| p.1 != 0.0),
            Body::Still(s) => {
                let process = s.planted.last()?;
                let most = (0..3).max_by(|a, b| process.channels[*a].abs().total_cmp(&process.channels[*b].abs()))?;
                s.parameters(process, most).first().copied()
            }
            Body::Turned(_) => None,
        }
    }

    /// Returns what the diagnosis may see, and nothing else: the recording and the base model.
    pub fn texts(&self) -> [String; 2] {
        let (recording, model) = match &self.body {
            Body::Driven(d) => driven_files(d),
            Body::Still(s) => still_files(s),
            Body::Turned(t) => turned_files(t),
        };
        [recording, model]
    }

    /// Writes [`texts`](Self::texts) into a folder.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Files> {
        let [recording, model] = self.texts();
        let files =
            Files { recording: folder.join("recording.csv"), model: folder.join("model.toml"), judging: Vec::new() };
        // They serve one verdict and go with their folder: nobody meets half of one after a crash.
        for (path, text) in [(&files.recording, recording), (&files.model, model)] {
            std::fs::write(path, text).map_err(|e| Error::io("write", path, &e))?;
        }
        Ok(files)
    }
}

fn driven_files(case: &Driven) -> (String, String) {
    let columns = case.render();
    let mut headings = Vec::new();
    let mut values: Vec<&[f64]> = Vec::new();
    let mut model = format!("kind = \"driven\"\nrate_hz = {}\n[columns]\n", case.rate_hz);
    if let Some(force) = &columns.force {
        headings.push("force");
        values.push(force);
        model += "input = \"force\"\n";
    }
    headings.push("reading");
    values.push(&columns.reading);
    model += "output = \"reading\"\n";
    if let Some(temperature) = &columns.temperature {
        headings.push("temperature");
        values.push(temperature);
        model += "environment = [\"temperature\"]\n";
    }
    if let Some([resonance_hz, damping_ratio]) = case.hints {
        let _ = write!(model, "[start]\nresonance_hz = {resonance_hz:e}\ndamping_ratio = {damping_ratio:e}\n");
    }
    (table(&headings, &values), model)
}

fn still_files(case: &Still) -> (String, String) {
    let channels = case.render();
    let mut headings = vec!["x", "y", "z"];
    let mut values: Vec<&[f64]> = channels.readings.iter().map(Vec::as_slice).collect();
    let mut model = format!("kind = \"static\"\nrate_hz = {}\nunit = \"g\"\n[columns]\n", case.rate_hz);
    model += "channels = [\"x\", \"y\", \"z\"]\n";
    if let Some(temperature) = &channels.temperature {
        headings.push("temperature");
        values.push(temperature);
        model += "environment = [\"temperature\"]\n";
    }
    if let Some(density) = case.promised_density() {
        let _ = write!(model, "[noise]\ndensity = {density:e}\n");
    }
    (table(&headings, &values), model)
}

fn turned_files(case: &Turned) -> (String, String) {
    let counts = case.render();
    let mut headings = vec!["ax", "ay", "az", "gx", "gy", "gz"];
    let mut values: Vec<&[f64]> = counts.readings.iter().map(Vec::as_slice).collect();
    let mut model = format!("kind = \"tumble\"\nrate_hz = {}\ngravity_m_s2 = {GRAVITY_M_S2}\n", case.rate_hz);
    model += "[columns]\ngyro = [\"gx\", \"gy\", \"gz\"]\naccelerometer = [\"ax\", \"ay\", \"az\"]\n";
    if case.has_temperature() {
        headings.push("temperature");
        values.push(&counts.temperature);
        model += "environment = [\"temperature\"]\n";
    }
    (table(&headings, &values), model)
}
