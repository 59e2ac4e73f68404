//! `[excitation]` as it is written: the kind, and the keys that the kinds declare.

use std::fmt;

#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, Visitor};

use crate::units::number::Number;

/// Form of a key's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A number that may be drawn per member.
    Number,
    /// A number that is the same for all members.
    Real,
    /// A whole number, zero or more.
    Whole,
    /// A word: a file, a column.
    Text,
    /// A table of pairs.
    Pairs,
}

/// The value of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number that may be drawn per member, of [`Form::Number`].
    Number(Number),
    /// A plain number, of [`Form::Real`].
    Real(f64),
    /// A whole number, of [`Form::Whole`].
    Whole(u32),
    /// A word, of [`Form::Text`].
    Text(String),
    /// Pairs of numbers, of [`Form::Pairs`].
    Pairs(Vec<[f64; 2]>),
}

/// Keys with their forms; a key has the same form in every kind that takes it.
pub(super) type Keys = &'static [(&'static str, Form)];

/// `[excitation]`: the kind and the keys that were given with it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// `kind`, one of the known ones.
    pub kind: Option<&'static str>,
    /// The other keys, as given.
    pub given: Vec<(&'static str, Value)>,
}

impl Section {
    /// The recording that it replays, as given.
    pub fn file(&self) -> Option<&str> {
        self.given.iter().find_map(|(key, value)| match value {
            Value::Text(file) if *key == "file" => Some(file.as_str()),
            _ => None,
        })
    }
}

/// The known kinds and keys.
pub struct Known {
    kinds: Vec<&'static str>,
    /// `kind`, then every key of every kind.
    names: Vec<&'static str>,
    forms: Vec<Form>,
}

impl Known {
    /// Of kinds with their keys.
    pub fn of(kinds: impl Iterator<Item = (&'static str, Keys)>) -> Self {
        let mut known = Self { kinds: Vec::new(), names: vec!["kind"], forms: Vec::new() };
        for (kind, keys) in kinds {
            known.kinds.push(kind);
            for (key, form) in keys {
                if !known.names.contains(key) {
                    known.names.push(key);
                    known.forms.push(*form);
                }
            }
        }
        known
    }
}

/// Reads the section.
///
/// # Errors
/// An unknown kind, an unknown key, a value of another form.
pub fn read<'de, D: Deserializer<'de>>(deserializer: D, known: &'static Known) -> Result<Section, D::Error> {
    deserializer.deserialize_map(Reading(known))
}

struct Reading(&'static Known);

impl<'de> Visitor<'de> for Reading {
    type Value = Section;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a section [excitation]")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Section, M::Error> {
        let mut section = Section::default();
        while let Some(name) = map.next_key_seed(Name(self.0))? {
            match self.0.names.iter().skip(1).position(|key| *key == name) {
                Some(place) => section.given.push((name, map.next_value_seed(self.0.forms[place])?)),
                None => section.kind = Some(map.next_value_seed(Kind(self.0))?),
            }
        }
        // The order of the keys in the file means nothing.
        section.given.sort_by_key(|(name, _)| *name);
        Ok(section)
    }
}

/// One of the section's keys, read as a key so that a misspelt one is placed.
struct Name(&'static Known);

impl<'de> DeserializeSeed<'de> for Name {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        let (name, names) = (String::deserialize(deserializer)?, &self.0.names);
        names.iter().find(|n| **n == name).copied().ok_or_else(|| de::Error::unknown_field(&name, names))
    }
}

/// One of the kinds, read as a value so that a misspelt one is placed.
struct Kind(&'static Known);

impl<'de> DeserializeSeed<'de> for Kind {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        let (name, kinds) = (String::deserialize(deserializer)?, &self.0.kinds);
        kinds.iter().find(|k| **k == name).copied().ok_or_else(|| de::Error::unknown_variant(&name, kinds))
    }
}

#[cfg(feature = "schema")]
impl Form {
    /// The JSON Schema of such a value.
    pub fn schema(self, generator: &mut SchemaGenerator) -> Schema {
        match self {
            Self::Number => Number::json_schema(generator),
            Self::Real => f64::json_schema(generator),
            Self::Whole => u32::json_schema(generator),
            Self::Text => String::json_schema(generator),
            Self::Pairs => <Vec<[f64; 2]>>::json_schema(generator),
        }
    }
}

impl<'de> DeserializeSeed<'de> for Form {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        Ok(match self {
            Self::Number => Value::Number(Number::deserialize(deserializer)?),
            Self::Real => Value::Real(f64::deserialize(deserializer)?),
            Self::Whole => Value::Whole(u32::deserialize(deserializer)?),
            Self::Text => Value::Text(String::deserialize(deserializer)?),
            Self::Pairs => Value::Pairs(Vec::deserialize(deserializer)?),
        })
    }
}
