//! A damaged byte in a format that has checksums is never read as another number.

use std::ops::Range;
use std::path::Path;

use super::find_in;
use crate::bytes::Bytes;
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
    if let Some((crc32, records)) = chunk(&bytes)
        && bytes[crc32..crc32 + 4] == [0; 4]
        && bytes[crc32 + 4..crc32 + 8] == [0; 4]
    {
        let stated = crc32fast::hash(&bytes[records]).to_le_bytes();
        bytes[crc32..crc32 + 4].copy_from_slice(&stated);
    }
    bytes
}

/// Returns where the first chunk of an MCAP log has its checksum and its records: mcap.dev/spec,
/// *Chunk*.
fn chunk(bytes: &[u8]) -> Option<(usize, Range<usize>)> {
    let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes")) as usize;
    let mut at = bytes.starts_with(b"\x89MCAP0\r\n").then_some(8)?;
    while bytes[at] != 6 {
        at += 9 + number(at + 1);
    }
    // Two times and a size; the name of the compression, and the length of the records.
    let crc32 = at + 9 + 24;
    let name_bytes = u32::from_le_bytes(bytes[crc32 + 4..crc32 + 8].try_into().expect("four bytes"));
    let length = crc32 + 8 + name_bytes as usize;
    Some((crc32, length + 8..length + 8 + number(length)))
}

/// The bytes that checksums are of: the records of a chunk, in a bag its packed data, the numbers
/// in the pages of a plain Parquet table, all of any other file.
fn covered(name: &str, bytes: &[u8]) -> Range<usize> {
    if bytes.starts_with(b"#ROSBAG") {
        return bag_chunk(bytes).expect("a chunk");
    }
    if bytes.starts_with(b"PAR1") {
        let second = memchr::memmem::find(bytes, &f64::sin(1.0).to_le_bytes()).expect("the sine of 1");
        return second - 8..second + 8 * 19;
    }
    match chunk(bytes) {
        Some((_, records)) if name != "checked.mcap" => records,
        _ => 0..bytes.len(),
    }
}

/// Returns where the first chunk of a bag has its data: wiki.ros.org/Bags/Format/2.0.
fn bag_chunk(bytes: &[u8]) -> Option<Range<usize>> {
    let number = |at: usize| bytes.get(at..at + 4).map(|four| Bytes::new(four).u32().unwrap_or_default() as usize);
    let mut at = 13;
    loop {
        let header = at + 4..at + 4 + number(at)?;
        let data = header.end + 4..header.end + 4 + number(header.end)?;
        if memchr::memmem::find(&bytes[header], b"compression=").is_some() {
            return Some(data);
        }
        at = data.end;
    }
}

/// Bits that change the numbers of a file and are not noticed, as words.
fn unnoticed(name: &str) -> Vec<String> {
    let bytes = corpus(name);
    let whole = numbers(&bytes).expect("an undamaged file is opened");
    assert!(whole.iter().flatten().any(|part| !part.is_empty()), "{name} holds numbers");
    let mut found = Vec::new();
    // An odd step meets each bit of a byte.
    let range = covered(name, &bytes);
    let bits = (8 * range.start..8 * range.end).step_by(3);
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
    let files = [
        "deflated.npz",
        "stored.npz",
        "packed.mat",
        "packed.npy.gz",
        "packed.npy.zst",
        "chunk.mcap",
        "checked.mcap",
        "checked_zstd.mcap",
        "checked.parquet",
        "checked.bag",
        "bzip2.bag",
    ];
    for name in files {
        let bits = unnoticed(name);
        assert!(bits.is_empty(), "{name}: {} bits, the first {:?}", bits.len(), bits.first());
    }
}

/// A plain array has no checksum: there, the same search finds bits.
#[test]
fn the_search_finds_what_is_not_noticed() {
    assert!(!unnoticed("plain.npy").is_empty());
}
