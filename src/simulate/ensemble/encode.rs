//! A state in few bytes: what a shard's file holds of each of its pieces.
//!
//! Most bins of most histograms are empty, and counts are small: a histogram is its non-empty bins,
//! as the gap to the one before and the count, in seven bits a byte. Subtrees of a fold are five
//! numbers per quantity. Everything that is small anyway is JSON. Unpacking adds to a state that
//! may hold other members already, so that a thousand pieces need the memory of one.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::state::{Run, State};
use crate::backend::Unfinished;
use crate::statistics::fold::{Fold, Node};
use crate::statistics::{Bins, Machine, Moments, Origin};

#[derive(Serialize, Deserialize)]
struct Head {
    fingerprint: String,
    members: Range<u64>,
    next_member: u64,
    seconds: f64,
    origins: Vec<Origin>,
    under_way: Option<(Machine, Unfinished)>,
}

/// Packs a state.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub(super) fn pack(state: &State) -> serde_json::Result<Vec<u8>> {
    let head = serde_json::to_vec(&Head {
        fingerprint: state.fingerprint.clone(),
        members: state.members.clone(),
        next_member: state.next_member,
        seconds: state.seconds,
        origins: state.origins.clone(),
        under_way: state.under_way.clone(),
    })?;
    let mut out = Vec::new();
    number(&mut out, head.len() as u64);
    out.extend_from_slice(&head);
    number(&mut out, state.reports.len() as u64);
    for (report, bins) in state.reports.iter().zip(&state.bins) {
        for b in bins {
            out.extend_from_slice(&b.from.to_le_bytes());
            out.extend_from_slice(&b.per_unit.to_le_bytes());
        }
        number(&mut out, report.failed);
        number(&mut out, report.moments.nodes().count() as u64);
        for (first, node) in report.moments.nodes() {
            number(&mut out, first);
            number(&mut out, u64::from(node.level));
            for m in &node.moments {
                number(&mut out, m.count);
                [m.mean, m.squares, m.min, m.max].iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
            }
        }
        for histogram in &report.histograms {
            number(&mut out, histogram.counts.iter().filter(|c| **c > 0).count() as u64);
            let mut after = 0;
            for (slot, count) in histogram.counts.iter().enumerate().filter(|(_, c)| **c > 0) {
                number(&mut out, (slot - after) as u64);
                number(&mut out, *count);
                after = slot + 1;
            }
        }
    }
    Ok(out)
}

