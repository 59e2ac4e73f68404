//! Which parts of the kernel a job needs: the rest is compiled away.

use crate::backend::cpu::column;
use crate::error::Result;
use crate::kernel::job::Job;
use crate::kernel::member::{Column, column};
use crate::kernel::source;
use crate::physics::coefficients::{StudyLaw, laws};
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{Sense, SensorTerm};

/// Members of the whole job that are asked which parts of the kernel it needs.
const ASKED: u64 = 256;

/// Which parts of the kernel the job needs: the rest is compiled away. Members from all over the
/// job are asked next to those of the batch, so that every batch of a job runs the same kernel: two
/// compilations may round differently.
pub(super) fn constants(job: &Job, batch: &[Column]) -> Result<Vec<(String, f64)>> {
    let drawn = asked(job, batch)?;
    let any = |c: usize| drawn.iter().any(|d| d.values[c] != 0.0);
    let has = |term: SensorTerm| drawn.iter().any(|d| d.has(term));
    let some = |wanted: &dyn Fn(SensorTerm) -> bool| SensorTerm::ALL.into_iter().any(|t| wanted(t) && has(t));
    let flag = |on: bool| f64::from(u8::from(on));
    let reading = |t: SensorTerm| matches!(t.law(), ErrorLaw::Proportional(_));
    let mut constants = vec![
        ("INTEGRATOR".to_owned(), job.integrator.method().code() as f64),
        ("SUBSTEPS".to_owned(), job.steps_per_sample() as f64),
        ("HAS_FORCE".to_owned(), flag(any(column::FORCE))),
        ("HAS_SINE".to_owned(), flag(any(column::SINE))),
        ("HAS_GYRO".to_owned(), flag(some(&|t| t.sense() == Sense::Gyro))),
        ("HAS_READING".to_owned(), flag(some(&reading))),
        ("HAS_STILL".to_owned(), flag(job.clock.still_samples > 0)),
    ];
    constants.extend(SensorTerm::ALL.map(|term| (source::terms::switch(term), flag(has(term)))));
    Ok(constants)
}

/// The laws that some member follows, by the same members.
pub(super) fn acting(job: &Job, batch: &[Column]) -> Result<Vec<StudyLaw>> {
    let drawn = asked(job, batch)?;
    let acts = |law: &&StudyLaw| drawn.iter().any(|d| d.laws[law.first] != 0.0);
    Ok(laws().iter().filter(acts).copied().collect())
}

/// The members of a batch and some from all over the job.
fn asked(job: &Job, batch: &[Column]) -> Result<Vec<Column>> {
    let asked = job.members.min(ASKED);
    let mut drawn = (0..asked).map(|i| column(job, i * (job.members / asked))).collect::<Result<Vec<Column>>>()?;
    drawn.extend_from_slice(batch);
    Ok(drawn)
}
