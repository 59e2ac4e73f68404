//! The list of laws, one line each; everything that knows them all is derived from it.

use std::ops::Deref;

use crate::numerics::elementary::Real;

use super::candidate::Candidate;
use super::law::{Law, Noise, Role};
use super::side_by_side::{each, each_reading};
use super::state::{Constants, Instants, Lanes, Staged, Stride, Values};

macro_rules! library {
    ($($law:ident in $file:ident),* $(,)?; in studies $($run:ident in $only:ident),* $(,)?; beside $($other:ident in $beside:ident),* $(,)?) => {
        /// Every law, in one of its forms.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[allow(missing_docs, reason = "each law's own file says what it is")]
        pub enum Term {
            $($law(super::$file::$law),)*
            $($run(super::$only::$run),)*
            $($other(super::$beside::$other)),*
        }

        /// Candidates that can be named in a driven recording, in public order.
        pub const CANDIDATES: &[Candidate] = &[$(super::$file::CANDIDATE),*];

        impl Term {
            /// Every law once, in its first form.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$law(super::$file::$law::default())),*]
            }

            /// Those in a form that studies alone have.
            pub(super) fn of_studies() -> Vec<Self> {
                vec![$(Self::$run(super::$only::$run)),*]
            }

            /// The form of it that studies run.
            pub(super) fn in_studies(&self) -> Self {
                match self {
                    $(Self::$law(law) => Self::$law(law.in_studies()),)*
                    $(Self::$run(law) => Self::$run(law.in_studies()),)*
                    $(Self::$other(law) => Self::$other(law.in_studies())),*
                }
            }

            /// The laws, in each of their forms, that a recording with this many environment
            /// columns is tried against.
            pub fn tried(environments: usize, input: bool) -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend(super::$file::$law::tried(environments).into_iter().map(Self::$law));)*
                $(all.extend(super::$beside::$other::tried(environments).into_iter().map(Self::$other));)*
                all.retain(|t| input || !t.needs_input());
                all
            }

            /// Adds its force to an acceleration and writes the rates of its states. Through the
            /// law itself, not through `Deref`, so that the compiler sees what is in the loop.
            #[inline(always)]
            pub fn force<T: Real, const N: usize, const FMA: bool>(
                &self,
                at: &Instants<'_, T, N>,
                p: &Values<T, N>,
                own: &Staged<T, N>,
                rates: &mut Staged<T, N>,
                acceleration: &mut [T; N],
            ) {
                match self {
                    $(Self::$law(law) => each::<_, T, N, FMA>(law, at, p, own, rates, acceleration),)*
                    $(Self::$run(law) => each::<_, T, N, FMA>(law, at, p, own, rates, acceleration),)*
                    $(Self::$other(law) => law.forces::<T, N, FMA>(at, p, own, rates, acceleration)),*
                }
            }

            /// Changes the readings; as `force`.
            #[inline(always)]
            pub fn reading<const N: usize>(
                &self,
                at: &Instants<'_, f64, N>,
                p: &Values<f64, N>,
                own: &[[f64; N]],
                y: &mut [f64; N],
            ) {
                match self {
                    $(Self::$law(law) => each_reading(law, at, p, own, y),)*
                    $(Self::$run(law) => each_reading(law, at, p, own, y),)*
                    $(Self::$other(law) => each_reading(law, at, p, own, y)),*
                }
            }

            /// Carries its states over one step of the mass; as `force`.
            #[inline(always)]
            pub fn follow(&self, stride: &Stride, constants: &Constants, p: &[Lanes], own: &mut [Lanes]) {
                match self {
                    $(Self::$law(law) => law.follow(stride, constants, p, own),)*
                    $(Self::$run(law) => law.follow(stride, constants, p, own),)*
                    $(Self::$other(law) => law.follow(stride, constants, p, own)),*
                }
            }
        }

        impl Deref for Term {
            type Target = dyn Law;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$law(law) => law,)*
                    $(Self::$run(law) => law,)*
                    $(Self::$other(law) => law),*
                }
            }
        }
    };
}

