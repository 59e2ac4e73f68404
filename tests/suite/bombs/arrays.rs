//! Archives, variables and lines that stand for more than they hold.

use libtest_mimic::{Failed, Trial};

use super::answered;
use crate::suite::world::test;

/// Tests of this module.
pub(super) fn tests() -> Vec<Trial> {
    vec![
        test("bombs: NumPy archives whose entries are one another's bytes", numpy),
        test("bombs: MATLAB files of any number of variables", matlab),
        test("bombs: lines of millions of columns", text),
    ]
}

/// An array as numpy.save writes it: numpy.lib.format, version 1.
fn array(dtype: &str, rows: usize, columns: usize, numbers: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}\n");
    [b"\x93NUMPY\x01\0", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), numbers].concat()
}

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum: u32, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

/// A zip archive of one stored file, which its list names so many times (PKWARE's APPNOTE 6.3).
fn archive(name: &str, content: &[u8], times: u16) -> Vec<u8> {
    let size = (content.len() as u32).to_le_bytes();
    let described = [
        &[0; 4],
        &[0; 4][..],
        &crc32(content).to_le_bytes(),
        &size,
        &size,
        &(name.len() as u16).to_le_bytes(),
        &[0; 2],
    ]
    .concat();
    let mut out = [b"PK\x03\x04\x14\0", &described[..], name.as_bytes(), content].concat();
    let list_at = (out.len() as u32).to_le_bytes();
    let entry = [b"PK\x01\x02\x14\0\x14\0", &described[..], &[0; 14], name.as_bytes()].concat();
    let list = entry.repeat(usize::from(times));
    out.extend(&list);
    let times = times.to_le_bytes();
    out.extend([b"PK\x05\x06\0\0\0\0", &times[..], &times, &(list.len() as u32).to_le_bytes(), &list_at].concat());
    out.extend([0; 2]);
    out
}

fn numpy() -> Result<(), Failed> {
    let readings: Vec<u8> =
        (0..3000u64).flat_map(|i| (i.wrapping_mul(6_364_136_223_846_793_005) as f64).to_le_bytes()).collect();
    answered(&[
        ("honest.npz", archive("a.npy", &array("<f8", 1000, 3, &readings), 1), true),
        ("columns.npz", archive("a.npy", &array("|i1", 160, 10_000, &vec![0; 1_600_000]), 16_000), false),
        ("again.npz", archive("a.npy", &vec![1; 4_000_000], 16_000), false),
    ])
}

/// A MATLAB file of so many variables of two columns: MathWorks, *MAT-File Format*.
fn variables(count: usize, rows: u32) -> Vec<u8> {
    let mut out = b"MATLAB 5.0 MAT-file".to_vec();
    out.resize(124, b' ');
    out.extend(b"\0\x01IM");
    let element = |kind: u32, data: &[u8]| {
        let mut out = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        out.extend(data);
        out.resize(out.len().next_multiple_of(8), 0);
        out
    };
    let numbers: Vec<u8> = (0..2 * rows).flat_map(|i| f64::from(i.wrapping_mul(2_654_435_761)).to_le_bytes()).collect();
    for variable in 0..count {
        let dimensions = [rows.to_le_bytes(), 2u32.to_le_bytes()].concat();
        let name = format!("v{variable}");
        let inner = [
            element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
            element(5, &dimensions),
            element(1, name.as_bytes()),
            element(9, &numbers),
        ];
        out.extend(element(14, &inner.concat()));
    }
    out
}

fn matlab() -> Result<(), Failed> {
    answered(&[("honest.mat", variables(1, 1000), true), ("many.mat", variables(200_000, 1), false)])
}

fn text() -> Result<(), Failed> {
    let table = |columns: usize| {
        let row = |cell: &str| [cell].repeat(columns).join(",") + "\n";
        [row("a"), row("1.5").repeat(3)].concat().into_bytes()
    };
    let wide = [&vec![b','; 60 << 20][..], b"\n1\n"].concat();
    let noisy: String = (0..1000u64).map(|i| format!("{}\n", i.wrapping_mul(6_364_136_223_846_793_005))).collect();
    answered(&[
        ("honest.csv", format!("a\n{noisy}").into_bytes(), true),
        ("wide.csv", wide, false),
        ("million.csv", table(1_000_000), false),
    ])
}
