//! A study is read as it is meant, or refused in a sentence that says what to change.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::drift::compare::{self, Outcome};
use proofmass::error::Error;
use proofmass::kernel::job::Job;
use proofmass::study::{self, Overrides};
use proofmass::units::{MICRO_G, STANDARD_GRAVITY_M_S2};

use super::world::{check, data_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("study: the embedded default reads", || {
            Ok(study::read_default(&Overrides::default(), &Control::silent()).map(drop)?)
        }),
        test("study: every study of this repository reads", committed),
        test("study: datasheet units become SI", units),
        test("study: the paper's m, D0, k, eps give the same proof mass as its modes", mechanics),
        test("study: every excitation reads", excitations),
        test("study: a section left out is an ideal one", ideal),
    ];
    all.push(data_test(
        "study: a simulated ADIS16405 gyro has the recorded Allan deviation from 0.2 to 10 s",
        likeness,
    ));
    all.push(data_test("study: a log of several topics is compared by the one that is named", topic_compared));
    all.extend(REFUSED.iter().map(|case| test(&format!("study: refused: {}", case.0), move || refused(case))));
    all
}

fn read(text: &str) -> Result<study::Study, proofmass::error::Error> {
    study::parse("study.toml", text, Path::new(""))
}

fn committed() -> Result<(), Failed> {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let mut found = 0;
    for entry in std::fs::read_dir(reports)? {
        let path = entry?.path().join("study.toml");
        if path.exists() {
            let study = study::read(&path, &Overrides::default(), &Control::silent())?;
            check(
                path.parent().is_some_and(|p| p.ends_with(&study.name)),
                format!("{} is named otherwise", path.display()),
            )?;
            found += 1;
        }
    }
    check(found >= 2, format!("only {found} studies found"))
}

fn units() -> Result<(), Failed> {
    let study = read(
        "duration_s = 1.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\nk2_ug_per_g2 = 3.0\n[gyro]\nangle_random_walk_deg_rth = 0.6\n[sensor]\nrange_g = 2\n",
    )?;
    let sensor = study.member(0).sensor;
    // N = n/√2 (IEEE 952); 0.6 °/√h = 0.6 × π/180/60 rad/√s; K₂ of 3 µg/g² makes 12 µg at 2 g.
    near("N", sensor.accelerometer.velocity_random_walk_m_s_rts, 100.0 * MICRO_G / 2f64.sqrt(), 1e-12)?;
    near("ARW", sensor.gyro.angle_random_walk_rad_rts, 1.745_329_25e-4, 1e-10)?;
    let two_g: f64 = 2.0 * STANDARD_GRAVITY_M_S2;
    near("K2 at 2 g", sensor.accelerometer.k2_per_m_s2 * two_g.powi(2), 12.0 * MICRO_G, 1e-12)?;
    near("range", sensor.accelerometer.range_m_s2, two_g, 1e-12)
}

fn mechanics() -> Result<(), Failed> {
    let start = "duration_s = 1.0\n[sensor]\n";
    let physical = "mass_kg = 2.0\ndamping_n_s_m = 0.8\nstiffness_n_m = 8.0\ncubic_stiffness_n_m3 = 0.6\n";
    let a = read(&format!("{start}{physical}"))?.member(0).sensor.proof_mass.ok_or("no proof mass")?;
    let modal = format!(
        "resonance_hz = {}\ndamping_ratio = 0.1\ncubic_stiffness_per_m2_s2 = 0.3\n",
        1.0 / std::f64::consts::PI
    );
    let b = read(&format!("{start}{modal}"))?.member(0).sensor.proof_mass.ok_or("no proof mass")?;
    near("natural frequency", a.natural_frequency_rad_s, 2.0, 1e-12)?;
    near("natural frequency", a.natural_frequency_rad_s, b.natural_frequency_rad_s, 1e-12)?;
    near("damping ratio", a.damping_ratio, b.damping_ratio, 1e-12)?;
    near("cubic", a.cubic_per_m2_s2(), b.cubic_per_m2_s2(), 1e-12)
}

