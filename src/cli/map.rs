//! `proofmass map`: a map.toml in, the maps and bifurcation diagrams of its oscillator out.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::device::{backends, on_device};
use super::launcher::refuse_ranks;
use super::numbers;
use super::output::{remark, say, sayln};
use super::sharded::tell;
use proofmass_base::document::{parse_toml, read_text};
use proofmass_base::error::Result;
use proofmass_base::number::significant;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::Shard;
use proofmass_base::shard::file::Place;
use proofmass_base::shard::gather::Found;
use proofmass_map::document::Document;
use proofmass_map::grid::Grid;
use proofmass_map::page;
use proofmass_map::{Atlas, compute, divided};
use proofmass_simulate::ensemble::Choice;

const EXAMPLE: &str = "map.toml:
  name = \"my proof mass\"
  [oscillator]              # m x'' + D0 x' + k x + epsilon x^3 = F0 cos(omega t)
  mass_kg = 1.0
  damping_kg_s = 0.1
  stiffness_n_m = 1.0
  cubic_n_m3 = 0.3
  [drive]                   # the point that is marked; omega_rad_s or frequency_hz
  amplitude_n = 66.75
  omega_rad_s = 1.5
  [[map]]                   # any two of amplitude_n omega_rad_s frequency_hz cubic_n_m3 damping_kg_s stiffness_n_m
  title = \"force and frequency\"
  x = { quantity = \"amplitude_n\", from = 0.0, to = 100.0, points = 256 }
  y = { quantity = \"omega_rad_s\", from = 0.5, to = 3.0, points = 256 }
  transient_periods = 100
  periods = 100
  noise_n_rts = 0.0         # white force noise, two-sided coefficient
  [[bifurcation]]           # swept up and down
  title = \"along the force\"
  from_n = 0.1
  to_n = 100.0
  points = 900
  transient_periods = 100
  strobes = 100
  noise_n_rts = 0.0";

/// Arguments of `map`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Arguments {
    /// Study of the map (map.toml)
    pub map: PathBuf,
    /// Folder for report.html, one CSV per map, the figures and their numbers
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Compute only this part of the work, e.g. 3/16: writes DIR/shard-3-of-16.state for
    /// `proofmass merge DIR`
    #[arg(long, value_name = "K/N", requires = "out")]
    pub shard: Option<Shard>,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long, requires = "out")]
    pub parquet: bool,
    /// Device to integrate on: auto takes a hardware GPU if present, else the CPU
    #[arg(long, value_parser = backends(), default_value = "auto")]
    pub backend: Choice,
}

/// Maps, prints a summary and writes the report.
///
/// # Errors
/// A map file that cannot be used; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let text = read_text(&arguments.map)?;
    let document: Document = parse_toml(&arguments.map.display().to_string(), &text)?;
    document.check()?;
    if let (Some(number), Some(out)) = (arguments.shard, &arguments.out) {
        return shard(arguments, &document, &text, number, out, json);
    }
    refuse_ranks(divided::COMMAND)?;
    let inputs = std::slice::from_ref(&arguments.map);
    let open = |path| Folder::open(path, outputs("map", inputs, &document, arguments.force, arguments.parquet));
    let folder = arguments.out.as_deref().map(open).transpose()?;
    let control = progress::terminal();
    let atlas = on_device(arguments.backend, |device| compute(document.clone(), device, &control))?;
    answer(&atlas, folder, json)
}

/// Prints a summary and writes the report.
fn answer(atlas: &Atlas, folder: Option<Folder>, json: bool) -> Result<()> {
    let report = folder.as_ref().map(|folder| folder.path().join(REPORT));
    let written = folder.map_or(Ok(()), |folder| write(folder, atlas));
    if json {
        sayln!("{:#}", summary(atlas))?;
    } else {
        say(format_args!("{}", page::table(atlas)))?;
        if let (Some(report), Ok(())) = (report, &written) {
            sayln!("report: {}", report.display())?;
        }
    }
    written
}

