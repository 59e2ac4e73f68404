//! The most multiply-adds per second that a device can do, measured: what a kernel's speed there is
//! a share of.

use bytemuck::cast_slice;

use super::{Dispatch, Gpu};
use crate::error::Result;
use crate::kernel::layout::PEAK_WORKGROUP;
use crate::kernel::source;

/// Multiply-adds of one invocation: 512 rounds of four on vectors of four.
const EACH: f64 = 512.0 * 4.0 * 4.0;

/// Keeps the whole device busy for a while; returns the multiply-adds done, for a clock to divide.
///
/// # Errors
/// As a dispatch.
pub fn multiply_adds(gpu: &Gpu) -> Result<f64> {
    let kernel = gpu.kernel(&source::peak(), &[])?;
    let numbers = gpu.upload(cast_slice(&[0.999_f32, 1e-3, 0.0]))?;
    let workgroups: u32 = if gpu.adapter.hardware { 1 << 15 } else { 1 << 10 };
    let submission = gpu.submit(&[Dispatch { kernel: &kernel, buffers: vec![&numbers], workgroups }])?;
    gpu.wait(&submission)?;
    Ok(f64::from(workgroups) * f64::from(PEAK_WORKGROUP) * EACH)
}
