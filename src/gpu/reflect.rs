//! The bindings of a shader, read from its declarations.

use std::collections::BTreeMap;

use naga::{AddressSpace, ImageClass, TypeInner};

use super::{Gpu, dispatch_chunks::FIRST_ROW, shader::base_name, specialise::Specialised};

/// Name of a uniform buffer that no shader declares and only software devices have.
///
/// Mesa's lavapipe (22.3, lvp_inline_uniforms.c) notes of each condition which uniforms it depends on. The notes of the fourth
/// uniform buffer of a kernel lie on the counts of all notes, because two tables disagree about their strides; where
/// such a condition depends on more than uniforms, the wrong counts remain, and the first dispatch reads far beyond a table. So
/// the fourth buffer is one of which nothing can be noted. Those of later ones fall on what compute pipelines do not use.
pub(super) const SPACER: &str = "spacer";

/// The place of the [`SPACER`] among uniform buffers.
const SPACER_PLACE: usize = 3;

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

/// The bind group layouts that a kernel needs, from the declarations that it uses.
pub(super) fn reflect(gpu: &Gpu, kernel: &Specialised, label: &str) -> Vec<Group> {
    let uses = kernel.info.get_entry_point(0);
    // Formats without filtering (32-bit float) may be bound to textures that are only loaded from.
    let filtered = |texture| uses.sampling_set.iter().any(|key| key.image == texture);
    let mut groups = BTreeMap::<u32, Vec<(wgpu::BindGroupLayoutEntry, String)>>::new();
    for (handle, variable) in kernel.module.global_variables.iter() {
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
                ty: binding_type(&kernel.module, variable, name, filtered(handle)),
                count: None,
            },
            name.to_owned(),
        ));
    }
    if gpu.summary.is_software() {
        add_spacer(&mut groups, label);
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

/// Puts the [`SPACER`] before the fourth uniform buffer, if there are as many. Buffers are counted by their bindings.
///
/// # Panics
/// If there is no number left between the bindings of the third and the fourth: that is a fault of the shader.
fn add_spacer(groups: &mut BTreeMap<u32, Vec<(wgpu::BindGroupLayoutEntry, String)>>, label: &str) {
    let is_uniform = |entry: &wgpu::BindGroupLayoutEntry| {
        matches!(
            entry.ty,
            wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                ..
            }
        )
    };
    let mut places = Vec::new();
    for (group, entries) in groups.iter() {
        let uniforms = entries.iter().filter(|(entry, _)| is_uniform(entry));
        places.extend(uniforms.map(|(entry, _)| (*group, entry.binding)));
    }
    places.sort_unstable();
    let (Some(&before), Some(&after)) = (places.get(SPACER_PLACE - 1), places.get(SPACER_PLACE))
    else {
        return;
    };
    let entries = groups.entry(before.0).or_default();
    let is_free = |binding: &u32| entries.iter().all(|(entry, _)| entry.binding != *binding);
    let binding = (before.1 + 1..)
        .take_while(|binding| (before.0, *binding) < after)
        .find(is_free)
        .unwrap_or_else(|| {
            panic!("`{label}` has no binding left between {before:?} and {after:?}")
        });
    entries.push((
        wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: uniform_buffer(false),
            count: None,
        },
        SPACER.to_owned(),
    ));
}

fn uniform_buffer(has_dynamic_offset: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset,
        min_binding_size: None,
    }
}

fn binding_type(
    module: &naga::Module,
    variable: &naga::GlobalVariable,
    name: &str,
    filterable: bool,
) -> wgpu::BindingType {
    match variable.space {
        AddressSpace::Uniform => return uniform_buffer(name == FIRST_ROW),
        AddressSpace::Storage { access } => {
            return wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage {
                    read_only: !access.contains(naga::StorageAccess::STORE),
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(places: &[(u32, u32)]) -> BTreeMap<u32, Vec<(wgpu::BindGroupLayoutEntry, String)>> {
        let mut groups = BTreeMap::<_, Vec<_>>::new();
        for (group, binding) in places {
            let entry = wgpu::BindGroupLayoutEntry {
                binding: *binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: uniform_buffer(false),
                count: None,
            };
            let name = format!("{group}.{binding}");
            groups.entry(*group).or_default().push((entry, name));
        }
        groups
    }

    #[test]
    fn the_spacer_is_the_fourth_uniform_buffer() {
        for places in [
            &[(0, 0), (0, 4), (0, 7), (0, 9)][..],
            &[(0, 0), (0, 4), (0, 7), (2, 0), (3, 0)],
            &[(0, 1), (2, 0), (2, 10), (2, 12)],
            &[(3, 7), (3, 5), (3, 2), (3, 0)],
        ] {
            let mut groups = groups(places);
            add_spacer(&mut groups, "a kernel");
            let mut all: Vec<_> = groups
                .iter()
                .flat_map(|(group, entries)| {
                    let found = entries.iter();
                    found.map(move |(entry, name)| ((*group, entry.binding), name.as_str()))
                })
                .collect();
            all.sort_unstable();
            assert_eq!(all[SPACER_PLACE].1, SPACER, "{all:?}");
            assert_eq!(all.len(), places.len() + 1, "{all:?}");
            all.dedup_by_key(|(place, _)| *place);
            assert_eq!(all.len(), places.len() + 1, "a place for each: {all:?}");
        }
    }

    #[test]
    fn few_uniform_buffers_need_no_spacer() {
        let mut few = groups(&[(0, 0), (0, 4), (2, 0)]);
        add_spacer(&mut few, "a kernel");
        assert!(few.values().flatten().all(|(_, name)| name != SPACER));
    }

    #[test]
    #[should_panic(expected = "`a kernel` has no binding left")]
    fn a_shader_must_leave_room_for_the_spacer() {
        add_spacer(&mut groups(&[(0, 0), (0, 1), (0, 2), (0, 3)]), "a kernel");
    }
}
