//! A GPU whose errors are collected.

use std::sync::{Arc, Mutex, PoisonError};

use crate::{
    commands::{Failure, options::RunOptions},
    gpu::{Gpu, ShaderChecks},
};

/// A worker's own device.
pub struct Watched {
    pub gpu: Gpu,
    errors: Arc<Mutex<Vec<String>>>,
    /// Buffers that a planted fault keeps alive.
    pub kept: Vec<wgpu::Buffer>,
}

impl Watched {
    /// # Errors
    /// Without a usable adapter of that name.
    pub fn open(run: &RunOptions) -> Result<Self, Failure> {
        let gpu = Gpu::open(run.adapter.as_deref(), ShaderChecks::default())?;
        let errors: Arc<Mutex<Vec<String>>> = Arc::default();
        let heard = errors.clone();
        gpu.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                let mut errors = heard.lock().unwrap_or_else(PoisonError::into_inner);
                errors.push(error.to_string());
            }));
        Ok(Self {
            gpu,
            errors,
            kept: Vec::new(),
        })
    }

    /// The errors since the last call.
    pub fn errors(&self) -> Vec<String> {
        std::mem::take(&mut *self.errors.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
