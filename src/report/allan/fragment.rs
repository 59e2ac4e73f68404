//! A sensor for a study from the coefficients of a log: one fragment per accelerometer-and-gyro
//! pair.

use proofmass_base::escape::line;
use proofmass_base::number::rounded;
use proofmass_numerics::numerics::allan::law::{FLICKER_FLOOR, Term};
use proofmass_recording::noise::{Channel, Noise};
use proofmass_recording::unit::Quantity;
use proofmass_scenario::sensor::Sense;
use proofmass_scenario::sensor::estimated::estimated;

/// A piece of study.toml.
#[derive(Debug, Clone, PartialEq)]
pub struct Fragment {
    /// File name that it is offered under.
    pub name: String,
    /// Its sections, as TOML.
    pub toml: String,
}

/// The n-th accelerometer is paired with the n-th gyro: `sensor.toml` for the first pair,
/// `sensor-2.toml` for the next. Where no scale was given the one fragment holds the coefficients
/// in the file's units, as comments.
pub fn fragments(file: &str, noise: &Noise) -> Vec<Fragment> {
    let of = |quantity| noise.channels.iter().filter(move |c| c.unit.quantity == quantity && c.fit.is_some());
    let file = line(file);
    let (mut accelerometers, mut gyros) = (of(Quantity::Accelerometer), of(Quantity::Gyro));
    let mut out = Vec::new();
    loop {
        let (accelerometer, gyro) = (accelerometers.next(), gyros.next());
        if accelerometer.is_none() && gyro.is_none() && !out.is_empty() {
            return out;
        }
        let number = out.len() + 1;
        let name = if number == 1 { "sensor.toml".to_owned() } else { format!("sensor-{number}.toml") };
        let mut toml = format!(
            "# Estimated from {file} (SHA-256 {}),\n# {} samples, by proofmass {}.\n# Paste it into a study.toml. \
            White levels \
             are two-sided random walks (N = n/√2).\n# Bias is not included: at rest it cannot be separated from \
             gravity and the Earth's rate.\n\n[sensor]\nsample_rate_hz = {:?}\n",
            noise.source.sha256,
            noise.source.samples,
            env!("CARGO_PKG_VERSION"),
            noise.source.rate_hz
        );
        if let Some(channel) = accelerometer {
            toml += &section(Sense::Accelerometer, channel);
        }
        if let Some(channel) = gyro {
            toml += &section(Sense::Gyro, channel);
        }
        if accelerometer.is_none() && gyro.is_none() {
            toml += "\n# No scale was given, so the values below are not in SI units: name the columns with \
            --accelerometer and --gyro.\n";
            noise.channels.iter().for_each(|c| toml += &commented(c));
            return vec![Fragment { name, toml }];
        }
        out.push(Fragment { name, toml });
    }
}

/// Says which convention a bias instability B follows, next to the other that datasheets print.
fn minimum(value: f64) -> String {
    format!("; B of IEEE 952: the minimum of the Allan deviation is 0.664 B = {:?}", rounded(FLICKER_FLOOR * value, 3))
}

fn section(sense: Sense, channel: &Channel) -> String {
    let name = sense.name();
    let mut out = format!("\n[{name}]  # column {}, {} per unit\n", line(&channel.name), line(&channel.unit.name));
    let Some(fit) = &channel.fit else { return out };
    if !fit.good() {
        out += "# The five terms do not describe this channel's Allan curve: see the report.\n";
    }
    for (term, key) in estimated(sense) {
        let coefficient = fit.coefficients[term as usize];
        let (key, scale) = (key.key(), channel.unit.si / key.factor);
        let [low, high] = coefficient.ci95.map(|e| to_five_digits(e * scale));
        out += &if coefficient.supported() {
            let value = coefficient.value * scale;
            let convention = if term == Term::Flicker { minimum(value) } else { String::new() };
            format!("{key} = {:?}  # 95 %: {low:?} to {high:?}{convention}\n", to_five_digits(value))
        } else {
            format!("{key} = 0.0  # not supported by the data; below {high:?} (95 %)\n")
        };
    }
    for (term, what) in [(Term::Ramp, "ramp R"), (Term::Quantisation, "quantisation Q")] {
        let coefficient = fit.coefficients[term as usize];
        if coefficient.supported() {
            let (unit, scale) = channel.unit.coefficient(term);
            out += &format!(
                "# also found, not simulated: {what} = {:?} {unit}\n",
                to_five_digits(coefficient.value * scale)
            );
        }
    }
    if let Some(step) = channel.step {
        let (unit, scale) = channel.unit.signal();
        out += &format!(
            "# quantisation (step {:?} {unit}) is already part of the white noise\n",
            to_five_digits(step * scale)
        );
    }
    out
}

fn commented(channel: &Channel) -> String {
    let Some(fit) = &channel.fit else { return String::new() };
    let mut out = format!("# {}:", line(&channel.name));
    for term in [Term::White, Term::Flicker, Term::Walk] {
        let unit = channel.unit.coefficient(term).0;
        let coefficient = fit.coefficients[term as usize];
        let value = if coefficient.supported() { to_five_digits(coefficient.value) } else { 0.0 };
        out += &format!(" {} = {value:?} {unit}", term.symbol());
    }
    out + "\n"
}

/// Five significant digits: more than any log supports.
pub(super) fn to_five_digits(value: f64) -> f64 {
    rounded(value, 5)
}
