//! What a candidate is to the simulator: a term in the equation of motion, at the readout, or in the noise.
//!
//! A term works on [`LANES`] parameter sets at once, so that a Jacobian or a line search is one pass over the recording.
//! One file per family; the list of all terms is [`Term::tried`]. Not for fitting (`fit`) and not for choosing (`select`).

use crate::diagnosis::candidate::Candidate;
use crate::kernel::misfit::Point;

use super::ensemble::Cloud;
pub use super::scales::{Coordinate, Scales};
use super::{contact, damping, drift, drive, hysteresis, lag, mode, noise, pickup, readout, spring};

/// Parameter sets simulated side by side.
pub const LANES: usize = 8;
/// One value per parameter set.
pub type Lanes = [f64; LANES];

/// The base model in every lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseLanes {
    /// Gain.
    pub gain: Lanes,
    /// ω₀².
    pub stiffness: Lanes,
    /// 2ζω₀.
    pub damping: Lanes,
}

/// The state at one instant, in every lane.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time from the first sample of the recording.
    pub time_s: f64,
    /// Integration step.
    pub step_s: f64,
    /// Input: for forces late where the reading is late (a delay is applied there), for readings as it is.
    pub input: Lanes,
    /// Displacement.
    pub x: Lanes,
    /// Velocity.
    pub v: Lanes,
    /// The base model.
    pub base: &'a BaseLanes,
    /// Environment columns, less their means.
    pub environment: &'a [f64],
}

/// What a term needs at every step and that does not change during a pass.
pub type Constants = [Lanes; 6];

/// One step that the mass has taken.
#[derive(Debug, Clone, Copy)]
pub struct Stride {
    /// Its length.
    pub step_s: f64,
    /// Displacement before.
    pub x0: Lanes,
    /// Velocity before.
    pub v0: Lanes,
    /// Displacement after.
    pub x1: Lanes,
    /// Velocity after.
    pub v1: Lanes,
    /// Input at its beginning, middle and end.
    pub input: [Lanes; 3],
}

/// Noise that no simulation predicts sample by sample; it enters through the filter's gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// White force.
    Force,
    /// Random walk of the reading.
    Walk,
}

