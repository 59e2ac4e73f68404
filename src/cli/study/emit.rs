//! `proofmass study --emit slurm|kubernetes --shards N`: the script that has a batch system run the
//! shards and, after them, the merge. Nothing is submitted here.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use clap::builder::PossibleValue;

use crate::output::{say, sayln};
use proofmass_base::error::Result;
use proofmass_base::escape::word;
use proofmass_base::output::{self, Folder};
use proofmass_simulate::ensemble::Choice;
use proofmass_study::Study;

/// For which batch system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A job array, and a job that depends on it.
    Slurm,
    /// An indexed Job, and a Job that tries until all shards are there.
    Kubernetes,
}

impl ValueEnum for Target {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Slurm, Self::Kubernetes]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::Slurm => PossibleValue::new("slurm").help("A job array and a dependent merge, as one shell script"),
            Self::Kubernetes => PossibleValue::new("kubernetes").help("An indexed Job and a merge, as one manifest"),
        })
    }
}

/// Describes the run that the script starts.
pub(super) struct Request<'a> {
    /// Batch system that the script is for.
    pub target: Target,
    /// Number of shards.
    pub shards: u64,
    /// The study's file, where it has one.
    pub input: Option<&'a Path>,
    /// Says where the shards and the report go.
    pub out: &'a Path,
    /// Says whether the script goes there too, instead of to stdout.
    pub written: bool,
    /// Backend that each shard integrates on.
    pub backend: Choice,
    /// Further arguments of the study, as given.
    pub arguments: Vec<String>,
    /// Replace a file that is not ours.
    pub force: bool,
}

/// Writes the script, or prints it.
///
/// # Errors
/// When it cannot be written.
pub(super) fn run(study: &Study, request: &Request<'_>) -> Result<()> {
    let name = object_name(&study.name);
    let (file, text) = match request.target {
        Target::Slurm => (format!("{name}.slurm.sh"), slurm(&name, request)),
        Target::Kubernetes => (format!("{name}.kubernetes.yaml"), kubernetes(&name, study, request)),
    };
    if !request.written {
        return say(format_args!("{text}"));
    }
    let mut folder = Folder::open(
        request.out,
        output::Request {
            command: "study --emit",
            inputs: request.input.iter().map(|path| path.to_path_buf()).collect(),
            writes: vec![file.clone()],
            force: request.force,
            ..output::Request::default()
        },
    )?;
    folder.write(&file, text.as_bytes())?;
    folder.finish()?;
    sayln!("{}", request.out.join(file).display())
}

/// A name as both systems take it: small letters, digits and hyphens, letters at both ends.
fn object_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let name: String = name.chars().map(plain).take(40).collect();
    match name.trim_matches('-') {
        "" => "study".into(),
        name if name.starts_with(|c: char| c.is_ascii_digit()) => format!("study-{name}"),
        name => name.into(),
    }
}

fn full(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

/// `--backend` and what else was given.
fn arguments(request: &Request<'_>) -> Vec<String> {
    let backend = (request.backend != Choice::Auto).then(|| request.backend.name().to_owned());
    backend.into_iter().flat_map(|name| ["--backend".into(), name]).chain(request.arguments.iter().cloned()).collect()
}

fn slurm(name: &str, request: &Request<'_>) -> String {
    let study = request.input.map(|path| full(path).display().to_string());
    let words: Vec<String> = study.into_iter().chain(arguments(request)).map(|text| word(&text).into_owned()).collect();
    format!(
        r#"#!/bin/bash
# {name} in {shards} shards: a Slurm job array, and the merge after it. Written by proofmass {version}.
#   bash {name}.slurm.sh                   submits both; options of sbatch (--partition, --gpus, --time) go into SBATCH_OPTIONS
#   RESUME=1 bash {name}.slurm.sh          resumes shards that were stopped
#   SLURM_ARRAY_TASK_ID=3 bash {name}.slurm.sh shard     one shard without Slurm; `merge` instead of `shard` merges them
set -euo pipefail
PROOFMASS=${{PROOFMASS:-proofmass}}
OUT={out}
SHARDS={shards}
ARGUMENTS=({words})

case "${{1:-submit}}" in
submit)
  mkdir -p "$OUT"
  read -ra options <<<"${{SBATCH_OPTIONS:-}}"
  array=$(sbatch --parsable --job-name={name} --array=1-"$SHARDS" --requeue --export=ALL \
    --output="$OUT/shard-%a.log" ${{options[@]+"${{options[@]}}"}} "$0" shard)
  merge=$(sbatch --parsable --job-name={name}-merge --dependency=afterok:"${{array%%;*}}" --kill-on-invalid-dep=yes \
    --export=ALL --output="$OUT/merge.log" ${{options[@]+"${{options[@]}}"}} "$0" merge)
  echo "shards: job $array; merge: job $merge; report: $OUT/report.html"
  ;;
shard)
  shard=${{SLURM_ARRAY_TASK_ID:?is the number of the shard}}
  resume=()
  # A task that Slurm has requeued, or that is to resume, continues where it stopped.
  if [[ ${{RESUME:-${{SLURM_RESTART_COUNT:-0}}}} != 0 && -e "$OUT/shard-$shard-of-$SHARDS.state" ]]; then
    resume=(--resume)
  fi
  exec "$PROOFMASS" study "${{ARGUMENTS[@]+"${{ARGUMENTS[@]}}"}}" --shard "$shard/$SHARDS" --out "$OUT" "${{resume[@]+"${{resume[@]}}"}}"
  ;;
merge)
  exec "$PROOFMASS" merge "$OUT" --out "$OUT"
  ;;
