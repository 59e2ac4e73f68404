//! Exports of lock-in amplifiers and analysers as text: one resonance under the headings of each
//! gives what the plain table gives.

use libtest_mimic::{Failed, Trial};
use nalgebra::Complex;

use super::touchstone::{diagnosed, response};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("instruments: one resonance under the headings of each is that of the plain table", headings)]
}

/// A row of a step: its number, frequency and reading.
type Row = fn(usize, f64, Complex<f64>) -> String;

// Zurich Instruments LabOne, Stanford Research SR860, Omicron Bode 100, Keysight InfiniiVision.
fn headings() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let written = |name: &str, heading: &str, row: Row| -> Result<_, Failed> {
        let path = folder.path().join(name);
        let rows: String = response().iter().enumerate().map(|(k, (f, s))| row(k, *f, *s) + "\n").collect();
        std::fs::write(&path, format!("{heading}\n{rows}"))?;
        Ok(diagnosed(&path).map_err(|e| format!("{name}: {e:?}"))?)
    };
    let plain = written("plain.csv", "frequency_hz,x,y", |_, f, s| format!("{f},{},{}", s.re, s.im))?;
    let others = [
        written("labone.csv", "chunk;timestamp;frequency;x;y;r;phase", |k, f, s| {
            format!("0;{};{f};{};{};{};{}", 7_000_000 + 60_000 * k, s.re, s.im, s.norm(), s.arg())
        })?,
        written("polar.csv", "chunk;timestamp;frequency;r;phase [rad]", |k, f, s| {
            format!("0;{};{f};{};{}", 7_000_000 + 60_000 * k, s.norm(), s.arg())
        })?,
        written("sr860.csv", "Freq (Hz), X (V), Y (V), R (V), Theta (deg)", |_, f, s| {
            format!("{f}, {}, {}, {}, {}", s.re, s.im, s.norm(), s.arg().to_degrees())
        })?,
        written("bode100.csv", "Frequency (Hz);Gain: Magnitude (dB);Gain: Phase (°)", |_, f, s| {
            format!("{f};{};{}", 20.0 * s.norm().log10(), s.arg().to_degrees())
        })?,
        written("scope.csv", "#,Frequency (kHz),Amplitude (Vpp),Gain (dB),Phase (°)", |k, f, s| {
            format!("{k},{},0.2,{},{}", f / 1e3, 20.0 * s.norm().log10(), s.arg().to_degrees())
        })?,
    ];
    for other in &others {
        for (found, wanted) in other.iter().zip(&plain) {
            check((found.value / wanted.value - 1.0).abs() < 1e-6, format!("{found:?} {wanted:?}"))?;
        }
    }
    // As a control, another unit in the heading is another resonance.
    let other = written("other.csv", "Freq (kHz), X (V), Y (V)", |_, f, s| format!("{f}, {}, {}", s.re, s.im))?;
    check((other[0].value / plain[0].value - 1e3).abs() < 1e-3, format!("{:?}", other[0]))
}
