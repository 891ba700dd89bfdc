//! The bindings of a shader, read from its declarations.

use std::collections::BTreeMap;

use naga::{AddressSpace, ImageClass, TypeInner};

use super::{Composed, Gpu, dispatch_chunks::FIRST_ROW, shader::base_name};

/// A bind group of a shader.
pub(super) struct Group {
    pub(super) layout: wgpu::BindGroupLayout,
    /// (binding, name) of each resource.
    pub(super) slots: Vec<(u32, String)>,
}

impl Group {
    /// Whether one of its resources holds the first row of a dispatch.
    pub(super) fn has_first_row(&self) -> bool {
        self.slots.iter().any(|(_, name)| name == FIRST_ROW)
    }
}

/// The bind group layouts that the entry point needs, from the declarations that it uses.
pub(super) fn reflect(gpu: &Gpu, composed: &Composed, entry: usize, label: &str) -> Vec<Group> {
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
                ty: binding_type(&composed.module, variable, name, filtered(handle)),
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
    name: &str,
    filterable: bool,
) -> wgpu::BindingType {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: name == FIRST_ROW,
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
