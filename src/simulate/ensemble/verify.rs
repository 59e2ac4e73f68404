//! Checks the integrity of a saved state: as many members counted as were summed, numbers that are
//! some.

use std::ops::Range;

use super::state::{BLOCK, State};
use crate::backend::Unfinished;
use crate::kernel::job::Job;
use crate::statistics::histogram::BINS;
use crate::statistics::{Fold, Histogram, Moments};

/// Says what is wrong with a state of this job.
pub(super) fn check(state: &State, job: &Job) -> Result<(), String> {
    let reports = job.clock.report_samples.len();
    let (members, next) = (&state.members, state.next_member);
    let ends_a_batch = |member: u64| member == job.members || (member < job.members && member.is_multiple_of(BLOCK));
    ensure(
        members.start <= members.end && ends_a_batch(members.start) && ends_a_batch(members.end),
        "impossible members",
    )?;
    let inside = (members.start..=members.end).contains(&next) && ends_a_batch(next);
    ensure(inside, "the number of members done is impossible")?;
    let begun = !state.bins.is_empty();
    ensure(begun || next == members.start, "members without bins")?;
    let expected = if begun { reports } else { 0 };
    ensure(state.bins.len() == expected && state.reports.len() == expected, "a different number of report times")?;
    for (report, bins) in state.reports.iter().zip(&state.bins) {
        ensure(report.histograms.iter().map(|h| h.bins).eq(bins.iter().copied()), "histograms on different bins")?;
        ensure(bins.iter().all(|b| b.from.is_finite() && b.per_unit > 0.0), "impossible bins")?;
        ensure(holds(&report.moments, members.start / BLOCK..next.div_ceil(BLOCK)), "missing blocks")?;
        sums(&report.moments.total(), &report.histograms, report.failed, next - members.start)?;
    }
    let mut at = members.start;
    for origin in &state.origins {
        ensure(origin.members.start == at && origin.members.end > at, "members from nowhere")?;
        at = origin.members.end;
    }
    ensure(at == next, "members from nowhere")?;
    state.under_way.as_ref().map_or(Ok(()), |(_, batch)| under_way(batch, state, job))
}

/// Returns whether a fold holds just these blocks.
fn holds(fold: &Fold, blocks: Range<u64>) -> bool {
    let end = fold.nodes().try_fold(blocks.start, |at, (first, node)| {
        let size = 1u64.checked_shl(node.level)?;
        (first == at && first.is_multiple_of(size)).then(|| at.checked_add(size))?
    });
    end == Some(blocks.end)
}

fn under_way(batch: &Unfinished, state: &State, job: &Job) -> Result<(), String> {
    let members = &batch.members;
    // Where there are no bins yet it is of the pilot, whose members are the first ones of all.
    let (start, end) = if state.bins.is_empty() { (0, job.members) } else { (state.next_member, state.members.end) };
    let inside = members.start == start && members.start < members.end && members.end <= end;
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
    let counted = members.checked_sub(failed).ok_or("more members failed than exist")?;
    for m in moments {
        ensure(m.count == counted, "the number of members summed differs from the number done")?;
        ensure(m.count == 0 || possible(m), "impossible moments")?;
    }
    for h in histograms {
        ensure(h.counts.len() == BINS + 2, "histograms of a different size")?;
        let total = h.counts.iter().try_fold(0u64, |sum, count| sum.checked_add(*count));
        ensure(total == Some(counted), "a histogram of a different number of members")?;
    }
    Ok(())
}

/// Far beyond what a member may reach before it has failed (10⁷ m/s², for the longest of runs), and
/// so that squares of sums stay in the range of numbers.
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
    use crate::statistics::fold::Node;
    use crate::validation::jobs::{Sine, job};

    /// 512 of 1000 members summed, as a run leaves them.
    fn summed(job: &Job) -> State {
        let run = Run { identity: "", part: 1, job, precision: Precision::F32 };
        let mut state = State::new(&run, 0..job.members);
        let bins = vec![[Bins { from: -1.0, per_unit: 2048.0 }; 4]; job.clock.report_samples.len()];
        state.set_bins(bins.clone());
        let mut cpu = Cpu::default();
        let batch = Batch { bins: &bins, ..Batch::whole(job, 0..512) };
        let Ok(Ran::Whole(partials)) = cpu.run(&batch) else { panic!("a batch that runs") };
        state.add(&partials, &cpu.machine(job), None);
        state
    }

    #[test]
    fn sums_that_cannot_be_are_told_from_those_that_are() {
        let sine = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
        let job = job(Sensor::default(), 1000, &[0.5, 1.0], sine, Integrator::Ideal);
        let good = summed(&job);
        assert_eq!(check(&good, &job), Ok(()));
        type Change = fn(&mut State);
        /// Changes the first subtree of a report.
        fn node(state: &mut State, report: usize, change: fn(&mut Node, &mut u64)) {
            let nodes = state.reports[report].moments.nodes().map(|(first, node)| {
                let (mut first, mut node) = (first, *node);
                change(&mut node, &mut first);
                (first, node)
            });
            state.reports[report].moments = Fold::from_nodes(nodes.collect::<Vec<_>>().into_iter());
        }
        let changes: [(&str, Change); 14] = [
            ("a mean that is huge", |s| node(s, 1, |n, _| n.moments[0].mean = 1e308)),
            ("blocks of other members", |s| node(s, 1, |_, first| *first = 2)),
            ("a subtree of more blocks", |s| node(s, 0, |n, _| n.level += 1)),
            ("a subtree of impossible size", |s| node(s, 0, |n, _| n.level = 64)),
            ("members that begin within a block", |s| s.members.start = 7),
            ("fewer members", |s| s.next_member = 256),
            ("more members", |s| s.next_member = 1000),
            ("impossible members", |s| s.next_member = u64::MAX),
            ("a mean that is no number", |s| node(s, 0, |n, _| n.moments[0].mean = f64::INFINITY)),
            ("counts that overflow", |s| s.reports[1].histograms[2].counts[5..7].fill(u64::MAX)),
            ("another count", |s| node(s, 1, |n, _| n.moments[3].count += 1)),
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
