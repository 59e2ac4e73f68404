//! Messages of known layout, as ROS 1 serialises them and as ROS 2 does (CDR, OMG
//! formal/2018-12-02).

use super::clock::stamp::Stamp;
use super::input::Input;
use super::reader::{BLOCK_ROWS, Block, Choice, Heading, Part, Reader};
use crate::error::Result;

/// One field behind the header, in the order of the message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Item {
    /// A double that is a column, and its unit.
    Column(&'static str, &'static str),
    /// So many doubles that are none.
    Doubles(usize),
    Text,
}
use Item::{Column, Doubles, Text};

/// A message that begins with a header: time stamp and frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    kind: &'static str,
    items: &'static [Item],
    /// It holds angular rates and specific forces.
    pub is_imu: bool,
}

const POSE: [Item; 7] = [
    Column("px", "m"),
    Column("py", "m"),
    Column("pz", "m"),
    Column("qx", "1"),
    Column("qy", "1"),
    Column("qz", "1"),
    Column("qw", "1"),
];
const TWIST: [Item; 6] = [
    Column("vx", "m/s"),
    Column("vy", "m/s"),
    Column("vz", "m/s"),
    Column("wx", "rad/s"),
    Column("wy", "rad/s"),
    Column("wz", "rad/s"),
];

const LAYOUTS: &[Layout] = &[
    Layout {
        kind: "sensor_msgs/Imu",
        items: &[
            Doubles(13),
            Column("gx", "rad/s"),
            Column("gy", "rad/s"),
            Column("gz", "rad/s"),
            Doubles(9),
            Column("ax", "m/s2"),
            Column("ay", "m/s2"),
            Column("az", "m/s2"),
            Doubles(9),
        ],
        is_imu: true,
    },
    Layout {
        kind: "sensor_msgs/MagneticField",
        items: &[Column("mx", "T"), Column("my", "T"), Column("mz", "T"), Doubles(9)],
        is_imu: false,
    },
    Layout { kind: "sensor_msgs/Temperature", items: &[Column("temperature", "degC"), Doubles(1)], is_imu: false },
    Layout { kind: "sensor_msgs/FluidPressure", items: &[Column("pressure", "Pa"), Doubles(1)], is_imu: false },
    Layout { kind: "geometry_msgs/PoseStamped", items: &POSE, is_imu: false },
    Layout { kind: "geometry_msgs/PoseWithCovarianceStamped", items: &POSE, is_imu: false },
    Layout {
        kind: "geometry_msgs/TransformStamped",
        items: &[Text, POSE[0], POSE[1], POSE[2], POSE[3], POSE[4], POSE[5], POSE[6]],
        is_imu: false,
    },
    Layout { kind: "geometry_msgs/PointStamped", items: &[POSE[0], POSE[1], POSE[2]], is_imu: false },
    Layout { kind: "geometry_msgs/TwistStamped", items: &TWIST, is_imu: false },
    Layout {
        kind: "nav_msgs/Odometry",
        items: &[
            Text,
            POSE[0],
            POSE[1],
            POSE[2],
            POSE[3],
            POSE[4],
            POSE[5],
            POSE[6],
            Doubles(36),
            TWIST[0],
            TWIST[1],
            TWIST[2],
            TWIST[3],
            TWIST[4],
            TWIST[5],
        ],
        is_imu: false,
    },
];

/// States how messages are serialised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// ROS 1: no padding, lowest byte first.
    Ros1,
    /// CDR, with its four bytes of encapsulation.
    Cdr,
}

/// The layout of messages of this type, as ROS 1 (`sensor_msgs/Imu`) or ROS 2
/// (`sensor_msgs/msg/Imu`) names it.
pub(crate) fn layout(kind: &str) -> Option<&'static Layout> {
    let plain = kind.replace("/msg/", "/");
    LAYOUTS.iter().find(|l| l.kind == plain)
}

impl Layout {
    /// Its columns: the clock, then the numbers.
    pub(crate) fn columns(&self) -> Vec<Heading> {
        let numbers = self.items.iter().filter_map(|item| match item {
            Column(name, unit) => Some(Heading::in_unit(*name, unit)),
            _ => None,
        });
        std::iter::once(Heading::clock("stamp", "ns")).chain(numbers).collect()
    }

