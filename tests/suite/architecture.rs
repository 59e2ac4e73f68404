//! The layer table of `lib.rs` holds: imports run one way, heavy crates have one owner, every file says what it is.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::world::{check, test};

/// The layers of the table in `lib.rs`, lowest first. A module may import its own layer and those below.
fn layers() -> Vec<Vec<String>> {
    let rows = read("src/lib.rs");
    let rows =
        rows.lines().filter_map(|l| l.strip_prefix("//! | ")).filter(|l| l.starts_with(|c: char| c.is_numeric()));
    let mut layers: Vec<Vec<String>> = rows.map(|row| quoted(row.split('|').nth(1).unwrap_or_default())).collect();
    layers.push(vec!["main".into(), "lib".into()]);
    layers
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
    ("wgpu", &["src/backend/gpu"]),
    ("naga", &["src/kernel/source"]),
    ("plotters", &["src/report/figure"]),
    ("rayon", &["src/parallel", "src/trial/workers"]),
];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("architecture: imports run one way", imports_run_one_way),
        test(
            "architecture: the checks see an upward import, a stray crate, a module in no table",
            what_is_wrong_is_seen,
        ),
        test("architecture: the tables of lib.rs and README hold every module once", tables_are_whole),
        test("architecture: heavy crates have one owner", owners),
        test("architecture: every file opens with a module doc", module_docs),
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

/// The height of a module in the table.
fn layer(layers: &[Vec<String>], module: &str) -> Option<usize> {
    layers.iter().position(|layer| layer.iter().any(|m| m == module))
}

/// The top-level module a file belongs to.
fn module(path: &Path) -> String {
    let second = path.components().nth(1).map(|c| c.as_os_str().to_string_lossy().into_owned()).unwrap_or_default();
    second.trim_end_matches(".rs").to_owned()
}

/// Code only: comments, and tests inside the file, may name anything.
fn code(text: &str) -> String {
    let before_tests = text.split("#[cfg(test)]").next().unwrap_or(text);
    before_tests.lines().filter(|l| !l.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

fn imports(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for rest in code(text).split("crate::").skip(1) {
        let mut take = |word: &str| {
            let name: String = word.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            found.push(name);
        };
        match rest.strip_prefix('{') {
            // use crate::{a::b, c}: only the names at the first depth.
            Some(list) => {
                let mut depth = 0;
                let mut start = true;
                for (i, c) in list.char_indices() {
                    if start && !c.is_whitespace() {
                        take(&list[i..]);
                        start = false;
                    }
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => start = true,
                        _ => {}
                    }
                }
            }
            None => take(rest),
        }
    }
    found
}

fn upward(layers: &[Vec<String>], own: &str, text: &str) -> Vec<String> {
    let Some(height) = layer(layers, own) else { return vec![format!("{own} stands in no layer")] };
    imports(text).into_iter().filter(|m| layer(layers, m).is_some_and(|h| h > height)).collect()
}

fn imports_run_one_way() -> Result<(), Failed> {
    let (layers, sources) = (layers(), sources());
    check(layers.len() > 10 && sources.len() > 100, format!("{} layers, {} files", layers.len(), sources.len()))?;
    for (path, text) in sources {
        let wrong = upward(&layers, &module(&path), &text);
        check(wrong.is_empty(), format!("{} imports from above: {}", path.display(), wrong.join(", ")))?;
    }
    Ok(())
}

/// The owned crate that a file names without being its place.
fn stray(path: &Path, text: &str) -> Option<&'static str> {
    let named = OWNERS.iter().find(|(name, places)| {
        let allowed = places.iter().any(|p| path.to_string_lossy().starts_with(p));
        !allowed && code(text).contains(&format!("{name}::"))
    });
    named.map(|(name, _)| *name)
}

fn owners() -> Result<(), Failed> {
    for (path, text) in sources() {
        let stray = stray(&path, &text);
        check(stray.is_none(), format!("{} names {}", path.display(), stray.unwrap_or_default()))?;
    }
    Ok(())
}

/// Modules of `lib.rs` that a table does not hold exactly once.
fn not_once(table: &[String], lib: &str) -> Vec<String> {
    let modules = lib.lines().filter_map(|l| l.strip_prefix("pub mod ")).map(|m| m.trim_end_matches(';').to_owned());
    modules.filter(|module| table.iter().filter(|m| *m == module).count() != 1).collect()
}

fn tables_are_whole() -> Result<(), Failed> {
    let lib = read("src/lib.rs");
    let own = layers().concat();
    let readme = read("README.md");
    let map = readme.split("## Map of `src/`").nth(1).unwrap_or_default();
    let map: Vec<String> = map
        .lines()
        .filter(|l| l.starts_with("| `"))
        .flat_map(|l| quoted(l.split('|').nth(1).unwrap_or_default()))
        .collect();
    for (table, what) in [(own, "lib.rs"), (map, "README.md")] {
        let wrong = not_once(&table, &lib);
        check(wrong.is_empty(), format!("the table of {what} does not hold once: {}", wrong.join(", ")))?;
        let gone = table.iter().find(|m| *m != "main" && *m != "lib" && !lib.contains(&format!("pub mod {m};")));
        check(gone.is_none(), format!("the table of {what} holds {gone:?}, which is no module"))?;
    }
    Ok(())
}

fn what_is_wrong_is_seen() -> Result<(), Failed> {
    let upward = upward(&layers(), "numerics", "use crate::{error::Error, report::table};");
    check(upward == ["report"], "the check of imports is blind")?;
    let text = "fn draw() { plotters::element::Circle; }";
    check(stray(Path::new("src/cli/study.rs"), text) == Some("plotters"), "the check of owners is blind")?;
    check(stray(Path::new("src/report/figure/draw.rs"), text).is_none(), "the owner is accused")?;
    let (table, lib) =
        (["units", "error", "error"].map(String::from), "pub mod error;\npub mod units;\npub mod rng;\n");
    check(not_once(&table, lib) == ["error", "rng"], "the check of tables is blind")
}

fn module_docs() -> Result<(), Failed> {
    for (path, text) in sources() {
        check(text.starts_with("//!"), format!("{} has no module doc", path.display()))?;
    }
    Ok(())
}

fn diagnosis_is_blind() -> Result<(), Failed> {
    for (path, text) in sources().into_iter().filter(|(p, _)| module(p) == "diagnosis") {
        check(!imports(&text).iter().any(|m| m == "trial"), format!("{} reaches the trial", path.display()))?;
    }
    Ok(())
}
