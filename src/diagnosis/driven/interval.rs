//! How sure a fitted parameter is: its covariance from the innovations, and again from the scatter between blocks, which
//! holds where the innovations are not quite white. The wider of the two is stated.

use nalgebra::DMatrix;

use crate::numerics::special;

use super::fit::Fit;

/// Blocks whose scores are summed apart.
const BLOCKS: usize = 32;

/// Standard deviations of the coordinates of the free parameters, and the same for each block's own wish to move them.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Standard deviation of each free parameter's coordinate.
    pub deviation: Vec<f64>,
    /// Correlation of the free parameters' coordinates.
    pub correlation: DMatrix<f64>,
    /// How much more the blocks disagree than their own noise explains, per free parameter: 1 when they agree.
    pub overdispersion: Vec<f64>,
}

/// Both estimates of a fit's covariance (White 1980; Liang & Zeger 1986 for the blocks).
pub fn spread(fit: &Fit) -> Spread {
    let parameters = fit.free.len();
    let unknown = Spread {
        deviation: vec![f64::INFINITY; parameters],
        correlation: DMatrix::identity(parameters, parameters),
        overdispersion: vec![1.0; parameters],
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
    let deviation: Vec<f64> =
        (0..parameters).map(|i| (fit.variance * inverse[(i, i)]).max(clustered[(i, i)]).max(0.0).sqrt()).collect();
    let overdispersion = (0..parameters)
        .map(|i| (clustered[(i, i)] / (fit.variance * inverse[(i, i)]).max(1e-300)).max(0.0).sqrt())
        .collect();
    let correlation = DMatrix::from_fn(parameters, parameters, |i, j| {
        inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).max(1e-300).sqrt()
    });
    Spread { deviation, correlation, overdispersion }
}

/// Half-width of a 95 % interval in standard deviations; Student's, as the blocks are few.
pub fn reach() -> f64 {
    special::t_quantile(0.975, BLOCKS as f64 - 1.0)
}
