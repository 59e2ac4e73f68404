//! A proof mass for the engine: its laws (`space`), how a set of them is simulated over segments of a
//! recording (`system`, `rows`, `coordinates`), and the search for those that a recording under an input follows
//! (`under_input`, `search`).

pub(in crate::driven) mod coordinates;
mod lines;
mod modes;
pub(in crate::driven) mod rows;
pub(in crate::driven) mod search;
pub(in crate::driven) mod space;
pub(in crate::driven) mod system;
pub(super) mod under_input;
