//! The file that a stopped run leaves and a resumed one goes on from: a state with its checksum.

use std::path::Path;

use sha2::{Digest, Sha256};

use super::state::{Run, SCHEMA, State};
use super::verify;
use crate::document::{hexadecimal, write_whole};
use crate::error::{Error, Result};

/// Leaves the file, whole or not at all.
///
/// # Errors
/// It cannot be written.
pub(super) fn write(state: &mut State, path: &Path) -> Result<()> {
    let unwritten =
        |e: serde_json::Error| Error::new(format!("could not write {}", path.display()), e.to_string(), "run again");
    state.sha256 = checksum(state).map_err(unwritten)?;
    write_whole(path, &serde_json::to_vec(state).map_err(unwritten)?)
}

fn checksum(state: &State) -> serde_json::Result<String> {
    let bare = State { sha256: String::new(), ..state.clone() };
    Ok(hexadecimal(&Sha256::digest(serde_json::to_vec(&bare)?)))
}

/// Reads the file of the same part of the same run.
///
/// # Errors
/// There is none, it is damaged, or it belongs to another run.
pub(super) fn read(path: &Path, run: &Run<'_>) -> Result<State> {
    let bytes = std::fs::read(path).map_err(|e| Error::io("resume from", path, &e))?;
    parse(&bytes, run).map_err(|cause| {
        Error::new(
            format!("could not resume from {}", path.display()),
            cause,
            "leave --resume out to start over, or give the study, seed and members of that run",
        )
    })
}

/// The state in the bytes of such a file; the error is what is wrong with them.
fn parse(bytes: &[u8], run: &Run<'_>) -> Result<State, String> {
    let state: State = serde_json::from_slice(bytes).map_err(|e| format!("it is not the state of a run: {e}"))?;
    if state.schema != SCHEMA {
        return Err(format!("it is of another version: {:?}, and this one reads {SCHEMA:?}", state.schema));
    }
    if state.fingerprint != run.fingerprint() {
        return Err(
            "it belongs to another run: the study, the file that it replays, the seed, the number of members or \
                    the version of the program is not the same"
                .to_owned(),
        );
    }
    if checksum(&state).ok().as_ref() != Some(&state.sha256) {
        return Err("the file is damaged: it does not have its checksum".to_owned());
    }
    if state.members != (0..run.job.members) {
        return Err("it belongs to a shard, not to the whole run".to_owned());
    }
    verify::check(&state, run.job).map_err(|what| format!("the file is damaged: {what}"))?;
    Ok(state)
}
