//! What must hold of every reader and document for any bytes at all, beside that nothing panics: rows that are in are used
//! or said to be dropped, TOML that is written can be read, JSON parses, an error says what to do.
//!
//! Each target of cargo-fuzz asks one of these; the suite replays the corpus and mutates it (`tests/suite/fuzz.rs`).

use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use proofmass::control::Control;
use proofmass::diagnosis::{self, consequence, model, repaired};
use proofmass::document::{parse_toml, to_json};
use proofmass::drift;
use proofmass::drift::document::Document;
use proofmass::ensemble::{self, Choice, Keeper, Options};
use proofmass::error::Error;
use proofmass::kernel::integrator::Integrator;
use proofmass::recording::formats::{Found, find_in};
use proofmass::recording::input::Input;
use proofmass::recording::reader::{self, Block};
use proofmass::recording::unit::{Quantity, Unit};
use proofmass::recording::{self, Request, noise, stream};
use proofmass::report;
use proofmass::sensor::Sensor;
use proofmass::statistics::Statistics;
use proofmass::study;
use proofmass::trial::{blind, real, seal::Sealed};
use proofmass::validation::jobs::{Sine, job};

/// What was found to be wrong, in words.
pub type Verdict = Result<(), String>;

/// An oracle by the name of its target and of its folder in the corpus.
pub type Oracle = (&'static str, fn(&[u8]) -> Verdict);

/// All of them.
pub const ALL: [Oracle; 13] = [
    ("recording", recording),
    ("formats", formats),
    ("allan", allan),
    ("unit", unit),
    ("study", study),
    ("model", model),
    ("map", map),
    ("recipe", recipe),
    ("truth", truth),
    ("verdicts", verdicts),
    ("state", state),
    ("manifest", manifest),
    ("diagnose", diagnose),
];

fn ensure(holds: bool, words: impl FnOnce() -> String) -> Verdict {
    if holds { Ok(()) } else { Err(words()) }
}

/// An error that a person can act on.
fn speaks(error: &Error) -> Verdict {
    let parts = [&error.attempt, &error.cause, &error.hint];
    ensure(parts.iter().all(|part| !part.trim().is_empty()), || format!("an error without words: {error:?}"))
}

fn speaks_or<T>(result: Result<T, Error>, then: impl FnOnce(T) -> Verdict) -> Verdict {
    match result {
        Ok(value) => then(value),
        Err(error) => speaks(&error),
    }
}

/// A folder of this thread's own.
fn folder() -> PathBuf {
    thread_local!(static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() });
    FOLDER.with(|folder| folder.get_or_init(|| tempfile::tempdir().expect("a temporary folder")).path().to_owned())
}

fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    std::fs::write(&path, bytes).expect("the temporary folder can be written");
    path
}

fn parses_as_json(text: &str) -> Verdict {
    serde_json::from_str::<serde_json::Value>(text).map(drop).map_err(|e| format!("JSON that does not parse: {e}"))
}

/// TOML that is a study when it is read again.
fn is_a_study(text: &str) -> Verdict {
    study::parse("written.toml", text, Path::new("/"))
        .map(drop)
        .map_err(|e| format!("a study that is refused: {e}\n{text}"))
}

