//! Chooses an adapter and opens a device with the features that the adapter offers.

use std::{
    collections::{HashMap, HashSet},
    sync::{Arc, Mutex},
};

use super::{
    Composed, EarlyShaders, GpuError, Kernel, ShaderLibrary,
    dispatch_chunks::{self, ChunkTime},
};

/// Whether shader modules get the run-time checks that wgpu adds (bounds, loop counters, division).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ShaderChecks {
    /// For tests: an index out of range reads zero instead of arbitrary data.
    Checked,
    /// Measured 3–5 % faster in marching; the default.
    #[default]
    Unchecked,
}

/// An open device. Cheap to clone.
#[derive(Clone)]
pub struct Gpu {
    pub instance: wgpu::Instance,
    pub adapter: wgpu::Adapter,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub summary: AdapterSummary,
    pub limits: wgpu::Limits,
    pub features: wgpu::Features,
    pub checks: ShaderChecks,
    shaders: EarlyShaders,
    /// Workgroups of a first dispatch, while the time of the work is unknown: see
    /// [`super::Recorder::run`]. Of large ones it has fewer: see
    /// `dispatch_chunks::first_groups`.
    pub first_groups: u32,
    /// The table of first rows (see `dispatch_chunks`).
    pub(super) first_rows: wgpu::Buffer,
    pub(super) chunk_arguments: dispatch_chunks::ChunkArguments,
    /// Kernels compiled so far, so that a resize need not compile again.
    pub(super) kernels: Arc<Mutex<HashMap<u64, Kernel>>>,
    /// The measured speed of each kernel on this device, by [`super::KernelSpec`].
    pub(super) chunk_times: Arc<Mutex<HashMap<u64, Arc<ChunkTime>>>>,
}

/// Description of an adapter, as `--json` and `grotto info` print it.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct AdapterSummary {
    pub name: String,
    /// `discrete`, `integrated`, `software`, `virtual` or `other`.
    pub kind: &'static str,
    pub driver: String,
    pub backend: String,
}

const KINDS: [(wgpu::DeviceType, &str); 4] = [
    (wgpu::DeviceType::DiscreteGpu, DISCRETE),
    (wgpu::DeviceType::IntegratedGpu, "integrated"),
    (wgpu::DeviceType::VirtualGpu, "virtual"),
    (wgpu::DeviceType::Cpu, "software"),
];
pub(super) const DISCRETE: &str = "discrete";
const OTHER: &str = "other";

impl<'de> serde::Deserialize<'de> for AdapterSummary {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        struct Read {
            name: String,
            kind: String,
            driver: String,
            backend: String,
        }
        let read = Read::deserialize(deserializer)?;
        let known = KINDS.iter().find(|(_, kind)| *kind == read.kind);
        Ok(Self {
            name: read.name,
            kind: known.map_or(OTHER, |(_, kind)| kind),
            driver: read.driver,
            backend: read.backend,
        })
    }
}

impl AdapterSummary {
    fn of(info: &wgpu::AdapterInfo) -> Self {
        let known = KINDS.iter().find(|(of, _)| *of == info.device_type);
        Self {
            name: info.name.clone(),
            kind: known.map_or(OTHER, |(_, kind)| kind),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            backend: info.backend.to_string(),
        }
    }

    /// Whether the adapter is a CPU that emulates a GPU: its timings never go into tables of GPU
    /// figures.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }
}

/// The features that grotto uses where they exist; each has a fallback.
const WANTED: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
    .union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS)
    .union(wgpu::Features::SUBGROUP)
    .union(wgpu::Features::SHADER_F16);

/// An adapter with everything that decides whether and how grotto runs on it.
#[derive(Clone, Debug)]
pub struct AdapterReport {
    pub summary: AdapterSummary,
    pub limits: wgpu::Limits,
    /// The optional features that the adapter offers.
    pub features: wgpu::Features,
    /// Whether every pass fits the adapter's limits.
    pub usable: bool,
}

/// Every adapter of this machine, best first: without a name the first usable one runs.
pub fn adapters() -> Vec<AdapterReport> {
    let mut found = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::all()));
    found.sort_by_key(slowness);
    found
        .iter()
        .map(|adapter| AdapterReport {
            summary: AdapterSummary::of(&adapter.get_info()),
            limits: adapter.limits(),
            features: adapter.features() & WANTED,
            usable: is_usable(adapter),
        })
        .collect()
}

/// Storage buffers that pass `surface_cache/trace` binds: no pass needs more.
const STORAGE_BUFFERS: u32 = 18;

/// Threads that a workgroup of any pass may have, where the adapter allows it.
const MOST_THREADS: u32 = 1024;

fn is_usable(adapter: &wgpu::Adapter) -> bool {
    adapter.limits().max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS
}