*)
  echo "use submit, shard or merge, not $1" >&2
  exit 2
  ;;
esac
"#,
        version = env!("CARGO_PKG_VERSION"),
        shards = request.shards,
        out = word(&full(request.out).display().to_string()),
        words = words.join(" "),
    )
}

fn kubernetes(name: &str, study: &Study, request: &Request<'_>) -> String {
    let indented: String = study.text.lines().map(|line| format!("    {line}\n")).collect();
    // The document holds the changes already, but for the two that have flags of their own.
    let backend = arguments(&Request { arguments: Vec::new(), ..*request });
    let numbers = ["--members".into(), study.members.to_string(), "--seed".into(), study.seed.to_string()];
    let words: Vec<String> = backend.into_iter().chain(numbers).map(|text| word(&text).into_owned()).collect();
    let recordings: Vec<String> = study.reads.iter().map(|path| path.display().to_string()).collect();
    let recordings = match recordings.is_empty() {
        true => String::new(),
        false => format!(
            "# The study reads {}: copy it to the volume, under the path that the study gives, relative to the \
            volume's root.\n",
            recordings.join(", ")
        ),
    };
    let head = |job: &str| format!("apiVersion: batch/v1\nkind: Job\nmetadata:\n  name: {job}\n");
    let container = |script: &str| {
        format!(
            r#"          image: "proofmass:{version}"
          command: ["/bin/sh", "-euc"]
          args:
            - |
{script}
          resources:
            requests: {{ cpu: "1", memory: "1Gi" }}
            # limits: {{ nvidia.com/gpu: "1" }}
          volumeMounts:
            - {{ name: data, mountPath: /data }}
            - {{ name: study, mountPath: /data/{name}.toml, subPath: study.toml }}
      volumes:
        - {{ name: data, persistentVolumeClaim: {{ claimName: proofmass }} }}
        - {{ name: study, configMap: {{ name: {name}-study }} }}
"#,
            version = env!("CARGO_PKG_VERSION"),
        )
    };
    let shard = format!(
        r#"              shard=$((JOB_COMPLETION_INDEX + 1))
              # A pod that replaces another continues where that one stopped.
              resume=""
              if [ -e "/data/{name}/shard-$shard-of-{shards}.state" ]; then resume=--resume; fi
              exec proofmass study /data/{name}.toml {words} --shard "$shard/{shards}" --out /data/{name} $resume"#,
        shards = request.shards,
        words = words.join(" "),
    );
    let merge = format!("              exec proofmass merge /data/{name} --out /data/{name}");
    format!(
        r#"# {name} in {shards} shards: an indexed Job, and the merge after it. Written by proofmass {version}.
#   kubectl apply -f {name}.kubernetes.yaml
# It takes an image `proofmass:{version}` with the program in its path, and a claim `proofmass` on a volume that several nodes
# may write (ReadWriteMany). Shards and report go into the folder {name} of that volume; one from an earlier, different
# study of this name must be removed first.
{recordings}apiVersion: v1
kind: ConfigMap
metadata:
  name: {name}-study
data:
  study.toml: |2
{indented}---
{shard_head}spec:
  completions: {shards}
  parallelism: {shards}
  completionMode: Indexed
  backoffLimit: {retries}
  template:
    spec:
      restartPolicy: OnFailure
      containers:
        - name: shard
{shard_container}---
# Until all shards are there the merge ends with an error and is retried, at most every five minutes.
{merge_head}spec:
  backoffLimit: 100000
  template:
    spec:
      restartPolicy: OnFailure
      containers:
        - name: merge
{merge_container}"#,
        shards = request.shards,
        version = env!("CARGO_PKG_VERSION"),
        retries = 6 * request.shards,
        shard_head = head(name),
        shard_container = container(&shard),
        merge_head = head(&format!("{name}-merge")),
        merge_container = container(&merge),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_suit_both_systems_and_words_any_shell() {
        assert_eq!(object_name("My Study_2."), "my-study-2");
        assert_eq!((object_name("…"), object_name("3x")), ("study".into(), "study-3x".into()));
        assert_eq!(word("it's"), r"'it'\''s'");
    }
}
