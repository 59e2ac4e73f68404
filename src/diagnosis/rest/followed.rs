//! States how a channel follows an environment column: which one, with what delay, by which powers
//! of it.

use super::profile::Profiled;

/// A column and the shape in which it is followed.
#[derive(Debug, Clone)]
pub(super) struct Followed {
    pub(super) column: String,
    /// States how it is delayed.
    pub(super) delay: Delay,
    /// Holds what one unit of the curves is in units of the column.
    pub(super) unit: f64,
    /// Which power of the column each curve is.
    pub(super) powers: &'static [i32],
}

/// States how a reading comes after the column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Delay {
    None,
    /// A first-order lag; in samples.
    Lag(Profiled),
    /// It moves when the column has moved by the play; half its width, in units of the column.
    Play(Profiled),
    /// A lag in samples, then play: a housing that warms late and holds what moves in it.
    LagAndPlay(Profiled, Profiled),
}

impl Followed {
    /// At once and along a straight line, in units of the column.
    pub(super) fn straight(column: &str) -> Self {
        Self { column: column.into(), delay: Delay::None, unit: 1.0, powers: &[1] }
    }
}

impl Delay {
    /// A column as it acts after this delay; a lag is in its samples.
    pub(super) fn of(self, column: &[f64]) -> Vec<f64> {
        match self {
            Self::None => column.to_vec(),
            Self::Lag(lag) => lagged(column, lag.value),
            Self::Play(play) => played(column, play.value),
            Self::LagAndPlay(lag, play) => played(&lagged(column, lag.value), play.value),
        }
    }

    /// Free numbers of it.
    pub(super) fn numbers(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Lag(_) | Self::Play(_) => 1.0,
            Self::LagAndPlay(..) => 2.0,
        }
    }

    /// The same in samples of which as many make one.
    pub(super) fn in_samples(self, together: usize) -> Self {
        self.times(together as f64)
    }

    /// The same in means of as many samples.
    pub(super) fn in_means(self, together: usize) -> Self {
        self.times(1.0 / together as f64)
    }

    fn times(self, factor: f64) -> Self {
        let longer = |lag: Profiled| lag.map(|v| v * factor);
        match self {
            Self::Lag(lag) => Self::Lag(longer(lag)),
            Self::LagAndPlay(lag, play) => Self::LagAndPlay(longer(lag), play),
            other => other,
        }
    }
}

/// After a first-order lag of this many samples, settled at the beginning.
pub(super) fn lagged(column: &[f64], samples: f64) -> Vec<f64> {
    let keep = (-1.0 / samples).exp();
    let mut state = column.first().copied().unwrap_or(0.0);
    let step = |v: &f64| {
        state = keep * state + (1.0 - keep) * v;
        state
    };
    column.iter().map(step).collect()
}

/// After play of so wide a half.
pub(super) fn played(column: &[f64], half: f64) -> Vec<f64> {
    let mut state = column.first().copied().unwrap_or(0.0);
    let step = |v: &f64| {
        state = state.clamp(v - half, v + half);
        state
    };
    column.iter().map(step).collect()
}
