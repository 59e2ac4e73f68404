//! `quantisation-noise`: rounding, of the reading or of an integral that is differenced.

use super::row::{Row, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::estimate::root;
use crate::rest::spectrum::Law;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "quantisation-noise",
    kind: Kind::Static,
    statement: "The reading is rounded to a step as coarse as its noise.",
    equation: "y = q·round(x/q)",
    parameters: &[size("step", "y")],
    acts: "readout",
    signature: "All values lie on a grid; rounding adds q²/12 to the variance.",
    confusable_with: &["white-noise"],
    reference: "Widrow & Kollár, Quantization Noise, Cambridge 2008",
};

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    // Noise that rises with f² is the rounding of an integral that is differenced only where the
    // readings lie on the grid that this rounding makes; a filter, or a hump near the top of the
    // band, rises too.
    offer: |to| {
        let Some(step) = to.channel.step.filter(|_| to.channel.together == 1) else { return Ok(Vec::new()) };
        let mut found = to.law(Cause::QuantisationNoise, Law::Differenced)?;
        found.retain(|f| {
            let rounding = 12.0 * f.strength_of(f.terms.len() - 1).0;
            (0.5..2.0).contains(&(rounding / (step * step)))
        });
        Ok(found)
    },
    numbers: 1.0,
    chance: |gain, _| 0.5 * chi_squared_survival(gain, 1.0),
    imitates: &[],
    is_drift: false,
    parameters: |of| {
        let factor = of.channel.scale * (1.0 / of.channel.rate_hz);
        vec![root("Q", format!("{}·s", of.channel.unit), factor, of.fitted.strength_of(of.index))]
    },
};
