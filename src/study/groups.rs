//! Everything of a study that differs from member to member, in groups that are independent of each
//! other: among these the variance of its error is shared.
//!
//! A group is a source of the error budget with all of its keys. Noise in the run is one group: its
//! streams have one seed, and some of them share their random bits (`kernel::cpu::cheap_noise`).

use std::sync::Arc;

use super::Study;
use super::second::{Second, Seeds, Slots};
use super::tolerances::Tolerances;
use crate::excitation::{FREQUENCY, PHASE, SIZE};
use crate::kernel::chained::Chained;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::source::ErrorSource;
use crate::sensor::{coupling, mechanics};
use crate::units::key::Key;

/// Random numbers of a study that are shared among sources together, independent of all others.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Name in tables: that of a source of the error budget, or of what is no source.
    pub name: &'static str,
    /// Sources that it holds, where these are several.
    pub holds: Vec<&'static str>,
    /// Keys that are drawn under its seed.
    pub slots: Slots,
    /// Says whether noise in the run belongs to it, and what a start draws.
    pub in_run: bool,
}

impl Group {
    fn drawn(name: &'static str, slots: Slots) -> Self {
        Self { name, holds: Vec::new(), slots, in_run: false }
    }
}

/// Name of the group of all noise.
const NOISE: &str = "noise in the run";

impl Study {
    /// Everything that differs from member to member, in groups; the noise in the run last.
    pub fn groups(&self) -> Vec<Group> {
        let axes = self.axes();
        let mut noise = Group { in_run: true, ..Group::drawn(NOISE, 0) };
        let mut groups: Vec<Group> = Vec::new();
        for source in ErrorSource::ALL {
            let keys = keys(source);
            match is_noise(source) {
                true if keys.iter().any(|key| is_on(axes, key)) => {
                    noise.holds.push(source.name());
                    noise.slots |= slots(&keys);
                }
                false if keys.iter().any(|key| is_drawn(axes, key)) || has_any_phase(axes, source) => {
                    groups.push(Group::drawn(source.name(), slots(&keys)));
                }
                _ => {}
            }
        }
        let excitation = [&SIZE, &FREQUENCY, &PHASE];
        if excitation.iter().any(|key| is_drawn(axes, key)) {
            groups.push(Group::drawn("excitation", slots(&excitation)));
        }
        if let Some(motion) = &self.in_motion {
            let known = groups.iter().fold(noise.slots, |known, group| known | group.slots);
            let couplings = coupling::KEYS.into_iter().filter(|key| (known >> key.slot) & 1 == 0);
            for key in couplings.filter(|key| **key != coupling::TIME_JITTER && is_drawn(axes, key)) {
                groups.push(Group::drawn(key.name, slots(&[key])));
            }
            if is_on(axes, &coupling::TIME_JITTER) {
                noise.holds.push(coupling::TIME_JITTER.name);
                noise.slots |= slots(&[&coupling::TIME_JITTER]);
            }
            let start = [motion.misalignment.tilt_sd_rad, motion.misalignment.heading_sd_rad];
            noise.holds.extend(start.iter().any(|sd_rad| *sd_rad != 0.0).then_some("initial attitude"));
            noise.holds.extend(motion.aiding.is_some().then_some("fixes"));
        }
        groups.extend((!noise.holds.is_empty()).then_some(noise));
        groups
    }

    /// The same members, some of whose random numbers come from a second sample.
    pub fn with_second(&self, second: Second) -> Self {
        Self { second: Some(second), ..self.clone() }
    }

    /// The same, with members of a chain.
    pub fn with_chained(&self, chained: Arc<dyn Chained>) -> Self {
        Self { chained: Some(chained), ..self.clone() }
    }

    /// The seeds under which it draws.
    pub(super) fn seeds(&self) -> Seeds {
        Seeds::one(self.seed).with(self.second.clone(), self.chained.clone())
    }
}

/// Every key of a source: its strength under any of its names, and its shape.
fn keys(source: ErrorSource) -> Vec<&'static Key> {
    match source {
        ErrorSource::Mechanics => mechanics::keys().filter(|key| key.slot != mechanics::FORCE_NOISE.slot).collect(),
        ErrorSource::ForceNoise => vec![&mechanics::FORCE_NOISE],
        ErrorSource::Term(term) => std::iter::once(term).chain(term.shapes()).flat_map(|t| t.row().keys).collect(),
    }
}

fn is_noise(source: ErrorSource) -> bool {
    use ErrorLaw::{Flicker, Markov, Walk, White};
    match source {
        ErrorSource::Mechanics => false,
        ErrorSource::ForceNoise => true,
        ErrorSource::Term(term) => matches!(term.law(), White(_) | Flicker(_) | Walk(_) | Markov(_)),
    }
}

fn is_on(axes: &[Tolerances], key: &Key) -> bool {
    axes.iter().any(|axis| axis[key].is_some_and(|number| !number.is_zero()))
}

fn is_drawn(axes: &[Tolerances], key: &Key) -> bool {
    axes.iter().any(|axis| axis.moments(key).1 > 0.0)
}

/// Returns whether it is a sine whose phase is drawn around the circle though no key says so.
fn has_any_phase(axes: &[Tolerances], source: ErrorSource) -> bool {
    let ErrorSource::Term(term) = source else { return false };
    let given = |axis: &Tolerances| axis.given(term).is_some_and(|key| axis[key].is_some_and(|n| !n.is_zero()));
    term.law() == ErrorLaw::Sine && axes.iter().any(|axis| given(axis) && axis.has_any_phase(term))
}

fn slots(keys: &[&Key]) -> Slots {
    keys.iter().fold(0, |slots, key| slots | 1 << key.slot)
}
