//! The GPU encodes directions, places probes and finds cages as the CPU does.

use glam::{DVec2, DVec3, IVec3, UVec2, UVec3, Vec3};
use grotto::{
    gpu::{Kernel, KernelSpec, Recorder},
    parameters::{ProbeParameters, Visibility},
    passes::probes::ProbeField,
    probes::{Layout as _, Volume, octahedral, sampling},
    world::{LayoutSpec, scenery::OctreeSpec, voxels::Voxels},
};

use super::{Rig, SEED};
use crate::support::gpu;

#[test]
fn the_gpu_encodes_and_decodes_as_the_cpu() {
    let gpu = gpu();
    let kernel = Kernel::new(
        &gpu,
        &KernelSpec {
            shader: "generated/octahedral",
            generated: &[(
                "octahedral",
                "
import package::math::octahedral::{octahedral_encode, octahedral_decode, texel_direction};
@group(3) @binding(0) var<storage, read> directions: array<vec4f>;
@group(3) @binding(1) var<storage, read_write> coded: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&directions) { return; }
    let point = octahedral_encode(directions[id.x].xyz);
    coded[2u * id.x] = vec4f(point, 0.0, 0.0);
    coded[2u * id.x + 1u] = vec4f(octahedral_decode(point), texel_direction(vec2u(id.x & 7u, 5u), 8u).x);
}
",
            )],
            ..Default::default()
        },
    )
    .expect("compiles");
    let axes = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|a| [a, -a]);
    let directions: Vec<DVec3> = axes
        .chain(sampling::directions(500, 1, 2))
        .map(|d| d.as_vec3().as_dvec3())
        .collect();
    let input: Vec<[f32; 4]> = directions
        .iter()
        .map(|d| (d * 3.0).as_vec3().extend(0.0).to_array())
        .collect();
    let input = gpu.storage_buffer_of("directions", &input).expect("fits");
    let out = gpu
        .storage_buffer("coded", directions.len() as u64 * 32)
        .expect("fits");
    let bindings = kernel.bind(
        &gpu,
        &[
            ("directions", input.as_entire_binding()),
            ("coded", out.as_entire_binding()),
        ],
    );
    let mut recorder = Recorder::new(&gpu, None);
    recorder.compute("octahedral", |pass| {
        kernel.dispatch_threads(pass, &bindings, [directions.len() as u32, 1, 1]);
    });
    recorder.submit(&gpu).expect("submits");
    let coded = gpu.read_buffer::<[[f32; 4]; 2]>(&out).expect("reads back");
    for (i, direction) in directions.iter().enumerate() {
        let [point, decoded] = coded[i].map(|c| c.map(f64::from));
        let point = DVec2::new(point[0], point[1]);
        // −Z lies in all four corners.
        let corner = direction.z < -1.0 + 1e-6 && point.abs().distance(DVec2::ONE) < 1e-3;
        assert!(
            corner || point.distance(octahedral::encode(*direction)) < 1e-5,
            "{direction}: {point}"
        );
        let decoded_direction = DVec3::new(decoded[0], decoded[1], decoded[2]);
        assert!(decoded_direction.distance(*direction) < 1e-5, "{direction}");
        let texel = octahedral::texel_direction(UVec2::new(i as u32 & 7, 5), 8);
        assert!((decoded[3] - texel.x).abs() < 1e-6);
    }
}

/// Positions and cages of the GPU's volumes equal those of the CPU's, wherever the volumes have moved.
#[test]
fn the_gpu_places_probes_and_cages_as_the_cpu() {
    for (counts, cascades, eyes) in [
        ([5, 3, 4], 1, &[][..]),
        ([1, 2, 1], 1, &[]),
        ([4, 5, 6], 3, &[]),
        ([5, 4, 6], 1, &[Vec3::new(-40.0, 1.0, 17.0)]),
        (
            [6, 5, 4],
            3,
            &[
                Vec3::ZERO,
                Vec3::new(13.0, -9.0, 4.0),
                Vec3::splat(-50_000.0),
            ],
        ),
    ] {
        let mut volume = Volume::new(&LayoutSpec {
            name: "test".into(),
            counts: counts.into(),
            spacing: Vec3::new(7.0, 3.5, 11.0),
            centre: Vec3::new(-0.2, 1.0, 3.4),
            follow: !eyes.is_empty(),
            cascades,
            octree: None,
        })
        .expect("a good layout");
        let mut rig = Rig::new(volume.clone(), ProbeParameters::default());
        compare_cages(&rig, &volume, Vec3::ZERO);
        for eye in eyes {
            volume.follow(*eye);
            rig.field.follow(*eye, 0);
            compare_cages(&rig, &volume, *eye);
        }
    }
}

