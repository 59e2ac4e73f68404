//! When terms that each earn a place say less together than apart: many laws at once, or several
//! that can be mistaken for each other, are the beginning of a series for something that the
//! library does not hold.

use crate::physics::library::Term;

use super::rivals::alike;

/// Laws that may be named together: to say that a model left out more at once claims more than one
/// recording can show.
pub(crate) const MOST_LAWS: usize = 3;

/// Terms that only together do the work of something that the library does not hold; whatever
/// stands beside them was fitted to what they leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Series {
    /// More laws than may be named at once.
    ManyLaws,
    /// Three that can be mistaken for each other.
    LookAlikes,
}

impl Series {
    /// The reason as a clause for a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Series::ManyLaws => "more than three laws at once",
            Series::LookAlikes => "three that can be mistaken for each other",
        }
    }
}

/// Whether these terms are a series.
pub(crate) fn series(terms: &[Term]) -> Option<Series> {
    let laws = terms.iter().filter(|t| t.noise().is_none()).count();
    let look_alikes = |t: &Term| terms.iter().filter(|other| *other != t && alike(t, other)).count();
    if laws > MOST_LAWS {
        return Some(Series::ManyLaws);
    }
    terms.iter().any(|t| look_alikes(t) > 1).then_some(Series::LookAlikes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{
        bias_drift::BiasDrift, cubic_stiffness::CubicStiffness, force_noise::ForceNoise, parasitic_mode::ParasiticMode,
        readout_delay::ReadoutDelay, readout_lowpass::ReadoutLowpass, squeeze_film_damping::SqueezeFilmDamping,
    };

    #[test]
    fn more_than_three_laws_at_once_are_a_series_and_noise_is_no_law() {
        let laws = [
            Term::CubicStiffness(CubicStiffness),
            Term::ReadoutDelay(ReadoutDelay),
            Term::BiasDrift(BiasDrift),
            Term::SqueezeFilmDamping(SqueezeFilmDamping),
        ];
        let unlike = |a: &Term| laws.iter().all(|b| a == b || !alike(a, b));
        assert!(laws.iter().all(unlike), "look-alikes would show another rule");
        assert_eq!(series(&laws[..MOST_LAWS]), None);
        assert_eq!(series(&[&laws[..MOST_LAWS], &[Term::ForceNoise(ForceNoise)]].concat()), None);
        assert_eq!(series(&laws), Some(Series::ManyLaws));
        let late = [
            Term::ReadoutDelay(ReadoutDelay),
            Term::ReadoutLowpass(ReadoutLowpass::default()),
            Term::ParasiticMode(ParasiticMode),
        ];
        assert_eq!(series(&late), Some(Series::LookAlikes));
        assert_eq!(series(&late[..2]), None);
    }
}
