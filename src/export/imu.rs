//! The part of a sensor that configurations speak of, in SI units: noise by its law, bias, and what
//! else was given.

use super::filter::Filter;
use proofmass_base::document::parse_toml;
use proofmass_base::error::{Error, Result};
use proofmass_base::units::key::Key;
use proofmass_scenario::sensor::error_law::ErrorLaw;
use proofmass_scenario::sensor::{Sense, SensorTerm, coupling};
use proofmass_study as study;
use proofmass_study::tolerances::{Tolerances, keys};

/// Mean and standard deviation over members.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Value {
    /// Mean over members.
    pub mean: f64,
    /// Standard deviation; zero for a fixed number.
    pub sd: f64,
}

/// The errors of an accelerometer (unit m/s²) or a gyro (unit rad/s), alike on all axes or of one
/// of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Name of the unit, for messages.
    pub unit: &'static str,
    /// White noise N, unit·√s.
    pub white: Value,
    /// Bias instability B, unit.
    pub flicker: Value,
    /// Random walk K, unit/√s.
    pub walk: Value,
    /// Constant bias, unit.
    pub bias: Value,
    /// Step of the reading, unit.
    pub step: f64,
    /// Full scale, unit; infinity for none.
    pub range: f64,
}

/// A term given that is not among [`Errors`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Other {
    /// Key of study.toml that gives it.
    pub key: &'static Key,
    /// The term, unless it belongs to the proof mass.
    pub term: Option<SensorTerm>,
    /// Number of each axis, in the key's unit.
    pub values: [Value; 3],
}

/// An inertial measurement unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Imu {
    /// Name of the file that it came from.
    pub source: String,
    /// Sampling rate, Hz; of its messages where it is [`sent`](Imu::sent).
    pub rate_hz: f64,
    /// Holds where the rate was given, and is not the usual one.
    pub rate_is_stated: bool,
    /// Filter that its messages stand behind.
    pub filter: Filter,
    /// Errors of the accelerometer, m/s².
    pub accelerometer: Errors,
    /// Errors of the gyro, rad/s.
    pub gyro: Errors,
    /// Other terms given, without those that are zero.
    pub others: Vec<Other>,
    /// Accelerometer and gyro of x, y and z where they differ; `accelerometer` and `gyro` are then
    /// their root mean squares.
    pub axes: Option<[[Errors; 2]; 3]>,
    /// Holds what a configuration states and has no place here, for people.
    pub unread: Vec<String>,
    /// Says which of its numbers are in doubt, and why, for people.
    pub doubts: Vec<String>,
}

impl Errors {
    /// A sensor without errors or limits.
    pub fn ideal(sense: Sense) -> Self {
        let unit = if sense == Sense::Accelerometer { "m/s²" } else { "rad/s" };
        Self { unit, range: f64::INFINITY, ..Self::default() }
    }
}

impl Imu {
    /// An IMU without errors.
    pub fn new(source: &str, rate_hz: f64) -> Self {
        let [accelerometer, gyro] = [Sense::Accelerometer, Sense::Gyro].map(Errors::ideal);
        Self {
            source: source.into(),
            rate_hz,
            rate_is_stated: true,
            filter: Filter::Mean,
            accelerometer,
            gyro,
            others: Vec::new(),
            axes: None,
            unread: Vec::new(),
            doubts: Vec::new(),
        }
    }

    /// The errors of an axis: accelerometer and gyro.
    pub fn axis(&self, axis: usize) -> [Errors; 2] {
        self.axes.and_then(|axes| axes.get(axis).copied()).unwrap_or([self.accelerometer, self.gyro])
    }

    /// The same unit with these axes: noise and steps by their root mean square, biases by their
    /// mean and what they differ by, the smallest range.
    pub fn with_axes(mut self, axes: [[Errors; 2]; 3]) -> Self {
        [self.accelerometer, self.gyro] = [0, 1].map(|sense| together(axes.map(|axis| axis[sense])));
        self.axes = (axes[0] != axes[1] || axes[0] != axes[2]).then_some(axes);
        self
    }

