//! Two campaigns: effects concealed in every way that occurs, and effects planted in the open, one
//! and two at a time.

use serde::{Deserialize, Serialize};

use super::case::Family;

/// Aim of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Campaign {
    /// Every family: how the diagnosis fares where effects hide.
    Concealed,
    /// Driven recordings only: each candidate alone at 1 % and at 5 % of the output, two at once,
    /// force noise only, foreign physics, and as many recordings with nothing planted.
    Planted,
}

impl Campaign {
    /// Cases of a family in a trial of full size. Enough nulls that silence in all of them proves
    /// fewer than 1 % false alarms (1 − 0.025^(1/368) = 1 %); single effects in multiples of the
    /// library's length.
    pub fn cases_of(self, family: Family) -> usize {
        match (self, family) {
            (_, Family::Null) => 300,
            (Self::Concealed, Family::ForceNoiseOnly) => 20,
            (Self::Planted, Family::ForceNoiseOnly) => 30,
            (_, Family::SingleOnePercent | Family::SingleFivePercent) => 63,
            (Self::Concealed, Family::Pair) => 40,
            (Self::Planted, Family::Pair) => 60,
            (_, Family::UnknownPhysics) => 40,
            (Self::Planted, _) => 0,
            (_, Family::UnderTheNoise | Family::AbsorbedByBase) => 21,
            (_, Family::AmplitudesNotRecorded) => 15,
            (_, Family::LookAlikes) => 24,
            (_, Family::BehindALarger) => 20,
            (_, Family::RareInTime) => 12,
            (_, Family::AroundTheLimit) => 63,
            (_, Family::RingDown) => 15,
            (_, Family::StillNull) => 60,
            (_, Family::StillPlanted) => 54,
            (_, Family::WithheldColumn) => 12,
            (_, Family::StillUnknown | Family::TurnedUnknown) => 20,
            (_, Family::TurnedNull) => 40,
            (_, Family::TurnedPlanted) => 36,
            (_, Family::Unsearched) => 12,
        }
    }

    /// Cases of a trial of full size, without those of families that are drawn behind all others
    /// ([`Family::is_drawn_last`]).
    pub fn size(self) -> usize {
        Family::ALL.iter().filter(|family| !family.is_drawn_last()).map(|family| self.cases_of(*family)).sum()
    }

    /// Rows per driven recording and per log at rest in a trial of full size.
    pub fn samples(self) -> usize {
        match self {
            Self::Concealed => 10_000,
            Self::Planted => 20_000,
        }
    }
}
