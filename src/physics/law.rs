//! Asks every law the same: what the library states of it, how it acts, where a fit of it begins,
//! and the law itself.
//!
//! Not for the list of laws (`library`), which imports each of them.

use crate::numerics::elementary::Real;

use super::candidate::Candidate;
use super::scales::{Coordinate, Scales};
use super::state::{Constants, Instant, LANES, Lanes, MOST_STAGED, MOST_VALUES, Stride};
use super::study::Given;

/// Role of a law in a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A force on the mass; its states are integrated with the mass.
    Force,
    /// Dry friction: a force that the integration switches at its events. Parameter 0 is its size.
    Friction,
    /// A mode that the input moves and that is read together with the mass; states 0 and 1 are
    /// displacement and velocity.
    Mode,
    /// The input acts late. Parameter 0 is the delay in s.
    InputDelay,
    /// The input that is recorded acts before. Parameter 0 is by how much, in s.
    InputLead,
    /// The displacement is read through a filter at this place of the readout. Parameter 0 is its
    /// time constant in s, state 0 what a low-pass of that holds.
    Filter(Place),
    /// The reading is changed at this place of the readout.
    Readout(Place),
    /// No simulation changes; it shows in which values readings take.
    Lattice,
    /// No simulation changes; it enters through the filter's gain. Parameter 0 is its strength as
    /// in the filter.
    Noise(Noise),
}

/// Order of a derivative by time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The rate of change.
    First,
    /// The rate of that.
    Second,
}

/// Places in the readout, in the order in which a reading passes them. The offset of the base model
/// is added before `Input`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Displacements of further modes are added to that of the mass.
    Modes,
    /// A low-pass.
    LowPass,
    /// A high-pass.
    HighPass,
    /// A static nonlinearity of the reading.
    Nonlinearity,
    /// Part of the input is added.
    Input,
    /// An offset that depends on time alone is added.
    Bias,
    /// Saturation at two rails.
    Rails,
}

impl Place {
    /// Returns whether it comes before the offset: it sees the displacement alone.
    pub fn is_before_offset(self) -> bool {
        self < Self::Input
    }
}

/// Noise that no simulation predicts sample by sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// White noise that enters as a force on the mass.
    Force,
    /// Random walk of the reading.
    Walk,
}

impl Role {
    /// Returns whether it acts on the mass, so that the equation of motion is more than the base
    /// model's.
    pub fn acts_on_mass(self) -> bool {
        matches!(self, Self::Force | Self::Friction)
    }

    /// Returns whether its states follow each step of the mass by an exact solution.
    pub fn follows(self) -> bool {
        matches!(self, Self::Mode | Self::Filter(_))
    }

    /// Place in the readout at which it acts, if it does.
    pub fn place(self) -> Option<Place> {
        match self {
            Self::Mode => Some(Place::Modes),
            Self::Filter(place) | Self::Readout(place) => Some(place),
            _ => None,
        }
    }
}

/// Points in parameter space to look at before a fit.
#[derive(Debug, Clone, PartialEq)]
pub enum StartGrid {
    /// All parameters of the law.
    Points(Vec<Vec<f64>>),
    /// The first parameter is a strength that acts nearly in proportion; only the others are looked
    /// for.
    Directions {
        /// A strength so small that the law acts in proportion to it.
        strength: f64,
        /// The other parameters.
        directions: Vec<Vec<f64>>,
    },
}

