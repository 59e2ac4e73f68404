//! A recorded IMU, dead-reckoned beside its reference: windows of a made-up flight lie inside the
//! predicted bands as often as those say, and what is no recording of the flight is refused by
//! name.

mod recorded;
mod scattered;

use std::fmt::Write as _;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::{UnitQuaternion, Vector3};
use proofmass::control::Control;
use proofmass::motion::sources::{self, Section};
use proofmass::motion::{Earth, Sampling, Truth};
use proofmass::rng::{Philox, Stream};
use proofmass::strapdown::windows::inflation::{CAUSES, Whose};
use proofmass::strapdown::windows::score::{self, BANDS};
use proofmass::strapdown::windows::{self, Compared, Sensor};
use proofmass::{document, numerics, study};

use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "flown: windows of a made-up flight lie inside the bands as often as these say, not with three times the noise",
            shares,
        ),
        test("flown: logs that are not of the flight are refused by name, the same log untouched is not", bad_input),
        test(
            "flown: biases of another flight and of a still start, a sensor of a file, an inflation fitted elsewhere",
            elsewhere,
        ),
        test(
            "flown: how far the reference's attitude errs is of the flight itself, the sensor's noise of another",
            references,
        ),
    ]
    .into_iter()
    .chain(recorded::tests())
    .chain(scattered::tests())
    .collect()
}

/// Noise of the made-up sensor: N of gyros, rad/√s, and accelerometers, m/s/√s; K of gyros,
/// rad/s/√s, and accelerometers, m/s²/√s.
const NOISE: [f64; 4] = [3e-4, 3e-3, 2e-6, 2e-5];
/// Its biases: of gyros, rad/s, and accelerometers, m/s².
const BIASES: [[f64; 3]; 2] = [[2e-3, -1e-3, 5e-4], [0.05, -0.02, 0.03]];
const RATE_HZ: f64 = 200.0;
/// Five standard errors of the median of 38 biases, each fitted in 5 s: of accelerometers, m/s²,
/// and gyros, rad/s. A gyro's in one window errs by N/√T = 1.3e-4 rad/s; an accelerometer's by
/// N/√T = 1.3e-3 m/s² and by what the gyros' noise tilts, g N √(T/12) = 1.9e-3 m/s² once the
/// attitude at both ends is known; a median's standard error is √(π/2)/√38 of that.
const WITHIN: [f64; 2] = [2.4e-3, 1.4e-4];

/// A study of the made-up sensor.
fn study_text(windows: &str, more: &str) -> String {
    format!(
        "duration_s = 10.0\n[sensor]\nsample_rate_hz = {RATE_HZ}\n[trajectory]\nkind = \"file\"\nfile = \"poses.csv\"\n\
         up = \"-z\"\n{more}\n[trajectory.compare]\nimu = \"imu.csv\"\nwindows_s = {windows}\n{}",
        sensor_text(1.0)
    )
}

/// The sensor with its noise times a factor, as study.toml has it: °/√h, °/h/√h, m/s/√h, µg/√s.
fn sensor_text(factor: f64) -> String {
    let [gyro, accelerometer, gyro_walk, accelerometer_walk] = NOISE.map(|n| n * factor);
    format!(
        "[gyro]\nangle_random_walk_deg_rth = {}\nrate_random_walk_deg_h_rth = {}\n[accelerometer]\n\
         velocity_random_walk_m_s_rth = {}\nacceleration_random_walk_ug_rts = {}\n",
        gyro.to_degrees() * 60.0,
        gyro_walk.to_degrees() * 3600.0 * 60.0,
        accelerometer * 60.0,
        accelerometer_walk / 9.806_65e-6,
    )
}

fn truth(section: &str, duration_s: f64) -> Result<Truth, Failed> {
    let section: Section = document::parse_toml("trajectory", section)?;
    let sampling = Sampling { rate_hz: RATE_HZ, duration_s, lever_arm_m: Vector3::zeros() };
    Ok(sources::trajectory(&section, duration_s)?.truth(&Earth::FLAT, sampling)?)
}

/// Poses at 100 Hz, as a table; the third axis points down.
fn poses(truth: &Truth) -> String {
    poses_off(truth, 0.0)
}

