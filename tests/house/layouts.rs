//! Structs that Rust and the shaders share: every member lies at the same offset on both sides.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};

use grotto::{
    gpu::ShaderLibrary,
    lights::{
        emitters::GpuFacing,
        table::{GpuLampSlot, GpuLightsHeader, GpuSky, LISTS_OFFSET},
    },
    passes::scene::GpuSeenLampsHeader,
    shared::{self, Layout},
    world::materials::table::{CAPACITY, GpuMaterial},
};

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

/// The layout of a Rust struct, from the members named here; padding is not named.
macro_rules! rust_layout {
    ($ty:ty { $($member:ident),* $(,)? }) => {
        Layout {
            members: BTreeMap::from([$((stringify!($member).to_owned(), offset_of!($ty, $member))),*]),
            stride: size_of::<$ty>(),
        }
    };
}

/// Compares every struct that Rust declares for the shaders.
#[test]
fn shared_structs_are_laid_out_alike() {
    let declared = shared::declarations();
    let structs = declared
        .iter()
        .filter_map(|declared| Some((declared, declared.layout?())));
    for (declared, layout) in structs {
        let module = format!("generated::{}", declared.module);
        let own = shader_layout(&module, declared.name);
        assert_eq!(own, layout, "{}", declared.name);
    }
}

#[test]
fn lights_are_a_header_lamps_and_lists() {
    let whole = shader_layout("scene::lights", "Lights");
    let mut header = rust_layout!(GpuLightsHeader {
        sky,
        gain,
        lamp_count,
        list_cells,
        list_shift,
        all_brightest,
        list_frame,
        keeps_slots,
        soft_lamps,
        unsettled,
        settled_since,
        moved_last,
        sight_cells,
        sight_shift,
        first_shadow,
        shadows_known,
        has_steady,
        _pad,
        rhythms,
        lamp_gains
    });
    header
        .members
        .insert("lamps".to_owned(), size_of::<GpuLightsHeader>());
    header.members.insert("lists".to_owned(), LISTS_OFFSET);
    // With one slot: how many there are depends on the world.
    header.stride = (LISTS_OFFSET + size_of::<GpuLampSlot>()).next_multiple_of(16);
    assert_eq!(whole, header);
}

#[test]
fn lamps_seen_are_a_header_and_words() {
    let whole = shader_layout("light::seen_lamps", "SeenLamps");
    let mut header = rust_layout!(GpuSeenLampsHeader {
        read_first,
        read_second,
        written,
        _pad,
        fresh
    });
    let words = size_of::<GpuSeenLampsHeader>();
    header.members.insert("words".to_owned(), words);
    // With one word.
    header.stride = (words + 4).next_multiple_of(16);
    assert_eq!(whole, header);
}

#[test]
fn materials() {
    let whole = shader_layout("scene::materials", "Materials");
    assert_eq!(
        whole.members["details"],
        CAPACITY * size_of::<GpuMaterial>()
    );
}

#[test]
fn emitters() {
    let whole = shader_layout("scene::emitters", "Emitters");
    assert_eq!(whole.members["groups"], 6 * size_of::<GpuFacing>());
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
    assert_ne!(shader_layout("generated::lights", "Sky"), moved);
    let missing = rust_layout!(GpuSky { zenith, horizon });
    assert_ne!(shader_layout("generated::lights", "Sky"), missing);
}
