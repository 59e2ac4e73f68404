//! A continuous motion through poses: a uniform B-spline of order six, whose second derivatives of
//! position and attitude are twice differentiable themselves.
//!
//! `basis` → `curve` → `fit` → `choice`: weights of the control points, the motion they make, the
//! control points that follow poses closest, how many of them measured poses can carry. Position
//! and attitude are split (R³ × SO(3)), attitude in cumulative form, so that rate and angular
//! acceleration are exact: Sommer, Usenko, Schubert, Demmel, Cremers, *Efficient derivative
//! computation for cumulative B-splines on Lie groups*, CVPR 2020. In position the spline
//! approaches smooth poses by the sixth power of the distance of its knots, in attitude by the
//! third where the axis of rotation turns (`fit`): what is left is said as a departure.

pub mod basis;
pub mod choice;
pub mod curve;
pub mod fit;

pub use choice::through;
pub use curve::{Motion, Spline};
pub use fit::{Departure, Knots, fit};
