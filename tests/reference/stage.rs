//! Scenes to test with: a few flat materials, lamps, a camera, and the renderer over them.

use std::sync::atomic::AtomicBool;

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::lights::Lights;
use grotto::measure::picture::Picture;
use grotto::measure::statistics::MeanEstimate;
use grotto::reference::{FilmOptions, Scene, View, render_scene};
use grotto::world::materials::MaterialSet;
use grotto::world::voxels::Voxels;
use grotto::world::{Camera, Colour, Lamp, LampKind, LampPreset, Material, Pattern, Sky, Sun};

/// A world in the small: everything that the path tracer looks at.
pub struct Stage {
    pub voxels: Voxels,
    pub origin: IVec3,
    pub materials: MaterialSet,
    pub lights: Lights,
}

impl Stage {
    /// Voxels of the given materials (albedo, emission), under a black sky.
    pub fn new(size: UVec3, materials: &[(f32, f32)], voxel: impl Fn(IVec3) -> u8 + Sync) -> Self {
        let materials: Vec<Material> = materials
            .iter()
            .map(|&(albedo, emission)| flat(albedo, emission))
            .collect();
        let lights = Lights {
            lamps: Vec::new(),
            sky: uniform_sky(0.0),
        };
        Self {
            voxels: super::voxels_from(size, voxel),
            origin: IVec3::ZERO,
            materials: MaterialSet::bake(&materials, 0),
            lights,
        }
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

    pub fn scene(&self) -> Scene<'_> {
        Scene {
            voxels: &self.voxels,
            origin: self.origin,
            materials: &self.materials,
            lights: &self.lights,
            textures: true,
        }
    }

    pub fn rendered(&self, options: &FilmOptions) -> Picture {
        render_scene(&self.scene(), options, &|_, _| {}, &AtomicBool::new(false))
    }

    /// A square picture of `pixels`² with `samples` through random points of each pixel.
    pub fn picture(&self, camera: &Camera, view: View, pixels: u32, samples: u32) -> Picture {
        let options = FilmOptions {
            size: [pixels; 2],
            samples,
            view,
            antialias: true,
            ..options(camera)
        };
        self.rendered(&options)
    }

    /// Mean over a square picture, from pixels that are independent estimates.
    pub fn mean(&self, camera: &Camera, view: View, pixels: u32, samples: u32) -> MeanEstimate {
        let picture = self.picture(camera, view, pixels, samples);
        assert!(
            picture.rgb.iter().all(|[r, g, b]| r == g && g == b),
            "everything here is grey"
        );
        let values = picture.rgb.iter().map(|rgb| f64::from(rgb[0]));
        MeanEstimate::of(values).expect("a picture with pixels")
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

pub fn flat(albedo: f32, emission: f32) -> Material {
    Material {
        name: format!("albedo {albedo} emission {emission}"),
        a: Colour::Flat(Vec3::splat(albedo)),
        b: Colour::Flat(Vec3::splat(albedo)),
        pattern: Pattern::Plain,
        emission: Vec3::splat(emission),
    }
}

pub fn uniform_sky(radiance: f32) -> Sky {
    let colour = Vec3::splat(radiance);
    Sky {
        zenith: colour,
        horizon: colour,
        ground: colour,
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
        motion: Vec::new(),
    }
}

/// A camera that sees 90° and looks along `yaw` and `pitch`: at distance d from a wall that it
/// faces it sees a square of edge 2d, and every point of it equally often.
pub fn square_camera(position: DVec3, yaw_deg: f32, pitch_deg: f32) -> Camera {
    Camera {
        name: "square".into(),
        position: position.as_vec3(),
        yaw_deg,
        pitch_deg,
        fov_deg: 90.0,
    }
}

/// The six cameras from one point, which together see every direction once.
pub fn all_around(position: DVec3) -> [Camera; 6] {
    [
        (0.0, 0.0),
        (90.0, 0.0),
        (180.0, 0.0),
        (270.0, 0.0),
        (0.0, 90.0),
        (0.0, -90.0),
    ]
    .map(|(yaw, pitch)| square_camera(position, yaw, pitch))
}
