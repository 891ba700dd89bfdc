//! The picture that DDGI is judged by: path-traced, or from the cache.

use std::sync::atomic::AtomicBool;

use super::{
    super::{Failure, options::RunOptions, output},
    cache::{Cache, Found, Key, Truth, fnv1a},
};
use crate::{
    lights::Lights,
    measure::picture::Picture,
    reference::{self, FilmOptions, View},
    world::{Camera, World, generate, materials::MaterialSet, voxels::Voxels},
};

/// What a reference shows, and how well.
pub struct Film<'a> {
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Paths per pixel.
    pub spp: u32,
    pub seed: u32,
    /// Whether textures are seen; else every texture is its mean.
    pub textures: bool,
}

/// The path tracer of one world, and the references that are kept of it.
pub struct Tracer<'a> {
    world: &'a World,
    lights: &'a Lights,
    run: &'a RunOptions,
    cache: &'a Cache,
    /// Made when the first reference is traced.
    voxels: Option<Voxels>,
}

/// The sources of the tracer: references are good for as long as it stays the same.
const SOURCES: [&str; 5] = [
    include_str!("../../reference/march.rs"),
    include_str!("../../reference/path_trace.rs"),
    include_str!("../../reference/random.rs"),
    include_str!("../../reference/render.rs"),
    include_str!("../../lights/lamp.rs"),
];

impl<'a> Tracer<'a> {
    pub fn new(
        world: &'a World,
        lights: &'a Lights,
        run: &'a RunOptions,
        cache: &'a Cache,
    ) -> Self {
        Self {
            world,
            lights,
            run,
            cache,
            voxels: None,
        }
    }

    /// The reference, traced if it is not in the cache.
    ///
    /// # Errors
    /// When it cannot be traced. A cache that fails is no failure.
    pub fn truth(&mut self, film: &Film<'_>) -> Result<Truth, Failure> {
        let key = self.key(film);
        match self.cache.load(&key) {
            Found::Truth(truth) => return Ok(*truth),
            Found::Nothing => {}
            Found::Unusable(reason) => {
                output::note(self.run, &format!("{reason}; the reference is traced anew"));
            }
        }
        let truth = Truth {
            direct: self.trace(film, View::Direct)?,
            indirect: self.trace(film, View::Indirect)?,
        };
        if let Err(reason) = self.cache.store(&key, &truth) {
            output::note(self.run, &format!("{reason}; the reference is not kept"));
        }
        Ok(truth)
    }

    fn key(&self, film: &Film<'_>) -> Key {
        // Who looks and where probes stand change nothing about the world.
        let mut world = self.world.clone();
        world.name.clear();
        world.title.clear();
        world.cameras.clear();
        world.layouts.clear();
        world.lamp_presets.clear();
        let Film {
            camera,
            size,
            spp,
            seed,
            textures,
        } = film;
        let basis = camera.basis(f64::from(size[0]) / f64::from(size[1]));
        Key {
            content: format!(
                "cpu {world:?} {:?} {basis:?} {size:?} {spp} {seed} {textures}",
                self.lights
            ),
            version: format!(
                "{} {:032x}",
                env!("CARGO_PKG_VERSION"),
                fnv1a(SOURCES.concat().as_bytes())
            ),
            size: *size,
        }
    }

    fn trace(&mut self, film: &Film<'_>, view: View) -> Result<Picture, Failure> {
        let world = self.world;
        let voxels = self.voxels.get_or_insert_with(|| generate::generate(world));
        let materials = MaterialSet::bake(&world.materials, world.seed);
        let scene = reference::Scene {
            voxels,
            origin: world.origin,
            materials: &materials,
            lights: self.lights,
            textures: film.textures,
        };
        let options = FilmOptions {
            camera: film.camera,
            size: film.size,
            samples: film.spp,
            seed: u64::from(film.seed),
            view,
            antialias: false,
            max_bounces: u32::MAX,
        };
        let bar = output::progress(self.run, "samples of the reference", 1);
        let progress = |done, total| {
            bar.set_length(total);
            bar.set_position(done);
        };
        let never = AtomicBool::new(false);
        let picture = reference::render_scene(&scene, &options, &progress, &never);
        bar.finish_and_clear();
        Ok(picture)
    }
}
