//! `proofmass trial`: how often the diagnosis is right, on cases whose truth is sealed until the
//! last verdict.

mod answer;
mod book;
mod independent;
mod kept;
mod planned;
mod recording_atlas;
pub(super) mod shard;

use std::path::{Path, PathBuf};

use super::diagnose::gate;
use super::launcher::refuse_ranks;
use super::numbers;
use super::output::{remark, say, sayln};
use answer::{FILES, Run, STATES};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::Shard;
use proofmass_diagnosis::gate::Gate;
use proofmass_diagnosis::recordings::Recordings;
use proofmass_diagnosis::verdict::Verdict;
use proofmass_diagnosis::{self as diagnosis, model};
use proofmass_report::diagnosis::worded;
use proofmass_trial::ask::{Files, Subject};
use proofmass_trial::blind::{self, Verdicts};
use proofmass_trial::campaign::Campaign;
use proofmass_trial::divided::COMMAND;
use proofmass_trial::independent::truth::Kind;
use proofmass_trial::judge;
use proofmass_trial::like;
use proofmass_trial::outcome::Outcome;
use proofmass_trial::page as report;
use proofmass_trial::plan::Plan;
use proofmass_trial::real::{self, Found, Recipe};
use proofmass_trial::scratch::Scratch;

/// Arguments of `trial`.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// Folder for the sealed truth, verdicts, report.html, trial.json, summary.md and figures
    #[arg(long, value_name = "DIR", group = "folder")]
    pub out: Option<PathBuf>,
    /// Write the verdict book to DIR: a line of book.jsonl for each case of a fixed corpus; with
    /// --recordings, for real recordings as well
    #[arg(long, value_name = "DIR", group = "folder",
        conflicts_with_all = ["parquet", "quick", "planted", "independent", "cases", "samples", "like", "case"])]
    pub book: Option<PathBuf>,
    /// Compare the book with the one in DIR; exits with 1 where false names rose or right marks
    /// fell beyond chance. With --resume a finished book is compared as it is
    #[arg(long, value_name = "DIR", requires = "book")]
    pub against: Option<PathBuf>,
    /// Part of the book's cases, the same of each kind, family and sub-family
    #[arg(long, value_name = "F", requires = "book", default_value_t = 1.0, allow_negative_numbers = true)]
    pub sample: f64,
    /// Only these cases of the book, by their names up to the colon, e.g. 1-17,1-23
    #[arg(long, value_name = "LIST", requires = "book", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Then ask each verdict of the book again without each rule that acted in it, and write what
    /// each rule is worth to gates.md
    #[arg(long, requires = "book", conflicts_with = "shard")]
    pub ablate: bool,
    /// Rules that never act (ids as in gates.md): for measuring what they are worth
    #[arg(long, value_name = "GATE", requires = "book", conflicts_with = "resume", value_delimiter = ',', hide = true,
        value_parser = gate)]
    pub without: Vec<Gate>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "folder")]
    pub force: bool,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long, requires = "out")]
    pub parquet: bool,
    /// Fewer and shorter recordings: at most two minutes instead of twenty
    #[arg(long)]
    pub quick: bool,
    /// Unconcealed effects: each candidate alone at 1 % and 5 % of the output, two at once, unknown
    /// physics, 300 recordings with nothing planted; 20,000 rows each
    #[arg(long, conflicts_with = "quick")]
    pub planted: bool,
    /// Cases of a second generator, mostly outside the library: modified laws, unknown physics,
    /// real noise; driven, at rest and hand-rotated
    #[arg(long, conflicts_with_all = ["planted", "like", "recordings"])]
    pub independent: bool,
    /// Experiments that `plan` proposes, for sensors whose first recording leaves laws tied: how often they
    /// decide, and as promised
    #[arg(long, conflicts_with_all = ["planted", "independent", "like", "recordings", "samples", "book", "shard",
        "parquet"])]
    pub plan: bool,
    /// Only cases of this kind of the second generator: driven, static, tumble, or response, whose
    /// stepped-sine sweeps no other trial has; the number of a --case says its kind
    #[arg(long, value_name = "KIND", requires = "independent", conflicts_with = "case", value_parser = kind)]
    pub kind: Option<Kind>,
    /// Resume the trial in --out, or the book
    #[arg(long, requires = "folder")]
    pub resume: bool,
    /// Approximate number of recordings
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub cases: Option<usize>,
    /// Seed of all random draws
    #[arg(long, value_name = "S", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Number of rows of each recording
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub samples: Option<usize>,
    /// Detection limits of this recording: plant every candidate into copies of it (needs --model)
    #[arg(long, value_name = "RECORDING", requires = "model")]
    pub like: Option<PathBuf>,
    /// The model.toml of that recording
    #[arg(long, value_name = "MODEL", requires = "like")]
    pub model: Option<PathBuf>,
    /// Also diagnose the real recordings that this file lists (data from PROOFMASS_DATA or
    /// ../shared/data)
    #[arg(long, value_name = "RECIPE")]
    pub recordings: Option<PathBuf>,
    /// Write pages on the real recordings that this file lists to --out, one a set, an index and one
    /// on the random walk: numbers, intervals and verdicts, no samples (data as with --recordings)
    #[arg(long, value_name = "RECIPE", requires = "out", conflicts_with_all = ["book", "quick", "planted",
        "independent", "plan", "resume", "cases", "samples", "like", "recordings", "shard", "case", "parquet"])]
    pub atlas: Option<PathBuf>,
    /// Run only this part of the cases, e.g. 3/16: writes DIR/shard-3-of-16.state for
    /// `proofmass merge DIR`, or of the book DIR/shard-3-of-16, which the undivided book resumes
    #[arg(long, value_name = "K/N", requires = "folder", conflicts_with_all = ["independent", "like", "case"])]
    pub shard: Option<Shard>,
    /// Run only this case: write its recording, model and truth to --out and print the verdict
    #[arg(long, value_name = "NUMBER", requires = "out", allow_negative_numbers = true)]
    pub case: Option<usize>,
}

