//! What sound costs: a frame at 60 frames per second with two noises and the rays of the ear, and a second of sound.

use criterion::Criterion;
use grotto::{
    app::sound::{Kind, Noise, Noises, Place, Soundtrack},
    world::{MaterialSound, World, voxels::Voxels},
};

use super::{CAVE, CAVE_VOXELS};

const FRAME_NS: u64 = 16_666_667;

pub fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sound");
    for (name, frame_ns) in [
        ("frame and 1/60 s of samples", FRAME_NS),
        ("second of samples", 1_000_000_000),
    ] {
        group.bench_function(name, |bencher| {
            let (world, voxels) = (&*CAVE, &*CAVE_VOXELS);
            let mut soundtrack = Soundtrack::new();
            let mut now_ns = 0;
            bencher.iter(|| {
                now_ns += frame_ns;
                frame(&mut soundtrack, world, voxels, now_ns)
            });
        });
    }
    group.finish();
}

fn frame(soundtrack: &mut Soundtrack, world: &World, voxels: &Voxels, now_ns: u64) -> usize {
    let mut noises = Noises::default();
    for kind in [Kind::Step, Kind::Dig] {
        noises.make(Noise {
            kind,
            material: MaterialSound::Stone,
            strength: 0.5,
            at_ns: now_ns,
        });
    }
    let sounds: Vec<MaterialSound> = world.materials.iter().map(|known| known.sound).collect();
    let place = Place {
        voxels,
        sounds: &sounds,
        ear: world.cameras[0].position.as_dvec3() - world.origin.as_dvec3(),
        voxels_per_m: 1.0,
    };
    soundtrack.frame(&place, &mut noises, now_ns).len()
}
