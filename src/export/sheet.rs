//! A configuration being written: numbers in the tool's syntax, and next to each its unit,
//! convention and source.

use super::drift::Process;
use super::imu::{Errors, Imu, Other, Value};
use proofmass_base::number::short;
use proofmass_scenario::sensor::{SensorTerm, coupling};

/// Syntax in which a tool writes numbers and comments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Syntax {
    /// `key: value`, `# comment`.
    Yaml,
    /// `<key>value</key>`, `<!-- comment -->`.
    Xml,
    /// `"key": value,`; JSON has no comments, so they stand as values of keys that the tool does
    /// not read.
    Json,
    /// `key = value`, `# comment`.
    Python,
    /// `key = value;`, `% comment`.
    Matlab,
    /// `key value`, `# comment`.
    Parm,
    /// QGroundControl's columns: vehicle, component, key, value, type (9: float); `# comment`.
    Params,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Field<'a> {
    pub key: &'a str,
    /// Value in the tool's unit.
    pub value: f64,
    pub unit: &'a str,
    /// Convention: N or density, per sample or continuous, σ or variance.
    pub means: &'a str,
}

/// Continuous-time white noise as N.
pub(super) const WHITE: &str = "continuous noise density as sigma: the two-sided random-walk coefficient N \
                         (one-sided datasheet density / sqrt 2), not per sample";
/// Continuous-time random walk as K.
pub(super) const WALK: &str = "continuous random walk K of the bias as sigma (IEEE 952), not per sample";

/// A number in nine digits, in a form that every target reads: YAML wants a point and a signed
/// exponent.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0.0".into();
    }
    let text = format!("{value:.8e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) if !exponent.starts_with('-') => format!("{mantissa}e+{exponent:0>2}"),
        Some((mantissa, exponent)) => format!("{mantissa}e-{:0>2}", exponent.trim_start_matches('-')),
        None => text,
    }
}

/// Lists what differs between the axes of a sensor, and what replaces it where a tool takes one
/// number for all of them.
fn by_axis(imu: &Imu) -> Vec<String> {
    type Of = fn(&Errors) -> f64;
    let quantities: [(&str, &str, &str, Of); 6] = [
        ("N", "*sqrt(s)", "root mean square", |e| e.white.mean),
        ("B", "", "root mean square", |e| e.flicker.mean),
        ("K", "/sqrt(s)", "root mean square", |e| e.walk.mean),
        ("bias", "", "mean, and their spread in its sigma,", |e| e.bias.mean),
        ("step", "", "root mean square", |e| e.step),
        ("range", "", "smallest", |e| e.range),
    ];
    let mut said = Vec::new();
    for (sense, name) in ["accelerometer", "gyro"].into_iter().enumerate() {
        let axes = [0, 1, 2].map(|axis| imu.axis(axis)[sense]);
        for (what, per, instead, of) in quantities {
            let values = axes.each_ref().map(of);
            if values[0] != values[1] || values[0] != values[2] {
                let [x, y, z] = values.map(short);
                let unit = axes[0].unit;
                said.push(format!(
                    "{name}: x, y, z differ, {what} = {x}, {y}, {z} {unit}{per}; where the tool takes one number for \
                    all axes, it is the {instead} of them"
                ));
            }
        }
    }
    said
}

/// Says what the sensor does not state and is written all the same.
fn missing(imu: &Imu) -> Vec<String> {
    let mut said = Vec::new();
    if !imu.rate_is_stated {
        said.push(format!("the sensor given states no rate: {} readings per second are assumed", imu.rate_hz));
    }
    for (name, errors) in [("accelerometer", &imu.accelerometer), ("gyro", &imu.gyro)] {
        let none = |values: &[Value]| values.iter().all(|value| *value == Value::default());
        for (what, is_missing) in [
            ("white noise", none(&[errors.white])),
            ("bias instability or random walk", none(&[errors.flicker, errors.walk])),
        ] {
            if is_missing {
                said.push(format!(
                    "no {what} of the {name} is given: zero stands for it, which estimators such as Kalibr refuse"
                ));
            }
        }
    }
    said
}

#[derive(Debug)]
pub(super) struct Sheet {
    syntax: Syntax,
    documented: &'static str,
    indent: usize,
    notes: usize,
    head: Vec<String>,
    text: String,
}

