//! `temperature-sensitivity`: a bias that follows an environment column, or a cause that channels share.

use super::row::{Row, TITTERTON, signed};
use crate::diagnosis::candidate::{Candidate, Kind};
use crate::diagnosis::rest::cause::Cause;
use crate::diagnosis::rest::channel::{Addition, Curve, Term};
use crate::diagnosis::rest::estimate::straight;
use crate::numerics::special::chi_squared_above;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "temperature-sensitivity",
    kind: Kind::Static,
    statement: "The bias follows temperature, or another slow cause that channels share.",
    equation: "b = s (θ − θ̄)",
    parameters: &[signed("slope", "y per unit of the environment")],
    acts: "readout",
    signature: "Channels drift together; the drift follows an environment column.",
    confusable_with: &["random-walk"],
    reference: TITTERTON,
};

pub(super) const ROW: Row = Row {
    entry: Some(&CANDIDATE),
    // One model per column that the model does not follow yet.
    offer: |to| {
        let open = to.environment.iter().filter(|(name, _)| !to.current.terms.iter().any(|t| t.follows(name)));
        let with = |(name, column): &(String, Curve)| {
            to.with(Term {
                cause: Cause::TemperatureSensitivity,
                addition: Addition::Curves(vec![column.clone()]),
                searched: 0.0,
                column: Some(name.clone()),
            })
        };
        Ok(open.map(with).collect())
    },
    numbers: 1.0,
    chance: |gain, _| chi_squared_above(gain, 1.0),
    imitates: &[],
    is_drift: true,
    parameters: |of| {
        let column = of.term().column.clone().unwrap_or_else(|| "the common cause".into());
        let unit = format!("{} per unit of {column}", of.unit);
        vec![straight("slope", unit, of.channel.scale, of.fitted.amplitudes_of(of.index)[0])]
    },
};
