//! `proofmass allan`: noise coefficients of a static log, and a sensor for a study made of them.

use std::path::{Path, PathBuf};

use super::numbers;
use super::output::{remark, say, sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::escape;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_export::filter::Filter;
use proofmass_export::imu::{Errors, Imu};
use proofmass_export::{self as export, Target};
use proofmass_numerics::numerics::allan::law::Term;
use proofmass_numerics::numerics::moments::rms;
use proofmass_recording::finding::Finding;
use proofmass_recording::noise::{self, Channel, Noise};
use proofmass_recording::roles::{self, Stated};
use proofmass_recording::scale::{self, Measured, Named};
use proofmass_recording::stream;
use proofmass_recording::unit::{Quantity, Unit};
use proofmass_recording::{self as recording, Request};
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
    /// Use --rate-hz even against the file's own clock
    #[arg(long, requires = "rate_hz")]
    force_rate: bool,
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
    /// [default: the unit that the file states, else m/s2]
    #[arg(long, value_name = "SCALE", requires = "accelerometer")]
    accelerometer_scale: Option<String>,
    /// Columns that are angular rate
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    gyro: Vec<String>,
    /// Scale of the gyro columns: rad/s, deg/s, mdeg/s or deg/h, optionally with a factor
    /// (0.05deg/s) [default: the unit that the file states, else rad/s]
    #[arg(long, value_name = "SCALE", requires = "gyro")]
    gyro_scale: Option<String>,
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
    /// Filter that the recording stands behind, for TARGET: none, or low-pass:HZ for one pole with
    /// this cut-off
    #[arg(long, value_name = "FILTER", default_value = "none", requires = "to", allow_hyphen_values = true)]
    filter: String,
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
                          --gyro gx,gy,gz --gyro-scale 0.05deg/s --out noise
  proofmass allan still.bag --to ros-covariance --filter low-pass:80";

/// Runs it.
///
/// # Errors
/// The recording cannot be read, a scale is invalid, a column is named twice, or the folder cannot
/// be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let request = Request { control: progress::terminal(), ..arguments.request() };
    let asked = Asked::new(request, &arguments.scales())?;
    let target = arguments.to.as_deref().map(export::target).transpose()?;
    let filter = Filter::parse(&arguments.filter)?;
    recording::formats::located(&arguments.recording)?;
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, arguments.outputs())).transpose()?;
    let noise = asked.analyse(&arguments.recording)?;
    let file = arguments.recording.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let configuration = target.map(|target| configuration(target, filter, &file, &noise)).transpose()?;
    if let (Some((_, text)), None) = (&configuration, &folder) {
        report::notes(&noise).iter().for_each(|note| remark!("{note}"));
        return match json {
            true => sayln!("{:#}", serde_json::json!({ "text": text })),
            false => say(format_args!("{text}")),
        };
    }
    let written = folder.map(|folder| arguments.write(folder, &file, &noise, configuration)).transpose();
    if json {
        sayln!("{}", to_json(&report::document(&file, &noise))?)?;
    } else {
        let tables: String = report::tables(&noise).iter().map(|table| format!("\n{table}")).collect();
        screen(format_args!("{}\n{tables}\n", report::answer(&noise)))?;
        report::notes(&noise).iter().try_for_each(|note| sayln!("{note}"))?;
    }
    let Some((folder, files)) = arguments.out.as_ref().zip(written?) else { return Ok(()) };
    remark!("wrote {} in {}", files.join(", "), folder.display());
    if files.iter().any(|name| name == STUDY) {
        remark!("simulate it next to its log: proofmass study {}", folder.join(STUDY).display());
    }
    Ok(())
}

/// Which columns are a sensor's, and what one unit of them is.
#[derive(Debug, Clone, Default)]
pub struct Scales {
    /// Columns that are specific force.
    pub accelerometer: Vec<String>,
    /// Unit of the accelerometer's columns; absent: the file's own.
    pub accelerometer_scale: Option<String>,
    /// Columns that are angular rate.
    pub gyro: Vec<String>,
    /// Unit of the gyro's columns; absent: the file's own.
    pub gyro_scale: Option<String>,
}

