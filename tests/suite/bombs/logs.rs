//! Logs of messages: chunks of gigabytes, channels without end, rows that are one another's.

use libtest_mimic::{Failed, Trial};

use super::{BLOCK_BYTES, answered, packed_zeros};
use crate::suite::world::test;

/// Tests of this module.
pub(super) fn tests() -> Vec<Trial> {
    vec![
        test("bombs: MCAP chunks of gigabytes, channels told a million times, schemas of a megabyte", mcap),
        test("bombs: bags with chunks of gigabytes, and with topics without end", rosbag),
        test("bombs: databases whose rows are one another's", db3),
        test("bombs: DataFlash and ULog logs of any number of sensors", flight),
    ]
}

/// A counted text or list.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// A record of MCAP: mcap.dev/spec.
fn record(op: u8, data: &[u8]) -> Vec<u8> {
    [&[op][..], &(data.len() as u64).to_le_bytes(), data].concat()
}

/// A log without a summary.
fn mcap_log(records: &[Vec<u8>]) -> Vec<u8> {
    let magic = b"\x89MCAP0\r\n";
    [&magic[..], &record(1, &[0; 8]), &records.concat(), &record(15, &[0; 4]), &record(2, &[0; 20]), magic].concat()
}

fn schema(id: u16, name: &[u8]) -> Vec<u8> {
    record(3, &[&id.to_le_bytes()[..], &counted(name), &counted(b"ros2msg"), &counted(b"")].concat())
}

fn channel(id: u16, topic: &str) -> Vec<u8> {
    let schema = 1u16.to_le_bytes();
    record(4, &[&id.to_le_bytes()[..], &schema, &counted(topic.as_bytes()), &counted(b"cdr"), &counted(b"")].concat())
}

fn chunk(size: u64, compression: &str, packed: &[u8]) -> Vec<u8> {
    let head = [&[0; 16], &size.to_le_bytes()[..], &[0; 4], &counted(compression.as_bytes())].concat();
    record(6, &[&head[..], &(packed.len() as u64).to_le_bytes(), packed].concat())
}

/// Readings of an IMU in CDR: sensor_msgs/msg/Imu.
fn imu(row: u32) -> Vec<u8> {
    let header = [&[0, 1, 0, 0][..], &[0; 4], &(row * 10_000_000).to_le_bytes(), &counted(b"imu\0")].concat();
    let numbers = (0..37u32).flat_map(|i| f64::from((row * 37 + i).wrapping_mul(2_654_435_761)).to_le_bytes());
    header.into_iter().chain(numbers).collect()
}

fn mcap() -> Result<(), Failed> {
    let kind = b"sensor_msgs/msg/Imu";
    let messages = (0..90).map(|row| record(5, &[&[0; 22][..], &imu(row)].concat()));
    let honest: Vec<Vec<u8>> = [schema(1, kind), channel(0, "imu")].into_iter().chain(messages).collect();
    let blocks = 2048;
    let size = blocks as u64 * u64::from(BLOCK_BYTES);
    let chunks = [&[schema(1, kind), channel(0, "imu")][..], &vec![chunk(size, "zstd", &packed_zeros(blocks)); 40]];
    let channels = |times: usize| {
        let all = (0..=u16::MAX).cycle().take(times).map(|id| channel(id, &id.to_string()));
        all.collect::<Vec<_>>()
    };
    answered(&[
        ("honest.mcap", mcap_log(&honest), true),
        ("chunks.mcap", mcap_log(&chunks.concat()), false),
        ("channels.mcap", mcap_log(&[vec![schema(1, b"x")], channels(500_000)].concat()), false),
        ("schemas.mcap", mcap_log(&[vec![schema(1, &vec![b'x'; 4 << 20])], channels(60_000)].concat()), false),
    ])
}

/// A record of a bag: wiki.ros.org/Bags/Format/2.0.
fn bag_record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let field = |(name, value): &(&str, &[u8])| counted(&[name.as_bytes(), b"=", value].concat());
    let header: Vec<u8> = fields.iter().flat_map(field).collect();
    [counted(&header), counted(data)].concat()
}

