//! A sealed truth: a document whose SHA-256 is said before the first verdict, and which is opened only
//! if it is still the same after the last.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use proofmass_base::document::{hexadecimal, write_whole};
use proofmass_base::error::{Error, Result};

/// Writes the document. Returns its seal and the document as it was sealed: what is asked and judged is
/// that, bit for bit.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn seal<T: Serialize + DeserializeOwned>(truths: &T, path: &Path) -> Result<(String, T)> {
    let (bytes, seal) = closed(truths)?;
    write_whole(path, &bytes)?;
    Ok((seal, parse(&bytes, path)?))
}

/// Returns the document as it is sealed, with its seal.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub(crate) fn closed<T: Serialize>(truths: &T) -> Result<(Vec<u8>, String)> {
    let bytes = serde_json::to_vec(truths).map_err(|e| unsealed(&e.to_string()))?;
    let seal = hexadecimal(&Sha256::digest(&bytes));
    Ok((bytes, seal))
}

/// Returns the seal of a document that lies there already, and the document.
///
/// # Errors
/// The file cannot be read, or is of another version.
pub(crate) fn sealed<T: DeserializeOwned>(path: &Path) -> Result<(String, T)> {
    let bytes = std::fs::read(path).map_err(|e| Error::io("read", path, &e))?;
    Ok((hexadecimal(&Sha256::digest(&bytes)), parse(&bytes, path)?))
}

/// Opens the envelope after the last verdict.
///
/// # Errors
/// It has changed since it was sealed.
pub(crate) fn open<T: DeserializeOwned>(path: &Path, seal: &str) -> Result<T> {
    let bytes = std::fs::read(path).map_err(|e| Error::io("read", path, &e))?;
    let found = hexadecimal(&Sha256::digest(&bytes));
    if found != seal {
        let cause = format!("its SHA-256 is {found}, sealed was {seal}");
        return Err(not_opened(path, cause, "the trial is void; run it again in an empty folder"));
    }
    parse(&bytes, path)
}

/// Refuses a truth that cannot be written.
pub(crate) fn unsealed(cause: &str) -> Error {
    Error::new("could not seal the truth", cause, "this is a defect of the program; please report it")
}

fn not_opened(path: &Path, cause: String, hint: &str) -> Error {
    Error::new(format!("could not open the sealed truth {}", path.display()), cause, hint)
}

fn parse<T: DeserializeOwned>(bytes: &[u8], path: &Path) -> Result<T> {
    serde_json::from_slice(bytes)
        .map_err(|e| not_opened(path, e.to_string(), "it was written by another version; run the trial again"))
}
