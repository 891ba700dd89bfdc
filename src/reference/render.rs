//! Whole pictures on the CPU: parallel by rows, progressive, and the same bytes every time.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::bodies::PosedBodies;
use super::path_trace::{CameraHit, TracedWorld, Vertex};
use super::random::Pcg;
use crate::lights::Lights;
use crate::measure::picture::Picture;
use crate::world::materials::MaterialSet;
use crate::world::voxels::Voxels;
use crate::world::{Camera, CameraBasis, LampPreset, View, World};

/// How to render a picture of a world.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions<'a> {
    pub lamps: &'a LampPreset,
    /// World time (seconds), which says where bodies are.
    pub time_s: f64,
    /// The same for lamps that move: they may be stopped.
    pub lamp_time_s: f64,
    /// Whether textures are visible; otherwise every texture is its mean.
    pub textures: bool,
    pub film: FilmOptions<'a>,
}

/// How to take a picture of a scene.
#[derive(Clone, Copy, Debug)]
pub struct FilmOptions<'a> {
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples (paths) per pixel, at least 1. The error falls with the square root of their number.
    pub samples: u32,
    pub seed: u64,
    /// A traceable one. All values are linear. Normals are stored as (normal + 1) / 2, and depth as the distance
    /// along the ray in voxels. Views of data are black where there is no surface.
    pub view: View,
    /// Spreads the samples over the pixel. If off, all samples go through its centre, as in the
    /// renderer on the GPU.
    pub antialias: bool,
    /// Surfaces after the first one whose light is gathered; `u32::MAX` for no limit.
    pub max_bounces: u32,
}

/// Most samples of a row between two checks of the cancel flag.
const SAMPLES_AT_ONCE: u32 = 8;

/// Path-traces a picture on the CPU: linear Rec. 709, top row first.
///
/// The picture depends only on the arguments, not on the number of threads. `progress` receives
/// (samples done, samples in total), counted over all pixels, from any thread. Once `cancel` is set the
/// rest is left out: every row then holds the mean of its own samples so far, or is black.
pub fn render(
    world: &World,
    voxels: &Voxels,
    options: &RenderOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
    cancel: &AtomicBool,
) -> Picture {
    let materials = MaterialSet::bake(&world.materials, world.seed);
    let lights = Lights::at(world, options.lamps, options.lamp_time_s);
    let poses = world.bodies.poses(options.time_s);
    let bodies = PosedBodies::new(&world.bodies, world.origin, &poses);
    let scene = TracedWorld {
        voxels,
        bodies: &bodies,
        origin: world.origin,
        materials: &materials,
        lights: &lights,
        textures: options.textures,
    };
    render_scene(&scene, &options.film, progress, cancel)
}

/// Like [`render`], for a scene whose materials and lights are ready.
pub fn render_scene(
    scene: &TracedWorld,
    options: &FilmOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
    cancel: &AtomicBool,
) -> Picture {
    assert!(
        options.view.is_traceable(),
        "path tracing has no view {:?}",
        options.view
    );
    let [width, height] = options.size;
    let mut picture = Picture::new(width, height);
    if picture.rgb.is_empty() {
        return picture;
    }
    let film = Film::new(scene, options);
    let mut rows: Vec<Row> = (0..height).map(|y| Row::new(y, width)).collect();
    let total = u64::from(width) * u64::from(height) * u64::from(film.samples);
    let done = AtomicU64::new(0);
    // Every row gets its next samples before any row gets more.
    for first in (0..film.samples).step_by(SAMPLES_AT_ONCE as usize) {
        let samples = first..film.samples.min(first + SAMPLES_AT_ONCE);
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        rows.par_iter_mut().for_each(|row| {
            if cancel.load(Ordering::Relaxed) {
                return;
            }
            row.add(&film, samples.clone());
            let now = u64::from(width) * samples.len() as u64;
            progress(done.fetch_add(now, Ordering::Relaxed) + now, total);
        });
    }
    for (out, row) in picture.rgb.chunks_mut(width as usize).zip(&rows) {
        let scale = 1.0 / f64::from(row.samples.max(1));
        for (rgb, sum) in out.iter_mut().zip(&row.sums) {
            *rgb = (*sum * scale).as_vec3().to_array();
        }
    }
    picture
}

/// Sums of the samples of one row of pixels.
struct Row {
    y: u32,
    sums: Vec<DVec3>,
    samples: u32,
}