/// The same with attitudes that err by this about each axis, rad rms, as a filter's do: slowly, and
/// otherwise in each window of 5 s.
fn poses_off(truth: &Truth, rad: f64) -> String {
    let wave =
        |t: f64, axis: f64| (t / (1.1 + 0.17 * axis) + axis).sin() + (t / (2.3 + 0.31 * axis) + 2.0 * axis).sin();
    let mut text = "t_s,x,y,z,qw,qx,qy,qz\n".to_owned();
    for s in truth.samples.iter().step_by(2) {
        let off = Vector3::from_fn(|axis, _| rad * wave(s.time_s, axis as f64));
        let (p, q) = (s.position_m, UnitQuaternion::from_scaled_axis(off) * s.attitude);
        let _ = writeln!(
            text,
            "{:.6},{:.9},{:.9},{:.9},{:.12},{:.12},{:.12},{:.12}",
            s.time_s, p.x, p.y, p.z, q.w, q.i, q.j, q.k
        );
    }
    text
}

/// What the sensor reads, with its noise times a factor.
fn readings(truth: &Truth, factor: f64, row: impl Fn(f64, Vector3<f64>, Vector3<f64>) -> String) -> String {
    drawn(truth, factor, 20, row)
}

/// The same with other random numbers.
fn drawn(truth: &Truth, factor: f64, seed: u64, row: impl Fn(f64, Vector3<f64>, Vector3<f64>) -> String) -> String {
    let [gyro, accelerometer, gyro_walk, accelerometer_walk] = NOISE.map(|n| n * factor);
    let mut draw = Philox::new(seed, 0, Stream::Start);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| size * draw.normal());
    let mut walked = [Vector3::zeros(); 2];
    let mut text = "t_s,gx,gy,gz,ax,ay,az\n".to_owned();
    for s in &truth.samples {
        let (white_rate, white_force) = (vector(gyro * RATE_HZ.sqrt()), vector(accelerometer * RATE_HZ.sqrt()));
        walked[0] += vector(gyro_walk / RATE_HZ.sqrt());
        walked[1] += vector(accelerometer_walk / RATE_HZ.sqrt());
        let rate = s.rate_rad_s + Vector3::from(BIASES[0]) + walked[0] + white_rate;
        let force = s.specific_force_m_s2 + Vector3::from(BIASES[1]) + walked[1] + white_force;
        text += &row(s.time_s, rate, force);
    }
    text
}

fn plain(t: f64, w: Vector3<f64>, f: Vector3<f64>) -> String {
    format!("{t:.6},{:.9},{:.9},{:.9},{:.9},{:.9},{:.9}\n", w.x, w.y, w.z, f.x, f.y, f.z)
}

fn compared(folder: &Path, text: &str) -> Result<Compared, Failed> {
    let study = study::parse("study.toml", text, folder)?;
    let motion = study.in_motion.as_ref().ok_or("no motion")?;
    Ok(windows::compare(motion, &Control::silent())?.ok_or("nothing compared")?)
}