#[test]
fn the_gpu_descends_octrees_as_the_cpu() {
    let mut voxels = Voxels::empty(UVec3::splat(64));
    voxels.fill_sphere(Vec3::new(20.0, 31.0, 40.0), 9.5, 1);
    voxels.fill_box(IVec3::new(0, 0, 0), IVec3::new(63, 3, 20), 1);
    for (depth, counts) in [(1, [2, 2, 2]), (3, [3, 2, 4]), (4, [3, 3, 3])] {
        let layout = LayoutSpec {
            name: "tree".into(),
            counts: counts.into(),
            spacing: Vec3::splat(32.0),
            centre: Vec3::new(3.0, -2.0, 0.0),
            follow: false,
            cascades: 1,
            octree: Some(OctreeSpec {
                depth,
                ..OctreeSpec::default()
            }),
        };
        let volume = Volume::octree_of(&layout, &voxels, IVec3::splat(-32)).expect("a good layout");
        let rig = Rig::new(volume.clone(), ProbeParameters::default());
        compare_cages(&rig, &volume, Vec3::ZERO);
    }
}

fn compare_cages(rig: &Rig, volume: &Volume, around: Vec3) {
    rig.field.begin_frame(&rig.gpu, &rig.parameters, SEED, 0);
    let points: Vec<[f32; 4]> = (0..300)
        .map(|i| around + sampling::rotation(4, i).xyz().as_vec3() * 90.0)
        .map(|point| point.extend(0.0).to_array())
        .collect();
    let kernel = Kernel::new(
        &rig.gpu,
        &KernelSpec {
            shader: "generated/cages",
            generated: &[("cages", CAGES)],
            offered: &rig.field.layout_constants(),
            ..Default::default()
        },
    )
    .expect("compiles");
    let slots = volume.slots();
    let levels = volume.levels().len();
    let input = rig.gpu.storage_buffer_of("points", &points).expect("fits");
    let positions = rig
        .gpu
        .storage_buffer("positions", u64::from(slots) * 16)
        .expect("fits");
    let corners = rig
        .gpu
        .storage_buffer("corners", (points.len() * levels * 64) as u64)
        .expect("fits");
    let mut resources = rig.field.resources().to_vec();
    resources.push(("points", input.as_entire_binding()));
    resources.push(("positions", positions.as_entire_binding()));
    resources.push(("corners", corners.as_entire_binding()));
    let bindings = kernel.bind(&rig.gpu, &resources);
    let mut recorder = Recorder::new(&rig.gpu, None);
    recorder.compute("cages", |pass| {
        kernel.dispatch_threads(
            pass,
            &bindings,
            [points.len().max(slots as usize) as u32, 1, 1],
        );
    });
    recorder.submit(&rig.gpu).expect("submits");
    let positions = rig.gpu.read_buffer::<[f32; 4]>(&positions).expect("reads");
    for slot in 0..slots {
        let [x, y, z, _] = positions[slot as usize];
        assert_eq!(Vec3::new(x, y, z), volume.position(slot), "slot {slot}");
    }
    let corners = rig.gpu.read_buffer::<[f32; 2]>(&corners).expect("reads");
    for (point, found) in points.iter().zip(corners.chunks_exact(8 * levels)) {
        let mut difference = vec![0.0; slots as usize];
        for (slot, weight) in volume.cage(Vec3::new(point[0], point[1], point[2])) {
            difference[slot as usize] += weight;
        }
        for [slot, weight] in found {
            difference[*slot as usize] -= weight;
        }
        for (slot, off) in difference.iter().enumerate() {
            // Far from the origin f32 has less precision within a cell.
            assert!(off.abs() < 5e-3, "slot {slot} at {point:?} is off by {off}");
        }
    }
}

