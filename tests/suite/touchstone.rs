//! Touchstone files: one resonance in three forms of number gives what the same numbers give as a
//! table; rows that are left out are reported, and a malformed line is refused by its number.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::Complex;
use proofmass::control::Control;
use proofmass::diagnosis::model::{Seconds, read_part};
use proofmass::diagnosis::proposal::{Named, parsed, proposed};
use proofmass::diagnosis::{diagnose, verdict::Estimate, verdict::Outcome};
use proofmass::recording::inspection::inspect;
use proofmass::recording::{self, Recording, Request};
use proofmass::report::diagnosis::worded;
use proofmass::rng::{Philox, Stream};

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("touchstone: a resonance in three forms is that of the table of its numbers", three_forms),
        test("touchstone: versions, orders and units of frequency give the same numbers", versions),
        test("touchstone: noise parameters and a row that is cut short are left out and said", left_out),
        test("touchstone: what is malformed is refused with its line", malformed),
        test("touchstone: inspect names the format and the parameter that diagnose takes", inspected),
    ]
}

const F0_HZ: f64 = 1e5;
const WIDTH_HZ: f64 = 500.0;

/// Frequency and S21 of a resonance of 0.3 at its peak, in noise of a ten-thousandth.
pub(super) fn response() -> Vec<(f64, Complex<f64>)> {
    let mut rng = Philox::new(11, 0, Stream::Host);
    let of = |k: u32| {
        let frequency_hz = F0_HZ + WIDTH_HZ * (f64::from(k) / 20.0 - 4.0);
        let (omega, omega0, damping) = (TAU * frequency_hz, TAU * F0_HZ, TAU * WIDTH_HZ);
        let size = 0.3 * omega0 * damping;
        let ideal = size / Complex::new(omega0.powi(2) - omega.powi(2), omega * damping);
        (frequency_hz, ideal + 1e-4 * Complex::new(rng.normal(), rng.normal()))
    };
    (0..=160).map(of).collect()
}

/// f₀ and width of a file without a model, as its headings suit.
pub(super) fn diagnosed(path: &Path) -> Result<[Estimate; 2], Failed> {
    let seen = inspect(path, &Request::default())?;
    let model = parsed(&proposed("FILE", &seen, &Named::default())?)?;
    let control = Control::silent();
    let read = read_part(path, &model, Seconds::default(), &control)?;
    let verdict = worded(diagnose(&read, &model, &control)?).verdict;
    check(verdict.verdict == Outcome::Adequate, format!("{}: {}", path.display(), verdict.sentence))?;
    let of = |name: &str| verdict.base.iter().find(|e| e.name == name).cloned().ok_or("it is in the base model");
    Ok([of("f0")?, of("width")?])
}

// The truth is what was written: f₀ 100 kHz, width 500 Hz.
fn three_forms() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let response = response();
    let table = folder.path().join("sweep.csv");
    let rows: String = response.iter().map(|(f, s)| format!("{f},{},{}\n", s.re, s.im)).collect();
    std::fs::write(&table, format!("frequency_hz,x,y\n{rows}"))?;
    let wanted = diagnosed(&table)?;
    for (found, truth) in wanted.iter().zip([F0_HZ, WIDTH_HZ]) {
        let half = 0.5 * (found.ci95[1] - found.ci95[0]);
        check((found.value - truth).abs() < 3.0 / 1.96 * half, format!("{found:?}"))?;
    }
    let pair = |form: &str, s: Complex<f64>| match form {
        "RI" => [s.re, s.im],
        "MA" => [s.norm(), s.arg().to_degrees()],
        _ => [20.0 * s.norm().log10(), s.arg().to_degrees()],
    };
    for form in ["RI", "MA", "DB"] {
        let other = pair(form, Complex::new(0.9, 0.1));
        let mut text = format!("! a two-port\n# kHz S {form} R 50\n! f S11 S21 S12 S22\n");
        for (f, s) in &response {
            let cells = [other, pair(form, *s), other, other].map(|[a, b]| format!("{a} {b}"));
            writeln!(text, "{} {}", f / 1e3, cells.join(" "))?;
        }
        let path = folder.path().join(format!("{form}.s2p"));
        std::fs::write(&path, text)?;
        for (found, wanted) in diagnosed(&path)?.iter().zip(&wanted) {
            let inside = (wanted.ci95[0]..=wanted.ci95[1]).contains(&found.value);
            check(inside && (found.value / wanted.value - 1.0).abs() < 1e-6, format!("{form}: {found:?} {wanted:?}"))?;
        }
    }
    Ok(())
}

