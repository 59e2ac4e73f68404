//! The GPU of a build without the feature `gpu`: none is ever found, so that what can use one needs
//! no second way.

use std::convert::Infallible;

use crate::backend::adapter::Adapter;
use crate::error::{Error, Result};

/// An open device, of which there is none.
pub struct Gpu {
    /// The adapter it was opened on.
    pub adapter: Adapter,
    never: Infallible,
}

/// The adapters of this machine that can compute: none.
pub fn list() -> Vec<Adapter> {
    Vec::new()
}

impl Gpu {
    /// Opens the best adapter.
    ///
    /// # Errors
    /// Always.
    pub fn open() -> Result<Self> {
        let cause = "this build has no GPU kernels";
        Err(Error::new("could not use a GPU", cause, "build it with the feature `gpu`, or use the CPU"))
    }

    /// Opens one of several adapters as good as the best.
    ///
    /// # Errors
    /// Always.
    pub fn open_nth(_: usize) -> Result<Self> {
        Self::open()
    }

    /// Opens one of several adapters of hardware as good as the best; there is none.
    ///
    /// # Errors
    /// None.
    pub fn hardware_nth(_: usize) -> Result<Option<Self>> {
        Ok(None)
    }

    /// Opens the best adapter that is hardware; there is none.
    ///
    /// # Errors
    /// None.
    pub fn hardware() -> Result<Option<Self>> {
        Ok(None)
    }

    /// Returns whether the device has failed.
    pub fn has_failed(&self) -> bool {
        match self.never {}
    }
}

/// Ensembles on a GPU.
pub mod simulate {
    use std::sync::Arc;

    use super::Gpu;
    use crate::backend::{Backend, Batch, Ran};
    use crate::error::Result;
    use crate::kernel::job::Job;
    use crate::statistics::Machine;

    /// Ensembles on a GPU.
    pub struct Ensembles(Arc<Gpu>);

    impl Ensembles {
        /// On an open device.
        pub fn on(gpu: Arc<Gpu>) -> Self {
            Self(gpu)
        }
    }

    impl Backend for Ensembles {
        fn machine(&self, _: &Job) -> Machine {
            match self.0.never {}
        }

        fn batch_members(&self, _: &Job) -> Result<u64> {
            match self.0.never {}
        }

        fn run(&mut self, _: &Batch<'_>) -> Result<Ran> {
            match self.0.never {}
        }
    }
}

/// Six-axis ensembles on a GPU.
pub mod flight {
    use std::sync::Arc;

    use super::Gpu;
    use crate::backend::flight::{FlightBackend, FlightBatch, Sums};
    use crate::error::Result;
    use crate::kernel::flight::Flight;
    use crate::statistics::Machine;

    /// Six-axis ensembles on a GPU.
    pub struct Flights(Arc<Gpu>);

    impl Flights {
        /// On an open device.
        pub fn on(gpu: Arc<Gpu>) -> Self {
            Self(gpu)
        }
    }

    impl FlightBackend for Flights {
        fn machine(&self, _: &Flight) -> Machine {
            match self.0.never {}
        }

        fn batch_members(&self) -> u64 {
            match self.0.never {}
        }

        fn run(&mut self, _: &FlightBatch<'_>) -> Result<Option<Vec<Sums>>> {
            match self.0.never {}
        }
    }
}

/// Map kernels on a GPU.
pub mod orbits {
    use super::Gpu;
    use crate::control::Control;
    use crate::error::Result;
    use crate::kernel::orbit::{Orbit, Plan, Point};

    /// Integrates every point on the device.
    ///
    /// # Errors
    /// None: there is no device.
    pub fn explore(gpu: &Gpu, _: &[Point], _: &Plan, _: &Control) -> Result<Vec<Orbit>> {
        match gpu.never {}
    }
}

/// The most multiply-adds per second that a device can do.
pub mod peak {
    use super::Gpu;
    use crate::error::Result;

    /// Keeps the whole device busy for a while.
    ///
    /// # Errors
    /// None: there is no device.
    pub fn multiply_adds(gpu: &Gpu) -> Result<f64> {
        match gpu.never {}
    }
}
