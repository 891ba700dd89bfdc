//! Rays through the cave on one core, in rays per second: by whole empty cells as the path tracer marches,
//! and voxel by voxel.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use glam::DVec3;
use grotto::{
    reference::march::{Outcome, Ray, march, march_plain},
    world::voxels::Voxels,
};

use super::{CAVE, CAVE_VOXELS, points};

const RAYS: u64 = 4096;

type March = fn(&Voxels, &Ray) -> Outcome;

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("marching");
    group.throughput(Throughput::Elements(RAYS));
    for (name, march) in [("cells", march as March), ("voxels", march_plain)] {
        group.bench_function(name, |bencher| {
            let (voxels, rays) = (&*CAVE_VOXELS, rays());
            bencher.iter(|| {
                let outcomes = rays.iter().map(|ray| march(voxels, black_box(ray)));
                outcomes
                    .filter(|outcome| matches!(outcome, Outcome::Hit(_)))
                    .count()
            });
        });
    }
    group.finish();
}

/// From points in air to other points of the cave.
fn rays() -> Vec<Ray> {
    let points = points(&CAVE, 8 * RAYS);
    let in_air = |ray: &Ray| CAVE_VOXELS.material(ray.start) == 0;
    let ray = |pair: &[glam::Vec3]| {
        let towards = (pair[1] - pair[0]).normalize_or(glam::Vec3::X);
        Ray::new(pair[0].as_dvec3(), DVec3::from(towards))
    };
    let rays: Vec<Ray> = points
        .windows(2)
        .map(ray)
        .filter(in_air)
        .take(RAYS as usize)
        .collect();
    assert_eq!(rays.len() as u64, RAYS, "an eighth of the cave is air");
    rays
}
