//! The CPU's part of grotto, timed by criterion: `cargo bench`, or `cargo bench -- marching` for one
//! subject. The test suite runs each benchmark once, so that all of them keep working.
//!
//! Worlds are built when the first benchmark needs them, so listing the benchmarks costs nothing.

mod edits;
mod frame;
mod generate;
mod marching;
mod parsing;
mod sdf;
mod sound;

use std::{path::PathBuf, sync::LazyLock, time::Duration};

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use grotto::{
    reference::random::Pcg,
    world::{World, file, generate::generate, voxels::Voxels},
};

/// The mushroom cave: 128×64×128 voxels with noise, rules, features and eight lamps.
static CAVE: LazyLock<World> = LazyLock::new(|| world("cave"));
static CAVE_VOXELS: LazyLock<Voxels> = LazyLock::new(|| generate(&CAVE));

/// The file of a world of the repository.
fn world_file(name: &str) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    root.join("worlds").join(name).with_extension("ron")
}

fn world(name: &str) -> World {
    file::load(&world_file(name), &Default::default()).expect("the repository's worlds are sound")
}

/// The same points in every run, uniform over the grid of a world (voxels).
fn points(world: &World, count: u64) -> Vec<Vec3> {
    let point = |index| {
        let mut random = Pcg::new(1, index, 0);
        let shares = [(); 3].map(|()| random.unit() as f32);
        Vec3::from(shares) * world.size.as_vec3()
    };
    (0..count).map(point).collect()
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(3));
    targets = sdf::all, generate::all, marching::all, edits::all, frame::all, parsing::all, sound::all
}
criterion_main!(benches);
