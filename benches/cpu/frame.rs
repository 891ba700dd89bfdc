//! What a frame costs the CPU until it is submitted: lights, uniforms and commands. The GPU's work is waited
//! for but not counted; `grotto bench` measures it. Without an adapter this benchmark is skipped.

use std::time::{Duration, Instant};

use criterion::Criterion;
use grotto::{
    frame::{Frame, Stage},
    gpu::{self, Gpu, Recorder, ShaderChecks},
    lights::Lights,
    parameters::Parameters,
    passes::view::Shot,
    world::{View, World},
};

use super::world;

/// Width and height in pixels: few, because a software adapter has to draw them too.
const SIZE: [u32; 2] = [16, 16];
/// Seconds of world time from frame to frame.
const STEP_S: f64 = 1.0 / 60.0;

pub fn all(criterion: &mut Criterion) {
    if !gpu::adapters().iter().any(|adapter| adapter.usable) {
        eprintln!("frame: no usable adapter on this machine; skipped");
        return;
    }
    let mut group = criterion.benchmark_group("frame");
    group.sample_size(20);
    let mut recording = None;
    group.bench_function("record", |bencher| {
        let recording = recording.get_or_insert_with(Recording::new);
        bencher.iter_custom(|frames| (0..frames).map(|_| recording.frame()).sum());
    });
    group.finish();
}

/// A world on the GPU whose lamp moves from frame to frame.
struct Recording {
    gpu: Gpu,
    world: World,
    parameters: Parameters,
    frame: Frame,
    time_s: f64,
}

impl Recording {
    fn new() -> Self {
        let gpu = Gpu::open(None, ShaderChecks::default()).expect("an adapter is usable");
        let world = world("bleed");
        let mut parameters = Parameters::default();
        parameters.probes.rays = 8;
        let stage = Stage::build(&gpu, &world).expect("it fits");
        let frame = Frame::new(&gpu, stage, &world.layouts[0], &parameters.probes, SIZE);
        Self {
            frame: frame.expect("it fits"),
            time_s: 0.0,
            gpu,
            world,
            parameters,
        }
    }

    /// Records and submits the next frame, and waits for it; returns the time up to the submission.
    fn frame(&mut self) -> Duration {
        self.time_s += STEP_S;
        let start = Instant::now();
        let shot = Shot {
            camera: self.world.cameras[0].clone(),
            size: SIZE,
            frame: self.frame.frames(),
            seed: 0,
            exposure_ev: 0.0,
            view: View::Full,
            time_s: self.time_s,
            textures: true,
            soft_rays: 4,
            shadows: Default::default(),
        };
        let lights = Lights::at(&self.world, &self.world.lamp_presets[0], self.time_s);
        let mut recorder = Recorder::new(&self.gpu, None);
        let probes = &self.parameters.probes;
        self.frame
            .record(&self.gpu, &mut recorder, &shot, &lights, probes);
        let recorded = start.elapsed();
        recorder.submit(&self.gpu).expect("the device works");
        self.gpu.wait().expect("the device works");
        recorded
    }
}
