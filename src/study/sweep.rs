//! `[sweep]`: keys and the values that they take one after the other,
//! `gyro.bias_deg_h = "1:20:log8"`.

use std::str::FromStr;

use toml::{Table, Value};

/// A key and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Dotted path of study.toml.
    pub key: String,
    /// First value, in the key's unit.
    pub from: f64,
    /// Last value, in the key's unit.
    pub to: f64,
    /// Number of values, both ends included.
    pub points: usize,
    /// Says whether their ratio is the same, not their difference.
    pub log: bool,
}

/// `[sweep]`, or what the command line says in its place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sweep {
    /// One for a curve, two for a map.
    pub axes: Vec<Axis>,
    /// A requirement, whose crossing is looked for.
    pub limit: Option<String>,
}

/// Most values of one axis.
const MOST: usize = 64;
/// The key of `[sweep]` that is no path.
const LIMIT: &str = "limit";

impl Axis {
    /// The values, from the first to the last.
    pub fn values(&self) -> Vec<f64> {
        let part = |n: usize| n as f64 / (self.points - 1) as f64;
        let at = |n: usize| match n {
            0 => self.from,
            n if n + 1 == self.points => self.to,
            n if self.log => self.from * (self.to / self.from).powf(part(n)),
            n => self.from + (self.to - self.from) * part(n),
        };
        (0..self.points).map(at).collect()
    }

    /// From `FROM:TO:N` or `FROM:TO:logN`.
    fn of(key: &str, text: &str) -> Result<Self, String> {
        let form = || format!("`{text}` is not FROM:TO:N or FROM:TO:logN, e.g. {key}=1:20:log8");
        let parts: Vec<&str> = text.split(':').map(str::trim).collect();
        let [from, to, count] = parts[..] else { return Err(form()) };
        let (log, count) = count.strip_prefix("log").map_or((false, count), |count| (true, count));
        let number = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(form);
        let (from, to) = (number(from)?, number(to)?);
        let points: usize = count.parse().map_err(|_| form())?;
        if !(2..=MOST).contains(&points) {
            return Err(format!("{key} takes {points} values: need 2 to {MOST}"));
        }
        if from >= to {
            return Err(format!("{key} goes from {from} to {to}: need a smaller value first"));
        }
        if log && from <= 0.0 {
            return Err(format!("{key} goes from {from} in equal ratios: need more than zero"));
        }
        Ok(Self { key: key.trim().into(), from, to, points, log })
    }
}

impl FromStr for Axis {
    type Err = String;

    /// `KEY=FROM:TO:N` or `KEY=FROM:TO:logN`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (key, values) = text.split_once('=').ok_or("need KEY=FROM:TO:N, e.g. --sweep gyro.bias_deg_h=1:20:log8")?;
        if key.split('.').any(|part| part.trim().is_empty()) {
            return Err("need a dotted path of study.toml before the `=`, e.g. gyro.bias_deg_h=1:20:log8".into());
        }
        Self::of(key, values)
    }
}

impl Sweep {
    /// From the section as it is written.
    ///
    /// # Errors
    /// What is no axis, or more than two.
    pub fn read(section: &Table) -> Result<Self, String> {
        let mut sweep = Self::default();
        let mut rest: Vec<(String, &Value)> = section.iter().map(|(key, value)| (key.clone(), value)).collect();
        while let Some((key, value)) = rest.pop() {
            match value {
                Value::String(text) if key == LIMIT => sweep.limit = Some(text.clone()),
                Value::String(text) => sweep.axes.push(Axis::of(&key, text)?),
                Value::Table(inner) => rest.extend(inner.iter().map(|(name, value)| (format!("{key}.{name}"), value))),
                other => {
                    return Err(format!("`{key}` is a {}: need \"FROM:TO:N\" or \"FROM:TO:logN\"", other.type_str()));
                }
            }
        }
        // As in the file, where they stand in the order of their names.
        sweep.axes.reverse();
        sweep.checked()
    }

    /// Itself, if it can be swept.
    ///
    /// # Errors
    /// More than two axes, or one key twice.
    pub fn checked(self) -> Result<Self, String> {
        match &self.axes[..] {
            [] => Err("it names no key: add one, e.g. gyro.bias_deg_h = \"1:20:log8\"".into()),
            [one, other] if one.key == other.key => Err(format!("`{}` is swept twice", one.key)),
            [_] | [_, _] => Ok(self),
            more => Err(format!("{} keys are swept: need one for a curve, two for a map", more.len())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_spaced_as_asked_and_end_where_they_say() {
        let log: Axis = "gyro.bias_deg_h=1:16:log5".parse().expect("an axis");
        assert_eq!((log.key.as_str(), log.values().len()), ("gyro.bias_deg_h", 5));
        for (got, want) in log.values().iter().zip([1.0, 2.0, 4.0, 8.0, 16.0]) {
            assert!((got / want - 1.0).abs() < 1e-12, "{got}");
        }
        let even: Axis = "a.b=-1:1:3".parse().expect("an axis");
        assert_eq!(even.values(), [-1.0, 0.0, 1.0]);
        for wrong in ["a.b", "a.b=1:2", "a.b=1:2:1", "a.b=2:1:3", "a.b=0:1:log3", "a..b=1:2:3", "a.b=1:2:many"] {
            assert!(wrong.parse::<Axis>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_section_holds_dotted_and_quoted_keys_and_a_limit() {
        let read = |text: &str| Sweep::read(&toml::from_str(text).expect("TOML"));
        let sweep = read("gyro.bias_deg_h = \"1:20:log8\"\n\"accelerometer.bias_mg.sd\" = \"0:2:5\"\nlimit = \"sd\"");
        let sweep = sweep.expect("a sweep");
        let keys: Vec<&str> = sweep.axes.iter().map(|a| a.key.as_str()).collect();
        assert_eq!((keys, sweep.limit.as_deref()), (vec!["accelerometer.bias_mg.sd", "gyro.bias_deg_h"], Some("sd")));
        assert!(read("").is_err() && read("a.b = 3").is_err());
        assert!(read("a = \"1:2:3\"\nb = \"1:2:3\"\nc = \"1:2:3\"").is_err_and(|e| e.contains("3 keys")));
    }
}
