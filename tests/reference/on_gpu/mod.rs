//! The path tracer on the GPU: against closed forms, against the CPU's, and against itself.

mod against_the_cpu;
mod convergence;
mod scenes;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use grotto::commands::reference::{TraceRequest, Traced, trace};
use grotto::frame;
use grotto::gpu::{Gpu, ShaderChecks};
use grotto::measure::picture::Picture;
use grotto::reference::FilmOptions;
use grotto::world::World;
use grotto::world::file::{self, Overrides};

use super::closed_forms::FORMS;
use super::stage::{Stage, Tracer};

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
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        Self {
            gpu: Gpu::open(None, checks).expect("the tests need a Vulkan device"),
            world: file::load(&path, &Overrides::default()).expect("a world of ours"),
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