/// The analysis asked of a recording, checked.
pub struct Asked {
    request: Request,
    sensors: [Columns; 2],
}

/// Columns that are given to one kind of sensor.
struct Columns {
    quantity: Quantity,
    /// The option that states their scale.
    option: &'static str,
    names: Vec<String>,
    scale: Option<Unit>,
}

impl Asked {
    /// The columns of `request` and those of `scales`; none: all of them.
    ///
    /// # Errors
    /// A scale is invalid, or a column is named twice.
    pub fn new(request: Request, scales: &Scales) -> Result<Self> {
        let sensor = |quantity, option, names: &[String], scale: &Option<String>| -> Result<Columns> {
            let scale = scale.as_deref().map(|text| Unit::parse(text, quantity)).transpose()?;
            Ok(Columns { quantity, option, names: names.to_vec(), scale })
        };
        let sensors = [
            sensor(Quantity::Gyro, "--gyro-scale", &scales.gyro, &scales.gyro_scale)?,
            sensor(
                Quantity::Accelerometer,
                "--accelerometer-scale",
                &scales.accelerometer,
                &scales.accelerometer_scale,
            )?,
        ];
        let columns = [&request.columns[..], &scales.accelerometer, &scales.gyro].concat();
        if let Some(twice) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)).map(|(_, c)| c) {
            return Err(Error::new(
                "could not choose the columns",
                format!("`{twice}` is named twice"),
                "name a column once, under --columns, --accelerometer or --gyro",
            ));
        }
        Ok(Self { request: Request { columns, ..request }, sensors })
    }

    /// Analyses the noise of these columns, in the units that the file or the user gives them.
    ///
    /// # Errors
    /// As `noise::analyse`; a scale that contradicts the unit that the file states.
    pub fn analyse(&self, recording: &Path) -> Result<Noise> {
        let (names, stated) = stream::headings(recording, &self.request)?;
        let everything = self.request.columns.is_empty();
        let around = if everything { roles::surroundings(&names, &stated) } else { Vec::new() };
        let (names, stated): (Vec<String>, Vec<Option<String>>) =
            names.into_iter().zip(stated).filter(|(name, _)| !around.contains(name)).unzip();
        // Named only where some are left out: two columns of one name cannot be.
        let columns = if around.is_empty() { self.request.columns.clone() } else { names.clone() };
        let request = Request { columns, ..self.request.clone() };
        let found = roles::of(&names);
        let by_role = [found.gyro, found.accelerometer].map(|places| places.filter(|_| everything));
        let mut units = vec![Unit::unknown(); names.len()];
        let mut unstated = [Vec::new(), Vec::new()];
        for (place, name) in names.iter().enumerate() {
            let sensor = self.sensors.iter().position(|s| s.names.contains(name));
            let role = by_role.iter().position(|places| places.is_some_and(|p| p.contains(&place)));
            let text = stated[place].as_deref();
            let known = match (sensor, roles::stated(name, text)) {
                (Some(sensor), _) => {
                    let Columns { quantity, option, scale, .. } = &self.sensors[sensor];
                    let named = Named { name, stated: text, quantity: *quantity, option };
                    let unit = named.unit(scale.as_ref())?;
                    if unit.is_none() {
                        unstated[sensor].push(place);
                    }
                    unit
                }
                (None, Some(Stated::Inertial(unit))) if role.is_some() || text.is_some() || !everything => Some(unit),
                (None, Some(_)) => roles::alone(name),
                (None, None) => {
                    unstated.iter_mut().enumerate().filter(|(s, _)| role == Some(*s)).for_each(|(_, p)| p.push(place));
                    None
                }
            };
            units[place] = known.unwrap_or_else(Unit::unknown);
        }
        let mut noise = noise::analyse(recording, &request, |name| {
            names.iter().position(|n| n == name).map_or_else(Unit::unknown, |place| units[place].clone())
        })?;
        for (sensor, places) in self.sensors.iter().zip(&unstated).filter(|(_, places)| !places.is_empty()) {
            assume(&mut noise, sensor, places);
        }
        noise.source.findings.extend((!around.is_empty()).then_some(Finding::Environment { columns: around }));
        Ok(noise)
    }
}

