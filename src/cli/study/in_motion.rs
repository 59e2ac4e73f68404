//! `proofmass study` of a study with a trajectory.

use std::path::Path;

use super::answer::Extended;
use super::shard;
use crate::interrupted::keep;
use crate::numbers;
use crate::output::{say, sayln};
use crate::sharded::tell;
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::file::Place;
use proofmass_base::shard::gather::Found;
use proofmass_numerics::statistics::jcgm101::Stated;
use proofmass_report::strapdown as page;
use proofmass_report::study::further::terminal;
use proofmass_report::study::jcgm101::sentence;
use proofmass_simulate::decision::digits;
use proofmass_simulate::decision::further::{Further, Questions};
use proofmass_simulate::ensemble::Choice;
use proofmass_simulate::strapdown::answer::{Answer, answer_kept, flight};
use proofmass_simulate::strapdown::backends::run_share;
use proofmass_simulate::strapdown::divided;
use proofmass_simulate::strapdown::document::Document;
use proofmass_simulate::strapdown::kept::Kept;
use proofmass_simulate::strapdown::share::Share;
use proofmass_study::Study;
use proofmass_study::in_motion::InMotion;

const REPORT: &str = "report.html";
const INFLATED: &str = "inflated.toml";

/// Request of the command line.
pub(super) struct Asked<'a> {
    /// The run, as its outputs are listed for a study of one axis.
    pub request: output::Request,
    /// Says whether to go on with one that was stopped.
    pub resume: bool,
    /// Backend to integrate on.
    pub backend: Choice,
    /// Digits to which its last horizontal error is to be stated.
    pub digits: Option<u32>,
    /// Questions about one error of it.
    pub questions: Questions,
    /// Folder of the results.
    pub path: &'a Path,
}

/// Runs it, prints the answer and writes the report.
///
/// # Errors
/// As `study`; there is no stopped run to resume.
pub(super) fn run(asked: Asked<'_>, study: &Study, motion: &InMotion, json: bool) -> Result<()> {
    let Asked { request, resume, backend, digits, questions, path } = asked;
    let mut kept = match resume {
        true => Kept::resume(path, &study.identity)?,
        false => Kept::new(path, &study.identity),
    };
    let mut folder = Folder::open(path, files(motion, request))?;
    keep(&mut folder, resume)?;
    let control = progress::terminal();
    let answer = answer_kept(study, motion, backend, &mut kept, &control)?;
    let stated = digits.and_then(|digits| digits::stated_in_motion(&answer, digits));
    let further = questions.answer(study, &control)?;
    let beside = Beside { stated: stated.as_ref(), further: &further };
    print(study, &answer, beside, None, json)?;
    write(&mut folder, study, &answer, beside)?;
    if !json {
        sayln!("report:     {}", path.join(REPORT).display())?;
    }
    kept.forget()
}

/// The request for the files of an answer: those of a study of one axis, without its figures.
fn files(motion: &InMotion, asked: output::Request) -> output::Request {
    let inflated = motion.flown.is_some().then_some(INFLATED);
    let numbers = asked.writes.into_iter().filter(|file| numbers::announces(file));
    let writes = [REPORT].into_iter().chain(inflated).map(str::to_owned).chain(numbers).collect();
    output::Request { writes, ..asked }
}

/// Answers next to the drift, where they were asked for.
#[derive(Clone, Copy)]
struct Beside<'a> {
    /// The last horizontal error to a number of digits.
    stated: Option<&'a Stated>,
    /// Answers to questions about one error of it.
    further: &'a Further,
}

fn print(study: &Study, answer: &Answer, beside: Beside<'_>, shards: Option<usize>, json: bool) -> Result<()> {
    let Beside { stated, further } = beside;
    if json {
        let document = Document::of(study, answer, page::findings(answer));
        let document = document.with_digits(stated.cloned()).with_shards(shards);
        return match further.is_empty() {
            true => sayln!("{}", to_json(&document)?),
            false => sayln!("{}", to_json(&Extended { document, shards: None, further })?),
        };
    }
    say(format_args!("{}", page::terminal(answer)))?;
    stated.map_or(Ok(()), |stated| sayln!("{}", sentence("Horizontal", stated)))?;
    terminal(further).iter().try_for_each(|text| say(format_args!("\n{text}")))
}

fn write(folder: &mut Folder, study: &Study, answer: &Answer, beside: Beside<'_>) -> Result<()> {
    let page = page::page(study, answer, beside.stated, beside.further);
    numbers::write(folder, REPORT, page)?;
    if let Some(inflated) = page::inflated_toml(study, answer) {
        folder.write(INFLATED, inflated.as_bytes())?;
    }
    folder.finish()
}

/// Integrates a shard and says where its state is.
///
/// # Errors
/// As [`shard::run`].
pub(super) fn shard(study: &Study, motion: &InMotion, request: &shard::Request<'_>, json: bool) -> Result<()> {
    let header = divided::header(study, motion, request.input, request.shard)?;
    let place = Place::take(request.out, &header, request.force)?;
    let path = place.path().to_path_buf();
    let share = match request.resume {
        true => Share::resume(place, &header)?,
        false => Share::new(place, header.clone()),
    };
    run_share(request.backend, &flight(study, motion)?, share, &progress::terminal())?;
    tell(&header, "", &path, json)
}

/// Puts shards together, prints the answer and, where it is to be written, writes the report.
///
/// # Errors
/// As [`divided::merged`]; a folder that cannot be written.
pub(crate) fn merge(
    study: &Study,
    motion: &InMotion,
    found: &[Found],
    out: Option<(&Path, output::Request)>,
    json: bool,
) -> Result<()> {
    let open = |(path, request)| Folder::open(path, files(motion, request));
    let folder = out.map(open).transpose()?;
    let answer = divided::merged(study, motion, found, &progress::terminal())?;
    let beside = Beside { stated: None, further: Further::NONE };
    print(study, &answer, beside, Some(found.len()), json)?;
    if let Some(mut folder) = folder {
        write(&mut folder, study, &answer, beside)?;
        if !json {
            sayln!("report:     {}", folder.path().join(REPORT).display())?;
        }
    }
    Ok(())
}
