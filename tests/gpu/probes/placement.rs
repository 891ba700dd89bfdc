//! Where probes move when their lattice point is solid, and their weights there.

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    parameters::{
        Method, ProbeParameters, Relocation, SourceParameters, SourceRelocation, SourceWeights,
    },
    passes::{
        probes::{
            ProbeField, classify::ProbeClassify, schedule::ProbeSchedule, source_walk::SourceWalk,
        },
        scene::GpuVoxels,
    },
    probes::{Layout as _, MOVE_REACH, Volume, sampling},
};
use half::f16;

use crate::support::{
    gpu,
    scenes::{lattice, volume_of, voxels_from},
};

const SIZE: i32 = 32;
const ORIGIN: IVec3 = IVec3::new(-16, -16, -16);
const SPACING: Vec3 = Vec3::new(5.0, 4.0, 3.0);

/// Grid space. Caves as large as a cage, pits of one voxel, and a slab thicker than any reach.
fn is_solid(voxel: IVec3) -> bool {
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
    let centre = Vec3::new(0.3, -0.4, 0.5);
    volume_of(&lattice(UVec3::new(7, 9, 10), SPACING, centre))
}

/// The test's world and its probes on the GPU.
fn placed(gpu: &Gpu, parameters: &ProbeParameters) -> (ProbeField, GpuVoxels) {
    let voxels = voxels_from(UVec3::splat(SIZE as u32), |voxel| u8::from(is_solid(voxel)));
    let voxels = GpuVoxels::upload(gpu, &voxels, ORIGIN).expect("fits");
    let field = ProbeField::new(gpu, volume(), parameters).expect("fits");
    let pass = ProbeClassify::new(gpu, &field, &voxels.resources()).expect("compiles");
    field.begin_frame(gpu, parameters, 1, 0);
    let mut recorder = Recorder::new(gpu, None);
    pass.record(&mut recorder);
    recorder.submit(gpu).expect("submits");
    (field, voxels)
}

/// XYZ: place, W: whether alive.
fn places(gpu: &Gpu, parameters: &ProbeParameters) -> Vec<[f32; 4]> {
    let (field, _) = placed(gpu, parameters);
    let mut places = gpu.read_buffer(field.places()).expect("reads back");
    // Back-side probes are not placed here.
    places.truncate(volume().slots() as usize);
    places
}

/// Squared distance that a probe moves (voxels), plus 4 for each solid neighbour beyond three.
fn cost(from: IVec3, to: IVec3) -> i32 {
    let around = [IVec3::X, IVec3::Y, IVec3::Z]
        .into_iter()
        .flat_map(|axis| [to + axis, to - axis])
        .filter(|voxel| is_solid(*voxel))
        .count() as i32;
    let is_outside = to.cmplt(IVec3::ZERO).any() || to.cmpge(IVec3::splat(SIZE)).any();
    (to - from).length_squared() + 4 * (around - 3).max(0) + 4096 * i32::from(is_outside)
}

/// A closed corridor whose walls are thinner towards the outside than towards the air in them.
#[test]
fn probes_stay_in_the_world_where_its_walls_are_thin() {
    let gpu = gpu();
    let size = UVec3::new(13, 12, 36);
    let voxels = voxels_from(size, |voxel| {
        let inside =
            voxel.cmpge(IVec3::new(6, 5, 3)).all() && voxel.cmplt(IVec3::new(7, 7, 33)).all();
        u8::from(!inside)
    });
    let voxels = GpuVoxels::upload(&gpu, &voxels, IVec3::ZERO).expect("fits");
    let centre = size.as_vec3() / 2.0;
    let volume = volume_of(&lattice(UVec3::new(2, 2, 6), Vec3::splat(7.0), centre));
    let parameters = ProbeParameters::default();
    let field = ProbeField::new(&gpu, volume, &parameters).expect("fits");
    let pass = ProbeClassify::new(&gpu, &field, &voxels.resources()).expect("compiles");
    field.begin_frame(&gpu, &parameters, 1, 0);
    let mut recorder = Recorder::new(&gpu, None);
    pass.record(&mut recorder);
    recorder.submit(&gpu).expect("submits");
    let places: Vec<[f32; 4]> = gpu.read_buffer(field.places()).expect("reads back");
    let alive: Vec<Vec3> = (places.iter().take(24))
        .filter(|place| place[3] != 0.0)
        .map(|[x, y, z, _]| Vec3::new(*x, *y, *z))
        .collect();
    assert!(alive.len() >= 16, "{} are alive", alive.len());
    for place in alive {
        let is_inside = place.cmpgt(Vec3::ZERO).all() && place.cmplt(size.as_vec3()).all();
        assert!(is_inside, "{place}");
    }
}

