//! Recordings are read as they are; what is wrong with a file is an error with attempt, cause and
//! hint, or a finding.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use libtest_mimic::{Failed, Trial};
use proofmass::control::{Control, Stage, Watcher};
use proofmass::error::{Error, Kind};
use proofmass::recording::{self, Recording, Request, inspection, stream};
use proofmass::study::{self, Overrides};

use super::world::{check, data_test, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("recording: separators, marks and line ends do not matter", separators),
        test("recording: bad files are refused with a hint, never a panic", refusals),
        test("recording: what can be survived is survived and said", findings),
        test("recording: a million columns are read by name", wide),
        test("recording: whoever watches is told of the reading and can stop it", watched),
        data_test("recording: the real recordings are read whole", |folder| {
            let silverbox = Request { time: Some("t_s".into()), ..Request::default() };
            let read = recording::read(&folder.join("silverbox/SNLS80mV.csv"), &silverbox)?;
            check(read.samples() == 131_072 && read.columns.len() == 2, format!("{} samples", read.samples()))?;
            // 10⁷/2¹⁴ Hz, from the data set's description.
            check((read.rate_hz / 610.351_562_5 - 1.0).abs() < 1e-6, format!("{} Hz", read.rate_hz))?;
            check(read.findings.is_empty(), format!("{:?}", read.findings))
        }),
    ]
}

fn written(text: &[u8]) -> Result<(tempfile::TempDir, PathBuf), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text)?;
    Ok((folder, path))
}

fn read(text: &str, columns: &[&str], time: Option<&str>) -> Result<Result<Recording, Error>, Failed> {
    let (_folder, path) = written(text.as_bytes())?;
    let columns = columns.iter().map(|c| (*c).to_owned()).collect();
    let rate_hz = time.is_none().then_some(10.0);
    Ok(recording::read(&path, &Request { columns, rate_hz, time: time.map(str::to_owned), ..Request::default() }))
}

/// Notes the stages that begin, and asks to stop.
struct Impatient {
    stops: bool,
    told: Arc<Mutex<Vec<String>>>,
}

struct Unheard;

impl Stage for Unheard {
    fn set(&self, _: u64) {}
    fn add(&self, _: u64) {}
    fn rename(&self, _: &str) {}
}

impl Watcher for Impatient {
    fn stopped_by(&self) -> Option<&'static str> {
        self.stops.then_some("a test")
    }
    fn begin(&self, name: &str, _: u64) -> Box<dyn Stage> {
        self.told.lock().expect("not poisoned").push(name.to_owned());
        Box::new(Unheard)
    }
    fn remark(&self, _: &str) {}
}

/// Every way to a recording asks the control that it was given, and no other.
fn watched() -> Result<(), Failed> {
    let (folder, log) = written(b"t,a\n0,1\n1,2\n2,3\n")?;
    let path = folder.path().join("study.toml");
    let text = "members = 2\nduration_s = 1.0\n[accelerometer]\nbias_mg = 1.0\n\
                [excitation]\nkind = \"replay\"\nfile = \"log.csv\"\ncolumn = \"a\"\nrate_hz = 1.0\n";
    std::fs::write(&path, text)?;
    type Way<'a> = (&'a str, &'a dyn Fn(Request) -> Result<(), Error>);
    let ways: [Way<'_>; 4] = [
        ("into memory", &|request| recording::read(&log, &request).map(drop)),
        ("as a stream", &|request| stream::read(&log, &request, |_| ()).map(drop)),
        ("to look at it", &|request| inspection::inspect(&log, &request).map(drop)),
        ("to replay it", &|request| study::read(&path, &Overrides::default(), &request.control).map(drop)),
    ];
    for (way, read) in ways {
        for stops in [true, false] {
            let told = Arc::new(Mutex::new(Vec::new()));
            let control = Control::new(Impatient { stops, told: told.clone() });
            let done = read(Request { rate_hz: Some(1.0), control, ..Request::default() });
            // Negative control: the same reading goes on where nobody stops it.
            let is_stopped = matches!(&done, Err(e) if e.kind == Kind::Interrupted && e.cause == "stopped by a test");
            check(is_stopped == stops && done.is_ok() != stops, format!("{way}, {stops}: {done:?}"))?;
            let told = told.lock().expect("not poisoned");
            check(!told.is_empty() && told.iter().all(|name| name == "reading"), format!("{way}: {told:?}"))?;
        }
    }
    Ok(())
}

