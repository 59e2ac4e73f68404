//! A verdict is one of the sensor, not of the file: the same in other units, with the other sign,
//! with the columns in another order, on an offset, and with every second sample.

use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};

use super::bench::{Bench, run};
use super::near_laws::{Force, PER_RADIAN, recording};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("same verdict: a cubic spring, however it is written down", || {
            same(|x, _| 0.2 * x.powi(3), "explained", &["cubic-stiffness"])
        }),
        test("same verdict: a linear mass, however it is written down", || same(|_, _| 0.0, "adequate", &[])),
        test("same verdict: another force in the file is another verdict (control)", control),
    ]
}

/// One way to write a recording down: factors of input and output, an offset of the output, columns
/// in the other order, every n-th sample.
#[derive(Debug, Clone, Copy)]
struct Written {
    input: f64,
    output: f64,
    offset: f64,
    output_first: bool,
    every: usize,
}

const PLAIN: Written = Written { input: 1.0, output: 1.0, offset: 0.0, output_first: false, every: 1 };

/// Input and output, row by row.
type Rows = Vec<[f64; 2]>;

fn rows(force: Force) -> Result<Rows, Failed> {
    let row = |line: &str| -> Result<[f64; 2], Failed> {
        let (u, y) = line.split_once(',').ok_or("two columns")?;
        Ok([u.parse()?, y.parse()?])
    };
    recording(force, 3, 0.0).lines().skip(1).map(row).collect()
}

/// Verdict, names, and β of a cubic spring in units of the plain recording.
type Said = (String, Vec<String>, Option<f64>);

fn diagnosed(rows: &Rows, as_: Written) -> Result<Said, Failed> {
    let mut csv = String::from(if as_.output_first { "y,u\n" } else { "u,y\n" });
    for [u, y] in rows.iter().step_by(as_.every) {
        let (u, y) = (as_.input * u, as_.output * y + as_.offset);
        let [first, second] = if as_.output_first { [y, u] } else { [u, y] };
        let _ = writeln!(csv, "{first},{second}");
    }
    let bench = Bench::new()?;
    let file = bench.file("log.csv", &csv)?;
    let rate_hz = 100.0 * PER_RADIAN / as_.every as f64;
    let columns = "[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let model = bench.file("model.toml", &format!("kind = \"driven\"\nrate_hz = {rate_hz}\n{columns}"))?;
    let answer = run(program().arg("diagnose").arg(file).arg("--model").arg(model).arg("--json"))?;
    let verdict: serde_json::Value = serde_json::from_str(&answer.stdout)?;
    let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
    let names = effects.iter().filter_map(|e| e["id"].as_str().map(str::to_owned)).collect();
    // β multiplies the cube of a reading to give its acceleration.
    let beta = effects.first().and_then(|e| e["parameters"][0]["value"].as_f64()).map(|b| b * as_.output.powi(2));
    Ok((verdict["verdict"].as_str().unwrap_or_default().to_owned(), names, beta))
}

fn same(force: Force, verdict: &str, names: &[&str]) -> Result<(), Failed> {
    let rows = rows(force)?;
    let plain = diagnosed(&rows, PLAIN)?;
    check(plain.0 == verdict && plain.1 == names, format!("{plain:?}"))?;
    // Beside the numbers as they are: how far β may be from the plain one. Units and order change
    // no information, only roundings; half the samples are √2 in the interval of 1 %.
    let ways = [
        (Written { output: 1e-6, ..PLAIN }, 1e-3),
        (Written { input: 1e3, ..PLAIN }, 1e-3),
        (Written { output: -1.0, ..PLAIN }, 1e-3),
        (Written { input: -1.0, output: -1.0, ..PLAIN }, 1e-3),
        (Written { output_first: true, ..PLAIN }, 1e-12),
        (Written { offset: 40.0, ..PLAIN }, 1e-3),
        (Written { every: 2, ..PLAIN }, 0.03),
    ];
    for (way, within) in ways {
        let said = diagnosed(&rows, way)?;
        let as_near = match (said.2, plain.2) {
            (Some(here), Some(there)) => (here / there - 1.0).abs() < within,
            (here, there) => here == there,
        };
        check(said.0 == plain.0 && said.1 == plain.1 && as_near, format!("{way:?}: {said:?}, plain {plain:?}"))?;
    }
    Ok(())
}

fn control() -> Result<(), Failed> {
    let [linear, cubic] = [rows(|_, _| 0.0)?, rows(|x, _| 0.2 * x.powi(3))?];
    let [linear, cubic] = [diagnosed(&linear, PLAIN)?, diagnosed(&cubic, PLAIN)?];
    check(linear.0 != cubic.0 && linear.1 != cubic.1, format!("{linear:?} {cubic:?}"))
}
