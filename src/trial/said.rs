//! What a verdict said, as far as a trial judges it.

use serde::{Deserialize, Serialize};

use crate::diagnosis::verdict::{Outcome, Verdict};

/// A fitted number with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Effect it belongs to.
    pub id: String,
    /// Column it belongs to, where there are several.
    pub channel: String,
    /// Symbol.
    pub name: String,
    /// Value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// One verdict, in brief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Said {
    /// The outcome's word, or "error".
    pub outcome: String,
    /// Named effects; under "undecidable" those that tie stand in one group.
    pub groups: Vec<Vec<String>>,
    /// Fitted numbers of the named effects.
    pub numbers: Vec<Number>,
    /// rmse of the base and of the repaired model on data not fitted, and the noise floor.
    pub rmse: [f64; 3],
    /// How long it took.
    pub seconds: f64,
    /// In words: the verdict's sentence or the error.
    pub words: String,
}

impl Said {
    /// From the public document.
    pub fn from_verdict(verdict: &Verdict, seconds: f64) -> Self {
        let mut groups: Vec<Vec<String>> = Vec::new();
        for effect in &verdict.effects {
            let mut group = vec![effect.id.clone()];
            if verdict.verdict == Outcome::Undecidable {
                group.extend(effect.confusable_with.iter().cloned());
            }
            // Groups that share a member are one.
            let (touching, apart): (Vec<_>, Vec<_>) =
                groups.into_iter().partition(|g| g.iter().any(|id| group.contains(id)));
            groups = apart;
            group.extend(touching.into_iter().flatten());
            group.sort();
            group.dedup();
            groups.push(group);
        }
        let numbers = verdict
            .effects
            .iter()
            .flat_map(|effect| {
                effect.parameters.iter().map(|p| Number {
                    id: effect.id.clone(),
                    channel: effect.channels.first().cloned().unwrap_or_default(),
                    name: p.name.clone(),
                    value: p.value,
                    ci95: p.ci95,
                })
            })
            .collect();
        let test = verdict.fit.test;
        Self {
            outcome: verdict.verdict.name().into(),
            groups,
            numbers,
            rmse: [test.rmse_before, test.rmse_after, verdict.fit.noise_floor],
            seconds,
            words: verdict.sentence.clone(),
        }
    }

    /// When the diagnosis stopped with an error.
    pub fn from_error(error: &crate::error::Error, seconds: f64) -> Self {
        Self {
            outcome: "error".into(),
            groups: Vec::new(),
            numbers: Vec::new(),
            rmse: [0.0; 3],
            seconds,
            words: error.to_string(),
        }
    }

    /// All ids, sorted.
    pub fn ids(&self) -> Vec<String> {
        let mut ids: Vec<String> = self.groups.iter().flatten().cloned().collect();
        ids.sort();
        ids.dedup();
        ids
    }
}
