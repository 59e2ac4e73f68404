//! A filter in the sensor that takes the top of its band away. No physics left out: a finding, not
//! a candidate.
//!
//! The usual ones are offered: means of neighbours, moving averages (once, or twice as Bartlett's),
//! one pole, the same pole twice, two poles. The shape is chosen on the spectrum as the model so
//! far leaves it; the model with the best of them is then fitted as a whole.

use std::f64::consts::FRAC_PI_2;

use super::row::{NO_CANDIDATE, Offer, Row};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::Fitted;
use crate::rest::spectrum::{self, Filter, Law, Part};

/// Times that neighbours are averaged.
const SMOOTHINGS: [u8; 3] = [1, 2, 4];
/// Readings in a moving average.
const READINGS: [u16; 12] = [2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32];
/// Cut-offs that are tried, as parts of half the sampling rate; refined between them.
const CUTS: [f64; 9] = [0.06, 0.1, 0.16, 0.25, 0.35, 0.46, 0.58, 0.7, 0.85];
const QUALITIES: [f64; 3] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0];
/// Memories of one pole in samples; a longer one is a property of the bias (`gauss-markov`).
const POLES: [f64; 6] = [0.4, 0.7, 1.2, 2.0, 3.5, 6.0];
/// Halvings of the step between two of these.
const REFINEMENTS: u32 = 6;

pub(super) const ROW: Row = Row {
    offer: |to| {
        let open = to.is_open_to(Cause::BandLimit);
        let best = if open { best(to) } else { None };
        Ok(best.map(|filter| to.with_law(Cause::BandLimit, Law::Filtered(filter), 0.0)).into_iter().collect())
    },
    numbers: 2.0,
    // Moving averages, cut-offs and qualities that differ by more than chance.
    chance: |gain, _| 10.0 * chi_squared_survival(gain, 1.0),
    ..NO_CANDIDATE
};

/// Least part of the power at the highest frequency, under a memory with white noise next to it,
/// that is white: with less of it all that the sensor hands out has gone through the memory, which
/// is a filter then.
const BESIDE: f64 = 0.25;
/// Longest memory of a filter, in samples: next to a filter, one no longer than this belongs to its
/// shape.
pub(super) const LONGEST: f64 = 10.0;

/// Returns whether a fitted model takes a filter of one pole for a memory of the bias.
pub(super) fn is_one_pole(fitted: &Fitted, memory: f64) -> bool {
    let white = fitted.strengths.values[0];
    let last = fitted.variances.last().copied().unwrap_or(white);
    memory < LONGEST && white < BESIDE * last
}

/// The filter that describes best what the model so far leaves.
fn best(to: &Offer<'_>) -> Option<Filter> {
    let mut laws: Vec<Law> = to.current.laws();
    // A drift that the model does not hold yet must not bend the filter.
    if !laws.contains(&Law::Walk) {
        laws.push(Law::Walk);
    }
    let promised = &to.channel.promised;
    let score = |filter: &Filter| {
        let with: Vec<Law> = laws.iter().copied().chain([Law::Filtered(*filter)]).collect();
        let fit = spectrum::fit(&to.current.bins, &with, promised, Part::All);
        // One pole next to white noise is a memory of the bias, which has a name of its own.
        let beside = fit.values[0] > BESIDE * (fit.values[0] + fit.values.last()? * filter.power(FRAC_PI_2));
        (!beside || !matches!(filter, Filter::OnePole(_))).then_some((*filter, fit.log_likelihood))
    };
    let better = |a: &(Filter, f64), b: &(Filter, f64)| a.1.total_cmp(&b.1);
    let tangent = |part: f64| (part * FRAC_PI_2).tan();
    let smoothings = SMOOTHINGS.map(Filter::Smoothing);
    let averages = READINGS.map(|readings| [1, 2].map(|times| Filter::MovingAverage { readings, times }));
    let poles = POLES.map(|memory| [Filter::OnePole(memory), Filter::PoleTwice(memory)]);
    let pairs = CUTS.map(|part| QUALITIES.map(|quality| Filter::TwoPoles { cut: tangent(part), quality }));
    let all = smoothings
        .into_iter()
        .chain(averages.into_iter().flatten())
        .chain(poles.into_iter().flatten())
        .chain(pairs.into_iter().flatten());
    let mut best = all.filter_map(|f| score(&f)).max_by(better)?;
    let mut factor: f64 = 1.5;
    for _ in 0..REFINEMENTS {
        factor = factor.sqrt();
        let near = |by: f64| match best.0 {
            Filter::OnePole(memory) => vec![Filter::OnePole(memory * by)],
            Filter::PoleTwice(memory) => vec![Filter::PoleTwice(memory * by)],
            Filter::TwoPoles { cut, quality } => {
                vec![Filter::TwoPoles { cut: cut * by, quality }, Filter::TwoPoles { cut, quality: quality * by }]
            }
            Filter::Smoothing(_) | Filter::MovingAverage { .. } => Vec::new(),
        };
        let found = [factor, 1.0 / factor].into_iter().flat_map(near).filter_map(|f| score(&f)).max_by(better);
        if let Some(found) = found.filter(|f| better(f, &best).is_gt()) {
            best = found;
        }
    }
    Some(best.0)
}
