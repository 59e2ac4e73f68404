//! `proofmass export`: a sensor as the configuration of an estimator or a simulator.

use std::path::{Path, PathBuf};

use super::output::{remark, say, sayln};
use proofmass_base::document::{read_text, to_json};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_export::filter::Filter;
use proofmass_export::imu::Imu;
use proofmass_export::{self as export, TARGETS};

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The sensor: a study.toml, a sensor.toml or a repaired.toml
    #[arg(required_unless_present = "list")]
    sensor: Option<PathBuf>,
    /// Tool to write for; --list shows all
    #[arg(long, value_name = "TARGET", required_unless_present = "list")]
    to: Option<String>,
    /// Messages or readings per second [default: the sensor's sample_rate_hz]
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// Filter that the messages stand behind: none, or low-pass:HZ for one pole with this cut-off
    #[arg(long, value_name = "FILTER", default_value = "none", allow_hyphen_values = true)]
    filter: String,
    /// File to write [default: stdout]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace FILE even if it is not from an earlier run of this command on the same input
    #[arg(long, requires = "out")]
    force: bool,
    /// List the tools whose configurations can be written
    #[arg(long, conflicts_with_all = ["sensor", "to", "out"])]
    list: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass export --list
  proofmass export sensor.toml --to kalibr --out imu.yaml
  proofmass export study.toml --to gazebo-sdf
  proofmass export sensor.toml --to ros-covariance --rate-hz 200 --filter low-pass:80

Each number is preceded by its unit, its convention and a reference to the tool's documentation.
What the tool cannot represent is stated, with the error of what replaces it.";

/// Runs it.
///
/// # Errors
/// A file that is no sensor, an unknown tool, a rate or a filter that it cannot take, a file that cannot
/// be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let (Some(path), Some(to)) = (&arguments.sensor, &arguments.to) else { return list(json) };
    let target = export::target(to)?;
    let filter = Filter::parse(&arguments.filter)?;
    let imu = Imu::parse(&path.display().to_string(), &read_text(path)?)?;
    let imu = imu.sent(target, arguments.rate_hz, filter)?;
    if imu.axes.is_none() {
        remark!("note: {} has one number for all axes: x, y and z are written alike", path.display());
    }
    let request = output::Request {
        command: "export",
        inputs: vec![path.clone()],
        force: arguments.force,
        keeps: true,
        ..output::Request::default()
    };
    deliver(&target.export(&imu), arguments.out.as_deref(), request, json)
}

fn list(json: bool) -> Result<()> {
    if json {
        let entry = |t: &export::Target| serde_json::json!({"name": t.name, "about": t.about, "imports": t.imports()});
        return sayln!("{}", to_json(&TARGETS.iter().map(entry).collect::<Vec<_>>())?);
    }
    TARGETS.iter().try_for_each(|t| {
        let back = if t.imports() { "; `import` reads it back" } else { "" };
        sayln!("{:<20}{}{back}", t.name, t.about)
    })
}

/// Prints a text, or writes it to a file if that is this command's own.
///
/// # Errors
/// The file is the user's, or cannot be written.
pub(super) fn deliver(text: &str, out: Option<&Path>, mut request: output::Request, json: bool) -> Result<()> {
    let Some(out) = out else {
        return match json {
            true => sayln!("{}", to_json(&serde_json::json!({ "text": text }))?),
            false => say(format_args!("{text}")),
        };
    };
    let Some(name) = out.file_name().and_then(|n| n.to_str()) else {
        let cause = "it does not end with the name of a file";
        return Err(Error::new(
            format!("could not write {}", out.display()),
            cause,
            "give a file, e.g. --out imu.yaml",
        ));
    };
    let parent = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    request.writes = vec![name.to_owned()];
    let mut folder = Folder::open(parent, request)?;
    folder.write(name, text.as_bytes())?;
    folder.finish()?;
    if json {
        return sayln!("{}", to_json(&serde_json::json!({ "out": out.display().to_string(), "text": text }))?);
    }
    remark!("wrote {}", out.display());
    Ok(())
}
