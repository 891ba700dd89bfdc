//! Structs that Rust and the shaders share: every member lies at the same offset on both sides.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};

use grotto::{
    gpu::ShaderLibrary,
    lights::{
        emitters::{GpuEmitterGroup, GpuFacing},
        table::{self as lights, GpuLamp, GpuLightsHeader, GpuSky},
    },
    passes::{
        path_trace::trace::GpuTraceJob,
        scene::voxelise::{GpuVoxeliseCounters, GpuVoxeliseJob},
        surface_cache::{GpuSurfaceCacheInfo, SurfaceCache},
        view::{GpuView, atlas_view::GpuAtlasJob, probe_draw::GpuDrawing},
    },
    world::materials::table::{CAPACITY, GpuMaterial},
};

/// A struct as a shader lays it out.
#[derive(Debug, PartialEq, Eq)]
struct Layout {
    /// Offset of each member by name.
    members: BTreeMap<String, usize>,
    /// Bytes from one array element to the next.
    stride: usize,
}

/// The layout of `name` in the shader module `path` (as `scene::lights`).
fn shader_layout(path: &str, name: &str) -> Layout {
    let source = format!(
        "import package::{path}::{name};
        @group(0) @binding(0) var<storage, read> value: {name};
        @compute @workgroup_size(1) fn main() {{ let used = &value; }}"
    );
    let composed = ShaderLibrary::embedded()
        .compose("generated/layout", &[("layout", &source)])
        .unwrap_or_else(|error| panic!("{error}"));
    let mut layouter = naga::proc::Layouter::default();
    layouter
        .update(composed.module.to_ctx())
        .expect("a valid module");
    let (handle, members) = composed
        .module
        .types
        .iter()
        .find_map(|(handle, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, .. }
                if ty
                    .name
                    .as_deref()
                    .is_some_and(|mangled| mangled.split("__").next() == Some(name)) =>
            {
                Some((handle, members))
            }
            _ => None,
        })
        .unwrap_or_else(|| panic!("no struct {name} in {path}"));
    Layout {
        members: members
            .iter()
            .map(|member| {
                (
                    member.name.clone().expect("members have names"),
                    member.offset as usize,
                )
            })
            .collect(),
        stride: layouter[handle].to_stride() as usize,
    }
}

/// The layout of a Rust struct by the members that are named here; padding has no name there.
macro_rules! rust_layout {
    ($ty:ty { $($member:ident),* $(,)? }) => {
        Layout {
            members: BTreeMap::from([$((stringify!($member).to_owned(), offset_of!($ty, $member))),*]),
            stride: size_of::<$ty>(),
        }
    };
}

#[test]
fn lamps_and_sky() {
    assert_eq!(
        shader_layout("scene::lights", "Lamp"),
        rust_layout!(GpuLamp {
            position_ws,
            radius,
            direction_ws,
            directional,
            intensity,
            spot_scale,
            spot_offset,
        })
    );
    assert_eq!(
        shader_layout("scene::lights", "Sky"),
        rust_layout!(GpuSky {
            zenith,
            horizon,
            ground
        })
    );
    let whole = shader_layout("scene::lights", "Lights");
    let mut header = rust_layout!(GpuLightsHeader { sky, lamp_count });
    header
        .members
        .insert("lamps".to_owned(), size_of::<GpuLightsHeader>());
    header.stride = lights::BYTES;
    assert_eq!(whole, header);
}

#[test]
fn materials() {
    assert_eq!(
        shader_layout("scene::materials", "Material"),
        rust_layout!(GpuMaterial {
            a,
            b,
            emission,
            mask_mean,
            texture
        })
    );
    let whole = shader_layout("scene::materials", "Materials");
    assert_eq!(
        whole.members["details"],
        CAPACITY * size_of::<GpuMaterial>()
    );
}

#[test]
fn faces() {
    assert_eq!(
        shader_layout("surface_cache::table", "FaceInfo"),
        rust_layout!(GpuSurfaceCacheInfo {
            edited_low_gs,
            frame,
            edited_high_gs,
            edited_frame,
            bucket_mask,
            most_batches,
            rays_rows,
            blend_rows,
            most_samples,
            widest_pixel,
            seed,
            alert,
            stillness,
            near,
            changed_frame,
        })
    );
    for (name, bytes) in [
        ("ListedFace", SurfaceCache::LISTED_BYTES),
        ("FaceBatch", SurfaceCache::BATCH_BYTES),
        ("FaceHistory", SurfaceCache::HISTORY_BYTES),
        ("AskedList", SurfaceCache::ASKED_LIST_BYTES),
    ] {
        let layout = shader_layout("surface_cache::lists", name);
        assert_eq!(layout.stride as u64, bytes, "{name}");
    }
}

#[test]
fn the_view() {
    assert_eq!(
        shader_layout("frame::view", "View"),
        rust_layout!(GpuView {
            position_ws,
            width,
            forward_ws,
            height,
            right_ws,
            frame,
            up_ws,
            seed,
            pixel_angle,
            exposure,
            mode,
            time_s,
            textures,
        })
    );
}

#[test]
fn path_tracing() {
    assert_eq!(
        shader_layout("scene::emitters", "Facing"),
        rust_layout!(GpuFacing { weight, first, end })
    );
    assert_eq!(
        shader_layout("scene::emitters", "EmitterGroup"),
        rust_layout!(GpuEmitterGroup {
            first,
            count,
            material,
            weight
        })
    );
    let whole = shader_layout("scene::emitters", "Emitters");
    assert_eq!(whole.members["groups"], 6 * size_of::<GpuFacing>());
    assert_eq!(
        shader_layout("path_trace::trace", "TraceJob"),
        rust_layout!(GpuTraceJob {
            first_tile,
            end_tile,
            tiles_across,
            tiles,
            first_sample,
            end_sample,
            scatter_bits,
            antialias,
        })
    );
}

#[test]
fn what_is_drawn_of_probes() {
    assert_eq!(
        shader_layout("view::atlas_view", "AtlasJob"),
        rust_layout!(GpuAtlasJob { layer, map, extent })
    );
    assert_eq!(
        shader_layout("view::probe_draw", "Drawing").members,
        rust_layout!(GpuDrawing {
            colour,
            stage,
            lines
        })
        .members
    );
}

#[test]
fn a_member_that_moved_is_found() {
    #[repr(C)]
    struct Moved {
        zenith: [f32; 3],
        horizon: [f32; 3],
        ground: [f32; 3],
        _pad: [f32; 3],
    }
    let moved = rust_layout!(Moved {
        zenith,
        horizon,
        ground
    });
    assert_ne!(shader_layout("scene::lights", "Sky"), moved);
    let missing = rust_layout!(GpuSky { zenith, horizon });
    assert_ne!(shader_layout("scene::lights", "Sky"), missing);
}

#[test]
fn voxelisation() {
    assert_eq!(
        shader_layout("scene::voxelise_job", "Job"),
        rust_layout!(GpuVoxeliseJob {
            size,
            first,
            cells,
            end,
            rows_at,
            parts_at,
            part_count,
            all_stone,
            entry_count,
        })
    );
    assert_eq!(
        shader_layout("scene::voxelise_job", "Counters"),
        rust_layout!(GpuVoxeliseCounters {
            candidates,
            mixed,
            exposed,
            varied,
            bricks,
        })
    );
}
