//! The blind trial is blind, its scoring can tell an oracle from a coin, and a stopped trial loses
//! nothing.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::candidate::Kind;
use proofmass::diagnosis::verdict::{self, Verdict};
use proofmass::recording::Recording;
use proofmass::rng::{Philox, Stream};
use proofmass::trial::ask::Files;
use proofmass::trial::blind::{self, Verdicts};
use proofmass::trial::campaign::Campaign;
use proofmass::trial::case::{Case, Family};
use proofmass::trial::outcome::Outcome;
use proofmass::trial::physics::Physics;
use proofmass::trial::plan::Plan;
use proofmass::trial::real;
use proofmass::trial::said::{Ending, Said};
use rand::RngExt;

use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trial: no use path leads from the diagnosis to the generator", blind_by_imports),
        test("trial: the diagnosis gets a recording and a base model, no truth", files_tell_nothing),
        test("trial: an oracle scores full marks and a coin does not", controls),
        test("trial: a stopped trial resumes with what it has, on the same seal only", resume),
        test("trial: a list of recordings that would count against the diagnosis is refused", recipes),
    ]
}

const PLAN: Plan = Plan { seed: 3, cases: 60, samples: 600, campaign: Campaign::Concealed };

fn cases() -> Vec<Case> {
    PLAN.families().into_iter().enumerate().map(|(n, (family, nth))| PLAN.draw(n, family, nth)).collect()
}

fn blind_by_imports() -> Result<(), Failed> {
    let taken = super::architecture::imports()?.taken();
    let top = |module: &[String]| module.first().cloned().unwrap_or_default();
    let reach = |start: &str| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![start.to_owned()]);
        while let Some(module) = open.pop() {
            if reached.insert(module.clone()) {
                open.extend(taken.iter().filter(|t| top(&t.by) == module).map(|t| top(&t.from)));
            }
        }
        reached
    };
    let from_diagnosis = reach("diagnosis");
    check(!from_diagnosis.contains("trial"), format!("diagnosis reaches {from_diagnosis:?}"))?;
    // Negative control: the walk does find the way that exists, from the command to the generator.
    check(reach("cli").contains("trial"), "the walk sees nothing")?;
    // The other way round, the generator calls no numerics that the fitting uses; its page may.
    let is_generator = |module: &[String]| top(module) == "trial" && module.get(1).is_none_or(|room| room != "page");
    let numerics = taken.iter().find(|t| is_generator(&t.by) && top(&t.from) == "numerics");
    check(numerics.is_none(), format!("the generator takes {numerics:?}"))
}

fn files_tell_nothing() -> Result<(), Failed> {
    for case in cases() {
        let folder = tempfile::tempdir()?;
        let files = case.write(folder.path())?;
        check(std::fs::read_dir(folder.path())?.count() == 2, "more than two files")?;
        let model = std::fs::read_to_string(&files.model)?;
        for id in case.planted() {
            check(!model.contains(&id), format!("model.toml of case {} names {id}", case.number))?;
        }
        let model = proofmass::diagnosis::model::read(&files.model)?;
        let recording = proofmass::diagnosis::model::read_recording(&files.recording, &model, &Control::silent())?;
        let rows = std::fs::read_to_string(&files.recording)?.lines().count() - 1;
        check(recording.samples() == rows, "rows are missing")?;
    }
    Ok(())
}

fn said(outcome: Ending, groups: Vec<Vec<String>>) -> Said {
    Said { outcome, groups, numbers: vec![], rmse: [2.0, 1.0, 1.0], seconds: 0.1, words: String::new() }
}

fn oracle(case: &Case) -> Said {
    match (case.planted(), case.in_library()) {
        (ids, _) if ids.is_empty() => said(Ending::Adequate, vec![]),
        (_, false) => said(Ending::Unexplained, vec![]),
        (ids, true) => said(Ending::Explained, ids.into_iter().map(|id| vec![id]).collect()),
    }
}

fn controls() -> Result<(), Failed> {
    let cases = cases();
    let verdicts =
        |speak: &mut dyn FnMut(&Case) -> Said| -> Verdicts { cases.iter().map(|c| (c.number, speak(c))).collect() };
    let best = Outcome::of(&cases, &verdicts(&mut oracle), "seal");
    near("named by the oracle", best.named_correctly, 1.0, 0.0)?;
    near("false alarms of the oracle", best.false_alarm_rate.value, 0.0, 0.0)?;
    near("flagged by the oracle", best.unknown_flagged, 1.0, 0.0)?;
    check(best.families.iter().all(|f| f.named_correctly == 1.0), "a family without full marks")?;

    // Negative control: a name drawn at random is right one time in 21 and alarms at every null.
    let mut rng = Philox::new(1, 0, Stream::Host);
    let mut coin = |_: &Case| {
        said(Ending::Explained, vec![vec![Physics::LIBRARY[rng.random_range(0..Physics::LIBRARY.len())].id()]])
    };
    let worst = Outcome::of(&cases, &verdicts(&mut coin), "seal");
    check(worst.named_correctly < 0.25, format!("a coin is right {} of the time", worst.named_correctly))?;
    near("false alarms of the coin", worst.false_alarm_rate.value, 1.0, 0.0)?;
    near("flagged by the coin", worst.unknown_flagged, 0.0, 0.0)?;

    // Silence is no merit: nothing is found, and no limit either.
    let mut mute = |_: &Case| said(Ending::Adequate, vec![]);
    let silent = Outcome::of(&cases, &verdicts(&mut mute), "seal");
    near("named in silence", silent.named_correctly, 0.0, 0.0)?;
    check(silent.detection_limit.iter().all(|l| l.effect_over_noise.is_none()), "silence has a detection limit")?;

    // Ties: two with the truth among them count, three do not, and neither does a tie without the
    // truth.
    let single = cases.iter().find(|c| c.family == Family::SingleFivePercent).ok_or("no single case")?;
    let truth = single.planted()[0].clone();
    let mark = |group: &[&str]| {
        let group = group.iter().map(|g| (*g).to_owned()).collect();
        proofmass::trial::judge::judge(single, &said(Ending::Undecidable, vec![group])).is_named()
    };
    check(mark(&[&truth, "other"]), "a tie of two with the truth is right")?;
    check(!mark(&[&truth, "other", "third"]), "a tie of three is not")?;
    check(!mark(&["other", "third"]), "a tie without the truth is not")
}

