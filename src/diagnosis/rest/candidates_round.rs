//! One round of selection: every candidate that a model does not hold yet, each added to it.

use crate::control::{Control, Stopped};

use super::candidate::{OFFERED, Offer, row};
use super::channel::{Addition, Channel, Environment, Fitted};
use super::standing::{HeldOut, Standing, probability};

/// Every candidate tried against a model, and the model with the best of those wanted.
pub(super) struct Tried {
    pub(super) standings: Vec<Standing>,
    pub(super) best: Option<(Standing, Fitted)>,
}

/// Tries all. Only the best model `wanted` is kept: curves of a long recording are large.
///
/// # Errors
/// Stopped.
pub(super) fn try_all(
    channel: &Channel,
    current: &Fitted,
    environment: &Environment,
    control: &Control,
    wanted: impl Fn(&Standing) -> bool,
) -> Result<Tried, Stopped> {
    let held_out_before = current.held_out(&channel.promised);
    let mut tried = Tried { standings: Vec::new(), best: None };
    let offer = Offer { channel, current, environment, control };
    for cause in OFFERED {
        control.go_on()?;
        for fitted in (row(cause).offer)(&offer)? {
            let last = fitted.terms.len() - 1;
            let gain = fitted.gain_over(current, last);
            let held_out = match fitted.terms[last].addition {
                Addition::Law(_) => HeldOut::LogLikelihood(fitted.held_out(&channel.promised) - held_out_before),
                Addition::Curves(_) => HeldOut::MeanSquare(channel.held_out_share(&fitted, last)),
            };
            let standing = Standing { cause, gain, p_value: probability(cause, gain, channel), held_out };
            tried.standings.push(standing);
            if wanted(&standing) && tried.best.as_ref().is_none_or(|(best, _)| standing.minus_aic() > best.minus_aic())
            {
                tried.best = Some((standing, fitted));
            }
        }
    }
    Ok(tried)
}
