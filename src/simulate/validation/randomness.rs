//! Random numbers by known answers and by their law.

use super::row::Row;
use crate::kernel::cpu::lanes::{LANES, Lane};
use crate::kernel::cpu::noise::Drawer;
use crate::rng::{Stream, philox4x32_10};

/// Checks of known answers, moments and correlation.
pub fn rows() -> Vec<Row> {
    let mut rows = known_answers();
    let normal = sample(Stream::AccelerometerWhite as u32);
    rows.extend(law("4 million normal numbers", &normal));
    // Control: the same law on numbers that are 1 % too large.
    let wrong: Vec<f64> = normal.iter().map(|g| g * 1.01).collect();
    rows.push(law("numbers 1 % too large", &wrong).swap_remove(1).control());
    let other = sample(Stream::GyroWhite as u32);
    let n = normal.len() as f64;
    let correlation: f64 = normal.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() / n;
    rows.push(Row::near("correlation of two streams (law: 0 ± 5/√n)", correlation, 0.0, 5.0 / n.sqrt()));
    rows
}

/// Random123 1.14, file kat_vectors, rows "philox4x32 10".
fn known_answers() -> Vec<Row> {
    let known = [
        ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
        ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
        (
            [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
            [0xa409_3822, 0x299f_31d0],
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
        ),
    ];
    let wrong = |(counter, key, answer): &([u32; 4], [u32; 2], [u32; 4])| philox4x32_10(*counter, *key) != *answer;
    let differing = known.iter().filter(|k| wrong(k)).count();
    vec![Row::at_most("Philox4x32-10: known answers of Random123 missed", differing as f64, 0.0)]
}

fn sample(stream: u32) -> Vec<f64> {
    let drawer = Drawer::new(7, 0);
    let mut four = [Lane::splat(0.0_f32); 4];
    let mut numbers = Vec::with_capacity(4 * LANES * 16_384);
    for counter in 0..16_384 {
        drawer.fill::<f32, false>(stream, counter, 4, &mut four);
        numbers.extend(four.iter().flat_map(|lane| lane.0.iter().map(|g| f64::from(*g))));
    }
    numbers
}

/// Moments and tails of a standard normal law, each within five of its own standard errors.
fn law(name: &str, numbers: &[f64]) -> Vec<Row> {
    let n = numbers.len() as f64;
    let moment = |power: i32| numbers.iter().map(|g| g.powi(power)).sum::<f64>() / n;
    let beyond = |limit: f64| numbers.iter().filter(|g| g.abs() > limit).count() as f64;
    // Two-sided tail of the normal law beyond 4.
    let expected = 6.334_248e-5 * n;
    vec![
        Row::near(format!("{name}: mean (law: 0 ± 5/√n)"), moment(1), 0.0, 5.0 / n.sqrt()),
        Row::near(format!("{name}: variance (law: 1 ± 5√(2/n))"), moment(2), 1.0, 5.0 * (2.0 / n).sqrt()),
        Row::near(format!("{name}: third moment (law: 0 ± 5√(15/n))"), moment(3), 0.0, 5.0 * (15.0 / n).sqrt()),
        Row::near(format!("{name}: fourth moment (law: 3 ± 5√(96/n))"), moment(4), 3.0, 5.0 * (96.0 / n).sqrt()),
        Row::near(format!("{name}: number beyond 4 sd (Poisson)"), beyond(4.0), expected, 5.0 * expected.sqrt()),
    ]
}
