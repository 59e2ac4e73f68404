//! A candidate: physics that a base model may have left out. Words and numbers only; how each is
//! simulated and fitted lives with its kind (driven, static, tumble, trajectory, response). Ids are a public
//! contract.

/// The kind of recording a candidate belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Input and output of one proof mass, or its free ring-down.
    Driven,
    /// A sensor at rest.
    Static,
    /// An IMU in many still poses.
    Tumble,
    /// An IMU in motion.
    Trajectory,
    /// Stepped-sine sweeps of a resonator.
    Response,
}

impl Kind {
    /// Every kind of recording.
    pub const ALL: [Self; 5] = [Self::Driven, Self::Static, Self::Tumble, Self::Trajectory, Self::Response];

    /// Value of `kind` in model.toml.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Driven => "driven",
            Kind::Static => "static",
            Kind::Tumble => "tumble",
            Kind::Trajectory => "trajectory",
            Kind::Response => "response",
        }
    }
}

/// One parameter of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Symbol in the equation.
    pub name: &'static str,
    /// Unit, with `u` for the input's and `y` for the output's unit.
    pub unit: &'static str,
    /// Plausible range. Of a tumble in those units (a scale: its relative error). Of a driven
    /// recording in multiples of the size that the recording makes typical (a spring's: as strong
    /// as the linear one), but for frequencies in Hz and ratios. At rest the sign alone is known
    /// beforehand.
    pub range: (f64, f64),
}

/// The library's entry of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// Public id, e.g. "cubic-stiffness".
    pub id: &'static str,
    /// Kind of recording that can show it.
    pub kind: Kind,
    /// One sentence: what was left out.
    pub statement: &'static str,
    /// The term, as an equation.
    pub equation: &'static str,
    /// Its free parameters, with units and plausible ranges.
    pub parameters: &'static [Parameter],
    /// Place where it acts: "equation of motion", "readout", …
    pub acts: &'static str,
    /// Features of a residual that point to it.
    pub signature: &'static str,
    /// Ids it can be mistaken for.
    pub confusable_with: &'static [&'static str],
    /// Literature on the effect.
    pub reference: &'static str,
}
