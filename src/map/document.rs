//! map.toml: the oscillator, its drive, and which parameters are laid out over which ranges.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use proofmass_base::error::{Error, Result};
use proofmass_physics::dynamics::duffing::Oscillator;

/// map.toml: an oscillator, its drive, and the maps and diagrams to compute.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Name of the report.
    #[serde(default = "unnamed")]
    pub name: String,
    /// Seed of the force noise.
    #[serde(default)]
    pub seed: u64,
    /// Coefficients of equation 6.
    pub oscillator: Coefficients,
    /// Drive; also the point marked in the maps.
    pub drive: Force,
    /// Maps over two parameters.
    #[serde(default)]
    pub map: Vec<Map>,
    /// Diagrams along the force.
    #[serde(default)]
    pub bifurcation: Vec<Diagram>,
}

fn unnamed() -> String {
    "map".into()
}

/// `[oscillator]`: m x″ + D₀x′ + kx + εx³ = F.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Coefficients {
    /// Mass m, kg.
    #[serde(default = "one")]
    pub mass_kg: f64,
    /// Damping D₀, kg/s.
    pub damping_kg_s: f64,
    /// Linear stiffness k, N/m.
    pub stiffness_n_m: f64,
    /// Cubic stiffness ε, N/m³.
    pub cubic_n_m3: f64,
}

fn one() -> f64 {
    1.0
}

impl From<Coefficients> for Oscillator {
    fn from(c: Coefficients) -> Self {
        Self {
            mass_kg: c.mass_kg,
            damping_kg_s: c.damping_kg_s,
            stiffness_n_m: c.stiffness_n_m,
            cubic_n_m3: c.cubic_n_m3,
        }
    }
}

/// `[drive]`: F₀ cos ωt, with either frequency key.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Amplitude F₀ of the force, N.
    pub amplitude_n: f64,
    /// Drive frequency ω, rad/s.
    omega_rad_s: Option<f64>,
    /// Drive frequency ω/2π, Hz.
    frequency_hz: Option<f64>,
}

impl Force {
    /// ω, whichever key gave it.
    pub fn omega_rad_s(&self) -> f64 {
        self.omega_rad_s.or(self.frequency_hz.map(|f| 2.0 * std::f64::consts::PI * f)).unwrap_or(f64::NAN)
    }
}

/// Parameter that an axis may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Amplitude F₀ of the force, N.
    AmplitudeN,
    /// Angular frequency ω of the force, rad/s.
    OmegaRadS,
    /// Frequency ω/2π of the force, Hz.
    FrequencyHz,
    /// Cubic stiffness ε, N/m³.
    CubicNM3,
    /// Damping D₀, kg/s.
    DampingKgS,
    /// Linear stiffness k, N/m.
    StiffnessNM,
}

impl Quantity {
    /// Symbol and unit for an axis.
    pub fn label(self) -> &'static str {
        match self {
            Quantity::AmplitudeN => "amplitude of the force F₀ / N",
            Quantity::OmegaRadS => "angular frequency ω / (rad/s)",
            Quantity::FrequencyHz => "frequency / Hz",
            Quantity::CubicNM3 => "cubic stiffness ε / (N/m³)",
            Quantity::DampingKgS => "damping D₀ / (kg/s)",
            Quantity::StiffnessNM => "stiffness k / (N/m)",
        }
    }
}

/// One axis of a map: evenly spaced cells from `from` to `to`, values at the cells' centres.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// Parameter along the axis; the ends below are in its unit.
    pub quantity: Quantity,
    /// Lower edge of the first cell.
    pub from: f64,
    /// Upper edge of the last cell.
    pub to: f64,
    /// Number of cells.
    pub points: u32,
}

impl Range {
    /// Value at the centre of a cell.
    pub fn at(&self, cell: u32) -> f64 {
        self.from + (self.to - self.from) * (f64::from(cell) + 0.5) / f64::from(self.points)
    }
}

/// `[[map]]`: two parameters, each cell an orbit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// Heading in the report.
    pub title: String,
    /// Parameter along the horizontal axis.
    pub x: Range,
    /// Parameter along the vertical axis.
    pub y: Range,
    /// Transient periods before averaging.
    #[serde(default = "default_count")]
    pub transient_periods: u32,
    /// Number of periods in the average.
    #[serde(default = "default_count")]
    pub periods: u32,
    /// White force noise, two-sided coefficient, N·√s.
    #[serde(default)]
    pub noise_n_rts: f64,
}

fn default_count() -> u32 {
    100
}

/// `[[bifurcation]]`: the force swept up and down.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Diagram {
    /// Heading in the report.
    pub title: String,
    /// Lowest amplitude of the force, N.
    pub from_n: f64,
    /// Highest amplitude of the force, N.
    pub to_n: f64,
    /// Amplitudes from `from_n` to `to_n`.
    pub points: u32,
    /// Periods after each change before strobing.
    #[serde(default = "default_count")]
    pub transient_periods: u32,
    /// Strobes recorded at each amplitude, one per forcing period.
    #[serde(default = "default_count")]
    pub strobes: u32,
    /// White force noise, two-sided coefficient, N·√s.
    #[serde(default)]
    pub noise_n_rts: f64,
}

/// Most cells of one map, and most strobes of one diagram: minutes on two cores.
const MOST: u64 = 1 << 24;

/// Sizes between which a proof mass has all its numbers, in SI units, and the arithmetic all its
/// powers of them.
const LARGEST: f64 = 1e18;
const SMALLEST: f64 = 1e-18;

