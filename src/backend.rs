//! Where kernels run: CPU lanes, or a GPU.

pub mod orbits;
