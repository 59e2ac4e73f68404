//! Every error source grows by its closed form.

use std::sync::Arc;

use libtest_mimic::Trial;
use proofmass::ensemble::{self, Choice, Options};
use proofmass::kernel::job::{Clock, Integrator, Job, Member, Waveform};
use proofmass::sensor::Sensor;
use proofmass::statistics::quantity::POSITION;

use super::world::{near, test};

struct Rest;
impl Waveform for Rest {
    fn specific_force_m_s2(&self, _: f64) -> f64 {
        0.0
    }
}

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("law: velocity random walk grows with t^1.5", || {
        let mut sensor = Sensor::ideal();
        sensor.accelerometer.velocity_random_walk_m_s_rts = 4e-4;
        let job = Job {
            seed: 1,
            members: 8192,
            clock: Clock { step_s: 1e-3, steps_per_sample: 10, samples: 2000, report_samples: vec![500, 1000, 2000] },
            draw: Arc::new(move |_| Member { sensor, sine: None }),
            waveform: Arc::new(Rest),
            integrator: Integrator::Ideal,
            gravity_m_s2: 9.80665,
        };
        let s = ensemble::run(&job, &Options { backend: Choice::Cpu, ..Options::default() })?;
        for (t, sd) in s.time_s.iter().zip(s.series(POSITION, |q| q.sd)) {
            near("sd / closed form", sd / (4e-4 * t.powf(1.5) / 3_f64.sqrt()), 1.0, 0.04)?;
        }
        println!("{:?}", s.series(POSITION, |q| q.percentiles[4] / q.sd));
        Ok(())
    })]
}
