//! The numbers of a study by key, and what one member draws of them.
//!
//! A draw is a pure function of seed, member and the key's slot, so that fixing one number leaves
//! the draws of the others.

use std::ops::{Index, IndexMut};

use crate::error::Result;
use crate::excitation;
use crate::kernel::integrator::{Choice, Integrator};
use crate::sensor::error_law::{ErrorLaw, Shape};
use crate::sensor::{ProofMass, SensorTerm, coupling, mechanics};
use crate::units::key::{Key, SLOTS};
use crate::units::number::Number;

/// Every key of a study that may be drawn per member, section by section, in the order of a sensor
/// table.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    let of = |section: &'static str| {
        let keys = SensorTerm::ALL.into_iter().flat_map(|term| term.row().keys);
        keys.filter(move |key| key.section() == section)
    };
    let excitation = [&excitation::SIZE, &excitation::FREQUENCY, &excitation::PHASE];
    let between = |section: &'static str| coupling::IN_MOTION.into_iter().filter(move |key| key.section() == section);
    let both = move |section: &'static str| of(section).chain(between(section));
    mechanics::keys()
        .chain(both("sensor"))
        .chain(both("accelerometer"))
        .chain(both("gyro"))
        .chain(of("alignment"))
        .chain(excitation)
}

/// One number per key, in datasheet units as written; absent ones are switched off.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances([Option<Number>; SLOTS]);

impl Default for Tolerances {
    fn default() -> Self {
        Self([None; SLOTS])
    }
}

impl Index<&Key> for Tolerances {
    type Output = Option<Number>;

    fn index(&self, key: &Key) -> &Option<Number> {
        &self.0[key.slot]
    }
}

impl IndexMut<&Key> for Tolerances {
    fn index_mut(&mut self, key: &Key) -> &mut Option<Number> {
        &mut self.0[key.slot]
    }
}

impl Tolerances {
    /// The key by which a sensor term is given, if it is.
    pub fn given(&self, term: SensorTerm) -> Option<&'static Key> {
        term.row().keys.iter().find(|key| self[key].is_some())
    }

    /// The SI value of a key for one member, whose probability of a lower one is drawn; what it is
    /// worth when absent if it was left out.
    pub fn draw(&self, key: &Key, probability: impl Fn(&Key) -> f64) -> f64 {
        self.draw_or(key, Number::Fixed(key.absent), probability)
    }

    /// The SI value of a key for one member; what `absent` draws if it was left out.
    pub fn draw_or(&self, key: &Key, absent: Number, probability: impl Fn(&Key) -> f64) -> f64 {
        let value = match self[key].unwrap_or(absent) {
            Number::Fixed(value) => value,
            number => number.quantile(probability(key), key.is_cut_at_zero()),
        };
        value * key.factor
    }

    /// Returns the integrator of proof masses of which this is the stiffest.
    ///
    /// # Errors
    /// One that no integrator can step.
    pub fn integrator(&self, stiffest: Option<&ProofMass>, step_s: f64) -> Result<Choice> {
        let choice = match self.given(SensorTerm::ReadoutLowPass) {
            Some(_) => Integrator::choose_resolving(stiffest, step_s),
            None => Integrator::choose(stiffest, step_s),
        };
        choice.integrator.check(stiffest, step_s)?;
        Ok(choice)
    }

    /// A number of a term's shape, SI, where it is given and the same for all members.
    pub fn shape(&self, term: SensorTerm, wanted: Shape) -> Option<f64> {
        let (value, variance) = self.moments(self.given(shape(term, wanted)?)?);
        (variance == 0.0).then_some(value)
    }

    /// Returns whether the phases of a sine are drawn around the circle.
    pub fn has_any_phase(&self, term: SensorTerm) -> bool {
        shape(term, Shape::Phase).is_none_or(|phase| self.given(phase).is_none())
    }

    /// Mean and variance over members, SI.
    pub fn moments(&self, key: &Key) -> (f64, f64) {
        let (mean, variance) = self[key].map_or((key.absent, 0.0), |n| n.moments(key.is_cut_at_zero()));
        (mean * key.factor, variance * key.factor * key.factor)
    }
}

fn shape(term: SensorTerm, wanted: Shape) -> Option<SensorTerm> {
    term.shapes().find(|shape| shape.law() == ErrorLaw::Shape(wanted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::second::probability;

    fn key(path: &str) -> &'static Key {
        keys().find(|k| k.path == path).expect("declared")
    }

    #[test]
    fn no_two_keys_share_a_slot_or_a_name() {
        for key in keys() {
            assert_eq!(keys().filter(|k| k.slot == key.slot).count(), 1, "slot {}", key.slot);
            assert_eq!(keys().filter(|k| k.path == key.path).count(), 1, "{}", key.path);
        }
        // Recorded with the first study that was published: the same seed keeps drawing the same
        // sensors.
        assert_eq!((key("accelerometer.bias_mg").slot, key("gyro.rate_random_walk_deg_h_rth").slot), (13, 25));
    }

    #[test]
    fn fixing_one_parameter_leaves_the_draws_of_another() {
        let mut both = Tolerances::default();
        both[key("accelerometer.bias_mg")] = Some(Number::Normal { mean: 0.0, sd: 1.0 });
        both[key("accelerometer.scale_factor_ppm")] = Some(Number::Uniform { min: -5.0, max: 5.0 });
        let mut one = both.clone();
        one[key("accelerometer.scale_factor_ppm")] = Some(Number::Fixed(1.0));
        for member in 0..100 {
            let draw = |t: &Tolerances| t.draw(key("accelerometer.bias_mg"), |key| probability(key, 7, member));
            assert_eq!(draw(&both), draw(&one));
        }
        let under = |seed: u64| both.draw(key("accelerometer.bias_mg"), |key| probability(key, seed, 0));
        assert_ne!(under(7), under(8));
    }

    #[test]
    fn draws_have_the_stated_mean_and_spread_and_are_uncorrelated() {
        let mut tolerances = Tolerances::default();
        tolerances[key("accelerometer.bias_mg")] = Some(Number::Normal { mean: 2.0, sd: 1.0 });
        tolerances[key("gyro.bias_deg_h")] = Some(Number::Uniform { min: -10.0, max: 20.0 });
        let n = 40_000u64;
        let column = |p: &Key| -> Vec<f64> {
            let (mean, variance) = tolerances.moments(p);
            (0..n).map(|m| (tolerances.draw(p, |key| probability(key, 3, m)) - mean) / variance.sqrt()).collect()
        };
        let (a, b) = (column(key("accelerometer.bias_mg")), column(key("gyro.bias_deg_h")));
        let mean = |v: &mut dyn Iterator<Item = f64>| v.sum::<f64>() / n as f64;
        // Five standard errors of each: 1/√n for a mean or a correlation, √(2/n) for a normal's
        // variance.
        assert!(mean(&mut a.iter().copied()).abs() < 0.025);
        assert!(mean(&mut b.iter().copied()).abs() < 0.025);
        assert!((mean(&mut a.iter().map(|x| x * x)) - 1.0).abs() < 0.036);
        assert!((mean(&mut b.iter().map(|x| x * x)) - 1.0).abs() < 0.036);
        assert!(mean(&mut a.iter().zip(&b).map(|(x, y)| x * y)).abs() < 0.025);
    }
}
