//! `cargo bench`: the rows of `proofmass bench` on the CPU, by the same harness, for changes that
//! one wants to see to a per cent. `cargo bench -- gpu` adds those of the best adapter.

use std::sync::Arc;

use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::benchmark;
use proofmass::benchmark::page;
use proofmass::control::Control;
use proofmass::error::Result;

fn main() -> Result<()> {
    let control = Control::silent();
    let progress = control.stage("measuring", 0);
    let mut rows = benchmark::cpu(&control, &progress)?;
    if std::env::args().any(|argument| argument == "gpu") {
        let gpu = Arc::new(Gpu::open()?);
        rows.extend(benchmark::gpu(&gpu, &mut Ensembles::on(gpu.clone()), &control, &progress)?);
    }
    println!("{}", page::table(&rows));
    Ok(())
}
