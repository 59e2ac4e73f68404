//! A map divided among machines: rows of its grids and whole diagrams, and the atlas from all
//! files.
//!
//! Results in a file: of a grid, exponent and period of each cell and the range of its steps per
//! period; of a diagram, its points on the way up and down.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::atlas::Atlas;
use super::diagram::{self, Bifurcation};
use super::document::Document;
use super::grid::{self, Grid};
use proofmass_base::control::Control;
use proofmass_base::document::{hexadecimal, parse_toml};
use proofmass_base::error::{Error, Result};
use proofmass_base::shard::file::{Header, Progress, Run, damaged};
use proofmass_base::shard::gather::Found;
use proofmass_base::shard::{Part, Piece, Shard};
use proofmass_simulate::backend::orbits::Device;

/// The subcommand that divides maps.
pub const COMMAND: &str = "map";

/// The map, as a shard's file carries it.
#[derive(Serialize, Deserialize)]
struct Carried {
    source: String,
    text: String,
    /// Holds what it was computed on.
    device: String,
}

/// Orbits on one processor lane cost this much less than one that is swept alone: 64 lanes, half of
/// them lost to waiting.
const ALONE: u64 = 32;

/// Grids by rows, then diagrams.
fn parts(document: &Document) -> Vec<Part> {
    let grids = document.map.iter().map(|m| Part {
        units: u64::from(m.y.points),
        grain: 1,
        effort: u64::from(m.x.points) * (u64::from(m.transient_periods) + u64::from(m.periods)),
    });
    let diagrams = document.bifurcation.iter().map(|d| Part {
        units: 1,
        grain: 1,
        effort: ALONE * 2 * u64::from(d.points) * (u64::from(d.transient_periods) + u64::from(d.strobes)),
    });
    grids.chain(diagrams).collect()
}

fn run(document: &Document) -> Run {
    Run {
        command: COMMAND.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        // Debug writes every key and every digit.
        identity: hexadecimal(&Sha256::digest(format!("{document:?}"))),
        unit: "rows".into(),
        parts: parts(document).iter().map(|part| part.units).collect(),
    }
}

/// The head of a shard's file: of a document with its text and the file that it stands in; without
/// the device, one that is not computed yet.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub fn header(
    document: &Document,
    text: &str,
    input: &Path,
    shard: Shard,
    device: Option<Device<'_>>,
) -> Result<Header> {
    let device = match device {
        None => String::new(),
        Some(Device::Cpu) => "cpu".to_owned(),
        Some(Device::Gpu(gpu)) => gpu.adapter.name.clone(),
    };
    let carried = Carried { source: input.display().to_string(), text: text.into(), device };
    let carried = serde_json::to_value(carried)
        .map_err(|e| Error::new("could not divide the map", e.to_string(), "report this as a defect"))?;
    let input = input.canonicalize().unwrap_or_else(|_| input.to_path_buf());
    let pieces = shard.pieces(&parts(document)).into_iter();
    let begun = |piece: Piece| Progress { next: piece.units.start, piece, bytes: 0 };
    Ok(Header { run: run(document), input: Some(input), document: carried, shard, pieces: pieces.map(begun).collect() })
}

/// Computes the pieces of a shard and notes in its head that they are done.
///
/// # Errors
/// When the device fails or Ctrl-C stops it.
pub fn compute(
    document: &Document,
    header: &mut Header,
    device: Device<'_>,
    control: &Control,
) -> Result<Vec<Vec<u8>>> {
    let units = header.pieces.iter().map(|p| p.piece.units.end - p.piece.units.start).sum();
    let progress = control.stage("mapping", units);
    let mut results = Vec::new();
    for Progress { piece, next, .. } in &mut header.pieces {
        results.push(match document.map.get(piece.part) {
            Some(map) => {
                let rows = piece.units.start as u32..piece.units.end as u32;
                pack_grid(&grid::compute(document, map, rows, device, control, &progress)?)
            }
            None => {
                let asked = document.bifurcation.get(piece.part - document.map.len());
                asked.map_or_else(
                    || Ok(Vec::new()),
                    |d| diagram::compute(document, d, control, &progress).map(pack_diagram),
                )?
            }
        });
        *next = piece.units.end;
    }
    Ok(results)
}

