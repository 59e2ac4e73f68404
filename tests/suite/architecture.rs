//! What Cargo does not hold: the table of `lib.rs` names every module once, imports run one way
//! within a crate too and never in a circle, heavy crates have one owner, the maps in module docs name what exists, every file says what it is.

mod circles;
mod imports;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::world::{check, test};
use imports::{Imports, Module, ROOT, Taken, module_of};

/// The modules of the table in `lib.rs`, lowest layer first and each layer from left to right: a
/// module may import those before it.
fn table() -> Vec<String> {
    let rows = read("src/lib.rs");
    let rows = rows.lines().filter_map(|l| l.strip_prefix("//! | ")).filter(|l| l.starts_with('`'));
    rows.flat_map(|row| quoted(row.split('|').nth(1).unwrap_or_default())).chain(["main".to_owned()]).collect()
}

/// The words in back-ticks.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap_or_default()
}

/// Crate, and the places that may name it.
const OWNERS: [(&str, &[&str]); 4] = [
    ("wgpu", &["src/simulate/backend/gpu"]),
    ("naga", &["src/kernel/source"]),
    ("plotters", &["src/report/figure"]),
    ("rayon", &["src/base/parallel", "src/trial/workers"]),
];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("architecture: imports run one way", imports_run_one_way),
        test("architecture: no file, and no room of a folder, imports in a circle", no_circles),
        test("architecture: a name taken is found however it is written", names_are_found),
        test(
            "architecture: the checks see an upward import, a circle, a stray crate, a module in no table",
            what_is_wrong_is_seen,
        ),
        test("architecture: the tables of lib.rs and README hold every module once", tables_are_whole),
        test("architecture: chains in module docs name modules, in the order of their imports", chains_are_true),
        test("architecture: heavy crates have one owner", owners),
        test("architecture: every file opens with a module doc", module_docs),
        test("architecture: docs begin with a verb, a noun or a sentence, not with a clause", docs_begin_well),
        test("architecture: comments have one word for one thing, as CONTRIBUTING lists them", one_word_for_one_thing),
        test("architecture: diagnosis cannot reach the trial's generator", diagnosis_is_blind),
    ]
}

fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.join("src")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                files.push((path.strip_prefix(root).unwrap_or(&path).to_owned(), text));
            }
        }
    }
    files
}

/// The names that files of this crate take from one another.
///
/// # Errors
/// Files that are not Rust.
pub fn imports() -> Result<Imports, Failed> {
    let sources = sources();
    check(sources.len() > 100, format!("{} files", sources.len()))?;
    Ok(Imports::read(&sources)?)
}

/// The top-level module of a file; the crate's root belongs to none.
fn top(module: &Module) -> Option<&str> {
    module.first().map(String::as_str)
}

/// The modules of the facade, each once.
fn modules(imports: &Imports) -> BTreeSet<&str> {
    imports.modules().filter_map(|m| top(m)).filter(|m| !m.ends_with(ROOT)).collect()
}

/// Names taken from a module that the table has further on.
fn upward<'a>(table: &[String], taken: &'a BTreeSet<Taken>) -> Vec<&'a Taken> {
    let height = |module: &Module| table.iter().position(|m| Some(m.as_str()) == top(module));
    let is_upward = |t: &&Taken| height(&t.by).zip(height(&t.from)).is_some_and(|(by, from)| from > by);
    taken.iter().filter(is_upward).collect()
}

fn imports_run_one_way() -> Result<(), Failed> {
    let (table, imports) = (table(), imports()?);
    check(table.len() > 25, format!("the table of lib.rs holds {} modules", table.len()))?;
    for module in modules(&imports) {
        check(table.iter().any(|m| m == module), format!("{module} stands in no layer"))?;
    }
    let taken = imports.taken();
    let wrong = upward(&table, &taken);
    let words = wrong.iter().map(|t| format!("{} takes {} from {}", t.by.join("/"), t.name, t.from.join("/")));
    check(wrong.is_empty(), format!("imports from above: {}", words.collect::<Vec<_>>().join("; ")))
}

fn no_circles() -> Result<(), Failed> {
    let imports = imports()?;
    let taken = imports.taken();
    check(taken.len() > 1000, format!("only {} names are taken", taken.len()))?;
    let is_folder = |m: &Module| !imports.children(m).is_empty();
    for arrows in [circles::among_files(&taken), circles::among_rooms(&taken, is_folder)] {
        if let Some(circle) = circles::find(&arrows) {
            return Err(circles::in_words(&circle, &taken).into());
        }
    }
    Ok(())
}

