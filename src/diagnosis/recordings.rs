//! The recordings of one sensor that a diagnosis is given: those that are fitted together, and
//! those that only judge.

use crate::error::{Error, Result};
use crate::recording::Recording;

/// Recordings of one sensor, in the order given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recordings<'a> {
    /// Fitted, each with its own initial state and offset; at least one.
    pub train: &'a [Recording],
    /// Recordings used for validation only.
    pub test: &'a [Recording],
}

impl<'a> Recordings<'a> {
    /// A single recording, without others for validation.
    pub fn one(recording: &'a Recording) -> Self {
        Self { train: std::slice::from_ref(recording), test: &[] }
    }

    /// The only recording, where there is but one.
    pub fn only(&self) -> Option<&'a Recording> {
        match (self.train, self.test) {
            ([only], []) => Some(only),
            _ => None,
        }
    }

    /// Fitted recordings first, then those for validation.
    pub fn all(&self) -> impl Iterator<Item = &'a Recording> {
        self.train.iter().chain(self.test)
    }

    /// Checks that no recording is part of another: what was fitted can't judge, and what is fitted
    /// twice seems twice as certain.
    ///
    /// # Errors
    /// Names both recordings and the row at which one begins in the other.
    pub fn check_distinct(&self) -> Result<()> {
        let all: Vec<&Recording> = self.all().collect();
        for (place, later) in all.iter().enumerate() {
            for earlier in &all[..place] {
                let (short, long) = if samples(later) < samples(earlier) { (later, earlier) } else { (earlier, later) };
                if let Some(row) = found_in(long, short) {
                    let [short, long, later] = [short, long, later].map(|r| r.path.display());
                    let hint = match place < self.train.len() {
                        true => "give each recording once",
                        false => {
                            "give --test a recording that is not fitted; without --test, a part of each is held out by itself"
                        }
                    };
                    let cause = format!("every row of {short} is also in {long}, from row {row} on");
                    return Err(Error::new(format!("could not use {later} with the other recordings"), cause, hint));
                }
            }
        }
        Ok(())
    }
}

fn samples(recording: &Recording) -> usize {
    recording.columns.first().map_or(0, |column| column.values.len())
}

/// Finds the row of `long` from which all rows of `short` stand in it (Knuth, Morris and Pratt:
/// linear in their length, whatever repeats).
fn found_in(long: &Recording, short: &Recording) -> Option<usize> {
    let is_same = |a: &Recording, i: usize, k: usize| {
        a.columns.len() == short.columns.len()
            && a.columns.iter().zip(&short.columns).all(|(a, b)| a.values[i].to_bits() == b.values[k].to_bits())
    };
    let rows = samples(short);
    // For each count of rows that agree, how many still do once the next one does not.
    let mut fallback = vec![0; rows];
    let mut agreed = 0;
    for i in 1..rows {
        while agreed > 0 && !is_same(short, i, agreed) {
            agreed = fallback[agreed - 1];
        }
        agreed += usize::from(is_same(short, i, agreed));
        fallback[i] = agreed;
    }
    agreed = 0;
    for i in 0..samples(long) {
        while agreed > 0 && !is_same(long, i, agreed) {
            agreed = fallback[agreed - 1];
        }
        agreed += usize::from(is_same(long, i, agreed));
        if agreed == rows && rows > 0 {
            return Some(i + 1 - rows);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Column;

    fn recording(path: &str, values: &[f64]) -> Recording {
        let columns = vec![Column { name: "x".into(), values: values.to_vec() }];
        Recording { path: path.into(), columns, ..Recording::default() }
    }

    #[test]
    fn a_recording_that_is_part_of_another_is_refused_wherever_it_begins() {
        let whole: Vec<f64> = (0..200).map(|k| f64::from(k * k % 37)).collect();
        let log = recording("log.csv", &whole);
        // Sequences with repeats, by the definition: windows compared one by one.
        for (from, to) in [(0, 200), (0, 50), (90, 140), (150, 200), (37, 38)] {
            let part = recording("part.csv", &whole[from..to]);
            let first = whole.windows(to - from).position(|w| *w == whole[from..to]);
            assert_eq!(found_in(&log, &part), first);
            for (train, test) in [(&log, &part), (&part, &log)] {
                let given = Recordings { train: std::slice::from_ref(train), test: std::slice::from_ref(test) };
                let refused = given.check_distinct().expect_err("part of the other").to_string();
                assert!(refused.contains("part.csv is also in log.csv") || from == 0 && to == 200, "{refused}");
                assert!(refused.contains("not fitted"), "{refused}");
            }
        }
        let twice = [log.clone(), log.clone()];
        let refused = Recordings { train: &twice, test: &[] }.check_distinct().expect_err("given twice").to_string();
        assert!(refused.contains("give each recording once"), "{refused}");
        // Controls: one reading differs in its last digit; another sensor.
        let mut other = whole[90..140].to_vec();
        other[49] += 1e-9;
        let other = recording("other.csv", &other);
        assert_eq!(found_in(&log, &other), None);
        assert!(Recordings { train: &[log], test: &[other] }.check_distinct().is_ok());
    }
}
