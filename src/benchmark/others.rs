//! States how much other programs took of the processors while something was measured: what a
//! figure from a busy machine owes its reader. Linux only; elsewhere nothing is known.

/// A reading of the counters, in clock ticks since the machine and the program began.
#[derive(Debug, Clone, Copy)]
pub struct Ticks {
    all: u64,
    busy: u64,
    own: u64,
}

impl Ticks {
    /// Reads them as they stand now.
    pub fn now() -> Option<Self> {
        let machine = std::fs::read_to_string("/proc/stat").ok()?;
        let own = std::fs::read_to_string("/proc/self/stat").ok()?;
        Self::parse(&machine, &own)
    }

    fn parse(machine: &str, own: &str) -> Option<Self> {
        // user nice system idle iowait irq softirq steal; the rest is counted among these.
        let counts: Vec<u64> =
            machine.lines().next()?.split_whitespace().skip(1).take(8).flat_map(str::parse).collect();
        let idle = counts.get(3)? + counts.get(4)?;
        let all: u64 = counts.iter().sum();
        // The name in parentheses may hold anything; user and system time are the 12th and 13th
        // field after it.
        let fields: Vec<&str> = own.rsplit_once(')')?.1.split_whitespace().collect();
        let own = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
        Some(Self { all, busy: all - idle, own })
    }

    /// Share of the processors that other programs used since then, 0 to 1.
    pub fn others_since(&self, begun: &Self) -> f64 {
        let busy = self.busy.saturating_sub(begun.busy);
        let others = busy.saturating_sub(self.own.saturating_sub(begun.own));
        others as f64 / self.all.saturating_sub(begun.all).max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_busy_and_not_ours_is_others() {
        let at = |machine: &str, own: &str| Ticks::parse(machine, own).expect("both parse");
        let begun = at("cpu 100 0 0 900 0 0 0 0 5 5", "1 (a ) b) S 1 1 1 1 1 1 1 1 1 1 10 5 0 0");
        let ended = at("cpu 180 0 20 980 20 0 0 0 5 5", "1 (a ) b) S 1 1 1 1 1 1 1 1 1 1 50 15 0 0");
        // 200 ticks went by, 100 busy, 50 of them ours.
        assert_eq!(ended.others_since(&begun), 0.25);
        assert!(Ticks::parse("", "").is_none());
    }
}
