//! Files of a few bytes that claim gigabytes, or visits without end: each is answered within ten
//! seconds of processor time and two gigabytes, and an honest file of the same making is read.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};

use super::bench::Bench;
use super::world::{check, program, test};

mod arrays;
mod logs;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("bombs: Parquet pages of billions of rows, and footers of millions of values", parquet),
        test("bombs: Arrow batches of gigabytes, and schemas whose fields are one another's", arrow),
        test("bombs: ULog formats of any number of fields", ulog),
    ];
    all.extend(logs::tests());
    all.extend(arrays::tests());
    all
}

/// Address space that the program may take, KiB, and processor time, s: the same on a busy machine.
const MOST_KIB: u64 = 2_000_000;
const MOST_CPU_S: u64 = 10;
/// Longest wait for a program that does nothing.
const LONGEST: Duration = Duration::from_secs(300);

/// How the program ends on a file: its exit code, within the bounds.
fn ended(file: &Path, command: &str) -> Result<i32, Failed> {
    let what = format!("{command} {}", file.display());
    let mut shell = Command::new("sh");
    // Few threads: each reserves address space that it never uses.
    shell.env("RAYON_NUM_THREADS", "2").env("MALLOC_ARENA_MAX", "2");
    shell
        .args(["-c", &format!("ulimit -v {MOST_KIB}; ulimit -t {MOST_CPU_S}; exec \"$0\" \"$@\"")])
        .arg(program().get_program());
    shell.arg(command).arg(file).stdout(Stdio::null()).stderr(Stdio::null());
    if command == "allan" {
        shell.args(["--rate-hz", "100"]);
    }
    let mut child = shell.spawn()?;
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return status.code().ok_or_else(|| format!("{what}: {status}").into());
        }
        if begun.elapsed() > LONGEST {
            child.kill()?;
            child.wait()?;
            return Err(format!("{what}: no end after {LONGEST:?}").into());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Reads each file with both commands: those that are `honest` are read, the other ones answered.
fn answered(files: &[(&str, Vec<u8>, bool)]) -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut wrong = Vec::new();
    for (name, bytes, honest) in files {
        let path = bench.path(name);
        std::fs::write(&path, bytes)?;
        for command in ["inspect", "allan"] {
            let expected: &[i32] = if *honest { &[0] } else { &[0, 2] };
            match ended(&path, command) {
                Err(words) => wrong.push(words.message().unwrap_or_default().to_owned()),
                Ok(code) if !expected.contains(&code) => wrong.push(format!("{name}: {command} ends with {code}")),
                Ok(code) if !*honest && command == "allan" && code != 2 => wrong.push(format!("{name}: was read")),
                Ok(_) => {}
            }
        }
    }
    check(wrong.is_empty(), wrong.join("\n"))
}

/// Thrift's compact protocol: apache.org/thrift, *compact protocol*.
#[derive(Default)]
struct Thrift {
    bytes: Vec<u8>,
    last: u8,
}

fn varint(mut n: u64) -> Vec<u8> {
    let mut out = Vec::new();
    loop {
        let byte = (n & 0x7f) as u8;
        n >>= 7;
        if n == 0 {
            out.push(byte);
            return out;
        }
        out.push(byte | 0x80);
    }
}

impl Thrift {
    fn field(mut self, id: u8, kind: u8, value: &[u8]) -> Self {
        self.bytes.push((id - self.last) << 4 | kind);
        self.bytes.extend_from_slice(value);
        self.last = id;
        self
    }

    /// A whole number that is not negative.
    fn number(self, id: u8, n: u64) -> Self {
        self.field(id, 6, &varint(n << 1))
    }

    fn text(self, id: u8, text: &str) -> Self {
        self.field(id, 8, &[&varint(text.len() as u64), text.as_bytes()].concat())
    }

    fn structure(self, id: u8, inner: Thrift) -> Self {
        self.field(id, 12, &inner.end())
    }

