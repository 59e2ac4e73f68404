//! How far a navigator in motion errs in position at the report times: one run, without budget,
//! covariance or windows. Not for a study's own answer (`answer`).

use super::kept::Kept;
use super::run;
use crate::backend::flight::{FlightCpu, Quantity};
use crate::control::Control;
use crate::error::Result;
use crate::study::Study;
use crate::study::in_motion::InMotion;

/// Returns the report times, s, each with the root mean square over members of the distance from the
/// truth, m.
///
/// # Errors
/// Mechanics that no integrator can step; stopped.
pub fn position_rms_m(study: &Study, motion: &InMotion, control: &Control) -> Result<Vec<(f64, f64)>> {
    let flight = study.flight(motion, study.clock.report_samples.clone())?;
    let ensemble = run::run(&flight, &mut FlightCpu::default(), &mut Kept::none(), control)?;
    let rms_m = |report: usize| {
        let axis = |axis: usize| {
            let error = ensemble.summary(report, Quantity::Position(axis));
            error.mean.powi(2) + error.sd.powi(2)
        };
        (0..3).map(axis).sum::<f64>().sqrt()
    };
    Ok(ensemble.time_s.iter().enumerate().map(|(k, time_s)| (*time_s, rms_m(k))).collect())
}
