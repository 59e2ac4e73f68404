//! Documents in and out: TOML with errors a person can act on, results as JSON, files written whole or not at all.
//!
//! Not for recordings: those stream, see `recording`.

use std::io::Write;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result, nearest};

/// Parses a TOML document. `name` stands in messages for where it came from.
///
/// # Errors
/// File, line and column; an unknown key also names the nearest known one.
pub fn parse_toml<T: DeserializeOwned>(name: &str, text: &str) -> Result<T> {
    toml::from_str(text).map_err(|error| {
        let place = match error.span() {
            Some(span) => {
                let before = &text[..span.start.min(text.len())];
                let line = before.matches('\n').count() + 1;
                let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
                format!("{name}:{line}:{column}: ")
            }
            None => String::new(),
        };
        let message = error.message();
        Error::new(format!("could not read {name}"), format!("{place}{message}"), hint(message))
    })
}

/// Reads and parses a TOML file.
///
/// # Errors
/// As [`parse_toml`], and when the file cannot be read.
pub fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, &e))?;
    parse_toml(&path.display().to_string(), &text)
}

fn hint(message: &str) -> String {
    // serde: "unknown field `membrs`, expected one of `name`, `members`"
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        let word = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        return match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known here: {}", known.join(", ")),
        };
    }
    "see the example in README.md; numbers need a digit on both sides of the point".into()
}

/// A result as one indented JSON document.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub fn to_json(result: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(result)
        .map_err(|e| Error::new("could not write the result as JSON", e.to_string(), "report this as a defect"))
}

/// Bytes as hexadecimal digits, two each: how checksums are written.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes a file beside its place and renames it, so that a reader never sees half of it.
///
/// # Errors
/// When the folder cannot be made or written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|e| Error::io("create the folder", folder, &e))?;
    let mut file = tempfile::Builder::new()
        .prefix(".proofmass-")
        .tempfile_in(folder)
        .map_err(|e| Error::io("write in", folder, &e))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let readable = std::fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(readable).map_err(|e| Error::io("write", path, &e))?;
    }
    file.write_all(bytes).map_err(|e| Error::io("write", path, &e))?;
    file.persist(path).map_err(|e| Error::io("write", path, &e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        #[serde(default)]
        #[allow(dead_code, reason = "only its name matters here")]
        members: u32,
    }

    #[test]
    fn an_unknown_key_is_placed_and_named() {
        let error = parse_toml::<Sample>("study.toml", "\nmembrs = 3\n").expect_err("misspelt");
        assert!(error.cause.starts_with("study.toml:2:1:"), "{}", error.cause);
        assert_eq!(error.hint, "did you mean `members`?");
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let blocked = folder.path().join("taken");
        std::fs::create_dir(&blocked).expect("a folder where the file should go");
        assert!(write_whole(&blocked, b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).expect("listing").count(), 1);
    }
}
