//! Excites the sensor: specific force along the sensitive axis as a function of time.
//!
//! # Adding a kind
//! One file with the waveform and its `KIND`: the name, the keys with their forms, and how a plan
//! is made of them; and its name in `KINDS`. Reading, placing misspelt keys, refusing foreign and
//! missing ones follow from it.
//!
//! Not for the sensor's answer (`sensor`, `kernel`).

pub mod keys;
pub mod multisine;
pub mod plan;
pub mod random;
pub mod reader;
pub mod rectangle;
pub mod replay;
pub mod rest;
pub mod section;
pub mod shock;
pub mod sine;
pub mod sweep;
pub mod waveform;

use std::sync::OnceLock;

#[cfg(feature = "schema")]
use schemars::{Schema, SchemaGenerator};
use serde::Deserializer;

use crate::error::Result;
use plan::Plan;
use reader::{Kind, Reader, Run};
use section::{Known, Section};

pub use keys::{FREQUENCY, PHASE, SIZE};
pub use rest::Rest;
pub use sine::MemberSine;
pub use waveform::Waveform;

/// Every kind; the first is the one of a study that names none.
pub(crate) const KINDS: &[Kind] =
    &[rest::KIND, rectangle::KIND, sine::KIND, sweep::KIND, multisine::KIND, random::KIND, shock::KIND, replay::KIND];

/// Reads `[excitation]`.
///
/// # Errors
/// An unknown kind or key, a value of another form.
pub fn section<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Section, D::Error> {
    static KNOWN: OnceLock<Known> = OnceLock::new();
    section::read(deserializer, KNOWN.get_or_init(|| Known::of(KINDS.iter().map(|k| (k.name, k.keys)))))
}

/// `[excitation]` as JSON Schema: one alternative a kind, with the keys that it takes.
#[cfg(feature = "schema")]
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    let mut kinds = Vec::new();
    for kind in KINDS {
        let mut properties = serde_json::Map::new();
        properties.insert("kind".into(), serde_json::json!({ "const": kind.name }));
        for (key, form) in kind.keys {
            properties.insert((*key).into(), form.schema(generator).into());
        }
        kinds.push(schemars::json_schema!({
            "type": "object",
            "properties": properties,
            "required": ["kind"],
            "additionalProperties": false,
        }));
    }
    schemars::json_schema!({ "oneOf": kinds })
}

/// Makes the excitation of a run.
///
/// # Errors
/// A key that is missing or belongs to another kind, a value that makes no sense, a recording that
/// cannot be read.
pub fn plan(section: &Section, run: Run<'_>) -> Result<Plan> {
    let kind = KINDS.iter().find(|k| Some(k.name) == section.kind).unwrap_or(&rest::KIND);
    let reader = Reader { kind, section, run };
    let moving: Vec<&str> = KINDS.iter().filter(|k| !k.keys.is_empty()).map(|k| k.name).collect();
    reader.only_its_keys(&moving)?;
    (kind.plan)(&reader)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_has_one_form_whatever_the_kind() {
        let keys: Vec<_> = KINDS.iter().flat_map(|k| k.keys).collect();
        for (name, form) in &keys {
            assert!(keys.iter().all(|(other, f)| other != name || f == form), "{name}");
        }
        assert_eq!(KINDS[0].name, "rest");
    }
}
