//! One engine for what a model leaves out, whatever the kind of recording.
//!
//! A kind gives a [`kind::Kind`]: a space of laws, and how a set of them is simulated. The engine
//! knows no physics. It fits sets of laws by free simulation ([`fit`]), scores each on blocks of
//! samples that were left out of the fit ([`linear`]), searches the sets best first ([`search`]),
//! and says which names hold ([`evidence`], [`names`]). Every level that can change what is said is
//! in [`levels`], with its calibration.
//!
//! Noise is part of every model and never a rival of physics: all errors are of free simulation, so
//! that no reading corrects a model, and all uncertainties are scatter between blocks, so that the
//! colour of the noise and the fineness of sampling do not matter.

pub(crate) mod evidence;
mod expanded;
pub(crate) mod fit;
pub(crate) mod kind;
pub(crate) mod levels;
pub(crate) mod linear;
pub(crate) mod names;
mod prospect;
mod prospects;
pub(crate) mod search;
