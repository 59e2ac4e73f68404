//! A channel and its model on means of neighbouring values: slow drift costs less to search there,
//! and looks the same.

use super::channel::{Addition, Channel, Curve, Term};
use super::spectrum::Law;

/// Means of as many neighbours.
pub(super) fn means(values: &[f64], together: usize) -> Vec<f64> {
    values.chunks_exact(together).map(|c| c.iter().sum::<f64>() / together as f64).collect()
}

/// The channel on means; without the rounding and the promise of its readings.
pub(super) fn channel(of: &Channel, values: &[f64], together: usize) -> Channel {
    Channel::new(&of.name, &means(values, together), of.rate_hz / together as f64)
}

/// A term on means; `None` for what averages out within a block.
pub(super) fn term(of: &Term, together: usize) -> Option<Term> {
    let addition = match &of.addition {
        Addition::Law(Law::Markov(memory)) => Addition::Law(Law::Markov(memory / together as f64)),
        Addition::Law(Law::Differenced | Law::Filtered(_)) if together > 1 => return None,
        Addition::Law(law) => Addition::Law(*law),
        Addition::Curves(curves) => {
            Addition::Curves(curves.iter().map(|c| Curve::new(means(&c.values, together))).collect())
        }
    };
    Some(Term { addition, ..of.clone() })
}