fn shares() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    for (name, section) in [
        ("drone", "kind = \"drone\"\nseed = 4"),
        ("figure-eight", "kind = \"figure-eight\"\nradius_m = 10.0\nspeed_m_s = 3.0"),
    ] {
        let truth = truth(section, 200.0)?;
        std::fs::write(folder.path().join("poses.csv"), poses(&truth))?;
        std::fs::write(folder.path().join("imu.csv"), readings(&truth, 1.0, plain))?;
        let text = study_text("[5.0, 10.0]", "");
        let right = compared(folder.path(), &text)?;
        std::fs::write(folder.path().join("imu.csv"), readings(&truth, 3.0, plain))?;
        let loud = compared(folder.path(), &text)?;
        check(right.sensors == [Sensor::Stated, Sensor::Tenfold, Sensor::Inflated], "sensors")?;
        for (compared, factor) in [(&right, 1.0), (&loud, 3.0)] {
            let inflation = compared.inflation.ok_or("no inflation")?;
            for (place, noise) in [(1, NOISE[0]), (3, NOISE[1])] {
                let [low, high] = inflation.interval[place];
                let held = |noise: f64| low <= noise && noise <= high;
                // Four intervals of 95 %, widened by a fifth: a miss by more is one in some
                // hundreds.
                let near = low / 1.2 <= factor * noise && factor * noise <= high * 1.2;
                check(near, format!("{name}: {:?} {low} to {high}, truth {}", CAUSES[place], factor * noise))?;
                check(factor == 1.0 || !held(noise), format!("{name}: tripled noise in {low} to {high} as {noise}"))?;
            }
        }
        for (length, loud) in right.lengths.iter().zip(&loud.lengths) {
            let windows = length.windows.len();
            check(windows as f64 >= 0.95 * 200.0 / length.seconds, format!("{name}: {windows} windows"))?;
            let (errors, shrill) = (length.errors(), loud.errors());
            let mut inside = [0; 2];
            for place in 0..9 {
                let axis = score::axis(&errors, &length.expected[0], place);
                for (share, inside) in BANDS.into_iter().zip(axis.inside) {
                    // 108 counts: an exact interval of 99.99 % leaves one in a hundred runs of a
                    // right prediction outside.
                    let [low, high] = numerics::special::exact_interval(inside as u64, windows as u64, 0.9999);
                    check(
                        low <= share && share <= high,
                        format!("{name} {place}: {inside} of {windows} inside {share}"),
                    )?;
                }
                // Normalised errors squared have the variance 2: five standard errors.
                near(&format!("{name} {place}: nees"), axis.nees.mean, 1.0, 5.0 * (2.0 / windows as f64).sqrt())?;
                let shrill = score::axis(&shrill, &loud.expected[0], place);
                check(
                    shrill.nees.mean > 4.0,
                    format!("{name} {place}: three times the noise gives {}", shrill.nees.mean),
                )?;
                inside[0] += axis.inside[1];
                inside[1] += shrill.inside[1];
            }
            // A normal error of three times the size lies inside 0.548 sd: in 42 % of the cases.
            let [right, loud] = inside.map(|hits| hits as f64 / (9 * windows) as f64);
            check(
                right > 0.8 && loud < 0.6,
                format!("{name}: {right} inside 90 %, {loud} with three times the noise"),
            )?;
            let all = score::together(&errors, &length.expected[0], 0..9);
            near(&format!("{name}: nees of all"), all.mean, 1.0, 5.0 * (2.0 / all.freedom as f64).sqrt())?;
            // Tenfold noise on a sensor that is right is too much: nothing is beyond its 50 % band.
            let tenfold = score::axis(&errors, &length.expected[1], 0);
            check(tenfold.inside[0] == windows, format!("{name}: {tenfold:?}"))?;
        }
        let biases = right.lengths[1].windows[0].biases;
        for (k, bias) in BIASES[1].iter().chain(&BIASES[0]).enumerate() {
            near(&format!("{name}: bias {k}"), biases[k], *bias, WITHIN[usize::from(k >= 3)])?;
        }
    }
    Ok(())
}

/// Mean of all normalised errors squared of a sensor, over windows of 5 s.
fn together(compared: &Compared, sensor: &Sensor) -> Result<f64, Failed> {
    let place = compared.sensors.iter().position(|s| s == sensor).ok_or_else(|| format!("no {sensor:?}"))?;
    let length = compared.lengths.first().ok_or("no windows")?;
    Ok(score::together(&length.errors(), &length.expected[place], 0..9).mean)
}

/// Five standard errors of the mean normalised error squared: 38 windows of nine errors have one of
/// √(2/342) = 0.076; a shared bias adds a fiftieth to the variance.
const RIGHT: f64 = 5.0 * 0.076 * 1.02 + 0.02;