fn separators() -> Result<(), Failed> {
    for text in [
        "t,a,b\n0,1,2\n1,3,4\n",
        "t;a;b\r\n0;1;2\r\n1;3;4",
        "\u{feff}t\ta\tb\n0\t1\t2\n1\t3\t4\n",
        "# x\nt, a, b\n0, 1, 2\n\n1, 3, 4\n",
    ] {
        let recording = read(text, &["b", "a"], None)??;
        check(recording.column("a") == Some(&[1.0, 3.0]) && recording.column("b") == Some(&[2.0, 4.0]), text)?;
        let all = read(text, &[], None)??;
        check(all.columns.len() == 2, "a clock is no channel")?;
    }
    // sha256sum of the ten bytes below.
    let sum = read("a\n1\n2\n3\n4\n", &[], None)??.sha256;
    check(sum == "929cee9e06d11c3fac6f7e656a709f8dcc190fc33f04452bd31461afcf571550", sum)
}

fn refusals() -> Result<(), Failed> {
    let many = |cell: &str| format!("t,a\n{}", (0..40).map(|i| format!("{i},{cell}\n")).collect::<String>());
    let cases = [
        ("", "a", None, "empty"),
        ("t,a\n", "a", None, "0 data rows"),
        ("t,a\n0,1\n", "a", None, "1 data rows"),
        ("t,a\n0,1\n1,2,3\n2,3\n", "a", None, "line 3 has 3 cells"),
        ("t,a\n0,1\n1,high\n2,3\n", "a", None, "`high` is not a number"),
        ("t,a\n0,\"1,5\"\n1,\"2,5\"\n", "a", None, "`1,5` is not a number"),
        ("t,acc_x\n0,1\n1,2\n", "acc_y", None, "no column `acc_y`"),
        ("t,a,a\n0,1,2\n1,2,3\n", "a", None, "two columns"),
        (&many(""), "a", None, "40 of 40 values are missing"),
        ("t,a\n0,1\n2,2\n1,3\n3,4\n", "a", Some("t"), "backwards"),
        ("t,a\n0,1\n0,2\n0,3\n0,4\n", "a", Some("t"), "repeat"),
        ("PK\u{3}\u{4}zip", "a", None, "spreadsheet"),
    ];
    for (text, column, time, cause) in cases {
        match read(text, &[column], time)? {
            Ok(_) => return Err(format!("accepted: {text:?}").into()),
            Err(e) => check(e.cause.contains(cause) && !e.hint.is_empty(), format!("{text:?}: {e}"))?,
        }
    }
    let nearest = read("t,acc_x\n0,1\n1,2\n", &["acc_y"], None)?.err().map(|e| e.hint);
    check(nearest.as_deref() == Some("did you mean `acc_x`?"), format!("{nearest:?}"))?;
    let folder = tempfile::tempdir()?;
    let request = Request { rate_hz: Some(1.0), ..Request::default() };
    let error = recording::read(folder.path(), &request).err().map(|e| e.hint);
    check(error.as_deref() == Some("give a file, not a folder"), format!("{error:?}"))?;
    check(recording::read(&folder.path().join("absent.csv"), &request).is_err(), "an absent file")?;
    let (_folder, path) = written(b"a\n1\n2\n")?;
    for rate in [None, Some(0.0), Some(f64::NAN)] {
        let request = Request { rate_hz: rate, ..Request::default() };
        check(recording::read(&path, &request).is_err(), format!("a rate of {rate:?}"))?;
    }
    let beyond = Request { rate_hz: Some(1.0), rows: Some(5..9), ..Request::default() };
    check(recording::read(&path, &beyond).is_err(), "rows beyond the end")
}

fn findings() -> Result<(), Failed> {
    let rows = |cell: fn(usize) -> String| (0..200).map(|i| format!("{i},{}\n", cell(i))).collect::<String>();
    let noisy: fn(usize) -> String = |i| format!("{}", (i * 7919 % 101) as f64);
    let cases = [
        (format!("t,a\n{}", rows(|i| if i == 50 { "nan".into() } else { format!("{}", i * 7919 % 101) })), "1 missing"),
        (format!("t,a\n{}200", rows(noisy)), "cut short"),
        (rows(noisy), "no header"),
        (format!("t,a\n{}", rows(|_| "7".into())), "dead channel"),
    ];
    for (text, said) in cases {
        let recording = read(&text, &[if said == "no header" { "2" } else { "a" }], None)??;
        check(recording.samples() == 200, format!("{} samples: {said}", recording.samples()))?;
        check(
            recording.sentences().iter().any(|f| f.contains(said)),
            format!("{:?} does not say {said}", recording.findings),
        )?;
    }
    Ok(())
}

fn wide() -> Result<(), Failed> {
    let line = |cell: &dyn Fn(usize) -> String| (0..1_000_000).map(cell).collect::<Vec<_>>().join(",") + "\n";
    let text = line(&|i| format!("c{i}")) + &line(&|i| i.to_string()) + &line(&|i| (2 * i).to_string());
    let recording = read(&text, &["c999999"], None)??;
    check(recording.columns[0].values == [999_999.0, 1_999_998.0], "the last of a million columns")?;
    check(read(&text, &[], None)?.is_err(), "a million channels at once")
}
