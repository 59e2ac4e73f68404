//! Recordings: columns of numbers from a file, with what is wrong with them found and said.
//!
//! [`read`](fn@read) brings the columns asked for into memory on a uniform clock; [`stream`] passes
//! a file of any length. Both look through the file first ([`plan`]), so they agree on its clock;
//! rows in the file = rows used + rows `dropped`. Not for judging physics: a gap or a clipped rail
//! is reported here, what it means is `diagnosis`' business.

#![warn(unreachable_pub)]

pub mod array;
pub mod budget;
pub mod bytes;
pub mod cells;
pub mod clock;
pub mod clock_column;
pub mod decimal;
pub mod decompress;
pub mod disturbance;
pub mod dropped;
pub mod element;
pub mod feed;
pub mod finding;
pub mod format;
pub mod formats;
pub mod glitch;
pub mod headings;
pub mod health;
pub mod in_memory;
pub mod inertial;
pub mod input;
pub mod inspection;
pub mod limits;
pub mod lines;
pub mod lost;
pub mod memory;
#[cfg(any(feature = "rosbag", feature = "mcap", feature = "db3"))]
pub mod messages;
pub mod noise;
pub mod pack;
pub mod pieces;
pub mod plan;
pub mod read;
pub mod reader;
pub mod records;
pub mod regular;
pub mod repeats;
pub mod request;
pub mod roles;
pub mod rows;
pub mod run;
pub mod scale;
pub mod series;
pub mod source;
pub mod stream;
pub mod table;
pub mod text;
pub mod time_unit;
pub mod trajectory;
pub mod undisturbed;
pub mod unit;
pub mod walk;
#[cfg(feature = "zstd")]
pub mod zstandard;

// The crates below, under the names by which files here call them.
use proofmass_base::{control, document, error, escape, number, parallel, units};
use proofmass_numerics::{numerics, rng};

pub use in_memory::{Averaged, Column, Recording};
pub use limits::FILL_LIMIT;
pub use memory::Memory;
pub use read::read;
pub use request::Request;
