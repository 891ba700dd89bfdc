//! Marching through the brick map, compared hit for hit with a march of one voxel per step.

use glam::{UVec3, Vec3};

use super::{super::test_case::TestCase, voxels};
use crate::{
    commands::Failure,
    gpu::Gpu,
    passes::{
        bench::rays::{Marcher, RayBench, RayKind, RaySet},
        scene::GpuVoxels,
        view::Shot,
    },
    probes::sampling,
    world::voxels::Voxels,
};

/// Number of voxels whose centres send rays, and of directions for each.
const PROBES: usize = 24;
const DIRECTIONS: u32 = 64;

/// Compares the camera's rays, and rays from voxels all over the world.
pub fn against_plain(
    gpu: &Gpu,
    case: &TestCase,
    on_gpu: &GpuVoxels,
    known: &Voxels,
    shot: &Shot,
) -> Result<Result<(), String>, Failure> {
    let mut air: Vec<UVec3> = voxels::all(known.size())
        .filter(|voxel| known.material(*voxel) == 0)
        .map(|voxel| voxel.as_uvec3())
        .collect();
    let every = air.len().div_ceil(PROBES).max(1);
    air = air.into_iter().step_by(every).collect();
    // Without air, rays start in solid voxels, and both marchers must report that alike.
    if air.is_empty() {
        air.push(UVec3::ZERO);
    }
    let directions: Vec<Vec3> = sampling::directions(DIRECTIONS, u64::from(case.world.seed), 0)
        .map(|direction| direction.as_vec3())
        .chain([
            Vec3::X,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::ONE,
            Vec3::new(1.0, -1.0, 0.0),
        ])
        .collect();
    let view_buffer = gpu.uniform_buffer("view", &shot.to_gpu());
    let rays = RaySet {
        view: &view_buffer,
        size: shot.size,
        rays_per_edge: 1,
        probes: &air,
        directions: &directions,
    };
    let bench = RayBench::new(gpu, on_gpu, &rays)?;
    for kind in [RayKind::Camera, RayKind::Probe] {
        let marched = bench.hits(gpu, kind, Marcher::BrickMap)?;
        let plain = bench.hits(gpu, kind, Marcher::PlainDda)?;
        let mut pairs = marched.iter().zip(&plain).enumerate();
        if let Some((ray, (found, wanted))) = pairs.find(|(_, (a, b))| !a.same_hit(**b)) {
            return Ok(Err(format!(
                "{kind:?} ray {ray} of {} hits voxel {} by marching and {} in steps of one voxel",
                marched.len(),
                found.place,
                wanted.place
            )));
        }
    }
    Ok(Ok(()))
}
