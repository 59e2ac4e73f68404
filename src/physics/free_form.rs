//! A law of the library with a free form: what a law that is near the stated one, but not it, looks
//! like to a fit.
//!
//! It is no candidate and is never named by itself: it says how far the law that it frees departs
//! from what its name states (`diagnosis::driven::selection::forms`). Its values are those of a fit
//! alone; a study cannot run it.

use crate::numerics::elementary::{Real, fma};
use crate::numerics::exponential;

use super::candidate::Candidate;
use super::end_stop::Side;
use super::law::{Law, Place, Role};
use super::power::{LEAST, bounded_power, by};
use super::scales::{Coordinate, Scales};
use super::side_by_side::each;
use super::state::{Instant, Instants, MOST_STAGED, MOST_VALUES, Staged, Values};
use super::{
    cubic_stiffness, drive_nonlinearity, end_stop, quadratic_damping, quadratic_stiffness, readout_nonlinearity,
    squeeze_film_damping, stiffness_drift,
};

/// Law whose form is freed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freed {
    /// Cubic stiffness, βx³.
    CubicSpring,
    /// Quadratic stiffness, αx².
    QuadraticSpring,
    /// Quadratic damping, c₂|x′|x′.
    Drag,
    /// c x²x′, as a damping that depends on x.
    Film,
    /// κu², over the gain.
    Drive,
    /// Contact beyond a gap: stiffer or softer the deeper, with a gap of its own on either side.
    Stop(Side),
    /// κt of the stiffness, along another course of time.
    Drift,
    /// k₂x² + k₃x³ of the reading: with a bend about zero besides, down to a dead zone.
    Readout,
}

/// Quantity that a law depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// Displacement of the mass.
    Displacement,
    /// Velocity of the mass.
    Velocity,
    /// The measured input.
    Input,
    /// Time since the recording began.
    Time,
}

/// A law with a free form.
///
/// With all of it free: laws that are a power of their argument a: stated(a) · sᵈ · (c + e(s −
/// 0.7) + h sgn a), s = |a|/size, values c, d, e, h; the stated law is d = e = h = 0. Time has one
/// sign: a drift has h (s − 0.7)² instead. A stop: k δ (δ/size)ᵈ for a depth δ
/// beyond the gap, values k, gap, d, and by how much the other side's gap is wider. A readout:
/// k₂x² + k₃x³ − b s(x/w), values k₂, k₃, b, w. With one value free only d is; the values
/// after it are zero. Of a readout all four are free in both extents: where narrow, s is tanh and
/// rounds the bend, where wide, it has the corners of a dead zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeForm {
    /// The law whose form is freed.
    pub law: Freed,
    /// A typical size of its argument (of the depth, for a stop).
    pub size: f64,
    /// Part of the form that is free.
    pub extent: Extent,
}

/// Part of a form that is free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// One coefficient, an exponent; of a readout, a rounded bend.
    Narrow,
    /// All coefficients of the form; of a readout, a bend with corners.
    Wide,
}

impl Default for FreeForm {
    fn default() -> Self {
        Self { law: Freed::CubicSpring, size: 1.0, extent: Extent::Wide }
    }
}

/// Values of a form.
pub const VALUES: usize = 4;
/// Place about which the slope of the form turns, in sizes.
const PIVOT: f64 = 0.7;

impl Freed {
    /// Returns the argument that it depends on.
    pub fn argument(self) -> Argument {
        match self {
            Self::CubicSpring | Self::QuadraticSpring | Self::Film | Self::Stop(_) | Self::Readout => {
                Argument::Displacement
            }
            Self::Drag => Argument::Velocity,
            Self::Drive => Argument::Input,
            Self::Drift => Argument::Time,
        }
    }

    /// The stated form, as a function of its argument.
    pub fn stated(self) -> &'static str {
        match self {
            Self::CubicSpring => "x^3",
            Self::QuadraticSpring => "x^2",
            Self::Drag => "|v| v",
            Self::Film => "x^2 v",
            Self::Drive => "u^2",
            Self::Stop(_) => "(x - gap)+",
            Self::Drift => "t",
            Self::Readout => "k2 x^2 + k3 x^3",
        }
    }

    /// Returns whether it is the stated form times a function of its argument.
    fn is_power(self) -> bool {
        !matches!(self, Self::Stop(_) | Self::Readout)
    }

    /// The stated form at an argument, of strength 1.
    #[inline(always)]
    fn power<T: Real>(self, a: T) -> T {
        match self {
            Self::CubicSpring => a * a * a,
            Self::Drag => a.abs() * a,
            Self::Drift => a,
            _ => a * a,
        }
    }
}

