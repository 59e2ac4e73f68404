//! `temperature-sensitivity`: a bias that follows an environment column, or a cause that channels
//! share.

use super::row::{Row, TITTERTON, signed, size};
use crate::candidate::{Candidate, Kind};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::{Addition, Curve, Term};
use crate::rest::estimate::straight;
use crate::rest::followed::{Delay, Followed};
use crate::rest::profile::Profiled;
use crate::verdict::Estimate;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "temperature-sensitivity",
    kind: Kind::Static,
    statement: "The bias follows temperature, or another slow cause that channels share.",
    equation: "b = s (θ − θ̄), with a square and a cube, a lag or play where the data show them",
    parameters: &[
        signed("slope", "y per unit of the environment"),
        signed("square", "y per squared unit"),
        signed("cube", "y per cubed unit"),
        size("lag", "s"),
        size("play", "half width, unit of the environment"),
    ],
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
                column: Some(Followed::straight(name)),
            })
        };
        Ok(open.map(with).collect())
    },
    numbers: 1.0,
    chance: |gain, _| chi_squared_survival(gain, 1.0),
    imitates: &[],
    is_drift: true,
    parameters: |of| {
        let followed = of.term().column.clone().unwrap_or_else(|| Followed::straight("the common cause"));
        let Followed { column, delay, unit, powers } = followed;
        let power = |(p, amplitude): (&i32, &(f64, f64))| {
            let (name, of_column) = match p {
                1 => ("slope", "unit"),
                2 => ("square", "squared unit"),
                _ => ("cube", "cubed unit"),
            };
            let factor = of.channel.scale / unit.powi(*p);
            straight(name, format!("{} per {of_column} of {column}", of.channel.unit), factor, *amplitude)
        };
        let step_s = 1.0 / of.channel.rate_hz;
        let late = |Profiled { value, ci95 }| Estimate {
            name: "lag".into(),
            value: value * step_s,
            unit: "s".into(),
            ci95: ci95.map(|v| v * step_s),
        };
        let loose =
            |Profiled { value, ci95 }| Estimate { name: "play".into(), value, unit: format!("unit of {column}"), ci95 };
        let delay = match delay {
            Delay::None => Vec::new(),
            Delay::Lag(lag) => vec![late(lag)],
            Delay::Play(play) => vec![loose(play)],
            Delay::LagAndPlay(lag, play) => vec![late(lag), loose(play)],
        };
        powers.iter().zip(of.fitted.amplitudes_of(of.index)).map(power).chain(delay).collect()
    },
};
