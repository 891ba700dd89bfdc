//! Checks that enough memory is left before resources are created.

use super::{Gpu, GpuError};

/// Available main memory in bytes: `MemAvailable` of Linux. `None` on systems that do not report it.
pub fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

impl Gpu {
    /// Refuses sizes that a software adapter cannot get from main memory. GPUs do not report how much
    /// memory is left: see [`Gpu::making`].
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn check_memory(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        match available_memory() {
            Some(limit) if self.summary.is_software() && bytes > limit => Err(GpuError::TooLarge {
                what: what.to_owned(),
                bytes,
                adapter: self.summary.name.clone(),
                limit,
                limit_name: "memory available",
                remedy: "Choose a smaller world, layout or picture.",
            }),
            _ => Ok(()),
        }
    }

    /// Creates resources of `bytes` bytes in total.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] if the adapter lacks the memory; and those of `make`.
    pub fn making<T, E: From<GpuError>>(
        &self,
        what: &str,
        bytes: u64,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        self.check_memory(what, bytes)?;
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = make()?;
        match pollster::block_on(scope.pop()) {
            None => Ok(made),
            Some(_) => Err(E::from(GpuError::OutOfMemory {
                what: what.to_owned(),
                bytes,
                adapter: self.summary.name.clone(),
            })),
        }
    }
}
