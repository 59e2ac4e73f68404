//! The adapters of this machine, and which of them is best.

use super::guard;
use crate::backend::adapter::Adapter;

/// Adapters, best first: hardware before software, discrete before integrated, Vulkan before
/// OpenGL. Where there is hardware, OpenGL is not even asked: its driver takes half a second.
pub(super) fn adapters(only_hardware: bool) -> Vec<(Adapter, wgpu::Adapter)> {
    let mut found = of(wgpu::Backends::PRIMARY);
    if !found.iter().any(|(described, _)| described.hardware) {
        found.extend(of(wgpu::Backends::SECONDARY));
        sort(&mut found);
    }
    found.retain(|(described, _)| described.hardware || !only_hardware);
    found
}

/// All adapters of these kinds of driver, in the same order.
fn of(backends: wgpu::Backends) -> Vec<(Adapter, wgpu::Adapter)> {
    let mut asked = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    asked.backends &= backends;
    let found = pollster::block_on(wgpu::Instance::new(asked).enumerate_adapters(backends));
    let mut adapters: Vec<(Adapter, wgpu::Adapter)> = found.into_iter().map(|a| (describe(&a), a)).collect();
    adapters.retain(|(_, a)| a.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS));
    sort(&mut adapters);
    adapters
}

fn sort(adapters: &mut [(Adapter, wgpu::Adapter)]) {
    let rank = |kind: &str| ["discrete", "integrated", "virtual", "other", "software"].iter().position(|k| *k == kind);
    adapters.sort_by_key(|(described, a)| (rank(described.kind), a.get_info().backend == wgpu::Backend::Gl));
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

/// All adapters of this machine that can compute, best first.
pub(super) fn list() -> Vec<Adapter> {
    let list = || of(wgpu::Backends::all()).into_iter().map(|(described, _)| described).collect();
    // A driver that cannot even be asked has no adapter to offer.
    guard::guarded(list).unwrap_or_default()
}
