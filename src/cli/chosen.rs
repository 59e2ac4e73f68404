//! The model that a recording is held against: a file, or what the headings suggest.

use std::path::Path;

use super::output::remark;
use proofmass_base::control::Control;
use proofmass_base::error::Result;
use proofmass_diagnosis::model::{self, Model, Seconds};
use proofmass_diagnosis::proposal;
use proofmass_recording::{Request, inspection};

/// Arguments that say which part of each recording is used.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Part {
    /// Topic, message or array to read, if a recording has several; also `topic` in the model
    #[arg(long, value_name = "TOPIC")]
    pub topic: Option<String>,
    /// Use each recording from this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub from_s: Option<f64>,
    /// Use each recording up to this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub to_s: Option<f64>,
}

/// Arguments that stand in for what a driven model would say.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Headings {
    /// Heading of the force on a proof mass, where no model is given
    #[arg(long, value_name = "COLUMN", conflicts_with = "model")]
    pub input: Option<String>,
    /// Heading of its reading, where no model is given
    #[arg(long, value_name = "COLUMN", conflicts_with = "model")]
    pub output: Option<String>,
}

/// Arguments that say when the rows of a recording were taken, where no model does.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Clock {
    /// Sampling rate of a recording without a clock, where no model is given, Hz
    #[arg(long, value_name = "F", conflicts_with = "model", allow_negative_numbers = true)]
    pub rate_hz: Option<f64>,
    /// Column that holds the time, where no model is given; its heading may name the unit: t_s, t_ms,
    /// t_us, t_ns
    #[arg(long, value_name = "COLUMN", conflicts_with = "model")]
    pub time: Option<String>,
}

/// Requests of a command line on recordings, next to their model.
#[derive(Debug, Clone, Default)]
pub(super) struct Asked {
    /// Part of each recording that is used.
    pub part: Part,
    /// Headings of a driven recording.
    pub headings: Headings,
    /// Clock of each recording.
    pub clock: Clock,
}

impl Part {
    /// Returns the seconds that are used.
    pub(super) fn seconds(&self) -> Seconds {
        Seconds { from_s: self.from_s, to_s: self.to_s }
    }
}

impl Asked {
    /// Returns how the recording is first looked at.
    pub(super) fn request(&self, control: &Control) -> Request {
        Request {
            topic: self.part.topic.clone(),
            from_s: self.part.from_s,
            to_s: self.part.to_s,
            rate_hz: self.clock.rate_hz,
            time: self.clock.time.clone(),
            control: control.clone(),
            ..Request::default()
        }
    }
}

/// The model of a file, or the one that the first recording suits, with its text.
///
/// # Errors
/// A model that cannot be read, a recording that suits none.
pub(super) fn model_for(
    first: &Path,
    file: Option<&Path>,
    asked: &Asked,
    control: &Control,
) -> Result<(Model, Option<String>)> {
    let (model, text) = match file {
        Some(path) => (model::read(path)?, None),
        None => {
            let text = proposed(first, asked, control)?;
            remark!("no model was given; this one was chosen:\n{}", text.trim_end());
            (proposal::parsed(&text)?, Some(text))
        }
    };
    Ok((asked.part.topic.as_ref().map_or_else(|| model.clone(), |topic| model.clone().of_topic(topic)), text))
}

/// The model that a recording suits.
fn proposed(path: &Path, asked: &Asked, control: &Control) -> Result<String> {
    let seen = inspection::inspect(path, &asked.request(control))?;
    let Headings { input, output } = asked.headings.clone();
    let is_cut = asked.part.seconds() != Seconds::default();
    let Clock { rate_hz, time } = asked.clock.clone();
    let named = proposal::Named { input, output, rate_hz, time, is_cut };
    proposal::proposed(&path.display().to_string(), &seen, &named)
}
