//! Exports of oscilloscopes and network analysers with settings above their headings: the table below
//! is read as it would be alone, and the lines left out are reported.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::recording::finding::Finding;
use proofmass::recording::{self, Request};
use serde_json::Value;

use super::touchstone::{diagnosed, response};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("formats: a network analyser's sweep below its settings is a response", sweep),
        test("formats: an oscilloscope's record below its settings is a series in time", record),
        test("formats: LabVIEW's measurement files are read, with their clock and without their comments", measurement),
        test("formats: settings above the numbers without headings are refused with their line", unnamed),
    ]
}

/// Twelve lines of settings as a Siglent analyser writes them, and one of free text as a Keysight.
const ANALYSER: &str = "!CSV A.01.01\nModel Number,SDS2104X Plus\nSerial Number,X0001\nSoftware Version,1.5.2R3\n\
    Date,2025-03-04 10:20\nSweep Type,Linear\nPoints,161\nAmplitude,1.00Vpp\nOffset,0\nLoad,High-Z\nDUT Input,C1\n\
    DUT Output,C2\n\n";
const NAMES: &str = "Frequency(Hz),Channel 1 Magnitude(dB),Channel 1 Phase(deg)";

/// Eight lines as a Rigol or Siglent oscilloscope writes them.
const OSCILLOSCOPE: &str = "Record Length,Analog:2000\r\nSample Interval,Analog:1.00E-03\r\nVertical Units,CH1:V\r\n\
    Vertical Scale,CH1:5.00E-01\r\nVertical Offset,CH1:0.00\r\nHorizontal Units,S\r\nHorizontal Scale,1.00E-01\r\n\
    Probe,10\r\n";

fn inspected(path: &Path) -> Result<Value, Failed> {
    let output = program().arg("inspect").arg(path).arg("--json").output()?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn sweep() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let rows: String =
        response().iter().map(|(f, s)| format!("{f},{},{}\n", 20.0 * s.norm().log10(), s.arg().to_degrees())).collect();
    let path = |name: &str, above: &str| -> Result<_, Failed> {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("{above}{NAMES}\n{rows}"))?;
        Ok(path)
    };
    let (below, alone) = (path("below.csv", ANALYSER)?, path("alone.csv", "")?);
    let seen = inspected(&below)?;
    let said = seen["findings"].to_string();
    check(said.contains("12 lines before the headings in line 14 were left out"), seen.to_string())?;
    let output = program().arg("diagnose").arg(&below).output()?;
    let notes = String::from_utf8_lossy(&output.stderr).into_owned();
    for words in ["kind = \"response\"", "amplitude = \"Channel 1 Magnitude(dB)\"", "phase = \"Channel 1 Phase(deg)\""]
    {
        check(notes.contains(words), format!("no {words} in: {notes}"))?;
    }
    // The same numbers below the settings and alone.
    let [found, wanted] = [diagnosed(&below)?, diagnosed(&alone)?];
    let same = found.iter().zip(&wanted).all(|(a, b)| a.value.to_bits() == b.value.to_bits());
    check(found.len() == wanted.len() && same, format!("{found:?} {wanted:?}"))?;
    // Control: the table alone is read as before, and nothing is said.
    check(!inspected(&alone)?["findings"].to_string().contains("before the headings"), "a table alone has settings")
}

/// LabVIEW writes a second head, decimal commas, tabs, and a heading for comments that its rows end
/// without.
fn measurement() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let head = "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\n\
        Decimal_Separator\t,\r\nMulti_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tAbsolute\r\n\
        ***End_of_Header***\t\t\t\r\nChannels\t2\t\t\r\nSamples\t2000\t2000\t\r\nX_Dimension\tTime\tTime\t\r\n\
        Delta_X\t0,000500\t0,000500\t\r\n***End_of_Header***\t\t\t\r\n";
    let value = |k: usize| ((k * k * 7919 + k * 104_729) % 10_007) as f64 / 2890.0 - 1.73;
    let row = |k: usize| format!("{:.6}\t{:.6}\t{:.6}\r\n", k as f64 * 5e-4, value(k), value(k + 7)).replace('.', ",");
    let rows: String = (0..2000).map(row).collect();
    let path = folder.path().join("log.lvm");
    std::fs::write(&path, format!("{head}X_Value\tForce\tLaser\tComment\r\n{rows}"))?;
    let read = recording::read(&path, &Request::default())?;
    let names: Vec<&str> = read.columns.iter().map(|c| c.name.as_str()).collect();
    let said = format!("{names:?} {} Hz, {} rows", read.rate_hz, read.rows);
    check(names == ["Force", "Laser"] && (read.rate_hz - 2000.0).abs() < 1e-6 && read.rows == 2000, said)?;
    let far = (0..2000).map(|k| (read.columns[1].values[k] - value(k + 7)).abs()).fold(0.0, f64::max);
    check(far < 1e-6, format!("{far}"))?;
    // Control: another heading without a column is one too many.
    std::fs::write(&path, format!("{head}X_Value\tForce\tLaser\tPosition\r\n{rows}"))?;
    check(recording::read(&path, &Request::default()).is_err(), "four headings for three columns")
}

fn record() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let value = |k: usize| ((k * k * 7919 + k * 104_729) % 10_007) as f64 / 2890.0 - 1.73;
    let rows: String = (0..2000).map(|k| format!("{:.3},{}\r\n", k as f64 * 1e-3 - 1.0, value(k))).collect();
    let written = |name: &str, above: &str| -> Result<_, Failed> {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("{above}{rows}"))?;
        Ok(path)
    };
    // The units alone stand as headings.
    let path = written("record.csv", &format!("{OSCILLOSCOPE}Second,Volt\r\n"))?;
    let below = recording::read(&path, &Request::default())?;
    let settings = Finding::Preamble { lines: 8, headings: 9 };
    check(below.findings.contains(&settings), format!("{:?}", below.findings))?;
    check((below.rate_hz - 1000.0).abs() < 1e-6 && below.rows == 2000, format!("{} Hz", below.rate_hz))?;
    let whole: Vec<f64> = (0..2000).map(value).collect();
    check(below.columns.len() == 1 && below.columns[0].name == "Volt", format!("{:?}", below.columns[0].name))?;
    check(below.columns[0].values == whole, "other numbers")?;
    check(inspected(&path)?["clock"] == "Second", inspected(&path)?.to_string())?;
    // Control: where the table begins with the file, `Second` is a column as any other.
    let alone = recording::read(
        &written("alone.csv", "Second,Volt\r\n")?,
        &Request { rate_hz: Some(1000.0), ..Request::default() },
    )?;
    check(alone.columns.len() == 2 && alone.columns[1].values == whole, format!("{:?}", alone.findings))?;
    check(!alone.findings.iter().any(|f| matches!(f, Finding::Preamble { .. })), format!("{:?}", alone.findings))
}

fn unnamed() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("record.csv");
    let rows: String = (0..50).map(|k| format!("{k},{},{}\r\n", 2 * k, 3 * k)).collect();
    std::fs::write(&path, format!("{OSCILLOSCOPE}Second,Volt\r\n{rows}"))?;
    let refused = recording::read(&path, &Request { rate_hz: Some(1.0), ..Request::default() });
    let Err(error) = refused else { return Err("two names for three columns were read".into()) };
    let words = "the numbers begin in line 10 with 3 cells, and line 9 above them, with 2";
    check(error.cause.contains(words), error.to_string())
}
