//! A compute pipeline whose resources are bound by name: group and binding numbers stay inside the
//! shader.

use std::{
    borrow::Cow,
    collections::HashSet,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    num::NonZeroU64,
    ops::Range,
    sync::Arc,
    thread,
};

use super::{
    Composed, Gpu, GpuError, ShaderChecks,
    ahead::OwnedSpec,
    dispatch_chunks::{self, ChunkTime, FIRST_ROW},
    made,
    reflect::{Group, SPACER, reflect},
    shader::base_name,
    specialise::specialise,
};

/// The constant of `shaders/math/per_thread.wesl`.
const IN_SOFTWARE: &str = "IN_SOFTWARE";

/// A shader with the values of its constants.
#[derive(Clone, Copy, Default)]
pub struct KernelSpec<'a> {
    /// For example `view/shade`, which is also the label in timings and captures.
    pub shader: &'a str,
    /// Entry point; `main` when empty.
    pub entry: &'a str,
    /// Values of `override` declarations, by the names in their own modules.
    pub overrides: &'a [(&'a str, f64)],
    /// Further values, which the shader may lack.
    pub offered: &'a [(&'a str, f64)],
    /// Modules generated for this kernel, imported as `package::generated::NAME`.
    pub generated: &'a [(&'a str, &'a str)],
}

impl KernelSpec<'_> {
    /// Distinguishes the kernels of a device.
    fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.shader, self.entry, self.generated).hash(&mut hasher);
        for (name, value) in self.overrides.iter().chain(self.offered) {
            (name, value.to_bits()).hash(&mut hasher);
        }
        hasher.finish()
    }
}

/// A compiled compute shader. Cheap to clone.
#[derive(Clone)]
pub struct Kernel {
    pub label: String,
    /// Key of its [`KernelSpec`].
    key: u64,
    pub(super) spec: Arc<OwnedSpec>,
    /// Names of the modules that it was composed of.
    sources: Arc<[String]>,
    pipeline: wgpu::ComputePipeline,
    groups: Arc<[Group]>,
    pub workgroup_size: [u32; 3],
}

/// The resources of a [`Kernel`], ready to be set, and its chunk time on this device.
pub struct Bindings {
    groups: Vec<Option<wgpu::BindGroup>>,
    pub(super) chunk_time: Arc<ChunkTime>,
}

impl Kernel {
    /// Composes, compiles and reflects the shader, or reuses the device's compiled kernel.
    ///
    /// # Errors
    /// [`GpuError::Shader`] if the shader does not compile.
    ///
    /// # Panics
    /// If the shader lacks a named override: that is a caller's bug.
    pub fn new(gpu: &Gpu, spec: &KernelSpec<'_>) -> Result<Self, GpuError> {
        match gpu.known(spec.key()) {
            Some(known) => Ok(known),
            None => Self::compile(gpu, spec, &gpu.compose(spec.shader, spec.generated)?),
        }
    }

    /// Kernels of several entry points of one shader, as those [of one shader](Kernel::of_one_shader).
    ///
    /// # Errors
    /// As [`Kernel::new`].
    ///
    /// # Panics
    /// As [`Kernel::new`].
    pub fn of_entries<const N: usize>(
        gpu: &Gpu,
        spec: &KernelSpec<'_>,
        entries: [&str; N],
    ) -> Result<[Self; N], GpuError> {
        let specs = entries.map(|entry| KernelSpec { entry, ..*spec });
        Self::of_one_shader(gpu, &specs)
    }

