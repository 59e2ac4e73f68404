//! What a run has summed up so far: the file that an interrupted run leaves and a resumed one goes on from.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::backend::Partial;
use crate::document::{hexadecimal, write_whole};
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::statistics::histogram::BINS;
use crate::statistics::{Bins, Histogram, Machine, Moments};

/// Sums at one report time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    /// Per quantity.
    pub moments: [Moments; 4],
    /// Per quantity.
    pub histograms: Vec<Histogram>,
    /// Members that failed.
    pub failed: u64,
}

/// Sums of a run up to `next_member`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    schema: String,
    /// Digest of the job and the machine: sums of another run must not be mixed in.
    fingerprint: String,
    /// First member not yet summed.
    pub next_member: u64,
    /// Bins per report time and quantity.
    pub bins: Vec<[Bins; 4]>,
    /// Sums per report time.
    pub reports: Vec<Report>,
}

const SCHEMA: &str = "proofmass.state/1";

impl State {
    /// Nothing summed yet.
    pub fn new(job: &Job, machine: &Machine) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            fingerprint: fingerprint(job, machine),
            next_member: 0,
            bins: Vec::new(),
            reports: Vec::new(),
        }
    }

    /// Sets the bins; nothing may have been summed.
    pub fn set_bins(&mut self, bins: Vec<[Bins; 4]>) {
        let report = |b: &[Bins; 4]| Report {
            moments: [Moments::default(); 4],
            histograms: b.iter().map(|b| Histogram::new(*b)).collect(),
            failed: 0,
        };
        self.reports = bins.iter().map(report).collect();
        self.bins = bins;
    }

    /// Adds the members of a batch, which ends before `next_member`.
    pub fn add(&mut self, partials: &[Partial], next_member: u64) {
        for (report, partial) in self.reports.iter_mut().zip(partials) {
            for block in &partial.blocks {
                report.moments.iter_mut().zip(block).for_each(|(mine, theirs)| mine.merge(theirs));
            }
            for (mine, theirs) in report.histograms.iter_mut().zip(&partial.histograms) {
                mine.merge(&theirs.counts);
            }
            report.failed += partial.failed;
        }
        self.next_member = next_member;
    }

    /// Leaves the file, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_vec(self)
            .map_err(|e| Error::new(format!("could not write {}", path.display()), e.to_string(), "run again"))?;
        write_whole(path, &text)
    }

    /// Reads the file of the same job on the same machine.
    ///
    /// # Errors
    /// There is none, it is damaged, or it belongs to another run.
    pub fn read(path: &Path, job: &Job, machine: &Machine) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io("resume from", path, &e))?;
        let attempt = format!("could not resume from {}", path.display());
        let hint = "leave --resume out to begin anew";
        let state: Self = serde_json::from_slice(&bytes).map_err(|e| Error::new(&*attempt, e.to_string(), hint))?;
        if state.schema != SCHEMA || state.fingerprint != fingerprint(job, machine) {
            return Err(Error::new(attempt, "it belongs to another study, seed, precision or machine", hint));
        }
        let whole = |h: &Histogram| h.counts.len() == BINS + 2;
        let whole = state.reports.len() == state.bins.len()
            && (state.bins.is_empty() || state.bins.len() == job.clock.report_samples.len())
            && state.reports.iter().all(|r| r.histograms.len() == 4 && r.histograms.iter().all(whole))
            && state.next_member <= job.members;
        if whole { Ok(state) } else { Err(Error::new(attempt, "the file is damaged", hint)) }
    }
}

/// A digest of what decides the numbers: the clock, a few members as drawn, the excitation at a few times, the machine.
fn fingerprint(job: &Job, machine: &Machine) -> String {
    let mut hash = Sha256::new();
    let duration_s = job.clock.duration_s();
    let force: Vec<f64> = (0..64).map(|i| job.waveform.specific_force_m_s2(duration_s * f64::from(i) / 64.0)).collect();
    let members: Vec<_> = [0, 1, job.members / 2, job.members - 1].iter().map(|&i| (job.draw)(i)).collect();
    let version = env!("CARGO_PKG_VERSION");
    hash.update(format!(
        "{version} {} {} {:?} {:?} {} {force:?} {members:?} {machine:?}",
        job.seed, job.members, job.clock, job.integrator, job.gravity_m_s2
    ));
    hexadecimal(&hash.finalize())
}
