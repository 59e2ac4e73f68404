//! A compute device: adapters, buffers, kernels made when first asked for, dispatches. This and
//! `memory` are the only files that name wgpu.
//!
//! Nothing here knows what is computed; `gpu::simulate` and the map kernels build on it. A device
//! that is lost or refuses is an `Err`, never a panic: every call of wgpu that can fail goes
//! through `guard`. Opening costs tens of milliseconds, so nothing is opened before it is used.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use self::adapter::adapters;
pub use self::memory::{Buffer, Piece};
use super::adapter::Adapter;
use crate::error::{Error, Result};
use crate::kernel::integrator::Integrator;
use crate::kernel::source::{self, Shader};
use crate::statistics::Machine;

mod adapter;
pub mod flight;
mod guard;
mod memory;
pub mod orbits;
mod pace;
pub mod peak;
pub mod simulate;

/// An open device with its queue and compiled kernels: one for all who ask for it.
#[derive(Clone)]
pub struct Gpu {
    /// The adapter it was opened on.
    pub adapter: Adapter,
    device: wgpu::Device,
    queue: wgpu::Queue,
    lost: Arc<Mutex<Option<String>>>,
    failed: Arc<AtomicBool>,
    kernels: Arc<Mutex<HashMap<String, Kernel>>>,
}

/// A compiled kernel. Its buffers are bound in the order of their binding numbers, all in group 0.
#[derive(Debug, Clone)]
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// A kernel with its buffers and the number of workgroups to run.
#[derive(Debug, Clone)]
pub struct Dispatch<'a> {
    /// Kernel to run.
    pub kernel: &'a Kernel,
    /// Buffers in the order of their binding numbers.
    pub buffers: Vec<&'a Buffer>,
    /// Number of workgroups.
    pub workgroups: u32,
}

/// Work that was handed to the device.
#[derive(Debug)]
pub struct Submission(wgpu::SubmissionIndex);

/// No submission is meant to take longer than 100 ms; one that takes this many seconds has hung.
/// `PROOFMASS_GPU_PATIENCE_S` sets another number.
const PATIENCE_S: f64 = 60.0;

fn timeout() -> Duration {
    let given = std::env::var("PROOFMASS_GPU_PATIENCE_S").ok().and_then(|text| text.parse().ok());
    Duration::try_from_secs_f64(given.unwrap_or(PATIENCE_S)).unwrap_or(Duration::from_secs(60))
}

const ATTEMPT: &str = "could not compute on the GPU";
const USE_CPU: &str = "use --backend cpu";

/// Says which adapters are wanted: of those that are as good as the best, the one of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wanted {
    only_hardware: bool,
    nth: usize,
}

/// The devices that this process has opened, by what was wanted. They stay open: a driver takes a
/// second for each, and NVIDIA's (580) stops for good where several threads open and close some at
/// a time.
static OPENED: Mutex<Vec<(Wanted, Gpu)>> = Mutex::new(Vec::new());

/// The best of the wanted adapters, opened, once unless it has failed since.
fn opened(wanted: Wanted) -> Result<Option<Gpu>> {
    let mut all = locked(&OPENED);
    all.retain(|(_, gpu)| !gpu.has_failed());
    if let Some((_, gpu)) = all.iter().find(|(of, _)| *of == wanted) {
        return Ok(Some(gpu.clone()));
    }
    let open = || {
        let mut found = adapters(wanted.only_hardware);
        let rank = |(described, adapter): &(Adapter, wgpu::Adapter)| (described.kind, adapter.get_info().backend);
        let equal = found.first().map_or(1, |best| found.iter().filter(|other| rank(other) == rank(best)).count());
        // The best come first.
        let found = if found.is_empty() { None } else { Some(found.swap_remove(wanted.nth % equal)) };
        found.map(|(described, adapter)| Gpu::on(described, &adapter)).transpose()
    };
    let gpu = guard::guarded(open).unwrap_or_else(|said| Err(Error::new("could not open the GPU", said, USE_CPU)))?;
    all.extend(gpu.clone().map(|gpu| (wanted, gpu)));
    Ok(gpu)
}

