//! Test scenes: a few flat materials, lamps, a camera, and the renderer over them.

use std::sync::atomic::AtomicBool;

use glam::{IVec3, UVec3, Vec3};
use grotto::lights::Lights;
use grotto::measure::picture::Picture;
use grotto::measure::statistics::MeanEstimate;
use grotto::reference::{FilmOptions, PosedBodies, TracedWorld, render_scene};
use grotto::world::generate::generate;
use grotto::world::materials::MaterialSet;
use grotto::world::voxels::Voxels;
use grotto::world::{Camera, Lamp, LampKind, LampPreset, Material, Sky, Sun, View};

use crate::support::scenes::voxels_from;
pub use crate::support::scenes::{all_around, flat, square_camera, uniform_sky};
use crate::support::shipped;

/// A small world: everything that the path tracer reads.
pub struct Stage {
    pub voxels: Voxels,
    pub bodies: PosedBodies,
    pub origin: IVec3,
    pub materials: MaterialSet,
    /// What `materials` was baked from, and the seed.
    pub list: Vec<Material>,
    pub seed: u32,
    pub lights: Lights,
}

impl Stage {
    /// Voxels of the given materials (albedo, emission), under a black sky.
    pub fn new(size: UVec3, materials: &[(f32, f32)], voxel: impl Fn(IVec3) -> u8 + Sync) -> Self {
        let list = materials
            .iter()
            .map(|&(albedo, emission)| flat(albedo, emission))
            .collect();
        Self::of(size, list, voxel)
    }

    /// As [`Self::new`], with any materials.
    pub fn of(size: UVec3, list: Vec<Material>, voxel: impl Fn(IVec3) -> u8 + Sync) -> Self {
        let lights = Lights {
            lamps: Vec::new(),
            sky: uniform_sky(0.0),
        };
        Self {
            voxels: voxels_from(size, voxel),
            bodies: PosedBodies::default(),
            origin: IVec3::ZERO,
            materials: MaterialSet::bake(&list, 0),
            list,
            seed: 0,
            lights,
        }
    }

    /// A world that comes with grotto, under its first lamps.
    pub fn of_world(name: &str) -> (Self, Vec<Camera>) {
        let world = shipped(name);
        let stage = Self {
            voxels: generate(&world),
            bodies: PosedBodies::new(&world.bodies, world.origin, &world.bodies.poses(0.0)),
            origin: world.origin,
            materials: MaterialSet::bake(&world.materials, world.seed),
            seed: world.seed,
            lights: Lights::at(&world, &world.lamp_presets[0], 0.0),
            list: world.materials,
        };
        (stage, world.cameras)
    }

    /// A closed box of air, `inner` voxels wide, in walls of material 1.
    pub fn closed_box(inner: u32, albedo: f32, emission: f32) -> Self {
        let last = inner as i32 + 1;
        Self::new(UVec3::splat(inner + 2), &[(albedo, emission)], |voxel| {
            let wall = voxel.cmpeq(IVec3::ZERO) | voxel.cmpeq(IVec3::splat(last));
            u8::from(wall.any())
        })
    }

    pub fn lit_by(mut self, lamps: &[Lamp], sun: Option<Sun>) -> Self {
        let lamps = lamps.to_vec();
        let preset = LampPreset {
            name: "test".into(),
            lamps,
        };
        self.lights.lamps = grotto::lights::evaluate(&preset, 0.0, 0);
        let sun = sun.as_ref().map(grotto::lights::LampState::from_sun);
        self.lights.lamps.extend(sun);
        self
    }

    pub fn under(mut self, sky: Sky) -> Self {
        self.lights.sky = sky;
        self
    }

    pub fn scene(&self) -> TracedWorld<'_> {
        TracedWorld {
            voxels: &self.voxels,
            bodies: &self.bodies,
            origin: self.origin,
            materials: &self.materials,
            lights: &self.lights,
            textures: true,
        }
    }

    pub fn rendered(&self, options: &FilmOptions) -> Picture {
        render_scene(&self.scene(), options, &|_, _| {}, &AtomicBool::new(false))
    }
}

/// Renders the pictures: every closed form is tested with the path tracers of the CPU and the GPU.
pub trait Tracer {
    fn rendered(&self, stage: &Stage, options: &FilmOptions) -> Picture;

    /// Largest relative error of results without randomness.
    fn rounding(&self) -> f64;

    /// Divides the number of samples: a software adapter is slow.
    fn haste(&self) -> u32 {
        1
    }

    /// A square picture of `pixels`² with `samples` through random points of each pixel.
    fn picture(
        &self,
        stage: &Stage,
        camera: &Camera,
        view: View,
        pixels: u32,
        samples: u32,
    ) -> Picture {
        let options = FilmOptions {
            size: [pixels; 2],
            samples: samples.div_ceil(self.haste()),
            view,
            antialias: true,
            ..options(camera)
        };
        self.rendered(stage, &options)
    }

    /// Mean over a square picture, from pixels that are independent estimates.
    fn mean(
        &self,
        stage: &Stage,
        camera: &Camera,
        view: View,
        pixels: u32,
        samples: u32,
    ) -> MeanEstimate {
        let picture = self.picture(stage, camera, view, pixels, samples);
        assert!(
            picture.rgb.iter().all(|[r, g, b]| r == g && g == b),
            "everything here is grey"
        );
        let values = picture.rgb.iter().map(|rgb| f64::from(rgb[0]));
        MeanEstimate::of(values).expect("a picture with pixels")
    }
}

/// The path tracer of `grotto::reference`.
pub struct Cpu;

impl Tracer for Cpu {
    fn rendered(&self, stage: &Stage, options: &FilmOptions) -> Picture {
        stage.rendered(options)
    }

    fn rounding(&self) -> f64 {
        1e-5
    }
}

/// A small full picture through pixel centres.
pub fn options(camera: &Camera) -> FilmOptions<'_> {
    FilmOptions {
        camera,
        size: [16, 16],
        samples: 4,
        seed: 1,
        view: View::Full,
        antialias: false,
        max_bounces: u32::MAX,
    }
}

/// A white point lamp of this power (W).
pub fn point_lamp(position: Vec3, power: f32) -> Lamp {
    Lamp {
        name: "lamp".into(),
        kind: LampKind::Point,
        position,
        colour: Vec3::ONE,
        power,
        radius: 0.01,
        soft_radius: 0.0,
        motion: Vec::new(),
    }
}
