//! An input that is moved in time because the output seems to follow it better so, until it is
//! known whether it does.

use super::data::Data;
use super::input::Input;
use super::notes::Notes;

/// An input that was moved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shift {
    /// Samples by which the output comes late; negative where it comes before the input.
    lag: isize,
    /// The input as it was recorded.
    recorded: Vec<f64>,
    clause: String,
}

impl Shift {
    /// Moves an input; the end that is left free gets its outermost value. `what` comes late or
    /// early, as the beginning of a clause.
    pub(super) fn of(input: &mut [f64], lag: isize, what: String) -> Self {
        let (n, recorded) = (input.len() as isize, input.to_vec());
        for (k, value) in input.iter_mut().enumerate() {
            *value = recorded[(k as isize - lag).clamp(0, n - 1) as usize];
        }
        let side = if lag > 0 { "late" } else { "early" };
        Self { lag, recorded, clause: format!("{what} {} samples {side}", lag.abs()) }
    }

    /// Samples by which the output seems to come late.
    pub(crate) fn lag_samples(&self) -> f64 {
        self.lag as f64
    }

    /// Reports that the input was moved.
    pub(crate) fn noted(&self, notes: &mut Notes) {
        notes.doubt(self.clause.clone(), "; the input was shifted by as many before fitting");
    }

    /// The recording with its input where it was.
    pub(crate) fn undone(&self, data: &Data) -> Data {
        let input = data.input.as_ref().map(|i| Input::new(self.recorded.clone(), i.interpolation));
        Data { input, ..data.clone() }
    }
}