#[test]
fn probes_in_solid_voxels_move_to_the_best_air_within_reach_or_die() {
    let gpu = gpu();
    let parameters = ProbeParameters::default();
    let reach = (MOVE_REACH * SPACING).as_ivec3();
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
            .filter(|voxel| !is_solid(*voxel))
            .map(|voxel| cost(home, voxel))
            .min();
        match best {
            _ if !is_solid(home) => assert_eq!((place, alive), (home, 1.0), "slot {slot}"),
            None => {
                assert_eq!((place, alive), (home, 0.0), "slot {slot}");
                dead += 1;
            }
            Some(best) => {
                assert!(!is_solid(place), "slot {slot} is put into a solid voxel");
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
fn without_relocation_probes_in_solid_voxels_are_dead_where_they_are() {
    let parameters = ProbeParameters {
        relocation: Relocation::Off,
        ..Default::default()
    };
    for (slot, [x, y, z, alive]) in (0..).zip(places(&gpu(), &parameters)) {
        let home_ws = volume().position(slot);
        let solid = is_solid(home_ws.floor().as_ivec3() - ORIGIN);
        assert_eq!((Vec3::new(x, y, z), alive == 0.0), (home_ws, solid));
    }
}

/// Weights of the probes at points, by slot: their shares, normalised to add up to 1 as in the gather. `share` is the
/// expression of a corner's share.
fn weights(gpu: &Gpu, field: &ProbeField, points: &[Vec3], share: &str) -> Vec<Vec<f32>> {
    let source = WEIGHTS.replace("SHARE", share);
    let kernel = Kernel::new(
        gpu,
        &KernelSpec {
            shader: "generated/weights",
            generated: &[("weights", &source)],
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
import package::probes::source_weights::adjusted_share;
import package::probes::volume::{cage_around, cage_slot, corner_share, lattice_weights, probe_place};
@group(3) @binding(0) var<storage, read> points: array<vec4f>;
@group(3) @binding(1) var<storage, read_write> corners: array<vec2f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&points) {
        let point = points[id.x].xyz;
        let cage = cage_around(0u, point);
        for (var corner = 0u; corner < 8u; corner += 1u) {
            let slot = cage_slot(cage, corner);
            let share = SHARE;
            corners[id.x * 8u + corner] = vec2f(f32(slot), share);
        }
    }
}
";

/// Shares from the places of the probes, from the lattice alone, and from Fibix's filter.
const CONTINUOUS: &str = "corner_share(cage, corner, probe_place(slot), point)";
const LATTICE: &str = "lattice_weights(cage, corner).x * lattice_weights(cage, corner).y * lattice_weights(cage, corner).z";
const ADJUSTED: &str = "adjusted_share(cage, corner, probe_place(slot).position_ws)";

/// Probes moved at random as far as they may, and points in their volume.
struct Moved {
    share: &'static str,
    gpu: Gpu,
    field: ProbeField,
    places: Vec<Vec3>,
    points: Vec<Vec3>,
}

impl Moved {
    fn new(share: &'static str) -> Self {
        let gpu = gpu();
        let parameters = ProbeParameters::default();
        let field = ProbeField::new(&gpu, volume(), &parameters).expect("fits");
        field.begin_frame(&gpu, &parameters, 1, 0);
        let reach = MOVE_REACH * SPACING;
        let random = |i: u64| sampling::rotation(17, i).xyz().as_vec3();
        let places: Vec<Vec3> = (0..volume().slots())
            .map(|slot| volume().position(slot) + (random(slot.into()) * reach).trunc())
            .collect();
        let alive: Vec<[f32; 4]> = places.iter().map(|p| p.extend(1.0).to_array()).collect();
        gpu.queue
            .write_buffer(field.places(), 0, bytemuck::cast_slice(&alive));
        let extent = (volume().counts() - 1).as_vec3() * SPACING * 0.5;
        let points = (0..1500)
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
        Self {
            share,
            gpu,
            field,
            places,
            points,
        }
    }

    fn weights(&self, points: &[Vec3]) -> Vec<Vec<f32>> {
        weights(&self.gpu, &self.field, points, self.share)
    }

    /// The largest change of a weight over a tiny step, across the planes between cages too.
    fn largest_jump(&self) -> f32 {
        const STEP: f32 = 1e-4;
        let shifted = |by: f32| -> Vec<Vec3> { self.points.iter().map(|p| p + by).collect() };
        let before = self.weights(&shifted(-STEP));
        let after = self.weights(&shifted(STEP));
        let all = before.iter().flatten().zip(after.iter().flatten());
        all.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }
}

/// `weights` itself asserts for all three kinds that shares add up to 1.
#[test]
fn continuous_and_lattice_weights_are_shares_without_steps() {
    // Where neighbours have changed places, shares are steep but have no step.
    let jump = Moved::new(CONTINUOUS).largest_jump();
    assert!(jump < 0.02, "{jump}");
    let jump = Moved::new(LATTICE).largest_jump();
    assert!(jump < 1e-3, "{jump}");
}

/// The comparison above can fail: the source's weights have steps between cages.
#[test]
fn adjusted_weights_are_shares_with_steps_between_cages() {
    let jump = Moved::new(ADJUSTED).largest_jump();
    assert!(jump > 0.1, "{jump}");
}

#[test]
fn lattice_and_adjusted_weights_are_their_closed_forms() {
    for kind in [LATTICE, ADJUSTED] {
        let moved = Moved::new(kind);
        let spacing = volume().levels()[0].spacing();
        for (found, point) in moved.weights(&moved.points).iter().zip(&moved.points) {
            let mut expected = vec![0.0; found.len()];
            for (slot, lattice) in volume().cage(*point) {
                let home = volume().position(slot);
                let low = volume().levels()[0].anchor();
                let index = ((home - low) / spacing).round();
                let along = (point - low) / spacing;
                // Where the point lies in the cage, seen from this corner: 1 − along or along.
                let is_low = index.cmple(along);
                let offset = (moved.places[slot as usize] - home) / spacing;
                let adjusted = (0..3).map(|axis| {
                    let a =
                        (along[axis] - index[axis] + f32::from(!is_low.test(axis))).clamp(0.0, 1.0);
                    let c = f32::from(!is_low.test(axis));
                    let t = (c - offset[axis]) / (1.0 - offset[axis]);
                    ((1.0 - a) * (1.0 - t) + a * t).clamp(0.0, 1.0)
                });
                expected[slot as usize] += match kind {
                    ADJUSTED => adjusted.product::<f32>(),
                    _ => lattice,
                };
            }
            // On a plane between cages either cage is right.
            let fraction = ((point - volume().levels()[0].anchor()) / spacing).fract();
            let on_plane = (fraction - 0.5).abs().max_element() > 0.4999;
            let total: f32 = expected.iter().sum();
            for (slot, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let difference = (found - expected / total).abs();
                assert!(
                    on_plane || difference < 1e-3,
                    "slot {slot} at {point}: {found}, not {}",
                    expected / total
                );
            }
        }
    }
}

/// Steps of the walk, in order: six directions at one voxel, then at two, and so on.
fn steps(reach: IVec3) -> impl Iterator<Item = IVec3> {
    (1..=reach.max_element()).flat_map(move |distance| {
        [IVec3::X, IVec3::Y, IVec3::Z]
            .into_iter()
            .flat_map(|axis| [axis, -axis])
            .map(move |direction| direction * distance)
    })
}

/// Distance (voxels) from the middle of an air voxel to the nearest solid voxel along an axis, as rays would find.
fn clearance(voxel: IVec3) -> f32 {
    let free = |direction: &IVec3| {
        (0..6)
            .take_while(|i| !is_solid(voxel + *direction * *i))
            .count()
    };
    let axes = [IVec3::X, IVec3::Y, IVec3::Z].into_iter();
    let nearest = axes.flat_map(|axis| [axis, -axis]).map(|d| free(&d)).min();
    nearest.expect("six") as f32 - 0.5
}

/// The source's algorithm, in which probes walk.
fn walking(relocation: SourceRelocation) -> ProbeParameters {
    ProbeParameters {
        method: Method::Source,
        rays: 8,
        source: SourceParameters {
            relocation,
            weights: SourceWeights::Adjusted,
            ..Default::default()
        },
        ..Default::default()
    }
}

fn begin(gpu: &Gpu, walk: &SourceWalk) {
    let mut recorder = Recorder::new(gpu, None);
    walk.record_begin(&mut recorder);
    recorder.submit(gpu).expect("submits");
}

#[test]
fn walking_probes_stop_where_their_rays_are_free() {
    let gpu = gpu();
    let parameters = walking(SourceRelocation::Clear);
    let (field, voxels) = placed(&gpu, &parameters);
    let walk = SourceWalk::with_memory(&gpu, &field, &voxels.resources(), 0.0);
    let walk = walk.expect("compiles").expect("probes walk");
    begin(&gpu, &walk);
    let schedule = ProbeSchedule::new(&gpu, &field, &[]).expect("compiles");
    let reach = (MOVE_REACH * SPACING).as_ivec3();
    let voxel_of = |place: &[f32; 4]| Vec3::from_slice(place).floor().as_ivec3() - ORIGIN;
    let mut found: Vec<[f32; 4]> = Vec::new();
    // As many frames as two walks have steps.
    for frame in 0..2 * steps(reach).count() as u64 + 2 {
        field.begin_frame(&gpu, &parameters, 1, frame);
        found = gpu.read_buffer(field.places()).expect("reads back");
        let rays: Vec<[f16; 4]> = found
            .iter()
            .flat_map(|place| {
                let voxel = voxel_of(place);
                let length = if is_solid(voxel) {
                    -1.0
                } else {
                    clearance(voxel)
                };
                [[0.0, 0.0, 0.0, length].map(f16::from_f32); 8]
            })
            .collect();
        gpu.queue
            .write_buffer(field.rays(), 0, bytemuck::cast_slice(&rays));
        let mut recorder = Recorder::new(&gpu, None);
        schedule.record(&mut recorder);
        walk.record(&mut recorder);
        recorder.submit(&gpu).expect("submits");
    }
    let (mut walked, mut far, mut dead) = (0, 0, 0);
    for (slot, place) in (0..).zip(&found) {
        let home = voxel_of(&volume().position(slot).extend(0.0).to_array());
        let turn = || steps(reach).map(|step| home + step);
        let allowed = |voxel: &IVec3| (*voxel - home).abs().cmple(reach).all() && !is_solid(*voxel);
        let clear = |voxel: &IVec3| allowed(voxel) && clearance(*voxel) >= SourceWalk::CLEARANCE;
        let expected = [home]
            .into_iter()
            .chain(turn())
            .find(clear)
            .or(turn().find(allowed));
        match expected {
            Some(voxel) => {
                assert_eq!((voxel_of(place), place[3]), (voxel, 1.0), "slot {slot}");
                walked += u32::from(voxel != home);
                far += u32::from((voxel - home).abs().max_element() > 1);
            }
            None => {
                assert_eq!((voxel_of(place), place[3]), (home, 0.0), "slot {slot}");
                dead += 1;
            }
        }
    }
    assert!(
        walked > 50 && far > 10 && dead > 50,
        "{walked}, {far}, {dead}"
    );
}

#[test]
fn a_probe_walks_only_after_a_long_time_in_a_solid_voxel() {
    let gpu = gpu();
    let parameters = walking(SourceRelocation::Surface);
    let (field, voxels) = placed(&gpu, &parameters);
    let walk = SourceWalk::new(&gpu, &field, &voxels.resources());
    let walk = walk.expect("compiles").expect("probes walk");
    begin(&gpu, &walk);
    let schedule = ProbeSchedule::new(&gpu, &field, &[]).expect("compiles");
    let ray = [0.0, 0.0, 0.0, -1.0].map(f16::from_f32);
    let rays = vec![ray; volume().slots() as usize * 8];
    gpu.queue
        .write_buffer(field.rays(), 0, bytemuck::cast_slice(&rays));
    let before: Vec<[f32; 4]> = gpu.read_buffer(field.places()).expect("reads back");
    // 1 − 0.95ⁿ passes a half at n = 14.
    for frame in 1..=14 {
        field.begin_frame(&gpu, &parameters, 1, frame);
        let mut recorder = Recorder::new(&gpu, None);
        schedule.record(&mut recorder);
        walk.record(&mut recorder);
        recorder.submit(&gpu).expect("submits");
        let places: Vec<[f32; 4]> = gpu.read_buffer(field.places()).expect("reads back");
        assert_eq!(places == before, frame < 14, "frame {frame}");
    }
}