    fn list(self, id: u8, kind: u8, items: &[Vec<u8>]) -> Self {
        assert!(items.len() < 15, "a short list");
        self.field(id, 9, &[&[(items.len() as u8) << 4 | kind][..], &items.concat()].concat())
    }

    fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}

/// A table of so many columns and rows, all of them the number 1.5: a dictionary of one entry, and
/// one page that is one run of its index. Format: parquet.apache.org/docs/file-format.
fn constant_table(rows: u64, names: &[&str]) -> Vec<u8> {
    let mut out = b"PAR1".to_vec();
    let mut chunks = Vec::new();
    for name in names {
        let dictionary_at = out.len() as u64;
        let entry = 1.5f64.to_le_bytes();
        let page = Thrift::default().number(1, 2).number(2, 8).number(3, 8);
        out.extend(page.structure(7, Thrift::default().number(1, 1).number(2, 0)).end());
        out.extend(entry);
        let at = out.len() as u64;
        let body = [&[1][..], &varint(rows << 1), &[0]].concat();
        let page = Thrift::default().number(1, 0).number(2, body.len() as u64).number(3, body.len() as u64);
        let of_data = Thrift::default().number(1, rows).number(2, 8).number(3, 3).number(4, 3);
        out.extend(page.structure(5, of_data).end());
        out.extend(body);
        let name = [&varint(name.len() as u64), name.as_bytes()].concat();
        let column = Thrift::default().number(1, 5).list(2, 5, &[vec![0], vec![16]]).list(3, 8, &[name]);
        let column = column.number(4, 0).number(5, rows).number(6, 100).number(7, 100).number(9, at);
        chunks.push(Thrift::default().number(2, at).structure(3, column.number(11, dictionary_at)).end());
    }
    let root = Thrift::default().text(4, "root").number(5, names.len() as u64).end();
    let leaves = names.iter().map(|name| Thrift::default().number(1, 5).number(3, 0).text(4, name).end());
    let schema: Vec<Vec<u8>> = [root].into_iter().chain(leaves).collect();
    let group = Thrift::default().list(1, 12, &chunks).number(2, 100).number(3, rows).end();
    let footer = Thrift::default().number(1, 1).list(2, 12, &schema).number(3, rows).list(4, 12, &[group]).end();
    closed(out, &footer)
}

fn closed(mut out: Vec<u8>, footer: &[u8]) -> Vec<u8> {
    out.extend_from_slice(footer);
    out.extend((footer.len() as u32).to_le_bytes());
    out.extend(b"PAR1");
    out
}

fn parquet() -> Result<(), Failed> {
    // A list of sixty-four million values, each a byte of the file and forty in memory.
    let count = 64_000_000;
    let list = [&[0x19, 0xf1][..], &varint(count), &vec![1; count as usize], &[0]].concat();
    answered(&[
        ("honest.parquet", constant_table(5000, &["a", "b"]), true),
        ("billions.parquet", constant_table((1 << 31) - 1, &["a"]), false),
        ("millions.parquet", constant_table(100_000_000, &["a"]), false),
        ("three.parquet", constant_table(150_000_000, &["a", "b", "c"]), false),
        ("footer.parquet", closed(b"PAR1".to_vec(), &list), false),
    ])
}

/// FlatBuffers, laid out from front to back: google.github.io/flatbuffers, *internals*.
#[derive(Default)]
struct Flat(Vec<u8>);

/// A field of a table: its number and its bytes; an offset is four that are set later.
type Field<'a> = (usize, &'a [u8]);

impl Flat {
    fn align(&mut self) {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
    }

