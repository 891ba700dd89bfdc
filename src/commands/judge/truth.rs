//! The picture that DDGI is judged against: path-traced, or from the cache.

use std::{
    borrow::Cow,
    sync::atomic::{AtomicBool, Ordering},
};

use clap::ValueEnum;

use super::{
    super::{
        Failure,
        dynamics::Stroke,
        options::RunOptions,
        output,
        reference::{content, sources},
    },
    cache::{Cache, Found, Key, Traced, Truth, fnv1a},
};
use crate::{
    frame::{Stage, TraceRequest, trace},
    gpu::Gpu,
    lights::Lights,
    measure::picture::Picture,
    reference::{self, FilmOptions, PosedBodies},
    world::{Camera, View, World, generate, materials::MaterialSet, voxels::Voxels},
};

/// The tracer of the references.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Against {
    /// The path tracer on the GPU, as in `grotto reference`
    Reference,
    /// The path tracer on the CPU, in f64, over the CPU's voxels: slow, and independent of all shaders
    Cpu,
}

/// Content and quality of a reference.
#[derive(Clone, Copy)]
pub struct Film<'a> {
    pub camera: &'a Camera,
    pub lights: &'a Lights,
    /// World time (seconds), which says where bodies are.
    pub time_s: f64,
    /// Edits of the world, which the stage has too.
    pub edits: &'a [Stroke],
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Paths per pixel.
    pub spp: u32,
    pub seed: u32,
    /// Whether textures are visible; else every texture is replaced by its mean.
    pub textures: bool,
    /// Whether samples are spread over their pixels; else all go through the pixels' centres.
    pub antialias: bool,
}

/// The path tracer of one world, and the cache of its references.
pub struct Tracer<'a> {
    pub world: &'a World,
    pub run: &'a RunOptions,
    pub cache: &'a Cache,
    pub gpu: &'a Gpu,
    pub against: Against,
    /// Stops the tracing when set.
    pub stop: &'a AtomicBool,
    /// Voxels for the CPU's tracer; built when the first reference is traced.
    pub voxels: Option<Voxels>,
}

/// The sources of the CPU tracer: stored references are valid as long as these files are unchanged.
const CPU_SOURCES: [&str; 6] = [
    include_str!("../../reference/bodies.rs"),
    include_str!("../../reference/march.rs"),
    include_str!("../../reference/path_trace.rs"),
    include_str!("../../reference/random.rs"),
    include_str!("../../reference/render.rs"),
    include_str!("../../lights/lamp.rs"),
];
impl<'a> Tracer<'a> {
    /// The reference, traced if it is not in the cache. `stage` is the world on the adapter.
    ///
    /// # Errors
    /// When it cannot be traced, and when the user stops the run: then nothing is stored. Failures of the cache
    /// are only reported.
    pub fn truth(&mut self, film: &Film<'_>, stage: &Stage) -> Result<Truth, Failure> {
        let key = self.key(film)?;
        match self.cache.load(&key) {
            Found::Truth(truth) => return Ok(*truth),
            Found::Nothing => {}
            Found::Unusable(reason) => {
                output::note(
                    self.run,
                    &format!("{reason}; the reference is traced again"),
                );
            }
        }
        let truth = self.traced_in_halves(film, stage)?;
        if let Err(reason) = self.cache.store(&key, &truth) {
            output::note(self.run, &format!("{reason}; the reference is not stored"));
        }
        Ok(truth)
    }

    /// Two halves of the paths, each with random numbers of its own, and their mean.
    fn traced_in_halves(&mut self, film: &Film<'_>, stage: &Stage) -> Result<Truth, Failure> {
        let paths = [film.spp.div_ceil(2), film.spp / 2];
        let half = |spp, seed| Film { spp, seed, ..*film };
        let first = self.both_views(&half(paths[0], film.seed), stage)?;
        if paths[1] == 0 {
            return Ok(Truth {
                whole: first,
                half: None,
            });
        }
        let second = self.both_views(&half(paths[1], !film.seed), stage)?;
        let share = f64::from(paths[0]) / f64::from(film.spp);
        Ok(Truth {
            whole: Traced::mean(&first, &second, share as f32),
            half: Some(first),
        })
    }

