//! Marching on the GPU: the brick map against the plain DDA hit for hit, and against the CPU's marcher.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    passes::{
        bench::rays::{FoundHit, Marcher, RayBench, RayKind, RaySet, ShadowTarget},
        scene::GpuVoxels,
    },
    reference::march::{Outcome, Ray, march_plain},
    world::{
        Camera,
        voxels::{NewCell, Voxels, brick_index},
    },
};

use crate::support::{self, frames};

const SIZE: UVec3 = UVec3::new(128, 64, 96);

/// A pseudorandom number in [0, 1).
fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277_803_737);
    ((word >> 22 ^ word) >> 8) as f32 / 16_777_216.0
}

/// Air with solid voxels at every size: single voxels, bricks, uniform cells.
fn rubble(seed: u32) -> Voxels {
    Voxels::from_cells(SIZE, |cell| {
        let mut state = seed ^ (cell.x * 7 + cell.y * 1_009 + cell.z * 91_193);
        let kind = random(&mut state);
        if kind < 0.6 {
            return NewCell::Empty;
        }
        if kind < 0.65 {
            return NewCell::Uniform(1);
        }
        let mut content = Box::new([0; 512]);
        for _ in 0..=(random(&mut state) * 6.0) as u32 {
            let at = UVec3::new(0, 0, 0).map(|_| (random(&mut state) * 8.0) as u32);
            content[brick_index(at)] = 1;
        }
        NewCell::Voxels(content)
    })
}

fn directions() -> Vec<Vec3> {
    let mut state = 5;
    let mut all: Vec<Vec3> = (0..200)
        .map(|_| {
            Vec3::ZERO
                .map(|_| random(&mut state) * 2.0 - 1.0)
                .normalize()
        })
        .collect();
    // Along axes and diagonals every crossing is a tie.
    for i in 0..27 {
        let d = IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        if d != IVec3::ZERO {
            all.push(d.as_vec3());
        }
    }
    all
}

fn mismatches(a: &[FoundHit], b: &[FoundHit]) -> usize {
    a.iter().zip(b).filter(|(a, b)| !a.same_hit(**b)).count()
}

#[test]
fn marching_equals_plain_dda_hit_for_hit() {
    let gpu = support::gpu();
    for (seed, position) in [
        (1, Vec3::new(60.3, 30.7, 50.2)),
        (2, Vec3::new(-30.0, 90.0, -20.0)),
        (3, Vec3::new(64.0, 32.0, 160.0)),
    ] {
        let voxels = rubble(seed);
        let on_gpu = GpuVoxels::upload(&gpu, &voxels, IVec3::ZERO).expect("fits");
        let camera = Camera {
            name: "test".to_owned(),
            position,
            yaw_deg: if seed == 2 { 215.0 } else { 0.0 },
            pitch_deg: if seed == 2 { -35.0 } else { 0.0 },
            fov_deg: 80.0,
        };
        let shot = frames::shot(camera, [160, 96]);
        let view_buffer = gpu.uniform_buffer("view", &shot.to_gpu());
        let probes: Vec<UVec3> = (0..64)
            .map(|i| UVec3::new(i * 37 % SIZE.x, i * 11 % SIZE.y, i * 53 % SIZE.z))
            .filter(|probe| voxels.material(probe.as_ivec3()) == 0)
            .collect();
        let directions = directions();
        let mut bench = RayBench::new(
            &gpu,
            &on_gpu,
            &RaySet {
                view: &view_buffer,
                size: shot.size,
                rays_per_edge: 1,
                probes: &probes,
                directions: &directions,
            },
        )
        .expect("compiles");
        let light = if seed == 2 {
            ShadowTarget::Sun(Vec3::new(0.3, 0.8, 0.4))
        } else {
            ShadowTarget::Lamp(Vec3::new(20.0, 60.0, 40.0))
        };
        bench.aim(&gpu, light).expect("runs");
        for kind in [RayKind::Camera, RayKind::Shadow, RayKind::Probe] {
            let run = |marcher| {
                let hits = bench.hits(&gpu, kind, marcher).expect("runs");
                let timed = bench.time(&gpu, kind, marcher, 1).expect("runs");
                assert_eq!(
                    timed.results.len(),
                    bench.rays(kind) as usize * kind.timed_words()
                );
                for (hit, words) in hits.iter().zip(timed.results.chunks(kind.timed_words())) {
                    let expected = match kind {
                        RayKind::Shadow => vec![u32::from(hit.place != FoundHit::MISS)],
                        _ => vec![hit.place, hit.face_and_steps & 0xffff],
                    };
                    assert_eq!(words, expected, "{kind:?} by {marcher:?}, seed {seed}");
                }
                hits
            };
            let marched = run(Marcher::BrickMap);
            let plain = run(Marcher::PlainDda);
            bench.scattered = true;
            let scattered = bench.hits(&gpu, kind, Marcher::BrickMap).expect("runs");
            bench.scattered = false;
            assert_eq!(mismatches(&scattered, &plain), 0, "{kind:?}, seed {seed}");
            assert_eq!(mismatches(&marched, &plain), 0, "{kind:?}, seed {seed}");
            let hits = marched
                .iter()
                .filter(|hit| hit.place != FoundHit::MISS)
                .count();
            assert!(
                hits > 100,
                "{kind:?}, seed {seed}: only {hits} hits to compare"
            );
            if kind == RayKind::Probe {
                against_the_cpu(&voxels, &probes, &directions, &marched);
            }
        }
        assert!(
            mismatches(
                &[FoundHit {
                    place: 1,
                    face_and_steps: 0
                }],
                &[FoundHit {
                    place: 1,
                    face_and_steps: 1
                }]
            ) == 1
        );
    }
}

/// Compares with the f64 marcher of the reference, which does not mirror rays. Rounding may send a ray
/// to the other side of an edge, so a few may differ.
fn against_the_cpu(voxels: &Voxels, probes: &[UVec3], directions: &[Vec3], found: &[FoundHit]) {
    let extent = voxels.cells() * 8;
    let (mut rays, mut differ) = (0, 0);
    for (index, hit) in found.iter().enumerate() {
        let probe = probes[index / directions.len()];
        let direction = directions[index % directions.len()].as_dvec3();
        // Diagonal rays run along edges, where f32 and f64 may choose differently.
        if direction.abs().max_element() == 1.0 {
            continue;
        }
        let origin = probe.as_dvec3() + DVec3::splat(0.5);
        let expected = match march_plain(voxels, &Ray::new(origin, direction)) {
            Outcome::Hit(hit) => {
                let v = hit.voxel.as_uvec3();
                v.x + extent.x * (v.y + extent.y * v.z)
            }
            Outcome::Miss | Outcome::Inside(_) => FoundHit::MISS,
        };
        rays += 1;
        differ += usize::from(expected != hit.place);
    }
    assert!(
        differ * 2000 <= rays,
        "{differ} of {rays} rays differ from the CPU's"
    );
}