fn connection(id: u32) -> Vec<u8> {
    let topic = id.to_string();
    let fields = [("op", &[7][..]), ("conn", &id.to_le_bytes()), ("topic", topic.as_bytes())];
    let kind = counted(b"type=sensor_msgs/Imu");
    bag_record(&fields, &kind)
}

/// A bag of these chunks, with the index behind them.
fn bag(chunks: &[Vec<u8>], index: &[Vec<u8>]) -> Vec<u8> {
    let body = chunks.concat();
    let head = |at: u64| {
        let fields = [("op", &[3][..]), ("index_pos", &at.to_le_bytes()), ("conn_count", &[0; 4])];
        [b"#ROSBAG V2.0\n", &bag_record(&fields, b"")[..]].concat()
    };
    let at = (head(0).len() + body.len()) as u64;
    [head(at), body, index.concat()].concat()
}

fn rosbag() -> Result<(), Failed> {
    // bzip2 of 45,899,235 zeros, one block as large as there may be; by Python's bz2.
    let stream = "425a68393141592653590e09e2df015f8e4000c0000008200030804d4642a025a90a80971772453850900e09e2df";
    let stream: Vec<u8> = (0..stream.len() / 2)
        .map(|i| u8::from_str_radix(&stream[2 * i..2 * i + 2], 16).map_err(|e| e.to_string()))
        .collect::<Result<_, _>>()?;
    let size = (5 * 45_899_235u32).to_le_bytes();
    let chunk = |compression: &[u8], size: u32, data: &[u8]| {
        bag_record(&[("op", &[5]), ("compression", compression), ("size", &size.to_le_bytes())], data)
    };
    let messages: Vec<u8> = (0..90)
        .flat_map(|row| {
            // As ROS 1 has it: a counter in place of the encapsulation.
            let imu = [&[0; 4][..], &imu(row)[4..]].concat();
            bag_record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &[0; 8])], &imu)
        })
        .collect();
    let plain = chunk(b"none", messages.len() as u32, &messages);
    let bomb = chunk(b"bz2", u32::from_le_bytes(size), &stream.repeat(5));
    let listed = |id: u32| bag_record(&[("op", &[6]), ("ver", &[1, 0, 0, 0])], &[id.to_le_bytes(); 2].concat());
    answered(&[
        ("honest.bag", bag(&[plain], &[connection(0)]), true),
        ("chunks.bag", bag(&vec![bomb; 40], &[connection(0)]), false),
        ("topics.bag", bag(&[], &(0..150_000).flat_map(|id| [connection(id), listed(id)]).collect::<Vec<_>>()), false),
    ])
}

/// A row of SQLite, as its cell: sqlite.org/fileformat2.html. Sizes of text and blobs are given as
/// types by `kinds`, in two bytes each.
fn row(size: u32, kinds: &[u32], body: &[u8]) -> Vec<u8> {
    // Numbers of four bytes of seven bits each.
    let wide = |n: u32| [(n >> 21) as u8 | 0x80, (n >> 14) as u8 | 0x80, (n >> 7) as u8 | 0x80, n as u8 & 0x7f];
    let header: Vec<u8> = kinds.iter().flat_map(|k| wide(*k)).collect();
    [&wide(size)[..], &[1], &[header.len() as u8 + 1], &header, body].concat()
}

const PAGE: usize = 1 << 16;

/// A page of a table whose cells are all one: so many pointers to it.
fn page(first: usize, rows: &[Vec<u8>], times: usize) -> Vec<u8> {
    let mut page = vec![0; PAGE];
    let mut end = PAGE;
    let mut pointers = Vec::new();
    for row in rows {
        end -= row.len();
        page[end..end + row.len()].copy_from_slice(row);
        pointers.extend(std::iter::repeat_n((end as u16).to_be_bytes(), times));
    }
    page[first] = 13;
    page[first + 3..first + 5].copy_from_slice(&(pointers.len() as u16).to_be_bytes());
    let pointers = pointers.concat();
    page[first + 8..first + 8 + pointers.len()].copy_from_slice(&pointers);
    page
}

