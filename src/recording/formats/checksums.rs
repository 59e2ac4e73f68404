//! A damaged byte in a format that has checksums is never read as another number.

use std::ops::Range;
use std::path::Path;

use super::find_in;
use crate::input::Input;
use crate::reader::{Block, Choice};

/// All numbers of all parts of a file, and of those that cannot be read why; `None` where it cannot
/// be opened.
fn numbers(bytes: &[u8]) -> Option<Vec<Result<Vec<u64>, String>>> {
    let open = || match find_in(Input::of_bytes(Path::new("a file"), bytes.to_vec())) {
        Ok(super::Found::Log { log, .. }) => Some(log),
        _ => None,
    };
    let count = open()?.parts().len();
    let part = |part: usize| -> Option<Result<Vec<u64>, String>> {
        let log = open()?;
        let choice = Choice { time: None, places: (0..log.parts()[part].columns.len()).collect() };
        if choice.places.is_empty() {
            return Some(Ok(Vec::new()));
        }
        let mut reader = match log.open(part, &choice) {
            Ok(reader) => reader,
            Err(error) => return Some(Err(error.cause)),
        };
        let (mut all, mut block) = (Vec::new(), Block::new(choice.places.len()));
        loop {
            block.clear();
            match reader.next(&mut block) {
                Ok(true) => all.extend(block.columns.iter().flatten().map(|n| n.to_bits())),
                Ok(false) => break,
                Err(error) => return Some(Err(error.cause)),
            }
        }
        let lost = reader.dropped().len() + reader.findings().len();
        Some(if lost == 0 { Ok(all) } else { Err("what was lost is reported".into()) })
    };
    (0..count).map(part).collect()
}

/// A file of the corpus; in a log, chunks that are stored as they are get the checksums that their
/// writer left out.
fn corpus(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/formats").join(name);
    let mut bytes = std::fs::read(&path).expect("the corpus");
    if let Some((crc32, records)) = chunk(&bytes) {
        let stated = crc32fast::hash(&bytes[records]).to_le_bytes();
        bytes[crc32..crc32 + 4].copy_from_slice(&stated);
    }
    bytes
}

/// Where the first chunk of an MCAP log has its checksum and its records: mcap.dev/spec, *Chunk*.
fn chunk(bytes: &[u8]) -> Option<(usize, Range<usize>)> {
    let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes")) as usize;
    let mut at = bytes.starts_with(b"\x89MCAP0\r\n").then_some(8)?;
    while bytes[at] != 6 {
        at += 9 + number(at + 1);
    }
    // Two times and a size; no name of a compression, and the length of the records.
    let (crc32, length) = (at + 9 + 24, at + 9 + 32);
    Some((crc32, length + 8..length + 8 + number(length)))
}

/// The bytes that checksums are of: the records of a chunk, the variables of a MATLAB file without
/// their tags, all of any other file.
fn covered(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut variables = Vec::new();
    let mut at = 128;
    while bytes.starts_with(b"MATLAB") && at < bytes.len() {
        let length = u32::from_le_bytes(bytes[at + 4..at + 8].try_into().expect("four bytes")) as usize;
        variables.push(at + 8..at + 8 + length);
        at += 8 + length;
    }
    match chunk(bytes) {
        Some((_, records)) => vec![records],
        None if variables.is_empty() => std::iter::once(0..bytes.len()).collect(),
        None => variables,
    }
}

/// Bits that change the numbers of a file and are not noticed, as words.
fn unnoticed(name: &str) -> Vec<String> {
    let bytes = corpus(name);
    let whole = numbers(&bytes).expect("an undamaged file is opened");
    assert!(whole.iter().flatten().any(|part| !part.is_empty()), "{name} holds numbers");
    let mut found = Vec::new();
    // An odd step meets each bit of a byte.
    let bits = covered(&bytes).into_iter().flat_map(|range| (8 * range.start..8 * range.end).step_by(3));
    for bit in bits {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let Some(read) = numbers(&damaged) else { continue };
        // A name may be damaged, and a part not be found: what is read is what was written.
        if read.iter().flatten().any(|now| !now.is_empty() && !whole.contains(&Ok(now.clone()))) {
            found.push(format!("bit {} of byte {}", bit % 8, bit / 8));
        }
    }
    found
}

#[test]
fn a_flipped_bit_is_an_error_or_changes_no_number() {
    for name in ["deflated.npz", "stored.npz", "packed.mat", "packed.npy.gz", "chunk.mcap"] {
        assert_eq!(unnoticed(name), [""; 0], "{name}");
    }
}

/// A plain array has no checksum: there, the same search finds bits.
#[test]
fn the_search_finds_what_is_not_noticed() {
    assert!(!unnoticed("plain.npy").is_empty());
}