fn read(name: &str, text: &str) -> Result<Recording, Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join(name);
    std::fs::write(&path, text)?;
    Ok(recording::read(&path, &Request { rate_hz: Some(1.0), force_rate: true, ..Request::default() })?)
}

fn column(read: &Recording, name: &str) -> Result<Vec<f64>, Failed> {
    Ok(read.column(name).ok_or(format!("no column {name}"))?.to_vec())
}

// The numbers of a row are told by their place: 0.11 is S11, 0.21 is S21.
fn versions() -> Result<(), Failed> {
    let first = "0.11 0 0.21 0.5 0.12 0 0.22 0";
    let wrapped = "0.11 0 0.21 0.5\n  0.12 0 0.22 0 ! further";
    let second = |order: &str, row: &str| {
        format!(
            "! made by hand\n[version] 2.0\n# hz s ri r 50\n[Number of ports] 2\n[Two-Port Data Order] {order}\n\
             [NUMBER OF FREQUENCIES] 2\n[Reference]\n50 75\n[Begin Information]\n# x\n[Maker] me\n[End Information]\n\
             [Network Data]\n1e9 {row}\n2e9 {row}\n[End]\n"
        )
    };
    for (name, text) in [
        ("a.s2p", format!("# GHz S RI R 50\n1 {first}\n2 {first}\n")),
        ("b.s2p", format!("\u{feff}# ri\r\n1 {first}\r\n\r\n2 {first}\r\n# MHz S MA R 75\r\n")),
        ("c.S2P", format!("#MHZ S RI\n1000 {wrapped}\n2000 {wrapped}\n")),
        ("d", format!("! no name\n# KHZ S RI R 50.0\n1e6 {first}\n2e6 {first}\n")),
        ("e.ts", second("21_12", first)),
        ("f.ts", second("12_21", "0.11 0 0.12 0 0.21 0.5 0.22 0")),
    ] {
        let text = text.replace("# ri", "# GHz RI");
        let read = read(name, &text).map_err(|e| format!("{name}: {e:?}"))?;
        for (column_of, wanted) in [
            ("frequency_hz", [1e9, 2e9]),
            ("s21_re", [0.21; 2]),
            ("s21_im", [0.5; 2]),
            ("s12_re", [0.12; 2]),
            ("s22_re", [0.22; 2]),
        ] {
            let found = column(&read, column_of)?;
            check(found == wanted, format!("{name}, {column_of}: {found:?}"))?;
        }
    }
    // 20 log₁₀ of 10 is 20, at a right angle; GHz and MA where nothing is said.
    let read = read("one.s1p", "! one\n#\n1 10 90\n2 10 90\n3 1 0\n")?;
    let (f, im) = (column(&read, "frequency_hz")?, column(&read, "s11_im")?);
    check(f == [1e9, 2e9, 3e9] && (im[0] - 10.0).abs() < 1e-12, format!("{f:?} {im:?}"))
}