/// Files of a made-up crate.
fn made_up(files: &[(&str, &str)]) -> Result<BTreeSet<Taken>, Failed> {
    let files: Vec<(PathBuf, String)> = files.iter().map(|(path, text)| (path.into(), (*text).to_owned())).collect();
    Ok(Imports::read(&files)?.taken())
}

fn names_are_found() -> Result<(), Failed> {
    let below = [
        ("src/lib.rs", "pub mod a; pub mod b; pub mod c; pub mod d;"),
        ("src/b.rs", "mod deep; pub use deep::Passed; pub struct B; pub mod inner { pub struct I; }"),
        ("src/b/deep.rs", "pub struct Passed; pub fn f() {}"),
        ("src/c.rs", "pub struct C; pub fn g() {} pub fn h() {} pub fn k() {}"),
        ("src/d.rs", "pub struct D;"),
    ];
    let text = r##"
        //! crate::d::D in words
        use crate::{b::{self, B}, c::{C as Sea}};
        #[cfg(test)]
        use crate::d::D;
        use super::b::Passed;
        pub use crate::d::D as PassedOn;
        // crate::d::D
        fn f() -> &'static str { crate::c::g(); vec![super::c::h()]; b::inner::I; "crate::d::D" }
        #[cfg(test)]
        mod tests { use crate::d::D; }
        mod own { fn f() { super::super::c::k() } }
    "##;
    let taken = made_up(&[&below[..], &[("src/a.rs", text)]].concat())?;
    let found: Vec<String> =
        taken.iter().filter(|t| t.by == ["a"]).map(|t| format!("{}::{}", t.from.join("::"), t.name)).collect();
    let expected = ["b::B", "b::inner", "b::deep::Passed", "c::C", "c::g", "c::h", "c::k"];
    check(found == expected, format!("found {found:?}, expected {expected:?}"))?;
    check(taken.iter().all(|t| t.by == ["a"]), "a re-export, or a `mod` line, is taken for an import")
}

/// The owned crate that a file names without being its place.
fn stray(path: &Path, imports: &Imports) -> Option<&'static str> {
    let foreign = imports.foreign(path);
    let named = OWNERS.iter().find(|(name, places)| {
        let allowed = places.iter().any(|p| path.to_string_lossy().starts_with(p));
        !allowed && foreign.contains(name)
    });
    named.map(|(name, _)| *name)
}

fn owners() -> Result<(), Failed> {
    let imports = imports()?;
    for (path, _) in sources() {
        let stray = stray(&path, &imports);
        check(stray.is_none(), format!("{} names {}", path.display(), stray.unwrap_or_default()))?;
    }
    for (name, places) in OWNERS {
        let named = |(path, _): &(PathBuf, String)| {
            places.iter().any(|p| path.starts_with(p) || path.with_extension("").starts_with(p))
                && imports.foreign(path).contains(name)
        };
        check(sources().iter().any(named), format!("nothing names {name} where it belongs: the check sees nothing"))?;
    }
    Ok(())
}

/// Modules that a table does not hold exactly once.
fn not_once<'a>(table: &[String], modules: &BTreeSet<&'a str>) -> Vec<&'a str> {
    modules.iter().copied().filter(|module| table.iter().filter(|m| m == module).count() != 1).collect()
}

fn tables_are_whole() -> Result<(), Failed> {
    let imports = imports()?;
    let all = modules(&imports);
    let readme = read("README.md");
    let map = readme.split("## Map of `src/`").nth(1).unwrap_or_default();
    let map: Vec<String> = map
        .lines()
        .filter(|l| l.starts_with("| `"))
        .flat_map(|l| quoted(l.split('|').nth(1).unwrap_or_default()))
        .chain(["main".to_owned()])
        .collect();
    for (table, what) in [(table(), "lib.rs"), (map, "README.md")] {
        let wrong = not_once(&table, &all);
        check(wrong.is_empty(), format!("the table of {what} does not hold once: {}", wrong.join(", ")))?;
        let gone = table.iter().find(|m| !all.contains(m.as_str()));
        check(gone.is_none(), format!("the table of {what} holds {gone:?}, which is no module"))?;
    }
    Ok(())
}

