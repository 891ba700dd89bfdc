//! Where probes go when their lattice point lies in stone, and what they weigh there.

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    parameters::{ProbeParameters, Relocation},
    passes::{GpuVoxels, ProbeField, probe_states::ProbeStates},
    probes::{Layout as _, Volume, sampling},
    world::{
        LayoutSpec,
        voxels::{NewCell, Voxels},
    },
};

use crate::gpu;

const SIZE: i32 = 32;
const ORIGIN: IVec3 = IVec3::new(-16, -16, -16);
const SPACING: Vec3 = Vec3::new(5.0, 4.0, 3.0);

/// Grid space. Caves as large as a cage, pits of one voxel, and a slab thicker than any reach.
fn is_stone(voxel: IVec3) -> bool {
    if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(IVec3::splat(SIZE)).any() {
        return false;
    }
    if voxel.x >= 20 {
        return true;
    }
    let p = voxel.as_vec3() * 0.45;
    let pit = voxel.x % 7 == 3 && voxel.y % 5 == 2 && voxel.z % 6 == 1;
    p.x.sin() + p.y.sin() + p.z.cos() > 0.1 && !pit
}

fn volume() -> Volume {
    Volume::new(&LayoutSpec {
        name: "test".into(),
        counts: UVec3::new(7, 9, 10),
        spacing: SPACING,
        centre: Vec3::new(0.3, -0.4, 0.5),
        follow: false,
        cascades: 1,
    })
    .expect("a good layout")
}

/// XYZ: place, W: whether alive.
fn places(gpu: &Gpu, parameters: &ProbeParameters) -> Vec<[f32; 4]> {
    let voxels = Voxels::from_cells(UVec3::splat(SIZE as u32), |cell| {
        let mut brick = Box::new([0u8; 512]);
        for (i, material) in brick.iter_mut().enumerate() {
            let local = UVec3::new(i as u32 & 7, i as u32 >> 3 & 7, i as u32 >> 6);
            *material = u8::from(is_stone((cell * 8 + local).as_ivec3()));
        }
        NewCell::Voxels(brick)
    });
    let voxels = GpuVoxels::upload(gpu, &voxels, ORIGIN).expect("fits");
    let field = ProbeField::new(gpu, volume(), parameters).expect("fits");
    let pass = ProbeStates::new(gpu, &field, &voxels.resources()).expect("compiles");
    field.begin_frame(gpu, parameters, 1, 0);
    let mut recorder = Recorder::new(gpu, None);
    pass.record(&mut recorder);
    recorder.submit(gpu).expect("submits");
    gpu.read_buffer(field.places()).expect("reads back")
}

/// Squared voxels that a probe has to go, and 4 for each neighbour of stone beyond three.
fn cost(from: IVec3, to: IVec3) -> i32 {
    let around = [IVec3::X, IVec3::Y, IVec3::Z]
        .into_iter()
        .flat_map(|axis| [to + axis, to - axis])
        .filter(|voxel| is_stone(*voxel))
        .count() as i32;
    (to - from).length_squared() + 4 * (around - 3).max(0)
}

#[test]
fn probes_in_stone_move_to_the_best_air_within_reach_or_die() {
    let gpu = gpu();
    let parameters = ProbeParameters::default();
    let reach = (parameters.move_reach * SPACING).as_ivec3();
    let (mut moved, mut dead) = (0, 0);
    for (slot, [x, y, z, alive]) in (0..).zip(places(&gpu, &parameters)) {
        let home_ws = volume().position(slot);
        let voxel_of = |position: Vec3| position.floor().as_ivec3() - ORIGIN;
        let home = voxel_of(home_ws);
        let place = voxel_of(Vec3::new(x, y, z));
        let candidates = (-reach.x..=reach.x)
            .flat_map(|x| (-reach.y..=reach.y).map(move |y| (x, y)))
            .flat_map(|(x, y)| (-reach.z..=reach.z).map(move |z| home + IVec3::new(x, y, z)));
        let best = candidates
            .filter(|voxel| !is_stone(*voxel))
            .map(|voxel| cost(home, voxel))
            .min();
        match best {
            _ if !is_stone(home) => assert_eq!((place, alive), (home, 1.0), "slot {slot}"),
            None => {
                assert_eq!((place, alive), (home, 0.0), "slot {slot}");
                dead += 1;
            }
            Some(best) => {
                assert!(!is_stone(place), "slot {slot} is put into stone");
                assert_eq!((cost(home, place), alive), (best, 1.0), "slot {slot}");
                moved += 1;
            }
        }
    }
    assert!(
        moved > 50 && dead > 50,
        "the world tests both: {moved}, {dead}"
    );
}

