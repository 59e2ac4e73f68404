//! Reports a shard of any command that is done.

use std::path::Path;

use serde_json::json;

use super::output::sayln;
use proofmass_base::error::Result;
use proofmass_base::shard::file::Header;

/// Reports how many units of a kind a shard has done, with a note on them, and where they are.
///
/// # Errors
/// When stdout cannot be written.
pub(super) fn tell(header: &Header, note: &str, path: &Path, json: bool) -> Result<()> {
    let Header { run, shard, pieces, .. } = header;
    let units: u64 = pieces.iter().map(|p| p.piece.units.end - p.piece.units.start).sum();
    let all: u64 = run.parts.iter().sum();
    let file = path.display().to_string();
    if json {
        let document = json!({
            "schema": "proofmass.shard/1", "command": run.command, "shard": shard.number, "of": shard.of,
            run.unit.clone(): units, "of_all": all, "file": file,
        });
        return sayln!("{document:#}");
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let unit = &run.unit;
    sayln!(
        "shard {shard}: {units} of {all} {unit}{note}, in {file}\nwhen all are there: proofmass merge {}",
        folder.display()
    )
}
