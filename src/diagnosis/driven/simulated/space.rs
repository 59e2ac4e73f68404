//! Lists the laws that a proof mass may follow in addition to the base model: the library's, and
//! free forms of their arguments.

use crate::engine::kind::{Argument, Form};
use crate::physics::asymmetric_stiffness::AsymmetricStiffness;
use crate::physics::bias_drift::{BiasDrift, Course};
use crate::physics::coupled_mode::CoupledMode;
use crate::physics::end_stop::{EndStop, Side};
use crate::physics::free_form::{Extent, FreeForm, Freed};
use crate::physics::hysteresis::{Hysteresis, Sharpness};
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::parasitic_mode::ParasiticMode;
use crate::physics::periodic_disturbance::PeriodicDisturbance;
use crate::physics::power::Exponent;
use crate::physics::power_law_damping::PowerLawDamping;
use crate::physics::power_law_stiffness::PowerLawStiffness;
use crate::physics::pumped_stiffness::PumpedStiffness;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::ringing_mode::RingingMode;
use crate::physics::scales::Scales;
use crate::physics::shaped_friction::{Shape, ShapedFriction};
use crate::physics::stiffness_drift::StiffnessDrift;

/// A law of the space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::driven) struct Member {
    /// The law.
    pub term: Term,
    /// Its use in the search.
    pub form: Form,
}

/// All laws that a recording with this many environment columns, of a mass that an input drives or
/// not, is tried against.
pub(in crate::driven) fn members(environments: usize, is_driven: bool, scales: &Scales) -> Vec<Member> {
    // Of a decay the start of each segment is free, so that what is linear next to the mass does
    // not show: a low-pass changes size and phase of the motion and nothing else.
    let shows = |t: &Term| {
        let is_hidden = match t {
            Term::ReadoutSaturation(_) => !is_driven,
            _ => matches!(t.role(), Role::Filter(_)) && !is_driven,
        };
        let is_shape = matches!(t, Term::ShapedFriction(_));
        t.noise().is_none() && t.role() != Role::Lattice && !is_hidden && !is_shape
    };
    let mut terms: Vec<Term> = Term::tried(environments, is_driven).into_iter().filter(shows).collect();
    for side in [Side::Both, Side::Upper, Side::Lower] {
        let stop = Term::EndStop(EndStop(side));
        if !terms.contains(&stop) {
            terms.push(stop);
        }
    }
    if is_driven {
        terms.extend(ParasiticMode::ALL.into_iter().skip(1).map(Term::ParasiticMode));
    } else {
        terms.extend(RingingMode::ALL.map(Term::RingingMode));
        terms.push(Term::PeriodicDisturbance(PeriodicDisturbance(1)));
    }
    let stated = terms.into_iter().map(|term| Member { term, form: Form::Stated });
    let powers = [
        Term::PowerLawStiffness(PowerLawStiffness(Exponent::Free)),
        Term::AsymmetricStiffness(AsymmetricStiffness),
        Term::PowerLawDamping(PowerLawDamping(Exponent::Free)),
        Term::BiasDrift(BiasDrift(Course::Power)),
        Term::Hysteresis(Hysteresis(Sharpness::Own)),
    ];
    let powers = powers.into_iter().chain(ShapedFriction::ALL.map(Term::ShapedFriction));
    // What a mode is when it pulls back on the mass, and a low-pass with a second pole.
    let linear = [Term::CoupledMode(CoupledMode), Term::ReadoutLowpass(ReadoutLowpass(Poles::Two))];
    let powers = powers.chain(linear.into_iter().filter(|_| is_driven));
    let powers = powers.map(|term| Member { term, form: Form::Exponent });
    let speed = 2.0 * scales.velocity;
    let free = |law: Freed, size: f64| Member {
        term: Term::FreeForm(FreeForm { law, size, extent: Extent::Wide }),
        form: Form::Free,
    };
    let size = 2.0 * scales.output;
    let mut forms = vec![
        free(Freed::CubicSpring, size),
        free(Freed::QuadraticSpring, size),
        free(Freed::Drag, speed),
        Member { term: Term::ShapedFriction(ShapedFriction(Shape::Falling)), form: Form::Free },
        free(Freed::Film, size),
        free(Freed::Drift, scales.duration_s),
    ];
    if is_driven {
        forms.extend([free(Freed::Drive, 2.0 * scales.input), free(Freed::Readout, size)]);
    } else {
        let any = [Term::PumpedStiffness(PumpedStiffness), Term::RingingMode(RingingMode::ANY)];
        forms.extend(any.map(|term| Member { term, form: Form::Free }));
    }
    stated.chain(powers).chain(forms).collect()
}

