//! Rows in = rows used + rows said to be dropped, for both readers, over thousands of damaged
//! files.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::recording::dropped::{Dropped, Reason};
use proofmass::recording::finding::{Finding, Uneven};
use proofmass::recording::{self, Request, stream};
use serde_json::Value;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "rows: none is lost without a word in four thousand damaged files, and the readers agree on the rate",
            damaged,
        ),
        test("rows: a stray quotation mark swallows nothing", stray_quotes),
        test("rows: both commands say how many rows there were and which were dropped", commands),
        test("rows: the count itself, as a control, tells a reader whose quotes span lines", control),
    ]
}

/// Numbers for mutations, the same in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

fn corpus() -> Vec<(String, Request)> {
    let noise = |n: usize| ((n * n * 7919 + n * 104_729) % 10_007) as f64 / 2890.0 - 1.73;
    let rated = |columns: &[&str]| Request {
        columns: columns.iter().map(|c| (*c).to_owned()).collect(),
        rate_hz: Some(100.0),
        ..Request::default()
    };
    let timed = |time: &str| Request { time: Some(time.into()), ..Request::default() };
    let lines = |row: &dyn Fn(usize) -> String| (0..300).map(row).collect::<String>();
    vec![
        (format!("a,note\n{}", lines(&|n| format!("{:.4},ok\n", noise(n)))), rated(&["a"])),
        (format!("a;b\r\n{}", lines(&|n| format!("{:.4};{:.3}\r\n", noise(n), noise(n + 7)))), rated(&[])),
        (lines(&|n| format!("{:.4}\t{}\n", noise(n), n % 17)), rated(&["1", "2"])),
        // Separators that end the lines.
        (format!("a,b,\n{}", lines(&|n| format!("{:.4},{:.3},\n", noise(n), noise(n + 7)))), rated(&[])),
        (format!("t_s,a,b\n{}", lines(&|n| format!("{:.2},{:.4},\"{n}\"\n", n as f64 * 0.01, noise(n)))), timed("t_s")),
        (
            format!(
                "#timestamp [ns],w [rad s^-1]\n{}",
                lines(&|n| format!("{},{:.5}\n", 1_700_000_000_000_000_000 + n as i64 * 5_000_000, noise(n)))
            ),
            timed("timestamp [ns]"),
        ),
        (
            format!(
                "# by a logger\nt_ms,a\n{}",
                lines(&|n| format!("{},{:.4}\n", (n as f64 / 1.024).floor(), noise(n)))
            ),
            timed("t_ms"),
        ),
    ]
}

/// One to three damages.
fn damage(text: &str, dice: &mut Dice) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=dice.below(3) {
        let at = dice.below(bytes.len());
        let starts: Vec<usize> = std::iter::once(0).chain((1..bytes.len()).filter(|i| bytes[i - 1] == b'\n')).collect();
        let line = dice.below(starts.len());
        let from = starts[line];
        let to = starts.get(line + 1).copied().unwrap_or(bytes.len());
        match dice.below(12) {
            0 | 1 => bytes.insert(at, b'"'),
            2 => {
                let strange = b"\"\n\r,;#.-e9\t x\0\xff";
                bytes[at] = strange[dice.below(strange.len())];
            }
            3 => {
                bytes.remove(at);
            }
            4 => bytes.truncate(at.max(1)),
            5 => {
                bytes.drain(from..to);
            }
            6 => {
                let copy = bytes[from..to].to_vec();
                bytes.splice(to..to, copy);
            }
            7 => {
                bytes.splice(from..from, *b"\n");
            }
            8 => {
                bytes.splice(from..from, *b"# a remark, \"\n");
            }
            9 => {
                bytes.splice(from..from, *b"nan,,\n");
            }
            10 => {
                let cut = starts[dice.below(starts.len())];
                bytes.splice(cut..cut, *b"#");
            }
            _ => {
                let word: &[&[u8]] = &[b"1e300", b"9007199254740993", b"-", b"\"\"", b"1,5", b"inf", b"x"];
                let word = word[dice.below(word.len())];
                bytes.splice(at..at, word.iter().copied());
            }
        }
        if bytes.is_empty() {
            bytes.push(b'a');
        }
    }
    bytes
}

