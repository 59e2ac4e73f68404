//! A study's text, read once, from which variants are made: other values at some keys, another
//! sensor.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::section::Section;
use super::{Assignment, Overrides, Study, Surroundings, parse_watched};
use crate::control::Control;
use crate::document::{from_table, parse_toml, read_text};
use crate::error::Result;

/// The study that runs when none is named: a consumer-grade MEMS IMU, one minute.
const DEFAULT: &str = include_str!("default.toml");

/// The text of a study.toml with what the command line changes in it.
#[derive(Debug, Clone)]
pub struct StudyText {
    name: String,
    text: String,
    overrides: Overrides,
    surroundings: Surroundings,
}

/// A sensor to put in the place of the study's; a section left out stays the study's.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sensor {
    /// Its `[accelerometer]` section.
    pub accelerometer: Option<Table>,
    /// Its `[gyro]` section.
    pub gyro: Option<Table>,
}

impl StudyText {
    /// Reads a study.toml.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path, overrides: Overrides, control: &Control) -> Result<Self> {
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let surroundings = Surroundings::new(folder, control);
        Ok(Self { name: path.display().to_string(), text: read_text(path)?, overrides, surroundings })
    }

    /// The default study; with a preset, its motion with that grade's sensor after a still start,
    /// under the grade's name.
    ///
    /// # Errors
    /// None, as a test shows that the embedded file is sound.
    pub fn of_default(overrides: Overrides, control: &Control) -> Result<Self> {
        let name = "the default study".to_owned();
        let mut text = DEFAULT.to_owned();
        if let Some(preset) = overrides.preset {
            let mut document: Table = parse_toml(&name, DEFAULT)?;
            [Section::Accelerometer, Section::Gyro].iter().for_each(|section| drop(document.remove(section.name())));
            document.insert("name".into(), preset.name().into());
            // A datasheet states biases as delivered, and the default those that a still start leaves.
            let still: Table =
                [("kind".to_owned(), "still".into()), ("still_s".to_owned(), 10.0.into())].into_iter().collect();
            document.insert("alignment".into(), still.into());
            text = document.to_string();
        }
        Ok(Self { name, text, overrides, surroundings: Surroundings::new("", control) })
    }

    /// The study as it stands.
    ///
    /// # Errors
    /// As [`super::read`].
    pub fn study(&self) -> Result<Study> {
        parse_watched(&self.name, &self.text, &self.overrides, &self.surroundings)
    }

    /// The study with further keys set.
    ///
    /// # Errors
    /// As [`super::read`].
    pub fn with(&self, set: &[Assignment]) -> Result<Study> {
        let mut overrides = self.overrides.clone();
        overrides.set.extend_from_slice(set);
        parse_watched(&self.name, &self.text, &overrides, &self.surroundings)
    }

    /// The study with another number of members.
    ///
    /// # Errors
    /// As [`super::read`].
    pub fn with_members(&self, members: u64) -> Result<Study> {
        let overrides = Overrides { members: Some(members), ..self.overrides.clone() };
        parse_watched(&self.name, &self.text, &overrides, &self.surroundings)
    }

    /// The study with another sensor; `name` stands for it in messages.
    ///
    /// # Errors
    /// As [`super::read`].
    pub fn with_sensor(&self, name: &str, sensor: &Sensor) -> Result<Study> {
        let mut document: Table = parse_toml(&self.name, &self.text)?;
        for (section, numbers) in [("accelerometer", &sensor.accelerometer), ("gyro", &sensor.gyro)] {
            if let Some(numbers) = numbers {
                document.insert(section.into(), Value::Table(numbers.clone()));
            }
        }
        self.overrides.apply(&mut document)?;
        let source = format!("{} with the part {name}", self.name);
        let text = document.to_string();
        Study::new(&source, text, from_table(&source, document)?, &self.overrides, &self.surroundings)
    }

    /// The number at a dotted path, if one stands there.
    ///
    /// # Errors
    /// A text that is no TOML, an override that leads nowhere.
    pub fn number(&self, key: &str) -> Result<Option<f64>> {
        let mut document: Table = parse_toml(&self.name, &self.text)?;
        self.overrides.apply(&mut document)?;
        let mut here = Some(&Value::Table(document));
        for part in key.split('.') {
            here = here.and_then(|value| value.get(part));
        }
        Ok(here.and_then(|value| value.as_float().or(value.as_integer().map(|n| n as f64))))
    }

    /// Returns whether members draw from a distribution at a dotted path.
    ///
    /// # Errors
    /// As [`StudyText::number`].
    pub fn is_drawn(&self, key: &str) -> Result<bool> {
        let ends = ["sd", "min"].map(|end| self.number(&format!("{key}.{end}")));
        ends.into_iter().try_fold(false, |drawn, number| Ok(drawn || number?.is_some()))
    }
}

/// The default study; with a preset, its motion with that grade's sensor, under the grade's name.
///
/// # Errors
/// A preset or `--set` that the default study cannot take; none otherwise, as a test shows that the
/// embedded file is sound.
pub fn read_default(overrides: &Overrides, control: &Control) -> Result<Study> {
    StudyText::of_default(overrides.clone(), control)?.study()
}

#[cfg(test)]
mod tests {
    use super::DEFAULT;

    // A package holds its own folder alone.
    #[test]
    fn the_default_study_is_the_one_that_the_report_shows() {
        assert_eq!(DEFAULT, include_str!("../../reports/default/study.toml"));
    }
}
