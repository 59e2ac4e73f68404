//! The laws that a study can run and their coefficients in one proof mass.

use std::sync::LazyLock;

use super::dimension::{Dimension, Units};
use super::library::Term;
use super::state::MOST_VALUES;
use super::study::Given;
use crate::units::key::Key;

/// Most coefficients that there may be.
pub const MOST: usize = 38;

/// A law that a study can run: one that gives a key for each of its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyLaw {
    /// The law that the keys set.
    pub term: Term,
    /// Place of its first coefficient.
    pub first: usize,
    /// Dimensions of its parameters, in their order.
    dimensions: [Dimension; MOST_VALUES],
}

impl StudyLaw {
    /// Keys that give its parameters.
    pub fn given(&self) -> &'static [Given] {
        self.term.study()
    }

    /// Returns whether it has states besides the displacement and velocity of the mass.
    pub fn has_states(&self) -> bool {
        self.term.states() > 0
    }

    /// Places of its coefficients.
    pub fn places(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.given().len()
    }

    /// Returns its first state at rest under one unit of input, with the reading as displacement and
    /// these values of its parameters.
    pub fn at_rest(&self, values: &[f64]) -> f64 {
        self.term.at_rest(1.0, values)
    }

    /// Factor that converts its `parameter` to other units.
    pub fn factor(&self, parameter: usize, units: &Units) -> f64 {
        self.dimensions.get(parameter).map_or(1.0, |dimension| dimension.factor(units))
    }
}

/// Dimensions of a law's parameters. Parsed once: each member of an ensemble is converted by them.
fn dimensions(term: &Term) -> [Dimension; MOST_VALUES] {
    let mut all = [Dimension::of("1"); MOST_VALUES];
    all.iter_mut().zip(term.candidate().parameters).for_each(|(dimension, p)| *dimension = Dimension::of(p.unit));
    all
}

/// All of them, in public order.
pub fn laws() -> &'static [StudyLaw] {
    static LAWS: LazyLock<Vec<StudyLaw>> = LazyLock::new(|| {
        let mut first = 0;
        let runnable = Term::all().into_iter().filter(|term| !term.study().is_empty());
        runnable
            .map(|term| term.in_studies())
            .chain(Term::of_studies())
            .map(|term| {
                let law = StudyLaw { term, first, dimensions: dimensions(&term) };
                first += term.study().len();
                law
            })
            .filter(|law| law.places().end <= MOST)
            .collect()
    });
    &LAWS
}

/// States of their own that all of them have together.
pub fn own_states() -> usize {
    laws().iter().map(|law| law.term.states()).sum()
}

/// The keys of all of them, in the order of their coefficients.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    // Gathered once: each member of an ensemble is drawn by them.
    static KEYS: LazyLock<Vec<&'static Key>> =
        LazyLock::new(|| laws().iter().flat_map(|law| law.given()).map(|given| &given.key).collect());
    KEYS.iter().copied()
}

/// Coefficients of the laws of one proof mass, SI; a strength of 0 where it does not follow a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients([f64; MOST]);

impl Default for Coefficients {
    /// Those of a mass that follows no law: what each is worth where it is left out.
    fn default() -> Self {
        Self::given(|key| key.absent * key.factor)
    }
}

impl Coefficients {
    /// The coefficients that each key is given.
    pub fn given(value: impl Fn(&Key) -> f64) -> Self {
        let mut all = [0.0; MOST];
        all.iter_mut().zip(keys()).for_each(|(coefficient, key)| *coefficient = value(key));
        Self(all)
    }

    /// The coefficient of a key; 0 for a key that is no law's.
    pub fn of(&self, key: &Key) -> f64 {
        place(key).map_or(0.0, |i| self.0[i])
    }

    /// With another coefficient of one key.
    pub fn with(mut self, key: &Key, value: f64) -> Self {
        if let Some(i) = place(key) {
            self.0[i] = value;
        }
        self
    }

    /// Returns whether the mass follows this law: its first parameter is the strength.
    pub fn has(&self, law: &StudyLaw) -> bool {
        self.0[law.first] != 0.0
    }

    /// The laws that the mass follows.
    pub fn acting(&self) -> impl Iterator<Item = &'static StudyLaw> {
        laws().iter().filter(|law| self.has(law))
    }

    /// Values of one law's parameters in these units.
    pub fn values(&self, law: &StudyLaw, units: &Units) -> [f64; MOST_VALUES] {
        let mut values = [0.0; MOST_VALUES];
        for (parameter, place) in law.places().enumerate().take(MOST_VALUES) {
            values[parameter] = self.0[place] * law.factor(parameter, units);
        }
        values
    }

    /// All coefficients in these units.
    pub fn scaled(&self, units: &Units) -> [f64; MOST] {
        let mut all = [0.0; MOST];
        for law in self.acting() {
            all[law.places()].copy_from_slice(&self.values(law, units)[..law.given().len()]);
        }
        all
    }

    /// One coefficient after the other of two masses.
    pub fn zip(&self, other: &Self, choose: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| choose(self.0[i], other.0[i])))
    }
}

/// Returns the place of the coefficient of a key.
fn place(key: &Key) -> Option<usize> {
    keys().position(|k| k.slot == key.slot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cubic_stiffness, squeeze_film_damping};

    #[test]
    fn every_runnable_law_has_a_place_and_a_key_per_parameter() {
        let runnable = Term::all().into_iter().filter(|t| !t.study().is_empty()).chain(Term::of_studies());
        assert_eq!(runnable.count(), laws().len(), "more coefficients than places: raise MOST");
        for law in laws() {
            assert_eq!(law.given().len(), law.term.candidate().parameters.len(), "{}", law.term.id());
            assert!(!law.term.wgsl().is_empty(), "{}", law.term.id());
            // At most two internal states: the shader stores one as f32 and two as vec2<f32>.
            let own = format!("fn {}_rates(", law.term.id().replace('-', "_"));
            assert!(law.term.states() <= 2, "{}", law.term.id());
            assert_eq!(law.term.wgsl().contains(&own), law.term.states() > 0, "{}", law.term.id());
        }
    }

    #[test]
    fn a_coefficient_is_found_by_its_key_and_moves_to_other_units_by_its_dimension() {
        let (beta, film) = (&cubic_stiffness::GIVEN[0].key, &squeeze_film_damping::GIVEN[0].key);
        let laws = Coefficients::default().with(beta, 7.0).with(film, 5.0);
        assert_eq!((laws.of(beta), laws.of(film)), (7.0, 5.0));
        assert_eq!(laws.acting().count(), 2);
        // 1/(m² s): two new units of length and a tenth of a second each.
        let units = Units { y: 2.0, u: 1.0, s: 10.0 };
        let law = super::laws().iter().find(|l| l.given()[0].key.slot == film.slot).expect("it is listed");
        assert!((laws.values(law, &units)[0] - 5.0 / 4.0 / 10.0).abs() < 1e-15);
    }
}