    /// The place of a table, and of its fields in their order.
    fn table(&mut self, fields: &[Field<'_>]) -> (usize, Vec<usize>) {
        let highest = fields.iter().map(|f| f.0).max().unwrap_or_default();
        let (mut offsets, mut places, mut size) = (vec![0u16; highest + 1], Vec::new(), 8usize);
        for (number, bytes) in fields {
            offsets[*number] = size as u16;
            places.push(size);
            size += bytes.len().next_multiple_of(8);
        }
        self.align();
        let vtable = self.0.len();
        self.0.extend(((4 + 2 * offsets.len()) as u16).to_le_bytes());
        self.0.extend((size as u16).to_le_bytes());
        self.0.extend(offsets.iter().flat_map(|o| o.to_le_bytes()));
        self.align();
        let table = self.0.len();
        self.0.extend(((table - vtable) as i32).to_le_bytes());
        self.0.resize(table + size, 0);
        for ((_, bytes), place) in fields.iter().zip(&places) {
            self.0[table + place..table + place + bytes.len()].copy_from_slice(bytes);
        }
        (table, places.into_iter().map(|place| table + place).collect())
    }

    /// Lets an offset point to a place behind it.
    fn point(&mut self, from: usize, to: usize) {
        self.0[from..from + 4].copy_from_slice(&((to - from) as u32).to_le_bytes());
    }

    /// A list of so many entries, at the end: the place of its length.
    fn list(&mut self, count: usize, bytes: &[u8]) -> usize {
        self.align();
        let at = self.0.len();
        self.0.extend((count as u32).to_le_bytes());
        self.0.extend_from_slice(bytes);
        at
    }
}

const OFFSET: &[u8] = &[0; 4];

/// An Arrow file: its footer holds a schema whose list of fields is set by `fields`, from the place
/// of the offset that points to it.
fn arrow_file(before: &[u8], batches: &[[u64; 3]], fields: impl FnOnce(&mut Flat, usize)) -> Vec<u8> {
    let mut flat = Flat(vec![0; 8]);
    let (footer, places) = flat.table(&[(0, &4u16.to_le_bytes()), (1, OFFSET), (3, OFFSET)]);
    flat.point(0, footer);
    let (schema, of_schema) = flat.table(&[(1, OFFSET)]);
    flat.point(places[1], schema);
    let blocks: Vec<u8> = batches.iter().flatten().flat_map(|n| n.to_le_bytes()).collect();
    let list = flat.list(batches.len(), &blocks);
    flat.point(places[2], list);
    fields(&mut flat, of_schema[0]);
    let size = (flat.0.len() as u32).to_le_bytes();
    [b"ARROW1\0\0", before, &flat.0, &size, b"ARROW1"].concat()
}

/// A schema of lists within lists: each has so many fields, and all of them are one.
fn nested(width: usize, depth: usize) -> Vec<u8> {
    arrow_file(&[], &[], |flat, mut parent| {
        for level in 0..depth {
            let list = flat.list(width, &vec![0; 4 * width]);
            flat.point(parent, list);
            // A structure, and at last nothing.
            let is_last = level + 1 == depth;
            let (field, places) = match is_last {
                true => flat.table(&[(2, &[1])]),
                false => flat.table(&[(2, &[13]), (5, OFFSET)]),
            };
            (0..width).for_each(|i| flat.point(list + 4 + 4 * i, field));
            parent = if is_last { parent } else { places[1] };
        }
    })
}

/// Bytes of a block of Zstandard, at most.
const BLOCK_BYTES: u32 = 128 << 10;

/// So many blocks of one byte again and again, packed by Zstandard (RFC 8878) as runs; the frame
/// states its size.
fn packed_zeros(blocks: usize) -> Vec<u8> {
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 2 << 6, 7 << 3];
    frame.extend((blocks as u32 * BLOCK_BYTES).to_le_bytes());
    for block in 1..=blocks {
        let head = u32::from(block == blocks) | 1 << 1 | BLOCK_BYTES << 3;
        frame.extend_from_slice(&head.to_le_bytes()[..3]);
        frame.push(0);
    }
    frame
}

