//! One clock for all readers: `allan` (streaming) and `diagnose` (in memory) name the same rate of
//! any file, or refuse it.

use libtest_mimic::{Failed, Trial};
use proofmass::error::Error;
use proofmass::recording::finding::Finding;
use proofmass::recording::{self, Request, stream};

use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("clock: units, rounding, jitter, gaps and overflows are recognised, and both readers agree", recognised),
        test("clock: a rate that changes, a clock that stops or runs back is refused with its row", refused),
        test("clock: a stretch of a log is cut out by rows or by seconds, and what is cut is said", stretches),
        test(
            "clock: the rate of the first thousand rows, as a control, is wrong where the whole file's is right",
            control,
        ),
        test(
            "clock: a rate that contradicts the file's own clock is refused with both, or forced and reported",
            forced,
        ),
        test("clock: rows stamped in groups have two rates, and both are said", grouped),
        data_test("clock: real logs in ns, in s from anywhere and with jitter have the rate known of them", real),
    ]
}

/// A log: heading of the time column and stamps as printed.
struct Log {
    heading: &'static str,
    stamps: Vec<String>,
}

/// What a reader makes of it: rate, samples and findings.
type Read = Result<(f64, usize, Vec<Finding>), Error>;

/// Noise without order, of unit size or so.
fn noise(n: usize) -> f64 {
    ((n * n * 7919 + n * 104_729) % 10_007) as f64 / 2890.0 - 1.73
}

impl Log {
    fn new(heading: &'static str, rows: usize, stamp: impl Fn(usize) -> String) -> Self {
        Self { heading, stamps: (0..rows).map(stamp).collect() }
    }

    fn request(&self) -> Request {
        Request { columns: vec!["x".into()], time: Some(self.heading.into()), ..Request::default() }
    }

    /// Rates and findings by both readers.
    fn read(&self, request: &Request) -> Result<[Read; 2], Failed> {
        let file = tempfile::NamedTempFile::new()?;
        let rows: String = self.stamps.iter().enumerate().map(|(n, t)| format!("{t},{:.6}\n", noise(n))).collect();
        std::fs::write(file.path(), format!("{},x\n{rows}", self.heading))?;
        let streamed = stream::read(file.path(), request, |_| {}).map(|s| (s.rate_hz, s.samples, s.findings));
        let held = recording::read(file.path(), request).map(|r| (r.rate_hz, r.samples(), r.findings));
        Ok([streamed, held])
    }

    /// Fails unless both readers find this rate within a tolerance, relative, and this many
    /// samples.
    fn has(&self, what: &str, rate_hz: f64, tolerance: f64, samples: usize) -> Result<Vec<Finding>, Failed> {
        let [streamed, held] = self.read(&self.request())?;
        let mut said = Vec::new();
        for (reader, read) in [("allan", streamed), ("diagnose", held)] {
            let (found, count, findings) = read.map_err(|e| format!("{what}, {reader}: {e}"))?;
            check((found / rate_hz - 1.0).abs() <= tolerance, format!("{what}, {reader}: {found} Hz, {findings:?}"))?;
            check(count == samples, format!("{what}, {reader}: {count} samples of {samples}, {findings:?}"))?;
            said = findings;
        }
        Ok(said)
    }

    fn refused(&self, what: &str, words: &str) -> Result<(), Failed> {
        for read in self.read(&self.request())? {
            match read {
                Ok((rate, ..)) => return Err(format!("{what}: accepted at {rate} Hz").into()),
                Err(e) => check(e.cause.contains(words) && !e.hint.is_empty(), format!("{what}: {e}"))?,
            }
        }
        Ok(())
    }
}

