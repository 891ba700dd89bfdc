//! Edits of the cave on the CPU, including the update of octant distances.

use std::hint::black_box;

use criterion::Criterion;
use glam::{IVec3, UVec3, Vec3};
use grotto::world::voxels::Voxels;

use super::{CAVE, CAVE_VOXELS};

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("edits");
    group.bench_function("set a voxel and take it away", |bencher| {
        let (mut voxels, at) = (CAVE_VOXELS.clone(), centre().as_ivec3());
        bencher.iter(|| {
            voxels.set(black_box(at), 1);
            voxels.set(black_box(at), 0)
        });
    });
    for radius in [4, 16] {
        let name = format!("fill and dig a ball of radius {radius}");
        group.bench_function(name, |bencher| {
            let mut voxels = CAVE_VOXELS.clone();
            bencher.iter(|| {
                voxels.fill_sphere(black_box(centre()), radius as f32, 1);
                voxels.fill_sphere(black_box(centre()), radius as f32, 0)
            });
        });
    }
    for edge in [8, 32] {
        let name = format!("fill and dig a box of {edge}³ voxels");
        group.bench_function(name, |bencher| {
            let mut voxels = CAVE_VOXELS.clone();
            // Not aligned to cells, like most boxes.
            let min = centre().as_ivec3() - edge / 2 + IVec3::new(1, 2, 3);
            bencher.iter(|| {
                voxels.fill_box(black_box(min), min + edge - 1, 1);
                voxels.fill_box(black_box(min), min + edge - 1, 0)
            });
        });
    }
    group.bench_function("distances of 512×256×512 voxels of air", |bencher| {
        bencher.iter(|| Voxels::empty(black_box(UVec3::new(512, 256, 512))));
    });
    group.finish();
}

/// The middle of the cave (grid space).
fn centre() -> Vec3 {
    CAVE.size.as_vec3() / 2.0
}