impl Row {
    fn new(y: u32, width: u32) -> Self {
        Self {
            y,
            sums: vec![DVec3::ZERO; width as usize],
            samples: 0,
        }
    }

    fn add(&mut self, film: &Film, samples: Range<u32>) {
        for (x, sum) in (0..).zip(&mut self.sums) {
            film.add_samples([x, self.y], samples.clone(), sum);
        }
        self.samples += samples.len() as u32;
    }
}

/// Turns pixels into samples of the scene that the camera sees.
struct Film<'a> {
    scene: TracedWorld<'a>,
    options: &'a FilmOptions<'a>,
    camera: CameraBasis,
    /// Number of samples per pixel that matter for this view.
    samples: u32,
    /// Angle of a pixel (radians) over which textures are averaged; 0 if the samples average them.
    pixel_angle: f64,
}

/// What a camera ray sees: the part that is not random, and the start of the random part.
struct Look {
    sure: DVec3,
    surface: Option<Vertex>,
}

impl<'a> Film<'a> {
    fn new(scene: &TracedWorld<'a>, options: &'a FilmOptions<'a>) -> Self {
        let [width, height] = options.size.map(f64::from);
        let camera = options.camera.basis(width / height);
        let random = options.antialias || options.view.is_random(scene.lights.has_spheres());
        Self {
            scene: TracedWorld {
                textures: scene.textures && options.view != View::TexturesOff,
                ..*scene
            },
            options,
            camera,
            samples: if random { options.samples.max(1) } else { 1 },
            pixel_angle: if options.antialias {
                0.0
            } else {
                2.0 * camera.up.length() / height
            },
        }
    }

    /// Adds these samples of a pixel to `sum` one by one, so that their grouping does not matter.
    fn add_samples(&self, [x, y]: [u32; 2], samples: Range<u32>, sum: &mut DVec3) {
        let corner = DVec2::new(f64::from(x), f64::from(y));
        let index = u64::from(y) << 32 | u64::from(x);
        // Without antialiasing all samples share their camera ray and the lamps that light its end.
        let centre = (!self.options.antialias).then(|| self.look(corner + 0.5));
        for sample in samples {
            let mut random = Pcg::new(self.options.seed, index, u64::from(sample));
            let look = match &centre {
                Some(look) => look,
                None => &self.look(corner + DVec2::new(random.unit(), random.unit())),
            };
            *sum += look.sure + self.sampled(look, &mut random);
        }
    }

    fn look(&self, pixel: DVec2) -> Look {
        let size = DVec2::from(self.options.size.map(f64::from));
        let direction = self.camera.direction_ws(pixel, size).normalize();
        let hit = self
            .scene
            .look(self.camera.origin, direction, self.pixel_angle);
        match hit {
            CameraHit::Sky(radiance) | CameraHit::Solid(radiance) => Look {
                sure: match self.options.view {
                    View::Full | View::TexturesOff | View::Direct => radiance,
                    _ => DVec3::ZERO,
                },
                surface: None,
            },
            CameraHit::Surface(vertex) => Look {
                sure: match self.options.view {
                    View::Full | View::TexturesOff | View::Direct => {
                        vertex.emission + self.scene.lamps_reflected(&vertex)
                    }
                    View::Indirect | View::Irradiance => DVec3::ZERO,
                    View::Albedo => vertex.albedo,
                    View::Normal => (vertex.normal() + 1.0) / 2.0,
                    View::Depth => DVec3::splat(vertex.distance),
                    View::Steps | View::Cage | View::States | View::Occlusion => {
                        unreachable!("only traceable views are rendered")
                    }
                },
                surface: Some(vertex),
            },
        }
    }

    /// One sample of the light that is random.
    fn sampled(&self, look: &Look, random: &mut Pcg) -> DVec3 {
        let Some(vertex) = &look.surface else {
            return DVec3::ZERO;
        };
        let view = self.options.view;
        let direct = match view {
            View::Full | View::TexturesOff | View::Direct => {
                self.scene.spheres_reflected(vertex, random)
            }
            _ => DVec3::ZERO,
        };
        if !view.shows_bounces() {
            return direct;
        }
        let reflectance = match view {
            View::Irradiance => DVec3::ONE,
            _ => vertex.albedo,
        };
        let max_bounces = self.options.max_bounces;
        direct + reflectance * self.scene.bounced(vertex, max_bounces, random)
    }
}
