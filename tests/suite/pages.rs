//! Pages as a reader sees them: nothing clipped or touching at any width, on a phone and on paper;
//! figures that answer; one script, the page's own.

use std::fs;
use std::path::Path;
use std::process::Command;

use base64::Engine as _;
use libtest_mimic::{Failed, Trial};
use proofmass::report::figure::{Axis, Chart, Ink, Mark};
use proofmass::report::html::Page;
use proofmass::report::table::Table;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::bench::{Bench, run};
use super::world::{check, program, test};
use browser::{browser_test, installed, look};

mod browser;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("pages: a policy allows one style and one script by their digests, and nothing else", policy),
        test("pages: curves are drawn to a twentieth of a pixel", sub_pixel),
        browser_test("pages: what measures them sees what is wrong", blind),
        browser_test("pages: a study's figures answer mouse, keys and fingers, with the right numbers", answers),
        browser_test("pages: a study is whole at every width", study),
        browser_test("pages: a study along a trajectory, with its digits, is whole at every width", flight),
        browser_test("pages: the noise of a log is whole at every width", allan),
        browser_test("pages: a map is whole at every width, and its colours can be read", map),
        browser_test("pages: diagnoses at rest, of a drive and of a turntable are whole at every width", diagnoses),
        browser_test("pages: wide tables are whole at every width", tables),
        browser_test("pages: a trial is whole at every width", trial),
    ]
}

/// The page without the one script that its policy allows by digest; an error where another one is
/// allowed.
pub fn without_own_script(page: &str) -> Result<String, Failed> {
    let Some((before, rest)) = page.split_once("<script>") else { return Ok(page.to_owned()) };
    let (script, after) = rest.split_once("</script>").ok_or("a script without an end")?;
    let digest = base64::engine::general_purpose::STANDARD.encode(Sha256::digest(script.as_bytes()));
    let allowed = format!("script-src 'sha256-{digest}'; img-src data:");
    check(before.contains(&allowed), "a script that the page's policy does not name")?;
    Ok(format!("{before}{after}"))
}

fn policy() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let page = study_page(&bench, &[])?.0;
    let head = page.split_once("<title>").ok_or("no title")?.0;
    check(head.contains("default-src 'none'; style-src 'sha256-"), "the policy is missing or wider")?;
    check(!head.contains("unsafe"), "the policy allows what is unsafe")?;
    check(without_own_script(&page)? != page, "the page has no script")?;
    let changed = page.replacen("'use strict';", "'use strict'; ", 1);
    check(without_own_script(&changed).is_err(), "another script passes")?;
    let script = page.split_once("<script>").and_then(|(_, r)| r.split_once("</script>")).ok_or("no script")?.0;
    check(script.len() <= 60_000, format!("the script has {} bytes", script.len()))?;
    for load in ["http://", "https://", " src=", "url(h", "@import", "<link", " style=\""] {
        let found = page.match_indices(load).find(|(at, _)| !page[at.saturating_sub(40)..*at].contains("const NS"));
        check(found.is_none(), format!("the page holds {load}"))?;
    }
    small("study", &page)
}

/// At most 500 kB for twelve figures, and no less for fewer.
fn small(name: &str, page: &str) -> Result<(), Failed> {
    let figures = page.matches("<figure>").count();
    let most = 500_000 * figures.max(12) / 12;
    check(page.len() <= most, format!("{name}: {} bytes with {figures} figures", page.len()))
}

