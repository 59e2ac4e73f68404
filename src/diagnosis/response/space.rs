//! The laws that a resonator may follow next to the base model: the library's, with exponents and
//! free forms of their arguments.
//!
//! A quadratic spring is none of them by itself: to a lock-in, which reads the fundamental alone, αx² is a
//! cubic spring of β = −10α²/(9ω₀²) (Nayfeh & Mook, Nonlinear Oscillations, § 4.2), and it is
//! reported with a softening one as what it cannot be told from. Next to a cubic one, which it may nearly cancel,
//! it shows by what the two leave at large amplitudes. Nor is a spring with memory: the
//! fundamental of its loop is that of a spring and a friction, whatever its form.

use std::sync::LazyLock;

use crate::candidate::{Candidate, Kind};
use crate::engine::kind::{Argument, Form};
use crate::physics::coulomb_friction::CoulombFriction;
use crate::physics::coupled_mode::CoupledMode;
use crate::physics::cubic_stiffness::CubicStiffness;
use crate::physics::free_form::{Extent, FreeForm, Freed};
use crate::physics::library::Term;
use crate::physics::parasitic_mode::ParasiticMode;
use crate::physics::power::Exponent;
use crate::physics::power_law_damping::PowerLawDamping;
use crate::physics::power_law_stiffness::PowerLawStiffness;
use crate::physics::quadratic_damping::QuadraticDamping;
use crate::physics::quadratic_stiffness::QuadraticStiffness;
use crate::physics::readout_delay::ReadoutDelay;
use crate::physics::readout_highpass::ReadoutHighpass;
use crate::physics::readout_lowpass::ReadoutLowpass;
use crate::physics::scales::Scales;
use crate::physics::shaped_friction::{Shape, ShapedFriction};
use crate::physics::squeeze_film_damping::SqueezeFilmDamping;
use crate::physics::stiffness_drift::StiffnessDrift;

/// A law of the space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Member {
    /// The law.
    pub term: Term,
    /// Its use in the search.
    pub form: Form,
}

/// Laws with a name, in public order.
fn stated(with_time: bool) -> Vec<Term> {
    let mut all = vec![
        Term::CubicStiffness(CubicStiffness),
        Term::QuadraticDamping(QuadraticDamping),
        Term::SqueezeFilmDamping(SqueezeFilmDamping),
        Term::CoulombFriction(CoulombFriction::default()),
        Term::CoupledMode(CoupledMode),
        Term::ParasiticMode(ParasiticMode(0)),
        Term::ReadoutDelay(ReadoutDelay),
        Term::ReadoutLowpass(ReadoutLowpass::default()),
        Term::ReadoutHighpass(ReadoutHighpass),
    ];
    if with_time {
        all.push(Term::StiffnessDrift(StiffnessDrift::default()));
    }
    all
}

/// The law that shows next to another spring alone.
const BESIDE: Term = Term::QuadraticStiffness(QuadraticStiffness);

/// Laws with an exponent or a shape of their own.
fn powers() -> Vec<Term> {
    let mut all = vec![
        Term::PowerLawStiffness(PowerLawStiffness(Exponent::Free)),
        Term::PowerLawDamping(PowerLawDamping(Exponent::Free)),
    ];
    all.extend(ShapedFriction::ALL.map(Term::ShapedFriction));
    all
}

/// All laws that sweeps of these sizes are tried against.
pub(super) fn members(scales: &Scales, with_time: bool) -> Vec<Member> {
    let free = |law: Freed, size: f64| Member {
        term: Term::FreeForm(FreeForm { law, size, extent: Extent::Wide }),
        form: Form::Free,
    };
    let (size, speed) = (2.0 * scales.output, 2.0 * scales.velocity);
    let mut forms = vec![
        free(Freed::CubicSpring, size),
        free(Freed::Drag, speed),
        Member { term: Term::ShapedFriction(ShapedFriction(Shape::Falling)), form: Form::Free },
        free(Freed::Film, size),
    ];
    if with_time {
        forms.push(free(Freed::Drift, scales.duration_s));
    }
    let stated = stated(with_time).into_iter().map(|term| Member { term, form: Form::Stated });
    let beside = Member { term: BESIDE, form: Form::Beside };
    let powers = powers().into_iter().map(|term| Member { term, form: Form::Exponent });
    stated.chain([beside]).chain(powers).chain(forms).collect()
}

/// Quantity that a law depends on.
pub(super) fn argument(term: &Term) -> Argument {
    match term {
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) => Argument::Velocity,
        Term::CoulombFriction(_) | Term::ShapedFriction(_) => Argument::Velocity,
        // To a lock-in a film is a damping by the third power: x²x′ and |x′|²x′ have the same fundamental but for ω².
        Term::SqueezeFilmDamping(_) => Argument::Velocity,
        Term::StiffnessDrift(_) => Argument::Time,
        Term::CoupledMode(_) | Term::ParasiticMode(_) | Term::ReadoutDelay(_) => Argument::Frequency,
        Term::ReadoutLowpass(_) | Term::ReadoutHighpass(_) => Argument::Frequency,
        Term::FreeForm(form) => match form.law {
            Freed::Drag => Argument::Velocity,
            Freed::Film => Argument::Both,
            Freed::Drift => Argument::Time,
            _ => Argument::Displacement,
        },
        _ => Argument::Displacement,
    }
}

/// Returns whether two laws are forms of one another, of which a set holds at most one.
pub(super) fn excludes(one: &Term, other: &Term) -> bool {
    let group = |t: &Term| match t {
        Term::CubicStiffness(_) | Term::PowerLawStiffness(_) => 1,
        Term::QuadraticDamping(_) | Term::PowerLawDamping(_) => 2,
        Term::SqueezeFilmDamping(_) => 3,
        Term::CoulombFriction(_) | Term::ShapedFriction(_) => 4,
        Term::FreeForm(form) => match form.law {
            Freed::CubicSpring => 1,
            Freed::Drag => 2,
            Freed::Film => 3,
            Freed::Drift => 5,
            _ => 0,
        },
        Term::StiffnessDrift(_) => 5,
        // Both of them at one frequency fit a mode whose residue is complex, and it is neither.
        Term::CoupledMode(_) | Term::ParasiticMode(_) => 6,
        _ => 0,
    };
    one.id() == other.id() || (group(one) != 0 && group(one) == group(other))
}

/// States what can be named in sweeps.
pub static CANDIDATES: LazyLock<Vec<Candidate>> = LazyLock::new(|| {
    // A friction with a shape of its own is one of the same name.
    let mut all: Vec<Term> = stated(true).into_iter().chain([BESIDE]).chain(powers()).collect();
    all.retain(|term| !matches!(term, Term::ShapedFriction(_)));
    let ids: Vec<&str> = all.iter().map(|term| term.id()).collect();
    let of_sweeps = |candidate: &Candidate| -> Candidate {
        // Made once, and kept as long as the program runs, like the texts of the laws.
        let others: Vec<&'static str> =
            candidate.confusable_with.iter().copied().filter(|other| ids.contains(other)).collect();
        Candidate { kind: Kind::Response, confusable_with: others.leak(), ..*candidate }
    };
    all.iter().map(|term| of_sweeps(term.candidate())).collect()
});