impl FreeForm {
    /// The law at argument `a`.
    #[inline(always)]
    pub fn curve<T: Real, const FMA: bool>(&self, p: &[T], a: T) -> T {
        let zero = T::of(0.0);
        let [first, second, third, fourth] = [p[0], p[1], p[2], p[3]];
        match self.law {
            Freed::Stop(side) => {
                let gap = if side == Side::Both { second + fourth } else { second };
                let upper = if side == Side::Lower { zero } else { self.push([first, third], a - second) };
                let lower = if side == Side::Upper { zero } else { self.push([first, third], -a - gap) };
                upper - lower
            }
            Freed::Readout => {
                let s = a / fourth.max(T::of(1e-300));
                let step = match self.extent {
                    Extent::Narrow => by(s, exponential::tanh),
                    Extent::Wide => s.max(T::of(-1.0)).min(T::of(1.0)),
                };
                a * a * fma::<T, FMA>(second, a, first) - third * step
            }
            law => {
                let s = (a.abs() / T::of(self.size)).max(T::of(LEAST));
                let turn = s - T::of(PIVOT);
                let more = match law {
                    Freed::Drift => fourth * turn * turn,
                    _ if a < zero => -fourth,
                    _ => fourth,
                };
                law.power(a) * bounded_power(s, second) * (fma::<T, FMA>(third, turn, first) + more)
            }
        }
    }

    /// Returns the force of a stop of this stiffness and further exponent at a depth.
    #[inline(always)]
    fn push<T: Real>(&self, [stiffness, exponent]: [T; 2], depth: T) -> T {
        let deep = (depth / T::of(self.size)).max(T::of(LEAST));
        stiffness * depth.max(T::of(0.0)) * bounded_power(deep, exponent)
    }

    /// Adds the forces on N masses to their accelerations: one loop for each form, as a choice
    /// among them inside the loop keeps it from becoming vector code.
    #[inline(always)]
    pub(super) fn forces<T: Real, const N: usize, const FMA: bool>(
        &self,
        at: &Instants<'_, T, N>,
        p: &Values<T, N>,
        own: &Staged<T, N>,
        rates: &mut Staged<T, N>,
        acceleration: &mut [T; N],
    ) {
        macro_rules! one_of {
            ($($law:pat => $form:expr),* $(,)?) => {
                match self.law {
                    $($law => each::<_, T, N, FMA>(&Self { law: $form, ..*self }, at, p, own, rates, acceleration)),*
                }
            };
        }
        one_of! {
            Freed::CubicSpring => Freed::CubicSpring,
            Freed::QuadraticSpring => Freed::QuadraticSpring,
            Freed::Drag => Freed::Drag,
            Freed::Film => Freed::Film,
            Freed::Drive => Freed::Drive,
            Freed::Stop(Side::Both) => Freed::Stop(Side::Both),
            Freed::Stop(Side::Lower) => Freed::Stop(Side::Lower),
            Freed::Stop(Side::Upper) => Freed::Stop(Side::Upper),
            Freed::Drift => Freed::Drift,
            Freed::Readout => Freed::Readout,
        }
    }

    /// Values at which it is the stated law, or nearly so, with these of the stated law's
    /// parameters. `typical` is the root mean square of its argument.
    pub fn narrow_starts(&self, stated: &[f64], typical: f64) -> Vec<Vec<f64>> {
        match self.law {
            Freed::Stop(_) => {
                let (k, gap) = (stated[0], stated[1]);
                vec![vec![k, gap, 0.0], vec![1.3 * k, gap - 0.3 * self.size, 0.5]]
            }
            Freed::Readout => [0.05, 0.2, 0.7].map(|w| vec![stated[0], stated[1], 0.0, w * typical]).to_vec(),
            _ => vec![vec![stated[0], 0.0]],
        }
    }

    /// Values of the wide form at, or next to, these of the narrow one.
    pub fn wide_starts(&self, narrow: &[f64], typical: f64) -> Vec<Vec<f64>> {
        if self.law == Freed::Readout {
            let dead = vec![0.0, 0.0, narrow[2], narrow[2].abs().max(0.01 * typical)];
            return vec![narrow.to_vec(), dead];
        }
        let more: Vec<[f64; 2]> = match self.law {
            Freed::Stop(_) => vec![[0.0; 2]],
            _ => vec![[0.0; 2]],
        };
        more.into_iter().map(|m| narrow.iter().copied().chain(m).take(VALUES).collect()).collect()
    }
}

