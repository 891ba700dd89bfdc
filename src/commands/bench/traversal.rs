//! `grotto bench traversal`: traces camera, shadow and probe rays through a world by the brick map and by plain
//! DDA in one run, and compares them hit for hit.

use glam::{UVec3, Vec3};
use serde::Serialize;

use crate::{
    gpu::{Gpu, GpuError},
    measure::statistics,
    passes::{
        bench::rays::{self, FoundHit, Marcher, RayBench, RayKind, RaySet, ShadowTarget},
        scene::GpuVoxels,
        view::Shot,
    },
    probes::sampling,
    world::{Camera, View, World, voxels::Voxels},
};

/// Spacing of the lattice whose air voxels send probe rays, in voxels.
const LATTICE: u32 = 16;
/// Probe rays per run: about the number of pixels of a 1080p picture.
const PROBE_RAYS: u32 = 1 << 21;
/// Fewest shadow rays of a row, per pixel of the picture.
const SHADOW_RAYS_PER_PIXEL: u64 = 2;
/// Most camera rays along each edge of a pixel.
const MOST_RAYS_PER_EDGE: u32 = 4;

/// One kind of rays from one place.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub world: String,
    /// The camera whose rays (or whose hits' shadow rays) these are; `lattice` for probe rays.
    pub camera: String,
    /// `camera`, `shadow` or `probe`.
    pub rays: &'static str,
    /// Target of shadow rays: the `sun`, the nearest `lamp`, or a point `above`.
    pub light: Option<&'static str>,
    /// Camera rays through each pixel: several for shadow rays, so that a large GPU stays busy.
    pub rays_per_pixel: u32,
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
/// `voxels` is the CPU's copy of `on_gpu`. Each median is taken over `repeats` runs.
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
    for (index, camera) in world.cameras.iter().enumerate() {
        let bench_at = |per_edge: u32| {
            let size = size.map(|edge| edge * per_edge);
            let view = gpu.uniform_buffer("view", &still(camera, size).to_gpu());
            let rays = RaySet {
                view: &view,
                size,
                rays_per_edge: per_edge,
                probes: &probes,
                directions: &directions,
            };
            RayBench::new(gpu, on_gpu, &rays)
        };
        let row = |bench: &RayBench<'_>, kind| measure_row(gpu, bench, kind, repeats);
        let place = |row: Row| Row {
            world: world.name.clone(),
            camera: camera.name.clone(),
            ..row
        };
        let mut bench = bench_at(1)?;
        rows.push(place(row(&bench, RayKind::Camera)?));
        if index == 0 && !probes.is_empty() {
            rows.push(Row {
                camera: "lattice".to_owned(),
                ..place(row(&bench, RayKind::Probe)?)
            });
        }
        for (name, light) in shadow_targets(world, camera) {
            bench.aim(gpu, light)?;
            if bench.rays(RayKind::Shadow) == 0 {
                continue;
            }
            let per_edge = rays_per_edge(gpu, size, bench.rays(RayKind::Shadow));
            let measured = if per_edge > 1 {
                let mut finer = bench_at(per_edge)?;
                finer.aim(gpu, light)?;
                row(&finer, RayKind::Shadow)?
            } else {
                row(&bench, RayKind::Shadow)?
            };
            rows.push(Row {
                light: Some(name),
                rays_per_pixel: per_edge * per_edge,
                ..place(measured)
            });
        }
    }
    Ok(rows)
}

/// Camera rays along each edge of a pixel for a row of shadow rays, whose light falls on `lit` pixels of a
/// picture. Enough for [`SHADOW_RAYS_PER_PIXEL`], so that the row does not measure how long a large GPU takes
/// to start and to run dry; at most [`MOST_RAYS_PER_EDGE`], and at most what fits. A software adapter always
/// has enough rays.
fn rays_per_edge(gpu: &Gpu, size: [u32; 2], lit: u32) -> u32 {
    if gpu.summary.is_software() {
        return 1;
    }
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    let fits = |per_edge: &u32| {
        let bytes = pixels * u64::from(per_edge * per_edge) * 8;
        gpu.check_buffer("found", bytes).is_ok()
            && size[0].max(size[1]) * per_edge <= rays::MAX_EDGE
    };
    let enough = |per_edge: &u32| {
        u64::from(lit) * u64::from(per_edge * per_edge) >= SHADOW_RAYS_PER_PIXEL * pixels
    };
    let largest = (1..=MOST_RAYS_PER_EDGE).take_while(fits).last();
    (1..=largest.unwrap_or(1))
        .find(enough)
        .or(largest)
        .unwrap_or(1)
}

/// Measures the row, except for its names.
fn measure_row(
    gpu: &Gpu,
    bench: &RayBench<'_>,
    kind: RayKind,
    repeats: u32,
) -> Result<Row, GpuError> {
    let rays = bench.rays(kind);
    let run = |marcher| {
        Ok((
            bench.hits(gpu, kind, marcher)?,
            bench.time(gpu, kind, marcher, repeats)?,
        ))
    };
    let (hits, timed) = run(Marcher::BrickMap)?;
    let (plain_hits, plain_timed) = run(Marcher::PlainDda)?;
    let words = kind.timed_words();
    let results = timed.results.chunks(words);
    let mismatches = hits
        .iter()
        .zip(&plain_hits)
        .zip(results.zip(plain_timed.results.chunks(words)))
        .filter(|((a, b), (c, d))| !a.same_hit(**b) || c != d)
        .count();
    let steps = |found: &[FoundHit]| {
        found.iter().map(|hit| f64::from(hit.steps())).sum::<f64>() / f64::from(rays.max(1))
    };
    let median = |times: &[f64]| statistics::median(times).unwrap_or(f64::NAN);
    let grays = |ms: f64| f64::from(rays) / ms / 1e6;
    let (ms, plain_ms) = (median(&timed.times_ms), median(&plain_timed.times_ms));
    Ok(Row {
        world: String::new(),
        camera: String::new(),
        rays: match kind {
            RayKind::Camera => "camera",
            RayKind::Shadow => "shadow",
            RayKind::Probe => "probe",
        },
        light: None,
        rays_per_pixel: 1,
        count: rays,
        ms,
        grays_per_s: grays(ms),
        steps_per_ray: steps(&hits),
        plain_ms,
        plain_grays_per_s: grays(plain_ms),
        plain_steps_per_ray: steps(&plain_hits),
        speedup: plain_ms / ms,
        mismatches,
    })
}

/// Rows as a table for people.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<10} {:<12} {:<7} {:>7} {:>9} {:>9} {:>10} {:>7} {:>11} {:>7} {:>8} {:>10}\n",
        "world",
        "camera",
        "rays",
        "/ pixel",
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
            "{:<10} {:<12} {:<7} {:>7} {:>9} {:>9.3} {:>10.2} {:>7.1} {:>11.2} {:>7.1} {:>7.1}x {:>10}\n",
            row.world,
            row.camera,
            row.light.unwrap_or(row.rays),
            row.rays_per_pixel,
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

fn still(camera: &Camera, size: [u32; 2]) -> Shot {
    Shot {
        camera: camera.clone(),
        size,
        frame: 0,
        seed: 0,
        exposure_ev: 0.0,
        view: View::Full,
        time_s: 0.0,
        textures: true,
        soft_rays: 1,
        shadows: Default::default(),
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

/// Lattice points (grid space) whose voxel is air.
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
