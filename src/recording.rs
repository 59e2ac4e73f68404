//! Recordings: columns of numbers from a CSV file, with what is wrong with them found and said.
//!
//! [`read`](fn@read) brings the columns asked for into memory on a uniform clock; [`stream`] passes a file of any length. Both look
//! through the file first ([`plan`]), so they agree on its clock; rows in the file = rows used + rows `dropped`. Not for
//! judging physics: a gap or a clipped rail is reported here, what it means is `diagnosis`' business.

pub mod cells;
pub mod clock;
pub mod dropped;
pub mod finding;
pub mod format;
pub mod glitch;
pub mod headings;
pub mod health;
pub mod in_memory;
pub mod limits;
pub mod lines;
pub mod noise;
pub mod plan;
pub mod read;
pub mod repeats;
pub mod request;
pub mod rows;
pub mod series;
pub mod stream;
pub mod time_unit;
pub mod unit;

pub use in_memory::{Averaged, Column, Recording};
pub use limits::FILL_LIMIT;
pub use read::read;
pub use request::Request;
