//! `proofmass template`: a complete, commented file of each kind, to begin from.

use super::output::{say, sayln};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;

/// Arguments of `template`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Kind of input file
    #[arg(value_enum)]
    kind: Kind,
}

const EXAMPLES: &str = "Examples:
  proofmass template study > study.toml
  proofmass template driven > model.toml";

/// The files that can be written by hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Kind {
    /// study.toml for `study`
    Study,
    /// study.toml in six axes, along a trajectory
    TrajectoryStudy,
    /// model.toml for `diagnose`: one proof mass, shaken or ringing
    Driven,
    /// model.toml for `diagnose`: sensors at rest
    Static,
    /// model.toml for `diagnose`: an IMU in many still poses
    Tumble,
    /// model.toml for `diagnose`: an IMU in motion, next to a reference
    #[value(alias = "flight")]
    Trajectory,
    /// model.toml for `diagnose`: stepped-sine sweeps of a resonator
    #[value(alias = "sweeps")]
    Response,
    /// map.toml for `map`
    Map,
    /// limits.toml for `plan`
    Limits,
}

impl Kind {
    fn text(self) -> &'static str {
        match self {
            Self::Study => include_str!("template/study.toml"),
            Self::TrajectoryStudy => include_str!("template/trajectory-study.toml"),
            Self::Driven => include_str!("template/driven.toml"),
            Self::Static => include_str!("template/static.toml"),
            Self::Tumble => include_str!("template/tumble.toml"),
            Self::Trajectory => include_str!("template/trajectory.toml"),
            Self::Response => include_str!("template/response.toml"),
            Self::Map => include_str!("template/map.toml"),
            Self::Limits => include_str!("template/limits.toml"),
        }
    }
}

/// Prints it; as JSON, one string.
///
/// # Errors
/// Stdout cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let text = arguments.kind.text();
    if json {
        return sayln!("{}", to_json(&text)?);
    }
    say(format_args!("{text}"))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use proofmass_base::document::parse_toml;
    use proofmass_diagnosis::model;
    use proofmass_diagnosis::plan::limits::Limits;
    use proofmass_map::document::Document;
    use proofmass_study as study;

    fn parsed(kind: Kind, text: &str) -> Result<()> {
        match kind {
            Kind::Study | Kind::TrajectoryStudy => study::parse("the template", text, Path::new("")).map(drop),
            Kind::Map => parse_toml::<Document>("the template", text).map(drop),
            Kind::Limits => Limits::parse("the template", text).map(drop),
            _ => model::parse("the template", text).map(drop),
        }
    }

    /// With the settings that stand in comments.
    fn with_options(text: &str) -> String {
        let is_setting = |l: &str| {
            l.starts_with('[')
                || l.split_once(" = ").is_some_and(|(k, _)| k.chars().all(|c| c == '_' || c.is_alphanumeric()))
        };
        let line = |l: &str| match l.strip_prefix("# ") {
            Some(setting) if is_setting(setting) => format!("{setting}\n"),
            _ => format!("{l}\n"),
        };
        text.lines().map(line).collect()
    }

    #[test]
    fn every_template_is_read_by_the_tool_as_it_is_and_with_every_option() {
        for kind in <Kind as clap::ValueEnum>::value_variants() {
            let text = kind.text();
            parsed(*kind, text).unwrap_or_else(|e| panic!("{kind:?}: {e}"));
            let all = with_options(text);
            parsed(*kind, &all).unwrap_or_else(|e| panic!("{kind:?} with every option: {e}\n{all}"));
            // Control: a key that is not known is refused.
            assert!(parsed(*kind, &format!("surplus = 1\n{text}")).is_err(), "{kind:?}");
        }
        let options = with_options(Kind::Driven.text());
        assert!(options.contains("\ntopic = ") && options.contains("\n[split]"), "{options}");
    }
}
