//! Surroundings in which a study is read.

use std::path::PathBuf;

use crate::control::Control;

/// Folder that the relative paths of a study start from, and who watches while the recording that it
/// replays is read.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    /// Folder of the study's file.
    pub folder: PathBuf,
    /// Who watches and may stop.
    pub control: Control,
}

impl Surroundings {
    /// In this folder, watched by this control.
    pub fn new(folder: impl Into<PathBuf>, control: &Control) -> Self {
        Self { folder: folder.into(), control: control.clone() }
    }
}
