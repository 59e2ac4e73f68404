//! Names, numbers, errors and files that every part of proofmass shares.
//! The order of its modules stands in the table of the facade.

#![warn(unreachable_pub)]

pub mod columns;
pub mod control;
pub mod document;
pub mod error;
pub mod escape;
pub mod number;
pub mod output;
pub mod parallel;
pub mod progress;
pub mod shard;
pub mod signal;
pub mod units;