/// Gives columns of no stated unit the usual one, or that in which their size is a sensor's at rest.
fn assume(noise: &mut Noise, sensor: &Columns, places: &[usize]) {
    let channels: Vec<&Channel> = places.iter().map(|place| &noise.channels[*place]).collect();
    let length = match channels[..] {
        [x, y, z] => Some(scale::length([x, y, z].map(|c| c.mean))),
        _ => None,
    };
    let walks = channels.iter().filter_map(|c| c.fit.as_ref().map(|fit| fit.coefficients[Term::White as usize].value));
    let measured = Measured { length, walk: walks.reduce(f64::min) };
    let names = channels.iter().map(|c| c.name.clone()).collect();
    let (unit, finding) = scale::assumed(names, sensor.quantity, sensor.option, &measured);
    places.iter().for_each(|place| noise.channels[*place].unit = unit.clone());
    noise.source.findings.push(finding);
}

const REPORT: &str = "report.html";
const STUDY: &str = "study.toml";

impl Arguments {
    fn request(&self) -> Request {
        Request {
            topic: self.topic.clone(),
            columns: self.columns.clone(),
            rate_hz: self.rate_hz,
            force_rate: self.force_rate,
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
fn configuration(target: &Target, filter: Filter, file: &str, noise: &Noise) -> Result<(String, String)> {
    let axes: Vec<Imu> = report::fragments(file, noise)
        .iter()
        .map(|fragment| Imu::parse(file, &fragment.toml))
        .collect::<Result<_>>()
        .map_err(|error| {
            let hint =
                "name the columns and their scales with --accelerometer and --gyro; see `proofmass allan --help`";
            Error::new(format!("could not export the noise of {file}"), error.cause, hint)
        })?;
    let mut instead = Vec::new();
    let mut imu = match &axes[..] {
        [x, y, z] => {
            let mut all = [x, y, z].map(|axis| [axis.accelerometer, axis.gyro]);
            instead = without_white(&mut all);
            x.clone().with_axes(all)
        }
        [x, ..] => x.clone(),
        [] => {
            return Err(Error::new(format!("could not export the noise of {file}"), "it has no channel", "give a log"));
        }
    };
    let is_bad = |channel: &&Channel| channel.fit.as_ref().is_some_and(|fit| !fit.good());
    imu.doubts = noise.channels.iter().filter(is_bad).map(|channel| doubt(channel, file)).chain(instead).collect();
    let imu = imu.ahead_of(filter).sent(target, None, filter)?;
    Ok((target.file.to_owned(), target.export(&imu)))
}

/// Gives an axis whose white noise was not found that of the others, and says so: no sensor is without.
fn without_white(axes: &mut [[Errors; 2]; 3]) -> Vec<String> {
    let mut said = Vec::new();
    for (sense, sensor) in ["accelerometer", "gyro"].into_iter().enumerate() {
        let found: Vec<f64> = axes.iter().map(|axis| axis[sense].white.mean).filter(|white| *white > 0.0).collect();
        if found.is_empty() {
            continue;
        }
        let others = rms(found);
        for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]).filter(|(axis, _)| axis[sense].white.mean == 0.0) {
            axis[sense].white.mean = others;
            said.push(format!(
                "IN DOUBT: no white noise of the {sensor}'s {name} was found: that of its other axes stands for it"
            ));
        }
    }
    said
}

/// Says that the coefficients of a channel are not of noise alone.
fn doubt(channel: &Channel, file: &str) -> String {
    format!(
        "IN DOUBT: no sum of the noise laws fits {}, and its N, B and K hold whatever else it shows: proofmass diagnose {} \
         says what that is",
        escape::line(&channel.name),
        escape::line(file)
    )
}
