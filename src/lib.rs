//! How far will this inertial sensor drift, which error is to blame, and what physics does my model
//! of it leave out?
//!
//! Two flows, one simulator.
//!
//! ```text
//! study.toml → Study → Job (sensor × excitation × tolerances) → Backend (gpu | cpu, one kernel contract)
//!            → Partials → Statistics → Report
//! recording  → Recording → intake → simulation of base model and candidates → identification → selection
//!            → verdict → Report (and a repaired sensor, which a study can run)
//! ```
//!
//! Every folder of the first level under `src` is a crate, and this one is their facade. Cargo holds
//! the walls between crates; `tests/suite/architecture.rs` checks what it cannot: that imports
//! within a crate run one way, lowest layer first and each layer from left to right, without circles
//! among files.
//!
//! | crate | modules | answers |
//! |---|---|---|
//! | `base` | `units` `number` `escape` `signal` `error` `control` `progress` `document` `columns` `output` `shard` `parallel` | how we name, round, fail, read, write and share work among threads |
//! | `numerics` | `numerics` `rng` `statistics` | mathematics without a domain, random numbers, what ensembles are summed to |
//! | `physics` | `physics` `dynamics` | the laws of a proof mass, one file each |
//! | `recording` | `recording` | files, clocks, units, findings |
//! | `scenario` | `sensor` `excitation` `navigation` `motion` | sensors, what moves them, closed forms of their drift |
//! | `kernel` `study` | `kernel` `study` | the contract between host and device; what to simulate |
//! | `simulate` | `backend` `ensemble` `drift` `strapdown` `decision` `validation` | study × backend → statistics → envelopes, error budget; requirements |
//! | `diagnosis` | `diagnosis` | what physics was left out |
//! | `report` `export` | `report` `export` | figures, tables, pages; configurations for other tools |
//! | `map` `paper` `trial` `benchmark` | `map` `paper` `trial` `benchmark` | the tool put to the test |
//! | `cli` `python` | `cli` `python` | the commands; the same for Python |
//!
//! An accelerometer whose bias b differs from part to part drifts by ½ b t²:
//!
//! ```
//! use std::path::Path;
//! use proofmass::{control::Control, drift, ensemble, statistics::quantity, study};
//!
//! let text = "members = 4096\nduration_s = 2.0\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n";
//! let study = study::parse("drift", text, Path::new("."))?;
//! let drift = drift::answer(&study, &Control::silent(), |job, _| ensemble::run(job, &ensemble::Options::default()))?;
//! let sd_m = drift.at_report(quantity::POSITION).last().map_or(0.0, |summary| summary.sd);
//! let expected_m = 0.5 * 9.80665e-3 * 2.0 * 2.0;
//! // Five standard errors of a standard deviation over 4096 members.
//! assert!((sd_m / expected_m - 1.0).abs() < 5.0 / (2.0_f64 * 4096.0).sqrt());
//! # Ok::<(), proofmass::error::Error>(())
//! ```
//!
//! As a dependency with `default-features = false` the crate contains the simulator on the CPU, the
//! diagnosis, and recordings as text. The features `cli`, `formats`, `gpu` and `plots` add the
//! command line, further file formats, GPU kernels, and figures with report pages.
//!
//! Glossary: *member*, one noisy sensor of an ensemble; *step*, one integration step; *sample*, one
//! reading; *tile*, members × steps in one submission; *effect*, physics that a base model leaves
//! out; *candidate*, an effect that the library can name; *null*, a recording without any effect.

pub use proofmass_base::{
    columns, control, document, error, escape, number, output, parallel, progress, shard, signal, units,
};
#[cfg(feature = "cli")]
pub use proofmass_benchmark as benchmark;
#[cfg(feature = "cli")]
pub use proofmass_cli as cli;
pub use proofmass_diagnosis as diagnosis;
pub use proofmass_export as export;
pub use proofmass_kernel as kernel;
#[cfg(feature = "cli")]
pub use proofmass_map as map;
pub use proofmass_numerics::{numerics, rng, statistics};
#[cfg(feature = "cli")]
pub use proofmass_paper as paper;
pub use proofmass_physics::{self as physics, dynamics};
pub use proofmass_recording as recording;
#[cfg(feature = "plots")]
pub use proofmass_report as report;
pub use proofmass_scenario::{excitation, motion, navigation, sensor};
pub use proofmass_simulate::{backend, decision, drift, ensemble, strapdown, validation};
pub use proofmass_study as study;
#[cfg(feature = "cli")]
pub use proofmass_trial as trial;
