//! The list of terms: which laws there are, which of them a recording is tried against, and in which order the library
//! names them. What each of them does is its own (`law` and the families beside it).

use std::ops::Deref;

use crate::diagnosis::candidate::Candidate;

use super::law::{Constants, Instant, Lanes, Physics, Stride};
use super::{contact, damping, drift, drive, hysteresis, lag, mode, noise, pickup, readout, spring};

/// What can be named in this kind of recording.
pub const CANDIDATES: &[Candidate] = &[
    spring::CUBIC,
    spring::QUADRATIC,
    damping::QUADRATIC,
    damping::SQUEEZE_FILM,
    damping::COULOMB,
    hysteresis::BOUC_WEN,
    spring::DRIFT,
    mode::PARASITIC,
    drive::SQUARE,
    contact::END_STOP,
    noise::FORCE,
    readout::SATURATION,
    readout::QUANTISATION,
    lag::DELAY,
    lag::LOWPASS,
    readout::POLYNOMIAL,
    drive::FEEDTHROUGH,
    drift::RAMP,
    drift::WARM_UP,
    noise::WALK,
    pickup::PERIODIC,
];

macro_rules! terms {
    ($($variant:ident = $family:ident :: $name:ident $(($inner:ty))?),* $(,)?) => {
        /// Every term, one line each.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Term {
            $(#[doc = stringify!($variant)] $variant($family::$name)),*
        }

        impl Deref for Term {
            type Target = dyn Physics;

            #[inline(always)]
            fn deref(&self) -> &Self::Target {
                match self { $(Term::$variant(t) => t),* }
            }
        }

        // Called at every step: by the term itself, so that the compiler sees the law.
        impl Term {
            /// As `Physics::force`.
            #[inline(always)]
            pub fn force(&self, at: &Instant<'_>, p: &[Lanes], own: &[Lanes], rates: &mut [Lanes], acceleration: &mut Lanes) {
                match self { $(Term::$variant(t) => t.force(at, p, own, rates, acceleration)),* }
            }
            /// As `Physics::reading`.
            #[inline(always)]
            pub fn reading(&self, at: &Instant<'_>, p: &[Lanes], own: &[Lanes], y: &mut Lanes) {
                match self { $(Term::$variant(t) => t.reading(at, p, own, y)),* }
            }
            /// As `Physics::follow`.
            #[inline(always)]
            pub fn follow(&self, stride: &Stride, constants: &Constants, p: &[Lanes], own: &mut [Lanes]) {
                match self { $(Term::$variant(t) => t.follow(stride, constants, p, own)),* }
            }
        }
    };
}

terms! {
    CubicStiffness = spring::Cubic,
    QuadraticStiffness = spring::Quadratic,
    StiffnessDrift = spring::Drift,
    QuadraticDamping = damping::Quadratic,
    SqueezeFilm = damping::SqueezeFilm,
    Coulomb = damping::Coulomb,
    Hysteresis = hysteresis::BoucWen,
    ParasiticMode = mode::Parasitic,
    DriveNonlinearity = drive::Square,
    EndStop = contact::EndStop,
    ForceNoise = noise::Force,
    BiasWalk = noise::Walk,
    Saturation = readout::Saturation,
    Quantisation = readout::Quantisation,
    ReadoutNonlinearity = readout::Polynomial,
    Delay = lag::Delay,
    Lowpass = lag::Lowpass,
    Feedthrough = drive::Feedthrough,
    BiasDrift = drift::Ramp,
    WarmUp = drift::WarmUp,
    Pickup = pickup::Periodic,
}

impl Term {
    /// The terms tried on a recording with this many environment columns.
    pub fn tried(environments: usize, input: bool) -> Vec<Term> {
        use contact::Side;
        let mut all = vec![
            Term::CubicStiffness(spring::Cubic),
            Term::QuadraticStiffness(spring::Quadratic),
            Term::QuadraticDamping(damping::Quadratic),
            Term::SqueezeFilm(damping::SqueezeFilm),
            Term::Coulomb(damping::Coulomb),
            Term::Hysteresis(hysteresis::BoucWen),
            Term::StiffnessDrift(spring::Drift { environment: None }),
            Term::ParasiticMode(mode::Parasitic),
            Term::DriveNonlinearity(drive::Square),
            Term::EndStop(contact::EndStop(Side::Both)),
            Term::EndStop(contact::EndStop(Side::Upper)),
            Term::EndStop(contact::EndStop(Side::Lower)),
            Term::ForceNoise(noise::Force),
            Term::Saturation(readout::Saturation),
            Term::Quantisation(readout::Quantisation),
            Term::Delay(lag::Delay),
            Term::Lowpass(lag::Lowpass),
            Term::ReadoutNonlinearity(readout::Polynomial),
            Term::Feedthrough(drive::Feedthrough),
            Term::BiasDrift(drift::Ramp),
            Term::WarmUp(drift::WarmUp),
            Term::BiasWalk(noise::Walk),
            Term::Pickup(pickup::Periodic),
        ];
        all.extend((0..environments).map(|e| Term::StiffnessDrift(spring::Drift { environment: Some(e) })));
        all.retain(|t| input || !t.needs_input());
        all
    }

    /// Library id.
    pub fn id(&self) -> &'static str {
        self.words().id
    }

    /// Number of values fitted: the library's parameters, then the unknown beginnings of its states.
    pub fn parameters(&self) -> usize {
        self.words().parameters.len() + self.unknown_beginnings()
    }
}
