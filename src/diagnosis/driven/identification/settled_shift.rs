//! Decides whether an input that was moved in time stays where it was moved to.
//!
//! A lag is seen in the spectra, where a mass that rings for longer than they are long looks out of
//! step with its input. What counts is whether the base model, started from the same places, follows
//! the moved input better than the one that was recorded; and whether whole samples are what it lags
//! by, as two columns of a file do, and not a delay of the sensor.

use crate::driven::intake::data::Data;
use crate::driven::intake::prepare::Prepared;
use crate::driven::intake::reading_noise::{Sample, reading_noise};
use crate::driven::intake::shift::Shift;
use crate::driven::intake::stretches;
use crate::model;
use crate::parallel;
use crate::physics::input_lag::InputLag;
use crate::physics::library::Term;
use crate::physics::readout_delay::ReadoutDelay;
use crate::physics::scales::Scales;

use super::fit::{self, Fit};
use super::start;

/// The shift stays if the residual variance above the noise falls below this fraction of what it is
/// without the shift.
const BY_FAR: f64 = 0.5;
/// A delay is preferred to a shift of whole samples if its residual variance is below this fraction
/// of the shift's.
const CLEARLY: f64 = 0.9;
/// Iterations of a fit with such a delay.
const DELAY_ITERATIONS: usize = 25;

/// Moves the input back unless the base model follows it far better where it was moved; the notes
/// report a move that stays.
pub(crate) fn settled(mut prepared: Prepared) -> Prepared {
    let Some(shift) = prepared.shift.take() else { return prepared };
    let narrow = stretches::loudest(&prepared.data);
    if stays(&shift, narrow.as_ref().unwrap_or(&prepared.data), &prepared.start) {
        shift.noted(&mut prepared.notes);
        return prepared;
    }
    Prepared { data: shift.undone(&prepared.data), ..prepared }
}

fn stays(shift: &Shift, moved: &Data, hints: &model::Start) -> bool {
    let recorded = shift.undone(moved);
    let (there, before) = parallel::join(|| start::base(moved, hints), || start::base(&recorded, hints));
    let variance = |found: Option<&(Fit, Scales)>| found.map_or(f64::INFINITY, |f| f.0.variance);
    let noise = reading_noise(&Sample::of(moved)).map_or(0.0, |n| n.deviation.powi(2));
    let above_noise = |found: Option<&(Fit, Scales)>| (variance(found) - noise).max(0.0);
    let delayed = || there.as_ref().and_then(|(base, scales)| with_delay(shift, &recorded, base, scales));
    let is_delay = || delayed().is_some_and(|with| with < CLEARLY * variance(there.as_ref()));
    above_noise(there.as_ref()) < BY_FAR * above_noise(before.as_ref()) && !is_delay()
}

/// Residual variance of the base model with a delay of the sensor, or of its input, that begins at
/// the length of the shift.
fn with_delay(shift: &Shift, recorded: &Data, base: &Fit, scales: &Scales) -> Option<f64> {
    let scales = Scales { lag_samples: shift.lag_samples(), ..scales.clone() };
    let late = [Term::ReadoutDelay(ReadoutDelay), Term::InputLag(InputLag)];
    let fits = late.into_iter().filter_map(|term| {
        // The one that begins at the lag, where the term has its sign.
        let start = term.starts(&scales).into_iter().find(|start| start[0] > 0.0)?;
        let (structure, point) = base.with(term, &start);
        fit::fit(recorded, &structure, &point, &scales, DELAY_ITERATIONS)
    });
    fits.map(|fit| fit.variance).min_by(f64::total_cmp)
}
