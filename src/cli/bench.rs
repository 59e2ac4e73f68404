//! `proofmass bench`: how fast this machine is.

use std::path::PathBuf;
use std::sync::Arc;

use super::device::open;
use super::say::{remark, say, sayln};
use crate::backend::gpu::simulate::Ensembles;
use crate::benchmark::others::Ticks;
use crate::benchmark::{self, Row};
use crate::document::{writable, write_whole};
use crate::ensemble::Choice;
use crate::error::{Error, Result};
use crate::progress;
use crate::report::bench;

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Where: `auto` measures the CPU and, if there is one, a hardware GPU; `gpu` takes a software one too
    #[arg(long, value_enum, default_value_t)]
    backend: Choice,
    /// Folder for report.html, summary.md and its figures
    #[arg(long)]
    out: Option<PathBuf>,
    /// Print rows of the work unit that other tools are measured on, as CSV
    #[arg(long, hide = true)]
    peers: bool,
}

/// Measures and prints.
///
/// # Errors
/// An adapter that is not there; a folder that cannot be written; Ctrl-C.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    if arguments.peers {
        return benchmark::peers::rows().iter().try_for_each(|row| sayln!("{row}"));
    }
    arguments.out.as_deref().map_or(Ok(()), writable)?;
    let stopped = |e: Error| e.within("could not finish the measurements", "run them again");
    let bar = progress::bar("measuring", 0);
    let told = |what: &str| bar.set_message(what.to_owned());
    let begun = Ticks::now();
    let mut rows: Vec<Row> = Vec::new();
    if arguments.backend != Choice::Gpu {
        rows.extend(benchmark::cpu(told).map_err(stopped)?);
    }
    if let Some(gpu) = open(arguments.backend)? {
        let gpu = Arc::new(gpu);
        rows.extend(benchmark::gpu(&gpu, &mut Ensembles::on(gpu.clone()), told).map_err(stopped)?);
    }
    bar.finish_and_clear();
    let others = Ticks::now().zip(begun).map(|(now, begun)| now.others_since(&begun));
    if let Some(folder) = &arguments.out {
        let (sizes, lengths) = (bench::sizes(&rows).file_svg(), bench::lengths(&rows).file_svg());
        let (page, summary) = (bench::page(&rows, others), bench::summary(&rows, others));
        let files = [("report.html", page), ("summary.md", summary), ("sizes.svg", sizes), ("lengths.svg", lengths)];
        for (name, text) in files {
            write_whole(&folder.join(name), text.as_bytes())?;
        }
        remark!("wrote {}", folder.join("report.html").display());
    }
    if json {
        sayln!("{:#}", serde_json::json!({ "schema": "proofmass.bench/1", "others_cpu_share": others, "rows": rows }))?;
    } else {
        say(format_args!("{}", bench::table(&rows)))?;
        sayln!("{}", bench::busy(others))?;
    }
    Ok(())
}
