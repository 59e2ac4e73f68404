//! Terms of a model as a pass needs them: with their values, and the places of their states.

use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::state::{LANES, Lanes, MOST_STAGED, MOST_VALUES, Values};

/// Most own states of all terms of a model together: those that move the mass, three modes, and a filter of two poles.
pub(super) const MOST_STATES: usize = MOST_STAGED + 3 * 2 + 2;

/// A term, its values and where its states begin.
#[repr(C, align(64))]
pub(super) struct Mover<'a> {
    /// Its values, with those of the first recording where it has some of each.
    pub values: Values<f64, LANES>,
    /// The term.
    pub term: &'a Term,
    /// Way in which it acts.
    pub role: Role,
    /// Index of its first value among those of all terms.
    pub first: usize,
    /// Index of its first state among those of all terms.
    pub state: usize,
}

/// Returns whether a pass has room for the own states of these terms.
pub(in crate::driven) fn have_room(terms: &[Term]) -> bool {
    let [moving, others] = [true, false].map(|moves| {
        let own = terms.iter().filter(|t| t.role().acts_on_mass() == moves);
        own.map(|t| t.states()).sum::<usize>()
    });
    moving <= MOST_STAGED && others <= MOST_STATES - MOST_STAGED
}

/// Terms in their order; those that move the mass have the first states.
pub(super) fn movers<'a>(terms: &'a [Term], first: &[usize], parameters: &[Lanes]) -> Vec<Mover<'a>> {
    let mut next = [0, MOST_STAGED];
    let mut all = Vec::new();
    for (term, first) in terms.iter().zip(first) {
        let (next, end) =
            if term.role().acts_on_mass() { (&mut next[0], MOST_STAGED) } else { (&mut next[1], MOST_STATES) };
        if *next + term.states() <= end {
            let mut values = [[0.0; LANES]; MOST_VALUES];
            values.iter_mut().zip(&parameters[*first..]).take(term.values()).for_each(|(row, p)| *row = *p);
            all.push(Mover { term, role: term.role(), first: *first, values, state: *next });
            *next += term.states();
        }
    }
    all
}