/// Ranks adapters: the lowest rank is the fastest.
fn slowness(adapter: &wgpu::Adapter) -> (u8, bool) {
    let info = adapter.get_info();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    (kind, info.backend == wgpu::Backend::Gl)
}

/// Vulkan, Metal and Direct3D 12, or what `WGPU_BACKEND` names. OpenGL lacks features with which the
/// passes are tested.
pub fn instance() -> wgpu::Instance {
    // wgpu would validate the size of each indirect dispatch with one more dispatch; our own kernels
    // write those sizes within the limits.
    let unneeded = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL;
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY),
        flags: wgpu::InstanceFlags::default()
            .difference(unneeded)
            .with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
    })
}

impl Gpu {
    /// Opens the adapter whose name contains `name` (case-insensitive), or the fastest one. `name#2` is
    /// the second match, for machines that have several adapters of a kind.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] without any, [`GpuError::AdapterNotFound`] if none matches.
    pub fn open(name: Option<&str>, checks: ShaderChecks) -> Result<Self, GpuError> {
        Self::open_with(instance(), name, None, checks)
    }

    /// Like [`Gpu::open`], for an instance whose adapter must be able to present to `surface`.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_with(
        instance: wgpu::Instance,
        name: Option<&str>,
        surface: Option<&wgpu::Surface<'_>>,
        checks: ShaderChecks,
    ) -> Result<Self, GpuError> {
        let adapter = choose(&instance, name, surface)?;
        let limits = wgpu::Limits {
            max_compute_invocations_per_workgroup: adapter
                .limits()
                .max_compute_invocations_per_workgroup
                .min(MOST_THREADS),
            max_compute_workgroup_size_x: adapter
                .limits()
                .max_compute_workgroup_size_x
                .min(MOST_THREADS),
            max_buffer_size: adapter.limits().max_buffer_size,
            max_storage_buffer_binding_size: adapter.limits().max_storage_buffer_binding_size,
            max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
            max_texture_array_layers: adapter.limits().max_texture_array_layers,
            max_storage_buffers_per_shader_stage: adapter
                .limits()
                .max_storage_buffers_per_shader_stage
                .min(STORAGE_BUFFERS),
            ..wgpu::Limits::default()
        };
        let features = adapter.features() & WANTED;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("grotto"),
            required_features: features,
            required_limits: limits.clone(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoAdapter {
            reason: format!("`{}`: {error}", adapter.get_info().name),
        })?;
        let summary = AdapterSummary::of(&adapter.get_info());
        let first_rows = dispatch_chunks::table(&device);
        Ok(Self {
            first_groups: dispatch_chunks::usual_first_groups(&summary),
            chunk_arguments: dispatch_chunks::ChunkArguments::new(&device, &first_rows),
            first_rows,
            summary,
            shaders: EarlyShaders::begin(&[]),
            kernels: Arc::default(),
            chunk_times: Arc::default(),
            instance,
            adapter,
            device,
            queue,
            limits,
            features,
            checks,
        })
    }

    /// Threads of a workgroup of which one alone works on something large: the more, the sooner it is done. `most` of them where
    /// the adapter allows it, and `in_software` on a CPU, which runs them one after the other.
    pub fn threads(&self, most: u32, in_software: u32) -> u32 {
        if self.summary.is_software() {
            return in_software;
        }
        let allowed = self.limits.max_compute_invocations_per_workgroup;
        most.min(allowed)
            .min(self.limits.max_compute_workgroup_size_x)
    }

    /// A new device of the same adapter that replaces a lost one: nothing made with the old device
    /// works with the new one. The new device must be able to present to `surface`.
    ///
    /// # Errors
    /// Those of [`Gpu::open`]; [`GpuError::AdapterNotFound`] if the adapter itself is gone.
    pub fn reopened(&self, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        let name = Some(self.summary.name.as_str());
        let opened = Self::open_with(self.instance.clone(), name, surface, self.checks)?;
        Ok(Self {
            shaders: self.shaders.clone(),
            first_groups: self.first_groups,
            ..opened
        })
    }

    /// The same device, whose kernels use what is being composed already.
    #[must_use]
    pub fn with_early(self, shaders: EarlyShaders) -> Self {
        Self { shaders, ..self }
    }

    /// The text of every shader module.
    pub fn shaders(&self) -> &ShaderLibrary {
        self.shaders.library()
    }

    /// A shader with its imports, composed now or early: see [`ShaderLibrary::compose`].
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn compose(&self, name: &str, generated: &[(&str, &str)]) -> Result<Composed, GpuError> {
        self.shaders.composed(name, generated)
    }

    /// The same device with other shaders. Kernels that contain none of the modules that differ are reused: to compile
    /// all of them takes seconds.
    pub fn with_shaders(&self, shaders: ShaderLibrary) -> Self {
        let changed: HashSet<&str> = shaders.differences(self.shaders()).collect();
        let kernels = self.kernels.lock().expect("nobody panics holding it");
        let same = kernels
            .iter()
            .filter(|(_, kernel)| kernel.has_none_of(&changed));
        let kernels: HashMap<u64, Kernel> = same.map(|(key, same)| (*key, same.clone())).collect();
        let chunk_times = self.chunk_times.lock().expect("nobody panics holding it");
        let mut chunk_times = chunk_times.clone();
        chunk_times.retain(|key, _| kernels.contains_key(key));
        Self {
            shaders: EarlyShaders::none(Arc::new(shaders)),
            kernels: Arc::new(Mutex::new(kernels)),
            chunk_times: Arc::new(Mutex::new(chunk_times)),
            ..self.clone()
        }
    }

    /// Blocks until everything submitted so far is done.
    ///
    /// # Errors
    /// [`GpuError::Device`] if the device is lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map(|_| ())
            .map_err(|error| GpuError::Device(error.to_string()))
    }

    /// Blocks until this submission is done; later ones may continue.
    ///
    /// # Errors
    /// [`GpuError::Device`] if the device is lost.
    pub fn wait_for(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let until = wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: None,
        };
        self.device
            .poll(until)
            .map(|_| ())
            .map_err(|error| GpuError::Device(error.to_string()))
    }
}

