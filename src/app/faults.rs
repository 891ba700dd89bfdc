//! Hears of a GPU that fails on its own, rather than in answer to a call.

use std::sync::{Arc, Mutex, PoisonError};

use crate::gpu::{Gpu, GpuError};

/// The first fault of a device: it was lost, or an error reached nobody else.
pub struct Faults(Arc<Mutex<Option<String>>>);

impl Faults {
    /// Listens to the device of `gpu` from now on.
    pub fn watch(gpu: &Gpu) -> Self {
        let first = Arc::new(Mutex::new(None));
        let heard = first.clone();
        let report = Arc::new(move |message: String| {
            let mut first = heard.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert(message);
        });
        let lost = report.clone();
        gpu.device.set_device_lost_callback(move |_, message| {
            lost(if message.is_empty() {
                "the device was lost".to_owned()
            } else {
                format!("the device was lost: {message}")
            });
        });
        gpu.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                report(error.to_string())
            }));
        Self(first)
    }

    /// What failed first, if anything did.
    pub fn first(&self) -> Option<GpuError> {
        let first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.clone().map(GpuError::Device)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::ShaderChecks;

    #[test]
    fn a_lost_device_is_heard_of() {
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need an adapter");
        let faults = Faults::watch(&gpu);
        assert!(faults.first().is_none());
        gpu.device.destroy();
        // Waiting for a device that is gone may itself be refused.
        let _ = gpu.wait();
        let message = faults.first().expect("it is gone").to_string();
        assert!(message.contains("the device was lost"), "{message}");
    }
}
