//! The units of a recording against its model: where the model says nothing, the file's unit holds;
//! where both say something, they must agree.

use std::borrow::Cow;

use super::model::{Model, Static};
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::roles::{self, Stated};
use crate::recording::scale::Named;
use crate::recording::unit::{Quantity, Unit};

/// The key of a model that states a unit.
const KEY: &str = "the model's `unit`";

/// Refuses a model that contradicts the units of a recording.
///
/// # Errors
/// A `unit` that is not the file's, or columns of rates under `accelerometer` and of forces under
/// `gyro`.
pub(super) fn check(recording: &Recording, model: &Model) -> Result<()> {
    let in_words = |name: &String, unit: &str| named(recording, name, Quantity::Unknown).check_words(unit);
    let sensors = |gyro: &Option<[String; 3]>, accelerometer: Option<&[String; 3]>| {
        let rates = gyro.iter().flatten().map(|name| (name, Quantity::Gyro));
        let forces = accelerometer.into_iter().flatten().map(|name| (name, Quantity::Accelerometer));
        rates.chain(forces).try_for_each(|(name, quantity)| named(recording, name, quantity).check(None))
    };
    match model {
        Model::Driven(model) => model.unit.as_deref().map_or(Ok(()), |unit| in_words(&model.columns.output, unit)),
        Model::Response(model) => {
            let read = model.columns.x.as_ref().or(model.columns.amplitude.as_ref());
            model.unit.as_deref().zip(read).map_or(Ok(()), |(unit, name)| in_words(name, unit))
        }
        Model::Static(model) if model.unit.is_empty() => Ok(()),
        Model::Static(model) => model.columns.channels.iter().try_for_each(|name| in_words(name, &model.unit)),
        Model::Tumble(model) => sensors(&model.columns.gyro, Some(&model.columns.accelerometer)),
        Model::Trajectory(model) => sensors(&model.columns.gyro, model.columns.accelerometer.as_ref()),
    }
}

fn named<'a>(recording: &'a Recording, name: &'a str, quantity: Quantity) -> Named<'a> {
    Named { name, stated: recording.stated(name), quantity, option: KEY }
}

/// The unit of a channel at rest: the model's, else the file's, else one of which nothing is said.
pub(super) fn of(recording: &Recording, name: &str, model: &Static) -> Unit {
    let stated = || match roles::stated(name, recording.stated(name)) {
        Some(Stated::Inertial(unit)) => Some(unit),
        _ => None,
    };
    Unit::of_file(&model.unit).or_else(stated).unwrap_or_else(Unit::unknown)
}

/// Words for it, where model or file state one.
pub(super) fn words(recording: &Recording, name: &str, model: &Static) -> Option<String> {
    let of_file = || match roles::stated(name, recording.stated(name)) {
        Some(Stated::Inertial(_)) => recording.unit_words(name),
        _ => None,
    };
    Some(&model.unit).filter(|unit| !unit.is_empty()).cloned().or_else(of_file)
}

/// The model with the unit that the file states for all of its channels, where the model has none.
pub(super) fn settled<'a>(recording: &Recording, model: &'a Static) -> Cow<'a, Static> {
    let mut units = model.columns.channels.iter().map(|name| words(recording, name, model));
    let first = units.next().flatten();
    match first {
        Some(unit) if model.unit.is_empty() && units.all(|other| other.as_ref() == Some(&unit)) => {
            Cow::Owned(Static { unit, ..model.clone() })
        }
        _ => Cow::Borrowed(model),
    }
}
