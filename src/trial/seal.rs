//! The truth as a sealed document: written and hashed before the first verdict, opened and checked
//! after the last.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::case::Case;
use super::plan::Plan;
use proofmass_base::document::{hexadecimal, write_whole};
use proofmass_base::error::{Error, Result};

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

fn hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
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
        let bytes = self.bytes()?;
        write_whole(path, &bytes)?;
        Ok(Sealed { path: path.into(), sha256: hash(&bytes) })
    }

    /// The document as it is sealed, with its seal.
    ///
    /// # Errors
    /// None for the types of this crate, whose keys are strings.
    pub fn sealed(&self) -> Result<(Vec<u8>, String)> {
        let bytes = self.bytes()?;
        let sha256 = hash(&bytes);
        Ok((bytes, sha256))
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        serde_json::to_vec(self).map_err(|e| {
            Error::new("could not seal the truth", e.to_string(), "this is a defect of the program; please report it")
        })
    }
}

impl Sealed {
    /// The seal of a document that lies there already.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn of(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io("read", path, &e))?;
        Ok(Self { path: path.into(), sha256: hash(&bytes) })
    }

    /// Opens the envelope.
    ///
    /// # Errors
    /// When the document has changed since it was sealed, or cannot be read.
    pub fn open(&self) -> Result<Truth> {
        let attempt = format!("could not open the sealed truth {}", self.path.display());
        let bytes = std::fs::read(&self.path).map_err(|e| Error::io("read", &self.path, &e))?;
        let found = hash(&bytes);
        if found != self.sha256 {
            let cause = format!("its SHA-256 is {found}, sealed was {}", self.sha256);
            return Err(Error::new(attempt, cause, "the trial is void; run it again in an empty folder"));
        }
        serde_json::from_slice(&bytes)
            .map_err(|e| Error::new(attempt, e.to_string(), "it was written by another version; run the trial again"))
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
