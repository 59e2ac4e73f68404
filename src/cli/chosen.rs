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

/// Requests of a command line on recordings, next to their model.
#[derive(Debug, Clone, Default)]
pub(super) struct Asked {
    /// Part of each recording that is used.
    pub part: Part,
    /// Headings of a driven recording.
    pub headings: Headings,
    /// Sampling rate of a recording without a clock, Hz.
    pub rate_hz: Option<f64>,
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
            rate_hz: self.rate_hz,
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
    let named = proposal::Named { input, output, rate_hz: asked.rate_hz, is_cut };
    proposal::proposed(&path.display().to_string(), &seen, &named)
}