fn excitations() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("log.csv"), "t_s,a\n0.0,0.0\n0.5,1.0\n1.0,3.0\n")?;
    for (section, time_s, force_m_s2) in [
        ("kind = \"rest\"", 0.5, 0.0),
        ("kind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.2\nlength_s = 0.5", 0.5, 2.0),
        ("kind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 0.5", 0.5, 2.0),
        ("kind = \"sweep\"\namplitude_m_s2 = 2.0\nfrom_hz = 1.0\nto_hz = 1.0", 0.25, 2.0),
        ("kind = \"shock\"\npeak_g = 10\nlength_s = 0.2\nstart_s = 0.4", 0.5, 10.0 * STANDARD_GRAVITY_M_S2),
        ("kind = \"replay\"\nfile = \"log.csv\"\ncolumn = \"a\"\ntime = \"t_s\"\nscale = 2.0", 0.25, 1.0),
        ("kind = \"replay\"\nfile = \"log.csv\"\ncolumn = \"a\"\nrate_hz = 2.0", 0.75, 2.0),
    ] {
        let study = study::parse("study.toml", &format!("duration_s = 1.0\n[excitation]\n{section}"), folder.path())?;
        near(section, study.excitation.waveform.specific_force_m_s2(time_s), force_m_s2, 1e-9)?;
    }
    for section in [
        "kind = \"multisine\"\nrms_m_s2 = { mean = 1.0, sd = 0.1 }\nfrom_hz = 1\nto_hz = 9\nlines = 9",
        "kind = \"random\"\npsd_g2_hz = [[20.0, 0.01], [200.0, 0.01]]",
    ] {
        read(&format!("duration_s = 1.0\n[excitation]\n{section}"))?;
    }
    let drawn = read(
        "duration_s = 1.0\n[excitation]\nkind = \"sine\"\namplitude_m_s2 = 1.0\nfrequency_hz = { min = 1, max = 2 }",
    )?;
    let sine = drawn.member(5).sine.ok_or("a drawn sine belongs to its member")?;
    check((1.0..2.0).contains(&sine.frequency_hz) && sine.amplitude_m_s2 == 1.0, format!("{sine:?}"))
}

fn ideal() -> Result<(), Failed> {
    let member = read("duration_s = 1.0")?.member(3);
    let a = member.sensor.accelerometer;
    check(member.sensor.proof_mass.is_none() && member.sine.is_none(), "mechanics from nowhere")?;
    check(a.range_m_s2 == f64::INFINITY && a.velocity_random_walk_m_s_rts == 0.0, format!("{a:?}"))
}

