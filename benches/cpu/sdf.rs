//! Evaluation of a world's SDF tree, in points per second.

use std::{hint::black_box, sync::LazyLock};

use criterion::{Criterion, Throughput};
use glam::DVec3;
use grotto::world::{World, sdf::Shape};

use super::{CAVE, points, world};

const POINTS: u64 = 4096;

static CORNELL: LazyLock<World> = LazyLock::new(|| world("cornell"));

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sdf");
    group.throughput(Throughput::Elements(POINTS));
    // Noise, warps and scatters · a few boxes.
    for (name, world) in [("cave", &CAVE), ("cornell", &CORNELL)] {
        group.bench_function(name, |bencher| {
            let shape = Shape::new(&world.shape, &world.noises);
            let origin = world.origin.as_dvec3();
            let points: Vec<DVec3> = points(world, POINTS)
                .iter()
                .map(|point| point.as_dvec3() + origin)
                .collect();
            bencher.iter(|| {
                points
                    .iter()
                    .map(|&p| shape.eval(black_box(p)))
                    .sum::<f64>()
            });
        });
    }
    group.finish();
}