fn left_out() -> Result<(), Failed> {
    let row = "0.1 0 0.2 0 0.3 0 0.4 0";
    let text = format!("# GHz S RI R 50\n1 {row}\n2 {row}\n3 {row}\n1 0.5 0.6 64 0.3\n2 0.7 0.6 64 0.3\n");
    let noisy = read("a.s2p", &text)?;
    let dropped: usize = noisy.dropped.iter().map(|d| d.rows).sum();
    check((noisy.rows, noisy.samples(), dropped) == (5, 3, 2), format!("{:?}", noisy.dropped))?;
    let said = noisy.sentences().join("; ");
    check(said.contains("2 rows of noise parameters"), said)?;
    let cut = read("b.s2p", &format!("# GHz S RI R 50\n1 {row}\n2 {row}\n3 0.1 0 0.2"))?;
    let said = cut.sentences().join("; ");
    check((cut.rows, cut.samples()) == (3, 2) && said.contains("the last row (2) is cut short"), said)
}

fn malformed() -> Result<(), Failed> {
    let second = "[Version] 2.0\n# GHz S RI R 50\n[Number of Ports] 1\n[Number of Frequencies] 3\n[Network Data]\n1 0 0\n2 0 0\n";
    for (name, text, wanted) in [
        ("a.s1p", "# GHz S RI R 50\n1 0 0\n2 zero 0\n", "line 3: column 2: need a number, got `zero`"),
        ("b.s1p", "# GHz S RI R 50\n1 0 0\n2 0\n3 0 0\n", "line 4: need 3 numbers in a row of S parameters, got 5"),
        ("c.s1p", "! x\n# GHz S RI 50\n1 0 0\n", "line 2: need an option, got `50`"),
        ("d.s1p", "! x\n# GHz Z RI R 50\n1 0 0\n", "need S parameters, got Z"),
        ("e.s3p", "# GHz S RI R 50\n1 0 0 0 0 0 0\n", "3 numbers of one port or 9 of two"),
        ("f.ts", second, "need 3 rows, as [Number of Frequencies] states, got 2"),
        ("g.ts", "[Version] 2.0\n# GHz S\n[Number of Ports] 4\n", "line 3: need 1 or 2 ports, got `4`"),
        ("h.ts", "[Version] 2.0\n# GHz S\n[Mixed-Mode Order] D2\n", "[mixed-mode order] is not read"),
        ("i.s1p", "# GHz S RI R 50\n1,0,0\n2,0,0\n", "line 2: column 1: need a number, got `1,0,0`"),
        ("j.s1p", "! x\n# GHz S RI R 50\n! nothing\n", "line 3: need rows of numbers"),
    ] {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join(name), text)?;
        let request = Request { rate_hz: Some(1.0), force_rate: true, ..Request::default() };
        let refused = recording::read(&folder.path().join(name), &request).err().ok_or(format!("{name}: read"))?;
        check(refused.cause.contains(wanted) && !refused.hint.is_empty(), format!("{name}: {refused}"))?;
    }
    // As a control, comments of a table are none of the format's.
    let table = read("k.csv", "# t s\na,b\n1,2\n3,4\n")?;
    check(table.column("b").is_some(), "a table of text")
}

fn inspected() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let mut text = "! a resonator\n# Hz S RI R 50\n".to_owned();
    for (f, s) in response() {
        writeln!(text, "{f} 0.1 0 {} {} 0.1 0 0.1 0", s.re, s.im)?;
    }
    std::fs::write(folder.path().join("dut.s2p"), text)?;
    let output = program().current_dir(folder.path()).args(["inspect", "dut.s2p"]).output()?;
    let said = String::from_utf8(output.stdout)?;
    for words in ["Touchstone file", "161 rows", "proofmass diagnose dut.s2p", "s21_re", "response"] {
        check(said.contains(words), format!("{words} in {said}"))?;
    }
    let output = program().current_dir(folder.path()).args(["diagnose", "dut.s2p", "--out", "r"]).output()?;
    let first = String::from_utf8(output.stderr)?;
    check(output.status.success() && first.contains("# s21 of s11, s21, s12, s22"), first)
}
