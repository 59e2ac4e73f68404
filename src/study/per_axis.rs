//! A number of study.toml that may be given axis by axis: one for all three, or a list of three.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use crate::units::number::Number;

/// A number for each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PerAxis {
    /// The same for all three; where it is drawn, it is drawn for each apart.
    All(Number),
    /// One number each for x, y and z.
    Each([Number; 3]),
}

impl PerAxis {
    /// That of an axis: 0, 1, 2.
    pub(super) fn of(self, axis: usize) -> Number {
        match self {
            Self::All(number) => number,
            Self::Each(numbers) => numbers[axis],
        }
    }
}

impl<'de> Deserialize<'de> for PerAxis {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Form)
    }
}

struct Form;

impl<'de> Visitor<'de> for Form {
    type Value = PerAxis;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a number, { mean = …, sd = … }, { min = …, max = … } or, with a [trajectory], a list of three of them",
        )
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<PerAxis, E> {
        self.visit_f64(value as f64)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<PerAxis, E> {
        Number::deserialize(de::value::F64Deserializer::new(value)).map(PerAxis::All)
    }

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<PerAxis, M::Error> {
        Number::deserialize(MapAccessDeserializer::new(map)).map(PerAxis::All)
    }

    fn visit_seq<S: SeqAccess<'de>>(self, mut list: S) -> Result<PerAxis, S::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = list.next_element::<Number>()? {
            numbers.push(number);
        }
        let count = numbers.len();
        let three =
            numbers.try_into().map_err(|_| de::Error::invalid_length(count, &"three numbers, one for each axis"))?;
        Ok(PerAxis::Each(three))
    }
}
