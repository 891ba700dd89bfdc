//! Hits that probes keep (`probes.hits=kept`): they light as marched ones do, and after anything that happens to voxels
//! or probes no hit is kept that a fresh start would not find.

use std::collections::HashMap;

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    frame::{Frame, Stage},
    gpu::Gpu,
    parameters::{FinalGather, ProbeHits, ProbeParameters, ProbeStates, RayLattice},
    passes::probes::{GpuProbePlace, ProbeField, ProbeFieldError},
    probes::sampling::kept_directions,
    world::{
        LayoutSpec,
        scenery::OctreeSpec,
        voxels::{Edit, Voxels},
    },
};
use half::f16;

use crate::support::{
    self,
    frames::Drawn,
    scenes::{lattice, volume_of},
    with_faults,
};

/// Two rooms behind a wall; the second is open to the sky.
const ROOMS: &str = "(
    title: \"Two rooms.\",
    size: (32, 32, 32),
    origin: (-16, -16, -16),
    shape: Union([
        Subtraction([Box(half: (14, 12, 12)), Box(half: (12, 10, 10)), Translate(by: (7, 11, 0), of: Box(half: (3, 3, 4)))]),
        Box(half: (1, 12, 12)),
    ]),
    materials: {\"plaster\": (a: Flat(0.7, 0.6, 0.5)), \"glow\": (a: Flat(0.5, 0.5, 0.5), emission: (1, 2, 3))},
    lamps: [(name: \"one\", lamps: [(position: (-7, 4, -4), power: 2000)])],
    cameras: [(name: \"inside\", position: (-9, 2, -7), look_at: (-4, -4, 6), fov_deg: 80)],
    sky: (zenith: (1, 1, 2)),
)";

const SIZE: [u32; 2] = [32, 24];
const RAYS: u32 = 64;
/// Bits of a hit that say what it is: not the steps that marching took.
const WHAT: u32 = 0xffff;

fn kept(hit_sets: u32, lattice: RayLattice) -> ProbeParameters {
    ProbeParameters {
        rays: RAYS,
        hits: ProbeHits::Kept,
        hit_sets,
        lattice,
        states: ProbeStates::Off,
        final_gather: FinalGather::Off,
        ..ProbeParameters::default()
    }
}

fn uniform() -> LayoutSpec {
    lattice(UVec3::new(5, 4, 4), Vec3::splat(6.0), Vec3::ZERO)
}

fn rooms(gpu: &Gpu, layout: &LayoutSpec, probes: &ProbeParameters) -> Drawn {
    let world = support::parsed(ROOMS);
    Drawn::new(gpu.clone(), world, layout, probes.clone(), SIZE)
}

/// The same world with these voxels, from the start.
fn fresh(drawn: &Drawn, layout: &LayoutSpec, voxels: &Voxels) -> Drawn {
    let (gpu, world) = (drawn.gpu.clone(), support::parsed(ROOMS));
    let stage = Stage::upload(&gpu, &world, voxels).expect("fits");
    Drawn {
        frame: Frame::new(&gpu, stage, layout, &drawn.probes, SIZE).expect("fits"),
        lights: drawn.lights.clone(),
        probes: drawn.probes.clone(),
        shot: drawn.shot.clone(),
        gpu,
        world,
    }
}

fn field(drawn: &Drawn) -> &ProbeField {
    drawn.frame.field()
}

/// Words of the kept hits: by slot, set, ray.
fn hits(drawn: &Drawn) -> Vec<[u32; 2]> {
    let slots = field(drawn).atlas().slots;
    let all: Vec<[u32; 2]> = drawn.gpu.read_buffer(field(drawn).rays()).expect("reads");
    all[(slots * RAYS) as usize..].to_vec()
}

fn places(drawn: &Drawn) -> Vec<GpuProbePlace> {
    drawn.gpu.read_buffer(field(drawn).places()).expect("reads")
}

/// How many kept hits are those of the other field, which was made for the voxels as they are now. Panics at one that
/// is not. Probes are told apart by their places.
fn assert_true(drawn: &Drawn, other: &Drawn, what: &str) -> usize {
    let own = drawn.probes.hit_sets as usize * RAYS as usize;
    let key = |place: &GpuProbePlace| place.position_ws.map(f32::to_bits);
    let (truth, of_truth) = (hits(other), places(other));
    let alive = |place: &GpuProbePlace| place.alive > 0.0;
    let numbered = of_truth.iter().enumerate();
    let known: HashMap<_, _> = numbered
        .filter(|(_, place)| alive(place))
        .map(|(slot, place)| (key(place), slot))
        .collect();
    let found = hits(drawn);
    let mut compared = 0;
    for (slot, place) in places(drawn).iter().enumerate() {
        let Some(other) = known.get(&key(place)).filter(|_| alive(place)) else {
            continue;
        };
        for ray in 0..own {
            let (found, truth) = (found[slot * own + ray], truth[other * own + ray]);
            if found[1] != 0 && truth[1] != 0 {
                let same = found[1] & WHAT == truth[1] & WHAT
                    && (found[1] & WHAT == WHAT || found[0] == truth[0]);
                assert!(
                    same,
                    "{what}: probe {place:?}, ray {ray}: {found:x?} {truth:x?}"
                );
                compared += 1;
            }
        }
    }
    compared
}

fn apply(drawn: &mut Drawn, voxels: &Voxels, edit: &Edit) {
    let gpu = drawn.gpu.clone();
    drawn.frame.apply(&gpu, voxels, edit).expect("fits");
}

/// Irradiance of all probes, and their rays.
fn light(drawn: &Drawn) -> (Vec<[f32; 3]>, Vec<[u32; 2]>) {
    let slots = field(drawn).atlas().slots;
    let rays: Vec<[u32; 2]> = drawn.gpu.read_buffer(field(drawn).rays()).expect("reads");
    let irradiance = field(drawn).irradiance(&drawn.gpu).expect("reads");
    (irradiance, rays[..(slots * RAYS) as usize].to_vec())
}

#[test]
fn kept_hits_light_as_marched_ones_to_the_bit() {
    let gpu = support::gpu();
    let file = "probes/kept_hits.wesl";
    let marches = with_faults(&gpu, &[(file, "return packed.y != 0u;", "return false;")]);
    let wrong = with_faults(
        &gpu,
        &[(file, "face, time, surface", "face, time + 0.01, surface")],
    );
    for (sets, directions) in [(1, RayLattice::Fibonacci), (3, RayLattice::LatLong)] {
        let probes = kept(sets, directions);
        let after = |gpu: &Gpu| {
            let mut drawn = rooms(gpu, &uniform(), &probes);
            drawn.draw(25);
            (light(&drawn), hits(&drawn))
        };
        let (of_kept, hits) = after(&gpu);
        let (of_marched, _) = after(&marches);
        assert!(hits.iter().filter(|hit| hit[1] != 0).count() > 1000);
        assert!(of_kept.0.iter().any(|light| light[0] > 0.01));
        assert!(of_kept == of_marched, "{sets} sets");
        assert!(after(&wrong).0 != of_marched, "a planted fault is seen");
    }
}

/// Whether a segment comes within `margin` of a box: slabs, on the CPU.
fn crosses(from: Vec3, to: Vec3, low: Vec3, high: Vec3, margin: f32) -> bool {
    let (low, high) = (low - margin, high + margin);
    let along = to - from;
    let (mut enter, mut leave) = (0f32, 1f32);
    for axis in 0..3 {
        let times = [low[axis], high[axis]].map(|plane| (plane - from[axis]) / along[axis]);
        enter = enter.max(times[0].min(times[1]));
        leave = leave.min(times[0].max(times[1]));
    }
    enter <= leave
}

#[test]
fn an_edit_traces_again_the_rays_that_cross_it_and_no_others() {
    const MARK: u32 = 0x7777;
    let gpu = support::gpu();
    let probes = kept(1, RayLattice::Fibonacci);
    let mut drawn = rooms(&gpu, &uniform(), &probes);
    drawn.draw(10);
    let mut voxels = drawn.frame.stage.read_back(&gpu).expect("reads back");
    let before = places(&drawn);
    // The upper half of the words Y counts the steps of marching. No ray of this world takes as many as the mark.
    let all: Vec<[u32; 2]> = gpu.read_buffer(field(&drawn).rays()).expect("reads");
    let slots = field(&drawn).atlas().slots;
    let first = (slots * RAYS) as usize;
    let marked: Vec<[u32; 2]> = all
        .iter()
        .enumerate()
        .map(|(index, &[x, y])| match y {
            y if index >= first && y != 0 => [x, y & WHAT | MARK << 16],
            y => [x, y],
        })
        .collect();
    gpu.queue
        .write_buffer(field(&drawn).rays(), 0, bytemuck::cast_slice(&marked));
    // A hole through the wall.
    let (low, high) = (IVec3::new(14, 14, 12), IVec3::new(17, 19, 18));
    let edit = voxels.fill_box(low, high, 0);
    apply(&mut drawn, &voxels, &edit);
    drawn.draw(1);
    let lengths = light(&drawn).1;
    let (after, found) = (places(&drawn), hits(&drawn));
    let directions = kept_directions(&probes, 0);
    let (mut again, mut untouched) = (0, 0);
    for (slot, (place, old)) in after.iter().zip(&before).enumerate() {
        if place.alive == 0.0 || old.alive == 0.0 {
            continue;
        }
        let has_moved = place.position_ws != old.position_ws;
        let from = Vec3::from(place.position_ws) + 16.0;
        for (ray, direction) in directions.iter().enumerate() {
            let index = slot * RAYS as usize + ray;
            if marked[first + index][1] == 0 {
                continue;
            }
            // The new length: where the hole is in the way the old one ended in it.
            let length = f16::from_bits((lengths[index][1] >> 16) as u16).to_f32();
            let to = from + direction.as_vec3() * length.min(100.0);
            let (low, high) = (low.as_vec3(), high.as_vec3() + 1.0);
            let is_traced_again = found[index][1] >> 16 != MARK;
            if has_moved || crosses(from, to, low, high, -0.01) {
                assert!(is_traced_again, "{place:?} {direction}");
                again += 1;
            } else if !crosses(from, to, low, high, 1.1) {
                assert!(!is_traced_again, "{place:?} {direction}");
                untouched += 1;
            }
        }
    }
    assert!(again > 50 && untouched > 1000, "{again} {untouched}");
    let mut anew = fresh(&drawn, &uniform(), &voxels);
    anew.draw(1);
    assert!(assert_true(&drawn, &anew, "a hole") > 3000);
}

/// Edits while probes sleep and other sets are in turn.
fn edits_leave_only_true_hits(layout: &LayoutSpec) {
    let gpu = support::gpu();
    let probes = ProbeParameters {
        states: ProbeStates::On,
        ..kept(3, RayLattice::LatLong)
    };
    let mut drawn = rooms(&gpu, layout, &probes);
    // Until the probes of the other room sleep.
    drawn.draw(60);
    let mut voxels = drawn.frame.stage.read_back(&gpu).expect("reads back");
    let edits = [
        (IVec3::new(14, 10, 12), IVec3::new(17, 19, 18), 0),
        (IVec3::new(22, 12, 14), IVec3::new(25, 15, 17), 2),
        (IVec3::new(16, 10, 12), IVec3::new(16, 19, 18), 1),
    ];
    for (number, (low, high, material)) in edits.into_iter().enumerate() {
        let edit = voxels.fill_box(low, high, material);
        apply(&mut drawn, &voxels, &edit);
        let mut anew = fresh(&drawn, layout, &voxels);
        anew.draw(30);
        for frames in [1, 2, 12] {
            drawn.draw(frames);
            let what = format!("edit {number}, {frames} frames later");
            let compared = assert_true(&drawn, &anew, &what);
            assert!(compared > 2000, "{what}: {compared}");
        }
    }
}

#[test]
fn edits_leave_only_true_hits_in_a_lattice() {
    edits_leave_only_true_hits(&uniform());
}

#[test]
fn edits_leave_only_true_hits_in_an_octree() {
    edits_leave_only_true_hits(&LayoutSpec {
        octree: Some(OctreeSpec {
            depth: 2,
            divide_at: 0.8,
            ..OctreeSpec::default()
        }),
        ..lattice(UVec3::splat(2), Vec3::splat(24.0), Vec3::ZERO)
    });
}

#[test]
fn cascades_that_move_keep_only_true_hits() {
    let gpu = support::gpu();
    let layout = LayoutSpec {
        cascades: 2,
        follow: true,
        ..lattice(UVec3::splat(4), Vec3::splat(3.0), Vec3::ZERO)
    };
    let mut drawn = rooms(&gpu, &layout, &kept(2, RayLattice::Fibonacci));
    let voxels = drawn.frame.stage.read_back(&gpu).expect("reads back");
    drawn.draw(8);
    for step in [
        Vec3::X * 3.5,
        Vec3::new(7.0, 0.0, 3.0),
        Vec3::splat(-1.0),
        Vec3::X * -100.0,
    ] {
        drawn.shot.camera.position += step;
        drawn.draw(1);
        let mut anew = fresh(&drawn, &layout, &voxels);
        anew.draw(4);
        let compared = assert_true(&drawn, &anew, &format!("{step}"));
        assert!(compared > 500, "{step}: {compared}");
    }
}

#[test]
fn stale_hits_would_be_found() {
    let faulty = with_faults(
        &support::gpu(),
        &[(
            "probes/forget_hits.wesl",
            "if !has_moved && !has_edit {",
            "if true {",
        )],
    );
    let probes = kept(1, RayLattice::Fibonacci);
    let mut drawn = rooms(&faulty, &uniform(), &probes);
    drawn.draw(10);
    let mut voxels = drawn.frame.stage.read_back(&faulty).expect("reads back");
    let edit = voxels.fill_box(IVec3::new(14, 14, 12), IVec3::new(17, 19, 18), 0);
    apply(&mut drawn, &voxels, &edit);
    drawn.draw(2);
    let mut anew = fresh(&drawn, &uniform(), &voxels);
    anew.draw(2);
    let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        assert_true(&drawn, &anew, "no hit was forgotten")
    }));
    assert!(checked.is_err(), "stale hits went unnoticed");
}

#[test]
fn hits_that_do_not_fit_are_refused_before_anything_is_allocated() {
    let gpu = support::gpu();
    let probes = ProbeParameters {
        rays: 4096,
        ..kept(64, RayLattice::Fibonacci)
    };
    let layout = lattice(UVec3::splat(16), Vec3::splat(2.0), Vec3::ZERO);
    let error = match ProbeField::new(&gpu, volume_of(&layout), &probes) {
        Err(ProbeFieldError::Gpu(error)) => error.to_string(),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("{} bytes fit", 16u64.pow(3) * 4096 * 8 * 65),
    };
    for part in ["probes.hits=kept", "fewer", "probes.hit_sets", "bytes"] {
        assert!(error.contains(part), "{part}: {error}");
    }
}
