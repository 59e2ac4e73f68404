//! The work unit that other tools print too, as rows of CSV, so that all can be timed by one
//! script.

use std::time::Instant;

use super::{duffing, ensemble, work};
use proofmass_base::control::Control;
use proofmass_kernel::cpu::lanes::Level;
use proofmass_numerics::numerics::elementary::Real;
use proofmass_simulate::backend::cpu::{Cpu, Precision};

/// Rows `peer,config,dtype,work,seconds_per_run,others_cpu_fraction,x_check` of the work unit that
/// other tools print too.
pub fn rows() -> Vec<String> {
    fn unit<T: Real>(dtype: &str) -> Vec<String> {
        let problem = duffing::Problem::<T>::new();
        let one = |(noise, work): (bool, &str)| {
            let (begun, mut runs) = (Instant::now(), 0);
            let mut x = problem.run(noise, Level::best());
            let warm = Instant::now();
            while runs == 0 || begun.elapsed().as_secs_f64() < 0.5 {
                x = problem.run(noise, Level::best());
                runs += 1;
            }
            let seconds = warm.elapsed().as_secs_f64() / f64::from(runs);
            format!("proofmass,64 lanes {},{dtype},{work},{seconds:.5},0.000,{x:.9e}", Level::best().name())
        };
        [(false, "rk4"), (true, "rk4+noise")].map(one).into()
    }
    let full = |(precision, dtype): (Precision, &str)| {
        let mut cpu = Cpu { precision, ..Cpu::default() };
        let job = work::full(8192);
        let measured = ensemble(&Control::silent(), "full", "cpu", &mut cpu, &job).map_or(f64::NAN, |r| r.seconds);
        format!("proofmass,ensemble kernel {},{dtype},full,{measured:.5},0.000,nan", Level::best().name())
    };
    let mut all = unit::<f32>("float32");
    all.extend(unit::<f64>("float64"));
    all.extend([(Precision::F32, "float32"), (Precision::F64, "float64")].map(full));
    all
}
