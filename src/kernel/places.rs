//! Columns of the members' numbers on a device: one for each number that some member has, and one
//! that all share which every member lacks.
//!
//! A member has some fifty numbers, of which a study uses a dozen: sent one by one, the others take
//! most of the time that a large ensemble needs to reach a card.

use crate::member::{COLUMNS, NOTHING};

/// Columns on a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Places {
    /// The column of each number.
    of: [usize; COLUMNS],
    /// The number that each column shows.
    shown: Vec<usize>,
}

impl Places {
    /// Columns of members of which some have the numbers that are `present`.
    pub fn of(present: &[bool; COLUMNS]) -> Self {
        let (mut of, mut shown) = ([0; COLUMNS], Vec::<usize>::new());
        for number in 0..COLUMNS {
            let shared = |column: &&usize| !present[**column] && NOTHING[**column] == NOTHING[number];
            let column = shown.iter().find(shared).filter(|_| !present[number]).map(|&like| of[like]);
            of[number] = column.unwrap_or(shown.len());
            shown.extend(column.is_none().then_some(number));
        }
        Self { of, shown }
    }

    /// Columns of members that have all numbers.
    pub fn all() -> Self {
        Self::of(&[true; COLUMNS])
    }

    /// Returns the number that each column shows, in their order.
    pub fn shown(&self) -> &[usize] {
        &self.shown
    }

    /// Returns the column of a number.
    pub fn column(&self, number: usize) -> usize {
        self.of[number]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::member::column;

    #[test]
    fn what_no_member_has_shares_a_column_by_its_value_and_all_else_has_its_own() {
        assert_eq!(Places::all().shown(), (0..COLUMNS).collect::<Vec<_>>());
        let mut present = [false; COLUMNS];
        (present[column::BIAS], present[column::GYRO_BIAS]) = (true, true);
        let places = Places::of(&present);
        // The two, a column of zeros and one of the range of a member that has none.
        assert_eq!(places.shown().len(), 4);
        for number in 0..COLUMNS {
            let shown = places.shown()[places.column(number)];
            if present[number] {
                assert_eq!(shown, number);
            } else {
                assert!(!present[shown] && NOTHING[shown] == NOTHING[number], "{number}");
            }
        }
    }
}