/// Splits `H200#2` into the part that the name must contain, in lower case, and the index among the
/// matches, counted from 0.
fn numbered(name: &str) -> (String, usize) {
    let split = name
        .rsplit_once('#')
        .and_then(|(name, number)| Some((name, number.parse::<usize>().ok()?.checked_sub(1)?)));
    let (name, number) = split.unwrap_or((name, 0));
    (name.to_lowercase(), number)
}

fn choose(
    instance: &wgpu::Instance,
    name: Option<&str>,
    surface: Option<&wgpu::Surface<'_>>,
) -> Result<wgpu::Adapter, GpuError> {
    let mut found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let count = found.len();
    if let Some(surface) = surface {
        found.retain(|adapter| adapter.is_surface_supported(surface));
    }
    let presenting = found.len();
    found.retain(is_usable);
    found.sort_by_key(slowness);
    let names = |found: &[wgpu::Adapter]| {
        found
            .iter()
            .map(|adapter| format!("`{}`", adapter.get_info().name))
            .collect::<Vec<_>>()
            .join(", ")
    };
    if found.is_empty() {
        return Err(GpuError::NoAdapter {
            reason: match (count, presenting) {
                (0, _) => "no Vulkan, Metal or Direct3D 12 adapter was found".to_owned(),
                (_, 0) => format!("none of the {count} adapters found can draw into this window"),
                _ => format!("none of the {count} adapters found fits grotto's needs"),
            },
        });
    }
    if let Some(name) = name {
        let (wanted, number) = numbered(name);
        let available = names(&found);
        let is_named =
            |adapter: &wgpu::Adapter| adapter.get_info().name.to_lowercase().contains(&wanted);
        return found
            .into_iter()
            .filter(is_named)
            .nth(number)
            .ok_or_else(|| GpuError::AdapterNotFound {
                name: name.to_owned(),
                available,
            });
    }
    Ok(found.swap_remove(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::KernelSpec;

    #[test]
    fn other_shaders_leave_kernels_that_lack_what_differs() {
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need a Vulkan device");
        let kernel = KernelSpec {
            shader: "view/tonemap",
            ..KernelSpec::default()
        };
        Kernel::new(&gpu, &kernel).expect("compiles");
        let kept = |changed: &str| {
            let text = gpu.shaders().text(changed).expect("a module");
            let text = format!("{text}\n// Another text.\n");
            let shaders = gpu.shaders().clone().with(changed, &text);
            gpu.with_shaders(shaders).compiled()
        };
        assert_eq!(kept("view/shade"), 1, "another shader");
        assert_eq!(kept("view/tonemap"), 0, "its own text");
        assert_eq!(kept("color/tonemap"), 0, "a module that it imports");
    }

    #[test]
    fn one_of_several_cards_of_a_kind_has_a_number() {
        assert_eq!(numbered("H200"), ("h200".to_owned(), 0));
        assert_eq!(numbered("H200#1"), ("h200".to_owned(), 0));
        assert_eq!(numbered("H200#3"), ("h200".to_owned(), 2));
        // Here `#` is part of the name.
        assert_eq!(numbered("card #0"), ("card #0".to_owned(), 0));
        assert_eq!(numbered("a#b"), ("a#b".to_owned(), 0));
    }
}
