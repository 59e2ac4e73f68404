//! References that know one half of a pose alone.

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::Outcome;
use proofmass::report::diagnosis::worded;

use super::super::world::{check, near, test};
use super::flight::{Files, base, effect, ids, made_up};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: attitude alone shows the gyro's scale and says what it cannot show", attitude),
        test("trajectory: of a file with both halves the model may take attitude alone", taken),
    ]
}

/// Headings of stamp and attitude.
const ATTITUDE: [&str; 2] = ["timestamp", "q_RS"];
const UNTOLD: &str =
    "a reference of attitude alone says nothing about lever-arm or accelerometer-bias of the accelerometer";

fn attitude() -> Result<(), Failed> {
    for seed in [1, 6] {
        let flight = made_up(seed)?;
        let none = flight.files().with_columns(&ATTITUDE).diagnosed()?;
        check(ids(&none).is_empty() && none.outcome == Outcome::Adequate, format!("seed {seed}: {:?}", ids(&none)))?;
        check(none.base.iter().all(|e| !e.name.starts_with("accelerometer")), "a bias of the accelerometer is stated")?;
        near("bias", base(&none, "gyro_bias_y")?.value, -0.02, 1e-4)?;
        let verdict = worded(none).verdict;
        check(verdict.findings.iter().any(|f| f.starts_with(UNTOLD)), format!("{:?}", verdict.findings))?;
        let scaled = flight.with_rate(|w| w.map(|v| v * 1.004)).files().with_columns(&ATTITUDE).diagnosed()?;
        let names = ids(&scaled);
        check(names.len() == 1 && names.contains("scale-factor"), format!("seed {seed}: {names:?}"))?;
        for p in &effect(&scaled, "scale-factor")?.parameters {
            near(&p.name, p.value, 4000.0, 500.0)?;
            check(p.ci95[0] < 4000.0 && p.ci95[1] > 4000.0, format!("{}: {:?}", p.name, p.ci95))?;
        }
    }
    let both = worded(made_up(1)?.diagnosed()?).verdict;
    check(!both.findings.iter().any(|f| f.starts_with(UNTOLD)), "a reference with both halves is said to lack one")
}

fn taken() -> Result<(), Failed> {
    let flight = made_up(1)?;
    let files = flight.files();
    // Positions that are of no use.
    let spoilt = flight.with_erring_reference(0.0, 0.05).files();
    let used = "file = \"reference.csv\"\nuse = \"attitude\"";
    let model = files.model.replace("file = \"reference.csv\"", used);
    let answer = Files { model, ..spoilt.clone() }.diagnosed()?;
    check(ids(&answer).is_empty() && answer.outcome == Outcome::Adequate, format!("{:?}", ids(&answer)))?;
    check(ids(&spoilt.diagnosed()?).contains("reference-noise"), "the positions are of use after all")
}
