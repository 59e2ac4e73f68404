//! The keys of a study that logs at rest give: noise coefficients with their spread from log to log, and
//! the bias of a gyro. An accelerometer's mean holds gravity and how it was levelled, so that its spread is
//! none of the sensor's.

use super::agreement::{Agreement, Line};
use super::parameter::{AtRest, Estimate, Parameter};
use crate::by_axis::{Drawn, three};
use crate::numerics::allan::law::Term;
use crate::recording::roles;
use crate::recording::unit::Quantity;
use crate::sensor::estimated::estimated;
use crate::sensor::{Sense, SensorTerm};

/// Lines of a sense's section, where its three axes are known by their headings and their unit is.
pub(super) fn section(agreement: &Agreement, of: &Estimate, sense: Sense) -> Vec<String> {
    let found: Vec<(&AtRest, &Line)> = agreement.lines.iter().filter_map(|line| Some((at(of, line)?, line))).collect();
    let mut names: Vec<String> = found.iter().map(|(at, _)| at.channel.clone()).collect();
    names.dedup();
    let roles = roles::of(&names);
    let (axes, quantity) = match sense {
        Sense::Gyro => (roles.gyro, Quantity::Gyro),
        Sense::Accelerometer => (roles.accelerometer, Quantity::Accelerometer),
    };
    let Some(axes) = axes else { return Vec::new() };
    let told = |term: Option<Term>, place: usize| {
        let is_asked =
            |(at, _): &&(&AtRest, &Line)| at.channel == names[place] && at.term == term && at.unit.quantity == quantity;
        found.iter().find(is_asked).and_then(|(at, line)| drawn(at, line)).unwrap_or_default()
    };
    let bias = (None, &SensorTerm::GyroBias.row().keys[0]);
    let noise = estimated(sense).into_iter().map(|(term, key)| (Some(term), key));
    let keys = (sense == Sense::Gyro).then_some(bias).into_iter().chain(noise);
    keys.map(|(term, key)| three(key, axes.map(|place| told(term, place)))).collect()
}

fn at<'a>(of: &'a Estimate, line: &Line) -> Option<&'a AtRest> {
    match &of.parameters[line.parameter] {
        Parameter::AtRest(at) => Some(at),
        Parameter::Element(_) | Parameter::Named(_) => None,
    }
}

/// Mean over the logs and standard deviation of the next, SI.
fn drawn(at: &AtRest, line: &Line) -> Option<Drawn> {
    let spread = line.spread?;
    let (mean, sd) = (spread.mean, spread.of_the_next_run());
    let drawn = match at.term {
        // Logarithms: a spread of a share of the mean.
        Some(_) => Drawn { mean: mean.exp() * at.unit.si, sd: mean.exp() * sd * at.unit.si },
        None => Drawn { mean: mean * at.unit.si, sd: sd * at.unit.si },
    };
    (drawn.mean.is_finite() && drawn.sd.is_finite()).then_some(drawn)
}
