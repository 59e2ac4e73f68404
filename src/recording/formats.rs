//! The formats of recordings: each is one file here and one line in the registry.
//!
//! A file is known by its first bytes, whatever its name; what no format knows is text. A folder
//! stands for the one recording in it, as a EuRoC set or a ROS 2 bag is laid out.
//!
//! Readers are the project's own where the crate of a format holds much more than columns of
//! numbers. Weighed in 2026: `parquet` 60 brings 10 crates that this tree has not (its part here
//! has some 1,200 lines), `arrow-ipc` 60 brings 14 (500 lines), `zip` 9 brings 6 (the directory of
//! an archive is half of `npz`), and `rusqlite` 271,000 lines of C (430 lines), against the rule
//! that a reader is pure Rust. Each would need the same [`Budget`](super::budget::Budget) around
//! it, as a crate decides by itself what it allocates for what a file claims. Compression is left
//! to crates.

use std::path::{Path, PathBuf};

use super::format;
use super::headings::Headings;
use super::input::Input;
use super::memory::Memory;
use super::pack::{self, Pack, Unpacked};
use super::reader::{Log, Part};
use super::text::Text;
use crate::error::{Error, Result, nearest};

#[cfg(feature = "npy")]
pub mod array_file;
#[cfg(feature = "arrow")]
pub mod arrow;
#[cfg(all(test, feature = "formats"))]
mod checksums;
#[cfg(feature = "dataflash")]
pub mod dataflash;
#[cfg(feature = "db3")]
pub mod db3;
#[cfg(feature = "hdf5")]
pub mod hdf5;
#[cfg(feature = "mat")]
pub mod mat;
#[cfg(feature = "mcap")]
pub mod mcap;
#[cfg(feature = "npy")]
pub mod npz;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "rosbag")]
pub mod rosbag;
pub mod touchstone;
#[cfg(feature = "ulog")]
pub mod ulog;

