//! `proofmass merge`: the state files of all shards in, the answer of the undivided run out.

use std::path::PathBuf;

use super::numbers;
use super::study::{answer, in_motion};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::gather::{Found, are_whole, find};
use proofmass_map::divided as map;
use proofmass_simulate::drift::{carried, divided as study};
use proofmass_trial::divided as trial;

const EXAMPLES: &str = "Examples:
  for k in 1 2 3 4; do proofmass study study.toml --shard $k/4 --out shards; done
  proofmass merge shards --out report               the same answer as from one run, to the last bit
  proofmass merge /disk1/shards /disk2/shards       shards may lie in several folders";

/// Arguments of `merge`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Folders with the state files of the shards, together all of one run
    #[arg(required = true, value_name = "DIR")]
    pub shards: Vec<PathBuf>,
    /// Folder for the output of the undivided run; without it, the result is only printed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier merge of the same folders
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// Merges.
///
/// # Errors
/// Shards that overlap, are missing, damaged, not finished or of another run; a folder that cannot
/// be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let found = find(&arguments.shards)?;
    are_whole(&found, &arguments.shards)?;
    let out = arguments.out.as_deref().map(|path| (path, arguments.force));
    match found[0].header.run.command.as_str() {
        carried::COMMAND => of_study(&found, arguments, json),
        map::COMMAND => super::map::merge(&found, &arguments.shards, out, json),
        trial::COMMAND => super::trial::shard::merge(&found, &arguments.shards, out, json),
        other => {
            let cause = format!("the shards are of `{other}`, which this version does not know how to merge");
            Err(Error::new("could not merge", cause, "use the version of proofmass that wrote them"))
        }
    }
}

fn of_study(found: &[Found], arguments: &Arguments, json: bool) -> Result<()> {
    let request = || output::Request {
        command: "merge",
        inputs: arguments.shards.clone(),
        reads: found.iter().map(|f| f.path.clone()).collect(),
        writes: answer::FILES.map(str::to_owned).into_iter().chain(numbers::files(false)).collect(),
        force: arguments.force,
        keeps: false,
    };
    let control = progress::terminal();
    let study = carried::study(found, &control)?;
    if let Some(motion) = &study.in_motion {
        let out = arguments.out.as_deref().map(|path| (path, request()));
        return in_motion::merge(&study, motion, found, out, json);
    }
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, request())).transpose()?;
    let drift = study::merged(&study, found, &control)?;
    answer::print(&study, &drift, answer::Beside::default(), Some(found.len()), json)?;
    if let Some(mut folder) = folder {
        answer::write(&mut folder, &study, &drift, answer::Beside::default())?;
        if !json {
            answer::point_to(folder.path())?;
        }
    }
    Ok(())
}
