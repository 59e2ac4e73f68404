//! The numbers behind the figures: a table a figure, named columns with units, the same numbers
//! that the answer has.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::recording::{self, Request};
use proofmass::rng::{Philox, Stream};

use super::bench::{Bench, run};
use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("numbers: a study's envelope holds the answer, in CSV and Parquet", study),
        test("numbers: every figure of allan, diagnose and map has a table", tables),
        test("numbers: a table of the user's in numbers/ is refused, a stale one goes", owned),
        test("numbers: the check of a table sees a bad heading, a missing cell and no unit", controls),
    ]
}

/// A table, by its headings.
type Table = BTreeMap<String, Vec<Option<f64>>>;

/// Reads a table and fails unless it is rectangular, with headings in the way of a study's keys.
fn table(text: &str) -> Result<Table, Failed> {
    let mut lines = text.lines();
    let headings: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let plain = |h: &str| {
        let letters = h.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        letters && !h.is_empty() && !h.ends_with('_')
    };
    check(headings.iter().copied().all(plain), format!("headings {headings:?}"))?;
    let mut columns = vec![Vec::new(); headings.len()];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        check(cells.len() == headings.len(), format!("{} cells under {headings:?}: {line}", cells.len()))?;
        cells.iter().zip(&mut columns).for_each(|(cell, column)| column.push(cell.parse().ok()));
    }
    let table: Table = headings.iter().map(|h| (*h).to_owned()).zip(columns).collect();
    check(table.len() == headings.len(), format!("two columns of one name: {headings:?}"))?;
    Ok(table)
}

/// The tables of a folder, by their names.
fn folder(out: &Path) -> Result<BTreeMap<String, Table>, Failed> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(out.join("numbers"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "csv") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let read =
                table(&fs::read_to_string(&path)?).map_err(|e| format!("{name}: {}", e.message().unwrap_or("")))?;
            all.insert(name, read);
        }
    }
    Ok(all)
}

/// The names of the tables, after the program ran with `--out`.
fn names(bench: &Bench, arguments: &[&str]) -> Result<Vec<String>, Failed> {
    let answer = run(program().args(arguments).arg("--out").arg(bench.path("out")))?;
    check(answer.code == Some(0), format!("{arguments:?}: exit {:?} {}", answer.code, answer.stderr))?;
    Ok(folder(&bench.path("out"))?.into_keys().collect())
}

fn study() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let text = "name = \"small\"\nmembers = 512\nduration_s = 2.0\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n\
                noise_density_ug_rthz = 100.0\n[report]\ntimes_s = [1.0, 2.0]\n";
    let file = bench.file("study.toml", text)?;
    let out = bench.path("out");
    let answer = run(program().args(["study", "--json", "--parquet"]).arg(&file).arg("--out").arg(&out))?.json()?;
    let tables = folder(&out)?;
    let expected = ["budget", "budget-alone", "envelope", "percentiles", "position-error-after-2-s"];
    for name in expected {
        check(tables.contains_key(name), format!("no {name} in {:?}", tables.keys()))?;
    }
    let envelope = &tables["envelope"];
    let sd = envelope["position_error_sd_simulated_m"].last().copied().flatten();
    near("the last sd", sd.unwrap_or(f64::NAN), answer["position_error_m"]["sd"][1].as_f64().unwrap_or(0.0), 0.0)?;
    near("its time", envelope["time_s"].last().copied().flatten().unwrap_or(f64::NAN), 2.0, 1e-12)?;
    for name in ["position_error_5_95_percent_low_m", "position_error_5_95_percent_high_m", "position_error_median_m"] {
        check(tables["percentiles"].contains_key(name), format!("no {name} in {:?}", tables["percentiles"].keys()))?;
    }
    let times: Vec<f64> = tables["percentiles"]["time_s"].iter().flatten().copied().collect();
    let column = "position_error_median_m".to_owned();
    let request =
        Request { columns: vec![column.clone()], rate_hz: Some(100.0), force_rate: true, ..Request::default() };
    let parquet = recording::read(&out.join("numbers/percentiles.parquet"), &request)?;
    let csv: Vec<f64> = tables["percentiles"][&column].iter().flatten().copied().collect();
    check(times.len() == csv.len() && parquet.columns[0].values == csv, "Parquet and CSV differ")
}