fn elsewhere() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    let (here, there) = (truth("kind = \"drone\"\nseed = 4", 200.0)?, truth("kind = \"drone\"\nseed = 5", 200.0)?);
    write("poses.csv", &poses(&here))?;
    write("other.csv", &poses(&there))?;
    let more = |line: &str| study_text("[5.0]", "").replacen("[gyro]", &format!("{line}\n[gyro]"), 1);
    // Biases that another flight gives, and as control, those of a flight in which they were
    // others.
    write("imu.csv", &readings(&here, 1.0, plain))?;
    let files = more("files = [[\"imu2.csv\", \"other.csv\"]]");
    write("imu2.csv", &drawn(&there, 1.0, 21, plain))?;
    near("biases of another flight", together(&compared(folder.path(), &files)?, &Sensor::Stated)?, 1.0, RIGHT)?;
    let off = Vector3::repeat(0.05);
    write("imu2.csv", &drawn(&there, 1.0, 21, |t, w, f| plain(t, w, f + off)))?;
    let wrong = together(&compared(folder.path(), &files)?, &Sensor::Stated)?;
    check(wrong > 4.0, format!("biases 0.05 m/s² apart give {wrong}"))?;
    // Tripled noise: a sensor that says so is right, the stated one is not; an inflation fitted on
    // the other flight is.
    write("imu.csv", &readings(&here, 3.0, plain))?;
    write("imu2.csv", &drawn(&there, 3.0, 21, plain))?;
    write("loud.toml", &sensor_text(3.0))?;
    let loud = more("sensors = [\"loud.toml\"]\nfit = [[\"imu2.csv\", \"other.csv\"]]");
    let loud = compared(folder.path(), &loud)?;
    near("a sensor of a file", together(&loud, &Sensor::File("loud.toml".into()))?, 1.0, RIGHT)?;
    // The fit has a standard error of its own, as large.
    near("an inflation fitted elsewhere", together(&loud, &Sensor::Inflated)?, 1.0, RIGHT * 2f64.sqrt())?;
    let stated = together(&loud, &Sensor::Stated)?;
    check(stated > 4.0, format!("three times the noise gives {stated}"))?;
    // A drive that begins with a minute at rest: biases by its mean. One white noise of 20 s is
    // common to all windows of 5 s and has a quarter of their variance, so that their squares go
    // together: twice the standard error.
    let drive = truth("kind = \"car\"\nstill_s = 60.0\nseed = 3", 260.0)?;
    write("poses.csv", &poses(&drive))?;
    write("imu.csv", &readings(&drive, 1.0, plain))?;
    let still = compared(folder.path(), &more("bias = \"still\"\nstill_s = 20.0"))?;
    near("biases of a still start", together(&still, &Sensor::Stated)?, 1.0, 2.0 * RIGHT)?;
    write("imu.csv", &readings(&drive, 3.0, plain))?;
    let loud = together(&compared(folder.path(), &more("bias = \"still\"\nstill_s = 20.0"))?, &Sensor::Stated)?;
    check(loud > 4.0, format!("three times the noise after a still start gives {loud}"))
}

/// An attitude that a filter estimates errs by some tenths of a degree, rad.
const ERRS_RAD: f64 = 3e-3;

fn references() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    let (here, there) = (truth("kind = \"drone\"\nseed = 4", 200.0)?, truth("kind = \"drone\"\nseed = 5", 200.0)?);
    write("imu.csv", &readings(&here, 1.0, plain))?;
    write("imu2.csv", &drawn(&there, 1.0, 21, plain))?;
    let text = study_text("[5.0]", "").replacen("[gyro]", "fit = [[\"imu2.csv\", \"other.csv\"]]\n[gyro]", 1);
    for (rad, there_rad) in [(ERRS_RAD, 0.0), (0.0, ERRS_RAD), (0.0, 0.0)] {
        write("poses.csv", &poses_off(&here, rad))?;
        write("other.csv", &poses_off(&there, there_rad))?;
        let found = compared(folder.path(), &text)?;
        let inflation = found.inflation.ok_or("no inflation")?;
        let windows = found.lengths[0].windows.len();
        check(inflation.whose == Whose::OwnReference { windows }, format!("{:?}, {windows} windows", inflation.whose))?;
        // A spread of 1/√(2·3·38) = 7 % by as many errors, and two waves of slightly different
        // weights in each axis: a third.
        let [low, high] = inflation.interval[0];
        // Where the other flight's errs, its gyros' share is uncertain by N√5 = 0.7 mrad, and this
        // one's makes up for it.
        let (most, least) = (1.33 * rad + NOISE[0] * 5f64.sqrt(), 0.67 * rad);
        check(
            low <= most && (least..=2.0 * most).contains(&high) && (rad == 0.0 || low > 0.0),
            format!("{rad}: the reference errs by {low} to {high}"),
        )?;
        // Errors that a sensor and its reference make are as large as predicted, as with any
        // inflation fitted elsewhere.
        let inflated = together(&found, &Sensor::Inflated)?;
        near(&format!("here {rad}, there {there_rad}"), inflated, 1.0, RIGHT * 2f64.sqrt())?;
        // Control: the sensor as it truly is, without its reference, is not.
        let stated = together(&found, &Sensor::Stated)?;
        check((stated > 4.0) == (rad > 0.0), format!("{rad}: the stated sensor alone gives {stated}"))?;
    }
    Ok(())
}