/// A format of binary files.
#[derive(Debug)]
pub struct Format {
    /// Name of the format, for people.
    pub name: &'static str,
    /// States how its files begin, and at which byte.
    magic: (usize, &'static [u8]),
    open: fn(&Input) -> Result<Box<dyn Log>>,
}

/// All of them but text.
const ALL: &[Format] = &[
    #[cfg(feature = "npy")]
    Format { name: "NumPy array", magic: (0, b"\x93NUMPY"), open: array_file::open },
    #[cfg(feature = "npy")]
    Format { name: "NumPy archive", magic: (0, b"PK\x03\x04"), open: npz::open },
    #[cfg(feature = "mat")]
    Format { name: "MATLAB file", magic: (0, b"MATLAB 5.0 MAT-file"), open: mat::open },
    #[cfg(feature = "hdf5")]
    Format { name: "HDF5 file", magic: (0, b"\x89HDF\r\n\x1a\n"), open: hdf5::open },
    #[cfg(feature = "hdf5")]
    Format { name: "MATLAB file of version 7.3", magic: (0, b"MATLAB 7.3 MAT-file"), open: hdf5::open },
    #[cfg(feature = "parquet")]
    Format { name: "Parquet table", magic: (0, b"PAR1"), open: parquet::open },
    #[cfg(feature = "arrow")]
    Format { name: "Arrow table", magic: (0, b"ARROW1"), open: arrow::open },
    #[cfg(feature = "rosbag")]
    Format { name: "ROS 1 bag", magic: (0, b"#ROSBAG V2.0\n"), open: rosbag::open },
    #[cfg(feature = "mcap")]
    Format { name: "MCAP log", magic: (0, b"\x89MCAP0\r\n"), open: mcap::open },
    #[cfg(feature = "db3")]
    Format { name: "ROS 2 bag in SQLite", magic: (0, b"SQLite format 3\0"), open: db3::open },
    #[cfg(feature = "ulog")]
    Format { name: "PX4 ULog", magic: (0, b"ULog\x01\x12\x35"), open: ulog::open },
    #[cfg(feature = "dataflash")]
    Format { name: "ArduPilot DataFlash log", magic: (0, b"\xa3\x95"), open: dataflash::open },
];

/// Text that is no table: it is known by its first lines, not by bytes.
static TOUCHSTONE: Format = Format { name: "Touchstone file", magic: (0, b""), open: touchstone::open };

/// Arrays that come from no file.
static IN_MEMORY: Format = Format {
    name: "table in memory",
    magic: (0, b""),
    open: |input| Err(input.fail("it is no table in memory", "give a file")),
};

/// Beginnings of files that are not read, and what to do instead.
const REFUSED: &[(&[u8], &str, &str)] = &[
    (b"\x89HDF\r\n\x1a\n", "this is HDF5 data (also MATLAB's -v7.3), which this build does not read", HDF5),
    (b"MATLAB 7.3 MAT-file", "this is a MATLAB file of version 7.3, which is HDF5", HDF5),
    (b"#ROSBAG V1", "this is a ROS bag of version 1, before 2010", "rosbag fix brings it to version 2"),
    (
        b"FEA1",
        "this is a Feather file of version 1",
        "write it again as Feather version 2 (pyarrow.feather.write_feather)",
    ),
    (b"BZh", "this is bzip2 data, not text", "unpack it first: bunzip2 FILE"),
    (b"\xfd7zXZ\0", "this is xz data, not text", "unpack it first: unxz FILE"),
    (b"PK\x03\x04", "this is a zip archive or a spreadsheet", "save it as CSV"),
    (b"\xd0\xcf\x11\xe0", "this is an old spreadsheet", "save it as CSV"),
    (b"{", "this is JSON, not a table", "save the samples as CSV with a header, one row each; or as .npz or Parquet"),
];
const HDF5: &str = "build with --features hdf5 where the HDF5 library is installed; or save it as .npz or Parquet, or in MATLAB \
                    with save(…, '-v7')";

/// A file whose format is known.
#[derive(Debug)]
pub enum Found {
    /// Text: rows of cells.
    Text(Box<Text>),
    /// A format other than text.
    Log {
        /// Bytes of the file.
        input: Input,
        /// Format that was recognised.
        format: &'static Format,
        /// Topics, messages or arrays of the file.
        log: Box<dyn Log>,
    },
}

/// A file and the part of it that is read.
#[derive(Debug)]
pub enum Opened {
    /// Text, which is one table.
    Text(Box<Text>),
    /// A format other than text.
    Log {
        /// Bytes of the file.
        input: Input,
        /// Topics, messages or arrays of the file.
        log: Box<dyn Log>,
        /// Place of the part among them.
        part: usize,
        /// Headings of the part that was chosen.
        headings: Headings,
    },
}

/// The file that a path stands for: itself, or the one recording in a folder.
///
/// # Errors
/// A folder that holds none, or several.
pub fn located(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.into());
    }
    for inside in ["mav0/imu0/data.csv", "imu0/data.csv", "data.csv"] {
        if path.join(inside).is_file() {
            return Ok(path.join(inside));
        }
    }
    let listed = std::fs::read_dir(path).map_err(|e| Error::io("read", path, &e))?;
    let is_bag = |p: &PathBuf| p.extension().is_some_and(|e| ["mcap", "db3", "bag"].iter().any(|known| e == *known));
    let mut bags: Vec<PathBuf> = listed.flatten().map(|entry| entry.path()).filter(is_bag).collect();
    bags.sort();
    let name = |p: &PathBuf| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match &bags[..] {
        [only] => Ok(only.clone()),
        [] => Err(Error::new(
            format!("could not read {}", path.display()),
            "it is a folder, and holds neither a ROS bag nor imu0/data.csv",
            "give a file, not a folder",
        )),
        several => Err(Error::new(
            format!("could not read {}", path.display()),
            format!(
                "it is a folder with {} bags: {}",
                several.len(),
                several.iter().map(name).collect::<Vec<_>>().join(", ")
            ),
            "give one of them",
        )),
    }
}

/// Tells the format of a file and opens it.
///
/// # Errors
/// A file that no format knows, or that is damaged.
pub fn find(path: &Path) -> Result<Found> {
    find_in(Input::open(&located(path)?)?)
}

