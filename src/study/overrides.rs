//! Changes a study by the command line: members, seed, the sensor's grade under it (`--preset`),
//! and any key by its dotted path (`--set KEY=VALUE`).

use toml::{Table, Value};

use super::preset::Preset;
use crate::document::number_advice;
use crate::error::{Error, Result};

/// Changes to a study, made before it is checked.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Number of members in place of the study's.
    pub members: Option<u64>,
    /// Seed in place of the study's.
    pub seed: Option<u64>,
    /// The grade whose errors the sensor has where the study says nothing.
    pub preset: Option<Preset>,
    /// Keys and their values, in the order given; a later one wins.
    pub set: Vec<Assignment>,
}

/// `gyro.bias_deg_h.sd = 2.0`: a path of study.toml and the value that it gets.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    path: Vec<String>,
    value: Value,
}

const EXAMPLE: &str = "e.g. --set gyro.bias_deg_h=4, --set gyro.bias_deg_h.sd=2 or --set 'name=\"mine\"'";

impl Assignment {
    /// A number at a path.
    pub fn number(key: &str, value: f64) -> Self {
        Self { path: key.split('.').map(str::to_owned).collect(), value: Value::Float(value) }
    }

    /// Changes the document. A number that was given without tolerance becomes the mean of a draw
    /// where the path leads into one, as `bias_deg_h.sd` does.
    ///
    /// # Errors
    /// A path that leads into something that is no section and no number.
    fn apply(&self, document: &mut Table) -> Result<()> {
        let Some((last, sections)) = self.path.split_last() else { return Ok(()) };
        let mut here = document;
        for (depth, name) in sections.iter().enumerate() {
            let entry = here.entry(name.as_str()).or_insert_with(|| Value::Table(Table::new()));
            if let (Value::Integer(_) | Value::Float(_), true) = (&entry, last == "sd" && depth + 1 == sections.len()) {
                let mean = std::mem::replace(entry, Value::Table(Table::new()));
                if let Value::Table(draw) = entry {
                    draw.insert("mean".into(), mean);
                }
            }
            let Value::Table(table) = entry else {
                return Err(Error::new(
                    format!("could not set `{self}`"),
                    format!("`{}` is a {}, not a section", sections[..=depth].join("."), entry.type_str()),
                    EXAMPLE,
                ));
            };
            here = table;
        }
        // A spread where nothing was drawn is about zero.
        if last == "sd" && here.is_empty() {
            here.insert("mean".into(), Value::Float(0.0));
        }
        here.insert(last.clone(), self.value.clone());
        Ok(())
    }
}

impl std::fmt::Display for Assignment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} = {}", self.path.join("."), self.value)
    }
}

impl std::str::FromStr for Assignment {
    type Err = String;

    /// `KEY=VALUE` with a dotted path and a TOML value.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (key, value) = text.split_once('=').ok_or_else(|| format!("need KEY=VALUE, {EXAMPLE}"))?;
        let path: Vec<String> = key.split('.').map(|part| part.trim().to_owned()).collect();
        if path.iter().any(String::is_empty) {
            return Err(format!("need a dotted path of study.toml before the `=`, {EXAMPLE}"));
        }
        let document: Table = toml::from_str(&format!("value = {}", value.trim())).map_err(|_| {
            let advice = number_advice(value).unwrap_or_else(|| format!("words and file names need quotes, {EXAMPLE}"));
            format!("`{}` is not a TOML value: {advice}", value.trim())
        })?;
        let mut values = document.into_iter();
        match (values.next(), values.next()) {
            (Some((_, value)), None) => Ok(Self { path, value }),
            _ => Err(format!("need one value after the `=`, {EXAMPLE}")),
        }
    }
}

impl Overrides {
    /// Returns whether the document stays as it is.
    pub(super) fn is_empty(&self) -> bool {
        self.preset.is_none() && self.set.is_empty()
    }

    /// Lays the grade under the document, then changes it by every assignment.
    ///
    /// # Errors
    /// A path that leads nowhere.
    pub(super) fn apply(&self, document: &mut Table) -> Result<()> {
        if let Some(preset) = self.preset {
            let is_set =
                |section: &str, key: &str| self.set.iter().any(|a| a.path.starts_with(&[section.into(), key.into()]));
            preset.lay_under(document, is_set)?;
        }
        self.set.iter().try_for_each(|assignment| assignment.apply(document))
    }

    /// The changes as they stand in messages: "with gyro.bias_deg_h = 4".
    pub(super) fn words(&self) -> String {
        let preset = self.preset.map(|preset| format!("the {} preset", preset.name()));
        let all: Vec<String> = preset.into_iter().chain(self.set.iter().map(Assignment::to_string)).collect();
        format!("with {}", all.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(text: &str, set: &[&str]) -> std::result::Result<String, String> {
        let mut document: Table = toml::from_str(text).map_err(|e| e.to_string())?;
        let set = set.iter().map(|s| s.parse()).collect::<std::result::Result<_, String>>()?;
        let overrides = Overrides { set, ..Overrides::default() };
        overrides.apply(&mut document).map_err(|e| e.to_string())?;
        toml::to_string(&document).map_err(|e| e.to_string())
    }

    #[test]
    fn a_path_reaches_a_section_a_draw_and_what_is_not_there_yet() {
        let text = "[gyro]\nbias_deg_h = { mean = 1.0, sd = 2.0 }\n";
        assert_eq!(after(text, &["gyro.bias_deg_h.sd=3"]), Ok("[gyro.bias_deg_h]\nmean = 1.0\nsd = 3\n".into()));
        assert_eq!(after(text, &["gyro.bias_deg_h=4.5"]), Ok("[gyro]\nbias_deg_h = 4.5\n".into()));
        assert_eq!(after("", &["sensor.range_g = 8"]), Ok("[sensor]\nrange_g = 8\n".into()));
        assert_eq!(after("seed = 1", &["name=\"mine\"", "seed=2"]), Ok("name = \"mine\"\nseed = 2\n".into()));
        assert_eq!(after("", &["gyro.bias_deg_h.sd=3"]), Ok("[gyro.bias_deg_h]\nmean = 0.0\nsd = 3\n".into()));
        let fixed = "[gyro]\nbias_deg_h = 4.0\n";
        assert_eq!(after(fixed, &["gyro.bias_deg_h.sd=3"]), Ok("[gyro.bias_deg_h]\nmean = 4.0\nsd = 3\n".into()));
    }

    #[test]
    fn what_is_no_assignment_is_refused_in_words() {
        for wrong in ["gyro.bias_deg_h", "=4", "gyro..bias=4", "name=mine", "seed=", "seed=1\nname=2"] {
            assert!(wrong.parse::<Assignment>().is_err(), "{wrong}");
        }
        let comma = "gyro.bias_deg_h=3,5".parse::<Assignment>().expect_err("no number");
        assert!(comma.contains("write a decimal point, not a comma: 3.5"), "{comma}");
        assert!(after("name = \"a\"", &["name.more=2"]).is_err_and(|e| e.contains("not a section")));
    }
}
