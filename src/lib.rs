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
//! Imports run one way, lowest layer first and each layer from left to right, without circles among
//! files; `tests/suite/architecture.rs` checks this:
//!
//! | layer | modules | answers |
//! |---|---|---|
//! | 0 | `units` `number` `escape` `signal` `error` `control` `progress` `document` `columns` `output` `shard` `parallel` | how we name, round, fail, read, write and share work among threads |
//! | 1 | `numerics` | mathematics without a domain |
//! | 2 | `rng` `statistics` | random numbers and what ensembles are summed to |
//! | 3 | `physics` `recording` `sensor` `excitation` `navigation` `motion` `dynamics` | the physics, one idea each |
//! | 4 | `kernel` `study` | the contract between host and device; what to simulate |
//! | 5 | `backend` | CPU lanes or GPU |
//! | 6 | `ensemble` `drift` `strapdown` `decision` | study × backend → statistics → envelopes, closed forms, error budget; in six axes; requirements |
//! | 7 | `diagnosis` | what physics was left out |
//! | 8 | `map` `paper` `trial` `validation` `benchmark` | the tool put to the test |
//! | 9 | `report` `export` | figures, tables, pages; configurations for other tools |
//! | 10 | `cli` `python` | the commands; the same for Python |
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

// Here and not in Cargo.toml: tests and benches are binaries, where nothing is reached from
// outside.
#![warn(unreachable_pub)]
// Code that only a missing feature uses is not dead.
#![cfg_attr(
    not(all(feature = "cli", feature = "formats", feature = "gpu", feature = "plots")),
    allow(dead_code, unused_imports)
)]

pub mod backend;
pub mod benchmark;
#[cfg(feature = "cli")]
pub mod cli;
pub mod columns;
pub mod control;
pub mod decision;
pub mod diagnosis;
pub mod document;
pub mod drift;
pub mod dynamics;
pub mod ensemble;
pub mod error;
pub mod escape;
pub mod excitation;
pub mod export;
pub mod kernel;
pub mod map;
pub mod motion;
pub mod navigation;
pub mod number;
pub mod numerics;
pub mod output;
pub mod paper;
pub mod parallel;
pub mod physics;
pub mod progress;
#[cfg(feature = "python")]
pub mod python;
pub mod recording;
#[cfg(feature = "plots")]
pub mod report;
pub mod rng;
pub mod sensor;
pub mod shard;
pub mod signal;
pub mod statistics;
pub mod strapdown;
pub mod study;
pub mod trial;
pub mod units;
pub mod validation;
