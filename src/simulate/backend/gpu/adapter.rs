//! The adapters of this machine, and which of them is best.

use super::guard;
use crate::backend::adapter::Adapter;

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

/// Adapters, best first: hardware before software, discrete before integrated, Vulkan before
/// OpenGL.
pub(super) fn adapters() -> Vec<(Adapter, wgpu::Adapter)> {
    let found = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::all()));
    let mut adapters: Vec<(Adapter, wgpu::Adapter)> = found.into_iter().map(|a| (describe(&a), a)).collect();
    adapters.retain(|(_, a)| a.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS));
    let rank = |kind: &str| ["discrete", "integrated", "virtual", "other", "software"].iter().position(|k| *k == kind);
    adapters.sort_by_key(|(described, a)| (rank(described.kind), a.get_info().backend == wgpu::Backend::Gl));
    adapters
}

fn describe(adapter: &wgpu::Adapter) -> Adapter {
    let info = adapter.get_info();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "other",
    };
    let driver = [info.driver.as_str(), info.driver_info.as_str()];
    let driver: Vec<&str> = driver.into_iter().filter(|d| !d.is_empty()).collect();
    let limits = adapter.limits();
    Adapter {
        // OpenGL drivers call themselves anything; the name of Mesa's software rasteriser gives it
        // away.
        hardware: !matches!(kind, "software" | "other") && !info.name.to_lowercase().contains("llvmpipe"),
        name: info.name,
        kind,
        driver: format!("{} ({})", driver.join(" "), info.backend),
        int64: adapter.features().contains(wgpu::Features::SHADER_INT64),
        largest_binding: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
    }
}

/// The adapters of this machine that can compute, best first.
pub fn list() -> Vec<Adapter> {
    let list = || adapters().into_iter().map(|(described, _)| described).collect();
    // A driver that cannot even be asked has no adapter to offer.
    guard::guarded(list).unwrap_or_default()
}
