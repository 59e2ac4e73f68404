//! Rules of a driven diagnosis that can change a name or the verdict, each with an id.
//!
//! A rule that acts records a [`Step`](crate::trace::Step); a rule that is switched off
//! (`Driven::without`) never acts, so that its worth can be measured. Not for the rules themselves:
//! each stands where it acts.

use serde::{Serialize, Serializer};

macro_rules! gates {
    ($($variant:ident $id:literal $statement:literal $quantity:literal;)*) => {
        /// A rule that can change a name or the verdict.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Gate { $(#[doc = $statement] $variant,)* }

        impl Gate {
            /// Every gate, in the order of the chain.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// Name in `verdict.json` and in `--without`.
            pub fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// Returns what the rule says, in a sentence without a full stop.
            pub fn statement(self) -> &'static str {
                match self { $(Self::$variant => $statement,)* }
            }

            /// Returns what its value and threshold measure; empty where it has none.
            pub fn quantity(self) -> &'static str {
                match self { $(Self::$variant => $quantity,)* }
            }
        }
    };
}

gates! {
    // The base model.
    BaseInterpolation "base-interpolation" "Hold or linear input where the base model then leaves far less" "remaining share of its error";
    NoLinearLaw "no-linear-law" "The recording does not follow a linear oscillator" "";
    Chaos "chaos" "A chaotic response is compared in windows" "largest Lyapunov exponent, 1/s";
    FreeBody "free-body" "A body without a spring is searched by the force that it takes" "turns of the resonance";
    // The search.
    InputLine "input-line" "An oscillation at a line of the input may be caused by it" "";
    SearchBound "search-bound" "A candidate at the end of its plausible range is not added" "";
    PartOfRest "part-of-rest" "A term must gain a part of what is still unexplained with it" "held-out gain";
    InTurn "in-turn" "All samples judge in turn where the validation samples show nothing" "p";
    Pruned "pruned" "A term whose absence costs nothing is removed" "lead in log-likelihood";
    NoRivals "no-rivals" "A model of several terms that is far from done is not compared with its rivals" "predictable share of the residual";
    Swap "swap" "A better candidate takes a term's place" "lead in log-likelihood";
    Tie "tie" "A candidate that fits as well in a term's place stays its rival" "lead in log-likelihood";
    KeptBack "kept-back" "A second pole, a mode or a second mass replaces or ties the linear terms" "lead in log-likelihood";
    FreeForm "free-form" "A law with a free form replaces what only patched the stated form" "lead in log-likelihood";
    FreeRival "free-rival" "A law whose free form fits as well stays a rival" "";
    PowerForStop "power-for-stop" "A spring of one power replaces a stop that it fits as well or better" "lead in log-likelihood";
    OwnPower "own-power" "A law with its own exponent replaces a stated law that departs" "lead in log-likelihood";
    OwnCourse "own-course" "A drift along one power of time replaces laws of time that imitate it together" "lead in log-likelihood";
    OwnSharpness "own-sharpness" "Hysteresis with its own exponent replaces what was chosen" "lead in log-likelihood";
    OtherInput "other-input" "Hold or linear input replaces linear terms that it explains as well" "";
    SmoothInput "smooth-input" "The search on a band-limited input replaces that on a held or linear one" "lead in log-likelihood";
    HalfSample "half-sample" "A readout behind a smooth input replaces a held input that lags by less than half a sample" "lead in log-likelihood";
    // The conclusion.
    ColouredReadout "coloured-readout" "Autocorrelated readout noise replaces noise inside the sensor" "one-step error over that with noise inside";
    Worsens "worsens" "A term that makes the prediction of the test samples worse is dropped" "test error with it over that without";
    Bound "bound" "A term with a parameter at the end of its plausible range is dropped" "";
    NoSecondResonance "no-second-resonance" "A mode is no second resonance where the first has become a creep" "damping ratio";
    MayBeNothing "may-be-nothing" "A term whose interval includes zero is dropped" "strength, against the half-width of its 95 % interval";
    LeastPart "least-part" "A law that adds next to nothing to what the others remove is not named" "growth of the error without it";
    Inexactness "inexactness" "Noise within the modelling error of the named laws is not named" "growth of the error without it";
    KnownSignal "known-signal" "Noise that follows a known signal is dropped: a law is missing" "predictable share of the noise";
    SmoothTrend "smooth-trend" "A random walk that a smooth trend describes better is dropped" "";
    Twins "twins" "Two faint terms that can be mistaken for each other are dropped" "growth of the error without it";
    RoundedReadings "rounded-readings" "Coarse rounding that explains the residual counts as named" "gain in log-likelihood per sample";
    Disturbance "disturbance" "A disturbance in the residual is a faint residual" "p";
    FewCycles "few-cycles" "Too few cycles of the resonance determine nothing" "cycles";
    LinearClass "linear-class" "Linear laws that the input cannot tell apart are indistinguishable" "";
    // Where the named terms do not account for the mismatch.
    StandIn "stand-in" "A term that does not tower above the residual is not named in an unexplained verdict" "growth of the error without it";
    NoiseAlone "noise-alone" "Noise alone is not named in an unexplained verdict" "";
    NoBase "no-base" "Nothing is named in an unexplained verdict whose base model the recording does not follow" "";
}

impl Gate {
    /// The gate of this id.
    pub fn of_id(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|gate| gate.id() == id)
    }
}

impl Serialize for Gate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_distinct_and_lead_back_to_their_gates() {
        for gate in Gate::ALL {
            assert_eq!(Gate::of_id(gate.id()), Some(*gate));
            assert!(!gate.statement().ends_with('.') && gate.id().chars().all(|c| c.is_ascii_lowercase() || c == '-'));
        }
        assert_eq!(Gate::of_id("no-such-gate"), None);
    }
}
