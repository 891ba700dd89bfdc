//! The path tracer on the GPU: against closed forms, against the CPU's, and against itself.

mod against_the_cpu;
mod convergence;
mod scenes;

use std::sync::atomic::AtomicBool;

use grotto::frame::{self, TraceRequest, Traced, trace};
use grotto::gpu::{Gpu, ShaderChecks};
use grotto::measure::picture::Picture;
use grotto::reference::FilmOptions;
use grotto::world::World;

use super::closed_forms::FORMS;
use super::stage::{Stage, Tracer};
use crate::support::{gpu_with, shipped};

/// The path tracer of `grotto reference`.
struct OnGpu {
    gpu: Gpu,
    /// Anything that a stage does not replace.
    world: World,
}

impl OnGpu {
    /// Statistics take many samples: they run as users do, without the checks that slow shaders down.
    fn open() -> Self {
        Self::with(ShaderChecks::Unchecked)
    }

    fn with(checks: ShaderChecks) -> Self {
        Self {
            gpu: gpu_with(checks),
            world: shipped("minimal"),
        }
    }

    fn traced(
        &self,
        stage: &Stage,
        film: &FilmOptions,
        progress: &dyn Fn(u64, u64),
        cancel: &AtomicBool,
    ) -> Traced {
        let world = World {
            origin: stage.origin,
            seed: stage.seed,
            materials: stage.list.clone(),
            ..self.world.clone()
        };
        let uploaded = frame::Stage::upload(&self.gpu, &world, &stage.voxels).expect("fits");
        let request = TraceRequest {
            camera: film.camera,
            size: film.size,
            view: film.view,
            spp: film.samples,
            seed: film.seed as u32,
            time_s: 0.0,
            textures: true,
            antialias: film.antialias,
        };
        trace(
            &self.gpu,
            &uploaded,
            &stage.lights,
            &request,
            progress,
            cancel,
        )
        .unwrap_or_else(|failure| panic!("{failure}"))
    }
}

impl Tracer for OnGpu {
    fn rendered(&self, stage: &Stage, options: &FilmOptions) -> Picture {
        let traced = self.traced(stage, options, &|_, _| {}, &AtomicBool::new(false));
        assert_eq!(traced.spp, options.samples);
        traced.picture
    }

    fn rounding(&self) -> f64 {
        1e-4
    }

    fn haste(&self) -> u32 {
        8
    }
}

#[test]
fn closed_forms() {
    let tracer = OnGpu::open();
    for (name, form) in FORMS {
        println!("{name}");
        form(&tracer);
    }
}