const CAGES: &str = "
import package::probes::field::probe_info;
import package::probes::volume::{
    lattice_point, lattice_position, level_of, level_share, point_within, cage_around, cage_slot,
    has_cell, lattice_weights,
};
@group(3) @binding(0) var<storage, read> points: array<vec4f>;
@group(3) @binding(1) var<storage, read_write> positions: array<vec4f>;
@group(3) @binding(2) var<storage, read_write> corners: array<vec2f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < probe_info.slots {
        positions[id.x] = vec4f(lattice_position(level_of(id.x), lattice_point(id.x)), 0.0);
    }
    if id.x >= arrayLength(&points) {
        return;
    }
    let point = points[id.x].xyz;
    var left = 1.0;
    for (var level = 0u; level < probe_info.level_count; level += 1u) {
        let coarsest = level + 1u == probe_info.level_count;
        let share = left * select(level_share(level, point), 1.0, coarsest);
        left -= share;
        let cage = cage_around(level, point_within(level, point));
        for (var corner = 0u; has_cell(cage) && corner < 8u; corner += 1u) {
            let weights = lattice_weights(cage, corner);
            corners[(id.x * probe_info.level_count + level) * 8u + corner] = vec2f(
                f32(cage_slot(cage, corner)), share * weights.x * weights.y * weights.z,
            );
        }
    }
}
";

/// Unless exact visibility is requested, bits that do not fit are not an error.
#[test]
fn bits_that_do_not_fit_a_binding_give_way_to_distances() {
    let gpu = gpu();
    let parameters = ProbeParameters {
        rays: 8,
        distance_texels: 8,
        ..Default::default()
    };
    for (counts, bytes) in [([8, 8, 8], 5_640_192), ([32, 16, 32], 180_486_144)] {
        let volume = Volume::new(&LayoutSpec {
            name: "coarse".into(),
            counts: counts.into(),
            spacing: Vec3::splat(16.0),
            centre: Vec3::ZERO,
            follow: false,
            cascades: 1,
            octree: None,
        })
        .expect("a good layout");
        let field = ProbeField::new(&gpu, volume, &parameters).expect("fits");
        let fits = bytes <= gpu.limits.max_storage_buffer_binding_size;
        assert_eq!(field.memory().visibility_bits, if fits { bytes } else { 0 });
        assert_eq!((field.exact(), field.keeps_distances()), (fits, !fits));
    }
}

#[test]
fn a_field_that_cannot_fit_is_refused_before_it_is_made() {
    let gpu = gpu();
    let parameters = ProbeParameters {
        rays: 4096,
        distance_texels: 64,
        ..Default::default()
    };
    let huge = Volume::new(&LayoutSpec {
        name: "huge".into(),
        counts: UVec3::splat(100),
        spacing: Vec3::ONE,
        centre: Vec3::ZERO,
        follow: false,
        cascades: 1,
        octree: None,
    })
    .expect("a good layout");
    let error = ProbeField::new(&gpu, huge, &parameters)
        .err()
        .expect("too large");
    let message = error.to_string();
    assert!(
        message.contains("probes.") || message.contains("layout"),
        "{message}"
    );
    // The most probes, with the largest cages that exact visibility allows: 5.3 GB of bits, more than any binding.
    let wide = Volume::new(&LayoutSpec {
        name: "wide".into(),
        counts: UVec3::splat(64),
        spacing: Vec3::splat(20.0),
        centre: Vec3::ZERO,
        follow: false,
        cascades: 1,
        octree: None,
    })
    .expect("a good layout");
    let parameters = ProbeParameters {
        visibility: Visibility::Exact,
        ..Default::default()
    };
    let refused = ProbeField::new(&gpu, wide, &parameters);
    let message = refused.err().expect("too large").to_string();
    assert!(
        message.contains("probes.visibility=exact") && message.contains("5328863232 bytes"),
        "{message}"
    );
    // A size that the adapter's limits allow, but not the memory that it shares with the CPU.
    if gpu.summary.is_software() && cfg!(target_os = "linux") {
        let refused = gpu.check_memory("a layout", u64::MAX);
        let error = refused.expect_err("16 EiB").to_string();
        assert!(
            error.contains("18446744073709551615 bytes") && error.contains("memory available"),
            "{error}"
        );
    }
}
