//! `proofmass allan`: noise coefficients of a static log, and a sensor for a study made of them.

use std::path::{Path, PathBuf};

use super::numbers;
use super::say::{remark, say, sayln, screen};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_export::imu::Imu;
use proofmass_export::{self as export, Target};
use proofmass_recording::finding::Finding;
use proofmass_recording::noise::{self, Noise};
use proofmass_recording::unit::{Quantity, Unit};
use proofmass_recording::{self as recording, Request};
use proofmass_recording::{roles, stream};
use proofmass_report::allan as report;

/// Arguments of `allan`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The recording: text, an array, a table or a robot's log; - is standard input
    recording: PathBuf,
    /// Topic, message or array to read, if the file has several
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Sampling rate, Hz
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// Column that holds the time, instead of or in addition to the rate; its heading may name the
    /// unit: t_s, t_ms, t_us, t_ns
    #[arg(long, value_name = "NAME")]
    time: Option<String>,
    /// Columns to analyse in the file's own unit [default: every column of numbers but the clock]
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    columns: Vec<String>,
    /// Columns that are specific force
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    accelerometer: Vec<String>,
    /// Scale of the accelerometer columns: g, mg, ug or m/s2, optionally with a factor (3.33mg)
    #[arg(long, value_name = "SCALE", default_value = "m/s2", requires = "accelerometer")]
    accelerometer_scale: String,
    /// Columns that are angular rate
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    gyro: Vec<String>,
    /// Scale of the gyro columns: rad/s, deg/s, mdeg/s or deg/h, optionally with a factor
    /// (0.05deg/s)
    #[arg(long, value_name = "SCALE", default_value = "rad/s", requires = "gyro")]
    gyro_scale: String,
    /// Use the recording from this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    from_s: Option<f64>,
    /// Use the recording up to this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    to_s: Option<f64>,
    /// Folder for report.html, sensor.toml and, if a scale is given, a study.toml ready to run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the sensor as this tool's configuration: into DIR, or without --out only to
    /// stdout; see `proofmass export --list`
    #[arg(long, value_name = "TARGET")]
    to: Option<String>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    force: bool,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long, requires = "out")]
    parquet: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass allan log.csv --rate-hz 100
  proofmass allan log.csv --rate-hz 100 --accelerometer ax,ay,az --accelerometer-scale 3.33mg \\
                          --gyro gx,gy,gz --gyro-scale 0.05deg/s --out noise";

/// Runs it.
///
/// # Errors
/// The recording cannot be read, a scale is invalid, a column is named twice, or the folder cannot
/// be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let request = Request { control: progress::terminal(), ..arguments.request() };
    let asked = Asked::new(request, &arguments.scales())?;
    let target = arguments.to.as_deref().map(export::target).transpose()?;
    recording::formats::located(&arguments.recording)?;
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, arguments.outputs())).transpose()?;
    let noise = asked.analyse(&arguments.recording)?;
    let file = arguments.recording.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let configuration = target.map(|target| configuration(target, &file, &noise)).transpose()?;
    if let (Some((_, text)), None) = (&configuration, &folder) {
        report::notes(&noise).iter().for_each(|note| remark!("{note}"));
        return match json {
            true => sayln!("{:#}", serde_json::json!({ "text": text })),
            false => say(format_args!("{text}")),
        };
    }
    let written = folder.map(|folder| arguments.write(folder, &file, &noise, configuration)).transpose();
    if json {
        sayln!("{:#}", report::document(&file, &noise))?;
    } else {
        let tables: String = report::tables(&noise).iter().map(|table| format!("\n{table}")).collect();
        screen(format_args!("{}\n{tables}\n", report::answer(&noise)))?;
        report::notes(&noise).iter().try_for_each(|note| sayln!("{note}"))?;
    }
    let Some((folder, files)) = arguments.out.as_ref().zip(written?) else { return Ok(()) };
    remark!("wrote {} in {}", files.join(", "), folder.display());
    if files.iter().any(|name| name == STUDY) {
        remark!("simulate it beside its log: proofmass study {}", folder.join(STUDY).display());
    }
    Ok(())
}

/// Which columns are a sensor's, and what one unit of them is.
#[derive(Debug, Clone, Default)]
pub struct Scales {
    /// Columns that are specific force.
    pub accelerometer: Vec<String>,
    /// Unit of the accelerometer's columns.
    pub accelerometer_scale: String,
    /// Columns that are angular rate.
    pub gyro: Vec<String>,
    /// Unit of the gyro's columns.
    pub gyro_scale: String,
}

/// What is asked of a recording, checked.
pub struct Asked {
    request: Request,
    scaled: [(Vec<String>, Unit); 2],
}

impl Asked {
    /// The columns of `request` and those of `scales`; none: all of them.
    ///
    /// # Errors
    /// A scale is invalid, or a column is named twice.
    pub fn new(request: Request, scales: &Scales) -> Result<Self> {
        let Scales { accelerometer, accelerometer_scale, gyro, gyro_scale } = scales;
        let scaled = [
            (accelerometer.clone(), Unit::parse(accelerometer_scale, Quantity::Accelerometer)?),
            (gyro.clone(), Unit::parse(gyro_scale, Quantity::Gyro)?),
        ];
        let columns = [&request.columns[..], accelerometer, gyro].concat();
        if let Some(twice) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)).map(|(_, c)| c) {
            return Err(Error::new(
                "could not choose the columns",
                format!("`{twice}` is named twice"),
                "name a column once, under --columns, --accelerometer or --gyro",
            ));
        }
        Ok(Self { request: Request { columns, ..request }, scaled })
    }

    /// The noise of these columns, in the units that the user or the file gives them.
    ///
    /// # Errors
    /// As `noise::analyse`.
    pub fn analyse(&self, recording: &Path) -> Result<Noise> {
        let known =
            if self.request.columns.is_empty() { inertial(recording, &self.request)? } else { Inertial::default() };
        let mut noise = noise::analyse(recording, &self.request, |name| {
            let given = self.scaled.iter().find(|(columns, _)| columns.iter().any(|c| c == name)).map(|(_, unit)| unit);
            let unit = given.or_else(|| known.units.iter().find(|u| u.0 == name).map(|u| &u.1));
            unit.cloned().unwrap_or_else(Unit::unknown)
        })?;
        noise.source.findings.extend(known.findings);
        Ok(noise)
    }
}

