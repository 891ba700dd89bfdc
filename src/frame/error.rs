//! Why a world cannot be shown.

use crate::{
    gpu::GpuError,
    passes::{probes::ProbeFieldError, view::InspectionError},
    probes::ProbeError,
};

/// Why a world cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Probes(#[from] ProbeError),
    #[error(transparent)]
    Inspection(#[from] InspectionError),
}

impl From<ProbeFieldError> for FrameError {
    fn from(error: ProbeFieldError) -> Self {
        match error {
            ProbeFieldError::Layout(error) => Self::Probes(error),
            ProbeFieldError::Gpu(error) => Self::Gpu(error),
        }
    }
}