/// Root-mean-square departure of ln(recorded / simulated median) over averaging times from 0.2 to
/// 10 s.
fn departure(data: &Path, angle_random_walk_deg_rth: f64) -> Result<f64, Failed> {
    let text = format!(
        "duration_s = 1.0\n[sensor]\nsample_rate_hz = 100\n[compare]\nfile = \"adis16405/run1_counts.csv\"\nrate_hz = 100\n\
         [[compare.axis]]\ncolumn = \"gy_lsb\"\nscale_deg_s = 0.05\n\
         gyro = {{ angle_random_walk_deg_rth = {angle_random_walk_deg_rth}, bias_instability_deg_h = 38.0 }}\n"
    );
    let study = study::parse("study.toml", &text, data)?;
    let mut none = |_: &Job, _: &str| Err(Error::new("could not simulate", "no windows were asked for", ""));
    let Outcome::Compared(comparison) = compare::run(&study, &Control::silent(), &mut none)? else {
        return Err("nothing was compared".into());
    };
    let axis = &comparison.axes[0];
    let squares: Vec<f64> = (0..axis.tau_s.len())
        .filter(|k| (0.2..10.0).contains(&axis.tau_s[*k]))
        .map(|k| (axis.recorded[k] / axis.simulated[1][k]).ln().powi(2))
        .collect();
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// A robot's log has several topics and its own clock.
fn topic_compared(data: &Path) -> Result<(), Failed> {
    let run = |topic: &str| {
        let text = format!(
            "duration_s = 1.0\n[sensor]\nsample_rate_hz = 200\n[compare]\nfile = \"formats/imu.bag\"\n{topic}\n\
             [[compare.axis]]\ncolumn = \"gx\"\nscale_deg_s = 57.29577951308232\n\
             gyro = {{ angle_random_walk_deg_rth = 0.3 }}\n"
        );
        let study = study::parse("study.toml", &text, data)?;
        let mut none = |_: &Job, _: &str| Err(Error::new("could not simulate", "no windows were asked for", ""));
        compare::run(&study, &Control::silent(), &mut none)
    };
    let Outcome::Compared(comparison) = run("topic = \"/imu0\"")? else { return Err("nothing was compared".into()) };
    check(comparison.axes.len() == 1 && comparison.axes[0].tau_s.len() > 4, "no axis of the topic was compared")?;
    let wrong = run("topic = \"/imu1\"").err().ok_or("a topic that is not there was read")?;
    check(wrong.to_string().contains("/imu1") || wrong.attempt.contains("/imu1"), format!("{wrong:?}"))?;
    let none = run("").err().ok_or("a log without a clock or topic was accepted")?;
    check(none.cause.contains("no clock") && none.hint.contains("topic"), format!("{none:?}"))
}

fn likeness(data: &Path) -> Result<(), Failed> {
    // The recordings' own README measures 2.58 °/√h on this axis.
    let (like, unlike) = (departure(data, 2.52)?, departure(data, 2.52 * 2f64.sqrt())?);
    check(like < 0.05, format!("recorded and simulated differ by {like}"))?;
    check(unlike > 0.2, format!("a gyro √2 too noisy differs by only {unlike}"))
}

/// What is wrong, the text (after `duration_s = 10.0`), a word of the cause, a word of the hint.
type Case = (&'static str, &'static str, &'static str, &'static str);

const REFUSED: &[Case] = &[
    ("unknown key", "membrs = 3", "unknown field `membrs`", "members"),
    ("unknown key in a section", "[gyro]\nbias_deg_hr = 3", "unknown field", "bias_deg_h"),
    ("wrong type", "members = \"many\"", "expected a whole number", "number"),
    ("wrong unit", "[accelerometer]\nbias_ug = 3", "unknown field `bias_ug`", "bias_mg"),
    ("negative noise", "[accelerometer]\nnoise_density_ug_rthz = -60", "= -60 µg/√Hz: need zero or more", "sign"),
    ("noise mostly negative", "[accelerometer]\nnoise_density_ug_rthz = { mean = 1, sd = 1 }", "more than 2 %", "min"),
    ("zero members", "members = 0", "at least one", "16384"),
    ("negative members", "members = -5", "-5", ""),
    ("more members than can be", "members = 999999999999", "at most", "million"),
    ("step longer than the run", "step_s = 20.0", "longer than the run", "shorten"),
    ("zero step", "step_s = 0.0", "more than zero", "positive"),
    ("negative step", "step_s = -0.1", "more than zero", "positive"),
    ("sample no multiple of the step", "step_s = 0.003\n[sensor]\nsample_rate_hz = 100", "3.3333 times", "multiple"),
    ("run no multiple of the sample", "step_s = 0.7", "14.2857 times", "9.8"),
    (
        "more steps a sample than are counted",
        "step_s = 1e-10\n[sensor]\nsample_rate_hz = 1.0",
        "a sample takes",
        "lengthen",
    ),
    ("absurdly many steps", "step_s = 1e-14", "steps", "longer step"),
    (
        "both density and random walk",
        "[accelerometer]\nnoise_density_ug_rthz = 1\nvelocity_random_walk_m_s_rth = 1",
        "two names",
        "n/√2",
    ),
    ("two proof masses", "[sensor]\nmass_kg = 1\nresonance_hz = 3", "two ways", "either"),
    ("damping without resonance", "[sensor]\ndamping_ratio = 1", "without `sensor.resonance_hz`", "ideal"),
    ("mass without stiffness", "[sensor]\nmass_kg = 1", "without `sensor.stiffness_n_m`", "add"),
    ("zero mass", "[sensor]\nmass_kg = 0\nstiffness_n_m = 1", "more than zero", "sign"),
    ("unknown excitation", "[excitation]\nkind = \"sin\"", "unknown variant `sin`", "sine"),
    ("excitation without kind", "[excitation]\namplitude_m_s2 = 1", "without `kind`", "kind"),
    ("key of another excitation", "[excitation]\nkind = \"sine\"\nfrom_hz = 1", "does not belong", "frequency_hz"),
    (
        "sine without frequency",
        "[excitation]\nkind = \"sine\"\namplitude_m_s2 = 1",
        "frequency_hz` is missing",
        "phase",
    ),
    (
        "sweep limits drawn",
        "[excitation]\nkind = \"sweep\"\namplitude_m_s2 = 1\nfrom_hz = { min = 1, max = 2 }\nto_hz = 3",
        "all members share",
        "amplitude",
    ),
    ("spectrum out of order", "[excitation]\nkind = \"random\"\npsd_g2_hz = [[2, 1], [1, 1]]", "increasing", "g²/Hz"),
    ("replay without clock", "[excitation]\nkind = \"replay\"\nfile = \"x.csv\"\ncolumn = \"a\"", "clock", "rate_hz"),
    (
        "replay of no file",
        "[excitation]\nkind = \"replay\"\nfile = \"x.csv\"\ncolumn = \"a\"\nrate_hz = 1",
        "No such file",
        "relative",
    ),
    ("report time outside the run", "[report]\ntimes_s = [20.0]", "outside the run", "within"),
    ("report times out of order", "[report]\ntimes_s = [2.0, 1.0]", "does not increase", "sort"),
    ("no report times", "[report]\ntimes_s = []", "0 times", "rows"),
    ("a name that is a path", "name = \"../x\"", "folder", "letters"),
    ("a number that is none", "[accelerometer]\nbias_mg = nan", "finite", ""),
    ("half a distribution", "[accelerometer]\nbias_mg = { mean = 1 }", "both", ""),
];

fn refused((_, text, cause, hint): &Case) -> Result<(), Failed> {
    let Err(error) = read(&format!("duration_s = 10.0\n{text}\n")) else { return Err("it was accepted".into()) };
    check(error.cause.contains(cause), format!("cause does not say '{cause}': {error}"))?;
    check(error.hint.contains(hint), format!("hint does not say '{hint}': {error}"))?;
    check(error.attempt.starts_with("could not"), format!("{error}"))
}
