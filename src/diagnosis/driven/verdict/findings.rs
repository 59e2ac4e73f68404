//! What is found besides the physics, as clauses.

use super::dropped::{Dropped, LeftOut};

/// Why a term has no name, as a clause.
pub fn dropped(reason: Dropped) -> String {
    match reason {
        Dropped::Indispensable => "the model breaks down without it, so that nothing says what it adds".into(),
        Dropped::Worsens => "made the prediction of the test samples worse".into(),
        Dropped::FollowsRounding => "follows only the rounding of the readings; carried along, not named".into(),
        Dropped::SmallerThanTheRest => "smaller than what is still unexplained; carried along, not named".into(),
        Dropped::WithinInexactness => {
            "too small beside what the other terms explain to be told from their inexactness; carried along, not named"
                .into()
        }
        Dropped::Twin => "only together with another that it can be mistaken for".into(),
        Dropped::Series(series) => format!("only in a series: {}", series.words()),
        Dropped::StandIn => "a stand-in: does not bring the residual to the noise".into(),
    }
}

/// What was left undone, as a clause.
pub fn left_out(what: LeftOut) -> &'static str {
    match what {
        LeftOut::Profiles => {
            "the intervals of laws with a corner are those of a parabola: their profiles were not finished"
        }
        LeftOut::WeighingAgain => "terms were not weighed again without one that made the prediction worse",
    }
}
