//! Watches for GPU errors that no call returns.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Gpu, GpuError};

/// The first error of a device: it was lost, or an error that no other handler caught.
pub struct DeviceErrors {
    heard: Arc<Mutex<Heard>>,
    device: wgpu::Device,
}

#[derive(Default)]
struct Heard {
    first: Option<String>,
    lost: bool,
}

impl DeviceErrors {
    /// Watches the device of `gpu` from now on.
    pub fn watch(gpu: &Gpu) -> Self {
        let device_errors = Arc::new(Mutex::new(Heard::default()));
        let heard = device_errors.clone();
        let report = Arc::new(move |message: String, lost: bool| {
            let mut heard = heard.lock().unwrap_or_else(PoisonError::into_inner);
            heard.first.get_or_insert(message);
            heard.lost |= lost;
        });
        let lost = report.clone();
        gpu.device.set_device_lost_callback(move |_, message| {
            let message = if message.is_empty() {
                "the device was lost".to_owned()
            } else {
                format!("the device was lost: {message}")
            };
            lost(message, true);
        });
        gpu.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                report(error.to_string(), false)
            }));
        Self {
            heard: device_errors,
            device: gpu.device.clone(),
        }
    }

    /// The first error, if any.
    pub fn first(&self) -> Option<GpuError> {
        self.heard().first.clone().map(GpuError::Device)
    }

    /// Whether the device is lost: a new one can replace it ([`Gpu::reopened`]).
    pub fn is_lost(&self) -> bool {
        // Only polling reports a loss, and a lost device may refuse to poll.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.heard().lost
    }

    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::ShaderChecks;

    #[test]
    fn a_lost_device_is_reported() {
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need an adapter");
        let device_errors = DeviceErrors::watch(&gpu);
        assert!(device_errors.first().is_none() && !device_errors.is_lost());
        gpu.device.destroy();
        // Waiting for a lost device may itself fail.
        let _ = gpu.wait();
        let message = device_errors.first().expect("it is gone").to_string();
        assert!(message.contains("the device was lost"), "{message}");
        assert!(device_errors.is_lost());
    }
}