/// A table of numbers, on a clock that is given and on that of its first column.
pub fn recording(bytes: &[u8]) -> Verdict {
    let path = file("log.csv", bytes);
    let lines = bytes.split(|b| *b == b'\n' || *b == b'\r').filter(|line| !line.is_empty()).count();
    let first =
        String::from_utf8_lossy(bytes.split(|b| b",;\t\n\r".contains(b)).next().unwrap_or_default()).into_owned();
    let given = Request { rate_hz: Some(100.0), ..Request::default() };
    let stamped = Request { time: Some(first.trim().to_owned()), ..Request::default() };
    for request in [given, stamped] {
        let mut rows = None;
        speaks_or(recording::read(&path, &request), |read| {
            let dropped: usize = read.dropped.iter().map(|d| d.rows).sum();
            rows = Some(read.rows);
            ensure(read.rows <= lines, || format!("{} rows in {lines} lines", read.rows))?;
            ensure(dropped <= read.rows, || format!("{dropped} of {} rows are dropped", read.rows))?;
            ensure(read.columns.iter().all(|c| c.values.len() == read.samples()), || {
                "columns of several lengths".into()
            })?;
            let finite = read.columns.iter().flat_map(|c| &c.values).all(|v| v.is_finite());
            ensure(finite && read.rate_hz.is_finite() && read.rate_hz > 0.0, || "a value that is no number".into())?;
            ensure(request.time.is_some() || read.samples() + dropped == read.rows, || {
                format!("{} rows, {} used, {dropped} said to be dropped", read.rows, read.samples())
            })?;
            ensure(read.sentences().iter().all(|s| !s.is_empty()), || "a finding without words".into())
        })?;
        let mut samples = 0;
        let streamed = stream::read(&path, &request, |block| samples += block.columns.first().map_or(0, Vec::len));
        speaks_or(streamed, |streamed| {
            let dropped: usize = streamed.dropped.iter().map(|d| d.rows).sum();
            ensure(samples == streamed.samples, || format!("{samples} samples given, {} counted", streamed.samples))?;
            ensure(rows.is_none_or(|rows| rows == streamed.rows), || "another number of rows when streamed".into())?;
            ensure(dropped <= streamed.rows, || format!("{dropped} of {} rows are dropped", streamed.rows))
        })?;
    }
    Ok(())
}

/// Most rows that are worth reading here: a few bytes of a format may stand for many.
const MOST_ROWS: usize = 20_000;

/// A binary file: each part that can be read, every column of it, beside a clock. Rows that a part states are given.
pub fn formats(bytes: &[u8]) -> Verdict {
    let input = Input::of_bytes(Path::new("log"), bytes.to_vec());
    let open = |part: usize| match find_in(input.clone()) {
        Ok(Found::Log { log, .. }) if part < log.parts().len() => Some(log),
        _ => None,
    };
    let parts = match find_in(input.clone()) {
        Ok(Found::Text(_)) => return Ok(()),
        Ok(Found::Log { log, .. }) => log.parts().to_vec(),
        Err(error) => return speaks(&error),
    };
    for (place, part) in parts.iter().enumerate().filter(|(_, p)| !p.columns.is_empty()).take(8) {
        let width = part.columns.len().min(16);
        let choice = reader::Choice { time: Some(0), places: (0..width).collect() };
        let Some(log) = open(place) else { return Err("parts that come and go".into()) };
        let mut reader = match log.open(place, &choice) {
            Ok(reader) => reader,
            Err(error) => {
                speaks(&error)?;
                continue;
            }
        };
        let (mut rows, mut block) = (0, Block::new(width));
        let ended = loop {
            block.clear();
            match reader.next(&mut block) {
                Ok(true) if rows < MOST_ROWS => rows += block.rows,
                Ok(more) => break Ok(!more),
                Err(error) => break Err(error),
            }
            let whole = block.stamps.len() == block.rows && block.columns.iter().all(|c| c.len() == block.rows);
            ensure(whole, || format!("a block of {} rows with columns of other lengths", block.rows))?;
        };
        let ended = match ended {
            Ok(ended) => ended,
            Err(error) => {
                speaks(&error)?;
                continue;
            }
        };
        let lost: usize = reader.dropped().iter().map(|d| d.rows).sum();
        let counted = part.rows.filter(|_| ended && lost == 0 && part.kind.is_empty() && !part.name.is_empty());
        ensure(counted.is_none_or(|stated| stated == rows as u64), || {
            format!("{:?} rows stated, {rows} given", part.rows)
        })?;
    }
    Ok(())
}

/// The noise of a log: page, JSON, and TOML that can be used.
pub fn allan(bytes: &[u8]) -> Verdict {
    let path = file("still.csv", bytes);
    let unit = Unit::parse("mg", Quantity::Accelerometer).map_err(|e| e.to_string())?;
    let request = Request { rate_hz: Some(100.0), ..Request::default() };
    speaks_or(noise::analyse(&path, &request, |_| unit.clone()), |noise| {
        let fragments = report::allan::fragments("still.csv", &noise);
        for fragment in &fragments {
            toml::from_str::<toml::Table>(&fragment.toml)
                .map_err(|e| format!("{}: {e}\n{}", fragment.name, fragment.toml))?;
        }
        let page = report::allan::page("still.csv", &noise, &fragments).finish();
        ensure(page.trim_end().ends_with("</html>"), || "half a page".into())?;
        report::allan::study(&path, &noise).map_or(Ok(()), |text| is_a_study(&text))?;
        parses_as_json(&to_json(&report::allan::document("still.csv", &noise)).map_err(|e| e.to_string())?)
    })
}