#[test]
fn without_relocation_probes_in_stone_are_dead_where_they_are() {
    let parameters = ProbeParameters {
        relocation: Relocation::Off,
        ..Default::default()
    };
    for (slot, [x, y, z, alive]) in (0..).zip(places(&gpu(), &parameters)) {
        let home_ws = volume().position(slot);
        let stone = is_stone(home_ws.floor().as_ivec3() - ORIGIN);
        assert_eq!((Vec3::new(x, y, z), alive == 0.0), (home_ws, stone));
    }
}

/// Weights of the probes at points, by slot: their shares, made to add up to 1 as the gather does.
fn weights(gpu: &Gpu, field: &ProbeField, points: &[Vec3]) -> Vec<Vec<f32>> {
    let kernel = Kernel::new(
        gpu,
        &KernelSpec {
            shader: "generated/weights",
            generated: &[("weights", WEIGHTS)],
            ..Default::default()
        },
    )
    .expect("compiles");
    let places: Vec<[f32; 4]> = points.iter().map(|p| p.extend(0.0).to_array()).collect();
    let input = gpu.storage_buffer_of("points", &places).expect("fits");
    let corners = gpu
        .storage_buffer("corners", points.len() as u64 * 64)
        .expect("fits");
    let mut resources = field.resources().to_vec();
    resources.push(("points", input.as_entire_binding()));
    resources.push(("corners", corners.as_entire_binding()));
    let bindings = kernel.bind(gpu, &resources);
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("weights", |pass| {
        kernel.dispatch_threads(pass, &bindings, [points.len() as u32, 1, 1]);
    });
    recorder.submit(gpu).expect("submits");
    let found: Vec<[[f32; 2]; 8]> = gpu.read_buffer(&corners).expect("reads back");
    found[..points.len()]
        .iter()
        .map(|corners| {
            let mut by_slot = vec![0.0; field.volume().slots() as usize];
            let total: f32 = corners.iter().map(|[_, weight]| weight).sum();
            assert!(total > 1e-6, "a point that no probe reaches: {corners:?}");
            for [slot, weight] in corners {
                assert!((0.0..=1.0).contains(weight), "{corners:?}");
                by_slot[*slot as usize] += weight / total;
            }
            by_slot
        })
        .collect()
}

const WEIGHTS: &str = "
import package::probes::volume::{cage_around, cage_slot, corner_share, probe_place};
@group(3) @binding(0) var<storage, read> points: array<vec4f>;
@group(3) @binding(1) var<storage, read_write> corners: array<vec2f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&points) {
        let point = points[id.x].xyz;
        let cage = cage_around(0u, point);
        for (var corner = 0u; corner < 8u; corner += 1u) {
            let slot = cage_slot(cage, corner);
            let share = corner_share(cage, corner, probe_place(slot), point);
            corners[id.x * 8u + corner] = vec2f(f32(slot), share);
        }
    }
}
";

/// Points and steps so small that no weight may change much, across the planes between cages too;
/// probes moved at random as far as the parameters allow.
#[test]
fn weights_of_moved_probes_are_shares_and_continuous() {
    const STEP: f32 = 1e-4;
    let gpu = gpu();
    let parameters = ProbeParameters::default();
    let field = ProbeField::new(&gpu, volume(), &parameters).expect("fits");
    field.begin_frame(&gpu, &parameters, 1, 0);
    let reach = parameters.move_reach * SPACING;
    let random = |i: u64| sampling::rotation(17, i).xyz().as_vec3();
    let moved: Vec<[f32; 4]> = (0..volume().slots())
        .map(|slot| volume().position(slot) + (random(u64::from(slot)) * reach).round())
        .map(|place| place.extend(1.0).to_array())
        .collect();
    gpu.queue
        .write_buffer(field.places(), 0, bytemuck::cast_slice(&moved));
    let extent = (volume().counts() - 1).as_vec3() * SPACING * 0.5;
    let points: Vec<Vec3> = (0..1500)
        .map(|i| {
            let mut place = (random(i + 1000) * extent) / SPACING;
            // Every other point lies on a plane between cages.
            if i % 2 == 0 {
                let axis = (i / 2 % 3) as usize;
                let half = (volume().counts()[axis] - 1) as f32 * 0.5;
                place[axis] = (place[axis] + half).round() - half;
            }
            Vec3::new(0.3, -0.4, 0.5) + place * SPACING
        })
        .collect();
    let shifted = |by: f32| -> Vec<Vec3> { points.iter().map(|p| *p + Vec3::splat(by)).collect() };
    let before = weights(&gpu, &field, &shifted(-STEP));
    let after = weights(&gpu, &field, &shifted(STEP));
    for ((before, after), point) in before.iter().zip(&after).zip(&points) {
        for (slot, (a, b)) in before.iter().zip(after).enumerate() {
            // Where neighbours have changed places, shares are steep, but no step.
            assert!(
                (a - b).abs() < 0.02,
                "slot {slot} jumps at {point}: {a}, {b}"
            );
        }
    }
}