impl Sheet {
    /// An empty one for a tool, which represents the terms `keeps` next to noise.
    pub(super) fn new(syntax: Syntax, about: &str, keeps: &[SensorTerm], imu: &Imu) -> Self {
        let source = std::path::Path::new(&imu.source).file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut head = vec![format!(
            "{}: from {} by proofmass {}, for {} readings per second",
            about,
            proofmass_base::escape::line(&source),
            env!("CARGO_PKG_VERSION"),
            imu.rate_hz
        )];
        head.extend(imu.doubts.iter().cloned());
        head.extend(missing(imu));
        for (name, errors) in [("accelerometer", &imu.accelerometer), ("gyro", &imu.gyro)] {
            let drawn =
                [("white noise", errors.white), ("bias instability", errors.flicker), ("random walk", errors.walk)];
            for (what, value) in drawn.into_iter().filter(|(_, value)| value.sd > 0.0) {
                let percent = 100.0 * value.sd / value.mean;
                head.push(format!("{name} {what} differs between sensors (sd {percent:.0} %); this is the mean"));
            }
        }
        if imu.axes.is_none() {
            head.push("x, y and z are alike: the sensor given has one number for all of them".to_owned());
        }
        head.extend(by_axis(imu));
        // A tool that ends the range of an accelerometer ends a gyro's.
        let ranges = keeps.contains(&SensorTerm::Range);
        let kept = |o: &&Other| o.term.is_some_and(|t| keeps.contains(&t)) || ranges && *o.key == coupling::GYRO_RANGE;
        for other in imu.others.iter().filter(|o| !kept(o)) {
            let [x, y, z] = other.values;
            let said = |value: Value| match value.sd {
                0.0 => short(value.mean),
                sd => format!("{} (sd {})", short(value.mean), short(sd)),
            };
            head.push(format!(
                "not represented, and not replaced: {} = {} {} ({})",
                other.key.path,
                if x == y && x == z { said(x) } else { format!("[{}]", other.values.map(said).join(", ")) },
                other.key.unit,
                other.key.name
            ));
        }
        Self { syntax, documented: "", indent: 0, notes: 0, head, text: String::new() }
    }

    /// Writes what is to be said of the whole, and where the tool documents its numbers.
    pub(super) fn head(&mut self, documented: &'static str) {
        self.documented = documented;
        for note in std::mem::take(&mut self.head) {
            self.note(&note);
        }
    }

    /// Indents what follows by this many spaces.
    pub(super) fn indent(&mut self, spaces: usize) {
        self.indent = spaces;
    }

    pub(super) fn note(&mut self, note: &str) {
        self.notes += 1;
        let line = match self.syntax {
            Syntax::Yaml | Syntax::Python | Syntax::Parm | Syntax::Params => format!("# {note}"),
            Syntax::Matlab => format!("% {note}"),
            // Two hyphens would end the comment.
            Syntax::Xml => format!("<!-- {} -->", note.replace("--", "- -")),
            Syntax::Json => format!("\"// {}\": {},", self.notes, serde_json::Value::from(note)),
        };
        self.line(&line);
    }

    /// A line as it is.
    pub(super) fn line(&mut self, line: &str) {
        self.text += &format!("{:1$}{line}\n", "", self.indent);
    }

    /// A number, with its unit, its convention and its source in a comment above.
    pub(super) fn field(&mut self, field: Field<'_>) {
        let value = number(field.value);
        self.written(field, &value);
    }

    /// The same of three axes: one number where they are alike, else a row of three as MATLAB
    /// writes it.
    pub(super) fn axes(&mut self, field: Field<'_>, axes: [f64; 3]) {
        let values = axes.map(number);
        let alike = values[0] == values[1] && values[0] == values[2];
        let value = if alike { number(field.value) } else { format!("[{}]", values.join(" ")) };
        self.written(field, &value);
    }

    /// Writes a row of numbers as YAML and Python have it, with the same comment.
    pub(super) fn row(&mut self, field: Field<'_>, row: &[f64]) {
        let row: Vec<String> = row.iter().map(|value| number(*value)).collect();
        self.written(field, &format!("[{}]", row.join(", ")));
    }

    /// Writes the comment above a number.
    pub(super) fn explain(&mut self, key: &str, unit: &str, means: &str) {
        self.note(&format!("{key}: {unit}; {means}; documented in {}", self.documented));
    }

    fn written(&mut self, field: Field<'_>, value: &str) {
        let Field { key, unit, means, .. } = field;
        self.explain(key, unit, means);
        let line = match self.syntax {
            Syntax::Yaml => format!("{key}: {value}"),
            Syntax::Xml => format!("<{key}>{value}</{key}>"),
            Syntax::Json => format!("\"{key}\": {value},"),
            Syntax::Python => format!("{key} = {value}"),
            Syntax::Matlab => format!("{key} = {value};"),
            Syntax::Parm => format!("{key} {value}"),
            Syntax::Params => format!("1\t1\t{key}\t{value}\t9"),
        };
        self.line(&line);
    }

    /// Adds the remarks on the processes that stand for the accelerometer's and the gyro's moving
    /// bias.
    pub(super) fn remarks(&mut self, accelerometer: &Process, gyro: &Process) {
        for (name, process) in [("accelerometer", accelerometer), ("gyro", gyro)] {
            if !process.remark.is_empty() {
                self.note(&format!("{name}: {}", process.remark));
            }
        }
    }

    pub(super) fn finish(self) -> String {
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_a_point_and_a_signed_exponent() {
        assert_eq!([number(1.5e-3), number(250.0), number(0.0)], ["1.50000000e-03", "2.50000000e+02", "0.0"]);
    }
}
