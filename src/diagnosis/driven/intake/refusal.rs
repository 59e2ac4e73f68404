//! States why a diagnosis ends before it has a verdict: something is wrong with the recording, or
//! somebody stopped it.

use crate::control::Stopped;
use crate::document::toml_string;
use crate::error::Error;
use crate::model::DrivenColumns;
use crate::recording::Recording;

/// Reason why there is no verdict.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// Input and output have nothing to do with each other, or no oscillator can be fitted; in
    /// words.
    Cause(String),
    /// It was asked to stop.
    Stopped(Stopped),
}

impl From<Stopped> for Refusal {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}

impl Refusal {
    /// Returns the error of this recording's diagnosis by these columns.
    pub(crate) fn of(self, recording: &Recording, columns: &DrivenColumns) -> Error {
        let attempt = format!("could not diagnose {}", recording.path.display());
        match self {
            Self::Cause(cause) if columns.input.is_none() => {
                let output = toml_string(&columns.output);
                let hint = format!(
                    "if nothing swings here and the sensor is at rest, give a --model with kind = \"static\" and channels = \
                     [{output}] under [columns] (`proofmass template static`); if it was shaken, name the input"
                );
                Error::new(attempt, cause, hint)
            }
            Self::Cause(cause) => {
                let hint = "check that input and output are the right columns and that the input moves the output";
                Error::new(attempt, cause, hint)
            }
            Self::Stopped(stopped) => stopped.during(attempt, "start it again"),
        }
    }
}