    /// The sensor of a study.toml, a sensor.toml or a repaired.toml; recordings that it names are
    /// not read.
    ///
    /// # Errors
    /// Text that is no such file, numbers that make no sense, or a file without noise.
    pub fn parse(source: &str, text: &str) -> Result<Self> {
        let (numbers, rate_hz) = study::sensor(source, text)?;
        let axes = numbers.each_ref().map(|axis| [Sense::Accelerometer, Sense::Gyro].map(|sense| errors(axis, sense)));
        let [accelerometer, gyro] = axes[0];
        let alike = Self { accelerometer, gyro, ..Self::new(source, rate_hz) };
        let mut imu = if axes == [axes[0]; 3] { alike } else { alike.with_axes(axes) };
        imu.others = others(&numbers);
        let document: serde_json::Value = parse_toml(source, text)?;
        imu.rate_is_stated = !document["sensor"]["sample_rate_hz"].is_null() || !document["step_s"].is_null();
        if [imu.accelerometer, imu.gyro].iter().all(|e| [e.white, e.flicker, e.walk, e.bias] == [Value::default(); 4]) {
            return Err(Error::new(
                format!("could not export {source}"),
                "it gives neither noise nor bias of an accelerometer or a gyro",
                "add e.g. [accelerometer] noise_density_ug_rthz = 60.0; `proofmass allan` estimates it from a log",
            ));
        }
        Ok(imu)
    }

    /// The sensor as a sensor.toml, nine digits each.
    pub fn sensor_toml(&self, target: &str) -> String {
        let unread = self.unread.iter().map(|what| format!("# not read: {}\n", proofmass_base::escape::line(what)));
        let unread: String = unread.collect();
        let mut toml = format!(
            "# Imported from {} ({target}) by proofmass {}. White levels are two-sided random walks (N = n/√2).\n\
             {unread}\n[sensor]\nsample_rate_hz = {:?}\n",
            proofmass_base::escape::line(&self.source),
            env!("CARGO_PKG_VERSION"),
            self.rate_hz
        );
        for (number, sense) in [Sense::Accelerometer, Sense::Gyro].into_iter().enumerate() {
            let axes = [0, 1, 2].map(|axis| self.axis(axis)[number]);
            let terms = SensorTerm::ALL.into_iter().filter(|term| term.sense() == sense);
            let mut lines: String = terms.filter_map(|term| line(term, &axes)).collect();
            if sense == Sense::Gyro && axes.iter().any(|errors| errors.range.is_finite()) {
                let key = &coupling::GYRO_RANGE;
                let limits = axes.map(|errors| digits(errors.range / key.factor));
                lines += &match limits.iter().all(|limit| *limit == limits[0]) {
                    true => format!("{} = {:?}\n", key.key(), limits[0]),
                    false => format!("{} = {limits:?}\n", key.key()),
                };
            }
            if !lines.is_empty() {
                toml += &format!("\n[{}]\n{lines}", sense.name());
            }
        }
        if self.accelerometer.range.is_finite() {
            let key = SensorTerm::Range.row().keys[0];
            let range = digits(self.accelerometer.range / key.factor);
            toml = toml.replacen("\n[sensor]\n", &format!("\n[sensor]\n{} = {range:?}\n", key.key()), 1);
        }
        toml
    }
}

/// One accelerometer or gyro for three axes.
fn together(axes: [Errors; 3]) -> Errors {
    let rms = |of: fn(&Errors) -> f64| (axes.iter().map(|a| of(a).powi(2)).sum::<f64>() / 3.0).sqrt();
    let value = |of: fn(&Errors) -> Value| {
        let rms = |part: fn(&Value) -> f64| (axes.iter().map(|a| part(&of(a)).powi(2)).sum::<f64>() / 3.0).sqrt();
        Value { mean: rms(|v| v.mean), sd: rms(|v| v.sd) }
    };
    let bias = axes.iter().map(|a| a.bias.mean).sum::<f64>() / 3.0;
    // An axis drawn from the three: what they differ by is spread.
    let apart = axes.iter().map(|a| (a.bias.mean - bias).powi(2)).sum::<f64>() / 3.0;
    Errors {
        unit: axes[0].unit,
        white: value(|a| a.white),
        flicker: value(|a| a.flicker),
        walk: value(|a| a.walk),
        bias: Value { mean: bias, sd: rms(|a| a.bias.sd).hypot(apart.sqrt()) },
        step: rms(|a| a.step),
        range: axes.iter().fold(f64::INFINITY, |least, a| least.min(a.range)),
    }
}