    fn both_views(&mut self, film: &Film<'_>, stage: &Stage) -> Result<Traced, Failure> {
        Ok(Traced {
            direct: self.trace(film, View::Direct, stage)?,
            indirect: self.trace(film, View::Indirect, stage)?,
        })
    }

    fn key(&self, film: &Film<'_>) -> Result<Key, Failure> {
        let Film {
            camera,
            lights,
            time_s,
            edits,
            size,
            spp,
            seed,
            textures,
            antialias,
        } = film;
        let basis = camera.basis(f64::from(size[0]) / f64::from(size[1]));
        let tracer = match self.against {
            Against::Reference => &self.gpu.summary.name,
            Against::Cpu => "CPU",
        };
        let edits = match edits {
            [] => String::new(),
            edits => format!(" {edits:?}"),
        };
        let antialiased = if *antialias { " anti-aliased" } else { "" };
        Ok(Key {
            content: format!(
                "{tracer} {} {basis:?} {size:?} {spp} {seed} {textures}{edits}{antialiased}",
                content(self.world, lights, *time_s)
            ),
            version: self.version()?,
            size: *size,
        })
    }

    fn version(&self) -> Result<String, Failure> {
        let sources = match self.against {
            Against::Cpu => CPU_SOURCES.concat(),
            Against::Reference => sources(self.gpu.shaders())?,
        };
        Ok(format!(
            "{} {:032x}",
            env!("CARGO_PKG_VERSION"),
            fnv1a(sources.as_bytes())
        ))
    }

    fn trace(&mut self, film: &Film<'_>, view: View, stage: &Stage) -> Result<Picture, Failure> {
        let bar = output::progress(self.run, "samples of the reference", 1);
        let progress = |done, total| {
            bar.set_length(total);
            bar.set_position(done);
        };
        let picture = match self.against {
            Against::Cpu => self.on_the_cpu(film, view, &progress, self.stop),
            Against::Reference => {
                let request = TraceRequest {
                    camera: film.camera,
                    size: film.size,
                    view,
                    spp: film.spp,
                    seed: film.seed,
                    time_s: film.time_s,
                    textures: film.textures,
                    antialias: film.antialias,
                };
                let gpu = self.gpu;
                let stop = self.stop;
                trace(gpu, stage, film.lights, &request, &progress, stop)?.picture
            }
        };
        bar.finish_and_clear();
        if self.stop.load(Ordering::Relaxed) {
            return Err(Failure::interrupted("stopped"));
        }
        Ok(picture)
    }

    fn on_the_cpu(
        &mut self,
        film: &Film<'_>,
        view: View,
        progress: &(dyn Fn(u64, u64) + Sync),
        cancel: &AtomicBool,
    ) -> Picture {
        let world = self.world;
        let unedited = self.voxels.get_or_insert_with(|| generate::generate(world));
        let mut voxels = Cow::Borrowed(&*unedited);
        for stroke in film.edits {
            stroke.apply(voxels.to_mut());
        }
        let materials = MaterialSet::bake(&world.materials, world.seed);
        let poses = world.bodies.poses(film.time_s);
        let bodies = PosedBodies::new(&world.bodies, world.origin, &poses);
        let scene = reference::TracedWorld {
            voxels: &voxels,
            bodies: &bodies,
            origin: world.origin,
            materials: &materials,
            lights: film.lights,
            textures: film.textures,
        };
        let options = FilmOptions {
            camera: film.camera,
            size: film.size,
            samples: film.spp,
            seed: u64::from(film.seed),
            view,
            antialias: film.antialias,
            max_bounces: u32::MAX,
        };
        reference::render_scene(&scene, &options, progress, cancel)
    }
}
