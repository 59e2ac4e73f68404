//! parts.toml: candidate sensors, each put into the study in turn to see whether it meets a
//! requirement.
//!
//! Every part is simulated with the same members; few of them decide where it is far from the
//! limit.

use std::path::Path;

use serde::Deserialize;
use toml::Table;

use super::statistic::Limit;
use super::values::{FIRST, Place, Work};
use crate::control::Control;
use crate::document::read_toml;
use crate::error::{Error, Result};
use crate::statistics::Estimate;
use crate::study::StudyText;
use crate::study::source::Sensor;

/// A parts catalogue, as parts.toml gives it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Catalogue {
    /// Parts of the catalogue.
    pub part: Vec<Part>,
}

/// `[[part]]`: one purchasable sensor of the catalogue.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// Price in any one currency.
    pub price: Option<f64>,
    /// Takes the place of the study's `[accelerometer]`.
    pub accelerometer: Option<Table>,
    /// Takes the place of the study's `[gyro]`.
    pub gyro: Option<Table>,
}

/// A part and whether it meets the requirement.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Name of the part.
    pub name: String,
    /// Price, in the catalogue's currency.
    pub price: Option<f64>,
    /// Says whether a study with it meets the requirement.
    pub meets: bool,
    /// Says whether the interval of the statistic says so too.
    pub sure: bool,
    /// Value of the limited statistic with its standard error.
    pub statistic: Estimate,
    /// Names of errors that the study has and the part, in whose place it comes, does not state: none of them is
    /// simulated with it.
    pub unstated: Vec<&'static str>,
}

impl Catalogue {
    /// Reads a parts.toml.
    ///
    /// # Errors
    /// A file that cannot be read, an unknown key, no part, two of one name.
    pub fn read(path: &Path) -> Result<Self> {
        let catalogue: Self = read_toml(path)?;
        let refuse = |cause: String| {
            let hint =
                "a part is [[part]] with name, price, [part.accelerometer] and [part.gyro] in the keys of study.toml";
            Err(Error::new(format!("could not use {}", path.display()), cause, hint))
        };
        for (n, part) in catalogue.part.iter().enumerate() {
            if catalogue.part[..n].iter().any(|other| other.name == part.name) {
                return refuse(format!("two parts are called `{}`", part.name));
            }
            if part.accelerometer.is_none() && part.gyro.is_none() {
                return refuse(format!("the part `{}` has neither an accelerometer nor a gyro", part.name));
            }
            if part.price.is_some_and(|price| !price.is_finite()) {
                return refuse(format!("the price of `{}` is not a finite number", part.name));
            }
        }
        if catalogue.part.is_empty() { refuse("it contains no [[part]]".into()) } else { Ok(catalogue) }
    }
}

/// A catalogue and the requirement to rank it by.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The requirement that a study with the part in place must meet.
    pub limit: &'a Limit,
    /// The parts to rank.
    pub parts: &'a Catalogue,
    /// Most members of one part, where not the usual.
    pub most: Option<u64>,
}

/// Judges every part; those that meet the requirement come first, the cheapest of them before all,
/// and the others by how far they miss it. Also the members that it took.
///
/// # Errors
/// A part that cannot be simulated, a time outside the run; stopped.
pub fn judge(source: &StudyText, asked: &Asked<'_>, control: &Control) -> Result<(Vec<Judged>, u64)> {
    let mut work = Work::new(control, "judging parts");
    let mut judged: Vec<Judged> = Vec::new();
    for part in &asked.parts.part {
        judged.push(judge_one(source, asked, part, &mut work)?);
    }
    judged.sort_by(|a, b| {
        let price = |part: &Judged| part.price.unwrap_or(f64::INFINITY);
        let cheaper = if a.meets { price(a).total_cmp(&price(b)) } else { std::cmp::Ordering::Equal };
        b.meets.cmp(&a.meets).then(cheaper).then(a.statistic.value.total_cmp(&b.statistic.value))
    });
    Ok((judged, work.members()))
}

fn judge_one(source: &StudyText, asked: &Asked<'_>, part: &Part, work: &mut Work<'_>) -> Result<Judged> {
    let limit = asked.limit;
    let sensor = Sensor { accelerometer: part.accelerometer.clone(), gyro: part.gyro.clone() };
    let study = source.with_sensor(&part.name, &sensor)?;
    let unstated = source.study()?.unstated_in(&study);
    let place = Place::of(limit, &study)?;
    let mut values = Vec::new();
    let (mut members, most) = (4 * FIRST, place.most_members(&study, asked.most));
    loop {
        let more = work.values(&study, place, values.len() as u64..members)?;
        values.extend(more);
        let kept: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        let statistic = limit.statistic.estimate(&kept);
        let [low, high] = statistic.ci95;
        // Where every member failed there is no statistic, and the part is out.
        let sure = statistic.value.is_nan() || high < limit.below || low >= limit.below;
        if sure || members >= most {
            let meets = statistic.value < limit.below;
            return Ok(Judged { name: part.name.clone(), price: part.price, meets, sure, statistic, unstated });
        }
        members = (4 * members).min(most);
    }
}
