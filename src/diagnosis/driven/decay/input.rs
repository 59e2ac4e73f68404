//! The way of the input between its samples: what a wrong one leaves looks like linear laws.

use std::sync::Arc;

use crate::driven::intake::data::Data;
use crate::driven::intake::input::Interpolation;
use crate::driven::simulated::rows::Rows;
use crate::driven::simulated::system::System;
use crate::engine::fit::{Fitted, MOST_STEPS, fit};
use crate::engine::kind::{Argument, Form, Kind};
use crate::engine::search::Search;

/// Another way of the input between its samples on which the first of these models that can does as well without
/// the linear laws that it holds, or better than it does now: steps look late by half a sample, straight lines
/// like a weak low-pass. Of a set that is too inexact to be named, these laws may be what is wrong with it.
pub(super) fn other_input(system: &System, noise: f64, models: &[&Fitted]) -> Option<Interpolation> {
    let input = system.rows.data.input.as_ref()?;
    let tried = |how: Interpolation| {
        let other = System { rows: rows(&system.rows, how), ..system.clone() };
        models.iter().find_map(|model| left(&other, system, noise, model)).map(|left| (how, left))
    };
    let others = [Interpolation::Hold, Interpolation::Linear].into_iter().filter(|how| *how != input.interpolation);
    others.filter_map(tried).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(how, _)| how)
}

/// The same recording with its input going this way.
pub(super) fn gone(data: &Data, how: Interpolation) -> Data {
    Data { input: data.input.clone().map(|input| input.gone(how)), ..data.clone() }
}

/// The same rows with the input going this way.
pub(super) fn rows(rows: &Rows, how: Interpolation) -> Rows {
    Rows { data: gone(&rows.data, how), ..rows.clone() }
}

/// Error of a model on another input, where it is as good there without its linear laws, or with one law in the place
/// of several, or better.
fn left(other: &System, system: &System, noise: f64, model: &Fitted) -> Option<f64> {
    let is_linear = |law: &usize| other.argument(*law) == Argument::Frequency;
    let (mut set, mut point) = (model.set.clone(), model.point.clone());
    while let Some(place) = set.iter().position(is_linear) {
        point = other.without(&set, &point, place);
        set.remove(place);
    }
    let has_fewer = set.len() < model.set.len();
    let base = (0..set.len()).rev().fold(point.clone(), |point, place| other.without(&set[..=place], &point, place));
    let (search, _) = Search::begin(other, noise, &base)?;
    let without = search.at(&set, &point)?;
    let is_as_good = |f: &Fitted| f.set.len() < model.set.len() && search.gain(f, model).is_chance();
    if is_as_good(&without) {
        return Some(without.error);
    }
    // Where the rest of the model does no better there, no linear law makes up for that.
    let is_worth_it = || fit(system, &set, &point, MOST_STEPS).is_none_or(|here| without.error < here.error);
    let with = if has_fewer && is_worth_it() { search.children(&without, Form::Stated, false) } else { Vec::new() };
    // Where one of the linear laws is large, it hides from the rest on which input that does better.
    let whole = search.at(&model.set, &model.point);
    let places = |f: &Fitted| (0..f.set.len()).filter(|place| is_linear(&f.set[*place])).collect::<Vec<_>>();
    let less = |f: &Arc<Fitted>| -> Vec<_> { places(f).into_iter().filter_map(|p| search.without(f, p)).collect() };
    let one_less = whole.as_ref().map(less).unwrap_or_default();
    let good = with.into_iter().chain(one_less).chain(whole).chain([without]);
    let good = good.filter(|f| is_as_good(f) || search.holds(model, f));
    good.map(|f| f.error).min_by(f64::total_cmp)
}