fn pack_grid(grid: &Grid) -> Vec<u8> {
    let cells = grid.exponent_per_s.iter().zip(&grid.period);
    let mut bytes: Vec<u8> = cells.flat_map(|(e, p)| e.to_le_bytes().into_iter().chain(p.to_le_bytes())).collect();
    bytes.extend([grid.steps.0, grid.steps.1].iter().flat_map(|s| s.to_le_bytes()));
    bytes
}

fn pack_diagram(diagram: Bifurcation) -> Vec<u8> {
    let points = diagram.up.iter().chain(&diagram.down);
    points.flat_map(|(n, m)| n.to_le_bytes().into_iter().chain(m.to_le_bytes())).collect()
}

/// Adds rows to a grid; `None` where they are not as many as they should be.
fn unpack_grid(bytes: &[u8], cells: usize, grid: &mut Grid) -> Option<()> {
    let (rows, steps) = bytes.split_at_checked(cells.checked_mul(12)?)?;
    for cell in rows.as_chunks::<12>().0 {
        let [exponent @ .., a, b, c, d] = cell;
        grid.exponent_per_s.push(f64::from_le_bytes(*exponent));
        grid.period.push(u32::from_le_bytes([*a, *b, *c, *d]));
    }
    let ([fewest, most], []) = steps.as_chunks::<4>() else { return None };
    grid.steps.0 = grid.steps.0.min(u32::from_le_bytes(*fewest));
    grid.steps.1 = grid.steps.1.max(u32::from_le_bytes(*most));
    Some(())
}

fn unpack_diagram(bytes: &[u8], asked: &super::document::Diagram) -> Option<Bifurcation> {
    let half = asked.points as usize * asked.strobes as usize;
    let (numbers, []) = bytes.as_chunks::<8>() else { return None };
    let numbers: Vec<f64> = numbers.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let points: Vec<(f64, f64)> = numbers.as_chunks::<2>().0.iter().map(|[n, m]| (*n, *m)).collect();
    let (up, down) = points.split_at_checked(half).filter(|(_, down)| down.len() == half)?;
    Some(Bifurcation { diagram: asked.clone(), up: up.to_vec(), down: down.to_vec() })
}

/// The atlas from the files of all shards, and the devices that it was computed on.
///
/// # Errors
/// A file that is damaged.
pub fn merged(found: &[Found]) -> Result<(Atlas, Vec<String>)> {
    let carried = |found: &Found| -> Result<Carried> {
        serde_json::from_value(found.header.document.clone()).map_err(|e| damaged(&found.path, &e.to_string()))
    };
    let first =
        found.first().ok_or_else(|| Error::new("could not merge", "there are no shards", "give their folders"))?;
    let Carried { source, text, .. } = carried(first)?;
    let document: Document = parse_toml(&source, &text)?;
    document.check()?;
    if run(&document) != first.header.run {
        return Err(damaged(&first.path, "it does not hold the map that it names"));
    }
    // In the order of the units, so that rows are put one behind the other.
    let mut pieces: Vec<(Piece, Vec<u8>, &PathBuf)> = Vec::new();
    let mut devices = Vec::new();
    for file in found {
        let contents = file.contents()?;
        pieces.extend(contents.pieces().map(|(p, bytes)| (p.piece.clone(), bytes.to_vec(), &file.path)));
        devices.push(carried(file)?.device);
    }
    pieces.sort_by_key(|(piece, ..)| (piece.part, piece.units.start));
    devices.sort();
    devices.dedup();
    let empty = |map: &super::document::Map| Grid {
        map: map.clone(),
        exponent_per_s: Vec::new(),
        period: Vec::new(),
        steps: (u32::MAX, 0),
    };
    let mut grids: Vec<Grid> = document.map.iter().map(empty).collect();
    let mut diagrams = Vec::new();
    for (piece, bytes, path) in pieces {
        let asked = piece.part.checked_sub(grids.len()).and_then(|n| document.bifurcation.get(n));
        let read = match (grids.get_mut(piece.part), asked) {
            (Some(grid), _) => {
                let cells = (piece.units.end - piece.units.start) as usize * grid.map.x.points as usize;
                unpack_grid(&bytes, cells, grid)
            }
            (None, Some(asked)) => unpack_diagram(&bytes, asked).map(|d| diagrams.push(d)),
            (None, None) => None,
        };
        read.ok_or_else(|| damaged(path, "the file is damaged: its results have the wrong length"))?;
    }
    Ok((Atlas { document, grids, diagrams }, devices))
}
