//! The layer table of `lib.rs` holds: imports run one way, heavy crates have one owner, every file says what it is.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::world::{check, test};

/// Lowest first. A module may import its own layer and those below.
const LAYERS: [&[&str]; 12] = [
    &["units", "error", "document", "progress"],
    &["numerics"],
    &["rng", "statistics"],
    &["sensor", "excitation", "recording", "navigation", "dynamics"],
    &["kernel", "study"],
    &["backend"],
    &["ensemble", "drift"],
    &["diagnosis"],
    &["map", "paper", "trial", "validation", "benchmark"],
    &["report"],
    &["cli"],
    &["main", "lib"],
];

/// Crate, and the places that may name it.
const OWNERS: [(&str, &[&str]); 3] =
    [("wgpu", &["src/backend/gpu"]), ("naga", &["src/kernel/source"]), ("plotters", &["src/report/figure"])];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("architecture: imports run one way", imports_run_one_way),
        test("architecture: the import check sees an upward import", an_upward_import_is_seen),
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

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.contains(&module))
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

fn upward(own: &str, text: &str) -> Vec<String> {
    let Some(height) = layer(own) else { return vec![format!("{own} stands in no layer")] };
    imports(text).into_iter().filter(|m| layer(m).is_some_and(|h| h > height)).collect()
}

fn imports_run_one_way() -> Result<(), Failed> {
    for (path, text) in sources() {
        let wrong = upward(&module(&path), &text);
        check(wrong.is_empty(), format!("{} imports from above: {}", path.display(), wrong.join(", ")))?;
    }
    Ok(())
}

fn an_upward_import_is_seen() -> Result<(), Failed> {
    check(upward("numerics", "use crate::{error::Error, report::table};") == ["report"], "the check is blind")
}

fn owners() -> Result<(), Failed> {
    for (path, text) in sources() {
        for (name, places) in OWNERS {
            let named = code(&text).contains(&format!("{name}::"));
            let allowed = places.iter().any(|p| path.to_string_lossy().starts_with(p));
            check(!named || allowed, format!("{} names {name}", path.display()))?;
        }
    }
    Ok(())
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