/// The same of bytes that are open already.
///
/// # Errors
/// As [`find`].
pub fn find_in(input: Input) -> Result<Found> {
    let head = input.head()?;
    let pack = pack::of(&head);
    if pack == Pack::None {
        return known(input, &head);
    }
    // What is packed is text, or is unpacked to be read at any place.
    let mut unpacked = Unpacked::new(&input, pack)?;
    let mut head = Vec::new();
    std::io::Read::read_to_end(&mut std::io::Read::take(&mut unpacked, super::input::HEAD_BYTES as u64), &mut head)
        .map_err(|e| unpacking(&input, pack, &e))?;
    if format_of(&head).is_none() {
        refuse(&input, &head)?;
        return Ok(Found::Text(Box::new(Text::open(input, pack)?)));
    }
    let mut unpacked = Unpacked::new(&input, pack)?;
    let inner = input.unpacked_by(&mut unpacked).map_err(|e| unpacking(&input, pack, &e))?;
    known(inner, &head)
}

fn unpacking(input: &Input, pack: Pack, error: &std::io::Error) -> Error {
    input.fail(format!("its {} data cannot be unpacked: {error}", pack.name()), "copy it again; is it complete?")
}

fn format_of(head: &[u8]) -> Option<&'static Format> {
    let known = ALL.iter().find(|f| head.get(f.magic.0..).is_some_and(|h| h.starts_with(f.magic.1)));
    known.or_else(|| touchstone::begins(head).then_some(&TOUCHSTONE))
}

fn refuse(input: &Input, head: &[u8]) -> Result<()> {
    match REFUSED.iter().find(|(magic, ..)| head.starts_with(magic)) {
        Some((_, cause, hint)) => Err(input.fail(*cause, *hint)),
        None => Ok(()),
    }
}

fn known(input: Input, head: &[u8]) -> Result<Found> {
    let Some(format) = format_of(head) else {
        refuse(&input, head)?;
        return Ok(Found::Text(Box::new(Text::open(input, Pack::None)?)));
    };
    let log = (format.open)(&input)?;
    Ok(Found::Log { input, format, log })
}

/// Opens a file at the part of this name; at the one that holds an IMU's readings, or the only one,
/// where none is given.
///
/// # Errors
/// As [`find`]; a part that is not there, that holds no numbers, or none that can be chosen without
/// a word of the user.
pub fn open(path: &Path, topic: Option<&str>) -> Result<Opened> {
    open_in(path, None, topic)
}

/// The same, with arrays in memory in place of the file where there are such.
///
/// # Errors
/// As [`open`].
pub(super) fn open_in(path: &Path, memory: Option<&Memory>, topic: Option<&str>) -> Result<Opened> {
    let found = match memory {
        Some(memory) => {
            let (input, arrays) = memory.opened();
            Found::Log { input, format: &IN_MEMORY, log: Box::new(arrays) }
        }
        None => find(path)?,
    };
    match found {
        Found::Text(text) => match topic {
            None => Ok(Opened::Text(text)),
            Some(topic) => Err(Error::new(
                format!("could not find the topic `{topic}` in {}", path.display()),
                "it is a table of text, which has no topics",
                "leave --topic out, or `topic` in the model",
            )),
        },
        Found::Log { input, format, log } => {
            let part = choose(&input, format, log.parts(), topic)?;
            let headings = Headings::stated(&log.parts()[part].columns);
            Ok(Opened::Log { input, log, part, headings })
        }
    }
}

