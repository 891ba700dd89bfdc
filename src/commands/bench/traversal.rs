//! `grotto bench traversal`: camera, shadow and probe rays through a world by the brick map and by
//! plain DDA, in one run, compared hit for hit.

use glam::{UVec3, Vec3};
use serde::Serialize;

use crate::{
    gpu::{Gpu, GpuError},
    measure::statistics,
    passes::{
        GpuVoxels, View, ViewMode,
        ray_bench::{FoundHit, Marcher, RayBench, RayKind, RaySet, ShadowTarget},
    },
    probes::sampling,
    world::{Camera, World, voxels::Voxels},
};

/// Edge of the lattice whose air voxels send probe rays, in voxels.
const LATTICE: u32 = 16;
/// Probe rays per run, about as many as a 1080p picture has pixels.
const PROBE_RAYS: u32 = 1 << 21;
/// Runs of each kind that are thrown away, and that the median is taken of.
const WARM_UP: u32 = 3;

/// One kind of rays from one place.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub world: String,
    /// The camera whose rays (or whose hits' shadow rays) these are; `lattice` for probe rays.
    pub camera: String,
    /// `camera`, `shadow` or `probe`.
    pub rays: &'static str,
    /// What shadow rays are sent to: the `sun`, the nearest `lamp`, or the sky `above`.
    pub light: Option<&'static str>,
    pub count: u32,
    pub ms: f64,
    pub grays_per_s: f64,
    pub steps_per_ray: f64,
    pub plain_ms: f64,
    pub plain_grays_per_s: f64,
    pub plain_steps_per_ray: f64,
    pub speedup: f64,
    /// Rays whose hit differs from plain DDA's.
    pub mismatches: usize,
}

/// Measures every named camera of the world and the lattice.
///
/// `voxels` is the CPU's copy of what `on_gpu` holds. `repeats` runs give each median.
///
/// # Errors
/// [`GpuError`] when the world's bit grid is too large for the adapter, or the device is lost.
pub fn measure(
    gpu: &Gpu,
    world: &World,
    voxels: &Voxels,
    on_gpu: &GpuVoxels,
    size: [u32; 2],
    repeats: u32,
) -> Result<Vec<Row>, GpuError> {
    let probes = air_lattice(voxels);
    let per_probe = (PROBE_RAYS / probes.len().max(1) as u32).clamp(16, 4096);
    let directions: Vec<Vec3> = (0..per_probe)
        .map(|ray| sampling::fibonacci(ray, per_probe).as_vec3())
        .collect();
    let mut rows = Vec::new();
    let lights = world
        .cameras
        .iter()
        .enumerate()
        .flat_map(|(index, camera)| {
            let lights = shadow_targets(world, camera).into_iter().enumerate();
            lights.map(move |(light, (name, target))| (index, camera, light, name, target))
        });
    for (index, camera, light, name, shadow) in lights {
        let view = gpu.uniform_buffer("view", &still(camera, size).to_gpu());
        let bench = RayBench::new(
            gpu,
            on_gpu,
            &RaySet {
                view: &view,
                size,
                shadow,
                probes: &probes,
                directions: &directions,
            },
        )?;
        // Shadow rays start where this bench's own camera rays ended.
        bench.run(gpu, RayKind::Camera, Marcher::BrickMap, 1)?;
        let mut kinds = vec![(RayKind::Shadow, "shadow", camera.name.as_str())];
        if light == 0 {
            kinds.insert(0, (RayKind::Camera, "camera", camera.name.as_str()));
        }
        if light == 0 && index == 0 && !probes.is_empty() {
            kinds.push((RayKind::Probe, "probe", "lattice"));
        }
        for (kind, rays, place) in kinds {
            let marched = bench.run(gpu, kind, Marcher::BrickMap, WARM_UP + repeats)?;
            let plain = bench.run(gpu, kind, Marcher::PlainDda, WARM_UP + repeats)?;
            let count = bench.rays(kind);
            // Rays that face away from the light are not marched by either.
            let marched_rays = plain.found.iter().filter(|hit| hit.steps() > 0).count();
            let median = |times: &[f64]| {
                statistics::median(times.get(WARM_UP as usize..).unwrap_or_default())
                    .unwrap_or(f64::NAN)
            };
            let steps = |found: &[FoundHit]| {
                found.iter().map(|hit| f64::from(hit.steps())).sum::<f64>()
                    / marched_rays.max(1) as f64
            };
            let grays = |ms: f64| marched_rays as f64 / ms / 1e6;
            let (ms, plain_ms) = (median(&marched.times_ms), median(&plain.times_ms));
            rows.push(Row {
                world: world.name.clone(),
                camera: place.to_owned(),
                rays,
                light: (kind == RayKind::Shadow).then_some(name),
                count: marched_rays as u32,
                ms,
                grays_per_s: grays(ms),
                steps_per_ray: steps(&marched.found),
                plain_ms,
                plain_grays_per_s: grays(plain_ms),
                plain_steps_per_ray: steps(&plain.found),
                speedup: plain_ms / ms,
                mismatches: marched
                    .found
                    .iter()
                    .zip(&plain.found)
                    .take(count as usize)
                    .filter(|(a, b)| !a.same_hit(**b))
                    .count(),
            });
        }
    }
    Ok(rows)
}

