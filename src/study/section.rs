//! A section of study.toml that holds numbers: its keys are those that the sensor's tables declare
//! for it.
//!
//! Read by hand instead of as a struct with a field per key, so that a key is declared once. An
//! unknown key is placed in the file and the known ones are listed, as for every other section.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::OnceLock;

#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, Visitor};

use super::per_axis::PerAxis;
use super::tolerances::{Tolerances, keys};
use crate::units::key::Key;
#[cfg(feature = "schema")]
use crate::units::key::Sign;
#[cfg(feature = "schema")]
use crate::units::number::Number;

/// The numbers given in one section, by key.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Numbers(Vec<(&'static Key, PerAxis)>);

impl Numbers {
    /// Puts those of an axis in their places and empties the places of the section's other keys.
    pub fn replace(&self, section: Section, axis: usize, all: &mut Tolerances) {
        keys().filter(|key| key.section() == section.name()).for_each(|key| all[key] = None);
        self.0.iter().for_each(|(key, number)| all[key] = Some(number.of(axis)));
    }

    /// The first key that is given axis by axis, if one is.
    pub fn by_axis(&self) -> Option<&'static Key> {
        self.0.iter().find(|(_, number)| matches!(number, PerAxis::Each(_))).map(|(key, _)| *key)
    }
}

/// `[sensor]`: numbers, and the sampling rate that all members share.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sensor {
    /// Readings per second, Hz.
    pub sample_rate_hz: Option<f64>,
    /// The other keys of the section.
    pub numbers: Numbers,
}

/// The sections of study.toml that hold numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// Mechanics, sampling and range.
    Sensor,
    /// The accelerometer's reading errors.
    Accelerometer,
    /// The gyro's reading errors.
    Gyro,
}

/// The key of [sensor] that is the same for all members.
const SAMPLE_RATE: &str = "sample_rate_hz";

impl Section {
    /// Name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::Accelerometer => "accelerometer",
            Self::Gyro => "gyro",
        }
    }

    fn known(self) -> &'static [&'static str] {
        static KNOWN: OnceLock<BTreeMap<Section, Vec<&'static str>>> = OnceLock::new();
        let sections = KNOWN.get_or_init(|| {
            let of = |section: Self| {
                let rate = (section == Self::Sensor).then_some(SAMPLE_RATE);
                rate.into_iter().chain(keys().filter(|k| k.section() == section.name()).map(Key::key)).collect()
            };
            [Self::Sensor, Self::Accelerometer, Self::Gyro].map(|section| (section, of(section))).into()
        });
        sections.get(&self).map_or(&[], Vec::as_slice)
    }
}

/// Reads `[sensor]`.
///
/// # Errors
/// An unknown key, or a value that is no number.
pub fn sensor<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Sensor, D::Error> {
    deserializer.deserialize_map(Reading(Section::Sensor))
}

/// Reads `[accelerometer]`.
///
/// # Errors
/// As [`sensor`].
pub fn accelerometer<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Numbers>, D::Error> {
    deserializer.deserialize_map(Reading(Section::Accelerometer)).map(|s| Some(s.numbers))
}

/// Reads `[gyro]`.
///
/// # Errors
/// As [`sensor`].
pub fn gyro<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Numbers>, D::Error> {
    deserializer.deserialize_map(Reading(Section::Gyro)).map(|s| Some(s.numbers))
}

/// `[sensor]` as JSON Schema.
#[cfg(feature = "schema")]
pub fn schema_of_sensor(generator: &mut SchemaGenerator) -> Schema {
    schema(generator, Section::Sensor)
}

/// `[accelerometer]` as JSON Schema.
#[cfg(feature = "schema")]
pub fn schema_of_accelerometer(generator: &mut SchemaGenerator) -> Schema {
    schema(generator, Section::Accelerometer)
}

/// `[gyro]` as JSON Schema.
#[cfg(feature = "schema")]
pub fn schema_of_gyro(generator: &mut SchemaGenerator) -> Schema {
    schema(generator, Section::Gyro)
}

/// A section's keys, each with its name, its unit and the values that make sense.
#[cfg(feature = "schema")]
fn schema(generator: &mut SchemaGenerator, section: Section) -> Schema {
    let mut properties = serde_json::Map::new();
    if section == Section::Sensor {
        let about = "Readings per second";
        properties.insert(
            SAMPLE_RATE.into(),
            serde_json::json!({ "type": "number", "exclusiveMinimum": 0, "description": about }),
        );
    }
    for key in keys().filter(|key| key.section() == section.name()) {
        let unit = if key.unit == "1" { String::new() } else { format!(", {}", key.unit) };
        let mut number = Number::json_schema(generator);
        number.insert("description".into(), format!("{}{unit}", key.name).into());
        let fixed = number.get_mut("anyOf").and_then(|any| any.get_mut(0)).and_then(serde_json::Value::as_object_mut);
        if let Some(fixed) = fixed {
            match key.sign {
                Sign::Any => None,
                Sign::NotNegative => fixed.insert("minimum".into(), 0.into()),
                Sign::Positive => fixed.insert("exclusiveMinimum".into(), 0.into()),
            };
        }
        if section != Section::Sensor {
            let three = serde_json::json!({ "type": "array", "minItems": 3, "maxItems": 3, "items": number.clone() });
            if let Some(forms) = number.get_mut("anyOf").and_then(serde_json::Value::as_array_mut) {
                forms.push(three);
            }
        }
        properties.insert(key.key().into(), number.into());
    }
    schemars::json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// A section being read.
struct Reading(Section);

impl<'de> Visitor<'de> for Reading {
    type Value = Sensor;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a section [{}] of numbers", self.0.name())
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Sensor, M::Error> {
        let mut read = Sensor::default();
        while let Some(name) = map.next_key_seed(Name(self.0))? {
            match keys().find(|k| k.section() == self.0.name() && k.key() == name) {
                Some(key) => read.numbers.0.push((key, map.next_value()?)),
                None => read.sample_rate_hz = Some(map.next_value()?),
            }
        }
        // The order of the keys in the file means nothing.
        read.numbers.0.sort_by_key(|(key, _)| key.slot);
        Ok(read)
    }
}

/// One of the section's keys, read as a key so that a misspelt one is placed.
struct Name(Section);

impl<'de> DeserializeSeed<'de> for Name {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        let name = <String as de::Deserialize>::deserialize(deserializer)?;
        let known = self.0.known();
        known.iter().find(|k| **k == name).copied().ok_or_else(|| de::Error::unknown_field(&name, known))
    }
}