fn choose(input: &Input, format: &Format, parts: &[Part], topic: Option<&str>) -> Result<usize> {
    let all = || {
        let named = |p: &Part| if p.kind.is_empty() { p.name.clone() } else { format!("{} ({})", p.name, p.kind) };
        let mut words: Vec<String> = parts.iter().take(40).map(named).collect();
        if parts.len() > words.len() {
            words.push(format!("and {} more", parts.len() - words.len()));
        }
        if words.is_empty() { "nothing".to_owned() } else { words.join(", ") }
    };
    if let Some(topic) = topic {
        let fail = |cause: String, hint: String| {
            Err(Error::new(format!("could not find the topic `{topic}` in {}", input.path.display()), cause, hint))
        };
        return match parts.iter().position(|p| p.name == topic) {
            Some(place) if parts[place].columns.is_empty() => fail(
                format!("its messages are {}, which hold no supported numbers", parts[place].kind),
                "supported are messages of sensor_msgs/Imu, MagneticField, Temperature, FluidPressure, and of poses, \
                odometry and \
                 twists with a header"
                    .into(),
            ),
            Some(place) => Ok(place),
            None => fail(
                format!("the {} has {}", format.name, all()),
                nearest(topic, parts.iter().map(|p| p.name.as_str()))
                    .map_or("give one of these".into(), |near| format!("did you mean `{near}`?")),
            ),
        };
    }
    let readable = |p: &&(usize, &Part)| !p.1.columns.is_empty();
    let listed: Vec<(usize, &Part)> = parts.iter().enumerate().collect();
    let imus: Vec<&(usize, &Part)> = listed.iter().filter(|p| p.1.is_imu).filter(readable).collect();
    match (&imus[..], &listed[..]) {
        ([only], _) => Ok(only.0),
        ([], [only]) if readable(&only) => Ok(only.0),
        ([], _) => Err(input.fail(
            format!("the {} holds no IMU's readings; it holds {}", format.name, all()),
            match parts.iter().find(|p| !p.columns.is_empty()) {
                Some(part) => {
                    format!("to read one of these, name it: --topic {}, or `topic` in the model", part.name)
                }
                None => "record the topic of the IMU (sensor_msgs/Imu), or export its readings as CSV".to_owned(),
            },
        )),
        (several, _) => Err(input.fail(
            format!(
                "the {} holds the readings of {} IMUs: {}",
                format.name,
                several.len(),
                several.iter().map(|p| p.1.name.as_str()).collect::<Vec<_>>().join(", ")
            ),
            format!("choose one: --topic {}, or topic = {:?} in the model", several[0].1.name, several[0].1.name),
        )),
    }
}

impl Opened {
    /// Headings of its columns.
    pub fn headings(&self) -> &Headings {
        match self {
            Self::Text(text) => text.headings(),
            Self::Log { headings, .. } => headings,
        }
    }

    /// The part that is read; none of a table of text.
    pub fn part(&self) -> Option<&Part> {
        match self {
            Self::Text(_) => None,
            Self::Log { log, part, .. } => log.parts().get(*part),
        }
    }

    /// The column that a format says is the clock.
    pub fn stated_clock(&self) -> Option<&str> {
        match self {
            Self::Text(_) => None,
            Self::Log { log, part, .. } => log.parts()[*part].columns.iter().find(|c| c.clock).map(|c| c.name.as_str()),
        }
    }

    /// Returns whether a heading of it names a clock.
    pub fn names_a_clock(&self, heading: &str) -> bool {
        match self {
            Self::Text(text) => text.names_a_clock(heading),
            Self::Log { .. } => format::names_a_clock(heading),
        }
    }

    /// The first heading that names a clock.
    pub fn clock_like(&self) -> Option<&str> {
        let named = || self.headings().names.iter().map(String::as_str).find(|n| self.names_a_clock(n));
        self.stated_clock().or_else(named)
    }

    /// Places of the columns of numbers that are no clock.
    ///
    /// # Errors
    /// None, or more than 64.
    pub fn numeric_places(&self) -> Result<Vec<usize>> {
        let (log, part, input) = match self {
            Self::Text(text) => return text.numeric_places(),
            Self::Log { log, part, input, .. } => (log, *part, input),
        };
        let columns = &log.parts()[part].columns;
        let places: Vec<usize> = (0..columns.len())
            .filter(|p| !columns[*p].clock && !columns[*p].aside && !format::names_a_clock(&columns[*p].name))
            .collect();
        match places.len() {
            0 => Err(input.fail("no column holds numbers", "name the columns wanted")),
            1..=64 => Ok(places),
            n => Err(input.fail(format!("it has {n} columns of numbers"), "name the columns wanted")),
        }
    }
}
