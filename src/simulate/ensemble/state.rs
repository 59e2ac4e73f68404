//! Holds what a part of a run has summed up so far, and which run it is a part of.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::backend::cpu::Precision;
use crate::backend::{Partial, Unfinished};
use crate::document::hexadecimal;
use crate::kernel::job::Job;
use crate::kernel::layout::state::TERMS;
use crate::statistics::{Bins, Fold, Histogram, Machine, Origin};

/// Sums at one report time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Report {
    /// Of the blocks summed.
    pub moments: Fold,
    /// Histograms, one per quantity.
    pub histograms: Vec<Histogram>,
    /// Members excluded from these sums because they failed.
    pub failed: u64,
}

/// Sums of a part of a run: of the members from the first of `members` up to `next_member`.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct State {
    pub(super) schema: String,
    /// SHA-256 of this document with this field empty.
    pub(super) sha256: String,
    /// Digest of the run: sums of another one must not be mixed in.
    pub(super) fingerprint: String,
    /// The members to sum: all of the job, or those of a shard. Begins with a block.
    pub members: Range<u64>,
    /// First member not yet summed.
    pub next_member: u64,
    /// Wall time that it took so far, s.
    pub seconds: f64,
    /// Machines on which the members summed were integrated.
    pub origins: Vec<Origin>,
    /// Bins per report time and quantity; none before the pilot is done.
    pub bins: Vec<[Bins; 4]>,
    /// Sums per report time.
    pub reports: Vec<Report>,
    /// A batch that was stopped between two tiles, of the pilot where there are no bins yet, and
    /// its machine.
    pub(super) under_way: Option<(Machine, Unfinished)>,
}

pub(super) const SCHEMA: &str = "proofmass.state/3";

/// A part of a run, as far as its numbers depend on it. Not the backend: sums from several may be
/// mixed, and say so.
pub(super) struct Run<'a> {
    /// Digest of the study.
    pub identity: &'a str,
    /// Number of the part, from 1 on.
    pub part: usize,
    /// Ensemble that it integrates.
    pub job: &'a Job,
    /// Precision of the kernels.
    pub precision: Precision,
}

impl Run<'_> {
    /// A digest of it.
    pub(super) fn fingerprint(&self) -> String {
        let Self { identity, part, job, precision } = self;
        let version = env!("CARGO_PKG_VERSION");
        // The number of values kept per member: a state of another layout cannot be read.
        let text = format!(
            "{version} {TERMS} {identity} {part} {precision:?} {} {} {:?} {:?} {:?}",
            job.seed, job.members, job.clock, job.integrator, job.gravity_m_s2
        );
        hexadecimal(&Sha256::digest(text))
    }
}

impl State {
    /// Nothing summed yet of these members.
    pub(super) fn new(run: &Run<'_>, members: Range<u64>) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            sha256: String::new(),
            fingerprint: run.fingerprint(),
            next_member: members.start,
            members,
            seconds: 0.0,
            origins: Vec::new(),
            bins: Vec::new(),
            reports: Vec::new(),
            under_way: None,
        }
    }

    /// Sets the bins; nothing may have been summed.
    pub(super) fn set_bins(&mut self, bins: Vec<[Bins; 4]>) {
        let report = |b: &[Bins; 4]| Report {
            moments: Fold::default(),
            histograms: b.iter().map(|b| Histogram::new(*b)).collect(),
            failed: 0,
        };
        self.reports = bins.iter().map(report).collect();
        self.bins = bins;
    }

    /// Returns whether all of its members are summed.
    pub(super) fn is_done(&self) -> bool {
        self.next_member >= self.members.end
    }

    /// Adds the next members, as many as the partials are of.
    pub(super) fn add(&mut self, partials: &[Partial], machine: &Machine, reason: Option<&str>) {
        let first = self.next_member / BLOCK;
        for (report, partial) in self.reports.iter_mut().zip(partials) {
            (first..).zip(&partial.blocks).for_each(|(block, moments)| report.moments.add_block(block, moments));
            for (mine, theirs) in report.histograms.iter_mut().zip(&partial.histograms) {
                mine.merge(&theirs.counts);
            }
            report.failed += partial.failed;
        }
        let blocks = partials.first().map_or(0, |partial| partial.blocks.len() as u64);
        let end = self.members.end.min(self.next_member + blocks * BLOCK);
        match self.origins.last_mut() {
            Some(last) if last.machine.same_bits(machine) => last.members.end = end,
            _ => {
                let (members, reason) = (self.next_member..end, reason.map(str::to_owned));
                self.origins.push(Origin { members, machine: machine.clone(), reason });
            }
        }
        self.next_member = end;
    }

    /// The machine that has integrated most members.
    pub(super) fn machine(&self) -> Machine {
        let most = self.origins.iter().max_by_key(|o| o.members.end - o.members.start);
        most.map_or_else(Machine::default, |o| o.machine.clone())
    }

    /// The batch that was stopped on such a machine; nothing of it can be used on another.
    pub(super) fn under_way(&self, machine: &Machine) -> Option<&Unfinished> {
        self.under_way.as_ref().filter(|(on, _)| on.same_bits(machine)).map(|(_, unfinished)| unfinished)
    }

    /// Notes a batch that was stopped, or that none is.
    pub(super) fn set_under_way(&mut self, batch: Option<(Machine, Unfinished)>) {
        self.under_way = batch;
    }
}

/// Members whose moments are summed apart and then merged in order.
pub(super) const BLOCK: u64 = 256;