library! {
    CubicStiffness in cubic_stiffness,
    QuadraticStiffness in quadratic_stiffness,
    AsymmetricStiffness in asymmetric_stiffness,
    PowerLawStiffness in power_law_stiffness,
    QuadraticDamping in quadratic_damping,
    PowerLawDamping in power_law_damping,
    SqueezeFilmDamping in squeeze_film_damping,
    CoulombFriction in coulomb_friction,
    Hysteresis in hysteresis,
    StiffnessDrift in stiffness_drift,
    ParasiticMode in parasitic_mode,
    CoupledMode in coupled_mode,
    DriveNonlinearity in drive_nonlinearity,
    EndStop in end_stop,
    ForceNoise in force_noise,
    ReadoutSaturation in readout_saturation,
    ReadoutQuantisation in readout_quantisation,
    ReadoutDelay in readout_delay,
    ReadoutLowpass in readout_lowpass,
    ReadoutHighpass in readout_highpass,
    ReadoutNonlinearity in readout_nonlinearity,
    Feedthrough in feedthrough,
    InputLag in input_lag,
    InputHighpass in input_highpass,
    BiasDrift in bias_drift,
    WarmUp in warm_up,
    BiasRandomWalk in bias_random_walk,
    PeriodicDisturbance in periodic_disturbance;
    // What a diagnosis names as a form of another law.
    in studies CreepingFriction in creeping_friction, OneSidedStop in one_sided_stop, WarmStiffness in warm_stiffness;
    // With loops of their own: shapes of a law, and what is fitted like one and never named.
    beside FreeForm in free_form, PumpedStiffness in pumped_stiffness, RingingMode in ringing_mode, ShapedFriction in shaped_friction
}

impl Term {
    /// Public id of the candidate.
    pub fn id(&self) -> &'static str {
        self.candidate().id
    }

    /// Which noise it is, if it is one.
    pub fn noise(&self) -> Option<Noise> {
        match self.role() {
            Role::Noise(noise) => Some(noise),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::free_form::{Extent, FreeForm, Freed};
    use super::super::scales::{Coordinate, Scales};
    use super::*;
    use crate::units::key::Sign;

    #[test]
    fn ids_are_unique_and_confusable_ones_exist() {
        for (i, c) in CANDIDATES.iter().enumerate() {
            assert!(CANDIDATES[..i].iter().all(|other| other.id != c.id), "{}", c.id);
            for other in c.confusable_with {
                assert!(CANDIDATES.iter().any(|c| c.id == *other), "{} names {other}", c.id);
            }
        }
        assert!(Term::all().iter().zip(CANDIDATES).all(|(t, c)| t.candidate() == c));
    }

    // What a study refuses below zero, as damping that feeds the motion, no fit may name there.
    #[test]
    fn what_no_study_takes_below_zero_no_fit_goes_below() {
        let scales = Scales::of_a_mass();
        let (mut bound, mut free) = (0, 0);
        let dampings = [Freed::Drag, Freed::Film];
        for law in dampings {
            let form = FreeForm { law, size: 1.0, extent: Extent::Wide };
            assert!(matches!(form.coordinates(&scales)[0], Coordinate::Bounded(_, 0.0, _)), "{law:?}");
        }
        for term in Term::all().into_iter().map(|term| term.in_studies()) {
            for (given, coordinate) in term.study().iter().zip(term.coordinates(&scales)) {
                let least = match coordinate {
                    Coordinate::Log(low, _) | Coordinate::Bounded(_, low, _) => low,
                    Coordinate::Linear(_) => f64::NEG_INFINITY,
                    // A reference that is chosen from sizes of the motion, not fitted.
                    Coordinate::Held => 0.0,
                };
                let refused = given.key.sign != Sign::Any;
                assert!(!refused || least >= 0.0, "{}: {}", term.id(), given.key.path);
                (bound, free) = (bound + usize::from(refused), free + usize::from(least < 0.0));
            }
        }
        assert!(bound > 5 && free > 1, "both kinds are there: {bound} {free}");
    }

    #[test]
    fn the_units_of_study_keys_are_those_of_the_law() {
        for term in Term::all().into_iter().chain(Term::of_studies()) {
            for (given, parameter) in term.study().iter().zip(term.candidate().parameters) {
                let metric = parameter.unit.replace("y/(u s^2)", "1").replace('y', "m").replace("1/u", "s²/m");
                let metric = metric.replace("^2", "²").replace("^3", "³");
                // A frequency is given in Hz.
                let (metric, factor) = if metric == "rad/s" { ("Hz".to_owned(), TAU) } else { (metric, 1.0) };
                assert_eq!((given.key.unit, given.key.factor), (metric.as_str(), factor), "{}", given.key.path);
            }
        }
    }
}
