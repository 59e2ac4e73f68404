//! One measurement: what was done, where, how fast, and how its time is taken.

use std::time::Instant;

use proofmass_base::control::Control;
use proofmass_base::error::Result;

/// One measured rate: work, machine, precision and timing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// Name of the work unit.
    pub work: String,
    /// "cpu", or the adapter's name.
    pub place: String,
    /// "f32" or "f64".
    pub precision: String,
    /// Members at a time.
    pub members: u64,
    /// Shortest of several runs, s.
    pub seconds: f64,
    /// Units of work per second.
    pub per_second: f64,
    /// Unit of work that is counted.
    pub unit: String,
    /// Vector instructions per unit, where they were counted.
    pub instructions: Option<f64>,
    /// Bytes to and from memory per unit, where they were counted.
    pub bytes: Option<f64>,
    /// Share of the machine's multiply-add peak that these instructions take.
    pub share_of_peak: Option<f64>,
}

impl Row {
    /// The same with what a unit costs in vector instructions.
    pub fn counted(mut self, instructions: f64) -> Self {
        self.instructions = Some(instructions);
        self
    }
}

/// Runs until half a second and three runs have passed, or once if that takes over three seconds;
/// the shortest time of one. A short first run is not counted.
fn shortest_s(control: &Control, mut run: impl FnMut() -> Result<()>) -> Result<f64> {
    let go_on = || control.go_on().map_err(|s| s.during("could not finish the measurements", "run them again"));
    let begun = Instant::now();
    go_on()?;
    run()?;
    let first = begun.elapsed().as_secs_f64();
    if first > 3.0 {
        return Ok(first);
    }
    let (begun, mut shortest, mut runs) = (Instant::now(), f64::INFINITY, 0);
    while runs < 3 || begun.elapsed().as_secs_f64() < 0.5 {
        let one = Instant::now();
        run()?;
        shortest = one.elapsed().as_secs_f64().min(shortest);
        runs += 1;
        go_on()?;
    }
    Ok(shortest)
}

/// Times work that is done in this many units.
///
/// # Errors
/// As the work; stopped.
pub(crate) fn row(
    control: &Control,
    work: &str,
    precision: &str,
    members: u64,
    units: f64,
    unit: &str,
    run: impl FnMut() -> Result<()>,
) -> Result<Row> {
    let seconds = shortest_s(control, run)?;
    Ok(Row {
        work: work.to_owned(),
        place: "cpu".to_owned(),
        precision: precision.to_owned(),
        members,
        seconds,
        per_second: units / seconds,
        unit: unit.to_owned(),
        instructions: None,
        bytes: None,
        share_of_peak: None,
    })
}
