//! The tutorials under `reports/book`: every command that a page shows is run, and prints what stands there; every figure is
//! the one that the run wrote; the reference is what the program says of itself.

mod compare;
mod examples;
mod page;
mod reference;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::bench::Bench;
use super::world::{check, data_test, program, test};
use page::{Page, Shown};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("tutorials: a changed number, word or line is seen, another last digit is not", compare::control),
        test("tutorials: a page that shows a wrong number or misses a line fails (control)", control),
        test("tutorials: the contents name every page once, and every link leads to one", links),
        test("tutorials: the reference is what the program says of itself", reference::is_current),
        test("tutorials: a picture of a candidate that was changed is not replaced", reference::changed_pictures_stay),
    ];
    for (name, path) in pages().unwrap_or_default() {
        let title = format!("tutorials: every command of {name} prints what the page shows");
        let page = match Page::read(&path) {
            Ok(page) => page,
            Err(why) => {
                all.push(test(&title, || Err(why)));
                continue;
            }
        };
        let has = (page.runs().next().is_some(), page.recordings.is_empty());
        match has {
            (false, _) => {}
            (true, true) => all.push(test(&title, move || shows_what_is_printed(&page, None))),
            (true, false) => all.push(data_test(&title, move |data| shows_what_is_printed(&page, Some(data)))),
        }
    }
    all
}

/// The examples of the reference, many verdicts.
pub fn campaigns() -> Vec<Trial> {
    examples::campaigns()
}

/// The folder of the pages.
pub fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/book/src")
}

/// The pages, by their path from the folder of all.
fn pages() -> Result<Vec<(String, PathBuf)>, Failed> {
    let mut found = Vec::new();
    for folder in [source(), source().join("reference")] {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension() == Some(OsStr::new("md")) {
                found.push((path.strip_prefix(source())?.to_string_lossy().replace('\\', "/"), path));
            }
        }
    }
    found.sort();
    Ok(found)
}

/// A command of a page, and what it printed.
struct Ran {
    command: String,
    shown: Vec<String>,
    printed: Vec<String>,
}

/// Writes the files of a page and runs its commands, in the order in which they stand there.
fn ran(page: &Page, bench: &Bench, data: Option<&Path>) -> Result<Vec<Ran>, Failed> {
    for recording in &page.recordings {
        let from = data.ok_or("no folder of recordings")?.join(recording);
        let name = from.file_name().ok_or("a recording without a name")?;
        std::fs::copy(&from, bench.path(&name.to_string_lossy()))?;
    }
    let mut all = Vec::new();
    for shown in &page.shown {
        match shown {
            Shown::File { name, text } => drop(bench.file(name, text)?),
            Shown::Run { command, lines } => {
                let printed = printed(command, bench)?;
                all.push(Ran { command: command.clone(), shown: lines.clone(), printed });
            }
        }
    }
    Ok(all)
}

/// The lines that a command prints, those on standard error among them, as a terminal shows them.
fn printed(command: &str, bench: &Bench) -> Result<Vec<String>, Failed> {
    let mut words = page::words(command);
    if let [head, count, file] = words.as_slice()
        && head == "head"
    {
        let count = count.trim_start_matches('-').parse()?;
        let text = std::fs::read_to_string(bench.path(file))?;
        return Ok(text.lines().take(count).map(str::to_owned).collect());
    }
    check(words.first().is_some_and(|word| word == "proofmass"), format!("the test cannot run: {command}"))?;
    let into = words.iter().position(|word| word == ">").map(|at| words.split_off(at));
    let folder = tempfile::tempdir()?;
    let terminal = folder.path().join("terminal");
    let screen = std::fs::File::create(&terminal)?;
    let mut program = program();
    program.args(&words[1..]).current_dir(bench.path("")).env_remove("COLUMNS").env_remove("PROOFMASS_DATA");
    program.stdin(std::process::Stdio::null()).stderr(screen.try_clone()?);
    match into.as_deref() {
        Some([_, file]) => program.stdout(std::fs::File::create(bench.path(file))?),
        Some(_) => return Err(format!("the test cannot run: {command}").into()),
        None => program.stdout(screen),
    };
    let status = program.status()?;
    let said = std::fs::read_to_string(&terminal)?;
    check(status.success(), format!("{command} ends with {status}: {said}"))?;
    Ok(said.lines().filter(|line| !is_progress(line)).map(str::to_owned).collect())
}

/// States whether a line is what long work writes every ten seconds, `simulating 71 %`: on a fast machine there is none.
fn is_progress(line: &str) -> bool {
    let words: Vec<&str> = line.split(' ').collect();
    let is_name = |words: &[&str]| words.iter().all(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == ','));
    match words.as_slice() {
        [name @ .., "…"] if !name.is_empty() => is_name(name),
        [name @ .., part, "%"] if !name.is_empty() => is_name(name) && part.parse::<u32>().is_ok(),
        _ => false,
    }
}

