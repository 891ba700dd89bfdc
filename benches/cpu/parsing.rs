//! Reading world files from text, up to the world that is ready to be built.

use std::{fs, hint::black_box};

use criterion::{Criterion, Throughput};
use grotto::world::file;

use super::world_file;

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("parsing");
    for name in ["minimal", "cave", "cavern"] {
        let path = world_file(name);
        let text = fs::read_to_string(&path).expect("a world of the repository");
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(name, |bencher| {
            let overrides = Default::default();
            bencher.iter(|| {
                let world = file::parse(black_box(&text), name, path.parent(), &overrides);
                world.expect("a sound world")
            });
        });
    }
    group.finish();
}
