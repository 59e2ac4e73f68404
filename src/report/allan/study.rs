//! A whole study from a log: the sensor as its coefficients have it, and the log laid next to its
//! simulation.
//!
//! Two commands from a recording to a simulation that is checked against it: `allan --out DIR`,
//! `study DIR/study.toml`.

use std::path::Path;

use super::fragment::to_five_digits;
use proofmass_base::document::toml_string;
use proofmass_base::escape::line;
use proofmass_base::number::rounded;
use proofmass_base::units::{DEGREE, MILLI_G};
use proofmass_numerics::numerics::allan::law::Term;
use proofmass_recording::finding::Finding;
use proofmass_recording::noise::{Channel, Noise};
use proofmass_recording::unit::Quantity;
use proofmass_scenario::sensor::Sense;
use proofmass_scenario::sensor::estimated::estimated;
use proofmass_study::{is_plausible, name_for};

/// The run is this long, s, and at least this many samples.
const LASTS_S: f64 = 60.0;
const LEAST_SAMPLES: f64 = 100.0;
/// Still start, s, and windows after it, s, where the log holds at least [`LEAST_WINDOWS`] of them.
const STILL_S: f64 = 10.0;
const WINDOWS_S: [f64; 2] = [10.0, 60.0];
/// Fewest windows that say how far a sensor drifts.
const LEAST_WINDOWS: f64 = 5.0;

/// The study of the log at `path`, named after it; `None` where no column has a scale.
pub fn study(path: &Path, noise: &Noise) -> Option<String> {
    let of = |quantity| -> Vec<&Channel> {
        noise.channels.iter().filter(|c| c.unit.quantity == quantity && c.fit.is_some()).collect()
    };
    let (accelerometers, gyros) = (of(Quantity::Accelerometer), of(Quantity::Gyro));
    if accelerometers.is_empty() && gyros.is_empty() {
        return None;
    }
    let rate_hz = noise.source.rate_hz;
    let name = name_for(&path.file_stem().unwrap_or_default().to_string_lossy());
    let path = path.canonicalize().unwrap_or_else(|_| path.into());
    let samples = (LASTS_S * rate_hz).round().max(LEAST_SAMPLES);
    let mut toml = format!(
        "# The sensor of a log at rest, and the log next to its simulation: run it with `proofmass study`.\n# Each coefficient \
         is drawn from the intervals of all axes that support it (95 %). Bias is absent: a log at rest cannot tell it\n# from \
         gravity and the Earth's rate; add bias_mg and bias_deg_h from the datasheet. bias_instability is B of IEEE 952:\n# the \
         minimum of the Allan deviation is 0.664 B.\nname = {}\nseed = 1\nmembers = 4096\n\
         duration_s = {:?}\n\n[sensor]\nsample_rate_hz = {rate_hz:?}\n",
        toml_string(&name),
        rounded(samples / rate_hz, 12)
    );
    for (sense, channels) in [(Sense::Accelerometer, &accelerometers), (Sense::Gyro, &gyros)] {
        if !channels.is_empty() {
            toml += &format!("\n[{}]\n{}", sense.name(), drawn(channels, sense));
        }
    }
    let Some(file) = path.to_str() else {
        return Some(toml + "\n# The log is not compared: its path is not UTF-8, which TOML needs.\n");
    };
    if file == "-" {
        return Some(toml + "\n# The log is not compared: it was read from standard input.\n");
    }
    let recorded_s = noise.source.samples as f64 / rate_hz;
    let lasts_s = samples / rate_hz;
    let fits = |w: &f64| *w <= lasts_s && recorded_s >= LEAST_WINDOWS * (STILL_S + w);
    let windows_s: Vec<f64> = WINDOWS_S.into_iter().filter(fits).collect();
    if !windows_s.is_empty() {
        toml += &format!("\n[alignment]\nkind = \"still\"\nstill_s = {STILL_S:?}\n");
    }
    toml += &format!("\n[compare]\nfile = {}\nrate_hz = {rate_hz:?}\n", toml_string(file));
    if !windows_s.is_empty() {
        toml += &format!("windows_s = {windows_s:?}\n");
    }
    if noise.source.findings.iter().any(|f| matches!(f, Finding::RateForced { .. })) {
        toml += "force_rate = true\n";
    }
    for (sense, scale, unit, channels) in
        [(Sense::Accelerometer, "scale_mg", MILLI_G, &accelerometers), (Sense::Gyro, "scale_deg_s", DEGREE, &gyros)]
    {
        for channel in channels {
            toml += &format!(
                "\n[[compare.axis]]\ncolumn = {}\n{scale} = {:?}\n[compare.axis.{}]\n{}",
                toml_string(&channel.name),
                channel.unit.si / unit,
                sense.name(),
                drawn(&[channel], sense)
            );
        }
    }
    Some(toml)
}

/// Each supported coefficient between the lowest and the highest end of the channels' intervals.
fn drawn(channels: &[&Channel], sense: Sense) -> String {
    let mut out = String::new();
    for (term, key) in estimated(sense) {
        let supported = channels.iter().filter_map(|c| {
            let coefficient = c.fit.as_ref()?.coefficients[term as usize];
            let scale = c.unit.si / key.factor;
            coefficient.supported().then(|| coefficient.ci95.map(|e| to_five_digits(e * scale)))
        });
        match supported.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) {
            Some([low, high]) if is_plausible(high) && (low == 0.0 || is_plausible(low)) => {
                out += &format!("{} = {{ min = {low:?}, max = {high:?} }}\n", key.key());
            }
            Some([low, high]) => {
                out += &format!("# {} would be {low:?} to {high:?}, which no sensor has: left out\n", key.key());
            }
            None => {}
        }
    }
    for (term, what) in [(Term::Ramp, "ramp R"), (Term::Quantisation, "quantisation Q")] {
        let holds = |c: &&&Channel| c.fit.as_ref().is_some_and(|f| f.coefficients[term as usize].supported());
        let names: Vec<&str> = channels.iter().filter(holds).map(|c| c.name.as_str()).collect();
        if !names.is_empty() {
            out += &format!("# also found, not simulated: {what} in {}\n", line(&names.join(", ")));
        }
    }
    out
}