fn bad_input() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let truth = truth("kind = \"drone\"\nseed = 4", 60.0)?;
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    write("poses.csv", &poses(&truth))?;
    let text = study_text("[5.0]", "");
    let said = |imu: &str| -> Result<String, Failed> {
        write("imu.csv", imu)?;
        let study = study::parse("study.toml", &text, folder.path())?;
        let motion = study.in_motion.as_ref().ok_or("no motion")?;
        match windows::compare(motion, &Control::silent()) {
            Ok(_) => Ok("taken".into()),
            Err(error) => Ok(error.cause.clone()),
        }
    };
    let changed = |row: &dyn Fn(f64, Vector3<f64>, Vector3<f64>) -> String| readings(&truth, 1.0, row);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let cases: [(&str, String, &str); 7] = [
        ("untouched", changed(&plain), "taken"),
        ("later", changed(&|t, w, f| plain(t + 90.0, w, f)), "do not overlap: the log begins 30"),
        ("years later", changed(&|t, w, f| plain(t + 1.4e9, w, f)), "the log begins 44.4 years after"),
        ("degrees", changed(&|t, w, f| plain(t, w * 180.0 / std::f64::consts::PI, f)), "degrees, not radians"),
        ("sign of gravity", changed(&|t, w, f| plain(t, w, -f)), "gravity has the wrong sign"),
        ("in g", changed(&|t, w, f| plain(t, w, f / 9.806_65)), "readings in g"),
        (
            "turned",
            changed(&|t, w, f| {
                let turn = |v: Vector3<f64>| Vector3::new(v.x, half * (v.y - v.z), half * (v.y + v.z));
                plain(t, turn(w), turn(f))
            }),
            "away from up",
        ),
    ];
    for (name, imu, cause) in cases {
        let got = said(&imu)?;
        check(got.contains(cause), format!("{name}: got `{got}`, expected `{cause}`"))?;
    }
    // Rows without a reading are counted, and the windows stay.
    let rows =
        changed(&|t, w, f| if (10.0..10.01).contains(&t) { format!("{t:.6},nan,0,0,0,0,0\n") } else { plain(t, w, f) });
    write("imu.csv", &rows)?;
    let found = compared(folder.path(), &text)?;
    check(
        found.findings.iter().any(|f| f.contains("2 rows of the IMU's log hold no reading")),
        format!("{:?}", found.findings),
    )?;
    check(found.findings.iter().any(|f| f.contains("2 readings are missing")), format!("{:?}", found.findings))?;
    // A reference at 2 Hz is said; one that jumps is refused.
    write("imu.csv", &changed(&plain))?;
    let every = poses(&truth);
    let (header, rows) = every.split_once('\n').ok_or("no header")?;
    let slow: String = rows.lines().step_by(50).map(|row| format!("{row}\n")).collect();
    write("poses.csv", &format!("{header}\n{slow}"))?;
    let refusal = |text: &str| match compared(folder.path(), text) {
        Ok(found) => found.findings.join("; "),
        Err(error) => format!("{error:?}"),
    };
    let said = refusal(&text);
    check(said.contains("2 Hz"), format!("slow: {said}"))?;
    let jump = |(k, row): (usize, &str)| match (
        k > 3000,
        row.split_once(',').and_then(|(t, rest)| Some((t, rest.split_once(',')?))),
    ) {
        (true, Some((t, (x, rest)))) => format!("{t},{},{rest}\n", x.parse::<f64>().unwrap_or_default() + 2.0),
        _ => format!("{row}\n"),
    };
    let jumped: String = rows.lines().enumerate().map(jump).collect();
    write("poses.csv", &format!("{header}\n{jumped}"))?;
    let said = refusal(&text);
    check(said.contains("jumps by 2"), format!("jump: {said}"))?;
    // Keys in the wrong company.
    write("poses.csv", &every)?;
    for (more, cause) in [
        ("still_s = 5.0", "belongs to bias = \"others\"".replace("others", "still")),
        ("bias = \"still\"", "still_s` is missing".into()),
        ("windows = [1.0]", "windows".into()),
    ] {
        let wrong = text.replace("[gyro]", &format!("{more}\n[gyro]"));
        let error = study::parse("study.toml", &wrong, folder.path()).err().ok_or(format!("{more} was taken"))?;
        check(error.cause.contains(&cause), format!("{more}: {error}"))?;
    }
    let error =
        study::parse("study.toml", &text.replace("[5.0]", "[10.0, 5.0]"), folder.path()).err().ok_or("taken")?;
    check(error.cause.contains("does not increase"), error.cause.clone())
}