fn sub_pixel() -> Result<(), Failed> {
    let sine: Vec<(f64, f64)> = (0..=500).map(|k| f64::from(k) * 0.02).map(|x| (x, x.sin())).collect();
    let chart = Chart::new("", Axis::linear("x").within(0.0, 10.0), Axis::linear("y").within(-1.0, 1.0));
    let figure = chart.with("", Ink::Blue, Mark::Line, sine).draw();
    let svg = figure.inline();
    let attribute = |key: &str| svg.split_once(key).and_then(|(_, r)| r.split_once('"')).map_or("", |r| r.0);
    let numbers = |text: &str| text.split([' ', ',']).filter_map(|n| n.parse().ok()).collect::<Vec<f64>>();
    let (size, points) =
        (numbers(attribute("viewBox=\"")), numbers(attribute("<polyline class=\"s-c1 line\" points=\"")));
    check(points.len() > 40, format!("{} numbers", points.len()))?;
    let farthest = |points: &[f64]| {
        let off = |p: &[f64]| (size[3] * 0.5 * (1.0 - (10.0 * p[0] / size[2]).sin()) - p[1]).abs();
        points.chunks_exact(2).map(off).fold(0.0, f64::max)
    };
    check(farthest(&points) < 0.05, format!("a point is {} px off", farthest(&points)))?;
    let whole: Vec<f64> = points.iter().map(|p| p.round()).collect();
    check(farthest(&whole) > 0.05, "points on whole pixels pass")
}

/// Widths of screens, and of a sheet of A4 between its margins, px.
const WIDTHS: [u32; 4] = [390, 960, 1280, 1920];
const SHEET: u32 = 718;

/// Fails where a page is clipped, hard to read or has labels that touch, at any width or in print;
/// where its first figure does not answer; and where it is too big.
pub fn whole(name: &str, page: &str) -> Result<(), Failed> {
    if !installed() {
        return Ok(());
    }
    let mut frames: Vec<(u32, bool, &str)> = WIDTHS.iter().map(|width| (*width, false, page)).collect();
    frames.push((SHEET, true, page));
    let found = look(&frames, "measure(win, width, print)")?;
    for ((width, print, _), faults) in frames.iter().zip(&found) {
        let place = if *print { "in print".to_owned() } else { format!("at {width} px") };
        let shown = faults.iter().take(8).cloned().collect::<Vec<String>>().join("\n");
        check(faults.is_empty(), format!("{name} {place}: {} faults\n{shown}", faults.len()))?;
    }
    if page.contains("<figure>") {
        let faults = look(&[(1280, false, page)], "touch(win, { units: [], values: [] })")?.concat();
        check(faults.is_empty(), format!("{name}, its first figure: {}", faults.join("\n")))?;
    }
    small(name, page)
}

fn blind() -> Result<(), Failed> {
    let page =
        |body: &str| format!("<!doctype html><style>body{{margin:0;font:16px sans-serif}}</style><body>{body}</body>");
    let text = |x: u32, words: &str| format!("<text font-size=\"12\" x=\"{x}\" y=\"20\">{words}</text>");
    let figure = |a: u32, b: u32| {
        format!("<figure><svg width=\"200\" height=\"40\">{}{}</svg></figure>", text(a, "left"), text(b, "right"))
    };
    let table =
        |css: &str| format!("<div style=\"overflow-x:auto;{css}\"><div style=\"width:1500px\">wide</div></div>");
    let shrunk = "<svg width=\"100\" viewBox=\"0 0 200 40\"><text font-size=\"16\" y=\"20\">half as large</text></svg>";
    let hidden =
        "<div style=\"overflow:hidden;width:300px\"><p style=\"margin-left:1100px;white-space:nowrap\">gone</p></div>";
    let bad: [(&str, String); 6] = [
        ("the page is", "<div style=\"width:3000px\">wide</div>".into()),
        ("small text", "<p style=\"font-size:10px\">tiny</p>".into()),
        ("small text", shrunk.into()),
        ("labels overlap", figure(0, 12)),
        ("clipped", hidden.into()),
        ("a box", table("")),
    ];
    for (what, body) in &bad {
        let faults = look(&[(390, false, &page(body))], "measure(win, width, print)")?.concat();
        check(faults.iter().any(|f| f.starts_with(what)), format!("{what} is not seen: {faults:?}"))?;
    }
    let good = [figure(0, 60), table("border:1px solid"), "<p>plain</p>".into()];
    for body in &good {
        let faults = look(&[(390, false, &page(body))], "measure(win, width, print)")?.concat();
        check(faults.is_empty(), format!("{faults:?} in what is right"))?;
    }
    let faults =
        look(&[(1280, false, &page(&table("border:1px solid;width:900px")))], "measure(win, width, print)")?.concat();
    check(faults.iter().any(|f| f.starts_with("a box scrolls")), "a table that scrolls on a desktop is not seen")
}