fn recognised() -> Result<(), Failed> {
    let rows = 5000;
    // 200 Hz from 1970 and from the start, in every unit, with and without it in the heading.
    let headings = [["t", "t_s"], ["t", "t_ms"], ["timestamp", "timestamp [us]"], ["%time", "t_ns"]];
    for (headings, (scale, digits)) in headings.into_iter().zip([(1, 3), (1000, 0), (1_000_000, 0), (1_000_000_000, 0)])
    {
        for (guessed, heading) in [(true, headings[0]), (false, headings[1])] {
            for start in [0i64, 1_700_000_000] {
                let log = Log::new(heading, rows, |n| match digits {
                    0 => format!("{}", start * scale + n as i64 * 5 * scale / 1000),
                    _ => format!("{:.3}", start as f64 + n as f64 * 0.005),
                });
                let said = log.has(&format!("{heading} from {start}"), 200.0, 1e-6, rows)?;
                let unit = said.iter().any(|f| matches!(f, Finding::TimeUnit { .. }));
                check(unit == (guessed && scale > 1), format!("{heading} from {start}: {said:?}"))?;
            }
        }
    }
    // Hundredths in decimal are no sums of a power of two: the rate is still the number that they mean.
    Log::new("t", 60_000, |n| format!("{:.2}", n as f64 / 100.0)).has("hundredths", 100.0, 0.0, 60_000)?;
    // Stamps rounded to whole ms, faster and slower than one per ms; every row is a sample. The
    // edge of a rounded stamp is worth one part in a span of five seconds.
    for rate in [1024.0, 1600.0, 990.0, 600.0, 333.0] {
        let log = Log::new("t_ms", rows, |n| format!("{}", (n as f64 * 1000.0 / rate).floor()));
        let said = log.has(&format!("{rate} Hz in whole ms"), rate, 2e-4, rows)?;
        let coarse = said.iter().any(|f| matches!(f, Finding::CoarseStamps { .. }));
        check(coarse, format!("{rate} Hz in whole ms: {said:?}"))?;
    }
    Log::new("t_s", rows, |n| format!("{}", n / 100)).has("100 Hz in whole s", 100.0, 1e-3, rows)?;
    // Read from a queue eight at a time, with one stamp for all.
    Log::new("t_us", rows, |n| format!("{}", n / 8 * 8 * 2500)).has("bursts of eight", 400.0, 3e-3, rows)?;
    // A counter of 32 bits in µs that overflows once.
    let wrapped = Log::new("t_us", rows, |n| format!("{}", (4_290_000_000u32).wrapping_add(5000 * n as u32)));
    let said = wrapped.has("32 bits of µs", 200.0, 1e-6, rows)?;
    check(said.iter().any(|f| matches!(f, Finding::ClockWrapped { first_row: 994, .. })), format!("{said:?}"))?;
    // Jitter of a tenth of a tick either way; an oscillator that is off by 50 ppm and drifts by 20
    // more.
    Log::new("t", rows, |n| format!("{:.6}", n as f64 * 0.01 + 0.001 * noise(n) / 1.73))
        .has("jitter", 100.0, 1e-3, rows)?;
    let drifting = |n: usize| n as f64 * 0.01 * (1.0 + 5e-5 + 2e-5 * n as f64 / rows as f64);
    let said = Log::new("t", rows, |n| format!("{:.7}", drifting(n))).has("a quartz", 99.994, 1e-4, rows)?;
    check(said.is_empty(), format!("a quartz needs no word: {said:?}"))?;
    // Lost rows: the rate is that of the clock, not of the rows.
    let kept: Vec<usize> = (0..rows).filter(|n| n % 131 != 7).collect();
    Log::new("t", kept.len(), |i| format!("{:.6}", kept[i] as f64 * 0.01 + 1e-5 * noise(i))).has(
        "lost rows",
        100.0,
        1e-4,
        rows,
    )?;
    // A drift of 1 % is said.
    let said = Log::new("t", rows, |n| format!("{:.6}", (n as f64 + 1e-6 * (n * n) as f64) * 0.01)).has(
        "a drift of 1 %",
        100.0 / 1.005,
        1e-3,
        rows,
    )?;
    check(said.iter().any(|f| matches!(f, Finding::RateVaries { .. })), format!("{said:?}"))
}

/// Time of row n where the rate changes from 100 Hz to another at a row.
fn stepped(n: usize, at: usize, rate_hz: f64) -> f64 {
    n.min(at) as f64 * 0.01 + n.saturating_sub(at) as f64 / rate_hz
}

fn refused() -> Result<(), Failed> {
    let rows = 20_000;
    for (at, rate) in [(1000, 200.0), (1000, 105.0), (10_000, 98.0), (19_000, 1000.0)] {
        let log = Log::new("t", rows, |n| format!("{:.6}", stepped(n, at, rate)));
        log.refused(&format!("100 Hz, then {rate} Hz"), "the sampling rate changes from ")?;
        let [streamed, _] = log.read(&log.request())?;
        let cause = streamed.err().map(|e| e.cause).unwrap_or_default();
        let row: usize =
            cause.split("near data row ").nth(1).and_then(|s| s.split(',').next()?.parse().ok()).unwrap_or(0);
        check(row.abs_diff(at) <= 64, format!("a step in row {at} is said to be in {row}: {cause}"))?;
    }
    // ±23 % from begin to end.
    Log::new("t", rows, |n| format!("{:.6}", (0.77 * n as f64 + 0.23 * (n * n) as f64 / rows as f64) * 0.01))
        .refused("a drift of ±23 %", "the sampling rate changes")?;
    Log::new("t", rows, |n| format!("{:.2}", n.min(1000) as f64 * 0.01))
        .refused("a clock that stops", "stands still for 19000 of 20000 rows from data row 1000")?;
    Log::new("t", rows, |n| format!("{:.2}", if n < 7000 { n } else { n - 5000 } as f64 * 0.01))
        .refused("a clock that is set back", "data row 7000")?;
    Log::new("t", 1000, |_| "5".into()).refused("one stamp for all", "repeat")?;
    Log::new("t", 1000, |n| format!("{}", n * 500)).refused("2 Hz or 2 kHz", "2000 Hz in µs or 2 Hz in ms")?;
    Log::new("t", 1000, |n| if n % 10 == 0 { String::new() } else { (n as f64 * 0.01).to_string() })
        .refused("a tenth of the stamps missing", "100 are missing")
}