/// Columns that are known for those of an inertial sensor, and their units.
#[derive(Default)]
struct Inertial {
    units: Vec<(String, Unit)>,
    findings: Vec<Finding>,
}

/// Knows them by their names, and by the units that the file states.
fn inertial(recording: &Path, request: &Request) -> Result<Inertial> {
    let (names, stated) = stream::headings(recording, request)?;
    let mut known = Inertial::default();
    let found = roles::of(&names);
    let kinds = [
        (found.gyro, Quantity::Gyro, "rad/s", "--gyro-scale"),
        (found.accelerometer, Quantity::Accelerometer, "m/s2", "--accelerometer-scale"),
    ];
    for (places, quantity, usual, option) in kinds {
        let mut assumed = Vec::new();
        for place in places.into_iter().flatten() {
            let unit = match roles::unit(&names[place], stated[place].as_deref()) {
                Some(unit) => unit.filter(|u| u.quantity == quantity),
                None => {
                    assumed.push(names[place].clone());
                    Some(Unit::parse(usual, quantity)?)
                }
            };
            known.units.extend(unit.map(|unit| (names[place].clone(), unit)));
        }
        if !assumed.is_empty() {
            known.findings.push(Finding::UnitAssumed { columns: assumed, unit: usual, option });
        }
    }
    for (name, _) in names.iter().zip(&stated).filter(|(_, stated)| stated.is_none()) {
        if known.units.iter().all(|(other, _)| other != name) {
            known.units.extend(roles::alone(name).map(|unit| (name.clone(), unit)));
        }
    }
    Ok(known)
}

const REPORT: &str = "report.html";
const STUDY: &str = "study.toml";

impl Arguments {
    fn request(&self) -> Request {
        Request {
            topic: self.topic.clone(),
            columns: self.columns.clone(),
            rate_hz: self.rate_hz,
            time: self.time.clone(),
            from_s: self.from_s,
            to_s: self.to_s,
            ..Request::default()
        }
    }

    fn scales(&self) -> Scales {
        Scales {
            accelerometer: self.accelerometer.clone(),
            accelerometer_scale: self.accelerometer_scale.clone(),
            gyro: self.gyro.clone(),
            gyro_scale: self.gyro_scale.clone(),
        }
    }

    fn outputs(&self) -> output::Request {
        let scaled = !self.accelerometer.is_empty() || !self.gyro.is_empty();
        let target = self.to.as_deref().and_then(|to| export::target(to).ok());
        let files = [REPORT, "sensor.toml"].into_iter().chain(scaled.then_some(STUDY)).chain(target.map(|t| t.file));
        let files = files.map(str::to_owned).chain(numbers::files(self.parquet));
        output::Request {
            command: "allan",
            inputs: vec![self.recording.clone()],
            writes: files.collect(),
            force: self.force,
            ..output::Request::default()
        }
    }

    /// Writes the results and gives the files' names.
    fn write(
        &self,
        mut folder: Folder,
        file: &str,
        noise: &Noise,
        configuration: Option<(String, String)>,
    ) -> Result<Vec<String>> {
        let fragments = report::fragments(file, noise);
        numbers::write(&mut folder, REPORT, report::page(file, noise, &fragments))?;
        let mut files: Vec<_> = fragments.into_iter().map(|fragment| (fragment.name, fragment.toml)).collect();
        files.extend(report::study(&self.recording, noise).map(|study| (STUDY.to_owned(), study)));
        files.extend(configuration);
        files.iter().try_for_each(|(name, text)| folder.write(name, text.as_bytes()))?;
        folder.finish()?;
        Ok(std::iter::once(REPORT.to_owned()).chain(files.into_iter().map(|(name, _)| name)).collect())
    }
}

/// The sensor of the accelerometers and gyros, three of each by axis, or the first of each, as a
/// tool's configuration: its file's name and text.
fn configuration(target: &Target, file: &str, noise: &Noise) -> Result<(String, String)> {
    let axes: Vec<Imu> = report::fragments(file, noise)
        .iter()
        .map(|fragment| Imu::parse(file, &fragment.toml))
        .collect::<Result<_>>()
        .map_err(|error| {
            let hint =
                "name the columns and their scales with --accelerometer and --gyro; see `proofmass allan --help`";
            Error::new(format!("could not export the noise of {file}"), error.cause, hint)
        })?;
    let imu = match &axes[..] {
        [x, y, z] => x.clone().with_axes([x, y, z].map(|axis| [axis.accelerometer, axis.gyro])),
        [x, ..] => x.clone(),
        [] => {
            return Err(Error::new(format!("could not export the noise of {file}"), "it has no channel", "give a log"));
        }
    };
    Ok((target.file.to_owned(), target.export(&imu)))
}