fn differing(all: &[Ran]) -> Option<String> {
    all.iter().find_map(|ran| {
        let why = compare::lines(&ran.shown, &ran.printed)?;
        Some(format!("$ {}\n{why}\nprinted was:\n{}", ran.command, ran.printed.join("\n")))
    })
}

fn shows_what_is_printed(page: &Page, data: Option<&Path>) -> Result<(), Failed> {
    let bench = Bench::new()?;
    let all = ran(page, &bench, data)?;
    if let Some(why) = differing(&all) {
        return Err(why.into());
    }
    let known = all.iter().flat_map(|ran| ran.printed.iter().map(String::as_str));
    let known = compare::numbers(known.chain([page.by_hand.as_str()]).chain(page.files().flat_map(str::lines)));
    for line in &page.prose {
        let unfounded = compare::unfounded(line, &known);
        check(unfounded.is_empty(), format!("no command prints {}, of: {line}", unfounded.join(" and ")))?;
    }
    for (figure, written) in &page.figures {
        let written = std::fs::read_to_string(bench.path(written))?;
        check(written.len() <= 60 * 1024, format!("{figure} has {} bytes", written.len()))?;
        let path = source().join(figure);
        if reference::is_written_anew() {
            std::fs::write(&path, &written)?;
        }
        if let Some(why) = compare::figures(&std::fs::read_to_string(&path).unwrap_or_default(), &written) {
            return Err(format!("{figure} is another figure: {why}; {}", reference::HOW).into());
        }
    }
    Ok(())
}

/// Every number that the first page shows under its first command, changed by a twentieth and by two of its last digit, fails; so does every
/// line that the program would no longer print.
fn control() -> Result<(), Failed> {
    let mut page = Page::read(&source().join("datasheet.md"))?;
    let first = page.shown.iter().position(|shown| matches!(shown, Shown::Run { .. })).ok_or("no command")?;
    page.shown.truncate(first + 1);
    let bench = Bench::new()?;
    let all = ran(&page, &bench, None)?;
    check(differing(&all).is_none(), "the page itself fails")?;
    let (mut numbers, mut lines) = (0, 0);
    for one in &all {
        for (k, line) in
            one.shown.iter().enumerate().filter(|(_, line)| !line.trim().is_empty() && *line != compare::ANY)
        {
            for wrong in compare::wrong_numbers(line) {
                let mut shown = one.shown.clone();
                shown[k].clone_from(&wrong);
                check(compare::lines(&shown, &one.printed).is_some(), format!("passes: {wrong}"))?;
                numbers += 1;
            }
            let printed: Vec<String> = one.printed.iter().filter(|p| !compare::alike(line, p)).cloned().collect();
            check(compare::lines(&one.shown, &printed).is_some(), format!("passes without: {line}"))?;
            lines += 1;
        }
    }
    check(numbers > 20 && lines > 8, format!("only {numbers} numbers and {lines} lines were tried"))
}

/// Where the links of a page lead, without those to other sites and within the page.
fn targets(text: &str) -> Vec<String> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let inner = links.map(|(target, _)| target).filter(|t| !t.contains("://") && !t.starts_with('#'));
    inner.map(|target| target.split('#').next().unwrap_or_default().to_owned()).collect()
}

fn links() -> Result<(), Failed> {
    let summary = targets(&std::fs::read_to_string(source().join("SUMMARY.md"))?);
    let pages = pages()?;
    for (name, path) in &pages {
        let times = summary.iter().filter(|target| *target == name).count();
        let expected = usize::from(name != "SUMMARY.md");
        check(times == expected, format!("SUMMARY.md names {name} {times} times"))?;
        let folder = path.parent().ok_or("a page without a folder")?;
        for target in targets(&std::fs::read_to_string(path)?) {
            check(folder.join(&target).exists(), format!("{name} links to {target}, which is not there"))?;
        }
    }
    for page in ["README.md", "reports/guide.md"] {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page))?;
        check(text.contains("book/src/SUMMARY.md"), format!("{page} does not lead to the tutorials"))?;
    }
    let with_commands =
        pages.iter().filter(|(_, path)| Page::read(path).is_ok_and(|page| page.runs().next().is_some()));
    let with_commands = with_commands.count();
    check(with_commands >= 6, format!("only {with_commands} pages have commands"))?;
    // Control: a link to nowhere is one.
    let found = targets("[a](b.md#c) ![d](e.svg) [f](https://g) [h](#i)");
    check(found == ["b.md", "e.svg"], format!("{found:?}"))
}
