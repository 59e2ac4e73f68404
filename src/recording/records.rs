//! Binary records that describe themselves: fields at known places, of which some become columns.

use super::element::Element;
use super::finding::Finding;
use super::reader::{Block, Choice, Heading};

/// A number within a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Heading and unit of its column.
    pub heading: Heading,
    /// States how it is stored.
    pub element: Element,
    /// Bytes from the beginning of the record.
    pub offset: usize,
    /// Holds what one unit of the stored number is of the column's; 1 but for fixed-point numbers.
    pub scale: f64,
}

/// Appends the fields wanted of a record to a block; what lies beyond its end is missing.
pub fn push(fields: &[Field], choice: &Choice, record: &[u8], block: &mut Block) {
    let bytes = |field: &Field| record.get(field.offset..field.offset + field.element.bytes);
    if let Some(field) = choice.time.map(|t| &fields[t]) {
        block.stamps.push(bytes(field).map_or(super::clock::stamp::Stamp::MISSING, |b| field.element.stamp(b)));
    }
    for (target, place) in choice.places.iter().enumerate() {
        let field = &fields[*place];
        let found = bytes(field);
        block.columns[target].push(found.map_or(f64::NAN, |b| field.element.value(b) * field.scale));
        if block.rounded[target].is_none() && found.is_some_and(|b| field.element.is_rounded(b)) {
            block.rounded[target] = Some(block.rows);
        }
    }
    block.rows += 1;
}

/// Columns of the readings of an inertial sensor go by the same names in every log.
pub fn inertial(names: &mut [Heading]) -> bool {
    let plain: Vec<String> = names.iter().map(|h| h.name.clone()).collect();
    let roles = super::roles::of(&plain);
    for (places, letter, unit) in [(roles.gyro, 'g', "rad/s"), (roles.accelerometer, 'a', "m/s2")] {
        for (place, axis) in places.into_iter().flatten().zip("xyz".chars()) {
            names[place] = Heading::in_unit(format!("{letter}{axis}"), unit);
        }
    }
    let both = roles.gyro.zip(roles.accelerometer);
    if let Some((gyro, accelerometer)) = both {
        // What else such a message holds is given where it is asked for.
        let among = |place: &usize| gyro.contains(place) || accelerometer.contains(place);
        names.iter_mut().enumerate().filter(|(place, _)| !among(place)).for_each(|(_, heading)| heading.aside = true);
    }
    both.is_some()
}

/// Bytes that belong to no record.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Strays {
    bytes: u64,
    first: u64,
}

impl Strays {
    /// Counts a record dropped at a byte.
    pub fn add(&mut self, at: u64, bytes: u64) {
        if self.bytes == 0 {
            self.first = at;
        }
        self.bytes += bytes;
    }

    /// Returns what is to be said of them.
    pub fn finding(&self) -> Option<Finding> {
        (self.bytes > 0).then_some(Finding::SkippedBytes { bytes: self.bytes, first: self.first })
    }
}
