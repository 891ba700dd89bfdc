//! A compute pipeline whose resources are bound by name: the group and binding numbers are the
//! shader's business alone.

use std::{
    collections::BTreeMap,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::Arc,
};

use naga::{AddressSpace, ImageClass, TypeInner};

use super::{Composed, Gpu, GpuError, ShaderChecks, shader::base_name};

/// Which shader, with which constants.
#[derive(Clone, Copy, Default)]
pub struct KernelSpec<'a> {
    /// As `passes/shade`. The label in timings and captures is its last part.
    pub shader: &'a str,
    /// Entry point; `main` when empty.
    pub entry: &'a str,
    /// Values of `override` declarations, by their name in their own module.
    pub overrides: &'a [(&'a str, f64)],
    /// Modules made at run time, imported as `package::generated::NAME`.
    pub generated: &'a [(&'a str, &'a str)],
}

impl KernelSpec<'_> {
    /// What tells one kernel of a device from another.
    fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.shader, self.entry, self.generated).hash(&mut hasher);
        for (name, value) in self.overrides {
            (name, value.to_bits()).hash(&mut hasher);
        }
        hasher.finish()
    }
}

/// A compiled compute shader. Cheap to clone.
#[derive(Clone)]
pub struct Kernel {
    pub label: String,
    pipeline: wgpu::ComputePipeline,
    groups: Arc<[Group]>,
    pub workgroup_size: [u32; 3],
}

struct Group {
    layout: wgpu::BindGroupLayout,
    /// (binding, name) of each resource.
    slots: Vec<(u32, String)>,
}

/// The resources of a [`Kernel`], ready to be set.
pub struct Bindings(Vec<Option<wgpu::BindGroup>>);

impl Kernel {
    /// Composes, compiles and reflects, or takes what the device has compiled before.
    ///
    /// # Errors
    /// [`GpuError::Shader`] when the shader does not compile.
    ///
    /// # Panics
    /// When an override is named that the shader does not have: that is a fault of the caller.
    pub fn new(gpu: &Gpu, spec: &KernelSpec<'_>) -> Result<Self, GpuError> {
        let key = spec.key();
        let cache = || gpu.kernels.lock().expect("nobody panics holding it");
        if let Some(known) = cache().get(&key) {
            return Ok(known.clone());
        }
        let compiled = Self::compile(gpu, spec)?;
        cache().insert(key, compiled.clone());
        Ok(compiled)
    }

    fn compile(gpu: &Gpu, spec: &KernelSpec<'_>) -> Result<Self, GpuError> {
        let composed = gpu.shaders.compose(spec.shader, spec.generated)?;
        let label = spec.shader.rsplit('/').next().unwrap_or(spec.shader);
        let entry = if spec.entry.is_empty() {
            "main"
        } else {
            spec.entry
        };
        let fault = |message: String| GpuError::Shader {
            name: spec.shader.to_owned(),
            message,
        };
        let index = composed
            .module
            .entry_points
            .iter()
            .position(|point| point.name == entry)
            .ok_or_else(|| fault(format!("has no entry point `{entry}`")))?;
        let constants = constants(&composed, spec.overrides);
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let groups = reflect(gpu, &composed, index, label);
        let layouts: Vec<_> = groups.iter().map(|group| Some(&group.layout)).collect();
        let layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            });
        let module = create_module(gpu, label, &composed.wgsl);
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    zero_initialize_workgroup_memory: false,
                },
                cache: None,
            });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(fault(error.to_string()));
        }
        Ok(Self {
            label: label.to_owned(),
            pipeline,
            groups: groups.into(),
            workgroup_size: composed.module.entry_points[index].workgroup_size,
        })
    }

    /// Binds every resource of the shader by its name; names that the shader does not use are
    /// ignored, so that passes may offer a common set.
    ///
    /// # Panics
    /// When a resource of the shader is not among `resources`: that is a fault of the caller.
    pub fn bind(&self, gpu: &Gpu, resources: &[(&str, wgpu::BindingResource<'_>)]) -> Bindings {
        let bind_group = |group: &Group| {
            let entries: Vec<_> = group
                .slots
                .iter()
                .map(|(binding, name)| wgpu::BindGroupEntry {
                    binding: *binding,
                    resource: resources
                        .iter()
                        .find(|(known, _)| known == name)
                        .unwrap_or_else(|| panic!("`{}` is not given `{name}`", self.label))
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
        Bindings(
            self.groups
                .iter()
                .map(|group| (!group.slots.is_empty()).then(|| bind_group(group)))
                .collect(),
        )
    }

    /// Dispatches this many workgroups.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        groups: [u32; 3],
    ) {
        self.set(pass, bindings);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
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

    /// Dispatches as many workgroups as three u32 at `offset` of `buffer` say.
    pub fn dispatch_indirect(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings,
        buffer: &wgpu::Buffer,
        offset: u64,
    ) {
        self.set(pass, bindings);
        pass.dispatch_workgroups_indirect(buffer, offset);
    }

    fn set(&self, pass: &mut wgpu::ComputePass<'_>, bindings: &Bindings) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in bindings.0.iter().enumerate() {
            if let Some(group) = group {
                pass.set_bind_group(index as u32, group, &[]);
            }
        }
    }
}

/// The one place that makes shader modules.
fn create_module(gpu: &Gpu, label: &str, wgsl: &str) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
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

fn constants<'a>(composed: &'a Composed, overrides: &[(&str, f64)]) -> Vec<(&'a str, f64)> {
    overrides
        .iter()
        .map(|(name, value)| {
            let known = composed
                .module
                .overrides
                .iter()
                .filter_map(|(_, declared)| declared.name.as_deref())
                .find(|declared| base_name(declared) == *name)
                .unwrap_or_else(|| panic!("shader `{}` has no override `{name}`", composed.name));
            (known, *value)
        })
        .collect()
}

/// The bind group layouts that the entry point needs, from the declarations that it uses.
fn reflect(gpu: &Gpu, composed: &Composed, entry: usize, label: &str) -> Vec<Group> {
    let uses = composed.info.get_entry_point(entry);
    // Formats without filtering (32-bit float) may be bound to textures that are only loaded from.
    let filtered = |texture| uses.sampling_set.iter().any(|key| key.image == texture);
    let mut groups: BTreeMap<u32, Vec<(wgpu::BindGroupLayoutEntry, String)>> = BTreeMap::new();
    for (handle, variable) in composed.module.global_variables.iter() {
        let Some(place) = &variable.binding else {
            continue;
        };
        if uses[handle].is_empty() {
            continue;
        }
        let name = variable.name.as_deref().map(base_name).unwrap_or_default();
        groups.entry(place.group).or_default().push((
            wgpu::BindGroupLayoutEntry {
                binding: place.binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: binding_type(&composed.module, variable, filtered(handle)),
                count: None,
            },
            name.to_owned(),
        ));
    }
    let last = groups.keys().next_back().map_or(0, |last| last + 1);
    (0..last)
        .map(|index| {
            let found = groups.remove(&index).unwrap_or_default();
            let (entries, names): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            Group {
                layout: gpu
                    .device
                    .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                        label: Some(label),
                        entries: &entries,
                    }),
                slots: entries
                    .iter()
                    .map(|entry| entry.binding)
                    .zip(names)
                    .collect(),
            }
        })
        .collect()
}

