//! `proofmass import`: a sensor.toml from the configuration of an estimator or a simulator.

use std::path::PathBuf;

use super::export::deliver;
use proofmass_base::document::read_text;
use proofmass_base::error::Result;
use proofmass_base::output;
use proofmass_export as export;

/// Arguments of `import`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Configuration file of another tool
    configuration: PathBuf,
    /// Tool that it was written for: kalibr, openvins, gazebo-sdf or matlab
    #[arg(long, value_name = "TARGET")]
    from: String,
    /// File to write [default: stdout]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace FILE even if it is not from an earlier run of this command on the same input
    #[arg(long, requires = "out")]
    force: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass import imu.yaml --from kalibr --out sensor.toml
  proofmass export sensor.toml --to px4

To simulate it, put name, members and duration_s above its first section: then it is a study.toml.";

/// Runs it.
///
/// # Errors
/// A configuration that cannot be read, an unknown tool, a file that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let target = export::target(&arguments.from)?;
    let path = &arguments.configuration;
    let imu = target.import(&path.display().to_string(), &read_text(path)?)?;
    let request = output::Request {
        command: "import",
        inputs: vec![path.clone()],
        force: arguments.force,
        keeps: true,
        ..output::Request::default()
    };
    deliver(&imu.sensor_toml(target.name), arguments.out.as_deref(), request, json)
}