/// What a column is worth.
pub fn unit(bytes: &[u8]) -> Verdict {
    let text = String::from_utf8_lossy(bytes);
    for quantity in [Quantity::Accelerometer, Quantity::Gyro] {
        speaks_or(Unit::parse(&text, quantity), |unit| {
            let factors = [unit.signal().1, unit.density().1];
            ensure(factors.iter().all(|f| f.is_finite() && *f > 0.0), || format!("`{text}` is worth {factors:?}"))
        })?;
    }
    Ok(())
}

/// Most member-steps that are worth running here.
const MOST_STEPS: u64 = 50_000;

/// study.toml, and its answer where it costs little.
pub fn study(bytes: &[u8]) -> Verdict {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(()) };
    speaks_or(study::parse("study.toml", text, &folder()), |read| {
        let again = study::parse("study.toml", text, &folder()).map_err(|e| e.to_string())?;
        ensure(again.identity == read.identity, || "one text, two identities".into())?;
        let steps = read.clock.samples.saturating_mul(u64::from(read.clock.steps_per_sample));
        if read.members.saturating_mul(steps) > MOST_STEPS {
            return Ok(());
        }
        let options = Options { backend: Choice::Cpu, ..Options::default() };
        let answer = drift::answer(&read, &Control::default(), |job, _| ensemble::run(job, &options));
        speaks_or(answer, |drift| {
            let json = to_json(&Document::of(&read, &drift)).map_err(|e| e.to_string())?;
            parses_as_json(&json)?;
            let page = report::study::page(&read, &drift, proofmass::decision::further::Further::NONE).finish();
            ensure(page.trim_end().ends_with("</html>"), || "half a page".into())
        })
    })
}

/// model.toml.
pub fn model(bytes: &[u8]) -> Verdict {
    speaks_or(model::parse("model.toml", &String::from_utf8_lossy(bytes)), |_| Ok(()))
}

/// map.toml.
pub fn map(bytes: &[u8]) -> Verdict {
    let read = parse_toml::<proofmass::map::document::Document>("map.toml", &String::from_utf8_lossy(bytes));
    speaks_or(read, |map| speaks_or(map.check(), Ok))
}

/// The recipe of real recordings.
pub fn recipe(bytes: &[u8]) -> Verdict {
    speaks_or(real::read(&file("recipe.toml", bytes)), |_| Ok(()))
}

/// truth.json of a trial.
pub fn truth(bytes: &[u8]) -> Verdict {
    let path = file("truth.json", bytes);
    speaks_or(Sealed::of(&path), |sealed| speaks_or(sealed.open(), |_| Ok(())))
}

/// verdicts.jsonl of a trial: every line is a verdict, of another truth, or said to be torn.
pub fn verdicts(bytes: &[u8]) -> Verdict {
    let path = file("verdicts.jsonl", bytes);
    // The seal that the lines of the corpus carry.
    let sealed = Sealed { path: path.clone(), sha256: "0".repeat(64) };
    speaks_or(blind::earlier(&path, &sealed), |(read, unread)| {
        let lines = bytes.split(|b| *b == b'\n').filter(|line| !line.trim_ascii().is_empty()).count();
        ensure(read.len() + unread <= lines, || format!("{} and {unread} of {lines} lines", read.len()))
    })
}

/// The state of a run, with bytes changed: three a change, two for the place. What would give other numbers is refused.
pub fn state(changes: &[u8]) -> Verdict {
    static WRITTEN: OnceLock<(Vec<u8>, Statistics)> = OnceLock::new();
    let sine = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
    let job = job(Sensor::default(), 64, &[0.1], sine, Integrator::Ideal);
    let options = Options { backend: Choice::Cpu, ..Options::default() };
    let run = |keeper: &mut Keeper| {
        let mut cpu = proofmass::backend::cpu::Cpu::default();
        ensemble::run_kept(&job, &mut cpu, &options, keeper)
    };
    let path = folder().join("interrupted-1.json");
    let (written, answer) = WRITTEN.get_or_init(|| {
        let mut keeper = Keeper::new(&folder(), "a study");
        let answer = run(&mut keeper).expect("a run of 64 members");
        keeper.write().expect("its state is written");
        (std::fs::read(&path).expect("its state"), answer)
    });
    let mut bytes = written.clone();
    for change in changes.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([change[0], change[1]])) % bytes.len();
        bytes[place] = change[2];
    }
    std::fs::write(&path, &bytes).map_err(|e| e.to_string())?;
    let mut keeper = Keeper::resume(&folder(), "a study").map_err(|e| e.to_string())?;
    let resumed = run(&mut keeper);
    ensure(bytes != *written || resumed.is_ok(), || format!("the state as it was written is refused: {resumed:?}"))?;
    speaks_or(resumed, |got| ensure(got.at == answer.at, || "a state that was changed gave other numbers".to_owned()))
}