    /// Several kernels of one shader, which is composed once; its pipelines are compiled side by side.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    ///
    /// # Panics
    /// As [`Kernel::new`], and if they are of different shaders.
    pub fn of_one_shader<const N: usize>(
        gpu: &Gpu,
        specs: &[KernelSpec<'_>; N],
    ) -> Result<[Self; N], GpuError> {
        let known = specs.each_ref().map(|spec| gpu.known(spec.key()));
        if known.iter().all(Option::is_some) {
            return Ok(known.map(|kernel| kernel.expect("all are known")));
        }
        let [first, others @ ..] = specs.as_slice() else {
            unreachable!("N is not 0");
        };
        for spec in others {
            let sources = [first, spec].map(|spec| (spec.shader, spec.generated));
            assert_eq!(sources[0], sources[1], "one shader");
        }
        let composed = gpu.compose(first.shader, first.generated)?;
        let compiled: Result<Vec<_>, _> = thread::scope(|threads| {
            let compiling = specs
                .each_ref()
                .map(|spec| threads.spawn(|| Self::compile(gpu, spec, &composed)));
            compiling.into_iter().map(made).collect()
        });
        compiled.map(|kernels| {
            kernels
                .try_into()
                .map_err(|_| ())
                .expect("one for each spec")
        })
    }

    /// Whether it was composed of none of these modules.
    pub(super) fn has_none_of(&self, modules: &HashSet<&str>) -> bool {
        let mut sources = self.sources.iter();
        sources.all(|source| !modules.contains(source.as_str()))
    }

    fn compile(gpu: &Gpu, spec: &KernelSpec<'_>, composed: &Composed) -> Result<Self, GpuError> {
        let label = spec.shader;
        let entry = if spec.entry.is_empty() {
            "main"
        } else {
            spec.entry
        };
        let mut entry_points = composed.module.entry_points.iter();
        if entry_points.all(|point| point.name != entry) {
            return Err(fault(spec, format!("has no entry point `{entry}`")));
        }
        let constants = constants(composed, spec, gpu.summary.is_software());
        let specialised =
            specialise(composed, entry, &constants).map_err(|error| fault(spec, error))?;
        let workgroup_size = specialised.module.entry_points[0].workgroup_size;
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let groups = reflect(gpu, &specialised, label);
        let layouts: Vec<_> = groups.iter().map(|group| Some(&group.layout)).collect();
        let layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            });
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                module: &create_module(gpu, label, specialised.module),
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[],
                    zero_initialize_workgroup_memory: false,
                },
                cache: None,
            });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(fault(spec, error.to_string()));
        }
        let compiled = Self {
            label: label.to_owned(),
            key: spec.key(),
            spec: Arc::new(spec.into()),
            sources: composed.sources.as_slice().into(),
            pipeline,
            groups: groups.into(),
            workgroup_size,
        };
        gpu.keep(&compiled);
        Ok(compiled)
    }

    /// Binds every resource of the shader by its name. Names that the shader does not use are ignored,
    /// so that passes may offer a common set. The table of first rows need not be given.
    ///
    /// # Panics
    /// If a resource of the shader is not among `resources`: that is a caller's bug.
    pub fn bind(&self, gpu: &Gpu, resources: &[(&str, wgpu::BindingResource<'_>)]) -> Bindings {
        let first_row = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &gpu.first_rows,
            offset: 0,
            size: NonZeroU64::new(size_of::<u32>() as u64),
        });
        let of_all = [(FIRST_ROW, first_row.clone()), (SPACER, first_row)];
        let bind_group = |group: &Group| {
            let entries: Vec<_> = group
                .slots
                .iter()
                .map(|(binding, name)| wgpu::BindGroupEntry {
                    binding: *binding,
                    resource: resources
                        .iter()
                        .chain(&of_all)
                        .find(|(known, _)| known == name)
                        .unwrap_or_else(|| panic!("`{}` lacks the resource `{name}`", self.label))
                        .1
                        .clone(),
                })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&self.label),
                layout: &group.layout,
                entries: &entries,
            })
        };
        let mut chunk_times = gpu.chunk_times.lock().expect("nobody panics holding it");
        Bindings {
            chunk_time: chunk_times.entry(self.key).or_default().clone(),
            groups: self
                .groups
                .iter()
                .map(|group| (!group.slots.is_empty()).then(|| bind_group(group)))
                .collect(),
        }
    }

    /// Dispatches this many workgroups.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        groups: [u32; 3],
    ) {
        self.set(pass, bindings, 0);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
    }

    /// Dispatches some of the rows of work that is `width` workgroups wide.
    ///
    /// # Panics
    /// If the shader does not use its first row: that is a caller's bug.
    pub(super) fn dispatch_rows(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        width: u32,
        rows: Range<u32>,
    ) {
        assert!(
            self.groups.iter().any(Group::has_first_row),
            "`{}` cannot be split: it does not use `{FIRST_ROW}`",
            self.label
        );
        self.set(pass, bindings, rows.start);
        pass.dispatch_workgroups(width, rows.end - rows.start, 1);
    }

    /// Columns and rows of workgroups for a picture, one thread per pixel.
    pub fn groups_of(&self, size: [u32; 2]) -> [u32; 2] {
        std::array::from_fn(|axis| size[axis].div_ceil(self.workgroup_size[axis]))
    }

    /// Dispatches at least this many threads.
    pub fn dispatch_threads(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        threads: [u32; 3],
    ) {
        let groups = std::array::from_fn(|axis| threads[axis].div_ceil(self.workgroup_size[axis]));
        self.dispatch(pass, bindings, groups);
    }

    /// Dispatches as many workgroups as the three u32 at `offset` of `buffer`, starting at a row.
    pub fn dispatch_indirect(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        first_row: u32,
        buffer: &wgpu::Buffer,
        offset: u64,
    ) {
        self.set(pass, bindings, first_row);
        pass.dispatch_workgroups_indirect(buffer, offset);
    }

    fn set(&self, pass: &mut wgpu::ComputePass<'_>, bindings: &Bindings, first_row: u32) {
        pass.set_pipeline(&self.pipeline);
        let groups = bindings.groups.iter().zip(self.groups.iter());
        for (index, (group, shape)) in groups.enumerate() {
            if group.is_some() {
                let offset = [first_row * dispatch_chunks::STRIDE];
                let offsets = &offset[..usize::from(shape.has_first_row())];
                pass.set_bind_group(index as u32, group, offsets);
            }
        }
    }
}

