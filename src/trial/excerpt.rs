//! Cuts part of a real recording into a separate file, next to its base model.

use std::path::{Path, PathBuf};

use super::ask::Files;
use proofmass_base::error::{Error, Result};

/// Part of a recording in the folder of recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excerpt<'a> {
    /// Path within the folder of recordings.
    pub file: &'a Path,
    /// Data rows used, half-open; absent means all.
    pub rows: Option<[usize; 2]>,
    /// Every k-th of these rows; absent means all.
    pub every: Option<usize>,
}

impl Excerpt<'_> {
    /// Returns the path of the part: the recording itself where all of it is wanted, else a file in
    /// `folder`.
    ///
    /// # Errors
    /// When files cannot be read or written.
    pub fn path(&self, data: &Path, folder: &Path) -> Result<PathBuf> {
        let recording = data.join(self.file);
        if self.rows.is_none() && self.every.is_none() {
            return Ok(recording);
        }
        let part = folder.join("recording.csv");
        cut(&recording, self.rows.unwrap_or([0, usize::MAX]), self.every.unwrap_or(1), &part)?;
        Ok(part)
    }

    /// Puts the files of a verdict together in one folder: the part, the base model, and recordings
    /// that only judge. In the model, `$PROOFMASS_DATA` stands for the folder of
    /// recordings.
    ///
    /// # Errors
    /// When files cannot be read or written.
    pub fn files(&self, data: &Path, folder: &Path, model: &Path, judging: &[PathBuf]) -> Result<Files> {
        let recording = self.path(data, folder)?;
        let text = std::fs::read_to_string(model).map_err(|e| Error::io("read", model, &e))?;
        let model = folder.join("model.toml");
        let full = std::path::absolute(data).map_err(|e| Error::io("find", data, &e))?;
        let text = text.replace("$PROOFMASS_DATA", &full.display().to_string());
        std::fs::write(&model, text).map_err(|e| Error::io("write", &model, &e))?;
        Ok(Files { recording, model, judging: judging.iter().map(|file| data.join(file)).collect() })
    }
}

/// Writes the heading and every k-th of the rows wanted to another file.
fn cut(from: &Path, rows: [usize; 2], every: usize, to: &Path) -> Result<()> {
    let text = std::fs::read_to_string(from).map_err(|e| Error::io("read", from, &e))?;
    let mut lines = text.lines();
    let heading = lines.next().unwrap_or_default();
    let wanted = lines.take(rows[1]).skip(rows[0]).step_by(every.max(1));
    let kept: Vec<&str> = std::iter::once(heading).chain(wanted).collect();
    std::fs::write(to, kept.join("\n") + "\n").map_err(|e| Error::io("write", to, &e))
}
