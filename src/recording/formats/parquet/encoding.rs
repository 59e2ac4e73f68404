//! How Parquet packs numbers: runs and bits, differences, streams of bytes. Format:
//! parquet.apache.org, *Encodings*.

use crate::bytes::Bytes;

/// Numbers of `width` bits, lowest bit first.
fn unpack(bytes: &[u8], width: u32, count: usize, into: &mut Vec<u32>) {
    let (mut held, mut bits) = (0u64, 0);
    let mut bytes = bytes.iter();
    let mask = (1u64 << width) - 1;
    for _ in 0..count {
        while bits < width {
            held |= u64::from(bytes.next().copied().unwrap_or_default()) << bits;
            bits += 8;
        }
        into.push((held & mask) as u32);
        held >>= width;
        bits -= width;
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

/// The hybrid of runs and packed bits: `count` numbers of `width` bits, 32 at most.
pub(super) fn hybrid(bytes: &[u8], width: u32, count: usize) -> Option<Vec<u32>> {
    if width > 32 {
        return None;
    }
    let mut bytes = Bytes::new(bytes);
    let mut out = Vec::new();
    while out.len() < count {
        let head = varint(&mut bytes)?;
        let left = count - out.len();
        if head & 1 == 1 {
            let numbers = usize::try_from(head >> 1).ok()?.checked_mul(8)?;
            let length = numbers.checked_mul(width as usize)? / 8;
            // The last group may be cut where the file ends.
            let packed = bytes.take(length.min(bytes.len()))?;
            let numbers = numbers.min(left);
            if packed.len() * 8 < numbers * width as usize {
                return None;
            }
            unpack(packed, width, numbers, &mut out);
        } else {
            let run = usize::try_from(head >> 1).ok()?.min(left);
            let value = bytes.take(width.div_ceil(8) as usize)?;
            let value = value.iter().rev().fold(0u32, |sum, b| (sum << 8) | u32::from(*b));
            out.resize(out.len() + run, value);
            if run == 0 && left > 0 && bytes.is_empty() {
                return None;
            }
        }
    }
    Some(out)
}

fn zigzag(bytes: &mut Bytes<'_>) -> Option<i64> {
    let n = varint(bytes)?;
    Some((n >> 1) as i64 ^ -((n & 1) as i64))
}

/// DELTA_BINARY_PACKED: whole numbers by their differences, at most `count`.
pub(super) fn deltas(bytes: &[u8], count: usize) -> Option<Vec<i64>> {
    let mut bytes = Bytes::new(bytes);
    let block = usize::try_from(varint(&mut bytes)?).ok()?;
    let minis = usize::try_from(varint(&mut bytes)?).ok()?;
    let total = usize::try_from(varint(&mut bytes)?).ok()?.min(count);
    let first = zigzag(&mut bytes)?;
    if minis == 0 || block == 0 || block > 1 << 20 || !block.is_multiple_of(minis) || !(block / minis).is_multiple_of(8)
    {
        return None;
    }
    let mut out = Vec::new();
    let mut value = first;
    if total > 0 {
        out.push(value);
    }
    while out.len() < total {
        let least = zigzag(&mut bytes)?;
        let widths = bytes.take(minis)?;
        for width in widths {
            if out.len() >= total {
                break;
            }
            let width = u32::from(*width);
            let numbers = block / minis;
            let packed = bytes.take(numbers * width as usize / 8).filter(|_| width <= 64)?;
            for i in 0..numbers.min(total - out.len()) {
                let begin = i * width as usize;
                // Nine bytes hold any number of 64 bits wherever it begins.
                let window = packed.iter().skip(begin / 8).take(9);
                let all = window.enumerate().fold(0u128, |sum, (k, b)| sum | u128::from(*b) << (8 * k));
                let delta = (all >> (begin % 8)) & ((1u128 << width) - 1);
                value = value.wrapping_add(least).wrapping_add(delta as i64);
                out.push(value);
            }
        }
    }
    Some(out)
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

    #[test]
    fn runs_and_packed_bits_are_read() {
        // From the format's own text: the numbers 0 to 7 in three bits are 0x88 0xc6 0xfa; a run of
        // four fives.
        assert_eq!(hybrid(&[3, 0x88, 0xc6, 0xfa, 8, 5], 3, 12), Some(vec![0, 1, 2, 3, 4, 5, 6, 7, 5, 5, 5, 5]));
        assert_eq!(hybrid(&[3, 0x88], 3, 8), None);
        assert_eq!(hybrid(&[], 1, 1), None);
        assert_eq!(hybrid(&[0, 0, 0, 0], 1, 5), None);
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
