//! Studies the paper's equation of motion: exact linear response, Duffing orbits, Lyapunov
//! exponents, fractal measures.
//!
//! Not for ensembles of noisy sensors (`kernel`, `backend`); these are the scalar f64 references
//! that the lanes and shaders are compared with, and the mathematics that turns orbits into
//! numbers.

pub mod bifurcation;
pub mod duffing;
pub mod estimate;
pub mod fractal;
pub mod linear;
pub mod lyapunov;
pub mod poincare;
