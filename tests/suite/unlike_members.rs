//! Members of one study that differ in what they have: a low-pass that only some have, a spring that
//! stiffens until the end of the run.

use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::{self, Cpu};
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::control::Control;
use proofmass::ensemble::{Options, run_on};
use proofmass::kernel::job::Job;
use proofmass::sensor::SensorTerm;
use proofmass::statistics::quantity::ACCELERATION;
use proofmass::study::{self, Study};
use proofmass::validation::parity;

use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("unlike members: one without a low-pass reads its mass beside others that have one", without_low_pass),
        gpu_test("unlike members: so it does on the GPU", without_low_pass_on_the_gpu),
        test("unlike members: steps allow for what a spring stiffens by until the end of the run", stiffening),
    ]
}

fn parsed(sensor: &str, duration_s: f64) -> Result<Study, Failed> {
    let text = format!(
        "members = 256\nduration_s = {duration_s:?}\n[sensor]\nsample_rate_hz = 1000.0\nresonance_hz = 12.0\n\
         damping_ratio = 0.4\n{sensor}[excitation]\nkind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 5.0\n\
         [report]\ntimes_s = [{duration_s:?}]\n"
    );
    Ok(study::parse("unlike members", &text, Path::new(""))?)
}

const DRAWN: &str = "readout_lowpass_s = { min = 0.01, max = 0.05 }\n";
const CUBIC: &str = "cubic_stiffness_per_m2_s2 = 1e10\n";

/// Its ensemble, in which every other member has no low-pass.
fn job(study: &Study) -> Result<Job, Failed> {
    let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
    let draw = job.draw.clone();
    let every_other = move |number: u64| {
        let mut member = draw(number);
        if number.is_multiple_of(2) {
            member.sensor = member.sensor.with_error(SensorTerm::ReadoutLowPass, 0.0);
        }
        member
    };
    Ok(Job { draw: Arc::new(every_other), ..job })
}

/// Expected: the same sensor in a study that has no low-pass.
fn without_low_pass() -> Result<(), Failed> {
    for mass in ["", CUBIC] {
        let outcomes = |study: &Study| Ok::<_, Failed>(cpu::outcomes::<f64>(&job(study)?, &Control::silent())?);
        let bare = outcomes(&parsed(mass, 1.0)?)?[0][ACCELERATION];
        check(bare.abs() > 0.1, format!("the mass reads right to {bare}: the comparison is blind"))?;
        let study = parsed(&format!("{mass}{DRAWN}"), 1.0)?;
        let (mut without, mut with) = (0, 0);
        for (member, outcome) in outcomes(&study)?.iter().enumerate() {
            if member.is_multiple_of(2) {
                near(&format!("{mass}: member {member}"), outcome[ACCELERATION], bare, 1e-9)?;
                without += 1;
            } else {
                // Control: one that has a low-pass reads otherwise.
                with += usize::from((outcome[ACCELERATION] - bare).abs() > 1e-3);
            }
        }
        check(without == 128 && with > 100, format!("{without} without and {with} with a low-pass"))?;
    }
    Ok(())
}

fn without_low_pass_on_the_gpu() -> Result<(), Failed> {
    let mut gpu = Ensembles::on(Arc::new(Gpu::open()?));
    for mass in ["", CUBIC] {
        let job = job(&parsed(&format!("{mass}{DRAWN}"), 1.0)?)?;
        let here = run_on(&job, &mut Cpu::default(), &Options::default())?;
        let apart = parity::difference(&here, &run_on(&job, &mut gpu, &Options::default())?);
        check(apart < 5e-3, format!("{mass}: percentiles {apart} sd apart"))?;
        // Control: other times.
        let other = self::job(&parsed(&format!("{mass}{}", DRAWN.replace("0.05", "0.06")), 1.0)?)?;
        let apart = parity::difference(&here, &run_on(&other, &mut gpu, &Options::default())?);
        check(apart > 5e-3, format!("{mass}: other times are {apart} sd apart"))?;
    }
    Ok(())
}

/// ω = ω₀√(1 + κt): after 5 s at κ = 160/s it is 28.3 ω₀, 2.13 a millisecond, for which 9 substeps keep
/// ωh below a quarter; after 0.1 s it is 4.1 ω₀, and 2 are enough.
fn stiffening() -> Result<(), Failed> {
    let substeps = |sensor: &str, duration_s: f64| -> Result<u32, Failed> {
        Ok(parsed(sensor, duration_s)?.integrator()?.integrator.substeps())
    };
    let drift = "stiffness_drift_per_s = 160.0\n";
    let got = [substeps(drift, 5.0)?, substeps(drift, 0.1)?];
    check(got == [9, 2], format!("{got:?} substeps"))?;
    // Control: a spring that softens, or stays, needs no more than at the beginning.
    let got = [
        substeps("stiffness_drift_per_s = -0.1\n", 5.0)?,
        substeps("end_stop_per_s2 = 1.0\nend_stop_gap_m = 1.0\n", 5.0)?,
    ];
    check(got == [1, 1], format!("{got:?} substeps without stiffening"))
}