/// Seven bits a byte, the lowest first; the eighth says that more follow.
fn number(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Adds what is packed to a state that holds none of its members; an empty one becomes it.
///
/// # Errors
/// What is wrong with the bytes: another run's, damaged, or sums on other bins.
pub(super) fn unpack(bytes: &[u8], run: &Run<'_>, into: &mut State) -> Result<(), String> {
    let cut = || "the file is damaged: it ends within its results".to_owned();
    let mut from = Reader(bytes);
    let length = from.number().ok_or_else(cut)?;
    let head = usize::try_from(length).ok().and_then(|n| from.take(n)).ok_or_else(cut)?;
    let head: Head = serde_json::from_slice(head).map_err(|e| format!("the file is damaged: {e}"))?;
    if head.fingerprint != run.fingerprint() {
        return Err(
            "it belongs to another run: the study, the seed or the version of the program is not the same".into()
        );
    }
    sums(&mut from, into)?;
    if !from.0.is_empty() {
        return Err("the file is damaged: its results are followed by something else".into());
    }
    into.members = match into.members.is_empty() {
        true => head.members,
        false => into.members.start.min(head.members.start)..into.members.end.max(head.members.end),
    };
    into.next_member = into.next_member.max(head.next_member);
    into.seconds += head.seconds;
    into.origins.extend(head.origins);
    into.under_way = head.under_way;
    Ok(())
}

fn sums(from: &mut Reader<'_>, into: &mut State) -> Result<(), String> {
    let cut = || "the file is damaged: it ends within its results".to_owned();
    let reports = from.number().ok_or_else(cut)?;
    if reports == 0 {
        return Ok(());
    }
    if into.bins.is_empty() {
        // As many as there are bytes for, whatever the number says.
        let mut ahead = Reader(from.0);
        let bins: Option<Vec<[Bins; 4]>> =
            (0..reports).map(|_| ahead.report(&mut |_, _| Some(())).map(|r| r.0)).collect();
        into.set_bins(bins.ok_or_else(cut)?);
    }
    if reports != into.reports.len() as u64 {
        return Err("the file is damaged: a different number of report times".into());
    }
    for (report, bins) in into.reports.iter_mut().zip(&into.bins) {
        let mut quantities = report.histograms.iter_mut();
        let mut counts = quantities.next().map(|h| &mut h.counts[..]).unwrap_or_default();
        let mut add = |slot: Option<usize>, count: u64| {
            match slot {
                None => counts = quantities.next().map(|h| &mut h.counts[..]).unwrap_or_default(),
                Some(slot) => {
                    let mine = counts.get_mut(slot)?;
                    *mine = mine.checked_add(count)?;
                }
            }
            Some(())
        };
        let (theirs, failed, fold) = from.report(&mut add).ok_or_else(cut)?;
        if theirs != *bins {
            return Err(
                "its pilot has other moments: the processor that it ran on rounds otherwise (fused multiply-add), \
                        or another version of the program wrote it"
                    .into(),
            );
        }
        report.failed = report.failed.checked_add(failed).ok_or_else(cut)?;
        report.moments.absorb(&fold);
    }
    Ok(())
}

/// Bytes that are still to be read; `None` where they end too early.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn number(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn f32(&mut self) -> Option<f32> {
        Some(f32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn f64(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    /// The sums at one report time. Counts go to `add`, by slot; no slot is the end of a quantity.
    fn report(&mut self, add: &mut impl FnMut(Option<usize>, u64) -> Option<()>) -> Option<([Bins; 4], u64, Fold)> {
        let mut bins = [Bins { from: 0.0, per_unit: 0.0 }; 4];
        for b in &mut bins {
            *b = Bins { from: self.f32()?, per_unit: self.f32()? };
        }
        let failed = self.number()?;
        let count = self.number()?;
        let mut nodes = Vec::new();
        for _ in 0..count {
            let (first, level) = (self.number()?, u32::try_from(self.number()?).ok()?);
            let mut moments = [Moments::default(); 4];
            for m in &mut moments {
                let count = self.number()?;
                *m = Moments { count, mean: self.f64()?, squares: self.f64()?, min: self.f64()?, max: self.f64()? };
            }
            nodes.push((first, Node { level, moments }));
        }
        for _ in 0..4 {
            let filled = self.number()?;
            let mut slot = 0usize;
            for _ in 0..filled {
                slot = slot.checked_add(usize::try_from(self.number()?).ok()?)?;
                add(Some(slot), self.number()?)?;
                slot = slot.checked_add(1)?;
            }
            add(None, 0)?;
        }
        Some((bins, failed, Fold::from_nodes(nodes.into_iter())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::cpu::{Cpu, Precision};
    use crate::backend::{Backend, Batch, Ran};
    use crate::kernel::integrator::Integrator;
    use crate::kernel::job::Job;
    use crate::sensor::Sensor;
    use crate::validation::jobs::{Sine, job};

    fn ensemble() -> Job {
        let sine = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
        job(Sensor::default(), 1500, &[0.5, 1.0], sine, Integrator::Ideal)
    }

    fn state(run: &Run<'_>, members: Range<u64>) -> State {
        let bins = vec![[Bins { from: -1.0, per_unit: 2048.0 }; 4]; run.job.clock.report_samples.len()];
        let mut state = State::new(run, members.clone());
        state.set_bins(bins.clone());
        let mut cpu = Cpu::default();
        let batch = Batch { bins: &bins, ..Batch::whole(run.job, members) };
        let Ok(Ran::Whole(partials)) = cpu.run(&batch) else { panic!("a batch that runs") };
        state.add(&partials, &cpu.machine(run.job), None);
        state
    }

    fn same(a: &State, b: &State) -> bool {
        let of = |s: &State| serde_json::to_string(&(&s.reports, &s.bins, &s.members, s.next_member)).ok();
        of(a) == of(b)
    }

    #[test]
    fn packed_states_come_back_and_add_up_to_the_whole() {
        let job = ensemble();
        let run = Run { identity: "a", part: 1, job: &job, precision: Precision::F32 };
        let whole = state(&run, 0..1500);
        let mut back = State::new(&run, 0..0);
        unpack(&pack(&whole).expect("packed"), &run, &mut back).expect("unpacked");
        assert!(same(&whole, &back) && back.origins == whole.origins);
        let mut sum = State::new(&run, 0..0);
        for members in [768..1500, 0..256, 256..768] {
            let bytes = pack(&state(&run, members)).expect("packed");
            unpack(&bytes, &run, &mut sum).expect("unpacked");
        }
        assert!(same(&whole, &sum));
        // Control: a stretch that is missing is no whole.
        let mut part = State::new(&run, 0..0);
        unpack(&pack(&state(&run, 0..1280)).expect("packed"), &run, &mut part).expect("unpacked");
        assert!(!same(&whole, &part));
    }

    #[test]
    fn what_is_cut_off_or_of_another_run_is_refused() {
        let job = ensemble();
        let run = Run { identity: "a", part: 1, job: &job, precision: Precision::F32 };
        let bytes = pack(&state(&run, 0..256)).expect("packed");
        let read = |bytes: &[u8], run: &Run<'_>| unpack(bytes, run, &mut State::new(run, 0..0));
        for length in (0..bytes.len()).step_by(bytes.len() / 97) {
            assert!(read(&bytes[..length], &run).is_err(), "{length}");
        }
        assert!(read(&[&bytes[..], b"x"].concat(), &run).is_err());
        let other = Run { identity: "b", ..run };
        assert!(read(&bytes, &other).is_err_and(|e| e.contains("another run")));
    }
}
