//! The machine that a run uses, as far as the system reports it.

use nvml_wrapper::{
    Nvml,
    enum_wrappers::device::{Clock, TemperatureSensor},
};
use sysinfo::System;

use super::super::model::{Adapter, Build, GpuState, Machine};
use crate::gpu::AdapterSummary;

pub fn build() -> Build {
    Build {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("GROTTO_COMMIT").to_owned(),
        profile: if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        }
        .to_owned(),
    }
}

/// The machine, before anything is measured.
pub fn machine(adapter: &AdapterSummary) -> Machine {
    // Where the system reports nothing, the architecture stands for the CPU.
    let mut system = System::new().ok();
    if let Some(system) = &mut system {
        system.refresh_cpu_all();
        system.refresh_memory();
    }
    let cpus = system.as_ref().map_or(&[][..], System::cpus);
    let cpu = cpus.first().map(|cpu| cpu.brand().trim().to_owned());
    Machine {
        cpu: cpu
            .filter(|name| !name.is_empty())
            .unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        cores: std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32),
        memory_bytes: system.as_ref().map_or(0, System::total_memory),
        os: System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.to_owned()),
        warm_up: String::new(),
        gpu_before: gpu_state(adapter),
        gpu_after: None,
    }
}

/// Clocks and power of the adapter now. `None` where no NVIDIA driver reports them.
pub fn gpu_state(adapter: &AdapterSummary) -> Option<GpuState> {
    if adapter.is_software() {
        return None;
    }
    let nvml = Nvml::init().ok()?;
    let mut devices = (0..nvml.device_count().ok()?).filter_map(|i| nvml.device_by_index(i).ok());
    let device = devices.find(|device| device.name().is_ok_and(|name| name == adapter.name))?;
    Some(GpuState {
        graphics_mhz: device.clock_info(Clock::Graphics).ok(),
        memory_mhz: device.clock_info(Clock::Memory).ok(),
        power_w: device.power_usage().ok().map(|mw| f64::from(mw) / 1e3),
        temperature_c: device.temperature(TemperatureSensor::Gpu).ok(),
    })
}

pub fn adapter(summary: &AdapterSummary) -> Adapter {
    Adapter {
        name: summary.name.clone(),
        kind: summary.kind.to_owned(),
        driver: summary.driver.clone(),
        backend: summary.backend.clone(),
    }
}
