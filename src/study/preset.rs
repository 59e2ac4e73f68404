//! Grades of inertial sensors: one part of each grade, from its datasheet. The sources stand in the
//! files under `preset/`.
//!
//! Not for whole studies: a grade holds the errors of accelerometer and gyro, and lies under what a
//! study says itself.

use toml::{Table, Value};

use crate::document::parse_toml;
use crate::error::Result;
use crate::sensor::SensorTerm;

/// A grade of IMU, with typical error figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// A phone's or a drone's part, not calibrated.
    Consumer,
    /// A factory-calibrated MEMS IMU.
    Industrial,
    /// The best of MEMS.
    Tactical,
    /// Navigation grade: ring-laser gyros.
    Navigation,
}

impl Preset {
    /// Every grade, the worst first.
    pub const ALL: [Self; 4] = [Self::Consumer, Self::Industrial, Self::Tactical, Self::Navigation];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Consumer => "consumer",
            Self::Industrial => "industrial",
            Self::Tactical => "tactical",
            Self::Navigation => "navigation",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Consumer => include_str!("preset/consumer.toml"),
            Self::Industrial => include_str!("preset/industrial.toml"),
            Self::Tactical => include_str!("preset/tactical.toml"),
            Self::Navigation => include_str!("preset/navigation.toml"),
        }
    }

    /// Adds the grade's keys to a study. A term that the study gives itself, by whichever of its
    /// keys, or that `is_set` (by section and key) says will be given, stays the study's.
    ///
    /// # Errors
    /// None, unless an embedded file is broken, which a test excludes.
    pub(super) fn lay_under(self, study: &mut Table, is_set: impl Fn(&str, &str) -> bool) -> Result<()> {
        let grade: Table = parse_toml(self.name(), self.text())?;
        for (section, numbers) in grade {
            let own = study.entry(section.as_str()).or_insert_with(|| Value::Table(Table::new()));
            // A section that is none is told when the study is read.
            let (Value::Table(own), Value::Table(numbers)) = (own, numbers) else { continue };
            let absent = numbers.into_iter().filter(|(key, _)| {
                let mut names = synonyms(&section, key);
                !names.any(|name| own.contains_key(name) || (name != key && is_set(&section, name)))
            });
            let absent: Vec<_> = absent.collect();
            own.extend(absent);
        }
        Ok(())
    }
}

/// All keys of the term that a key gives: noise as density or as random walk.
fn synonyms(section: &str, key: &str) -> impl Iterator<Item = &'static str> {
    let path = format!("{section}.{key}");
    let rows = SensorTerm::ALL.into_iter().map(|term| term.row().keys);
    rows.filter(move |keys| keys.iter().any(|k| k.path == path)).flatten().map(|k| k.key())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Control;
    use crate::{Overrides, Study, read_default};

    fn with(preset: Preset, set: &[&str]) -> Study {
        let set = set.iter().map(|s| s.parse().expect("an assignment")).collect();
        read_default(&Overrides { preset: Some(preset), set, ..Overrides::default() }, &Control::silent())
            .expect("a study")
    }

    #[test]
    fn every_grade_is_a_study_and_a_better_one_has_the_smaller_errors() {
        let angle = |study: &Study| study.member(0).sensor.gyro.angle_random_walk_rad_rts;
        let studies = Preset::ALL.map(|preset| with(preset, &[]));
        assert!(studies.windows(2).all(|pair| angle(&pair[1]) < angle(&pair[0])));
        assert!(Preset::ALL.iter().zip(&studies).all(|(preset, study)| study.name == preset.name()));
    }

    #[test]
    fn what_a_study_gives_itself_stays_and_a_synonym_takes_the_place() {
        let mut study: Table = toml::from_str("[gyro]\nangle_random_walk_deg_rth = 0.5\n").expect("TOML");
        Preset::Consumer.lay_under(&mut study, |_, key| key == "velocity_random_walk_m_s_rth").expect("laid under");
        let keys = |section: &str| study[section].as_table().expect("a section").keys().cloned().collect::<Vec<_>>();
        assert_eq!(keys("gyro"), ["angle_random_walk_deg_rth", "bias_deg_h"]);
        assert_eq!(keys("accelerometer"), ["bias_mg", "scale_factor_ppm"]);
        // Control: with nothing of its own the study gets the datasheet's noise.
        let mut empty = Table::new();
        Preset::Consumer.lay_under(&mut empty, |_, _| false).expect("laid under");
        assert_eq!(empty["gyro"]["noise_density_deg_s_rthz"].as_float(), Some(0.015));
        assert_ne!(with(Preset::Consumer, &["gyro.bias_deg_h.sd=2"]).identity, with(Preset::Consumer, &[]).identity);
    }
}