/// Rows as a table for people.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<10} {:<12} {:<7} {:>9} {:>9} {:>10} {:>7} {:>11} {:>7} {:>8} {:>10}\n",
        "world",
        "camera",
        "rays",
        "count",
        "ms",
        "Grays/s",
        "steps",
        "DDA Grays/s",
        "steps",
        "speedup",
        "mismatches"
    );
    for row in rows {
        text += &format!(
            "{:<10} {:<12} {:<7} {:>9} {:>9.3} {:>10.2} {:>7.1} {:>11.2} {:>7.1} {:>7.1}x {:>10}\n",
            row.world,
            row.camera,
            row.light.unwrap_or(row.rays),
            row.count,
            row.ms,
            row.grays_per_s,
            row.steps_per_ray,
            row.plain_grays_per_s,
            row.plain_steps_per_ray,
            row.speedup,
            row.mismatches
        );
    }
    text
}

fn still(camera: &Camera, size: [u32; 2]) -> View {
    View {
        camera: camera.clone(),
        size,
        frame: 0,
        seed: 0,
        exposure_ev: 0.0,
        mode: ViewMode::Full,
        time_s: 0.0,
        textures: true,
    }
}

/// The lights that shadow rays are sent to, by name: the sun, if the world has one, and the lamp of
/// the first preset that is nearest to the camera; a point high above in a world with neither.
fn shadow_targets(world: &World, camera: &Camera) -> Vec<(&'static str, ShadowTarget)> {
    let sun = world.sun.map(|sun| ("sun", ShadowTarget::Sun(sun.towards)));
    let distance = |p: &Vec3| p.distance_squared(camera.position);
    let preset = world.lamp_presets.first();
    let lamps = preset.map_or(&[][..], |preset| &preset.lamps);
    let nearest = lamps
        .iter()
        .map(|lamp| lamp.position)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .map(|at_ws| ("lamp", ShadowTarget::Lamp(at_ws - world.origin.as_vec3())));
    let found: Vec<_> = sun.into_iter().chain(nearest).collect();
    if found.is_empty() {
        vec![("above", ShadowTarget::Sun(Vec3::Y))]
    } else {
        found
    }
}

/// Lattice voxels (grid space) that are air.
fn air_lattice(voxels: &Voxels) -> Vec<UVec3> {
    let counts = voxels.size() / LATTICE;
    let start = UVec3::splat(LATTICE / 2);
    (0..counts.element_product())
        .map(|i| {
            let index = UVec3::new(
                i % counts.x,
                i / counts.x % counts.y,
                i / counts.x / counts.y,
            );
            index * LATTICE + start
        })
        .filter(|voxel| voxels.material(voxel.as_ivec3()) == 0)
        .collect()
}
