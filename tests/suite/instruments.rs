//! Exports of lock-in amplifiers and analysers as text: one resonance under the headings of each
//! gives what the plain table gives, and thermomechanical noise is said where it is asked for.

use libtest_mimic::{Failed, Trial};
use nalgebra::Complex;

use super::touchstone::{diagnosed, response};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("instruments: one resonance under the headings of each is that of the plain table", headings),
        test("instruments: thermomechanical noise is said next to the residual", thermal),
    ]
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
    // The same numbers to the last digit, or turned from polar ones: nothing next to intervals of 1e-5 and more.
    for other in &others {
        for (found, wanted) in other.iter().zip(&plain) {
            check((found.value / wanted.value - 1.0).abs() < 1e-6, format!("{found:?} {wanted:?}"))?;
        }
    }
    // As a control, another unit in the heading is another resonance.
    let other = written("other.csv", "Freq (kHz), X (V), Y (V)", |_, f, s| format!("{f}, {}, {}", s.re, s.im))?;
    check((other[0].value / plain[0].value - 1e3).abs() < 1e-3, format!("{:?}", other[0]))
}

// By hand: k_B T is 4.0474e-21 J at 293.15 K; ω₀ is 2π·10⁵ rad/s and Γ 2π·500 1/s, so that 4 k_B T m Γ is
// 5.0861e-29 N²/Hz at 10⁻¹² kg.
fn thermal() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let rows: String = response().iter().map(|(f, s)| format!("{f},{},{}\n", s.re, s.im)).collect();
    std::fs::write(folder.path().join("sweep.csv"), format!("frequency_hz,x_V,y_V\n{rows}"))?;
    let model = |last: &str| {
        format!(
            "kind = \"response\"\n[columns]\nfrequency = \"frequency_hz\"\nx = \"x_V\"\ny = \"y_V\"\n[thermal]\nmass_kg = 1e-12\n\
             temperature_k = 293.15\nsi_per_unit = {last}\n"
        )
    };
    let run = |text: &str, json: bool| -> Result<_, Failed> {
        std::fs::write(folder.path().join("model.toml"), text)?;
        let mut command = program();
        command.current_dir(folder.path()).args(["diagnose", "sweep.csv", "--model", "model.toml"]);
        Ok(if json { command.arg("--json").output()? } else { command.output()? })
    };
    let output = run(&model("1e-9\nbandwidth_hz = 1.0"), true)?;
    let verdict: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let noise = &verdict["thermal"];
    let number = |name: &str| noise[name].as_f64().ok_or(format!("no {name} in {noise}"));
    let force = number("force_psd_n2_hz")?;
    // The width is fitted to 0.1 % (its 95 % interval).
    check((force / 5.0861e-29 - 1.0).abs() < 0.003, format!("{force}"))?;
    let (density, reading) = (number("displacement_psd_m2_hz")?, number("reading_rms")?);
    check((reading / (density.sqrt() / 1e-9) - 1.0).abs() < 1e-3, format!("{reading} {density}"))?;
    // The noise that was added is a ten-thousandth in X and in Y: 322 numbers know it to 4 %.
    let ratio = number("residual_ratio")?;
    check((ratio * reading / 1e-4 - 1.0).abs() < 0.2, format!("{ratio} {reading}"))?;
    let said = String::from_utf8(run(&model("1e-9"), false)?.stdout)?;
    check(said.contains("thermal noise") && said.contains("N/√Hz"), said)?;
    let refused = String::from_utf8(run(&model("0.0"), false)?.stderr)?;
    check(refused.contains("[thermal] needs si_per_unit above zero"), refused)
}