/// A bag whose messages are so many times the same row: `data` begins on the page, and goes on
/// over the pages behind.
fn database(data: &[u8], times: usize) -> Vec<u8> {
    let text = |text: &str| 13 + 2 * text.len() as u32;
    let table = |name: &str, root: u8, columns: &str| {
        let sql = format!("CREATE TABLE {name} ({columns})");
        let body = [b"table", name.as_bytes(), name.as_bytes(), &[root], sql.as_bytes()].concat();
        let kinds = [text("table"), text(name), text(name), 1, text(&sql)];
        row((1 + 4 * kinds.len() + body.len()) as u32, &kinds, &body)
    };
    let tables = [
        table("topics", 2, "id, name, type, serialization_format"),
        table("messages", 3, "id, topic_id, timestamp, data"),
    ];
    let topic = ["imu", "sensor_msgs/msg/Imu", "cdr"];
    let kinds: Vec<u32> = std::iter::once(1).chain(topic.iter().map(|t| text(t))).collect();
    let body = [&[1], topic.concat().as_bytes()].concat();
    let topics = row((1 + 4 * kinds.len() + body.len()) as u32, &kinds, &body);
    let payload = (1 + 16 + 2 + data.len()) as u32;
    let message = row(payload, &[0, 1, 1, 12 + 2 * data.len() as u32], &[&[1, 0], data].concat());
    // What does not fit on a page: sqlite.org/fileformat2.html, *cell payload overflow pages*.
    let (begin, most, least) = (5, PAGE - 35, (PAGE - 12) * 32 / 255 - 23);
    let local = match payload as usize {
        all if all <= most => all,
        all => Some(least + (all - least) % (PAGE - 4)).filter(|l| *l <= most).unwrap_or(least),
    };
    let (front, rest) = message.split_at(begin + local);
    let overflow: Vec<Vec<u8>> = rest.chunks(PAGE - 4).map(<[u8]>::to_vec).collect();
    let mut cell = front.to_vec();
    if !overflow.is_empty() {
        cell.extend(4u32.to_be_bytes());
    }
    let mut head = page(100, &tables, 1);
    head[..16].copy_from_slice(b"SQLite format 3\0");
    head[16..18].copy_from_slice(&[0, 1]);
    let mut out = [head, page(0, &[topics], 1), page(0, &[cell], times)].concat();
    for (number, part) in overflow.iter().enumerate() {
        let next = if number + 1 < overflow.len() { 5 + number as u32 } else { 0 };
        let mut page = [&next.to_be_bytes()[..], part].concat();
        page.resize(PAGE, 0);
        out.extend(page);
    }
    out
}

fn db3() -> Result<(), Failed> {
    answered(&[
        ("rows.db3", database(&vec![0; 20 << 20], 6000), false),
        ("packed.db3", database(&packed_zeros(2048), 6000), false),
    ])
}

fn flight() -> Result<(), Failed> {
    // ArduPilot, libraries/AP_Logger: FMT, and messages of three bytes of head and a number.
    let format = |kind: u8| {
        let mut out = vec![0xa3, 0x95, 128, kind, 4];
        out.extend(format!("K{kind:03}B").bytes());
        out.resize(25, 0);
        out.push(b'I');
        out.resize(89, 0);
        out
    };
    let kinds = || (0..=255u8).filter(|kind| *kind != 128);
    let mut sensors: Vec<u8> = kinds().flat_map(format).collect();
    kinds().for_each(|kind| (0..=255u8).for_each(|instance| sensors.extend([0xa3, 0x95, kind, instance])));
    let mut topics = b"ULog\x01\x12\x35\x01".to_vec();
    topics.extend([0; 8]);
    for topic in 0..300_000 {
        let name = format!("\0\0\0{topic}");
        topics.extend((name.len() as u16).to_le_bytes());
        topics.push(b'A');
        topics.extend(name.bytes());
    }
    answered(&[("sensors.bin", sensors, false), ("topics.ulg", topics, false)])
}
