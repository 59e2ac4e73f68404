//! A case for each candidate that a trial plants: the command that writes its recording, and whether the verdict on it
//! names what is in it.

use libtest_mimic::{Failed, Trial};

use super::super::bench::{Bench, run};
use super::super::world::{check, program, test};

/// Kind and id of a candidate, and the words of `proofmass trial` that make a recording in which it alone is planted.
const EXAMPLES: &[(&str, &str, &str)] = &[
    ("driven", "cubic-stiffness", "--case 737"),
    ("driven", "quadratic-stiffness", "--case 860"),
    ("driven", "power-law-stiffness", "--independent --quick --case 195"),
    ("driven", "quadratic-damping", "--case 661"),
    ("driven", "power-law-damping", "--independent --quick --case 41"),
    ("driven", "squeeze-film-damping", "--case 782"),
    ("driven", "coulomb-friction", "--case 906"),
    ("driven", "hysteresis", "--case 709"),
    ("driven", "stiffness-drift", "--case 829"),
    ("driven", "parasitic-mode", "--case 955"),
    ("driven", "coupled-mode", "--case 959"),
    ("driven", "drive-nonlinearity", "--case 751"),
    ("driven", "end-stop", "--case 876"),
    ("driven", "force-noise", "--case 675"),
    ("driven", "readout-saturation", "--case 797"),
    ("driven", "readout-quantisation", "--case 919"),
    ("driven", "readout-delay", "--case 721"),
    ("driven", "readout-lowpass", "--case 845"),
    ("driven", "readout-nonlinearity", "--case 642"),
    ("driven", "feedthrough", "--case 768"),
    ("driven", "input-lag", "--independent --quick --case 273"),
    ("driven", "bias-drift", "--case 890"),
    ("driven", "warm-up", "--case 691"),
    ("driven", "bias-random-walk", "--case 815"),
    ("driven", "periodic-disturbance", "--case 618"),
    ("static", "white-noise", "--case 272"),
    ("static", "quantisation-noise", "--case 240"),
    ("static", "flicker-noise", "--case 523"),
    ("static", "random-walk", "--case 7"),
    ("static", "rate-ramp", "--case 614"),
    ("static", "gauss-markov", "--case 257"),
    ("static", "sinusoid", "--case 381"),
    ("static", "warm-up", "--case 28"),
    ("static", "temperature-sensitivity", "--case 308"),
    ("tumble", "scale-factor", "--case 45"),
    ("tumble", "misalignment", "--case 228"),
    ("tumble", "g-sensitivity", "--case 411"),
    ("tumble", "scale-nonlinearity", "--case 441"),
    ("tumble", "temperature-sensitivity", "--case 146"),
    ("tumble", "earth-rate", "--case 173"),
    ("response", "cubic-stiffness", "--independent --case 200000038"),
    ("response", "quadratic-damping", "--independent --case 200000003"),
    ("response", "squeeze-film-damping", "--independent --case 200000176"),
    ("response", "coulomb-friction", "--independent --case 200000040"),
    ("response", "coupled-mode", "--independent --case 200000045"),
    ("response", "parasitic-mode", "--independent --case 200000201"),
    ("response", "readout-delay", "--independent --case 200000056"),
    ("response", "stiffness-drift", "--independent --case 200000027"),
    ("response", "power-law-stiffness", "--independent --case 200000014"),
];

/// The command that makes the example of a candidate, in a folder named after it; `None` where there is none.
pub fn command(kind: &str, id: &str) -> Option<String> {
    let (.., words) = EXAMPLES.iter().find(|(k, i, _)| (*k, *i) == (kind, id))?;
    Some(format!("proofmass trial {words} --out {kind}-{id}"))
}

/// Why what a trial printed of a case is no example of a candidate: it is planted, and nothing but it is said.
fn wanting(id: &str, printed: &str) -> Option<String> {
    let line = |start: &str| printed.lines().find_map(|line| line.strip_prefix(start)).unwrap_or_default();
    let planted = [line("planted: "), line("present: ")].concat();
    // Of a shape that several candidates have, all of them stand there.
    let names = planted.split(',').next().unwrap_or_default();
    if !names.split(" or ").any(|name| name == id)
        || printed.lines().filter(|line| line.starts_with("planted: ")).count() > 1
    {
        return Some(format!("planted is {planted:?}"));
    }
    let said = line("said: ");
    if !said.starts_with(&format!("explained [[\"{id}\"]]")) {
        return Some(format!("said was {said:?}"));
    }
    let mark = line("mark: ");
    (!["named", "right"].contains(&mark)).then(|| format!("the mark is {mark:?}"))
}

/// One test for each example.
pub fn campaigns() -> Vec<Trial> {
    let of = |(kind, id, words): &'static (&str, &str, &str)| {
        test(&format!("examples: the verdict on the example of {kind} {id} names it"), move || names(kind, id, words))
    };
    EXAMPLES.iter().map(of).collect()
}

fn names(kind: &str, id: &str, words: &str) -> Result<(), Failed> {
    let bench = Bench::new()?;
    let folder = bench.path("example");
    let answer = run(program().arg("trial").args(words.split(' ')).arg("--out").arg(&folder))?;
    check(answer.code == Some(0), format!("{kind} {id}: exit {:?} {}", answer.code, answer.stderr))?;
    let why = wanting(id, &answer.stdout);
    check(why.is_none(), format!("{kind} {id}: {}", why.unwrap_or_default()))?;
    let model = std::fs::read_to_string(folder.join("model.toml"))?;
    let is_of_kind = model.contains(&format!("kind = \"{kind}\""));
    check(is_of_kind && folder.join("recording.csv").is_file(), format!("{kind} {id}: {model}"))?;
    // Control: another name is not the one that was planted, and would not do.
    check(wanting("another-name", &answer.stdout).is_some(), "any name will do")
}
