//! `proofmass.report/1`: a recording's whole report as JSON, made of the documents of its parts.

use serde::Serialize;

use super::{Log, allan, check, inspection};
use proofmass_diagnosis::verdict::Verdict;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.report/1";

/// The public document `proofmass.report/1`; parts that were not made are null, and `not_made` says why.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document<'a> {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    file: &'a str,
    answers: Vec<Answer>,
    /// The model that was chosen, as TOML, where none was given.
    model: Option<&'a str>,
    verdict: &'a Verdict,
    check: Option<check::Document>,
    noise: Option<allan::Document>,
    inspect: inspection::Document,
    not_made: Vec<NotMade<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Answer {
    question: &'static str,
    answer: String,
}

/// A part that was not made.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct NotMade<'a> {
    part: &'static str,
    because: &'a str,
}

/// Makes the document.
pub fn document<'a>(log: &Log<'a>) -> Document<'a> {
    let because = [("check", log.checked.as_ref().err()), ("noise", log.noise.as_ref().err())];
    Document {
        schema: SCHEMA,
        file: log.file,
        answers: log.answers().map(|(question, answer)| Answer { question, answer }).into(),
        model: log.proposed,
        verdict: &log.diagnosis.verdict,
        check: log.checked.as_ref().ok().map(|checked| check::document(&[log.file.to_owned()], checked)),
        noise: log.noise.as_ref().ok().map(|noise| allan::document(&log.name(), noise)),
        inspect: inspection::document(log.file, log.seen),
        not_made: because.into_iter().filter_map(|(part, why)| Some(NotMade { part, because: why? })).collect(),
    }
}