/// What each candidate answers. Empty defaults: a term acts only where it says so.
pub trait Physics {
    /// What the library says of it.
    fn words(&self) -> &'static Candidate;
    /// One per parameter, and one per unknown beginning.
    fn coordinates(&self, scales: &Scales) -> Vec<Coordinate>;
    /// Where to begin; several where the misfit has several valleys.
    fn starts(&self, scales: &Scales) -> Vec<Vec<f64>>;
    /// Where to look before a fit, many points at a time; `None` where the few starts are enough.
    fn cloud(&self, _scales: &Scales) -> Option<Cloud> {
        None
    }
    /// Where else, seen from a fit, its misfit may have another valley.
    fn elsewhere(&self, _p: &[f64], _scales: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// Own state variables.
    fn states(&self) -> usize {
        0
    }
    /// Of its own states, how many begin somewhere that has to be fitted: as many values follow the parameters, in order.
    fn unknown_beginnings(&self) -> usize {
        0
    }
    /// Fastest rate it brings in, so that steps stay short enough.
    fn fastest_rad_s(&self, _parameters: &[f64], _scales: &Scales) -> f64 {
        0.0
    }
    /// Adds to the acceleration, and gives the rates of its own states.
    #[inline(always)]
    fn force(&self, _at: &Instant<'_>, _p: &[Lanes], _own: &[Lanes], _rates: &mut [Lanes], _acceleration: &mut Lanes) {}
    /// Changes the reading.
    #[inline(always)]
    fn reading(&self, _at: &Instant<'_>, _p: &[Lanes], _own: &[Lanes], _y: &mut Lanes) {}
    /// Its own states when the mass begins at `x`, `v`; at rest where nothing is known.
    fn begin(&self, _x: &Lanes, _v: &Lanes, _p: &[Lanes], _own: &mut [Lanes]) {}
    /// What `follow` takes for granted during a pass of steps of this length.
    fn constants(&self, _p: &[Lanes], _step_s: f64) -> Constants {
        [[0.0; LANES]; 6]
    }
    /// Carries its own states over one step of the mass, by exact solution.
    #[inline(always)]
    fn follow(&self, _stride: &Stride, _constants: &Constants, _p: &[Lanes], _own: &mut [Lanes]) {}
    /// Whether `follow` does anything.
    fn follows(&self) -> bool {
        false
    }
    /// Whether its law has a corner, near which the misfit is far from a parabola and integration needs short steps.
    fn has_corner(&self) -> bool {
        false
    }
    /// Whether `force` does anything.
    fn moves(&self) -> bool {
        false
    }
    /// Position in the chain of the readout; `None` where `reading` does nothing.
    fn reads(&self) -> Option<u8> {
        None
    }
    /// Whether parameter 0 is a delay of the input in s.
    fn delays(&self) -> bool {
        false
    }
    /// Whether parameter 0 is dry friction, which the pass switches at its events.
    fn rubs(&self) -> bool {
        false
    }
    /// Whether parameter 0 is the time constant of a low-pass, state 0 its own, through which the displacement is read.
    fn lags(&self) -> bool {
        false
    }
    /// Puts its parameters where the search kernel reads them; `false` where that kernel does not have the term.
    fn place(&self, _p: &[f64], _point: &mut Point) -> bool {
        false
    }
    /// Which noise it is; parameter 0 is then its strength as in `gain`.
    fn noise(&self) -> Option<Noise> {
        None
    }
    /// Whether the term needs an input column.
    fn needs_input(&self) -> bool {
        false
    }
}

macro_rules! terms {
    ($($variant:ident = $family:ident :: $name:ident $(($inner:ty))?),* $(,)?) => {
        /// Every term, one line each.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Term {
            $(#[doc = stringify!($variant)] $variant($family::$name)),*
        }

        impl Term {
            #[inline(always)]
            fn physics(&self) -> &dyn Physics {
                match self { $(Term::$variant(t) => t),* }
            }
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

    /// As `Physics::words`.
    pub fn words(&self) -> &'static Candidate {
        self.physics().words()
    }

    /// As `Physics::coordinates`.
    pub fn coordinates(&self, scales: &Scales) -> Vec<Coordinate> {
        self.physics().coordinates(scales)
    }

    /// As `Physics::starts`.
    pub fn starts(&self, scales: &Scales) -> Vec<Vec<f64>> {
        self.physics().starts(scales)
    }

    /// As `Physics::cloud`.
    pub fn cloud(&self, scales: &Scales) -> Option<Cloud> {
        self.physics().cloud(scales)
    }

    /// As `Physics::elsewhere`.
    pub fn elsewhere(&self, p: &[f64], scales: &Scales) -> Vec<Vec<f64>> {
        self.physics().elsewhere(p, scales)
    }

    /// As `Physics::states`.
    pub fn states(&self) -> usize {
        self.physics().states()
    }

    /// As `Physics::fastest_rad_s`.
    pub fn fastest_rad_s(&self, parameters: &[f64], scales: &Scales) -> f64 {
        self.physics().fastest_rad_s(parameters, scales)
    }

    /// As `Physics::moves`.
    pub fn moves(&self) -> bool {
        self.physics().moves()
    }

    /// As `Physics::has_corner`.
    pub fn has_corner(&self) -> bool {
        self.physics().has_corner()
    }

    /// As `Physics::begin`.
    pub fn begin(&self, x: &Lanes, v: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        self.physics().begin(x, v, p, own);
    }

    /// As `Physics::constants`.
    pub fn constants(&self, p: &[Lanes], step_s: f64) -> Constants {
        self.physics().constants(p, step_s)
    }

    /// As `Physics::follows`.
    pub fn follows(&self) -> bool {
        self.physics().follows()
    }

    /// As `Physics::reads`.
    pub fn reads(&self) -> Option<u8> {
        self.physics().reads()
    }

    /// As `Physics::delays`.
    pub fn delays(&self) -> bool {
        self.physics().delays()
    }

    /// As `Physics::rubs`.
    pub fn rubs(&self) -> bool {
        self.physics().rubs()
    }

    /// As `Physics::lags`.
    pub fn lags(&self) -> bool {
        self.physics().lags()
    }

    /// As `Physics::place`.
    pub fn place(&self, p: &[f64], point: &mut Point) -> bool {
        self.physics().place(p, point)
    }

    /// As `Physics::noise`.
    pub fn noise(&self) -> Option<Noise> {
        self.physics().noise()
    }

    /// As `Physics::needs_input`.
    pub fn needs_input(&self) -> bool {
        self.physics().needs_input()
    }

    /// Number of values fitted: the library's parameters, then the unknown beginnings of its states.
    pub fn parameters(&self) -> usize {
        self.words().parameters.len() + self.unknown_beginnings()
    }

    /// As `Physics::unknown_beginnings`.
    pub fn unknown_beginnings(&self) -> usize {
        self.physics().unknown_beginnings()
    }
}
