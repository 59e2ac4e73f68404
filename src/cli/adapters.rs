//! `proofmass adapters`: what could compute on this machine.

use super::output::{say, sayln};
use proofmass_base::error::Result;
use proofmass_kernel::cpu::lanes::Level;
use proofmass_report::table::Table;
use proofmass_simulate::backend::{cpu, gpu};

/// Arguments of `adapters`.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Lists the CPU and every GPU adapter.
///
/// # Errors
/// None: a machine without adapters has an empty list.
pub fn run(_arguments: &Arguments, json: bool) -> Result<()> {
    let adapters = gpu::list();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    if json {
        let list: Vec<_> = adapters
            .iter()
            .map(|a| {
                serde_json::json!({
                    "name": a.name, "kind": a.kind, "driver": a.driver, "hardware": a.hardware,
                    "int64": a.int64, "largest_binding_bytes": a.largest_binding,
                })
            })
            .collect();
        let cpu = serde_json::json!({
            "name": cpu::processor_name(), "threads": threads, "instructions": Level::best().name(),
        });
        sayln!("{:#}", serde_json::json!({ "schema": "proofmass.adapters/1", "cpu": cpu, "gpu": list }))?;
        return Ok(());
    }
    let mut table = Table::new(&["name", "kind", "driver", "64-bit integers", "largest buffer, MB"]);
    table.row([cpu::processor_name(), "cpu".to_owned(), format!("{}, {threads} threads", Level::best().name())]);
    for a in &adapters {
        let int64 = if a.int64 { "yes" } else { "no" };
        table.row([
            a.name.clone(),
            a.kind.to_owned(),
            a.driver.clone(),
            int64.to_owned(),
            (a.largest_binding >> 20).to_string(),
        ]);
    }
    say(format_args!("{table}"))?;
    if !adapters.iter().any(|a| a.hardware) {
        sayln!("no hardware GPU: `--backend auto` takes the CPU")?;
    }
    Ok(())
}