/// Lines that are rows: neither blank nor comments. Told without the program's own reader.
fn row_lines(bytes: &[u8]) -> usize {
    let text: Vec<u8> = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).to_vec();
    text.split(|b| matches!(b, b'\n' | b'\r')).filter(|l| !l.trim_ascii().is_empty() && l[0] != b'#').count()
}

/// The rule, for a reader that found so many rows in a file with so many row lines, its header
/// included if it has one, and the lines before it that are said to be left out.
fn rule(rows: usize, lines: usize, dropped: &[Dropped], findings: &[Finding], samples: usize) -> Result<(), String> {
    let above = |f: &Finding| if let Finding::Preamble { lines, .. } = f { *lines as usize } else { 0 };
    let lines = lines - findings.iter().map(above).sum::<usize>();
    if rows != lines && rows + 1 != lines {
        return Err(format!("{rows} rows of {lines} lines"));
    }
    let headless = findings.contains(&Finding::NoHeader);
    if headless && rows != lines {
        return Err(format!("no header, {rows} rows of {lines} lines"));
    }
    let lost: usize = dropped.iter().map(|d| d.rows).sum();
    let of = |reason: Reason| dropped.iter().filter(|d| d.reason == reason).map(|d| d.rows).sum::<usize>();
    let filled: usize =
        findings.iter().map(|f| if let Finding::GapsFilled { samples, .. } = f { *samples } else { 0 }).sum();
    // Where a clock is uneven, samples lie between rows.
    let resampled = findings.iter().any(|f| matches!(f, Finding::UnevenClock { treatment: Uneven::Resampled, .. }));
    let expected = rows - lost + filled + of(Reason::HoldsPlace);
    if samples != expected && !resampled {
        return Err(format!("{samples} samples, {rows} rows, dropped {dropped:?}, {findings:?}"));
    }
    let said = dropped.iter().all(|d| d.first_row < rows && d.rows > 0);
    if said { Ok(()) } else { Err(format!("dropped {dropped:?} of {rows}")) }
}

fn damaged() -> Result<(), Failed> {
    let file = tempfile::NamedTempFile::new()?;
    let mut dice = Dice(12);
    let (mut read, mut both) = (0, 0);
    for (text, request) in corpus() {
        for n in 0..700 {
            let bytes = if n == 0 { text.clone().into_bytes() } else { damage(&text, &mut dice) };
            std::fs::write(file.path(), &bytes)?;
            let lines = row_lines(&bytes);
            let fail = |what: &str, why: String| format!("{what}: {why}\n{}", String::from_utf8_lossy(&bytes));
            let mut given = 0;
            let streamed = stream::read(file.path(), &request, |b| given += b.columns.first().map_or(0, Vec::len));
            let held = recording::read(file.path(), &request);
            if let Ok(s) = &streamed {
                read += 1;
                check(given == s.samples, fail("stream", format!("{given} samples handed on, {} said", s.samples)))?;
                rule(s.rows, lines, &s.dropped, &s.findings, s.samples).map_err(|e| fail("stream", e))?;
            }
            if let Ok(h) = &held {
                rule(h.rows, lines, &h.dropped, &h.findings, h.samples()).map_err(|e| fail("memory", e))?;
                check(
                    h.columns.iter().all(|c| c.values.len() == h.samples()),
                    fail("memory", "ragged columns".into()),
                )?;
            }
            if let (Ok(s), Ok(h)) = (&streamed, &held) {
                both += 1;
                check(
                    (s.rate_hz / h.rate_hz - 1.0).abs() < 1e-3,
                    fail("rates", format!("{} {}", s.rate_hz, h.rate_hz)),
                )?;
            }
        }
    }
    // The rule is worth something only where files are read in spite of their damage.
    check(read > 1500 && both > 1000, format!("only {read} and {both} of 4200 files were read"))
}

fn stray_quotes() -> Result<(), Failed> {
    let noise = |n: usize| (n * 7919 % 101) as f64;
    for marks in [vec![5000], vec![5000, 8000], vec![3], vec![9999]] {
        let note = |n: usize| if marks.contains(&n) { "\"bumped" } else { "" };
        let lines: String = (0..10_000).map(|n| format!("{},{}\n", noise(n), note(n))).collect();
        let file = tempfile::NamedTempFile::new()?;
        std::fs::write(file.path(), format!("a,note\n{lines}"))?;
        let request = Request { columns: vec!["a".into()], rate_hz: Some(100.0), ..Request::default() };
        let held = recording::read(file.path(), &request)?;
        let whole: Vec<f64> = (0..10_000).map(noise).collect();
        check(held.columns[0].values == whole, format!("{marks:?}: {} samples", held.samples()))?;
        check(stream::read(file.path(), &request, |_| {})?.samples == 10_000, format!("{marks:?}: the stream"))?;
    }
    Ok(())
}

