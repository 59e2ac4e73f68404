//! `proofmass allan`: noise coefficients of a static log, and a sensor for a study made of them.

use std::path::PathBuf;

use super::say::{remark, sayln};
use crate::document::{writable, write_whole};
use crate::error::{Error, Result};
use crate::recording::Request;
use crate::recording::unit::{Quantity, Unit};
use crate::recording::{noise, rows};
use crate::report::allan as report;

/// Arguments of `allan`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// CSV file: a header, one row per sample
    recording: PathBuf,
    /// Sampling rate, Hz
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// Column that holds the time in s, instead of or beside the rate
    #[arg(long, value_name = "NAME")]
    time: Option<String>,
    /// Columns to analyse in the file's own unit [default: every column of numbers but the clock]
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    columns: Vec<String>,
    /// Columns that are specific force
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    accelerometer: Vec<String>,
    /// What one unit of the accelerometer columns is: g, mg, ug, m/s2, with a number if need be
    #[arg(long, value_name = "SCALE", default_value = "m/s2", requires = "accelerometer")]
    accelerometer_scale: String,
    /// Columns that are angular rate
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    gyro: Vec<String>,
    /// What one unit of the gyro columns is: rad/s, deg/s, mdeg/s, deg/h, with a number if need be
    #[arg(long, value_name = "SCALE", default_value = "rad/s", requires = "gyro")]
    gyro_scale: String,
    /// Folder for report.html, sensor.toml and, where a scale is given, a study.toml that runs
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "Examples:
  proofmass allan log.csv --rate-hz 100
  proofmass allan log.csv --rate-hz 100 --accelerometer ax,ay,az --accelerometer-scale 3.33mg \\
                          --gyro gx,gy,gz --gyro-scale 0.05deg/s --out noise";

/// Runs it.
///
/// # Errors
/// A recording that cannot be read, a scale that is none, a column named twice, a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let accelerometer = Unit::parse(&arguments.accelerometer_scale, Quantity::Accelerometer)?;
    let gyro = Unit::parse(&arguments.gyro_scale, Quantity::Gyro)?;
    let columns = [&arguments.columns[..], &arguments.accelerometer, &arguments.gyro].concat();
    if let Some(twice) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)).map(|(_, c)| c) {
        return Err(Error::new(
            "could not choose the columns",
            format!("`{twice}` is named twice"),
            "name a column once, under --columns, --accelerometer or --gyro",
        ));
    }
    rows::open(&arguments.recording)?;
    arguments.out.as_deref().map_or(Ok(()), writable)?;
    let request = Request { columns, rate_hz: arguments.rate_hz, time: arguments.time.clone(), ..Request::default() };
    let noise = noise::analyse(&arguments.recording, &request, |name| {
        let among = |columns: &[String]| columns.iter().any(|c| c == name);
        match name {
            _ if among(&arguments.accelerometer) => accelerometer.clone(),
            _ if among(&arguments.gyro) => gyro.clone(),
            _ => Unit::unknown(),
        }
    })?;
    let file = arguments.recording.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(folder) = &arguments.out {
        let fragments = report::fragments(&file, &noise);
        for fragment in &fragments {
            write_whole(&folder.join(&fragment.name), fragment.toml.as_bytes())?;
        }
        write_whole(&folder.join("report.html"), report::page(&file, &noise, &fragments).as_bytes())?;
        remark!("wrote {} and {}", folder.join("report.html").display(), folder.join("sensor.toml").display());
        if let Some(study) = report::study(&arguments.recording, &noise) {
            write_whole(&folder.join("study.toml"), study.as_bytes())?;
            remark!("simulate it beside its log: proofmass study {}", folder.join("study.toml").display());
        }
    }
    if json {
        sayln!("{:#}", report::document(&file, &noise))?;
    } else {
        report::tables(&noise).iter().try_for_each(|table| sayln!("{table}"))?;
        report::notes(&noise).iter().try_for_each(|note| sayln!("{note}"))?;
    }
    Ok(())
}
