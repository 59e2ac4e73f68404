//! `proofmass schema`: the keys of a file, or the fields of a document that `--json` prints, as JSON
//! Schema (draft 2020-12), for editors that complete and programs that check.
//!
//! Made of the structs and key tables that files are read with and documents are written from, so that
//! it knows the same keys.

mod documents;

use std::sync::LazyLock;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use schemars::{Schema, schema_for};
use serde_json::json;

use super::output::sayln;
use super::template::Kind;
use documents::Document;
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_diagnosis::model::{Driven, Response, Static, Trajectory, Tumble};
use proofmass_diagnosis::plan::limits::Limits;
use proofmass_map::document::Document as Map;
use proofmass_study::file::File;

/// Arguments of `schema`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Kind of input file, or document by its name behind "proofmass."
    #[arg(value_enum)]
    kind: Of,
}

const EXAMPLES: &str = "Examples:
  proofmass schema study > study.schema.json
  proofmass schema verdict/1 > verdict.schema.json
In an editor with TOML schemas (taplo, Even Better TOML), the first line of study.toml:
  #:schema ./study.schema.json";

/// An input file or a document.
#[derive(Debug, Clone, Copy)]
enum Of {
    File(Kind),
    Document(Document),
}

static ALL: LazyLock<Vec<Of>> = LazyLock::new(|| {
    let files = Kind::value_variants().iter().copied().map(Of::File);
    files.chain(Document::value_variants().iter().copied().map(Of::Document)).collect()
});

impl ValueEnum for Of {
    fn value_variants<'a>() -> &'a [Self] {
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::File(kind) => kind.to_possible_value(),
            Self::Document(document) => document.to_possible_value(),
        }
    }
}

/// Prints it.
///
/// # Errors
/// Stdout cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let schema = match arguments.kind {
        Of::File(kind) => of_file(kind),
        Of::Document(document) => documents::schema(document),
    };
    sayln!("{}", to_json(&schema)?)
}

fn of_file(kind: Kind) -> Schema {
    match kind {
        Kind::Study | Kind::TrajectoryStudy => titled(schema_for!(File), "study.toml"),
        Kind::Driven => model(schema_for!(Driven), "driven"),
        Kind::Static => model(schema_for!(Static), "static"),
        Kind::Tumble => model(schema_for!(Tumble), "tumble"),
        Kind::Trajectory => model(schema_for!(Trajectory), "trajectory"),
        Kind::Response => model(schema_for!(Response), "response"),
        Kind::Limits => titled(schema_for!(Limits), "limits.toml"),
        Kind::Map => titled(schema_for!(Map), "map.toml"),
    }
}

fn titled(mut schema: Schema, title: &str) -> Schema {
    schema.insert("title".into(), title.into());
    schema
}

/// A model's first key says which kind it is; it is read before the rest.
fn model(schema: Schema, kind: &str) -> Schema {
    let mut schema = titled(schema, "model.toml");
    if let Some(properties) = schema.get_mut("properties").and_then(serde_json::Value::as_object_mut) {
        properties.insert("kind".into(), json!({ "const": kind, "description": "What was recorded" }));
    }
    match schema.get_mut("required").and_then(serde_json::Value::as_array_mut) {
        Some(required) => required.push("kind".into()),
        None => drop(schema.insert("required".into(), json!(["kind"]))),
    }
    schema
}