fn json(arguments: &[&str], file: &Path) -> Result<Value, Failed> {
    let output = program().args(&arguments[..1]).arg(file).args(&arguments[1..]).arg("--json").output()?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn commands() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let (log, model) = (folder.path().join("log.csv"), folder.path().join("model.toml"));
    let noise = |n: usize| ((n * n * 7919 + n * 104_729) % 10_007) as f64 / 2890.0 - 1.73;
    // Row 700 once more, and the last row cut short.
    let lines: String = (0..2000)
        .flat_map(|n| vec![n; if n == 700 { 2 } else { 1 }])
        .map(|n| format!("{:.2},{:.4}\n", n as f64 * 0.01, noise(n)))
        .collect();
    std::fs::write(&log, format!("t_s,a\n{lines}20.00"))?;
    std::fs::write(&model, "kind = \"static\"\nrows = [[100, 1500]]\n[columns]\ntime = \"t_s\"\nchannels = [\"a\"]\n")?;
    let allan = json(&["allan", "--time", "t_s", "--from-s", "1", "--to-s", "14.99"], &log)?;
    let diagnose = json(&["diagnose", "--model", &model.to_string_lossy()], &log)?;
    let expected = serde_json::json!([["written twice", 1, 701]]);
    for (what, document) in [("allan", allan), ("diagnose", diagnose)] {
        let source = &document["recording"];
        check(source["rows"] == 2002 && source["samples"] == 1399, format!("{what}: {source}"))?;
        let list = source["dropped"].as_array().cloned().unwrap_or_default();
        let lost: u64 = list.iter().filter_map(|d| d["rows"].as_u64()).sum();
        check(lost == 2002 - 1399, format!("{what}: {source}"))?;
        let twice = list.iter().find(|d| d["reason"] == expected[0][0]).cloned().unwrap_or_default();
        check(twice["rows"] == expected[0][1] && twice["first_row"] == expected[0][2], format!("{what}: {source}"))?;
        check(
            document["findings"].to_string().contains("rows 100 to 1500"),
            format!("{what}: {}", document["findings"]),
        )?;
    }
    // Several ranges, an empty one, and a split that does not lie in the part.
    for (edit, words) in [
        ("rows = [[0, 500], [900, 1500]]\n", "2 ranges"),
        ("rows = [[500, 500]]\n", "holds no row"),
        ("rows = [[500, 9000]]\n", "2002 data rows"),
    ] {
        let text = format!("kind = \"static\"\nrate_hz = 100.0\n{edit}[columns]\nchannels = [\"a\"]\n");
        refuses(&log, &model, &text, words)?;
    }
    for (split, words) in [
        ("train = [[5, 1]]\n", "[5, 1) does not lie in the 2001 samples"),
        ("train = [[9000, 9500]]\n", "[9000, 9500) does not lie in the 2001 samples"),
        ("train = [[0, 900]]\ntest = [[0, 900]]\n", "overlap in 900 samples"),
    ] {
        let text = format!("kind = \"static\"\nrate_hz = 100.0\n[columns]\nchannels = [\"a\"]\n[split]\n{split}");
        refuses(&log, &model, &text, words)?;
    }
    Ok(())
}

fn refuses(log: &Path, model: &Path, text: &str, words: &str) -> Result<(), Failed> {
    std::fs::write(model, text)?;
    let output = program().arg("diagnose").arg(log).arg("--model").arg(model).output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(2) && said.contains(words), format!("{text}: {said}"))
}

/// A reader that lets a quotation mark reach over lines joins rows; the rule must tell.
fn control() -> Result<(), Failed> {
    let text = b"a,note\n1,\n2,\"bumped\n3,\n4,\"hit\n5,\n";
    let joined = 3;
    check(rule(joined, row_lines(text), &[], &[], joined).is_err(), "three rows of six lines pass for all of them")?;
    check(rule(5, row_lines(text), &[], &[], 4).is_err(), "a sample that is lost without a word passes")?;
    check(rule(5, row_lines(text), &[], &[], 5).is_ok(), "five rows of six lines, one the header")
}