/// Chains like "`a` → `b`" in a module doc, each as its names.
fn chains(text: &str) -> Vec<Vec<String>> {
    let doc: Vec<&str> = text.lines().map_while(|l| l.strip_prefix("//!")).map(str::trim).collect();
    let mut chains: Vec<Vec<String>> = Vec::new();
    let mut goes_on = false;
    for (i, part) in doc.join(" ").split('`').enumerate() {
        match (i % 2 == 1, goes_on) {
            (true, true) => chains.last_mut().into_iter().for_each(|c| c.push(part.to_owned())),
            (true, false) => chains.push(vec![part.to_owned()]),
            (false, _) => goes_on = part.trim() == "→",
        }
    }
    chains.retain(|c| c.len() > 1);
    chains
}

/// What is wrong with a chain in the doc of a module: a name that is no module there, or an import
/// against its direction.
fn wrong_in_chain(module: &Module, chain: &[String], imports: &Imports, taken: &BTreeSet<Taken>) -> Option<String> {
    let children = imports.children(module);
    if let Some(gone) = chain.iter().find(|name| !children.contains(*name)) {
        return Some(format!("the doc of {} names {gone}, which is no module there", module.join("/")));
    }
    let link = |of: &Module| {
        let child = of.strip_prefix(module.as_slice())?.first()?;
        chain.iter().position(|name| name == child)
    };
    let against = taken.iter().find(|t| link(&t.by).zip(link(&t.from)).is_some_and(|(by, from)| by < from))?;
    Some(format!("{} takes {} from {}, later in the chain", against.by.join("/"), against.name, against.from.join("/")))
}

fn chains_are_true() -> Result<(), Failed> {
    let (imports, mut seen) = (imports()?, 0);
    let taken = imports.taken();
    for (path, text) in sources() {
        for chain in chains(&text) {
            seen += 1;
            let wrong = wrong_in_chain(&module_of(&path), &chain, &imports, &taken);
            check(wrong.is_none(), wrong.unwrap_or_default())?;
        }
    }
    check(seen > 0, "no module doc has a chain: the check sees nothing")
}

fn what_is_wrong_is_seen() -> Result<(), Failed> {
    let files = |low: &str, high: &str| {
        vec![
            ("src/lib.rs".into(), "pub mod physics; pub mod report;".to_owned()),
            ("src/physics.rs".into(), format!("//! `low` → `high`\nmod low; mod high; pub struct N; {low}")),
            ("src/physics/low.rs".into(), format!("pub struct L; {high}")),
            ("src/physics/high.rs".into(), "use super::low::L; pub struct H;".to_owned()),
            ("src/report.rs".into(), "use crate::physics::N; pub struct R; use plotters::prelude;".to_owned()),
        ]
    };
    let read = |low: &str, high: &str| -> Result<(Imports, BTreeSet<Taken>), Failed> {
        let imports = Imports::read(&files(low, high))?;
        let taken = imports.taken();
        Ok((imports, taken))
    };
    let circle = |taken: &BTreeSet<Taken>| {
        let among_rooms = || circles::find(&circles::among_rooms(taken, |_| true));
        circles::find(&circles::among_files(taken)).or_else(among_rooms).map(|c| circles::in_words(&c, taken))
    };
    let chain = ["low", "high"].map(String::from);
    let physics = vec!["physics".to_owned()];
    let wrong = |(imports, taken): &(Imports, BTreeSet<Taken>), chain: &[String]| {
        wrong_in_chain(&physics, chain, imports, taken)
    };

    let sound = read("", "")?;
    check(circle(&sound.1).is_none() && upward(&table(), &sound.1).is_empty(), "a sound crate is accused")?;
    check(chains(&files("", "")[1].1) == [chain.clone()], "a chain is not read")?;
    check(wrong(&sound, &chain).is_none(), "a true chain is accused")?;
    check(wrong(&sound, &["low", "middle"].map(String::from)).is_some(), "a chain may name what does not exist")?;

    let (_, taken) = read("fn f(_: crate::report::R) {}", "")?;
    check(upward(&table(), &taken).len() == 1, "the check of directions is blind")?;
    let against = read("", "fn f(_: super::high::H) {}")?;
    let words = "physics/high takes L from physics/low; physics/low takes H from physics/high";
    check(circle(&against.1).as_deref() == Some(words), format!("a circle is told as {:?}", circle(&against.1)))?;
    check(wrong(&against, &chain).is_some(), "a chain may run backwards")?;
    let (_, taken) = read("use low::L;", "use super::N;")?;
    check(circle(&taken).is_some(), "a circle of a folder with what stands in it is not seen")?;
    let (_, taken) = read("pub use low::L;", "#[cfg(test)] mod tests { use super::super::N; }")?;
    check(circle(&taken).is_none(), "a re-export and a test are taken for a circle")?;
    let rooms = made_up(&[
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a/one.rs", "use crate::b::one::B;"),
        ("src/a/two.rs", "pub struct A;"),
        ("src/b/one.rs", "pub struct B;"),
        ("src/b/two.rs", "use crate::a::two::A;"),
    ])?;
    check(circles::find(&circles::among_files(&rooms)).is_none(), "no two of these files import each other")?;
    check(circle(&rooms).is_some(), "a circle of two rooms is not seen")?;

    check(stray(Path::new("src/report.rs"), &sound.0) == Some("plotters"), "the check of owners is blind")?;
    check(stray(Path::new("src/physics.rs"), &sound.0).is_none(), "one is accused who names no crate")?;
    let (table, all) = (["units", "error", "error"].map(String::from), BTreeSet::from(["error", "units", "rng"]));
    check(not_once(&table, &all) == ["error", "rng"], "the check of tables is blind")
}