/// Nine significant digits: what configurations are written with.
fn digits(value: f64) -> f64 {
    proofmass_base::number::rounded(value, 9)
}

/// The line of a term, with a list where the axes differ.
fn line(term: SensorTerm, axes: &[Errors; 3]) -> Option<String> {
    let key = term.row().keys.iter().find(|key| !key.one_sided)?;
    let of = |errors: &Errors| {
        let value = match term.law() {
            ErrorLaw::White(_) => errors.white,
            ErrorLaw::Flicker(_) => errors.flicker,
            ErrorLaw::Walk(_) => errors.walk,
            ErrorLaw::Constant => errors.bias,
            ErrorLaw::Rounding => Value { mean: errors.step, sd: 0.0 },
            _ => return None,
        };
        Some(match [value.mean, value.sd].map(|v| digits(v / key.factor)) {
            [mean, 0.0] => format!("{mean:?}"),
            [mean, sd] => format!("{{ mean = {mean:?}, sd = {sd:?} }}"),
        })
    };
    let [x, y, z] = axes.each_ref().map(of);
    let (x, y, z) = (x?, y?, z?);
    match x == y && x == z {
        true if x == "0.0" => None,
        true => Some(format!("{} = {x}\n", key.key())),
        false => Some(format!("{} = [{x}, {y}, {z}]\n", key.key())),
    }
}

fn value(numbers: &Tolerances, term: SensorTerm) -> Option<Value> {
    let (mean, variance) = numbers.moments(numbers.given(term)?);
    Some(Value { mean, sd: variance.sqrt() })
}

fn errors(numbers: &Tolerances, sense: Sense) -> Errors {
    let mut errors = Errors::ideal(sense);
    if sense == Sense::Gyro && numbers[&coupling::GYRO_RANGE].is_some() {
        errors.range = numbers.moments(&coupling::GYRO_RANGE).0;
    }
    for term in SensorTerm::ALL.into_iter().filter(|term| term.sense() == sense) {
        let Some(value) = value(numbers, term) else { continue };
        match term.law() {
            ErrorLaw::White(_) => errors.white = value,
            ErrorLaw::Flicker(_) => errors.flicker = value,
            ErrorLaw::Walk(_) => errors.walk = value,
            ErrorLaw::Constant => errors.bias = value,
            ErrorLaw::Rounding => errors.step = value.mean,
            ErrorLaw::FullScale => errors.range = value.mean,
            ErrorLaw::Proportional(_)
            | ErrorLaw::Ramp
            | ErrorLaw::Offset
            | ErrorLaw::Force(_)
            | ErrorLaw::Warm(_)
            | ErrorLaw::WarmPower(_)
            | ErrorLaw::Markov(_)
            | ErrorLaw::Settling
            | ErrorLaw::Sine
            | ErrorLaw::LowPass
            | ErrorLaw::Delay
            | ErrorLaw::Shape(_) => {}
        }
    }
    errors
}

/// Lists the terms that were given besides noise by its law, on any axis.
fn others(axes: &[Tolerances; 3]) -> Vec<Other> {
    let noise = |law| matches!(law, ErrorLaw::White(_) | ErrorLaw::Flicker(_) | ErrorLaw::Walk(_));
    let of_a_sensor = |key: &&Key| ["sensor", "accelerometer", "gyro"].contains(&key.section());
    let is_given = |key: &&Key| axes.iter().any(|numbers| numbers[*key].is_some_and(|n| !n.is_zero()));
    let other = |key: &'static Key| {
        let term = SensorTerm::ALL.into_iter().find(|term| term.row().keys.iter().any(|k| k.slot == key.slot));
        let values = axes.each_ref().map(|numbers| {
            let (mean, variance) = numbers.moments(key);
            Value { mean: mean / key.factor, sd: variance.sqrt() / key.factor.abs() }
        });
        (!term.is_some_and(|t| noise(t.law()))).then_some(Other { key, term, values })
    };
    keys().filter(of_a_sensor).filter(is_given).filter_map(other).collect()
}
