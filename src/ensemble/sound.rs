//! Whether the sums of a state can be what it says they are: as many members counted as were summed, numbers that are some.

use super::state::{BLOCK, State};
use crate::backend::Unfinished;
use crate::kernel::job::Job;
use crate::statistics::histogram::BINS;
use crate::statistics::{Histogram, Moments};

/// What is wrong with a state of this job.
pub(super) fn check(state: &State, job: &Job) -> Result<(), String> {
    let reports = job.clock.report_samples.len();
    let next = state.next_member;
    let ends_a_batch = next == job.members || (next < job.members && next.is_multiple_of(BLOCK));
    ensure(ends_a_batch, "the number of members done is impossible")?;
    let begun = !state.bins.is_empty();
    ensure(begun || next == 0, "members without bins")?;
    let expected = if begun { reports } else { 0 };
    ensure(state.bins.len() == expected && state.reports.len() == expected, "another number of report times")?;
    for (report, bins) in state.reports.iter().zip(&state.bins) {
        ensure(report.histograms.iter().map(|h| h.bins).eq(bins.iter().copied()), "histograms on other bins")?;
        ensure(bins.iter().all(|b| b.from.is_finite() && b.per_unit > 0.0), "bins that are none")?;
        sums(&report.moments, &report.histograms, report.failed, next)?;
    }
    let mut at = 0;
    for origin in &state.origins {
        ensure(origin.members.start == at && origin.members.end > at, "members from nowhere")?;
        at = origin.members.end;
    }
    ensure(at == next, "members from nowhere")?;
    state.under_way.as_ref().map_or(Ok(()), |(_, batch)| under_way(batch, state, job))
}

fn under_way(batch: &Unfinished, state: &State, job: &Job) -> Result<(), String> {
    let members = &batch.members;
    let inside = members.start == state.next_member && members.start < members.end && members.end <= job.members;
    ensure(inside && members.end - members.start <= u64::from(u32::MAX), "a batch of impossible members")?;
    ensure(batch.samples > 0 && batch.samples < job.clock.samples, "a batch at an impossible sample")?;
    let passed = job.clock.report_samples.iter().filter(|&&r| r <= batch.samples).count();
    ensure(batch.partials.len() == passed, "a batch with another number of report times")?;
    let size = members.end - members.start;
    for partial in &batch.partials {
        ensure(partial.blocks.len() as u64 == size.div_ceil(BLOCK), "a batch with another number of blocks")?;
        ensure(partial.histograms.len() == if state.bins.is_empty() { 0 } else { 4 }, "a batch without histograms")?;
        let mut all = [Moments::default(); 4];
        for block in &partial.blocks {
            ensure(block.iter().all(|m| m.count <= BLOCK), "blocks of too many members")?;
            all.iter_mut().zip(block).for_each(|(all, block)| all.merge(block));
        }
        sums(&all, &partial.histograms, partial.failed, size)?;
    }
    Ok(())
}

/// Moments and histograms of some members, those that failed left out.
fn sums(moments: &[Moments; 4], histograms: &[Histogram], failed: u64, members: u64) -> Result<(), String> {
    let counted = members.checked_sub(failed).ok_or("more members failed than there are")?;
    for m in moments {
        ensure(m.count == counted, "another number of members was summed than it says are done")?;
        ensure(m.count == 0 || possible(m), "moments that no run can have")?;
    }
    for h in histograms {
        ensure(h.counts.len() == BINS + 2, "histograms of another size")?;
        let total = h.counts.iter().try_fold(0u64, |sum, count| sum.checked_add(*count));
        ensure(total == Some(counted), "a histogram of another number of members")?;
    }
    Ok(())
}

/// Far beyond what a member may reach before it has failed (10⁷ m/s², for the longest of runs), and so that squares of sums
/// stay in the range of numbers.
const LARGEST: f64 = 1e150;

fn possible(m: &Moments) -> bool {
    let small = [m.mean, m.squares, m.min, m.max].iter().all(|v| v.abs() < LARGEST);
    small && m.squares >= 0.0 && m.min <= m.max
}

fn ensure(holds: bool, otherwise: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::cpu::{Cpu, Precision};
    use crate::backend::{Backend, Batch, Ran};
    use crate::ensemble::state::Run;
    use crate::kernel::integrator::Integrator;
    use crate::sensor::Sensor;
    use crate::statistics::Bins;
    use crate::validation::jobs::{Sine, job};

    /// 512 of 1000 members summed, as a run leaves them.
    fn summed(job: &Job) -> State {
        let mut state = State::new(&Run { identity: "", part: 1, job, precision: Precision::F32 });
        let bins = vec![[Bins { from: -1.0, per_unit: 2048.0 }; 4]; job.clock.report_samples.len()];
        state.set_bins(bins.clone());
        let mut cpu = Cpu::default();
        let batch = Batch { bins: &bins, ..Batch::whole(job, 0..512) };
        let Ok(Ran::Whole(partials)) = cpu.run(&batch) else { panic!("a batch that runs") };
        state.add(&partials, job, &cpu.machine(job), None);
        state
    }

    #[test]
    fn sums_that_cannot_be_are_told_from_those_that_are() {
        let sine = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
        let job = job(Sensor::default(), 1000, &[0.5, 1.0], sine, Integrator::Ideal);
        let good = summed(&job);
        assert_eq!(check(&good, &job), Ok(()));
        type Change = fn(&mut State);
        let changes: [(&str, Change); 10] = [
            ("a mean that is huge", |s| s.reports[1].moments[0].mean = 1e308),
            ("fewer members", |s| s.next_member = 256),
            ("more members", |s| s.next_member = 1000),
            ("impossible members", |s| s.next_member = u64::MAX),
            ("a mean that is no number", |s| s.reports[0].moments[0].mean = f64::INFINITY),
            ("counts that overflow", |s| s.reports[1].histograms[2].counts[5..7].fill(u64::MAX)),
            ("another count", |s| s.reports[1].moments[3].count += 1),
            ("members that failed and are counted", |s| s.reports[0].failed = u64::MAX),
            ("one report less", |s| s.reports.truncate(1)),
            ("origins that do not add up", |s| s.origins[0].members.end = 256),
        ];
        for (what, change) in changes {
            let mut state = good.clone();
            change(&mut state);
            assert!(check(&state, &job).is_err(), "{what} is accepted");
        }
    }
}
