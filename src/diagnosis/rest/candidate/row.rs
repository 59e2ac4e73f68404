//! States what a file of the library tells of its candidate, and the model that candidates are
//! offered to.

use crate::candidate::{Candidate, Parameter};
use crate::control::{Control, Stopped};
use crate::numerics::special::chi_squared_survival;
use crate::rest::cause::Cause;
use crate::rest::channel::{Addition, Channel, Curve, Environment, Fitted, Term};
use crate::rest::spectrum::Law;
use crate::verdict::Estimate;

/// Laws next to white noise that one spectrum can tell apart.
pub(in crate::rest) const MOST_LAWS: usize = 4;

/// All that the selection and the verdict ask of a cause.
pub(in crate::rest) struct Row {
    /// Holds what the library says; `None` for what is no physics left out.
    pub(in crate::rest) entry: Option<&'static Candidate>,
    /// The models with it, each at its best: none where it cannot be added, several where there are
    /// several columns.
    pub(in crate::rest) offer: fn(&Offer<'_>) -> Result<Vec<Fitted>, Stopped>,
    /// Free numbers, searched ones included.
    pub(in crate::rest) numbers: f64,
    /// Probability of at least this gain (twice the log-likelihood) by chance, for this many
    /// samples. A variance at its wall counts half (Self & Liang 1987); a searched number
    /// multiplies by the independent places it was searched at.
    pub(in crate::rest) chance: fn(gain: f64, samples: f64) -> f64,
    /// Simpler causes that it imitates at the edge of its range: those are preferred.
    pub(in crate::rest) imitates: &'static [Cause],
    /// States whether it moves the bias slowly.
    pub(in crate::rest) is_drift: bool,
    /// Its parameters as the library names them, in file units.
    pub(in crate::rest) parameters: fn(&Placed<'_>) -> Vec<Estimate>,
}

/// A cause that is never offered: a check on others.
pub(super) const NO_CANDIDATE: Row = Row {
    entry: None,
    offer: |_| Ok(Vec::new()),
    numbers: 2.0,
    chance: |_, _| 1.0,
    imitates: &[],
    is_drift: false,
    parameters: |_| Vec::new(),
};

/// A jump: its size, and its place among the samples.
pub(in crate::rest) const JUMP: Row =
    Row { chance: |gain, samples| samples * chi_squared_survival(gain, 1.0), ..NO_CANDIDATE };

/// A model to which candidates are offered.
pub(in crate::rest) struct Offer<'a> {
    pub(in crate::rest) channel: &'a Channel,
    pub(in crate::rest) current: &'a Fitted,
    pub(in crate::rest) environment: &'a Environment,
    pub(in crate::rest) control: &'a Control,
}

impl Offer<'_> {
    pub(super) fn samples(&self) -> usize {
        self.channel.values.len()
    }

    /// The model with one term more.
    pub(super) fn with(&self, term: Term) -> Fitted {
        let mut terms = self.current.terms.clone();
        terms.push(term);
        self.channel.fit(terms)
    }

    pub(super) fn with_curves(&self, cause: Cause, curves: Vec<Curve>, searched: f64) -> Fitted {
        self.with(Term { cause, addition: Addition::Curves(curves), searched, column: None })
    }

    pub(super) fn with_law(&self, cause: Cause, law: Law, searched: f64) -> Fitted {
        self.with(Term { cause, addition: Addition::Law(law), searched, column: None })
    }

    /// Returns whether a law can be added: it is not there yet, and there is room for one.
    pub(super) fn is_open_to(&self, law: Cause) -> bool {
        self.current.laws().len() <= MOST_LAWS && !self.current.has(law)
    }

    /// The model with a law that has no number but its strength.
    pub(super) fn law(&self, cause: Cause, law: Law) -> Result<Vec<Fitted>, Stopped> {
        Ok(if self.is_open_to(cause) { vec![self.with_law(cause, law, 0.0)] } else { Vec::new() })
    }
}

/// A term in its model, to be described.
pub(in crate::rest) struct Placed<'a> {
    pub(in crate::rest) channel: &'a Channel,
    pub(in crate::rest) fitted: &'a Fitted,
    /// Among the model's terms.
    pub(in crate::rest) index: usize,
}

impl Placed<'_> {
    pub(super) fn term(&self) -> &Term {
        &self.fitted.terms[self.index]
    }
}

pub(super) const fn size(name: &'static str, unit: &'static str) -> Parameter {
    Parameter { name, unit, range: (0.0, f64::MAX) }
}

pub(super) const fn signed(name: &'static str, unit: &'static str) -> Parameter {
    Parameter { name, unit, range: (f64::MIN, f64::MAX) }
}

pub(super) const IEEE: &str = "IEEE Std 952-1997 (R2008), annex C";
pub(super) const TITTERTON: &str = "Titterton & Weston, Strapdown Inertial Navigation Technology, 2nd ed., IET 2004";