fn binding_type(
    module: &naga::Module,
    variable: &naga::GlobalVariable,
    filterable: bool,
) -> wgpu::BindingType {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    match variable.space {
        AddressSpace::Uniform => return buffer(wgpu::BufferBindingType::Uniform),
        AddressSpace::Storage { access } => {
            return buffer(wgpu::BufferBindingType::Storage {
                read_only: !access.contains(naga::StorageAccess::STORE),
            });
        }
        _ => {}
    }
    match module.types[variable.ty].inner {
        TypeInner::Sampler { comparison } => wgpu::BindingType::Sampler(if comparison {
            wgpu::SamplerBindingType::Comparison
        } else {
            wgpu::SamplerBindingType::Filtering
        }),
        TypeInner::Image {
            dim,
            arrayed,
            class,
        } => {
            let view_dimension = match (dim, arrayed) {
                (naga::ImageDimension::D1, _) => wgpu::TextureViewDimension::D1,
                (naga::ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
                (naga::ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
                (naga::ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
                (naga::ImageDimension::Cube, false) => wgpu::TextureViewDimension::Cube,
                (naga::ImageDimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
            };
            match class {
                ImageClass::Sampled { kind, multi } => wgpu::BindingType::Texture {
                    sample_type: match kind {
                        naga::ScalarKind::Sint => wgpu::TextureSampleType::Sint,
                        naga::ScalarKind::Uint => wgpu::TextureSampleType::Uint,
                        _ => wgpu::TextureSampleType::Float { filterable },
                    },
                    view_dimension,
                    multisampled: multi,
                },
                ImageClass::Storage { format, access } => wgpu::BindingType::StorageTexture {
                    access: if access
                        .contains(naga::StorageAccess::LOAD | naga::StorageAccess::STORE)
                    {
                        wgpu::StorageTextureAccess::ReadWrite
                    } else if access.contains(naga::StorageAccess::LOAD) {
                        wgpu::StorageTextureAccess::ReadOnly
                    } else {
                        wgpu::StorageTextureAccess::WriteOnly
                    },
                    format: storage_format(format),
                    view_dimension,
                },
                ref class => panic!("no pass binds images of class {class:?}"),
            }
        }
        ref inner => panic!("no pass binds resources of type {inner:?}"),
    }
}

fn storage_format(format: naga::StorageFormat) -> wgpu::TextureFormat {
    match format {
        naga::StorageFormat::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
        naga::StorageFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        naga::StorageFormat::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        naga::StorageFormat::Rgba32Uint => wgpu::TextureFormat::Rgba32Uint,
        naga::StorageFormat::Rg32Float => wgpu::TextureFormat::Rg32Float,
        naga::StorageFormat::Rg32Uint => wgpu::TextureFormat::Rg32Uint,
        naga::StorageFormat::R32Float => wgpu::TextureFormat::R32Float,
        naga::StorageFormat::R32Uint => wgpu::TextureFormat::R32Uint,
        other => panic!("no pass stores to {other:?}"),
    }
}