fn adequate(files: &Files) -> Verdict {
    let score = verdict::Score { rmse_before: 1.0, rmse_after: None, ratio_ci95: None, share: None };
    Verdict {
        schema: verdict::SCHEMA,
        kind: Kind::Driven,
        verdict: verdict::Outcome::Adequate,
        sentence: "Nothing is missing.".into(),
        recording: verdict::RecordingInfo::of(&Recording { path: files.recording.clone(), ..Recording::default() }),
        base: Vec::new(),
        effects: Vec::new(),
        location: verdict::Where::default(),
        fit: verdict::Fit {
            unit: "y".into(),
            noise_floor: 1.0,
            noise: None,
            train: score,
            test: score,
            test_ranges: Vec::new(),
            recordings: Vec::new(),
            log_score: None,
            with_unnamed: None,
            one_step_rmse: None,
        },
        residual_after: verdict::Whiteness { white: true, p_value: 0.5 },
        thermal: None,
        calibration: None,
        detectable: Vec::new(),
        next_experiment: String::new(),
        findings: Vec::new(),
        trace: None,
    }
}

fn resume() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let plan = Plan { seed: 8, cases: 17, samples: 500, campaign: Campaign::Concealed };
    let (sealed, cases) = blind::prepare(plan, folder.path(), false, &Control::silent())?;
    let state = folder.path().join("verdicts.jsonl");
    let asked = AtomicUsize::new(0);
    let subject = |files: &Files| {
        asked.fetch_add(1, Ordering::Relaxed);
        Ok(adequate(files))
    };
    let half = &cases[..cases.len() / 2];
    blind::run(half, &sealed, &state, Verdicts::new(), &subject, &Control::silent())?;
    // A line that was being written when the power went, in the middle of a letter; and one that is
    // no text at all.
    let whole = std::fs::read(&state)?;
    let torn = [&whole[..], "{\"seal\":\"×".as_bytes().split_last().ok_or("empty")?.1, b"\n\xff\xfe\n"].concat();
    std::fs::write(&state, torn)?;
    let (again, same) = blind::prepare(plan, folder.path(), true, &Control::silent())?;
    check(again == sealed && same == cases, "the truth was drawn anew")?;
    let (done, unread) = blind::earlier(&state, &sealed)?;
    check(unread == 2, format!("{unread} lines are said to be torn, and 2 are"))?;
    check(done.len() == half.len(), format!("{} of {} verdicts kept", done.len(), half.len()))?;
    let all = blind::run(&cases, &sealed, &state, done, &subject, &Control::silent())?;
    check(all.len() == cases.len(), "not every case has a verdict")?;
    check(asked.load(Ordering::Relaxed) == cases.len(), "a verdict was asked for twice")?;
    check(blind::earlier(&state, &sealed)?.0.len() == cases.len(), "the state file lost a verdict")?;
    let (other, _) = blind::prepare(Plan { seed: 9, ..plan }, tempfile::tempdir()?.path(), false, &Control::silent())?;
    check(blind::earlier(&state, &other)?.0.is_empty(), "verdicts of another truth were taken")
}

fn recipes() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [recipe, model] = ["list.toml", "model.toml"].map(|name| folder.path().join(name));
    std::fs::write(&model, "kind = \"driven\"\n")?;
    let one = "[[recording]]\nname = \"a\"\nfile = \"a.csv\"\nmodel = \"model.toml\"\n\
               truth = [\"cubic-stiffness|power-law-stiffness\"]\nsource = \"me\"\n";
    let read = |text: &str| -> Result<String, Failed> {
        std::fs::write(&recipe, text)?;
        Ok(real::read(&recipe).map_or_else(|error| error.to_string(), |_| "read".into()))
    };
    // Control: as it stands it is read.
    check(read(one)? == "read", read(one)?)?;
    for (text, words) in [
        (one.replace("cubic-stiffness", "cubic-stifness"), "did you mean `cubic-stiffness`?"),
        (format!("{one}also = [\"nothing-like-it\"]\n"), "`nothing-like-it` is no effect"),
        (format!("{one}numbers = [{{ id = \"cubic-stiffness\", name = \"beta\", value = nan }}]\n"), "beta is NaN"),
        (format!("{one}rows = [50, 20]\n"), "end before they begin"),
        (format!("{one}{one}"), "a name of its own"),
        (one.replace("\"a\"", "\"…\""), "a name of its own"),
        (one.replace("model.toml", "absent.toml"), "absent.toml"),
    ] {
        let said = read(&text)?;
        check(said.contains(words), format!("{words}: {said}"))?;
    }
    Ok(())
}
