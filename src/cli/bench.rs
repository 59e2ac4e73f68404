//! `proofmass bench`: how fast this machine is.

use std::path::PathBuf;
use std::sync::Arc;

use super::device::{backends, open};
use super::numbers;
use super::output::{remark, say, sayln};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_benchmark::others::Ticks;
use proofmass_benchmark::page;
use proofmass_benchmark::{self as benchmark, Row};
use proofmass_simulate::backend::gpu::simulate::Ensembles;
use proofmass_simulate::ensemble::Choice;

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Devices to measure: `auto` is the CPU and, if present, a hardware GPU; `gpu` includes
    /// software GPUs
    #[arg(long, value_parser = backends(), default_value = "auto")]
    backend: Choice,
    /// Folder for report.html, summary.md and its figures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    force: bool,
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
    let request = || output::Request {
        command: "bench",
        writes: FILES.map(str::to_owned).into_iter().chain(numbers::files(false)).collect(),
        force: arguments.force,
        ..output::Request::default()
    };
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, request())).transpose()?;
    let stopped = |e: Error| e.within("could not finish the measurements", "run them again");
    let control = progress::terminal();
    let progress = control.stage("measuring", 0);
    let begun = Ticks::now();
    let mut rows: Vec<Row> = Vec::new();
    if arguments.backend != Choice::Gpu {
        rows.extend(benchmark::cpu(&control, &progress).map_err(stopped)?);
    }
    if let Some(gpu) = open(arguments.backend)? {
        let gpu = Arc::new(gpu);
        rows.extend(benchmark::gpu(&gpu, &mut Ensembles::on(gpu.clone()), &control, &progress).map_err(stopped)?);
    }
    drop(progress);
    let others = Ticks::now().zip(begun).map(|(now, begun)| now.others_since(&begun));
    let written = folder.map_or(Ok(()), |folder| write(folder, &rows, others));
    if let (Some(folder), Ok(())) = (&arguments.out, &written) {
        remark!("wrote {}", folder.join(FILES[0]).display());
    }
    if json {
        sayln!("{:#}", serde_json::json!({ "schema": "proofmass.bench/1", "others_cpu_share": others, "rows": rows }))?;
    } else {
        say(format_args!("{}", page::table(&rows)))?;
        sayln!("{}", page::busy(others))?;
    }
    written
}

const FILES: [&str; 4] = ["report.html", "summary.md", "sizes.svg", "lengths.svg"];

fn write(mut folder: Folder, rows: &[Row], others: Option<f64>) -> Result<()> {
    let texts = [page::summary(rows, others), page::sizes(rows).file_svg(), page::lengths(rows).file_svg()];
    numbers::write(&mut folder, FILES[0], page::page(rows, others))?;
    FILES.iter().skip(1).zip(texts).try_for_each(|(name, text)| folder.write(name, text.as_bytes()))?;
    folder.finish()
}