/// Page and document of a small study.
fn study_page(bench: &Bench, more: &[&str]) -> Result<(String, Value), Failed> {
    let out = bench.path("study");
    let mut command = program();
    command.args(["study", "--json", "--members", "512", "--backend", "cpu", "--out"]).arg(&out).args(more);
    let document = run(&mut command)?.json()?;
    Ok((fs::read_to_string(out.join("report.html"))?, document))
}

/// Height of a figure's plotting area.
const HEIGHT_PX: f64 = 280.0;

/// The length of the first figure's axis whose ends stand in these attributes.
fn range_of(page: &str, from: &str, to: &str) -> Result<f64, Failed> {
    let number = |name: &str| -> Option<f64> { page.split_once(name)?.1.split('"').nth(1)?.parse().ok() };
    Ok(number(to).ok_or("no end of the axis")? - number(from).ok_or("no beginning of the axis")?)
}

fn answers() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let (page, document) = study_page(&bench, &[])?;
    let at = document["time_s"].as_array().and_then(|t| t.iter().position(|t| t == 10.0)).ok_or("no report at 10 s")?;
    let sd = document["position_error_m"]["sd"][at].as_f64().ok_or("no sd")?;
    let median = document["position_error_m"]["p50"][at].as_f64().ok_or("no median")?;
    // A curve is true to a twentieth of a pixel, 0.3 % on an axis of six decades; a read-out has
    // four digits. The axis of the envelope is linear.
    let twentieth_m = range_of(&page, "data-y-from=", "data-y-to=")? / (20.0 * HEIGHT_PX);
    let expected = json!({ "units": ["s", "m"], "values": [
        { "figure": 1, "name": "simulated", "x": 10.0, "value": sd, "tolerance": 0.004 * sd },
        { "figure": 0, "name": "median", "x": 10.0, "value": median, "tolerance": twentieth_m },
    ]});
    let work = |expected: &Value| format!("touch(win, {expected})");
    let faults = look(&[(1280, false, &page), (390, false, &page)], &work(&expected))?;
    check(faults.concat().is_empty(), faults.concat().join("\n"))?;
    let mut wrong = expected.clone();
    wrong["values"][0]["value"] = json!(1.01 * sd);
    let faults = look(&[(1280, false, &page)], &work(&wrong))?.concat();
    check(faults.len() == 1 && faults[0].contains("expected"), format!("a wrong number passes: {faults:?}"))?;
    let mut wrong = expected.clone();
    wrong["values"][1]["value"] = json!(median + 0.2 * sd);
    let faults = look(&[(1280, false, &page)], &work(&wrong))?.concat();
    check(faults.len() == 1 && faults[0].contains("median"), format!("a wrong median passes: {faults:?}"))?;
    // The policy holds: the same script with one more space does not run.
    let changed = page.replacen("'use strict';", "'use strict'; ", 1);
    let faults = look(&[(1280, false, &changed)], &work(&expected))?.concat();
    check(faults == ["the script did not run"], format!("a foreign script runs: {faults:?}"))
}

fn study() -> Result<(), Failed> {
    let bench = Bench::new()?;
    whole("study", &study_page(&bench, &[])?.0)?;
    // Large errors and many report times make wide tables.
    let more = [
        "--set",
        "accelerometer.bias_mg={ mean = -30.0, sd = 50.0 }",
        "--set",
        "report.times_s=[0.1, 1.0, 3.0, 10.0, 20.0, 30.0, 60.0]",
    ];
    whole("study with long tables", &study_page(&bench, &more)?.0)
}

