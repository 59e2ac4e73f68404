//! A still start in the warmth, and warmth that comes late: what both leave of the error that follows
//! the temperature, by closed forms.

use libtest_mimic::{Failed, Trial};
use proofmass::drift::expected::Expected;
use proofmass::ensemble::Choice;
use proofmass::statistics::quantity;

use super::closed_form::{G, TIMES_S, simulate, study};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("closed form: a still start takes off what the temperature made of the bias", warm_start),
        test("closed form: a sensor that follows the temperature late drifts late", lag),
        test("closed form: it takes off what the temperature's square made of it", warm_start_of_a_square),
    ]
}

/// 1 K/s followed with a lag of τ: b′ (t − τ (1 − e^(−t/τ))), twice integrated.
fn lag() -> Result<(), Failed> {
    let slope = 100e-6 * G;
    let text = |lag_s: f64| {
        format!(
            "[accelerometer]\nbias_temperature_ug_k = 100.0\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, \
             40.0]]\nlag_s = {lag_s:?}\n"
        )
    };
    let law = |tau: f64, t: f64| {
        let gone = 1.0 - (-t / tau).exp();
        slope * (t.powi(3) / 6.0 - 0.5 * tau * t * t + tau * tau * t - tau.powi(3) * gone)
    };
    let study = study(&text(4.0))?;
    let statistics = simulate(&study, Choice::Cpu)?;
    let expected = Expected::of(&study, &study.clock.report_samples);
    for (k, t) in TIMES_S.into_iter().enumerate() {
        let got = statistics.at[k][quantity::POSITION].mean;
        near("position over the law", got / law(4.0, t), 1.0, 2e-4)?;
        near("reported position", expected.total(quantity::POSITION)[k].mean / law(4.0, t), 1.0, 1e-5)?;
        // Control: another lag, and none.
        check((got / law(4.4, t) - 1.0).abs() > 5e-3, "any lag makes the same way")?;
        check(got < 0.8 * slope * t.powi(3) / 6.0, "it is not late")?;
    }
    Ok(())
}

/// 10 K above the reference during the still start, then 1 K/s: of b′ per kelvin the start finds 10
/// b′, which the levelled tilt −10 b′/g hides; what comes is a ramp, b′ t³/6. Without a still start
/// the 10 K act as well: b′ (5 t² + t³/6).
fn warm_start() -> Result<(), Failed> {
    let slope = 100e-6 * G;
    let warm = "[accelerometer]\nbias_temperature_ug_k = 100.0\n[temperature]\nprofile_s_deg_c = [[0.0, 30.0], [20.0, 50.0]]\nreference_deg_c = 20.0\n";
    let still = format!("{warm}[alignment]\nkind = \"still\"\nstill_s = 5.0");
    for (sections, steps_k, tilt_k) in [(warm, 10.0, 0.0), (still.as_str(), 0.0, 10.0)] {
        let study = study(sections)?;
        let statistics = simulate(&study, Choice::Cpu)?;
        let expected = Expected::of(&study, &study.clock.report_samples);
        for (k, t) in TIMES_S.into_iter().enumerate() {
            let (position, tilt) = (slope * (0.5 * steps_k * t * t + t.powi(3) / 6.0), -slope * tilt_k / G);
            let at = &statistics.at[k];
            near("position over the law", at[quantity::POSITION].mean / position, 1.0, 1e-4)?;
            near("tilt", at[quantity::TILT].mean, tilt, 1e-4 * 1e-3)?;
            near("reported position", expected.total(quantity::POSITION)[k].mean / position, 1.0, 1e-6)?;
            near("reported tilt", expected.total(quantity::TILT)[k].mean, tilt, 1e-12)?;
        }
        // Control: a kelvin more at the start is another way.
        let other = simulate(&self::study(&sections.replace("[0.0, 30.0]", "[0.0, 31.0]"))?, Choice::Cpu)?;
        let moved = other.at[2][quantity::POSITION].mean / statistics.at[2][quantity::POSITION].mean;
        check((moved - 1.0).abs() > 1e-3, "any temperature at the start makes the same way")?;
    }
    Ok(())
}

/// The same of the square, c (10 + t)² less c 10² after a still start: c (10 t³/3 + t⁴/12), and the
/// tilt −10² c/g.
fn warm_start_of_a_square() -> Result<(), Failed> {
    let c = 10e-6 * G;
    let text = |from: f64| {
        format!(
            "[accelerometer]\nbias_temperature_ug_k2 = 10.0\n[temperature]\nprofile_s_deg_c = [[0.0, {from:?}], \
             [20.0, 50.0]]\nreference_deg_c = 20.0\n[alignment]\nkind = \"still\"\nstill_s = 5.0"
        )
    };
    let study = study(&text(30.0))?;
    let (statistics, other) = (simulate(&study, Choice::Cpu)?, simulate(&self::study(&text(31.0))?, Choice::Cpu)?);
    let expected = Expected::of(&study, &study.clock.report_samples);
    for (k, t) in TIMES_S.into_iter().enumerate() {
        let (position, tilt) = (c * (t.powi(3) / 0.3 + t.powi(4) / 12.0), -100.0 * c / G);
        let at = &statistics.at[k];
        near("position over the law", at[quantity::POSITION].mean / position, 1.0, 1e-4)?;
        near("tilt", at[quantity::TILT].mean, tilt, 1e-6)?;
        near("reported position", expected.total(quantity::POSITION)[k].mean / position, 1.0, 1e-6)?;
        near("reported tilt", expected.total(quantity::TILT)[k].mean, tilt, 1e-12)?;
        // Control: a kelvin more at the start is another way.
        let moved = other.at[k][quantity::POSITION].mean / position;
        check((moved - 1.0).abs() > 1e-3, "any temperature at the start makes the same way")?;
    }
    Ok(())
}
