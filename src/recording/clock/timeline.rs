//! Stamps one after the other: the step from each to the next, across counters that overflow.

use super::stamp::Stamp;

/// Lengths after which counters start again: powers of two in units and in thousandths and
/// millionths of them, a day, a week.
const MODULI: [f64; 14] = [
    4_294_967_296.0,
    4_294_967.296,
    4_294.967_296,
    2_147_483_648.0,
    2_147_483.648,
    2_147.483_648,
    16_777_216.0,
    16_777.216,
    65_536.0,
    65.536,
    86_400.0,
    86_400_000.0,
    604_800.0,
    604_800_000.0,
];
/// Usual steps that may lie between the last stamp and the overflow, and behind it: a gap there may
/// be a set-back.
const NEAR: f64 = 20.0;

/// A stamp that is smaller than the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetBack {
    /// Row at which the stamp was found.
    pub row: usize,
    /// The stamp before it, in the file's unit.
    pub from: f64,
    /// The smaller stamp, in the file's unit.
    pub to: f64,
}

/// Overflows of the counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wraps {
    /// Number of overflows.
    pub times: usize,
    /// Holds what was added each time, in the file's unit.
    pub modulus: f64,
    /// First row after the first of them.
    pub first_row: usize,
}

/// Follows the stamps of a file.
#[derive(Debug, Clone, Default)]
pub struct Timeline {
    origin: Option<Stamp>,
    before: Option<Stamp>,
    offset: f64,
    elapsed: f64,
    /// Running mean of the steps forward.
    usual: f64,
    wraps: Option<Wraps>,
}

impl Timeline {
    /// Step from the stamp before, in the file's unit; `None` for the first one. Missing stamps are
    /// not for here.
    pub fn advance(&mut self, row: usize, stamp: Stamp) -> Result<Option<f64>, SetBack> {
        let (Some(origin), Some(before)) = (self.origin, self.before.replace(stamp)) else {
            self.origin = Some(stamp);
            return Ok(None);
        };
        let mut step = stamp.since(&before);
        if step < 0.0 {
            let modulus = self.overflow(before.value(), stamp.value()).ok_or(SetBack {
                row,
                from: before.value(),
                to: stamp.value(),
            })?;
            self.offset += modulus;
            step += modulus;
            let wraps = self.wraps.get_or_insert(Wraps { times: 0, modulus, first_row: row });
            wraps.times += 1;
        }
        if step > 0.0 {
            self.usual = if self.usual > 0.0 { 0.9 * self.usual + 0.1 * step } else { step };
        }
        self.elapsed = self.offset + stamp.since(&origin);
        Ok(Some(step))
    }

    fn overflow(&self, from: f64, to: f64) -> Option<f64> {
        let near = NEAR * self.usual;
        MODULI.into_iter().find(|m| from < *m && m - from < near && to >= 0.0 && to < near && near < 0.25 * m)
    }

    /// Time since the first stamp, in the file's unit.
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// The first stamp.
    pub fn origin(&self) -> Option<Stamp> {
        self.origin
    }

    /// Overflows so far.
    pub fn wraps(&self) -> Option<Wraps> {
        self.wraps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(stamps: &[f64]) -> Result<Vec<f64>, SetBack> {
        let mut line = Timeline::default();
        let mut out = Vec::new();
        for (row, stamp) in stamps.iter().enumerate() {
            let stamp = Stamp::parse(format!("{stamp}").as_bytes()).unwrap_or_else(|| unreachable!("{stamp}"));
            out.extend(line.advance(row, stamp)?);
        }
        Ok(out)
    }

    #[test]
    fn a_counter_of_32_bits_goes_on_and_a_clock_set_back_does_not() {
        let wrapping: Vec<f64> = (0..9u32).map(|k| f64::from((u32::MAX - 40_000).wrapping_add(10_000 * k))).collect();
        assert_eq!(steps(&wrapping), Ok(vec![10_000.0; 8]));
        let back = steps(&[0.0, 10.0, 20.0, 5.0]);
        assert_eq!(back, Err(SetBack { row: 3, from: 20.0, to: 5.0 }));
        // Near no overflow, and a whole range back without one.
        assert!(steps(&[4e9, 4e9 + 1e4, 1e4]).is_err());
    }
}