fn module_docs() -> Result<(), Failed> {
    for (path, text) in sources() {
        check(text.starts_with("//!"), format!("{} has no module doc", path.display()))?;
    }
    Ok(())
}

fn diagnosis_is_blind() -> Result<(), Failed> {
    let taken = imports()?.taken();
    let seen = taken.iter().find(|t| top(&t.by) == Some("diagnosis") && top(&t.from) == Some("trial"));
    check(
        seen.is_none(),
        seen.map(|t| format!("{} takes {} from the trial", t.by.join("/"), t.name)).unwrap_or_default(),
    )
}

/// The doc comments of a file that begin with a clause that has no main verb; a question is a sentence.
fn clauses(text: &str) -> Vec<String> {
    let doc = |line: &str| {
        let line = line.trim();
        line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).map(|words| words.trim().to_owned())
    };
    let lines: Vec<Option<String>> = text.lines().map(doc).collect();
    let begins = |at: &usize| lines[*at].is_some() && at.checked_sub(1).is_none_or(|before| lines[before].is_none());
    let opening = |at: usize| -> String {
        let paragraph = lines[at..].iter().map_while(|line| line.as_ref().filter(|words| !words.is_empty()));
        paragraph.cloned().collect::<Vec<String>>().join(" ")
    };
    let is_clause = |doc: &String| {
        let first = doc.split(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
        let is_question = doc.find(['.', '?']).is_some_and(|end| doc[end..].starts_with('?'));
        ["What", "Whether", "How", "Where", "As"].contains(&first) && !is_question
    };
    (0..lines.len()).filter(begins).map(opening).filter(is_clause).collect()
}

/// Words that the list in CONTRIBUTING.md replaces and that have one meaning in a comment.
const REPLACED: [&str; 5] = ["beside", "takes up", "turned by hand", "kept back", "remainder"];

/// Comments with a word that another one replaces; names of modules stand in backticks.
fn replaced(text: &str) -> Vec<String> {
    let has = |line: &&str| {
        let words: Vec<&str> = line.split('`').step_by(2).collect();
        let words = words.join(" ").to_lowercase().replace(|c: char| !c.is_alphanumeric(), " ");
        REPLACED.iter().any(|word| format!(" {words} ").contains(&format!(" {word} ")))
    };
    text.lines().map(str::trim).filter(|line| line.starts_with("//")).filter(has).map(str::to_owned).collect()
}

fn one_word_for_one_thing() -> Result<(), Failed> {
    for (path, text) in sources() {
        let wrong = replaced(&text);
        check(wrong.is_empty(), format!("{}: {}", path.display(), wrong.join("; ")))?;
    }
    // Negative controls.
    let bad = "/// What noise Takes up,\n// beside it.\nlet beside = 1;\n//! See `remainder`, besides.\n";
    check(replaced(bad).len() == 2, format!("{:?}", replaced(bad)))
}

fn docs_begin_well() -> Result<(), Failed> {
    for (path, text) in sources() {
        let wrong = clauses(&text);
        check(wrong.is_empty(), format!("{}: {}", path.display(), wrong.join("; ")))?;
    }
    // Negative controls: a clause is seen in both kinds of doc, at the beginning alone, and a question
    // or a verb is none.
    let bad = "//! How it is done.\n\n/// What it holds,\n/// and more.\n/// Where it is, too.\nfn a() {}\n";
    check(clauses(bad).len() == 2, format!("{:?}", clauses(bad)))?;
    check(
        clauses("/// How far\n/// is it?\n/// Returns what it holds.\n").is_empty(),
        "a sentence is taken for a clause",
    )
}
