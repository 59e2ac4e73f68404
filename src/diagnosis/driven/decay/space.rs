//! The laws that a decay may follow beside the base model: the library's, and free forms of their
//! arguments.

use crate::engine::kind::{Argument, Form};
use crate::physics::end_stop::{EndStop, Side};
use crate::physics::free_form::{Extent, FreeForm, Freed};
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::power::Exponent;
use crate::physics::power_law_damping::PowerLawDamping;
use crate::physics::power_law_stiffness::PowerLawStiffness;
use crate::physics::scales::Scales;
use crate::physics::stiffness_drift::StiffnessDrift;

/// A law of the space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Member {
    /// The law.
    pub term: Term,
    /// Its use in the search.
    pub form: Form,
}

/// All laws that a decay with this many environment columns is tried against.
pub(super) fn members(environments: usize, scales: &Scales) -> Vec<Member> {
    // The start of each segment is free, so that what is linear beside the mass does not show: a
    // low-pass changes size and phase of the motion and nothing else.
    let shows = |t: &Term| {
        t.noise().is_none()
            && !matches!(t.role(), Role::LowPass | Role::Lattice)
            && !matches!(t, Term::ReadoutSaturation(_) | Term::ForceNoise(_))
    };
    let mut terms: Vec<Term> = Term::tried(environments, false).into_iter().filter(shows).collect();
    for side in [Side::Both, Side::Upper, Side::Lower] {
        let stop = Term::EndStop(EndStop(side));
        if !terms.contains(&stop) {
            terms.push(stop);
        }
    }
    let stated = terms.into_iter().map(|term| Member { term, form: Form::Stated });
    let powers = [
        Term::PowerLawStiffness(PowerLawStiffness(Exponent::Free)),
        Term::PowerLawDamping(PowerLawDamping(Exponent::Free)),
    ]
    .map(|term| Member { term, form: Form::Exponent });
    let speed = 2.0 * scales.velocity;
    let free = |law: Freed, size: f64| Member {
        term: Term::FreeForm(FreeForm { law, size, extent: Extent::Wide }),
        form: Form::Free,
    };
    let size = 2.0 * scales.output;
    let forms = [
        free(Freed::CubicSpring, size),
        free(Freed::QuadraticSpring, size),
        free(Freed::Drag, speed),
        free(Freed::Friction, speed),
        free(Freed::Film, size),
        free(Freed::Drift, scales.duration_s),
    ];
    stated.chain(powers).chain(forms).collect()
}

/// Quantity that a law depends on.
pub(super) fn argument(term: &Term) -> Argument {
    match term {
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) | Term::CoulombFriction(_) => Argument::Velocity,
        Term::SqueezeFilmDamping(_) => Argument::Both,
        Term::Hysteresis(_) => Argument::Path,
        Term::StiffnessDrift(StiffnessDrift { environment: Some(_) }) => Argument::Environment,
        Term::StiffnessDrift(_) | Term::BiasDrift(_) | Term::WarmUp(_) => Argument::Time,
        Term::ReadoutNonlinearity(_) => Argument::Readout,
        Term::CoupledMode(_) | Term::ParasiticMode(_) | Term::PeriodicDisturbance(_) => Argument::Frequency,
        Term::FreeForm(form) => match form.law {
            Freed::Drag | Freed::Friction => Argument::Velocity,
            Freed::Film => Argument::Both,
            Freed::Drift => Argument::Time,
            Freed::Readout => Argument::Readout,
            _ => Argument::Displacement,
        },
        _ => Argument::Displacement,
    }
}

/// Whether two laws are forms of one another, of which a set holds at most one.
pub(super) fn excludes(one: &Term, other: &Term) -> bool {
    let group = |t: &Term| match t {
        Term::CubicStiffness(_) | Term::PowerLawStiffness(_) => 1,
        Term::FreeForm(form) => match form.law {
            Freed::CubicSpring => 1,
            Freed::Drag => 2,
            Freed::Film => 3,
            Freed::Friction => 4,
            Freed::Drift => 5,
            Freed::QuadraticSpring => 6,
            _ => 0,
        },
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) => 2,
        Term::SqueezeFilmDamping(_) => 3,
        Term::CoulombFriction(_) => 4,
        Term::StiffnessDrift(_) => 5,
        Term::QuadraticStiffness(_) => 6,
        Term::EndStop(_) => 7,
        _ => 0,
    };
    one.id() == other.id() || (group(one) != 0 && group(one) == group(other))
}