/// One law of the library. Empty defaults: a law acts only where it says so.
pub trait Law {
    /// Its entry in the library of candidates.
    fn candidate(&self) -> &'static Candidate;
    /// Returns where and how the law acts.
    fn role(&self) -> Role;
    /// Returns how an optimiser moves each parameter, and each unknown initial value after them.
    fn coordinates(&self, scales: &Scales) -> Vec<Coordinate>;
    /// Returns the points at which a fit begins; several where the misfit has several minima.
    fn starts(&self, scales: &Scales) -> Vec<Vec<f64>>;
    /// Returns the grid of places to look at before a fit, many points at a time; `None` where the
    /// few starts are enough.
    fn start_grid(&self, _scales: &Scales) -> Option<StartGrid> {
        None
    }
    /// Returns other places where, seen from a fit, its misfit may have another minimum.
    fn elsewhere(&self, _p: &[f64], _scales: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// Returns the keys that give its parameters in a study; nothing where no study can run it.
    fn study(&self) -> &'static [Given] {
        &[]
    }
    /// The form of it that studies run, where one holds the others.
    fn in_studies(&self) -> Self
    where
        Self: Copy,
    {
        *self
    }
    /// The law for the GPU: a function of its id (hyphens as underscores) with the arguments (at,
    /// its parameters, sum), as `force` below; empty where no study can run it. One with states of
    /// its own has them behind its parameters, as a number or a vector of two, and a second
    /// function, its name and `_rates`, with the same arguments but the sum, as `rates` below.
    fn wgsl(&self) -> &'static str {
        ""
    }
    /// Returns its first state at rest under one unit of input, which displaces the mass by
    /// `displacement`; its further states rest at zero.
    fn at_rest(&self, _displacement: f64, _p: &[f64]) -> f64 {
        0.0
    }
    /// Number of states next to displacement and velocity of the mass.
    fn states(&self) -> usize {
        0
    }
    /// Of these states, how many have an unknown initial value: as many values follow the
    /// parameters, in order.
    fn unknown_beginnings(&self) -> usize {
        0
    }
    /// Number of values fitted: the parameters, then the unknown initial values.
    fn values(&self) -> usize {
        self.candidate().parameters.len() + self.unknown_beginnings()
    }
    /// Fastest rate that it brings in, rad/s, so that steps stay short enough.
    fn fastest_rad_s(&self, _parameters: &[f64], _scales: &Scales) -> f64 {
        0.0
    }
    /// The most that it adds to ω₀² of a mass, (rad/s)²; from it a study chooses steps that are
    /// short enough.
    fn stiffens(&self, _p: &[f64]) -> f64 {
        0.0
    }
    /// Returns whether its law has a corner, near which the misfit is far from a parabola and
    /// integration needs short steps.
    fn has_corner(&self) -> bool {
        false
    }
    /// The environment column that it follows in place of time, in this form; its one parameter is
    /// then a share per unit of the column.
    fn environment(&self) -> Option<usize> {
        None
    }
    /// Returns whether it follows the temperature of a study, which stands in the place of the
    /// first environment column, in K above its reference.
    fn follows_temperature(&self) -> bool {
        false
    }
    /// Returns whether it needs an input column.
    fn needs_input(&self) -> bool {
        false
    }
    /// Its states when the mass begins at displacement `x` and velocity `v`: the values fitted, or
    /// at rest.
    fn begin(&self, _x: &Lanes, _v: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        let first = self.candidate().parameters.len();
        for (state, value) in own.iter_mut().zip(&p[first..]).take(self.unknown_beginnings()) {
            *state = *value;
        }
    }
    /// Returns what `follow` takes for granted during a pass of steps of this length.
    fn constants(&self, _p: &[Lanes], _step_s: f64) -> Constants {
        [[0.0; LANES]; 6]
    }
    /// Carries its states over one step of the mass by exact solution (roles that follow).
    #[inline(always)]
    fn follow(&self, _stride: &Stride, _constants: &Constants, _p: &[Lanes], _own: &mut [Lanes]) {}

    /// Returns the first or second derivative of what the low-pass in it shows of displacement `x`, whose
    /// velocity is `v` (role filter).
    fn smoothed(&self, _order: Order, _motion: [&Lanes; 2], _p: &[Lanes], _own: &[Lanes]) -> Lanes {
        [0.0; LANES]
    }

    /// `sum` and the acceleration that the law adds to it.
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        _at: &Instant<'_, T>,
        _p: &[T; MOST_VALUES],
        _own: &[T; MOST_STAGED],
        sum: T,
    ) -> T
    where
        Self: Sized,
    {
        sum
    }
    /// Rates of its states (role force; role mode in a study, which takes its stages with the
    /// mass).
    #[inline(always)]
    fn rates<T: Real, const FMA: bool>(
        &self,
        _at: &Instant<'_, T>,
        _p: &[T; MOST_VALUES],
        _own: &[T; MOST_STAGED],
    ) -> [T; MOST_STAGED]
    where
        Self: Sized,
    {
        [T::default(); MOST_STAGED]
    }
    /// Returns what becomes of the reading `y`.
    #[inline(always)]
    fn reading(&self, _at: &Instant<'_, f64>, _p: &[f64; MOST_VALUES], _own: &[f64; MOST_STAGED], y: f64) -> f64
    where
        Self: Sized,
    {
        y
    }
    /// The forms of it that a recording with this many environment columns is tried against.
    fn tried(_environments: usize) -> Vec<Self>
    where
        Self: Default,
    {
        vec![Self::default()]
    }
}
