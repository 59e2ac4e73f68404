//! The work units of `proofmass bench` under criterion, for changes that one wants to see to a per cent.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::orbits::{Device, explore_on};
use proofmass::backend::{Backend, Batch};
use proofmass::benchmark::{DIFFUSION, LORENZ, diffusion, duffing, lorenz, work};
use proofmass::control::Control;
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
            let batch = Batch::whole(&job, 0..8192);
            group.bench_function(format!("{name}, {precision:?}"), |b| b.iter(|| cpu.run(&batch).is_ok()));
        }
    }
    group.finish();
}

fn yardsticks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("yardsticks");
    group.sample_size(10);
    let level = Level::best();
    group.throughput(Throughput::Elements((lorenz::MEMBERS * lorenz::STEPS) as u64));
    group.bench_function(LORENZ, |b| b.iter(|| lorenz::run::<f32>(level)));
    group.throughput(Throughput::Elements((diffusion::MEMBERS * diffusion::STEPS) as u64));
    group.bench_function(DIFFUSION, |b| b.iter(|| diffusion::run::<f32>(level)));
    let (points, plan) = work::orbits(8192);
    group.throughput(Throughput::Elements(work::orbit_steps(points.len(), &plan) as u64));
    group.bench_function("Lyapunov map", |b| {
        b.iter(|| explore_on(Device::Cpu, &points, &plan, &Control::silent()).is_ok())
    });
    group.finish();
}

criterion_group!(benches, unit, ensembles, yardsticks);
criterion_main!(benches);