impl Arguments {
    fn campaign(&self) -> Plan {
        let campaign = if self.planted { Campaign::Planted } else { Campaign::Concealed };
        let usual = Plan { seed: self.seed, cases: campaign.size(), samples: campaign.samples(), campaign };
        let usual = if self.quick { Plan::quick(self.seed) } else { usual };
        Plan { cases: self.cases.unwrap_or(usual.cases), samples: self.samples.unwrap_or(usual.samples), ..usual }
    }

    fn command(&self) -> String {
        let mut command = format!("proofmass trial --seed {}", self.seed);
        for (name, given) in [("quick", self.quick), ("planted", self.planted)] {
            if given {
                command += &format!(" --{name}");
            }
        }
        if let Some(recipe) = &self.recordings {
            command += &format!(" --recordings {}", recipe.display());
        }
        for (name, value) in [("cases", self.cases), ("samples", self.samples)] {
            if let Some(value) = value {
                command += &format!(" --{name} {value}");
            }
        }
        command
    }
}

/// The kind of this name.
fn kind(name: &str) -> std::result::Result<Kind, String> {
    let known = || Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| format!("the kinds are {}", known()))
}

/// Runs it.
///
/// # Errors
/// When the folder cannot be written, on Ctrl-C, or when the sealed truth was changed.
pub fn run(arguments: &Arguments, json: bool) -> Result<u8> {
    let control = progress::terminal();
    if let Some(folder) = &arguments.book {
        let folder = folder.clone();
        let Arguments { against, sample, only, shard, recordings, seed, force, resume, ablate, without, .. } =
            arguments.clone();
        let request =
            book::Request { folder, against, sample, only, shard, recordings, seed, force, resume, ablate, without };
        // Many diagnoses run at once: their stages would write over each other.
        let quiet = control.without_stages();
        return book::run(&request, &|files, without| diagnosed(files, without, &quiet), &control, json);
    }
    trial(arguments, json, &control).map(|()| 0)
}