/// Quantity that a law depends on.
pub(in crate::driven) fn argument(term: &Term) -> Argument {
    match term {
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) => Argument::Velocity,
        Term::CoulombFriction(_) | Term::ShapedFriction(_) => Argument::Velocity,
        Term::SqueezeFilmDamping(_) => Argument::Both,
        Term::Hysteresis(_) => Argument::Path,
        Term::StiffnessDrift(StiffnessDrift { environment: Some(_) }) => Argument::Environment,
        Term::StiffnessDrift(_) | Term::BiasDrift(_) | Term::WarmUp(_) => Argument::Time,
        Term::ReadoutNonlinearity(_) | Term::ReadoutSaturation(_) => Argument::Readout,
        Term::DriveNonlinearity(_) => Argument::Input,
        Term::CoupledMode(_)
        | Term::ParasiticMode(_)
        | Term::PeriodicDisturbance(_)
        | Term::ReadoutDelay(_)
        | Term::InputLag(_)
        | Term::ReadoutLowpass(_)
        | Term::ReadoutHighpass(_)
        | Term::InputHighpass(_)
        | Term::Feedthrough(_) => Argument::Frequency,
        Term::RingingMode(RingingMode::ANY) => Argument::Line,
        Term::RingingMode(_) => Argument::Motion,
        Term::PumpedStiffness(_) => Argument::Rhythm,
        Term::FreeForm(form) => match form.law {
            Freed::Drag => Argument::Velocity,
            Freed::Film => Argument::Both,
            Freed::Drift => Argument::Time,
            Freed::Readout => Argument::Readout,
            Freed::Drive => Argument::Input,
            _ => Argument::Displacement,
        },
        _ => Argument::Displacement,
    }
}

/// The place of a law among those of its id, of which a set may hold several: a structure has several modes, and hum
/// several lines.
pub(in crate::driven) fn place(term: &Term) -> Option<(&'static str, usize)> {
    match term {
        Term::ParasiticMode(ParasiticMode(place))
        | Term::RingingMode(RingingMode(place))
        | Term::PeriodicDisturbance(PeriodicDisturbance(place)) => Some((term.id(), *place)),
        _ => None,
    }
}

/// Returns whether a set holds at most one of two laws: they are forms of one another, or undo each other.
pub(in crate::driven) fn excludes(one: &Term, other: &Term) -> bool {
    let group = |t: &Term| match t {
        Term::CubicStiffness(_) | Term::PowerLawStiffness(_) => 1,
        Term::FreeForm(form) => match form.law {
            Freed::CubicSpring => 1,
            Freed::Drag => 2,
            Freed::Film => 3,
            Freed::Drift => 5,
            Freed::QuadraticSpring => 6,
            Freed::Drive => 8,
            Freed::Readout => 9,
            Freed::Stop(_) => 7,
        },
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) => 2,
        Term::SqueezeFilmDamping(_) => 3,
        Term::CoulombFriction(_) | Term::ShapedFriction(_) => 4,
        Term::StiffnessDrift(_) => 5,
        Term::QuadraticStiffness(_) | Term::AsymmetricStiffness(_) => 6,
        Term::EndStop(_) => 7,
        Term::DriveNonlinearity(_) => 8,
        Term::ReadoutNonlinearity(_) => 9,
        // One is the other with its sign turned.
        Term::ReadoutDelay(_) | Term::InputLag(_) => 10,
        // What remains of both is a shelf, (1 + sτ₁)/(1 + sτ₂), which damping that goes with a power of
        // frequency looks like as well.
        Term::ReadoutHighpass(_) | Term::InputHighpass(_) => 11,
        _ => 0,
    };
    if let (Some(one), Some(other)) = (place(one), place(other)) {
        return one == other;
    }
    one.id() == other.id() || (group(one) != 0 && group(one) == group(other))
}
