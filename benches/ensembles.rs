//! The work units of `proofmass bench` under criterion, for changes that one wants to see to a per cent.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::{Backend, Batch};
use proofmass::benchmark::{duffing, work};
use proofmass::kernel::cpu::lanes::Level;

fn unit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("duffing");
    group.sample_size(10).throughput(Throughput::Elements((duffing::MEMBERS * duffing::STEPS) as u64));
    let problem = duffing::Problem::<f32>::new();
    for level in Level::available() {
        for (noise, name) in [(false, "quiet"), (true, "noisy")] {
            group.bench_function(format!("{name} {}", level.name()), |b| b.iter(|| problem.run(noise, level)));
        }
    }
    group.finish();
}

fn ensembles(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ensemble");
    group.sample_size(10).throughput(Throughput::Elements(8192 * 4096));
    for precision in [Precision::F32, Precision::F64] {
        let mut cpu = Cpu { precision, ..Cpu::default() };
        for (name, job) in work::ensembles(8192) {
            let batch = Batch { job: &job, members: 0..8192, bins: &[], progress: &|_| () };
            group.bench_function(format!("{name}, {precision:?}"), |b| b.iter(|| cpu.run(&batch).is_ok()));
        }
    }
    group.finish();
}

criterion_group!(benches, unit, ensembles);
criterion_main!(benches);