impl Document {
    /// Refuses what cannot be computed, naming the key.
    ///
    /// # Errors
    /// The first number that is out of its range, with its key.
    pub fn check(&self) -> Result<()> {
        let positive = |key: &str, value: f64| match value {
            v if (SMALLEST..=LARGEST).contains(&v) => Ok(()),
            v => Err(wrong(key, v, &format!("a number from {SMALLEST:?} to {LARGEST:?}"))),
        };
        let not_negative = |key: &str, value: f64| match value {
            v if (0.0..=LARGEST).contains(&v) => Ok(()),
            v => Err(wrong(key, v, &format!("a number from 0 to {LARGEST:?}"))),
        };
        positive("oscillator.mass_kg", self.oscillator.mass_kg)?;
        positive("oscillator.damping_kg_s", self.oscillator.damping_kg_s)?;
        positive("oscillator.stiffness_n_m", self.oscillator.stiffness_n_m)?;
        not_negative("oscillator.cubic_n_m3", self.oscillator.cubic_n_m3)?;
        not_negative("drive.amplitude_n", self.drive.amplitude_n)?;
        if self.drive.omega_rad_s.is_some() == self.drive.frequency_hz.is_some() {
            return Err(Error::new(
                "could not use [drive]",
                "need one of omega_rad_s and frequency_hz",
                "omega_rad_s = 1.5 is 1.5 rad/s; frequency_hz = 1.5 is 9.42 rad/s",
            ));
        }
        positive("drive.omega_rad_s", self.drive.omega_rad_s())?;
        if self.map.is_empty() && self.bifurcation.is_empty() {
            return Err(Error::new(
                "could not use the map file",
                "it has neither [[map]] nor [[bifurcation]]",
                "see `proofmass map --help` for an example",
            ));
        }
        for (i, map) in self.map.iter().enumerate() {
            for (name, axis) in [("x", &map.x), ("y", &map.y)] {
                let key = |part: &str| format!("map[{i}].{name}.{part}");
                positive(&key("to"), axis.to)?;
                not_negative(&key("from"), axis.from)?;
                if axis.from >= axis.to {
                    return Err(wrong(&key("from"), axis.from, "less than `to`"));
                }
                count(&key("points"), u64::from(axis.points), 1 << 13)?;
            }
            count(&format!("map[{i}].periods"), u64::from(map.periods), 1 << 20)?;
            count(&format!("map[{i}].transient_periods"), u64::from(map.transient_periods) + 1, 1 << 20)?;
            count(&format!("map[{i}] cells"), u64::from(map.x.points) * u64::from(map.y.points), MOST)?;
            not_negative(&format!("map[{i}].noise_n_rts"), map.noise_n_rts)?;
            if map.x.quantity == map.y.quantity {
                return Err(Error::new(
                    format!("could not use map[{i}]"),
                    "both axes hold the same quantity",
                    "choose two, e.g. amplitude_n along x and omega_rad_s along y",
                ));
            }
        }
        for (i, d) in self.bifurcation.iter().enumerate() {
            not_negative(&format!("bifurcation[{i}].from_n"), d.from_n)?;
            positive(&format!("bifurcation[{i}].to_n"), d.to_n)?;
            if d.from_n >= d.to_n {
                return Err(wrong(
                    &format!("bifurcation[{i}].from_n"),
                    d.from_n,
                    "less than `to_n`: it is swept both ways",
                ));
            }
            count(&format!("bifurcation[{i}].points"), u64::from(d.points), MOST)?;
            count(&format!("bifurcation[{i}].strobes"), u64::from(d.strobes), MOST)?;
            count(&format!("bifurcation[{i}].transient_periods"), u64::from(d.transient_periods) + 1, 1 << 20)?;
            count(&format!("bifurcation[{i}] strobes"), u64::from(d.points) * u64::from(d.strobes), MOST)?;
            let periods = u64::from(d.transient_periods) + u64::from(d.strobes);
            count(&format!("bifurcation[{i}] periods"), u64::from(d.points) * periods, 1 << 28)?;
            not_negative(&format!("bifurcation[{i}].noise_n_rts"), d.noise_n_rts)?;
        }
        Ok(())
    }
}

fn wrong(key: &str, value: f64, need: &str) -> Error {
    Error::new(
        format!("could not use {key}"),
        format!("need {need}, got {value:?}"),
        "correct the number and run again",
    )
}

fn count(key: &str, value: u64, most: u64) -> Result<()> {
    if (1..=most).contains(&value) {
        return Ok(());
    }
    Err(Error::new(
        format!("could not use {key}"),
        format!("need 1 to {most}, got {value}"),
        "correct the number and run again",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_base::document::parse_toml;

    #[test]
    fn the_paper_s_own_map_is_in_order_and_mistakes_are_named() {
        let text = include_str!("../../reports/map/map.toml");
        let document: Document = parse_toml("map.toml", text).expect("the committed map parses");
        document.check().expect("and is in order");
        let misspelt = text.replacen("transient_periods", "transient_period", 1);
        let error = parse_toml::<Document>("map.toml", &misspelt).expect_err("misspelt");
        assert_eq!(error.hint, "did you mean `transient_periods`?");
        let both = text.replacen("omega_rad_s = 1.5", "omega_rad_s = 1.5\nfrequency_hz = 1.5", 1);
        let document: Document = parse_toml("map.toml", &both).expect("parses");
        assert!(document.check().is_err());
        let mut endless: Document = parse_toml("map.toml", text).expect("the committed map parses");
        endless.bifurcation[0].transient_periods = u32::MAX;
        assert!(endless.check().is_err_and(|e| e.attempt.contains("bifurcation[0].transient_periods")));
    }
}
