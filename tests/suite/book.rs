//! The verdict book: its lines, its resumption and division, and what its comparison calls worse.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::{Answer, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("book: the same cases have the same verdicts, and a book with worse marks is called worse", book)]
}

/// Fields of a line, as the contract names them, and the mark.
const FIELDS: [&str; 13] = [
    "case",
    "cpu_s",
    "family",
    "gates",
    "held",
    "kind",
    "mark",
    "names",
    "parameters",
    "shares",
    "ties",
    "truth",
    "verdict",
];

/// Nulls of three kinds, which cost little; a rule of the search acts in the last two.
const CASES: &str = "1-1,1-2,1-5,1-8,1-13,1-21,1-27,1-32,1-40,1-112,1-115";

fn write(folder: &Path, more: &[&str]) -> Result<Answer, Failed> {
    run(program().args(["--json", "trial", "--book"]).arg(folder).args(["--only", CASES]).args(more))
}

fn lines(folder: &Path) -> Result<Vec<Value>, Failed> {
    let text = std::fs::read_to_string(folder.join("book.jsonl"))?;
    text.lines().map(|line| Ok(serde_json::from_str(line)?)).collect()
}

/// Everything but what it cost.
fn timeless(mut lines: Vec<Value>) -> Vec<Value> {
    lines.iter_mut().filter_map(Value::as_object_mut).for_each(|line| drop(line.remove("cpu_s")));
    lines
}

fn book() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    let (first, again) = (path("first"), path("again"));
    let whole = write(&first, &[])?.json()?;
    let book = lines(&first)?;
    let wanted = CASES.split(',').count();
    check(whole["cases"] == wanted && book.len() == wanted, whole.to_string())?;
    for line in &book {
        let mut fields: Vec<&str> = line.as_object().ok_or("no object")?.keys().map(String::as_str).collect();
        fields.sort_unstable();
        check(fields == FIELDS, format!("fields {fields:?}"))?;
        check(line["cpu_s"].as_f64().is_some_and(|s| s > 0.0), format!("costs nothing: {line}"))?;
    }
    // Divided, the second half stopped in the middle of a line, put together and gone on with.
    for shard in ["1/2", "2/2"] {
        write(&again, &["--shard", shard])?.json()?;
    }
    let half = again.join("shard-2-of-2/verdicts.jsonl");
    let bytes = std::fs::read(&half)?;
    std::fs::write(&half, &bytes[..bytes.len() - 20])?;
    let against = ["--resume", "--against", &first.display().to_string()];
    let same = write(&again, &against)?;
    let document = same.json()?;
    check(timeless(lines(&again)?) == timeless(book.clone()), "divided and resumed, another book")?;
    check(document["against"]["changed"] == Value::Array(Vec::new()), document["against"].to_string())?;
    check(document["against"]["rows"][0]["cases"] == wanted, "not all were compared")?;
    // Control: eight right marks turned into false names are worse; the other way round, better.
    let right = book.iter().filter(|line| line["mark"] == "right").count();
    check(right >= 8, format!("only {right} of {wanted} are right: the control would be empty"))?;
    let worse = path("worse");
    std::fs::create_dir(&worse)?;
    let text = std::fs::read_to_string(first.join("book.jsonl"))?;
    std::fs::write(worse.join("verdicts.jsonl"), text.replace("\"mark\":\"right\"", "\"mark\":\"confidently-wrong\""))?;
    let called = write(&worse, &against)?;
    check(called.code == Some(1), format!("a worse book ends with {:?} {}", called.code, called.stderr))?;
    let document: Value = serde_json::from_str(&called.stdout)?;
    check(document["against"]["rows"][0]["is_worse"] == true, document["against"].to_string())?;
    let better = run(program()
        .args(["trial", "--book"])
        .arg(&again)
        .args(["--only", CASES])
        .args(["--resume", "--against"])
        .arg(&worse))?;
    check(better.code == Some(0), format!("a better book ends with {:?} {}", better.code, better.stderr))?;
    let said = better.stdout;
    check(said.contains("(confidently wrong) → ") && said.contains("processor time of the verdicts"), said)?;
    // Rules that acted are each asked for once more, and no others.
    let resumed = ["--resume", "--ablate"];
    let ablated = run(program().args(["--json", "trial", "--book"]).arg(&first).args(["--only", CASES]).args(resumed))?;
    let document = ablated.json()?;
    let gates = document["gates"].as_array().ok_or("no gates")?.clone();
    check(gates.len() > 30, format!("{} gates", gates.len()))?;
    for gate in &gates {
        let is_in = |line: &&Value| line["gates"].as_array().is_some_and(|all| all.contains(&gate["gate"]));
        let acted = book.iter().filter(is_in).count();
        check(gate["acted"] == acted, format!("acted in {acted} lines: {gate}"))?;
    }
    check(gates.iter().any(|gate| gate["acted"] != 0), "no rule acted: the comparison would be empty")?;
    let table = std::fs::read_to_string(first.join("gates.md"))?;
    check(table.lines().filter(|line| line.starts_with("| `")).count() == gates.len(), table)?;
    // What is not there is refused before an hour of work.
    run(program().args(["trial", "--book"]).arg(path("new")).arg("--against").arg(path("none")))?
        .refuses("no other book", "there is no book.jsonl")?;
    run(program().args(["trial", "--book"]).arg(path("new")).args(["--only", "7-7"]))?
        .refuses("a case of another seed", "has none of that name")?;
    check(!path("new").exists(), "what was refused left a folder")
}