/// A batch that stands in the file so many times, of columns of zeros, all of them one buffer of
/// `blocks` · 128 KiB.
fn zeros(times: usize, columns: usize, blocks: usize) -> Vec<u8> {
    let size = blocks as u64 * u64::from(BLOCK_BYTES);
    let body = [&size.to_le_bytes()[..], &packed_zeros(blocks)].concat();
    let rows = size / 8;
    let mut message = Flat(vec![0; 8]);
    let (root, places) = message.table(&[(0, &4u16.to_le_bytes()), (1, &[3]), (2, OFFSET)]);
    message.point(0, root);
    let (batch, of_batch) = message.table(&[(0, &rows.to_le_bytes()), (1, OFFSET), (2, OFFSET), (3, OFFSET)]);
    message.point(places[2], batch);
    let numbers = |all: &[u64]| all.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    // Lists of structures begin where a number of 64 bits may.
    for (place, entry) in [(of_batch[1], [rows, 0].to_vec()), (of_batch[2], [0, 0, 0, body.len() as u64].to_vec())] {
        message.align();
        message.0.extend([0; 4]);
        let count = columns * entry.len() / 2;
        let at = message.0.len();
        message.0.extend((count as u32).to_le_bytes());
        message.0.extend(numbers(&entry).repeat(columns));
        message.point(place, at);
    }
    let (compression, _) = message.table(&[(0, &[1])]);
    message.point(of_batch[3], compression);
    message.align();
    let before = [&[0xff; 4][..], &(message.0.len() as u32).to_le_bytes(), &message.0, &body].concat();
    let lengths = [8, 8 + message.0.len() as u64, body.len() as u64];
    arrow_file(&before, &vec![lengths; times], |flat, parent| {
        let list = flat.list(columns, &vec![0; 4 * columns]);
        flat.point(parent, list);
        for column in 0..columns {
            let name = format!("c{column}");
            let (field, places) = flat.table(&[(0, OFFSET), (2, &[3]), (3, OFFSET)]);
            flat.point(list + 4 + 4 * column, field);
            let text = flat.list(name.len(), name.as_bytes());
            flat.point(places[0], text);
            let (double, _) = flat.table(&[(0, &2u16.to_le_bytes())]);
            flat.point(places[2], double);
        }
    })
}

fn arrow() -> Result<(), Failed> {
    answered(&[
        ("honest.feather", zeros(1, 3, 1), true),
        ("batch.feather", zeros(1, 12, 2048), false),
        ("again.feather", zeros(10_000, 1, 8), false),
        ("nested.feather", nested(100, 8), false),
    ])
}

/// A log of ten messages `sensor_combined` with these formats. Format:
/// docs.px4.io/main/en/dev_log/ulog_file_format.
fn log(formats: &[&str]) -> Vec<u8> {
    let mut out = b"ULog\x01\x12\x35\x01".to_vec();
    out.extend([0; 8]);
    let mut message = |kind: u8, data: &[u8]| {
        out.extend((data.len() as u16).to_le_bytes());
        out.push(kind);
        out.extend_from_slice(data);
    };
    message(b'B', &[0; 40]);
    formats.iter().for_each(|format| message(b'F', format.as_bytes()));
    message(b'A', b"\0\0\0sensor_combined");
    for i in 0..2000u64 {
        let reading = i.wrapping_mul(6_364_136_223_846_793_005).to_le_bytes()[6];
        message(
            b'D',
            &[&[0, 0][..], &(i * 10_000).to_le_bytes(), &f32::from(reading).to_le_bytes().repeat(6)].concat(),
        );
    }
    out
}

fn ulog() -> Result<(), Failed> {
    const IMU: &str = "float[3] gyro_rad;float[3] accelerometer_m_s2;";
    let combined = |field: &str| format!("sensor_combined:uint64_t timestamp;{field}{IMU}");
    let inner: Vec<String> = (1..8).map(|i| format!("a{i}:a{}[60000] x;", i + 1)).collect();
    let outer = combined("a1[60000] x;");
    let nested: Vec<&str> =
        [outer.as_str()].into_iter().chain(inner.iter().map(String::as_str)).chain(["a8: "]).collect();
    answered(&[
        ("honest.ulg", log(&[&combined("")]), true),
        ("unknown.ulg", log(&[&combined("foo[18446744073709551615] x;")]), false),
        ("empty.ulg", log(&["b:", &combined("b[999999999999] x;")]), false),
        ("nested.ulg", log(&nested), false),
    ])
}