/// 4000 rows of white noise in two columns, `ax` and `gz`.
fn log() -> String {
    let mut rng = Philox::new(5, 0, Stream::Host);
    let mut row = || format!("{:.6},{:.6}\n", rng.normal(), rng.normal());
    "ax,gz\n".to_owned() + &(0..4000).map(|_| row()).collect::<String>()
}

const MAP: &str = "name = \"m\"\n[oscillator]\nmass_kg = 1.0\ndamping_kg_s = 0.1\nstiffness_n_m = 1.0\ncubic_n_m3 = 0.3\n\
    [drive]\namplitude_n = 60.0\nomega_rad_s = 1.5\n[[map]]\ntitle = \"a\"\n\
    x = { quantity = \"amplitude_n\", from = 0.0, to = 100.0, points = 8 }\n\
    y = { quantity = \"omega_rad_s\", from = 0.5, to = 3.0, points = 4 }\ntransient_periods = 10\nperiods = 10\nnoise_n_rts = 0.0\n";

fn tables() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let (file, model) = (bench.file("log.csv", &log())?, bench.path("model.toml"));
    fs::write(&model, "kind = \"static\"\nrate_hz = 100.0\nunit = \"g\"\n[columns]\nchannels = [\"ax\", \"gz\"]\n")?;
    let map = bench.file("map.toml", MAP)?;
    let [file, model, map] = [&file, &model, &map].map(|p| p.display().to_string());
    let runs: [(&[&str], &[&str]); 3] = [
        (
            &["allan", &file, "--rate-hz", "100"],
            &["allan-deviation-of-ax", "allan-deviation-of-gz", "noise-density-of-ax", "noise-density-of-gz"],
        ),
        (
            &["diagnose", &file, "--model", &model],
            &["allan-ax", "allan-gz", "density-ax", "density-gz", "trace-ax", "trace-gz"],
        ),
        (&["map", &map], &["map-1-exponent", "map-1-exponent-marks", "map-1-period", "map-1-period-marks"]),
    ];
    for (arguments, expected) in runs {
        let bench = Bench::new()?;
        let names = names(&bench, arguments)?;
        let missing: Vec<_> = expected.iter().filter(|n| !names.iter().any(|name| name == *n)).collect();
        check(missing.is_empty(), format!("{}: no {missing:?} in {names:?}", arguments[0]))?;
        let page = fs::read_to_string(bench.path("out/report.html"))?;
        let figures = page.matches("<figure>").count();
        check(names.len() >= figures, format!("{}: {} tables of {figures} figures", arguments[0], names.len()))?;
        if arguments[0] == "map" {
            let cells = &folder(&bench.path("out"))?["map-1-exponent"];
            check(cells.len() == 3 && cells.values().all(|c| c.len() == 32), format!("{:?}", cells.keys()))?;
        }
    }
    Ok(())
}

fn owned() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let file = bench.file("log.csv", &log())?.display().to_string();
    let both = ["allan", &file, "--rate-hz", "100"];
    fs::create_dir_all(bench.path("out/numbers"))?;
    fs::write(bench.path("out/numbers/mine.csv"), "precious")?;
    let refused = run(program().args(both).arg("--out").arg(bench.path("out")))?;
    refused.refuses("a table of the user's", "numbers/mine.csv: not written by proofmass")?;
    fs::remove_dir_all(bench.path("out"))?;
    fs::create_dir(bench.path("out"))?;
    fs::write(bench.path("out/numbers"), "precious")?;
    let refused = run(program().args(both).arg("--out").arg(bench.path("out")))?;
    refused.refuses("a file named numbers", "its folder has the name of an existing file")?;
    check(fs::read_to_string(bench.path("out/numbers"))? == "precious", "the user's file was replaced")?;
    fs::remove_file(bench.path("out/numbers"))?;
    let before = names(&bench, &both)?;
    let after = names(&bench, &["allan", &file, "--rate-hz", "100", "--columns", "ax"])?;
    check(before.len() == 2 * after.len(), format!("{before:?} became {after:?}"))?;
    check(after.iter().all(|name| name.ends_with("ax")), format!("stale tables: {after:?}"))
}

fn controls() -> Result<(), Failed> {
    table("time_s,error_m\n0.0,1.0\n1.0,\n")?;
    for bad in ["time / s,error_m\n0.0,1.0\n", "time_s,error_m\n0.0\n", "time_s,time_s\n0.0,1.0\n", ",a\n1,2\n"] {
        check(table(bad).is_err(), format!("{bad:?} passes"))?;
    }
    Ok(())
}
