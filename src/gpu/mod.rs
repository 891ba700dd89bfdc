//! The GPU as the passes see it: a device with its limits, shaders composed and bound by name, buffers
//! that are checked against the limits before they are created, and timings by label. Knows no world.

mod ahead;
mod buffers;
mod device;
mod device_errors;
mod dispatch_chunks;
mod early_shaders;
mod kernel;
mod learner;
mod made;
mod memory;
mod offer;
mod recorder;
mod reflect;
mod shader;
mod specialise;
mod timing;

pub use ahead::{Compiling, OwnedSpec};
pub use buffers::Structured;
pub use device::{AdapterReport, AdapterSummary, Gpu, ShaderChecks, adapters, instance};
pub use device_errors::DeviceErrors;
pub use dispatch_chunks::rectangle;
pub use early_shaders::EarlyShaders;
pub use kernel::{Bindings, Kernel, KernelSpec};
pub use made::made;
pub use memory::available_memory;
pub use offer::Offer;
pub use recorder::Recorder;
pub use shader::{Composed, ShaderLibrary};
pub use timing::{PassTimes, Timing};

/// Errors between the program and the GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error(
        "no usable GPU: {reason}\n\
         On Debian, `apt-get install mesa-vulkan-drivers libvulkan1` gives a software Vulkan device; \
         `grotto render --cpu` needs no GPU at all."
    )]
    NoAdapter { reason: String },
    #[error("no adapter matches `{name}`; this machine has: {available}")]
    AdapterNotFound { name: String, available: String },
    #[error(
        "{what} needs {bytes} bytes, but adapter `{adapter}` allows {limit} ({limit_name}). {remedy}"
    )]
    TooLarge {
        what: String,
        bytes: u64,
        adapter: String,
        limit: u64,
        limit_name: &'static str,
        remedy: &'static str,
    },
    #[error(
        "{what} needs {bytes} bytes, but adapter `{adapter}` has less memory left. Choose a \
         smaller layout or world, or close other programs."
    )]
    OutOfMemory {
        what: String,
        bytes: u64,
        adapter: String,
    },
    #[error("shader `{name}` does not compile:\n{message}")]
    Shader { name: String, message: String },
    #[error("the GPU failed: {0}")]
    Device(String),
}
