//! Describes a GPU adapter before it is opened.

/// An adapter of this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Name that the driver reports.
    pub name: String,
    /// "discrete", "integrated", "virtual", "software" or "other".
    pub kind: &'static str,
    /// Driver, its version, and the interface it is reached by.
    pub driver: String,
    /// Says whether it is a GPU rather than a software renderer.
    pub hardware: bool,
    /// 64-bit integers in shaders.
    pub int64: bool,
    /// Largest storage buffer that a kernel can see, bytes.
    pub largest_binding: u64,
}