impl Gpu {
    fn known(&self, key: u64) -> Option<Kernel> {
        let kernels = self.kernels.lock().expect("nobody panics holding it");
        kernels.get(&key).cloned()
    }

    pub(super) fn knows(&self, spec: &KernelSpec<'_>) -> bool {
        let kernels = self.kernels.lock().expect("nobody panics holding it");
        kernels.contains_key(&spec.key())
    }

    fn keep(&self, kernel: &Kernel) {
        let mut kernels = self.kernels.lock().expect("nobody panics holding it");
        kernels.insert(kernel.key, kernel.clone());
    }
}

fn fault(spec: &KernelSpec<'_>, message: String) -> GpuError {
    GpuError::Shader {
        name: spec.shader.to_owned(),
        message,
    }
}

/// The one place that makes shader modules.
///
/// It takes what has been parsed already. wgpu would parse the text again, and where it checks itself it would note the line
/// of each statement for debuggers, which took an eighth of the CPU time of a start.
fn create_module(gpu: &Gpu, label: &str, module: naga::Module) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
    };
    match gpu.checks {
        ShaderChecks::Checked => gpu.device.create_shader_module(descriptor),
        // SAFETY: every shader is our own or generated from a checked world, is run with checks by
        // the tests, indexes within its buffers, and ends its loops.
        ShaderChecks::Unchecked => unsafe {
            gpu.device
                .create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        },
    }
}

/// The values of the shader's `override` declarations, by their names in the composed text.
fn constants<'a>(
    composed: &'a Composed,
    spec: &KernelSpec<'_>,
    in_software: bool,
) -> Vec<(&'a str, f64)> {
    let declared = |name: &str| {
        let overrides = composed.module.overrides.iter();
        let mut names = overrides.filter_map(|(_, declared)| declared.name.as_deref());
        names.find(|declared| base_name(declared) == name)
    };
    let own = spec.overrides.iter().map(|(name, value)| {
        let known = declared(name)
            .unwrap_or_else(|| panic!("shader `{}` has no override `{name}`", composed.name));
        (known, *value)
    });
    let offered = spec.offered.iter();
    let taken = offered.filter_map(|(name, value)| Some((declared(name)?, *value)));
    let in_software = declared(IN_SOFTWARE).map(|name| (name, f64::from(in_software)));
    own.chain(taken).chain(in_software).collect()
}