fn trial(arguments: &Arguments, json: bool, control: &Control) -> Result<()> {
    if let (Some(recording), Some(model)) = (&arguments.like, &arguments.model) {
        return like(recording, model, arguments, json, control);
    }
    if arguments.independent {
        let Arguments { out, force, quick, resume, cases, seed, samples: rows, case, kind, .. } = arguments.clone();
        let place = kept::Place { out, force, resume };
        let request = independent::Request { place, quick, cases, seed, rows, case, kind };
        return independent::run(&request, &tool(control), json, control);
    }
    if let (Some(recipe), Some(out)) = (arguments.atlas.clone(), arguments.out.clone()) {
        let request = recording_atlas::Request { recipe, out, force: arguments.force };
        return recording_atlas::run(&request, &tool(control), control, json);
    }
    if arguments.plan {
        let Arguments { out, force, quick, resume, cases, seed, case, .. } = arguments.clone();
        let place = kept::Place { out, force, resume };
        let request = planned::Request { place, quick, cases, seed, case };
        return planned::run(&request, &tool(control), json, control);
    }
    let plan = arguments.campaign();
    if !(1..=1_000_000).contains(&plan.cases) || !(500..=10_000_000).contains(&plan.samples) {
        let cause = format!("{} cases of {} samples", plan.cases, plan.samples);
        return Err(Error::new("could not plan the trial", cause, "use at least one case and 500 samples"));
    }
    if let (Some(number), Some(path)) = (arguments.case, &arguments.out) {
        return one(&plan, number, path, arguments.force, json, &tool(control));
    }
    if let (Some(shard), Some(out)) = (arguments.shard, &arguments.out) {
        if arguments.recordings.is_some() {
            let cause = "the real recordings of a trial are not divided";
            return Err(Error::new("could not divide the trial", cause, "leave --recordings out, or use --book"));
        }
        let request = shard::Request { plan, shard, out, force: arguments.force, resume: arguments.resume };
        return shard::run(&request, &tool(control), control, json);
    }
    refuse_ranks(COMMAND)?;
    let recipe = arguments.recordings.as_deref().map(real::read).transpose()?;
    let mut kept = arguments.out.as_deref().map(|path| keep(path, arguments, recipe.as_ref())).transpose()?;
    if let Some(kept) = &mut kept {
        STATES.iter().try_for_each(|name| kept.state(name, arguments.resume))?;
    }
    let scratch = Scratch::new(arguments.out.as_deref())?;
    let folder = arguments.out.as_deref().unwrap_or(scratch.path());
    let (sealed, cases) = blind::prepare(plan, folder, arguments.resume, control)?;
    remark!("sealed truth of {} cases, SHA-256 {}", cases.len(), sealed.sha256);
    let state = folder.join(STATES[1]);
    let (done, unread) = if arguments.resume { blind::earlier(&state, &sealed)? } else { (Verdicts::new(), 0) };
    if unread > 0 {
        remark!("note: {unread} lines of {} cannot be read; their cases are run again", state.display());
    }
    if !arguments.resume && state.exists() {
        std::fs::remove_file(&state).map_err(|e| Error::io("replace", &state, &e))?;
    }
    let verdicts =
        blind::run(&cases, &sealed, &state, done, &tool(control), control).map_err(|error| match arguments.out {
            Some(_) => error,
            // The folder is a scratch one and goes with the process.
            None => Error { hint: "run it again; with --out DIR finished verdicts would be kept".into(), ..error },
        })?;
    // Only now is the envelope opened; what is judged is what was sealed, not what is in memory.
    let truth = sealed.open()?;
    let outcome = Outcome::of(&truth.cases, &verdicts, &sealed.sha256);
    let real = recordings(recipe.as_ref(), &scratch, control)?;
    let run = Run { plan: &plan, outcome: &outcome, cases: &truth.cases, verdicts: &verdicts, real: &real };
    answer::give(&run, &arguments.command(), kept, &[], json)
}

/// The folder of a trial; to resume one, there must be one.
fn keep(path: &Path, arguments: &Arguments, recipe: Option<&Recipe>) -> Result<Folder> {
    if arguments.resume && !path.join(STATES[0]).is_file() {
        return Err(Error::new(
            "could not resume",
            format!("no trial in {}", path.display()),
            "leave --resume out to start over, or give the --out of the interrupted trial",
        ));
    }
    let models = recipe.iter().flat_map(|recipe| &recipe.recording).map(|real| real.model.clone());
    let request = output::Request {
        command: "trial",
        reads: arguments.recordings.iter().cloned().chain(models).collect(),
        writes: FILES.map(str::to_owned).into_iter().chain(numbers::files(arguments.parquet)).collect(),
        force: arguments.force,
        ..output::Request::default()
    };
    Folder::open(path, request)
}

/// The real recordings of the recipe, where both it and the data are there.
fn recordings(recipe: Option<&Recipe>, scratch: &Scratch, control: &Control) -> Result<Vec<Found>> {
    let Some(recipe) = recipe else { return Ok(Vec::new()) };
    let Some(data) = real::folder() else {
        remark!("no folder of recordings (set PROOFMASS_DATA): the real recordings are left out");
        return Ok(Vec::new());
    };
    real::run(recipe, &data, &tool(control), scratch)
}

