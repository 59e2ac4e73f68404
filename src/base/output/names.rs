//! Names within a folder of results: those of states and of results that the program gives itself,
//! and those that lead out of the folder.

use std::path::{Component, Path};

/// Names of the files of what parts of a study have summed up, written in intervals and when it is
/// stopped.
pub const INTERRUPTED: &str = "interrupted-*.json";

/// Files that change while a run goes on; `*` is any text. A manifest that lists another is not of
/// this program's making.
pub const STATES: [&str; 3] = [INTERRUPTED, "truth.json", "verdicts.jsonl"];

/// Results whose names the program chooses, those of `export` included. A manifest is a file that
/// anybody can write, so a result that a run no longer has is removed under these names alone.
const RESULTS: &[&str] = &[
    "*.html",
    "*.svg",
    "check.json",
    "experiment.csv",
    "fast_lio.yaml",
    "imu.parm",
    "imu.sdf",
    "imu.yaml",
    "imu_err.py",
    "imu_noise.m",
    "imu_noise.py",
    "inflated.toml",
    "kalibr_imu_chain.yaml",
    "kf-gins.yaml",
    "map-*.csv",
    "next.csv",
    "numbers/*.csv",
    "numbers/*.parquet",
    "orb_slam3.yaml",
    "params.yaml",
    "plan.json",
    "power.json",
    "px4_imu.sdf",
    "repaired.toml",
    "sensor-*.toml",
    "sensor.toml",
    "settings.json",
    "study.toml",
    "summary.md",
    "sweep.csv",
    "trial.json",
    "truth.json",
    "uncorrected.toml",
    "verdict.json",
    "vins.yaml",
];

/// Returns true where a name is that of a pattern, which may hold one `*` for any text within a
/// folder.
pub fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, end)) => {
            name.len() >= start.len() + end.len()
                && name.starts_with(start)
                && name.ends_with(end)
                && !name[start.len()..name.len() - end.len()].contains('/')
        }
    }
}

/// Returns true where the program itself gives a result this name.
pub fn is_result(name: &str) -> bool {
    RESULTS.iter().any(|pattern| matches(pattern, name))
}

/// Returns true where a name, read as text, stays within the folder.
pub fn is_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// Returns true where a folder between this one and the file is a link, so that the file lies
/// somewhere else.
pub fn crosses_link(folder: &Path, name: &str) -> bool {
    let below = Path::new(name).ancestors().skip(1).filter(|part| !part.as_os_str().is_empty());
    below
        .map(|part| folder.join(part))
        .any(|path| std::fs::symlink_metadata(path).is_ok_and(|about| about.is_symlink()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_is_any_text_within_a_folder_and_no_star_the_name() {
        let parts = "interrupted-*.json";
        assert!(matches(parts, "interrupted-12.json") && matches("truth.json", "truth.json"));
        assert!(!matches(parts, "interrupted-.jso") && !matches("truth.json", "truth.jsonl"));
        assert!(!matches("a-*-a", "a-a") && !matches("*.svg", "home/a.svg") && matches("a/*.svg", "a/b.svg"));
    }

    #[test]
    fn results_are_told_from_files_of_the_users() {
        assert!(["report.html", "numbers/drift.csv", "study.toml", "map-2.csv"].into_iter().all(is_result));
        assert!(!["thesis.tex", "model.toml", "log.csv", "d/report.html", ".bashrc"].into_iter().any(is_result));
    }
}
