//! Schemas of the documents that `--json` prints, by name and version. Under one version fields may be
//! added, so that none forbids further ones.

use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema, json_schema};
use serde_json::{Value, json};

use proofmass_diagnosis::verdict::Verdict;
use proofmass_report::{allan, check, inspection, log, plan};
use proofmass_simulate::{decision, drift, strapdown};

/// A document.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum Document {
    /// what `study` and `merge` print
    #[value(name = "study/1")]
    Study,
    /// what `study --sweep` prints
    #[value(name = "sweep/1")]
    Sweep,
    /// what `require` prints
    #[value(name = "require/1")]
    Require,
    /// what `diagnose` prints, and verdict.json
    #[value(name = "verdict/1")]
    Verdict,
    /// what `allan` prints
    #[value(name = "allan/1")]
    Allan,
    /// what `check` prints, and check.json
    #[value(name = "check/1")]
    Check,
    /// what `plan` prints, and plan.json
    #[value(name = "plan/1")]
    Plan,
    /// what `inspect` prints
    #[value(name = "inspect/1")]
    Inspect,
    /// what `report` prints, and report.json
    #[value(name = "report/1")]
    Report,
}

/// The schema of a document.
pub(super) fn schema(document: Document) -> Schema {
    let generator = SchemaSettings::draft2020_12().for_serialize().with_transform(nullable).into_generator();
    match document {
        Document::Study => of_study(generator),
        Document::Sweep => root::<decision::sweep_document::Document>(generator, "proofmass.sweep/1"),
        Document::Require => root::<decision::document::Document>(generator, "proofmass.require/1"),
        Document::Verdict => root::<Verdict>(generator, "proofmass.verdict/1"),
        Document::Allan => root::<allan::Document>(generator, "proofmass.allan/1"),
        Document::Check => root::<check::Document>(generator, "proofmass.check/1"),
        Document::Plan => root::<plan::Document>(generator, "proofmass.plan/1"),
        Document::Inspect => root::<inspection::Document>(generator, "proofmass.inspect/1"),
        Document::Report => root::<log::Document<'_>>(generator, "proofmass.report/1"),
    }
}

fn root<T: JsonSchema>(generator: SchemaGenerator, title: &str) -> Schema {
    let mut schema = generator.into_root_schema_for::<T>();
    schema.insert("title".into(), title.into());
    schema
}

/// A study on one axis, or along a trajectory.
fn of_study(mut generator: SchemaGenerator) -> Schema {
    let one_axis = generator.subschema_for::<drift::document::Document>();
    let trajectory = generator.subschema_for::<strapdown::document::Document>();
    let definitions = generator.take_definitions(true);
    json_schema!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "proofmass.study/1",
        "anyOf": [one_axis, trajectory],
        "$defs": definitions,
    })
}

/// JSON has no infinity and none of a number that does not exist: both are written as null.
fn nullable(schema: &mut Schema) {
    if schema.get("type").is_some_and(|t| t == "number") {
        schema.insert("type".into(), json!(["number", "null"]));
    }
    if schema.get("format").and_then(Value::as_str) == Some("double") {
        schema.remove("format");
    }
    transform_subschemas(&mut nullable, schema);
}