impl Law for FreeForm {
    fn candidate(&self) -> &'static Candidate {
        match self.law {
            Freed::CubicSpring => &cubic_stiffness::CANDIDATE,
            Freed::QuadraticSpring => &quadratic_stiffness::CANDIDATE,
            Freed::Drag => &quadratic_damping::CANDIDATE,
            Freed::Film => &squeeze_film_damping::CANDIDATE,
            Freed::Drive => &drive_nonlinearity::CANDIDATE,
            Freed::Stop(_) => &end_stop::CANDIDATE,
            Freed::Drift => &stiffness_drift::CANDIDATE,
            Freed::Readout => &readout_nonlinearity::CANDIDATE,
        }
    }
    fn role(&self) -> Role {
        match self.law {
            Freed::Readout => Role::Readout(Place::Nonlinearity),
            _ => Role::Force,
        }
    }
    fn values(&self) -> usize {
        match (self.extent, self.law) {
            (Extent::Wide, _) | (_, Freed::Readout) => VALUES,
            (Extent::Narrow, Freed::Stop(_)) => 3,
            (Extent::Narrow, _) => 2,
        }
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let (omega, zeta) = (s.omega_rad_s, s.zeta);
        let spring = omega * omega;
        let strength = match self.law {
            Freed::CubicSpring => 0.1 * spring / s.output.powi(2),
            Freed::QuadraticSpring => 0.1 * spring / s.output,
            Freed::Drag => zeta * omega / s.velocity,
            Freed::Film => zeta * omega / s.output.powi(2),
            Freed::Drive => 0.1 / s.input.max(1e-300),
            Freed::Stop(_) => spring,
            Freed::Drift => 0.1 / s.duration_s,
            Freed::Readout => 0.1 / s.output,
        };
        let linear = Coordinate::Linear(strength);
        // Below zero they would feed the motion.
        let damps = matches!(self.law, Freed::Drag | Freed::Film);
        let own = if damps { Coordinate::Bounded(strength, 0.0, f64::MAX) } else { linear };
        let mut all = match self.law {
            Freed::Stop(_) => vec![
                Coordinate::Log(0.01 * spring, 1e4 * spring),
                Coordinate::Log(0.1 * s.output, 10.0 * s.output),
                Coordinate::Bounded(0.1, -0.7, 6.0),
                Coordinate::Linear(0.1 * s.output),
            ],
            Freed::Readout => vec![
                linear,
                Coordinate::Linear(0.1 / s.output.powi(2)),
                Coordinate::Linear(0.1 * s.output),
                Coordinate::Log(0.003 * s.output, 2.0 * s.output),
            ],
            // A spring that drifts begins as it is at rest: not slower than as t^0.1.
            Freed::Drift => vec![linear, Coordinate::Bounded(0.1, -0.9, 4.0), linear, linear],
            _ => vec![own, Coordinate::Bounded(0.1, -2.0, 4.0), linear, linear],
        };
        all.truncate(self.values());
        all
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        let fastest = match self.law {
            Freed::Stop(_) => (p[0].max(0.0) + s.omega_rad_s.powi(2)).sqrt(),
            _ => 0.0,
        };
        fastest.min(7.0 * s.omega_rad_s)
    }
    fn has_corner(&self) -> bool {
        !self.law.is_power()
    }
    fn needs_input(&self) -> bool {
        self.law == Freed::Drive
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        match self.law {
            Freed::Drive => fma::<T, FMA>(at.gain, self.curve::<T, FMA>(p, at.input), sum),
            Freed::Film => fma::<T, FMA>(-self.curve::<T, FMA>(p, at.x), at.v, sum),
            Freed::Drag => sum - self.curve::<T, FMA>(p, at.v),
            Freed::Drift => fma::<T, FMA>(-(at.stiffness * self.curve::<T, FMA>(p, at.time)), at.x, sum),
            Freed::Readout => sum,
            _ => sum - self.curve::<T, FMA>(p, at.x),
        }
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        match self.law {
            Freed::Readout => y + self.curve::<f64, false>(p, y),
            _ => y,
        }
    }
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests;