/// Plants into copies of a user's recording.
fn like(recording: &Path, model: &Path, arguments: &Arguments, json: bool, control: &Control) -> Result<()> {
    let request = || output::Request {
        command: "trial --like",
        inputs: vec![recording.into(), model.into()],
        writes: ["power.json", "power.html"]
            .map(str::to_owned)
            .into_iter()
            .chain(numbers::files(arguments.parquet))
            .collect(),
        force: arguments.force,
        ..output::Request::default()
    };
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, request())).transpose()?;
    let power = like::power(recording, model, arguments.quick, arguments.seed, &tool(control), control)?;
    let document = to_json(&power)?;
    let written = folder.map_or(Ok(()), |mut folder| {
        folder.write("power.json", document.as_bytes())?;
        numbers::write(&mut folder, "power.html", report::like::page(&power))?;
        folder.finish()
    });
    if json {
        sayln!("{document}")?;
    } else {
        say(format_args!("{}", report::like::terminal(&power)))?;
    }
    written
}

/// Reproduces one case of a plan.
fn one(plan: &Plan, number: usize, path: &Path, force: bool, json: bool, subject: &Subject<'_>) -> Result<()> {
    let families = plan.families();
    let Some((family, nth)) = families.get(number).copied() else {
        let cause = format!("the trial has cases 0 to {}", families.len() - 1);
        return Err(Error::new(
            format!("could not make case {number}"),
            cause,
            "give --seed and --cases of that trial",
        ));
    };
    let names = ["recording.csv", "model.toml", "truth.json"];
    let request = output::Request {
        command: "trial --case",
        writes: names.map(str::to_owned).into(),
        force,
        ..output::Request::default()
    };
    let mut folder = Folder::open(path, request)?;
    let case = plan.draw(number, family, nth);
    let [recording, model] = case.texts();
    for (name, text) in names.into_iter().zip([recording, model, to_json(&case)?]) {
        folder.write(name, text.as_bytes())?;
    }
    folder.finish()?;
    drop(folder);
    let scratch = Scratch::new(None)?;
    if json {
        let said = blind::ask(&case, subject, &scratch)?;
        let mark = judge::judge(&case, &said).word();
        sayln!("{}", to_json(&serde_json::json!({ "case": case, "said": said, "mark": mark }))?)?;
        return Ok(());
    }
    sayln!("case {number}: {}", family.name())?;
    for (id, size) in case.sizes_over_noise() {
        sayln!("planted: {id}, {size:.3} × noise")?;
    }
    sayln!("files: {} and {}", path.join(names[0]).display(), path.join(names[1]).display())?;
    let said = blind::ask(&case, subject, &scratch)?;
    sayln!("said: {} {:?} in {:.1} s\n{}", said.outcome.name(), said.groups, said.seconds, said.words)?;
    sayln!("held out: rmse {:.4e} → {:.4e}, noise floor {:.4e}", said.rmse[0], said.rmse[1], said.rmse[2])?;
    for n in &said.numbers {
        let truth =
            case.parameter(&n.id, &n.channel, &n.name).map_or(String::new(), |t| format!("  (planted {t:.5e})"));
        sayln!("  {} {} = {:.5e} [{:.5e}, {:.5e}]{truth}", n.id, n.name, n.value, n.ci95[0], n.ci95[1])?;
    }
    sayln!("mark: {}", judge::judge(&case, &said).word())?;
    Ok(())
}

/// The tool itself, by the way that `proofmass diagnose` goes.
fn tool(control: &Control) -> impl Fn(&Files) -> Result<Verdict> + Sync {
    // Many diagnoses run at once: their stages would write over each other.
    let control = control.without_stages();
    move |files| diagnosed(files, &[], &control)
}

/// One verdict with its trace, without some rules.
fn diagnosed(files: &Files, without: &[Gate], control: &Control) -> Result<Verdict> {
    let model = model::read(&files.model)?.without(without);
    let train = [model::read_recording(&files.recording, &model, control)?];
    let test: Result<Vec<_>> = files.judging.iter().map(|path| model::read_recording(path, &model, control)).collect();
    let recordings = Recordings { train: &train, test: &test? };
    Ok(worded(diagnosis::diagnose_all(recordings, &model, control)?).with_trace().verdict)
}