/// .proofmass.json of a folder of results.
pub fn manifest(bytes: &[u8]) -> Verdict {
    file(proofmass::output::manifest::NAME, bytes);
    speaks_or(proofmass::output::manifest::Manifest::read(&folder()), |_| Ok(()))
}

/// Models of the three kinds.
const MODELS: [&str; 3] = [
    "kind = \"driven\"\nrate_hz = 200.0\n[columns]\ninput = \"a\"\noutput = \"b\"\n",
    "kind = \"static\"\nrate_hz = 100.0\nunit = \"g\"\n[columns]\nchannels = [\"a\", \"b\"]\n",
    "kind = \"tumble\"\nrate_hz = 100.0\ngravity_m_s2 = 9.81\n[columns]\ngyro = [\"a\", \"b\", \"c\"]\naccelerometer = [\"d\", \"e\", \"f\"]\n",
];

/// A whole diagnosis: the first byte chooses the kind of model and the number of rows, the others make the columns.
pub fn diagnose(bytes: &[u8]) -> Verdict {
    let [first, rest @ ..] = bytes else { return Ok(()) };
    let model = model::parse("model.toml", MODELS[usize::from(first % 3)]).map_err(|e| e.to_string())?;
    let path = file("shape.csv", table(usize::from(first / 3), rest).as_bytes());
    speaks_or(model::read_recording(&path, &model, &Control::silent()), |recording| {
        speaks_or(diagnosis::diagnose(&recording, &model, &Control::default()), |answer| {
            let diagnosis = report::diagnosis::worded(answer);
            parses_as_json(&to_json(&diagnosis.verdict).map_err(|e| e.to_string())?)?;
            let study = repaired::document(diagnosis.repair.as_ref(), &diagnosis.detail, &diagnosis.verdict);
            study.as_deref().map_or(Ok(()), is_a_study)?;
            let costs = consequence::costs(diagnosis.repair.as_ref(), &Control::default());
            let costs = costs.map_err(|_| "it stopped, and nobody asked".to_owned())?;
            let exhibits = report::diagnosis::exhibits(&diagnosis.detail);
            let page = report::diagnosis::page(&diagnosis, &costs, &exhibits, study.as_deref()).finish();
            ensure(page.trim_end().ends_with("</html>"), || "half a page".into())
        })
    })
}

/// Six columns of noise, steps, sines, constants and holes, as the bytes say.
fn table(size: usize, bytes: &[u8]) -> String {
    let rows = 200 + 20 * size;
    let byte = |i: usize| f64::from(bytes.get(i % bytes.len().max(1)).copied().unwrap_or(0));
    let mut seed = bytes.iter().fold(1u64, |s, b| s.wrapping_mul(31).wrapping_add(u64::from(*b)));
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / 8_388_608.0 - 1.0
    };
    let mut text = String::from("a,b,c,d,e,f\n");
    for row in 0..rows {
        let t = row as f64 / rows as f64;
        let cells: Vec<String> = (0..6)
            .map(|column| {
                let [level, sine, step, loud] = [0, 1, 2, 3].map(|k| byte(4 * column + k));
                let wave = sine / 64.0 * (t * (1.0 + level) * 6.3).sin();
                let value = level / 128.0 - 1.0 + wave + if t > step / 255.0 { step / 100.0 } else { 0.0 };
                match byte(row + 7 * column) as u8 {
                    255 => String::new(),
                    254 => "nan".to_owned(),
                    253 => "1e300".to_owned(),
                    _ => format!("{:.6}", value + noise() * loud * loud / 20_000.0),
                }
            })
            .collect();
        text += &cells.join(",");
        text.push('\n');
    }
    text
}
