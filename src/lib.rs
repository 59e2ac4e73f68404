//! proofmass: how far will this inertial sensor drift, which error is to blame, and what physics does the model leave out?
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
//! Imports run one way, lowest layer first and each layer from left to right, and no two files import each other, directly or
//! through others; `tests/suite/architecture.rs` keeps this true:
//!
//! | layer | modules | answers |
//! |---|---|---|
//! | 0 | `units` `number` `escape` `signal` `error` `control` `progress` `document` `output` `parallel` | how we name, round, fail, read, write and share work among threads |
//! | 1 | `numerics` | mathematics without a domain |
//! | 2 | `rng` `statistics` | random numbers and what ensembles are summed to |
//! | 3 | `physics` `recording` `sensor` `excitation` `navigation` `motion` `dynamics` | the physics, one idea each |
//! | 4 | `kernel` `study` | the contract between host and device; what to simulate |
//! | 5 | `backend` | CPU lanes or GPU |
//! | 6 | `ensemble` `drift` | study × backend → statistics → envelopes, closed forms, error budget |
//! | 7 | `diagnosis` | what physics was left out |
//! | 8 | `map` `paper` `trial` `validation` `benchmark` | the tool put to the test |
//! | 9 | `report` `export` | figures, tables, pages; configurations for other tools |
//! | 10 | `cli` | the commands |
//!
//! Glossary: *member*, one noisy sensor of an ensemble; *step*, one integration step; *sample*, one reading; *tile*,
//! members × steps in one submission; *effect*, physics that a base model leaves out; *candidate*, an effect the library
//! can name; *null*, a recording without any.

pub mod backend;
pub mod benchmark;
pub mod cli;
pub mod control;
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
pub mod recording;
pub mod report;
pub mod rng;
pub mod sensor;
pub mod signal;
pub mod statistics;
pub mod study;
pub mod trial;
pub mod units;
pub mod validation;
