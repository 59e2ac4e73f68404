//! Which error a requirement limits: one of a study along one axis, or one of a study along a
//! trajectory.
//!
//! Names are those of `study --json`; an entry of an object there is named by its path:
//! `position_error_ned_m.north`.

use std::fmt;

use crate::backend::flight::Quantity;
use crate::error::{Error, Result, nearest};
use crate::statistics::{QUANTITIES, quantity};
use crate::study::Study;
use crate::study::in_motion::InMotion;

/// An error of every member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watched {
    /// Error along one axis, by its place in [`QUANTITIES`].
    OneAxis(usize),
    /// Error along a trajectory, by its place in [`IN_MOTION`].
    InMotion(usize),
}

/// Names of the errors along a trajectory.
pub const IN_MOTION: [(&str, Quantity); 11] = [
    ("position_error_ned_m.north", Quantity::Position(0)),
    ("position_error_ned_m.east", Quantity::Position(1)),
    ("position_error_ned_m.down", Quantity::Position(2)),
    ("velocity_error_ned_m_s.north", Quantity::Velocity(0)),
    ("velocity_error_ned_m_s.east", Quantity::Velocity(1)),
    ("velocity_error_ned_m_s.down", Quantity::Velocity(2)),
    ("attitude_error_rad.roll", Quantity::Attitude(0)),
    ("attitude_error_rad.pitch", Quantity::Attitude(1)),
    ("attitude_error_rad.heading", Quantity::Attitude(2)),
    ("horizontal_error_m", Quantity::Horizontal),
    ("spherical_error_m", Quantity::Spherical),
];

impl Watched {
    /// Horizontal distance from the truth.
    pub const HORIZONTAL: Self = Self::InMotion(9);

    /// The error of this name.
    ///
    /// # Errors
    /// In words: there is none.
    pub fn named(name: &str) -> std::result::Result<Self, String> {
        if let Some(place) = QUANTITIES.iter().position(|known| *known == name) {
            return Ok(Self::OneAxis(place));
        }
        if let Some(place) = IN_MOTION.iter().position(|(known, _)| *known == name) {
            return Ok(Self::InMotion(place));
        }
        let known: Vec<&str> = QUANTITIES.into_iter().chain(IN_MOTION.map(|(known, _)| known)).collect();
        Err(match nearest(name, known.iter().copied()) {
            Some(near) => format!("`{name}` is not a quantity: did you mean `{near}`?"),
            None => format!("`{name}` is not a quantity; known: {}", known.join(", ")),
        })
    }

    /// Its name in requirements and in the JSON of a study, e.g. "position_error_m".
    pub fn name(self) -> &'static str {
        match self {
            Self::OneAxis(place) => QUANTITIES[place],
            Self::InMotion(place) => IN_MOTION[place].0,
        }
    }

    /// Its name in words and its unit, e.g. "north position error" and "m".
    pub fn words(self) -> (String, &'static str) {
        let (error, part) = self.name().split_once('.').unwrap_or((self.name(), ""));
        let units = [("_m_s2", "m/s²"), ("_m_s", "m/s"), ("_m", "m"), ("_rad", "rad")];
        let found = units.into_iter().find_map(|(suffix, unit)| Some((error.strip_suffix(suffix)?, unit)));
        let (error, unit) = found.unwrap_or((error, "1"));
        let words = error.trim_end_matches("_ned").replace('_', " ");
        (format!("{part} {words}").trim_start().to_owned(), unit)
    }

    /// Its place among the errors of a study that has it.
    pub fn place(self) -> usize {
        match self {
            Self::OneAxis(place) | Self::InMotion(place) => place,
        }
    }

    /// The errors that a study has, in the order of its sums.
    pub fn all(study: &Study) -> Vec<Self> {
        match &study.in_motion {
            None => (0..QUANTITIES.len()).map(Self::OneAxis).collect(),
            Some(_) => (0..IN_MOTION.len()).map(Self::InMotion).collect(),
        }
    }

    /// The error that says how far a study has drifted.
    pub fn drift(study: &Study) -> Self {
        match &study.in_motion {
            None => Self::OneAxis(quantity::POSITION),
            Some(_) => Self::HORIZONTAL,
        }
    }

    /// Refuses an error that the study does not have.
    ///
    /// # Errors
    /// An error of one axis along a trajectory, or the other way round.
    pub fn check(self, study: &Study) -> Result<()> {
        match self {
            Self::OneAxis(_) if study.in_motion.is_some() => Err(Error::new(
                format!("could not evaluate `{self}`"),
                format!("{} follows a trajectory, and `{self}` is an error along one axis", study.name),
                "e.g. cep95(horizontal_error_m, 60) or p95(position_error_ned_m.north, 60)",
            )),
            Self::OneAxis(_) => Ok(()),
            Self::InMotion(_) => self.motion(study).map(|_| ()),
        }
    }

    /// Returns what moves the sensor of a study that has this error.
    ///
    /// # Errors
    /// The study has no trajectory.
    pub(super) fn motion(self, study: &Study) -> Result<&InMotion> {
        study.in_motion.as_ref().ok_or_else(|| {
            Error::new(
                format!("could not evaluate `{self}`"),
                format!("{} runs along one axis, and `{self}` needs a [trajectory]", study.name),
                "e.g. p95(position_error_m, 60); or add a [trajectory], e.g. kind = \"rest\"",
            )
        })
    }
}

impl fmt::Display for Watched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_is_found_by_its_own_name_and_a_misspelt_one_is_suggested() {
        for name in QUANTITIES.into_iter().chain(IN_MOTION.map(|(name, _)| name)) {
            assert_eq!(Watched::named(name).map(Watched::name), Ok(name));
        }
        assert_eq!(Watched::named("horizontal_error_m"), Ok(Watched::HORIZONTAL));
        let words = |name: &str| Watched::named(name).map(|watched| watched.words());
        assert_eq!(words("position_error_m"), Ok(("position error".into(), "m")));
        assert_eq!(words("velocity_error_ned_m_s.north"), Ok(("north velocity error".into(), "m/s")));
        assert_eq!(words("acceleration_error_m_s2"), Ok(("acceleration error".into(), "m/s²")));
        let suggested = |name: &str| Watched::named(name).expect_err("misspelt");
        assert!(suggested("horizontal_eror_m").contains("did you mean `horizontal_error_m`"));
    }
}