/// Computes a share of the map.
fn shard(arguments: &Arguments, document: &Document, text: &str, shard: Shard, out: &Path, json: bool) -> Result<()> {
    let control = progress::terminal();
    let place = Place::take(out, &divided::header(document, text, &arguments.map, shard, None)?, arguments.force)?;
    on_device(arguments.backend, |device| {
        let mut header = divided::header(document, text, &arguments.map, shard, Some(device))?;
        let results = divided::compute(document, &mut header, device, &control)?;
        place.write(&header, &results)?;
        tell(&header, " and diagrams", place.path(), json)
    })
}

/// Puts the shards of a map together.
///
/// # Errors
/// A file that is damaged; a folder that cannot be written.
pub(super) fn merge(found: &[Found], places: &[PathBuf], out: Option<(&Path, bool)>, json: bool) -> Result<()> {
    let (atlas, devices) = divided::merged(found)?;
    if devices.len() > 1 {
        remark!(
            "note: the shards were computed on {}: their results may differ in the last bits.",
            devices.join(" and ")
        );
    }
    let open = |(path, force)| Folder::open(path, outputs("merge", places, &atlas.document, force, false));
    answer(&atlas, out.map(open).transpose()?, json)
}

const REPORT: &str = "report.html";

fn outputs(
    command: &'static str,
    inputs: &[PathBuf],
    document: &Document,
    force: bool,
    parquet: bool,
) -> output::Request {
    let tables = (0..document.map.len()).map(csv_name);
    let figures = page::file_names(document).into_iter().flatten();
    output::Request {
        command,
        inputs: inputs.to_vec(),
        writes: tables.chain(figures).chain([REPORT.to_owned()]).chain(numbers::files(parquet)).collect(),
        force,
        ..output::Request::default()
    }
}

fn csv_name(map: usize) -> String {
    format!("map-{}.csv", map + 1)
}

fn summary(atlas: &Atlas) -> serde_json::Value {
    let maps: Vec<_> = atlas
        .grids
        .iter()
        .map(|g| {
            let largest = g.exponent_per_s.iter().copied().filter(|e| e.is_finite()).fold(f64::NAN, f64::max);
            json!({"title": g.map.title, "cells": g.exponent_per_s.len(), "lost": g.lost(), "chaotic_share": g.chaotic_share(),
                "largest_exponent_per_s": largest,
                "x": {"quantity": g.map.x.quantity, "from": g.map.x.from, "to": g.map.x.to, "points": g.map.x.points},
                "y": {"quantity": g.map.y.quantity, "from": g.map.y.from, "to": g.map.y.to, "points": g.map.y.points}})
        })
        .collect();
    let diagrams: Vec<_> = atlas
        .diagrams
        .iter()
        .map(|b| json!({"title": b.diagram.title, "amplitudes_with_hysteresis": b.hysteresis_n().len()}))
        .collect();
    json!({"schema": "proofmass.map/1", "name": atlas.document.name, "maps": maps, "bifurcations": diagrams})
}

/// x, y, exponent and period of every cell.
fn csv(grid: &Grid) -> String {
    let mut text = String::from("x,y,exponent_per_s,period\n");
    for (cell, (exponent, period)) in grid.exponent_per_s.iter().zip(&grid.period).enumerate() {
        let (column, row) = (cell as u32 % grid.map.x.points, cell as u32 / grid.map.x.points);
        text += &format!("{},{},{exponent:.6},{period}\n", grid.map.x.at(column), grid.map.y.at(row));
    }
    text
}

fn write(mut folder: Folder, atlas: &Atlas) -> Result<()> {
    for (i, grid) in atlas.grids.iter().enumerate() {
        folder.write(&csv_name(i), csv(grid).as_bytes())?;
    }
    let lede = format!(
        "Where a driven Duffing proof mass is periodic and where it is chaotic: largest Lyapunov exponent and period over \
         its parameters. The marked point is F₀ = {} N at ω = {} rad/s.",
        significant(atlas.document.drive.amplitude_n, 4),
        significant(atlas.document.drive.omega_rad_s(), 4),
    );
    let mut paper = proofmass_report::html::Page::new(&atlas.document.name, &lede);
    paper.table(&page::table(atlas));
    page::write(&mut paper, atlas);
    for (name, figure) in page::figures(atlas) {
        folder.write(&name, figure.file_svg().as_bytes())?;
    }
    numbers::write(&mut folder, REPORT, paper)?;
    folder.finish()
}
