//! `proofmass validate`: laws, closed forms, orders and parities on this machine.

use super::device::backends;
use super::output::{say, sayln};
use proofmass_base::error::{Error, Result};
use proofmass_base::number::significant;
use proofmass_base::progress;
use proofmass_report::table::Table;
use proofmass_simulate::ensemble::Choice;
use proofmass_simulate::validation::{self, Row, jobs::Place};

/// Arguments of `validate`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Devices to check: `auto` is the CPU and, if present, a GPU (including software GPUs)
    #[arg(long, value_parser = backends(), default_value = "auto")]
    backend: Choice,
}

/// Runs it.
///
/// # Errors
/// A check that does not hold; an adapter that is not there.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let control = progress::terminal();
    let mut places = match arguments.backend {
        Choice::Cpu => vec![Place::cpu(&control)],
        Choice::Gpu => vec![Place::gpu(&control)?],
        Choice::Auto => std::iter::once(Place::cpu(&control)).chain(Place::gpu(&control)).collect(),
    };
    let rows = validation::run(&mut places, &control)?;
    let failed: Vec<&Row> = rows.iter().filter(|r| !r.holds).collect();
    if json {
        let backends: Vec<&str> = places.iter().map(|p| p.name.as_str()).collect();
        let document = serde_json::json!({
            "schema": "proofmass.validation/1", "backends": backends, "holds": failed.is_empty(), "checks": rows,
        });
        sayln!("{document:#}")?;
    } else {
        say(format_args!("{}", table(&rows)))?;
    }
    match failed.first() {
        None => Ok(()),
        Some(first) => Err(Error::new(
            format!("{} of {} checks failed", failed.len(), rows.len()),
            format!("{}: got {:e}, expected {:e} ± {:e}", first.what, first.got, first.expected, first.tolerance),
            "do not trust results of this build on this machine, and please report the table above",
        )),
    }
}

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new(&["what", "expected", "got", "tolerance", "holds"]);
    for r in rows {
        let number = |v: f64| significant(v, 5);
        let holds = if r.holds { "yes" } else { "NO" };
        table.row([r.what.clone(), number(r.expected), number(r.got), number(r.tolerance), holds.to_owned()]);
    }
    table
}