    /// Takes a message apart: its stamp in ns since 1970 and the numbers in order; `None` where it
    /// is too short.
    fn read(&self, encoding: Encoding, message: &[u8], values: &mut Vec<f64>) -> Option<i64> {
        let mut walk = Walk::new(encoding, message)?;
        if encoding == Encoding::Ros1 {
            walk.u32()?;
        }
        let (seconds, nanoseconds) = (walk.u32()?, walk.u32()?);
        walk.text()?;
        // ROS 1 counts seconds without a sign until 2106, ROS 2 with one until 2038: as the first,
        // they agree for now.
        let stamp = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
        values.clear();
        for item in self.items {
            match item {
                Column(..) => values.push(walk.f64()?),
                Doubles(count) => walk.doubles(*count)?,
                Text => walk.text()?,
            }
        }
        Some(stamp)
    }
}

/// Passes through a message.
struct Walk<'a> {
    message: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Alignment counts from here, to this many bytes at most.
    origin: usize,
    aligned: usize,
}

impl<'a> Walk<'a> {
    fn new(encoding: Encoding, message: &'a [u8]) -> Option<Self> {
        let plain = Self { message, at: 0, big_endian: false, origin: 0, aligned: 1 };
        match (encoding, message) {
            (Encoding::Ros1, _) => Some(plain),
            // XCDR1 and XCDR2, plain.
            (Encoding::Cdr, [0, kind @ (0 | 1 | 6 | 7), ..]) if message.len() >= 4 => {
                let aligned = if *kind < 2 { 8 } else { 4 };
                Some(Self { at: 4, origin: 4, big_endian: kind % 2 == 0, aligned, ..plain })
            }
            _ => None,
        }
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let step = self.aligned.min(N);
        let at = self.origin + (self.at - self.origin).next_multiple_of(step);
        let mut bytes: [u8; N] = self.message.get(at..at + N)?.try_into().ok()?;
        self.at = at + N;
        if self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn doubles(&mut self, count: usize) -> Option<()> {
        (0..count).try_for_each(|_| self.take::<8>().map(drop))
    }

    fn text(&mut self) -> Option<()> {
        let length = self.u32()? as usize;
        self.at = self.at.checked_add(length).filter(|end| *end <= self.message.len())?;
        Some(())
    }
}

/// A topic's part of a log.
pub(crate) fn part(name: String, kind: String, rows: Option<u64>, readable: bool) -> Part {
    let layout = layout(&kind).filter(|_| readable);
    let columns = layout.map(Layout::columns).unwrap_or_default();
    Part { name, kind, rows, columns, is_imu: layout.is_some_and(|l| l.is_imu) }
}

/// The messages of one topic, in the order of the file.
pub(super) trait Messages: std::fmt::Debug + Send {
    /// Appends the next message to `into`, which is empty; false at the end.
    ///
    /// # Errors
    /// What is damaged.
    fn next(&mut self, into: &mut Vec<u8>) -> Result<bool>;

    /// Returns how far the file was read, bytes.
    fn bytes_read(&self) -> u64;
}

/// Rows out of messages.
#[derive(Debug)]
pub(super) struct MessageRows {
    pub input: Input,
    /// States where the messages come from.
    pub messages: Box<dyn Messages>,
    /// Type of the messages, as the file calls it.
    pub kind: String,
    /// States how they are serialised.
    pub encoding: Encoding,
    /// Holds what is wanted of them.
    pub choice: Choice,
    /// States how many messages the file says there are.
    pub stated: Option<u64>,
    /// States how many were given.
    pub count: u64,
}

impl Reader for MessageRows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        let Some(layout) = layout(&self.kind) else { return Ok(false) };
        let (mut message, mut values) = (Vec::new(), Vec::new());
        while block.rows < BLOCK_ROWS {
            message.clear();
            if !self.messages.next(&mut message)? {
                if let Some(stated) = self.stated.filter(|stated| *stated != self.count) {
                    return Err(self.input.fail(
                        format!("the log states {stated} messages of the topic, and holds {}", self.count),
                        "it is damaged: copy it again, or have it indexed again (`rosbag reindex`, `mcap recover`)",
                    ));
                }
                break;
            }
            let Some(stamp) = layout.read(self.encoding, &message, &mut values) else {
                return Err(self.input.fail(
                    format!(
                        "message {} of the topic has {} bytes, which is not a {} in {}",
                        self.count,
                        message.len(),
                        self.kind,
                        if self.encoding == Encoding::Cdr { "CDR" } else { "ROS 1 serialisation" }
                    ),
                    "was it recorded with another definition of that message? Export the topic as CSV",
                ));
            };
            self.count += 1;
            block.rows += 1;
            if self.choice.time.is_some() {
                block.stamps.push(Stamp::of_integer(stamp));
            }
            for (column, place) in block.columns.iter_mut().zip(&self.choice.places) {
                column.push(place.checked_sub(1).map_or(stamp as f64, |p| values[p]));
            }
        }
        Ok(block.rows > 0)
    }

    fn bytes_read(&self) -> u64 {
        self.messages.bytes_read()
    }
}
