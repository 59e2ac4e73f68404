//! Predicts what a sensor's errors make of a window's end, once the biases are taken off that other
//! windows or a still stretch gave: mean and covariance, by the linear error model.
//!
//! Constants of the sensor are the same in the window and where its biases come from, so what is
//! taken off takes most of them along. Noise is another one in each window; the biases that were
//! fitted in it bring its share.

use nalgebra::Matrix6;

use super::bias::{Others, Source, Still, Taken, ToBias, at_end};
use super::linear::{Kind, Linear, Part};
use super::window::{Biases, Nine};
use crate::kernel::flicker;
use crate::strapdown::family::Gain;
use crate::strapdown::linear::{Felt, Square};

/// Expected end of a window.
#[derive(Debug, Clone, Copy)]
pub struct Expected {
    /// Mean of the nine errors at the end of the window, SI.
    pub mean: Nine,
    /// Covariance of the error.
    pub covariance: Square,
}

/// A window, and where its biases come from.
pub struct Place<'a> {
    /// Prediction of the linear model.
    pub linear: &'a Linear,
    /// The biases that are taken off.
    pub taken: &'a Taken,
    /// When it begins on the reference's clock, s.
    pub begin_s: f64,
    /// Number of readings in the window.
    pub samples: u64,
}

/// Adds up the parts of a sensor in a window; `in_base` gives the same parts in a base.
pub fn expected<'a>(place: &Place<'_>, parts: &[Part], in_base: impl Fn(usize) -> &'a [Part]) -> Expected {
    let mut all = Expected { mean: Nine::zeros(), covariance: Square::zeros() };
    for (number, part) in parts.iter().enumerate() {
        match part {
            Part::Constant { gain, end, mean, variance } => {
                let (net, apart) = net(place, *gain, end, |base| end_of(&in_base(base)[number]));
                all.mean += net * *mean;
                all.covariance += (net * net.transpose() + apart) * *variance;
            }
            Part::Noise { .. } => all.covariance += noise(place, part, |base| noise_of(&in_base(base)[number])),
        }
    }
    all
}

/// Covariance that one noise leaves at the end of a window.
pub fn noise(place: &Place<'_>, part: &Part, in_base: impl Fn(usize) -> Square) -> Square {
    let Part::Noise { kind, squares, end } = part else { return Square::zeros() };
    let taken = match &place.taken.source {
        Source::Others(others) => in_others(others, *kind, squares, in_base),
        Source::Still(still) => in_still(still, place, *kind, squares),
    };
    **end + at_end(&place.linear.to_end, &taken)
}

fn end_of(part: &Part) -> Nine {
    match part {
        Part::Constant { end, .. } => *end,
        Part::Noise { .. } => Nine::zeros(),
    }
}

fn noise_of(part: &Part) -> Square {
    match part {
        Part::Noise { end, .. } => **end,
        Part::Constant { .. } => Square::zeros(),
    }
}

/// Returns what is left of a constant per unit, and the covariance per unit of variance of what is
/// drawn anew for each flight.
fn net(place: &Place<'_>, gain: Gain, end: &Nine, in_base: impl Fn(usize) -> Nine) -> (Nine, Square) {
    let to_end = &place.linear.to_end;
    match &place.taken.source {
        Source::Still(still) => {
            let [force, rate] = still.standing;
            let felt = Felt { force, rate, ..Felt::default() };
            (end - to_end * gain.inputs(&felt, 0.0), Square::zeros())
        }
        Source::Others(others) => {
            let mean = others.bases.iter().map(|(base, to_bias)| to_bias * in_base(*base)).sum::<Biases>();
            let net = end - to_end * mean;
            // A bias is another one each time that the sensor is switched on.
            let apart = match (others.flights, gain) {
                (Some(flights), Gain::One(_)) => end * end.transpose() * (1.0 + 1.0 / flights as f64),
                _ => Square::zeros(),
            };
            (net, apart)
        }
    }
}

/// Covariance of the biases that other windows gave.
fn in_others(others: &Others, kind: Kind, squares: &[f64; 6], in_base: impl Fn(usize) -> Square) -> Matrix6<f64> {
    let of = |(base, to_bias): &(usize, ToBias)| to_bias * in_base(*base) * to_bias.transpose();
    let mut biases = others.bases.iter().map(of).sum::<Matrix6<f64>>() * others.excess;
    if kind == Kind::Walk {
        (0..6).for_each(|i| biases[(i, i)] += squares[i] * others.walked_s[i / 3]);
    }
    biases
}

/// Covariance of the biases that a still stretch gave.
fn in_still(still: &Still, place: &Place<'_>, kind: Kind, squares: &[f64; 6]) -> Matrix6<f64> {
    let seconds = still.seconds();
    let diagonal = |by: f64| Matrix6::from_diagonal(&(Biases::from(*squares) * by));
    match kind {
        Kind::White => diagonal(1.0 / seconds),
        // A mean over T lags the end of it by T/3 of variance.
        Kind::Walk if place.begin_s >= still.span_s[1] => diagonal(place.begin_s - still.span_s[1] + seconds / 3.0),
        Kind::Walk => diagonal((still.span_s[0] - place.begin_s).max(0.0) + seconds / 3.0),
        Kind::Flicker => {
            diagonal((0..flicker::terms(place.samples)).map(|term| flicker::amplitude(term).powi(2)).sum())
        }
        // A still stretch asks no reference where it is.
        Kind::Poses => Matrix6::zeros(),
        Kind::Attitude => {
            let mut biases = Matrix6::zeros();
            let levelled = still.levelled([squares[0], squares[1], squares[2]]);
            biases.fixed_view_mut::<3, 3>(0, 0).copy_from(&levelled);
            biases
        }
    }
}
