//! An effect that a verdict names: its numbers with their intervals, the part of the error that it
//! removes, and why it is believed.

use serde::Serialize;

use crate::physics::free_form::Freed;

/// A fitted number with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Symbol of the parameter, as in the equation.
    pub name: String,
    /// Estimated value, in `unit`.
    pub value: f64,
    /// Unit of the value and of its interval.
    pub unit: String,
    /// 95 % confidence interval, lower and upper end.
    pub ci95: [f64; 2],
}

/// Part of the excess error of free simulation, that over the noise, on samples that were not
/// fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Share {
    /// Part that is removed; 1 is all of it.
    pub value: f64,
    /// 95 % interval, from the scatter between blocks.
    pub ci95: [f64; 2],
}

/// Quantity on which the residual depends.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DependsOn {
    /// "displacement", "velocity", "time", …
    pub name: String,
    /// Part of the residual's excess error that a free function of it removes.
    pub share: Share,
}

/// Why an effect is believed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evidence {
    /// Share of the held-out mean-square error (beyond the noise floor) or log-score gain that it
    /// removes.
    pub held_out_gain: f64,
    /// Corrected for the number of candidates tried.
    pub p_value: f64,
}

/// States how far a named law departs from the form that its name states.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Form {
    /// The law whose form was freed.
    #[serde(skip)]
    pub law: Freed,
    /// The stated form, as a function of its argument.
    pub stated: String,
    /// Root mean square of the departure over that of the stated form, over the arguments visited.
    pub departure: f64,
    /// Its 95 % interval; from zero where the stated form predicts as well.
    pub ci95: [f64; 2],
    /// Argument and value of the law with a free form, without what the base model's own parameters
    /// do.
    pub curve: Vec<[f64; 2]>,
    /// The stated form at the same arguments.
    #[serde(skip)]
    pub stated_curve: Vec<[f64; 2]>,
    /// States whether unseen samples tell the free form from the stated one.
    #[serde(skip)]
    pub departs: bool,
}

/// An effect that the verdict names, with parameters and evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Effect {
    /// Id in the library of candidates.
    pub id: String,
    /// One sentence about what was left out.
    pub statement: String,
    /// The law as an equation.
    pub equation: String,
    /// Estimates of its parameters with their intervals.
    pub parameters: Vec<Estimate>,
    /// Columns it shows in.
    pub channels: Vec<String>,
    /// States how far it departs from its stated form, where it has one that was freed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
    /// Why it is believed.
    pub evidence: Evidence,
    /// Part of the error that it removes from the model without it, where models are judged by free
    /// simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<Share>,
    /// Ids that fit equally or nearly so.
    pub confusable_with: Vec<String>,
    /// The base model's numbers next to this law, where it stands in another one's place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub base: Vec<Estimate>,
}

/// Names with their channels, one effect in several channels, or several times in one, stated once:
/// "random-walk (ax, ay); warm-up (az)".
pub fn named(effects: &[Effect]) -> String {
    let mut all: Vec<(&str, Vec<&str>)> = Vec::new();
    for effect in effects {
        let place = all.iter().position(|(id, _)| *id == effect.id).unwrap_or(all.len());
        if place == all.len() {
            all.push((&effect.id, Vec::new()));
        }
        let known = &mut all[place].1;
        for channel in &effect.channels {
            if !known.contains(&channel.as_str()) {
                known.push(channel);
            }
        }
    }
    all.iter().map(|(id, channels)| format!("{id} ({})", channels.join(", "))).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sines_of_one_axis_name_it_once_and_those_of_two_name_both() {
        let effect = |id: &str, channels: &[&str]| Effect {
            id: id.into(),
            statement: String::new(),
            equation: String::new(),
            parameters: Vec::new(),
            channels: channels.iter().map(|c| (*c).to_owned()).collect(),
            form: None,
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            confusable_with: Vec::new(),
            base: Vec::new(),
        };
        let found = [
            effect("sinusoid", &["wy"]),
            effect("random-walk", &["wx", "wy"]),
            effect("sinusoid", &["wy"]),
            effect("sinusoid", &["wz"]),
        ];
        assert_eq!(named(&found), "sinusoid (wy, wz); random-walk (wx, wy)");
    }
}
