//! Voxels of a whole world on all cores, in voxels per second.

use std::{hint::black_box, sync::LazyLock};

use criterion::{Criterion, SamplingMode, Throughput};
use grotto::world::{World, generate::generate};

use super::{CAVE, world};

static MINIMAL: LazyLock<World> = LazyLock::new(|| world("minimal"));

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("generate");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (name, world, voxels) in [
        ("minimal", &MINIMAL, 64 * 32 * 64),
        ("cave", &CAVE, 128 * 64 * 128),
    ] {
        group.throughput(Throughput::Elements(voxels));
        group.bench_function(name, |bencher| {
            let size = world.size.as_u64vec3();
            assert_eq!(size.element_product(), voxels, "the size of `{name}`");
            bencher.iter(|| generate(black_box(world)));
        });
    }
    group.finish();
}