fn stretches() -> Result<(), Failed> {
    let log = Log::new("t", 4000, |n| format!("{:.2}", 100.0 + stepped(n, 2000, 50.0)));
    let base = log.request();
    for (request, rate, rows) in [
        (Request { to_s: Some(20.0), ..base.clone() }, 100.0, [0, 2000]),
        (Request { from_s: Some(20.0), ..base.clone() }, 50.0, [2000, 4000]),
        (Request { from_s: Some(5.0), to_s: Some(15.0), ..base.clone() }, 100.0, [500, 1500]),
        (Request { rows: Some(2000..3000), ..base.clone() }, 50.0, [2000, 3000]),
        (Request { rows: Some(1000..2000), from_s: Some(5.0), ..base.clone() }, 100.0, [1500, 2000]),
    ] {
        for read in log.read(&request)? {
            let (found, samples, findings) = read?;
            check((found / rate - 1.0).abs() < 1e-6, format!("{request:?}: {found} Hz"))?;
            check(samples == rows[1] - rows[0], format!("{request:?}: {samples} samples"))?;
            let cut = Finding::Cut { from_row: rows[0], to_row: rows[1], of: 4000 };
            check(findings.contains(&cut), format!("{request:?}: {findings:?}"))?;
        }
    }
    // Without a clock, seconds are rows over the rate.
    let request = Request { time: None, rate_hz: Some(10.0), from_s: Some(100.0), to_s: Some(110.0), ..base.clone() };
    for read in log.read(&request)? {
        check(read?.1 == 100, "ten seconds at 10 Hz")?;
    }
    for wrong in [
        Request { from_s: Some(1e6), ..base.clone() },
        Request { from_s: Some(5.0), to_s: Some(5.0), ..base.clone() },
        Request { from_s: Some(-1.0), ..base.clone() },
        Request { to_s: Some(f64::NAN), ..base.clone() },
        Request { rows: Some(3000..5000), ..base.clone() },
        Request { rows: Some(10..10), ..base },
    ] {
        check(log.read(&wrong)?.iter().all(Result::is_err), format!("accepted: {wrong:?}"))?;
    }
    Ok(())
}

/// The former way: what it says of a file whose rate changes in row 1000 is what the test above
/// must not accept.
fn control() -> Result<(), Failed> {
    let first_thousand = 999.0 / stepped(999, 1000, 200.0);
    let whole = 19_999.0 / stepped(19_999, 1000, 200.0);
    check((first_thousand / whole - 1.0).abs() > 0.4, format!("{first_thousand} Hz, {whole} Hz"))
}

fn real(folder: &std::path::Path) -> Result<(), Failed> {
    // Rates as the data's own description states them: EuRoC 200 Hz in ns from 1970, silverbox
    // 10⁷/2¹⁴ Hz, EMPS 1 kHz, Xsens 100 Hz, Sense HAT a row every 10 s, Xsens DOT 120 Hz.
    for (file, time, rate, guessed) in [
        ("euroc_v102/imu0.csv", "timestamp", 200.0, false),
        ("formats/euroc.csv", "#timestamp [ns]", 200.0, false),
        ("formats/plain.csv", "t_ns", 200.0, false),
        ("silverbox/SNLS80mV.csv", "t_s", 610.351_562_5, false),
        ("emps/train.csv", "t_s", 1000.0, false),
        ("xsens_mti/raw_counts.csv", "t_s", 100.0, false),
        ("fleet/unit_1.csv", "t_s", 120.0, false),
    ] {
        let path = folder.join(file);
        let request = Request { time: Some(time.into()), ..Request::default() };
        let streamed = stream::read(&path, &request, |_| {})?;
        let held = recording::read(&path, &request)?;
        for (reader, found, findings) in
            [("allan", streamed.rate_hz, &streamed.findings), ("diagnose", held.rate_hz, &held.findings)]
        {
            check((found / rate - 1.0).abs() < 2e-3, format!("{file}, {reader}: {found} Hz, {findings:?}"))?;
            let said = findings.iter().any(|f| matches!(f, Finding::TimeUnit { .. }));
            check(said == guessed, format!("{file}, {reader}: {findings:?}"))?;
        }
        check((streamed.rate_hz / held.rate_hz - 1.0).abs() < 1e-3, format!("{file}: the readers disagree"))?;
        check(!held.column("2").is_some_and(|_| true), format!("{file}: its header was not found"))?;
    }
    Ok(())
}

