//! Why a file in a folder of results must not be replaced, in words.

use std::collections::BTreeMap;
use std::path::Path;

use super::manifest::Identity;
use crate::error::Error;

/// So many files of a kind are named.
const NAMED: usize = 6;

/// Why a file must not be replaced.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reason {
    /// The run reads it.
    Input,
    /// A folder stands there.
    Folder,
    /// A file stands where its folder would go.
    File,
    /// Its folder is a link to another place.
    Link,
    /// A link, a pipe or a device stands where a state is kept.
    Special,
    /// It has been changed since this run wrote it.
    Changed,
    /// Another run wrote it.
    Other(Identity),
    /// No run wrote it.
    Unknown,
}

impl Reason {
    /// Returns whether it holds for a run that is forced too.
    pub(super) fn stands_against_force(&self) -> bool {
        matches!(self, Self::Input | Self::Folder | Self::File | Self::Link | Self::Special)
    }

    fn words(&self) -> String {
        match self {
            Self::Input => "an input of this run".into(),
            Self::Folder => "a folder where a file would be written".into(),
            Self::File => "its folder has the name of an existing file".into(),
            Self::Link => "its folder is a link to another place, where nothing is written".into(),
            Self::Special => "a link, a pipe or a device where a file was expected".into(),
            Self::Changed => "changed since proofmass wrote it".into(),
            Self::Unknown => "not written by proofmass".into(),
            Self::Other(Identity { command, inputs }) if inputs.is_empty() => {
                format!("written by `proofmass {command}`")
            }
            Self::Other(Identity { command, inputs }) => {
                format!("written by `proofmass {command}` for {}", inputs.join(" and "))
            }
        }
    }
}

/// Names as they are said: of several files in a folder below, the folder and their number.
fn together<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let (mut plain, mut below) = (Vec::new(), BTreeMap::<&str, Vec<&str>>::new());
    for name in names {
        match name.rsplit_once('/') {
            None => plain.push(name.to_owned()),
            Some((folder, _)) => below.entry(folder).or_default().push(name),
        }
    }
    plain.extend(below.into_iter().map(|(folder, names)| match names[..] {
        [only] => only.to_owned(),
        _ => format!("{folder}/ ({} files)", names.len()),
    }));
    plain
}

/// The error that names the files.
pub(crate) fn refuse(folder: &Path, found: &[(String, Reason)]) -> Error {
    let mut reasons: Vec<&Reason> = found.iter().map(|(_, reason)| reason).collect();
    reasons.sort();
    reasons.dedup();
    let sentence = |reason: &&Reason| {
        let names = together(found.iter().filter(|(_, r)| r == *reason).map(|(name, _)| name.as_str()));
        let more = match names.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("{}{more}: {}", names[..names.len().min(NAMED)].join(", "), reason.words())
    };
    let cause: Vec<String> = reasons.iter().map(sentence).collect();
    let hint = match found.iter().any(|(_, reason)| reason.stands_against_force()) {
        true => "give another folder with --out DIR",
        false => "give another folder with --out DIR, or --force to replace them",
    };
    Error::new(format!("could not replace files in {}", folder.display()), cause.join("; "), hint)
}
