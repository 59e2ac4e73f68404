//! A filter in the sensor that takes the top of its band away. No physics left out: a finding, not a candidate.

use super::row::{NO_CANDIDATE, Row};
use crate::diagnosis::rest::cause::Cause;
use crate::diagnosis::rest::spectrum::Law;
use crate::numerics::special::chi_squared_above;

/// Powers of the cosine that are tried.
const POWERS: [u8; 3] = [1, 2, 4];

pub(super) const ROW: Row = Row {
    offer: |to| {
        if !to.is_open_to(Cause::BandLimit) {
            return Ok(Vec::new());
        }
        let powers = POWERS.map(|p| to.with_law(Cause::BandLimit, Law::Smoothed(p), f64::from(p)));
        let best = powers.into_iter().max_by(|a, b| a.log_likelihood().total_cmp(&b.log_likelihood()));
        Ok(best.into_iter().collect())
    },
    numbers: 1.0,
    chance: |gain, _| 1.5 * chi_squared_above(gain, 1.0),
    ..NO_CANDIDATE
};