/// 100 Hz, stamped on arrival: fifty rows a millisecond apart, every half second.
fn grouped() -> Result<(), Failed> {
    let stamp = |n: usize| format!("{:.3}", (n / 50) as f64 * 0.5 + (n % 50) as f64 * 1e-3);
    let log = Log::new("t_s", 2000, stamp);
    let rates = |read: &Read| -> Option<f64> {
        let said = read.as_ref().ok()?.2.iter().find_map(|f| match f {
            Finding::InGroups { groups: 40, mean_hz, .. } => Some(*mean_hz),
            _ => None,
        });
        said.filter(|_| read.as_ref().is_ok_and(|(rate_hz, ..)| (rate_hz / 1000.0 - 1.0).abs() < 1e-6))
    };
    let [streamed, _] = log.read(&log.request())?;
    // 1999 rows after the first in 19.549 s.
    check(rates(&streamed).is_some_and(|hz| (hz - 102.3).abs() < 0.1), format!("{streamed:?}"))?;
    // Control: a pause of as much time between two groups alone is a gap.
    let once = Log::new("t_s", 2000, |n| format!("{:.3}", n as f64 * 1e-3 + if n < 900 { 0.0 } else { 20.0 }));
    let [streamed, _] = once.read(&once.request())?;
    check(rates(&streamed).is_none() && streamed.is_ok(), format!("{streamed:?}"))
}

/// A log at 200 Hz whose clock is found by its heading or named.
fn forced() -> Result<(), Failed> {
    let file = tempfile::NamedTempFile::with_suffix(".csv")?;
    let write = |heading: &str, step_s: f64| {
        let rows: String = (0..4000).map(|n| format!("{:.4},{:.6}\n", n as f64 * step_s, noise(n))).collect();
        std::fs::write(file.path(), format!("{heading},x\n{rows}"))
    };
    write("t_s", 0.005)?;
    let path = file.path().to_string_lossy().into_owned();
    let allan = |more: &[&str]| program().args([&["allan", &path, "--columns", "x"], more].concat()).output();
    for time in [&[][..], &["--time", "t_s"]] {
        let output = allan(&[&["--rate-hz", "100"], time].concat())?;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(2) && said.contains("200") && said.contains("100"), &said)?;
        let output = allan(&[&["--rate-hz", "100", "--force-rate", "--json"], time].concat())?;
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        check(output.status.success() && said.contains("used against the file's own clock, which says 200 Hz"), &said)?;
        check(said.contains("\"rate_hz\": 100.0"), said)?;
    }
    // By inspect and by a model, too.
    let output = program().args(["inspect", &path, "--rate-hz", "100"]).output()?;
    check(output.status.code() == Some(2), String::from_utf8_lossy(&output.stderr))?;
    let model = tempfile::NamedTempFile::with_suffix(".toml")?;
    let model_path = model.path().to_string_lossy().into_owned();
    let diagnose = |force: &str| {
        let text = format!("kind = \"static\"\nrate_hz = 100.0\n{force}\n[columns]\nchannels = [\"x\"]\n");
        std::fs::write(model.path(), text)?;
        program().args(["diagnose", &path, "--model", &model_path]).output()
    };
    let refused = diagnose("")?;
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    check(refused.status.code() == Some(2) && said.contains("200") && said.contains("100"), said)?;
    check(diagnose("force_rate = true")?.status.success(), "a forced rate in a model")?;
    // Controls: what agrees, to within what an oscillator is off by; a column that is no clock; a unit
    // that is only guessed.
    for (heading, step_s, rate) in
        [("t_s", 0.005, "200"), ("t_s", 0.005, "198.5"), ("u", 0.005, "100"), ("t", 5.0, "100")]
    {
        write(heading, step_s)?;
        let output = allan(&["--rate-hz", rate])?;
        check(
            output.status.success(),
            format!("{heading} {step_s} {rate}: {}", String::from_utf8_lossy(&output.stderr)),
        )?;
    }
    Ok(())
}