fn flight() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let file = bench.file(
        "study.toml",
        "members = 256\nduration_s = 4.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"car\"\n[earth]\n\
         latitude_deg = 47.4\n[accelerometer]\nnoise_density_ug_rthz = 100.0\nbias_mg = { mean = 0.0, sd = 1.0 }\n\
         [gyro]\nbias_deg_h = { mean = 0.0, sd = 20.0 }\n[alignment]\nkind = \"still\"\nstill_s = 1.0\n[report]\n\
         times_s = [1.0, 4.0]\n",
    )?;
    let mut command = program();
    command.arg("study").arg(&file).args(["--backend", "cpu", "--digits", "1"]);
    let page = page_of(&bench.path("out"), &mut command)?;
    check(page.contains("The result as JCGM 101 states it"), "the digits are not on the page")?;
    command = program();
    command.arg("study").arg(&file).args(["--backend", "cpu"]);
    let without = page_of(&bench.path("without"), &mut command)?;
    check(!without.contains("JCGM"), "digits that nobody asked for (control)")?;
    whole("study along a trajectory", &page)
}

fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut random = proofmass::rng::Philox::new(seed, 0, proofmass::rng::Stream::Host);
    move || random.normal()
}

/// A page that a command writes.
fn page_of(out: &Path, command: &mut Command) -> Result<String, Failed> {
    let answer = run(command.arg("--out").arg(out))?;
    check(answer.code == Some(0), format!("exit {:?}: {}", answer.code, answer.stderr))?;
    Ok(fs::read_to_string(out.join("report.html"))?)
}

fn allan() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut normal = normals(31);
    let mut rows = String::from("ax,ay,az,gx,gy,gz\n");
    for _ in 0..20_000 {
        let row: Vec<String> = (0..6).map(|c| format!("{:.5}", if c < 3 { 0.01 } else { 0.001 } * normal())).collect();
        rows += &(row.join(",") + "\n");
    }
    let log = bench.file("log.csv", &rows)?;
    let mut command = program();
    command.arg("allan").arg(log).args(["--rate-hz", "100", "--accelerometer", "ax,ay,az", "--gyro", "gx,gy,gz"]);
    whole("allan", &page_of(&bench.path("out"), &mut command)?)
}

fn map() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let file = bench.file(
        "map.toml",
        "[oscillator]\ndamping_kg_s = 0.1\nstiffness_n_m = 1.0\ncubic_n_m3 = 0.3\n[drive]\namplitude_n = 66.75\n\
         omega_rad_s = 1.5\n[[map]]\ntitle = \"small\"\nx = { quantity = \"amplitude_n\", from = 60.0, to = 70.0, \
         points = 20 }\ny = { quantity = \"omega_rad_s\", from = 1.4, to = 1.6, points = 11 }\n[[bifurcation]]\n\
         title = \"short\"\nfrom_n = 60.0\nto_n = 70.0\npoints = 10\nstrobes = 10\n",
    )?;
    let out = bench.path("out");
    let page = page_of(&out, program().arg("map").arg(file))?;
    whole("map", &page)?;
    // The exponent in the middle row, from the table beside the page; the bar's range and 128
    // colours bound a reading.
    let table = fs::read_to_string(out.join("map-1.csv"))?;
    check(table.starts_with("x,y,exponent_per_s,"), table.lines().next().unwrap_or_default())?;
    let cells: Vec<Vec<f64>> =
        table.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().unwrap_or(f64::NAN)).collect()).collect();
    let bar = page.split_once("class=\"bar\"").ok_or("no colour bar")?.1;
    let limit =
        |key: &str| bar.split_once(key).and_then(|(_, r)| r.split_once('"')).and_then(|r| r.0.parse::<f64>().ok());
    let (low, high) = (limit("data-from=\"").ok_or("no low")?, limit("data-to=\"").ok_or("no high")?);
    let inside = |c: &&Vec<f64>| (c[1] - 1.5).abs() < 1e-9 && (low..high).contains(&c[2]);
    let known: Vec<Value> = cells
        .iter()
        .filter(inside)
        .step_by(4)
        .map(|c| {
            let tolerance = 0.012 * (high - low);
            json!({ "figure": 0, "name": "largest exponent", "x": c[0], "value": c[2], "tolerance": tolerance })
        })
        .collect();
    check(known.len() > 2, format!("{} cells to read", known.len()))?;
    let expected = json!({ "units": ["N"], "values": known });
    let faults = look(&[(1280, false, &page)], &format!("touch(win, {expected})"))?.concat();
    check(faults.is_empty(), faults.join("\n"))
}

