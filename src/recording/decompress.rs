//! Compressed parts of files, each to the size that its file states.

use std::io::Read;

use super::budget::{Budget, LARGEST_BYTES, Spent};
#[cfg(feature = "zstd")]
use super::zstandard;

/// States how a part is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "which of them are met is a matter of features")]
pub enum Codec {
    /// Stored without compression.
    None,
    /// Snappy's raw format.
    Snappy,
    /// gzip, RFC 1952.
    Gzip,
    /// Zstandard, RFC 8878.
    Zstandard,
    /// A bare LZ4 block.
    Lz4Block,
    /// LZ4 frames.
    Lz4Frame,
    /// bzip2.
    Bzip2,
}

/// Decompresses a part whose size is stated, which is charged first.
///
/// # Errors
/// In words: damaged data, another size than the one stated, one beyond [`LARGEST_BYTES`], or more
/// than the budget has.
#[allow(unused_variables, reason = "which codecs there are is a matter of features")]
pub fn decompress(codec: Codec, from: &[u8], size: u64, budget: &mut Budget) -> Result<Vec<u8>, String> {
    if size > LARGEST_BYTES {
        return Err(format!(
            "{} bytes are said to become {size} when decompressed, more than the {} MiB that one part may have",
            from.len(),
            LARGEST_BYTES >> 20
        ));
    }
    budget.unpacked(size).map_err(Spent::words)?;
    let bytes = match codec {
        Codec::None => from.to_vec(),
        #[cfg(feature = "parquet")]
        Codec::Snappy => {
            let stated = snap::raw::decompress_len(from).map_err(|e| format!("damaged Snappy data: {e}"))?;
            if stated as u64 != size {
                return Err(format!("Snappy data of {stated} bytes where {size} were expected"));
            }
            snap::raw::Decoder::new().decompress_vec(from).map_err(|e| format!("damaged Snappy data: {e}"))?
        }
        #[cfg(feature = "gzip")]
        Codec::Gzip => whole(flate2::read::MultiGzDecoder::new(from), size, "gzip")?,
        #[cfg(feature = "zstd")]
        Codec::Zstandard => whole(zstandard::Frames::new(from), size, "Zstandard")?,
        #[cfg(any(feature = "parquet", feature = "arrow", feature = "mcap", feature = "rosbag"))]
        Codec::Lz4Block => {
            lz4_flex::block::decompress(from, size as usize).map_err(|e| format!("damaged LZ4 data: {e}"))?
        }
        #[cfg(any(feature = "parquet", feature = "arrow", feature = "mcap", feature = "rosbag"))]
        Codec::Lz4Frame => whole(lz4_flex::frame::FrameDecoder::new(from), size, "LZ4")?,
        #[cfg(feature = "rosbag")]
        Codec::Bzip2 => whole(bzip2::read::MultiBzDecoder::new(from), size, "bzip2")?,
        #[allow(unreachable_patterns, reason = "which of them remain is a matter of features")]
        other => return Err(format!("this build does not decompress {other:?}")),
    };
    if bytes.len() as u64 == size {
        Ok(bytes)
    } else {
        Err(format!("{} bytes after decompression where {size} were expected", bytes.len()))
    }
}

/// All that a decoder gives, and no more than one byte beyond what is expected.
#[allow(dead_code, reason = "without features nothing is compressed")]
fn whole(decoder: impl Read, size: u64, name: &str) -> Result<Vec<u8>, String> {
    let mut out = Vec::with_capacity(usize::try_from(size + 1).map_err(|e| e.to_string())?);
    decoder.take(size + 1).read_to_end(&mut out).map_err(|e| format!("damaged {name} data: {e}"))?;
    Ok(out)
}
