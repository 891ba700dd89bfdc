//! The path tracers of the CPU and the GPU against closed forms and against each other.

mod closed_forms;
mod command;
mod marching;
mod on_gpu;
mod pictures;
mod stage;

use glam::{IVec3, UVec3};
use grotto::world::voxels::{BRICK_VOXELS, CELL, NewCell, Voxels, brick_index};

/// Voxels of `size` with the material that the function gives (grid space; 0 is air).
fn voxels_from(size: UVec3, material: impl Fn(IVec3) -> u8 + Sync) -> Voxels {
    Voxels::from_cells(size, |cell| {
        let mut brick = Box::new([0; BRICK_VOXELS]);
        let edge = 0..CELL;
        for (z, y) in edge.clone().flat_map(|z| edge.clone().map(move |y| (z, y))) {
            for x in edge.clone() {
                let local = UVec3::new(x, y, z);
                let voxel = cell * CELL + local;
                if voxel.cmplt(size).all() {
                    brick[brick_index(local)] = material(voxel.as_ivec3());
                }
            }
        }
        NewCell::Voxels(brick)
    })
}
