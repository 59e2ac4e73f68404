//! `proofmass study --sweep`: a study at several values of one or two keys, as a curve or a map.

use std::path::Path;

use super::interrupted::keep;
use super::output::{say, sayln};
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_numerics::statistics::Statistics;
use proofmass_report::sweep as page;
use proofmass_simulate::decision::statistic::Limit;
use proofmass_simulate::decision::sweep::{self, Plan, Summed, Work};
use proofmass_simulate::decision::sweep_document::Document;
use proofmass_simulate::decision::watched::IN_MOTION;
use proofmass_simulate::ensemble::{Backends, Choice, Keeper, Options};
use proofmass_simulate::strapdown::backends::run_on;
use proofmass_study::sweep::Sweep;
use proofmass_study::{Axis, Study, StudyText};

/// Request to `study`.
pub(super) struct Asked<'a> {
    /// The study's file; the default study without one.
    pub study: Option<&'a Path>,
    /// The keys of the command line.
    pub axes: &'a [Axis],
    /// Requirement whose crossing is wanted.
    pub limit: Option<&'a Limit>,
    /// Backend to integrate on.
    pub backend: Choice,
    /// Folder of the results.
    pub out: Option<&'a Path>,
    /// Replace the user's files too.
    pub force: bool,
    /// Go on with a run that was stopped.
    pub resume: bool,
}

/// Plans the sweep: the keys of the command line, else those of the study; nothing where neither
/// names any.
///
/// # Errors
/// More than two keys; an invalid limit, or one without a sweep.
pub(super) fn plan(asked: &Asked<'_>, study: &Study) -> Result<Option<Plan>> {
    let refuse = |cause: String| {
        let hint = "e.g. --sweep gyro.bias_deg_h=1:20:log8 --limit 'p95(position_error_m, 60) < 10'";
        Err(Error::new("could not sweep", cause, hint))
    };
    let swept = match (asked.axes, &study.sweep) {
        ([], None) if asked.limit.is_some() => return refuse("--limit is given without --sweep".into()),
        ([], None) => return Ok(None),
        ([], Some(sweep)) => sweep.clone(),
        (axes, section) => {
            let limit = section.as_ref().and_then(|section| section.limit.clone());
            match (Sweep { axes: axes.to_vec(), limit }).checked() {
                Ok(sweep) => sweep,
                Err(cause) => return refuse(cause),
            }
        }
    };
    let limit = match (asked.limit, &swept.limit) {
        (Some(limit), _) => Some(limit.clone()),
        (None, Some(text)) => match text.parse::<Limit>() {
            Ok(limit) => Some(limit),
            Err(cause) => return refuse(format!("limit = {text:?}: {cause}")),
        },
        (None, None) => None,
    };
    Ok(Some(Plan { axes: swept.axes, limit }))
}

/// Sweeps, prints the answer and writes the report.
///
/// # Errors
/// A value that the study refuses, a backend that is not there, Ctrl-C, a folder that cannot be
/// written.
pub(super) fn run(asked: &Asked<'_>, source: &StudyText, study: &Study, plan: &Plan, json: bool) -> Result<()> {
    let usual = || Path::new("reports").join(format!("{}-sweep", study.name));
    let path = asked.out.map_or_else(usual, Path::to_path_buf);
    let identity = format!("{} {plan:?}", study.identity);
    let mut keeper = match asked.resume {
        true => Keeper::resume(&path, &identity)?,
        false => Keeper::new(&path, &identity),
    };
    let mut folder = Folder::open(&path, outputs(asked, study, plan))?;
    keep(&mut folder, asked.resume)?;
    let options = Options { backend: asked.backend, control: progress::terminal(), ..Options::default() };
    for axis in &plan.axes {
        if source.is_drawn(&axis.key)? {
            options.control.remark(&format!(
                "note: members draw `{0}`; here every member gets the same value. {0}.sd varies the spread.",
                axis.key
            ));
        }
    }
    let mut backends = Backends::default();
    let sweep = sweep::run(source, plan, &options.control, |work| {
        Ok(match work {
            Work::OneAxis(job) => {
                let Statistics { at, failed, .. } = backends.run(job, &options, &mut keeper)?;
                Summed { at: at.into_iter().map(Vec::from).collect(), failed }
            }
            Work::InMotion(flight) => {
                let ensemble = run_on(options.backend, flight, &options.control)?;
                let of = |report: usize| IN_MOTION.map(|(_, q)| ensemble.summary(report, q).clone()).into();
                Summed { at: (0..ensemble.time_s.len()).map(of).collect(), failed: ensemble.failed }
            }
        })
    })?;
    if json {
        sayln!("{}", to_json(&Document::of(study, &sweep))?)?;
    } else {
        say(format_args!("{}", page::terminal(&sweep)))?;
    }
    let written = write(&mut folder, study, &sweep);
    written.map_err(|error| keeper.kept(error))?;
    if !json {
        sayln!("report:     {}", path.join(REPORT).display())?;
    }
    keeper.forget()
}

const REPORT: &str = "report.html";
const TABLE: &str = "sweep.csv";

fn outputs(asked: &Asked<'_>, study: &Study, plan: &Plan) -> output::Request {
    let figures = page::file_names(plan).into_iter().map(str::to_owned);
    output::Request {
        command: "study --sweep",
        inputs: asked.study.iter().map(|path| path.to_path_buf()).collect(),
        reads: study.reads.clone(),
        writes: figures.chain([REPORT, TABLE].map(str::to_owned)).collect(),
        force: asked.force,
        keeps: false,
    }
}

fn write(folder: &mut Folder, study: &Study, sweep: &sweep::Sweep) -> Result<()> {
    for (name, figure) in page::file_names(&sweep.plan).into_iter().zip(page::figures(sweep)) {
        folder.write(name, figure.0.file_svg().as_bytes())?;
    }
    folder.write(TABLE, page::csv(sweep).as_bytes())?;
    folder.write(REPORT, page::page(study, sweep).finish().as_bytes())?;
    folder.finish()
}
