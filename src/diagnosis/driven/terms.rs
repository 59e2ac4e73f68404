//! The laws that can be named and the list of them: what each states, its parameters, and what it does to a simulation.

pub mod base;
pub mod contact;
pub mod damping;
pub mod drift;
pub mod drive;
pub mod friction;
pub mod hysteresis;
pub mod lag;
pub mod law;
pub mod mode;
pub mod noise;
pub mod pickup;
pub mod quantisation;
pub mod readout;
pub mod scales;
pub mod spring;
pub mod term;
