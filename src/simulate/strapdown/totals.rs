//! The sums of an ensemble in motion over all batches: blocks of 256 members merged in the order of
//! a fixed tree, counts as integers, so that neither batches nor stops change a bit.

use serde::{Deserialize, Serialize};

use crate::backend::flight::{QUANTITIES, Sums};
use crate::kernel::cpu::reduce::BLOCK;
use crate::kernel::flight::Flight;
use crate::statistics::{Bins, Fold, Histogram, Moments, Summary};

/// Groups of four quantities, as a tree merges them.
const GROUPS: usize = QUANTITIES / 4;

/// Sums at one report time.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Report {
    moments: [Fold; GROUPS],
    histograms: Vec<Histogram>,
    failed: u64,
}

/// Sums at all of them; none before the pilot has set the bins.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Totals {
    reports: Vec<Report>,
}

impl Totals {
    /// Nothing summed yet, on the bins that a pilot has set.
    pub(super) fn new(pilot: &[Sums]) -> Self {
        let report = |sums: &Sums| Report {
            moments: Default::default(),
            histograms: moments(sums).map(|m| Histogram::new(Bins::around(&m))).into(),
            failed: 0,
        };
        Self { reports: pilot.iter().map(report).collect() }
    }

    /// Returns whether no pilot has run.
    pub(super) fn is_empty(&self) -> bool {
        self.reports.is_empty()
    }

    /// Returns whether they can be those of a flight.
    pub(super) fn fit(&self, flight: &Flight) -> bool {
        self.reports.len() == flight.clock().report_samples.len()
            && self.reports.iter().all(|report| report.histograms.len() == QUANTITIES)
    }

    /// The bins per report time.
    pub(super) fn bins(&self) -> Vec<[Bins; QUANTITIES]> {
        self.reports.iter().map(|report| std::array::from_fn(|q| report.histograms[q].bins)).collect()
    }

    /// Adds a batch that begins with a member.
    pub(super) fn add(&mut self, first_member: u64, batch: &[Sums]) {
        for (report, sums) in self.reports.iter_mut().zip(batch) {
            for (block, moments) in (first_member / BLOCK as u64..).zip(&sums.blocks) {
                for (g, fold) in report.moments.iter_mut().enumerate() {
                    fold.add_block(block, &std::array::from_fn(|q| moments[4 * g + q]));
                }
            }
            report.failed += sums.failed;
            report.histograms.iter_mut().zip(&sums.histograms).for_each(|(mine, theirs)| mine.merge(&theirs.counts));
        }
    }

    /// Adds the sums of other members; `false` where their bins are not these.
    pub(crate) fn absorb(&mut self, other: &Self) -> bool {
        if self.bins() != other.bins() {
            return false;
        }
        for (mine, theirs) in self.reports.iter_mut().zip(&other.reports) {
            mine.moments.iter_mut().zip(&theirs.moments).for_each(|(mine, theirs)| mine.absorb(theirs));
            mine.histograms.iter_mut().zip(&theirs.histograms).for_each(|(mine, theirs)| mine.merge(&theirs.counts));
            mine.failed += theirs.failed;
        }
        true
    }

    /// Members that had failed by the last report.
    pub(super) fn failed(&self) -> u64 {
        self.reports.last().map_or(0, |report| report.failed)
    }

    /// The summaries per report time.
    pub(super) fn summed(&self) -> Vec<[Summary; QUANTITIES]> {
        let report = |report: &Report| {
            let totals: Vec<[Moments; 4]> = report.moments.iter().map(Fold::total).collect();
            std::array::from_fn(|q| Summary::of(&totals[q / 4][q % 4], report.histograms[q].clone()))
        };
        self.reports.iter().map(report).collect()
    }
}

/// The moments of all blocks, merged in order.
fn moments(sums: &Sums) -> [Moments; QUANTITIES] {
    let mut all = [Moments::default(); QUANTITIES];
    sums.blocks.iter().for_each(|block| all.iter_mut().zip(block).for_each(|(mine, theirs)| mine.merge(theirs)));
    all
}
