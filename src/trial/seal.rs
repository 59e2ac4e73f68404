//! The truth as a sealed document: written and hashed before the first verdict, opened and checked
//! after the last.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::envelope;
use super::plan::Plan;
use proofmass_base::error::Result;

/// Contents of the sealed file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Always "proofmass.truth/1".
    pub schema: String,
    /// Plan that the cases were drawn by.
    pub plan: Plan,
    /// Every case with what was planted.
    pub cases: Vec<Case>,
}

/// Truth of a trial, sealed by its SHA-256.
#[derive(Debug, Clone, PartialEq)]
pub struct Sealed {
    /// Path of the sealed truth.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

impl Truth {
    /// Wraps the cases of a plan.
    pub fn new(plan: Plan, cases: Vec<Case>) -> Self {
        Self { schema: "proofmass.truth/1".into(), plan, cases }
    }

    /// Writes the document and returns its seal.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn seal(&self, path: &Path) -> Result<Sealed> {
        let (sha256, _) = envelope::seal(self, path)?;
        Ok(Sealed { path: path.into(), sha256 })
    }

    /// The document as it is sealed, with its seal.
    ///
    /// # Errors
    /// None for the types of this crate, whose keys are strings.
    pub fn sealed(&self) -> Result<(Vec<u8>, String)> {
        envelope::closed(self)
    }
}

impl Sealed {
    /// The seal of a document that lies there already.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn of(path: &Path) -> Result<Self> {
        let (sha256, _) = envelope::sealed::<Truth>(path)?;
        Ok(Self { path: path.into(), sha256 })
    }

    /// Opens the envelope.
    ///
    /// # Errors
    /// When the document has changed since it was sealed, or cannot be read.
    pub fn open(&self) -> Result<Truth> {
        envelope::open(&self.path, &self.sha256)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;

    #[test]
    fn a_changed_truth_is_refused_and_an_untouched_one_comes_back_whole() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("truth.json");
        let plan = Plan { seed: 1, cases: 17, samples: 400, campaign: Campaign::Concealed };
        let cases = vec![plan.draw(0, crate::case::Family::Null, 0)];
        let truth = Truth::new(plan, cases);
        let sealed = truth.seal(&path).expect("written");
        let opened = sealed.open().expect("opens");
        assert_eq!((opened.plan, opened.cases.len()), (truth.plan, 1));
        let mut bytes = std::fs::read(&path).expect("readable");
        let last = bytes.len() - 10;
        bytes[last] ^= 1;
        std::fs::write(&path, bytes).expect("writable");
        assert!(sealed.open().is_err());
    }
}
