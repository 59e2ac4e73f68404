//! CPU twins of the shaders, same names: 64 lanes per block, the time loop outside, written so that compilers vectorise.

pub mod lyapunov;
pub mod poincare;
