//! Notes on a recording apart from its physics.

use crate::driven::base::ZETAS;
use crate::verdict::Estimate;

use super::data::Data;
use super::defects;
use super::input::Input;

/// Reason why input and output do not belong together as they stand. No candidate is tried then.
#[derive(Debug, Clone, PartialEq)]
pub enum Broken {
    /// The input responds to the output as an oscillator responds to a force.
    Exchanged {
        /// Heading of the input column.
        input: String,
        /// Heading of the output column.
        output: String,
    },
    /// One of them changes its size from a row on.
    Rescaled {
        /// Heading of the input column.
        input: String,
        /// Heading of the output column.
        output: String,
        /// Row at which it changes.
        row: usize,
        /// Size of the output over that of the input after this row, over that before.
        factor: f64,
    },
}

/// Findings about the recording, apart from its physics.
#[derive(Debug, Clone, Default)]
pub struct Notes {
    /// Findings, one sentence each.
    pub findings: Vec<String>,
    /// Doubts that a reader of the verdict must know, as clauses.
    pub doubts: Vec<String>,
    /// Reason why the columns do not belong together as they stand, so that no physics may be
    /// blamed; `None` if they do.
    pub broken: Option<Broken>,
    /// States how the reading depends on its input without a linear law that can be seen, as a
    /// clause; a doubt only where the base model bears it out.
    pub bent: Option<String>,
    /// Samples at which the reading jumps; only worth a word where the final model does not predict
    /// it.
    pub jumps: Vec<usize>,
}

impl Notes {
    /// Reports those of the jumps in the reading at which a model with these errors over
    /// `data.hull` jumps too.
    pub fn report_jumps(&mut self, data: &Data, errors: &[f64]) {
        let input = data.input.as_ref().map(Input::samples);
        let clause = match defects::unpredicted(&self.jumps, input, errors, &data.hull).as_slice() {
            [] => return,
            [only] => format!("the reading jumps in row {only}"),
            places @ [first, ..] => format!("the reading jumps {} times, first in row {first}", places.len()),
        };
        let more = ", which neither its own past nor the input nor the model predicts: lost or repeated samples, or a \
                    knock? A time column would tell";
        self.doubt(clause, more);
    }

    /// Says of an oscillation that may not decay, by its base model's numbers, what else it may be.
    pub fn may_be_steady(&mut self, base: &[Estimate]) {
        // A tenth of the value is where ± 90 % of it ends; so does the least damping that a fit reaches, where the value
        // is hardly known. A light damping that is known well stands below that one.
        let is_steady = |number: &Estimate| {
            let ([low, high], value) = (number.ci95, number.value);
            number.name == "zeta" && (low <= 0.1 * value || (low <= ZETAS[0] && high - low > value))
        };
        if base.iter().any(is_steady) {
            let clause = "the damping may be none at all; a sensor at rest that picks up hum or vibration shows such a line \
                          too, and is diagnosed with kind = \"static\"";
            self.doubt(clause.to_owned(), "");
        }
    }

    /// Something that a reader of the verdict must know: as a clause, and with what follows from
    /// it.
    pub fn doubt(&mut self, clause: String, more: &str) {
        self.findings.push(format!("{clause}{more}"));
        self.doubts.push(clause);
    }
}
