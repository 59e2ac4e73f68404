//! States how Parquet packs numbers: runs and bits, differences, streams of bytes. Format:
//! parquet.apache.org, *Encodings*.

use crate::bytes::Bytes;

/// Numbers of `width` bits from the `first` of them on, lowest bit first; nothing beyond the end.
fn unpack(bytes: &[u8], width: u32, first: usize, into: &mut [u32]) {
    let mask = (1u64 << width) - 1;
    for (i, number) in into.iter_mut().enumerate() {
        let bit = (first + i) * width as usize;
        let rest = bytes.get(bit / 8..).unwrap_or_default();
        // Eight bytes hold any number of 32 bits wherever it begins.
        let window = match rest.first_chunk::<8>() {
            Some(window) => u64::from_le_bytes(*window),
            None => rest.iter().rev().fold(0, |sum, b| (sum << 8) | u64::from(*b)),
        };
        *number = ((window >> (bit % 8)) & mask) as u32;
    }
}

fn varint(bytes: &mut Bytes<'_>) -> Option<u64> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let byte = bytes.u8()?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

/// The hybrid of runs and packed bits, given piece by piece: a run of any length takes no room.
#[derive(Debug)]
pub(super) struct Hybrid {
    width: u32,
    /// States where the next run begins among the bytes.
    at: usize,
    /// Numbers that are still to be given.
    left: usize,
    run: Run,
}

/// Holds what is left of a run.
#[derive(Debug)]
enum Run {
    Same { value: u32, left: usize },
    Packed { at: usize, given: usize, left: usize },
}

impl Hybrid {
    /// Of `count` numbers of `width` bits, 32 at most, that begin at a place among the bytes.
    pub(super) fn new(width: u32, at: usize, count: usize) -> Option<Self> {
        (width <= 32).then_some(Self { width, at, left: count, run: Run::Same { value: 0, left: 0 } })
    }

    /// Fills `into` with the numbers that follow; `None` where they are not there.
    pub(super) fn fill(&mut self, bytes: &[u8], into: &mut [u32]) -> Option<()> {
        let mut filled = 0;
        while filled < into.len() {
            let room = into.len() - filled;
            let given = match &mut self.run {
                Run::Same { left: 0, .. } | Run::Packed { left: 0, .. } => {
                    self.run = self.begin(bytes)?;
                    continue;
                }
                Run::Same { value, left } => {
                    let count = room.min(*left);
                    into[filled..filled + count].fill(*value);
                    *left -= count;
                    count
                }
                Run::Packed { at, given, left } => {
                    let count = room.min(*left);
                    unpack(&bytes[*at..], self.width, *given, &mut into[filled..filled + count]);
                    (*given, *left) = (*given + count, *left - count);
                    count
                }
            };
            filled += given;
            self.left -= given;
        }
        Some(())
    }

    /// The next run; each takes a byte at least.
    fn begin(&mut self, bytes: &[u8]) -> Option<Run> {
        let mut rest = Bytes::new(bytes.get(self.at..).filter(|_| self.left > 0)?);
        let head = varint(&mut rest)?;
        let run = if head & 1 == 1 {
            let numbers = usize::try_from(head >> 1).ok()?.checked_mul(8)?;
            let length = numbers.checked_mul(self.width as usize)? / 8;
            let at = self.at + rest.taken();
            // The last group may be cut where the file ends.
            let packed = rest.take(length.min(rest.len()))?;
            let left = numbers.min(self.left);
            if packed.len() * 8 < left * self.width as usize {
                return None;
            }
            Run::Packed { at, given: 0, left }
        } else {
            let left = usize::try_from(head >> 1).ok()?.min(self.left);
            let value = rest.take(self.width.div_ceil(8) as usize)?;
            Run::Same { value: value.iter().rev().fold(0u32, |sum, b| (sum << 8) | u32::from(*b)), left }
        };
        self.at += rest.taken();
        Some(run)
    }
}

fn zigzag(bytes: &mut Bytes<'_>) -> Option<i64> {
    let n = varint(bytes)?;
    Some((n >> 1) as i64 ^ -((n & 1) as i64))
}

/// DELTA_BINARY_PACKED: whole numbers by their differences, given piece by piece.
#[derive(Debug)]
pub(super) struct Deltas {
    /// Numbers of a part of a block, and parts of a block.
    part: usize,
    parts: usize,
    value: i64,
    /// Numbers that are still to be given, the first included.
    left: usize,
    is_first: bool,
    /// States where the next part or block begins among the bytes.
    at: usize,
    least: i64,
    /// States where the widths of the parts stand, and how many of the parts were begun.
    widths: usize,
    begun: usize,
    /// The part at hand: its width, where it begins, how many were given of it, and are left.
    width: u32,
    packed: usize,
    given: usize,
    within: usize,
}

impl Deltas {
    /// Of at most `count` numbers, described where the bytes begin at a place.
    pub(super) fn new(bytes: &[u8], at: usize, count: usize) -> Option<Self> {
        let mut rest = Bytes::new(bytes.get(at..)?);
        let block = usize::try_from(varint(&mut rest)?).ok()?;
        let parts = usize::try_from(varint(&mut rest)?).ok()?;
        let left = usize::try_from(varint(&mut rest)?).ok()?.min(count);
        let value = zigzag(&mut rest)?;
        if parts == 0
            || block == 0
            || block > 1 << 20
            || !block.is_multiple_of(parts)
            || !(block / parts).is_multiple_of(8)
        {
            return None;
        }
        let at = at + rest.taken();
        let part = block / parts;
        let begun = parts;
        let (least, widths, width, packed, given, within) = (0, 0, 0, 0, 0, 0);
        let is_first = true;
        Some(Self { part, parts, value, left, is_first, at, least, widths, begun, width, packed, given, within })
    }

    /// Numbers that are still to be given.
    #[cfg(test)]
    fn left(&self) -> usize {
        self.left
    }

    /// The next number; `None` where it is not there.
    pub(super) fn next(&mut self, bytes: &[u8]) -> Option<i64> {
        self.left = self.left.checked_sub(1)?;
        if std::mem::take(&mut self.is_first) {
            return Some(self.value);
        }
        if self.within == 0 {
            self.begin(bytes)?;
        }
        let bit = self.given * self.width as usize;
        // Nine bytes hold any number of 64 bits wherever it begins.
        let window = bytes.get(self.packed + bit / 8..).unwrap_or_default().iter().take(9);
        let all = window.enumerate().fold(0u128, |sum, (k, b)| sum | u128::from(*b) << (8 * k));
        let delta = (all >> (bit % 8)) & ((1u128 << self.width) - 1);
        (self.given, self.within) = (self.given + 1, self.within - 1);
        self.value = self.value.wrapping_add(self.least).wrapping_add(delta as i64);
        Some(self.value)
    }

    /// The next part, of the next block where this one has no more.
    fn begin(&mut self, bytes: &[u8]) -> Option<()> {
        if self.begun == self.parts {
            let mut rest = Bytes::new(bytes.get(self.at..)?);
            self.least = zigzag(&mut rest)?;
            self.widths = self.at + rest.taken();
            rest.take(self.parts)?;
            self.at += rest.taken();
            self.begun = 0;
        }
        self.width = u32::from(*bytes.get(self.widths + self.begun)?);
        let length = self.part * self.width as usize / 8;
        self.packed = self.at;
        self.at = self.at.checked_add(length).filter(|end| *end <= bytes.len() && self.width <= 64)?;
        (self.begun, self.given, self.within) = (self.begun + 1, 0, self.part);
        Some(())
    }
}

/// BYTE_STREAM_SPLIT: all first bytes, then all second bytes, …
pub(super) fn split_streams(bytes: &[u8], width: usize) -> Vec<u8> {
    let count = bytes.len() / width.max(1);
    let mut out = vec![0; count * width];
    for (stream, part) in bytes.chunks_exact(count.max(1)).take(width).enumerate() {
        for (i, byte) in part.iter().enumerate() {
            out[i * width + stream] = *byte;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All numbers, in pieces of at most `piece`.
    fn hybrid(bytes: &[u8], width: u32, count: usize, piece: usize) -> Option<Vec<u32>> {
        let mut hybrid = Hybrid::new(width, 0, count)?;
        let mut out = vec![0; count];
        out.chunks_mut(piece).try_for_each(|into| hybrid.fill(bytes, into))?;
        Some(out)
    }

    fn deltas(bytes: &[u8], count: usize) -> Option<Vec<i64>> {
        let mut deltas = Deltas::new(bytes, 0, count)?;
        (0..deltas.left()).map(|_| deltas.next(bytes)).collect()
    }

    #[test]
    fn runs_and_packed_bits_are_read() {
        // From the format's own text: the numbers 0 to 7 in three bits are 0x88 0xc6 0xfa; a run of
        // four fives.
        let bytes = [3, 0x88, 0xc6, 0xfa, 8, 5];
        for piece in [1, 3, 5, 12] {
            assert_eq!(hybrid(&bytes, 3, 12, piece), Some(vec![0, 1, 2, 3, 4, 5, 6, 7, 5, 5, 5, 5]), "{piece}");
        }
        assert_eq!(hybrid(&bytes, 3, 13, 13), None);
        assert_eq!(hybrid(&[3, 0x88], 3, 8, 8), None);
        assert_eq!(hybrid(&[], 1, 1, 1), None);
        assert_eq!(hybrid(&[0, 0, 0, 0], 1, 5, 5), None);
        assert!(Hybrid::new(33, 0, 1).is_none());
    }

    #[test]
    fn differences_are_summed() {
        // The format's example: 7, 5, 3, 1, 2, 3, 4, 5 has the first value 7, the least
        // difference -2, and the differences above it 0, 0, 0, 3, 3, 3, 3 in two bits; one block of
        // 128 with four parts of 32.
        let head = [128, 1, 4, 8, 14, 3, 2, 0, 0, 0];
        let mut packed = [0u8; 8];
        for (i, delta) in [0u8, 0, 0, 3, 3, 3, 3].into_iter().enumerate() {
            packed[i / 4] |= delta << (2 * (i % 4));
        }
        let bytes = [&head[..], &packed].concat();
        assert_eq!(deltas(&bytes, 8), Some(vec![7, 5, 3, 1, 2, 3, 4, 5]));
        assert_eq!(deltas(&bytes[..9], 8), None);
    }

    #[test]
    fn streams_of_bytes_are_joined() {
        assert_eq!(split_streams(&[1, 4, 2, 5, 3, 6], 3), [1, 2, 3, 4, 5, 6]);
    }
}