/// The adapters of this machine that can compute, best first.
pub fn list() -> Vec<Adapter> {
    let _alone = locked(&OPENED);
    adapter::list()
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Gpu {
    /// The device, for provenance.
    pub(super) fn machine(&self, integrator: Integrator) -> Machine {
        Machine {
            kind: "gpu".to_owned(),
            name: self.adapter.name.clone(),
            driver: self.adapter.driver.clone(),
            precision: "f32".to_owned(),
            fused_multiply_add: "as the driver compiles fma()".to_owned(),
            integrator: integrator.to_string(),
        }
    }

    /// Opens the best adapter, in software if there is no other.
    ///
    /// # Errors
    /// There is none, or it refuses.
    pub fn open() -> Result<Self> {
        Self::open_nth(0)
    }

    /// The same, or of several adapters as good as the best the one of this number, counted round.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_nth(nth: usize) -> Result<Self> {
        opened(Wanted { only_hardware: false, nth })?.ok_or_else(|| {
            Error::new(
                "could not use a GPU",
                "no adapter was found by Vulkan, Metal, DirectX 12 or OpenGL",
                "install a driver (Debian: libvulkan1 and, for one in software, mesa-vulkan-drivers), or use \
                 --backend cpu",
            )
        })
    }

    /// Opens the best adapter that is hardware; `None` where there is none.
    ///
    /// # Errors
    /// It refuses.
    pub fn hardware() -> Result<Option<Self>> {
        Self::hardware_nth(0)
    }

    /// The same, or of several adapters as good as the best the one of this number, counted round.
    ///
    /// # Errors
    /// It refuses.
    pub fn hardware_nth(nth: usize) -> Result<Option<Self>> {
        opened(Wanted { only_hardware: true, nth })
    }

    fn on(described: Adapter, adapter: &wgpu::Adapter) -> Result<Self> {
        let mut features = wgpu::Features::empty();
        features.set(wgpu::Features::SHADER_INT64, described.int64);
        let request = wgpu::DeviceDescriptor {
            label: None,
            required_features: features,
            required_limits: adapter.limits(),
            experimental_features: wgpu::ExperimentalFeatures::disabled(),
            memory_hints: wgpu::MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request))
            .map_err(|e| Error::new(format!("could not open {}", described.name), e.to_string(), USE_CPU))?;
        let lost = Arc::new(Mutex::new(None));
        let (by_loss, by_error) = (lost.clone(), lost.clone());
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                *locked(&by_loss) = Some(format!("the device was lost ({reason:?}): {message}"));
            }
        });
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            locked(&by_error).get_or_insert(error.to_string());
        }));
        Ok(Self { adapter: described, device, queue, lost, failed: Arc::default(), kernels: Arc::default() })
    }

    /// Returns whether anything has failed on this device since it was opened. It must not be used
    /// any more.
    pub fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Does something with the device; whatever goes wrong, a panic of the library included, is an
    /// error and noted.
    fn guarded<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let done = guard::guarded(work).unwrap_or_else(|said| Err(Error::new(ATTEMPT, said, USE_CPU)));
        done.inspect_err(|_| self.failed.store(true, Ordering::Relaxed))
    }

    /// An error if the device was lost or refused something since it was opened.
    ///
    /// # Errors
    /// The sentence that it said.
    fn healthy(&self) -> Result<()> {
        match &*locked(&self.lost) {
            None => Ok(()),
            Some(what) => Err(Error::new(ATTEMPT, what.clone(), USE_CPU)),
        }
    }

    /// Does something whose refusal the device tells later, and waits for the answer.
    fn caught<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T> {
        self.guarded(|| self.scoped(what, work))
    }

    fn scoped<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let done = work();
        let invalid = pollster::block_on(validation.pop());
        let full = pollster::block_on(memory.pop());
        if let Some(error) = full {
            let hint = "use fewer members at a time, or --backend cpu";
            return Err(Error::new(format!("could not {what} on the GPU"), error.to_string(), hint));
        }
        if let Some(error) = invalid {
            return Err(Error::new(format!("could not {what} on the GPU"), error.to_string(), USE_CPU));
        }
        self.healthy()?;
        Ok(done)
    }

    /// The kernel of a shader with these override constants; compiled the first time.
    ///
    /// # Errors
    /// The driver refuses it.
    pub fn kernel(&self, shader: &Shader, constants: &[(&str, f64)]) -> Result<Kernel> {
        // The text belongs to the key: shaders of one name differ by the laws that they were
        // assembled from.
        let key = format!("{} {constants:?}\n{}", shader.name, shader.text);
        if let Some(kernel) = locked(&self.kernels).get(&key) {
            return Ok(kernel.clone());
        }
        let kernel = self.caught(&format!("compile the kernel {}", shader.name), || {
            let described = wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
            };
            // A second counter in every loop costs 6 % of the full path on llvmpipe.
            let checks =
                wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..wgpu::ShaderRuntimeChecks::checked() };
            // SAFETY: indices stay checked, and every loop of our shaders counts to a bound: a test
            // reads each of them.
            let module = unsafe { self.device.create_shader_module_trusted(described, checks) };
            let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                module: &module,
                entry_point: Some(shader.name),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            });
            Kernel { layout: pipeline.get_bind_group_layout(0), pipeline }
        })?;
        locked(&self.kernels).insert(key, kernel.clone());
        Ok(kernel)
    }

    /// Hands dispatches to the device, one after the other.
    ///
    /// # Errors
    /// The device was lost; buffers that do not fit their bindings.
    pub fn submit(&self, dispatches: &[Dispatch<'_>]) -> Result<Submission> {
        let index = self.caught("dispatch", || {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            for d in dispatches {
                let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
                    .zip(&d.buffers)
                    .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.binding() })
                    .collect();
                let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: None,
                    layout: &d.kernel.layout,
                    entries: &entries,
                });
                pass.set_pipeline(&d.kernel.pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(d.workgroups, 1, 1);
            }
            drop(pass);
            self.queue.submit([encoder.finish()])
        })?;
        Ok(Submission(index))
    }

    /// Waits until a submission is done.
    ///
    /// # Errors
    /// It hangs, or the device was lost.
    pub fn wait(&self, submission: &Submission) -> Result<()> {
        self.guarded(|| self.poll(Some(submission.0.clone())))
    }

    fn poll(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<()> {
        let timeout = timeout();
        let wait = wgpu::PollType::Wait { submission_index, timeout: Some(timeout) };
        self.device.poll(wait).map_err(|e| {
            let cause = match e {
                wgpu::PollError::Timeout => format!("the device has not answered for {} s", timeout.as_secs_f64()),
                other => other.to_string(),
            };
            Error::new(ATTEMPT, cause, USE_CPU)
        })?;
        self.healthy()
    }

    /// Returns what a plain and a compensated f32 sum keep of 1 when 2²⁵ is added and taken away
    /// again: 0 and 1 where compensation is alive.
    ///
    /// # Errors
    /// As a dispatch.
    pub fn compensation(&self) -> Result<[f32; 2]> {
        let kernel = self.kernel(&source::compensation(), &[])?;
        let numbers = self.upload(bytemuck::cast_slice(&[1.0_f32, 33_554_432.0, 0.0, 0.0]))?;
        self.submit(&[Dispatch { kernel: &kernel, buffers: vec![&numbers], workgroups: 1 }])?;
        let bytes = self.read(&numbers, 8)?;
        let read: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        Ok([read[0], read[1]])
    }
}
