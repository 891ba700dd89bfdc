//! The voxels that the GPU builds, against the CPU's reference and against the invariants of the brick map.

use glam::{IVec3, UVec3};

use super::super::test_case::TestCase;
use crate::{
    gpu::Gpu,
    passes::scene::GpuVoxels,
    world::{
        generate::{differing, generate},
        voxels::{ALL_FARTHEST, SOLID, Voxels},
    },
};

/// Distance from a voxel's centre (voxels) within which rounding (f32 against f64) may put the surface on
/// either side.
const TOLERANCE: f64 = 1e-3;
/// Largest share of voxels that may be so near to a boundary. In small worlds of round numbers whole planes of
/// voxel centres lie on a boundary, where either answer is right.
const MOST_SHARE: f64 = 0.05;

/// The GPU's voxels against those of `world::generate`.
pub fn against_the_cpu(case: &TestCase, found: &Voxels) -> Result<(), String> {
    let world = &case.world;
    let count = differing(world, found, &generate(world), TOLERANCE)?;
    let all = f64::from(world.size.element_product());
    if count as f64 > (MOST_SHARE * all).max(8.0) {
        return Err(format!(
            "{count} of {all} voxels differ, each within rounding of a boundary"
        ));
    }
    Ok(())
}

/// Compares the GPU's voxels with the copy that received the same edits.
pub fn against_the_copy(found: &Voxels, copy: &Voxels) -> Result<(), String> {
    let size = found.size();
    for index in 0..size.element_product() {
        let at = UVec3::new(
            index % size.x,
            index / size.x % size.y,
            index / size.x / size.y,
        );
        let (a, b) = (found.material(at.as_ivec3()), copy.material(at.as_ivec3()));
        if a != b {
            return Err(format!(
                "after the edits voxel {at} is {a} on the GPU and {b} on the CPU"
            ));
        }
    }
    Ok(())
}

/// Plants a distance that reaches into a solid voxel: in the first empty cell beside a solid one.
pub fn overstate(gpu: &Gpu, on_gpu: &GpuVoxels, voxels: &Voxels) {
    let (grid, ..) = voxels.raw();
    let near = grid
        .iter()
        .position(|word| word & SOLID == 0 && word & ALL_FARTHEST != ALL_FARTHEST);
    if let Some(index) = near {
        gpu.queue.write_buffer(
            &on_gpu.grid,
            index as u64 * 4,
            &(grid[index] | ALL_FARTHEST).to_le_bytes(),
        );
    }
}

/// Every voxel of a box of this size.
pub fn all(size: UVec3) -> impl Iterator<Item = IVec3> {
    let size = size.as_ivec3();
    (0..size.z).flat_map(move |z| {
        (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z)))
    })
}