fn diagnoses() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut normal = normals(32);
    let (mut walk, mut rest) = (0.0, String::from("x,y\n"));
    for _ in 0..3000 {
        walk += 0.2 * normal();
        rest += &format!("{:.4},{:.4}\n", walk + normal(), normal());
    }
    let model = "kind = \"static\"\nrate_hz = 100.0\nunit = \"mg\"\n[columns]\nchannels = [\"x\", \"y\"]\n";
    let page = |name: &str, csv: &str, model: &str| {
        let (csv, model) = (bench.file(&format!("{name}.csv"), csv)?, bench.file(&format!("{name}.toml"), model)?);
        page_of(&bench.path(name), program().arg("diagnose").arg(csv).arg("--model").arg(model))
    };
    whole("a diagnosis at rest", &page("rest", &rest, model)?)?;

    // A Duffing oscillator under filtered noise, by Runge–Kutta.
    let (mut x, mut v, mut u, h) = (0.0f64, 0.0f64, 0.0f64, 1.0 / 500.0);
    let mut driven = String::from("u,y\n");
    for _ in 0..6000 {
        let next = 0.7 * u + normal();
        let slope = |x: f64, v: f64, f: f64| (v, 3000.0 * f - 8.0 * v - 4000.0 * x - 800.0 * x.powi(3));
        driven += &format!("{u:.5},{:.6}\n", x + 0.002 * normal());
        let (k1, m) = (slope(x, v, u), 0.5 * (u + next));
        let k2 = slope(x + 0.5 * h * k1.0, v + 0.5 * h * k1.1, m);
        let k3 = slope(x + 0.5 * h * k2.0, v + 0.5 * h * k2.1, m);
        let k4 = slope(x + h * k3.0, v + h * k3.1, next);
        x += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
        v += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
        u = next;
    }
    let model = "kind = \"driven\"\nrate_hz = 500.0\nunit = \"V\"\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
    whole("a diagnosis of a drive", &page("driven", &driven, model)?)?;

    let mut imu = super::tumble_bench::Imu::without_defect(1);
    imu.g_sensitivity[(1, 0)] = 1e-3;
    let (recording, _) = imu.record(1);
    let mut turned = String::from("ax,ay,az,gx,gy,gz\n");
    for k in 0..recording.samples() {
        let row: Vec<String> = recording.columns.iter().take(6).map(|c| c.values[k].to_string()).collect();
        turned += &(row.join(",") + "\n");
    }
    let model = "kind = \"tumble\"\nrate_hz = 50.0\ngravity_m_s2 = 9.81\n[columns]\ngyro = [\"gx\", \"gy\", \"gz\"]\n\
                 accelerometer = [\"ax\", \"ay\", \"az\"]\n";
    whole("a diagnosis of a turntable", &page("turned", &turned, model)?)
}

/// A matrix of the largest trial's size, and a table of sentences.
fn tables() -> Result<(), Failed> {
    let mut page = Page::new("Tables", "A page of wide tables.");
    let numbers: Vec<String> = (1..=28).map(|n| n.to_string()).collect();
    let outcomes = ["adequate", "unexplained", "undecidable"];
    let headings = ["planted"].into_iter().chain(numbers.iter().map(String::as_str)).chain(outcomes);
    let mut matrix = Table::new(&headings.collect::<Vec<&str>>());
    for n in 1..=28 {
        matrix.row([format!("{n} readout-quantisation")].into_iter().chain((0..31).map(|_| "12".to_owned())));
    }
    page.table(&matrix);
    let mut sentences = Table::new(&["case", "kind", "how it is concealed", "planted", "verdict", "said", "why"]);
    let words = "a sentence of a few words that a table must wrap";
    sentences.row(["12", "driven", words, "readout-quantisation", "undecidable", words, words]);
    page.table(&sentences);
    page.preformatted(&"key = 1.0  # a comment that runs on ".repeat(12));
    whole("wide tables", &page.finish())
}

fn trial() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut command = program();
    whole("trial", &page_of(&bench.path("out"), command.args(["trial", "--cases", "6", "--samples", "600"]))?)
}
