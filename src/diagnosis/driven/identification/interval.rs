//! States the uncertainty of a fitted parameter: its covariance from the innovations, and again
//! from the scatter between blocks, which holds where the innovations are not quite white; the
//! wider of the two is stated. Where a law has a corner the misfit is no parabola, and the interval
//! is that of the profile likelihood.

use nalgebra::DMatrix;

use crate::driven::intake::data::Data;
use crate::numerics::least_squares::Residuals;
use crate::numerics::special;
use crate::parallel;
use crate::physics::scales::Scales;

use super::fit::{Fit, Search};

/// Blocks whose scores are summed apart.
const BLOCKS: usize = 32;
/// Places tried on one side of a profile.
const PLACES: usize = 4;
/// A place this near to the level, in half-widths of the interval, is on it.
const CLOSE: f64 = 0.1;
/// Iterations of the other parameters at one place.
const ITERATIONS: usize = 4;

/// Uncertainty of the coordinates of the free parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Standard deviation of each free parameter's coordinate.
    pub deviation: Vec<f64>,
    /// Correlation of the free parameters' coordinates.
    pub correlation: DMatrix<f64>,
    /// Distance that the 95 % interval reaches down and up from each coordinate.
    pub reach: Vec<[f64; 2]>,
    /// Factor in variance by which blocks disagree more than their own noise explains, per free
    /// parameter; at least 1.
    pub dispersion: Vec<f64>,
}

/// Both estimates of a fit's covariance (White 1980; Liang & Zeger 1986 for the blocks).
pub fn spread(fit: &Fit) -> Spread {
    let parameters = fit.free.len();
    let unknown = Spread {
        deviation: vec![f64::INFINITY; parameters],
        correlation: DMatrix::identity(parameters, parameters),
        reach: vec![[f64::INFINITY; 2]; parameters],
        dispersion: vec![1.0; parameters],
    };
    let normal = fit.linear.normal();
    let Some(inverse) = normal.inverse(0.0) else { return unknown };
    let rows = fit.linear.residual.len();
    let mut scores = DMatrix::zeros(parameters, parameters);
    for b in 0..BLOCKS {
        let (from, to) = (rows * b / BLOCKS, rows * (b + 1) / BLOCKS);
        let score: Vec<f64> = fit
            .linear
            .columns
            .iter()
            .map(|c| c[from..to].iter().zip(&fit.linear.residual[from..to]).map(|(c, e)| c * e).sum())
            .collect();
        for i in 0..parameters {
            for j in 0..parameters {
                scores[(i, j)] += score[i] * score[j];
            }
        }
    }
    let small = BLOCKS as f64 / (BLOCKS as f64 - 1.0);
    let clustered = &inverse * scores * &inverse * small;
    let plain: Vec<f64> = (0..parameters).map(|i| (fit.variance * inverse[(i, i)]).max(0.0)).collect();
    let dispersion: Vec<f64> = (0..parameters).map(|i| (clustered[(i, i)] / plain[i].max(1e-300)).max(1.0)).collect();
    let deviation: Vec<f64> = plain.iter().zip(&dispersion).map(|(v, d)| (v * d).sqrt()).collect();
    let correlation = DMatrix::from_fn(parameters, parameters, |i, j| {
        inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).max(1e-300).sqrt()
    });
    let reach = deviation.iter().map(|d| [reach() * d; 2]).collect();
    Spread { deviation, correlation, reach, dispersion }
}

/// Half-width of a 95 % interval in standard deviations; Student's, as the blocks are few.
pub(crate) fn reach() -> f64 {
    special::t_quantile(0.975, BLOCKS as f64 - 1.0)
}

/// Replaces the intervals of these terms, whose law has a corner, by those of their profile
/// likelihood.
pub(crate) fn profiled(data: &Data, fit: &Fit, scales: &Scales, terms: &[usize], spread: &mut Spread) {
    let places: Vec<(usize, usize)> = terms
        .iter()
        .flat_map(|i| {
            (0..fit.structure.terms[*i].candidate().parameters.len()).map(move |j| fit.structure.first[*i] + j)
        })
        .filter_map(|place| Some((place, fit.free.iter().position(|f| *f == place)?)))
        .filter(|(_, index)| spread.deviation[*index].is_finite())
        .flat_map(|(_, index)| [(index, 0), (index, 1)])
        .collect();
    let found: Vec<f64> =
        parallel::map(&places, |(index, side)| side_of_profile(data, fit, scales, spread, *index, *side));
    for ((index, side), reach) in places.into_iter().zip(found) {
        spread.reach[index][side] = reach;
    }
}

/// Returns how far from the best value a coordinate can be held before the others, fitted anew,
/// leave a deviance of the 95 % level.
fn side_of_profile(data: &Data, fit: &Fit, scales: &Scales, spread: &Spread, index: usize, side: usize) -> f64 {
    let begin = || {
        let mut search = Search::all(data, &fit.structure, &fit.point, scales);
        search.run.steps = fit.steps;
        search
    };
    let (all, mut others) = (begin(), begin());
    others.free.remove(index);
    let best = all.z(&fit.point);
    let (least, sign) = (fit.variance * fit.linear.residual.len() as f64, if side == 0 { -1.0 } else { 1.0 });
    let unit = fit.variance * spread.dispersion[index] * self::reach().powi(2);
    let mut reach = spread.reach[index][side];
    // Along the ridge of the covariance, where the others would follow if the misfit were a
    // parabola; then along where the last place led them.
    let mut slopes: Vec<f64> = (0..best.len())
        .map(|i| sign * spread.correlation[(i, index)] * spread.deviation[i] / spread.deviation[index].max(1e-300))
        .collect();
    slopes[index] = sign;
    for _ in 0..PLACES {
        let mut z: Vec<f64> = best.iter().zip(&slopes).map(|(z, slope)| z + slope * reach).collect();
        all.confine(&mut z);
        others.point = all.point(&z);
        let Some(found) = others.minimise(ITERATIONS) else { break };
        let places = (0..best.len()).filter(|i| *i != index);
        places.zip(&found.z).for_each(|(i, z)| slopes[i] = (z - best[i]) / reach);
        // How many times the level the deviance is, as a ratio of distances.
        let ratio = ((found.sum - least).max(0.0) / unit).sqrt();
        reach *= (1.0 / ratio.max(1e-3)).clamp(0.3, 3.0);
        if (ratio - 1.0).abs() < CLOSE {
            break;
        }
    }
    reach
}
