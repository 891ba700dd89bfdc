//! The path tracer on the GPU: against closed forms, against the CPU's, and against itself.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::commands::reference::{TraceRequest, Traced, trace};
use grotto::frame;
use grotto::gpu::{Gpu, ShaderChecks, ShaderLibrary};
use grotto::measure::picture::Picture;
use grotto::reference::{FilmOptions, View};
use grotto::world::file::{self, Overrides};
use grotto::world::{Camera, Colour, Lamp, LampKind, Material, Pattern, Sky, Sun, World};

use super::closed_forms::FORMS;
use super::pictures::room;
use super::stage::{Cpu, Stage, Tracer, flat, options, point_lamp, square_camera, uniform_sky};

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
            &world,
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

    /// Albedos are 16-bit floats there.
    fn rounding(&self) -> f64 {
        6e-4
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

fn coloured(albedo: Vec3, emission: Vec3, pattern: Pattern) -> Material {
    Material {
        a: Colour::Flat(albedo),
        b: Colour::Flat(albedo * 0.3),
        pattern,
        emission,
        ..flat(0.5, 0.0)
    }
}

/// A rough cave lit by nothing but coloured lights in its walls.
fn glow() -> (Stage, Camera) {
    let list = vec![
        coloured(
            Vec3::new(0.7, 0.5, 0.4),
            Vec3::ZERO,
            Pattern::Checker { squares: 2 },
        ),
        coloured(Vec3::splat(0.2), Vec3::new(0.5, 6.0, 9.0), Pattern::Plain),
        coloured(Vec3::splat(0.4), Vec3::new(4.0, 0.5, 1.0), Pattern::Plain),
    ];
    let stage = Stage::of(UVec3::splat(20), list, |voxel| {
        let from_middle = voxel.as_vec3() - 9.5;
        let hash = (voxel.x * 71 + voxel.y * 193 + voxel.z * 389) % 23;
        let radius = 7.5 + 0.1 * hash as f32;
        match hash {
            _ if from_middle.length() < radius => 0,
            5 => 2,
            13 => 3,
            _ => 1,
        }
    });
    (
        stage,
        square_camera(DVec3::new(9.5, 9.0, 12.5), 20.0, -10.0),
    )
}

/// A slab with pillars under sun, sky and a spot, away from the origin.
fn outdoors() -> (Stage, Camera) {
    let list = vec![
        coloured(Vec3::new(0.3, 0.5, 0.2), Vec3::ZERO, Pattern::Plain),
        coloured(Vec3::new(0.8, 0.7, 0.6), Vec3::ZERO, Pattern::Plain),
    ];
    let mut stage = Stage::of(UVec3::new(24, 10, 24), list, |voxel| {
        let pillar = voxel.x % 6 == 3 && voxel.z % 7 == 2;
        match voxel.y {
            0 => 1,
            y if pillar && y < 8 => 2,
            8 if voxel.x < 12 => 2,
            _ => 0,
        }
    });
    stage.origin = IVec3::new(-8, 16, 40);
    let low = stage.origin.as_vec3();
    let spot = Lamp {
        kind: LampKind::Spot {
            direction: Vec3::new(0.2, -1.0, -0.3),
            inner_deg: 20.0,
            outer_deg: 45.0,
        },
        colour: Vec3::new(1.0, 0.6, 0.2),
        ..point_lamp(low + Vec3::new(8.0, 7.0, 9.0), 400.0)
    };
    let sun = Sun {
        towards: Vec3::new(0.5, 0.7, 0.3).normalize(),
        irradiance: Vec3::new(3.0, 2.8, 2.2),
    };
    let sky = Sky {
        zenith: Vec3::new(0.2, 0.4, 0.9),
        horizon: Vec3::new(0.8, 0.8, 0.9),
        ground: Vec3::splat(0.1),
    };
    let camera = square_camera(low.as_dvec3() + DVec3::new(12.0, 5.0, 22.0), 15.0, -15.0);
    (stage.lit_by(&[spot], Some(sun)).under(sky), camera)
}

/// Pictures of independent seeds.
fn runs(
    tracer: &dyn Tracer,
    (stage, camera): &(Stage, Camera),
    view: View,
    antialias: bool,
) -> Vec<Picture> {
    let film = FilmOptions {
        samples: 256 / tracer.haste(),
        view,
        antialias,
        ..options(camera)
    };
    let run = |seed| tracer.rendered(stage, &FilmOptions { seed, ..film });
    (10..14).map(run).collect()
}

/// Mean over some pixels and its standard error, from the scatter of each pixel from run to run.
fn mean(runs: &[Picture], channel: usize, pixels: &[usize]) -> (f64, f64) {
    let count = runs.len() as f64;
    let (mut sum, mut variance) = (0.0, 0.0);
    for &pixel in pixels {
        let values = runs.iter().map(|run| f64::from(run.rgb[pixel][channel]));
        let mean = values.clone().sum::<f64>() / count;
        sum += mean;
        variance += values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0) / count;
    }
    let size = pixels.len() as f64;
    (sum / size, variance.sqrt() / size)
}

/// Whether two sets of runs are of the same light: their means over the picture within 1 % or three
/// standard errors of each other, over each block of 8×8 pixels within 1 % or 4.5 of them.
fn agree(a: &[Picture], b: &[Picture]) -> Result<(), String> {
    let (width, height) = (a[0].width as usize, a[0].height as usize);
    let all: Vec<usize> = (0..width * height).collect();
    let block_of = |pixel: usize| (pixel % width / 8, pixel / width / 8);
    let blocks = (0..width / 8).flat_map(|x| (0..height / 8).map(move |y| (x, y)));
    let blocks = blocks.map(|block| {
        let inside = all
            .iter()
            .copied()
            .filter(|pixel| block_of(*pixel) == block);
        (format!("block {block:?}"), inside.collect(), 4.5)
    });
    let whole = ("picture".to_owned(), all.clone(), 3.0);
    for (name, pixels, errors) in std::iter::once(whole).chain(blocks) {
        for channel in 0..3 {
            let (a, b) = (mean(a, channel, &pixels), mean(b, channel, &pixels));
            let error = a.1.hypot(b.1);
            if name == "picture" && error > 0.02 * b.0 {
                return Err(format!(
                    "{name}, channel {channel}: too noisy: {a:?}, {b:?}"
                ));
            }
            if (a.0 - b.0).abs() > (errors * error).max(0.01 * b.0) {
                return Err(format!("{name}, channel {channel}: {a:?}, {b:?}"));
            }
        }
    }
    Ok(())
}

#[test]
fn it_agrees_with_the_cpu_in_every_world() {
    let tracer = OnGpu::open();
    let (stage, cameras) = Stage::of_world("cornell");
    let inside = cameras.iter().find(|camera| camera.name == "inside");
    let cornell = (stage, inside.expect("a camera of the world").clone());
    for (name, scene) in [
        ("room", room()),
        ("glow", glow()),
        ("outdoors", outdoors()),
        ("cornell", cornell),
    ] {
        let [on_gpu, on_cpu] =
            [&tracer as &dyn Tracer, &Cpu].map(|tracer| runs(tracer, &scene, View::Full, false));
        agree(&on_gpu, &on_cpu).unwrap_or_else(|difference| panic!("{name}: {difference}"));
    }
}

#[test]
fn it_agrees_with_the_cpu_in_every_view() {
    let tracer = OnGpu::open();
    let scene = room();
    for (view, antialias) in [
        (View::Indirect, false),
        (View::Irradiance, false),
        // Spread over the pixel, lamps are chosen at random at the first surface too.
        (View::Full, true),
        (View::Direct, true),
    ] {
        let [on_gpu, on_cpu] =
            [&tracer as &dyn Tracer, &Cpu].map(|tracer| runs(tracer, &scene, view, antialias));
        agree(&on_gpu, &on_cpu).unwrap_or_else(|difference| panic!("{view:?}: {difference}"));
    }
    // What is not random agrees pixel by pixel.
    for view in [View::Direct, View::Albedo, View::Normal, View::Depth] {
        for (name, (stage, camera)) in [("room", room()), ("outdoors", outdoors())] {
            let film = FilmOptions {
                view,
                samples: 2,
                ..options(&camera)
            };
            let [on_gpu, on_cpu] =
                [&tracer as &dyn Tracer, &Cpu].map(|tracer| tracer.rendered(&stage, &film));
            let far = |(a, b): (&[f32; 3], &[f32; 3])| {
                (0..3).any(|channel| (a[channel] - b[channel]).abs() > 1e-3 * b[channel].max(0.1))
            };
            let differing = on_gpu.rgb.iter().zip(&on_cpu.rgb).filter(|pair| far(*pair));
            // A ray that grazes an edge may pass on either side of it.
            assert!(differing.count() <= 2, "{name}, {view:?}");
        }
    }
}

/// Light that is wrong by little is found: in the scene, and in each of the shaders' estimates.
#[test]
fn planted_faults_are_found() {
    let tracer = OnGpu::open();
    let truth = runs(&Cpu, &glow(), View::Full, false);
    // Where light bounces often, an albedo off by 2 % makes a tenth more of it.
    let [faulty, sound] =
        [(&tracer as &dyn Tracer, 0.8 * 1.02), (&Cpu, 0.8)].map(|(tracer, albedo)| {
            let lamp = point_lamp(Vec3::new(2.5, 4.8, 3.1), 50.0);
            let stage = Stage::closed_box(6, albedo, 0.0).lit_by(&[lamp], None);
            let camera = square_camera(DVec3::splat(4.0), 30.0, -20.0);
            runs(tracer, &(stage, camera), View::Indirect, false)
        });
    assert!(agree(&faulty, &sound).is_err(), "albedo × 1.02");
    for (file, sound, faulty) in [
        // Uniform in place of cosine-weighted directions.
        (
            "light/sampling.wesl",
            "sqrt(1.0 - squared_radius);",
            "sqrt(1.0 - squared_radius * squared_radius);",
        ),
        // Emissive faces counted twice when a ray finds them.
        ("passes/path_trace.wesl", "emitted * share;", "emitted;"),
        // A weight without its π.
        (
            "light/emitters.wesl",
            "(PI * density * squared_distance",
            "(density * squared_distance",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"),
            folder.path(),
        );
        let path = folder.path().join(file);
        let text = fs::read_to_string(&path).expect("readable");
        assert!(text.contains(sound), "{file} no longer has `{sound}`");
        fs::write(&path, text.replace(sound, faulty)).expect("writable");
        let shaders = ShaderLibrary::from_folder(folder.path()).expect("a folder of shaders");
        let mutant = OnGpu {
            gpu: tracer.gpu.with_shaders(shaders),
            world: tracer.world.clone(),
        };
        let found = agree(&runs(&mutant, &glow(), View::Full, false), &truth);
        assert!(found.is_err(), "{file}: `{faulty}` makes no difference");
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("writable");
    for entry in fs::read_dir(from).expect("readable").flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).expect("writable");
        }
    }
}

/// The root of the mean squared error falls as 1/√N.
#[test]
fn the_error_falls_with_the_root_of_the_samples() {
    let tracer = OnGpu::open();
    let (stage, camera) = room();
    let picture = |samples, seed| {
        let film = FilmOptions {
            size: [8, 8],
            samples,
            seed,
            view: View::Indirect,
            ..options(&camera)
        };
        tracer.rendered(&stage, &film)
    };
    const LONG: u32 = 1024;
    let truth = picture(LONG, 99);
    let points = [4, 16, 64, 256].map(|samples| {
        let trial = picture(samples, 7);
        let squares = trial.rgb.iter().zip(&truth.rgb);
        let sum: f64 = squares.map(|(a, b)| f64::from(a[1] - b[1]).powi(2)).sum();
        // The truth has an error of its own: σ²(1/N + 1/LONG).
        let own = 1.0 / (1.0 + f64::from(samples) / f64::from(LONG));
        let error = (sum / trial.rgb.len() as f64 * own).sqrt();
        (f64::from(samples).ln(), error.ln())
    });
    let slope = least_squares_slope(&points);
    println!("{points:?}: exponent {slope}");
    assert!((-0.57..=-0.43).contains(&slope), "{points:?}: {slope}");
}

fn least_squares_slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let above: f64 = points
        .iter()
        .map(|point| (point.0 - x) * (point.1 - y))
        .sum();
    above
        / points
            .iter()
            .map(|point| (point.0 - x).powi(2))
            .sum::<f64>()
}

/// More samples than one sum takes, all of them equal: none may be lost.
#[test]
fn long_sums_lose_nothing_and_slices_change_nothing() {
    let tracer = OnGpu::with(ShaderChecks::Checked);
    let floor = Stage::new(UVec3::new(64, 8, 64), &[(0.125, 0.0)], |voxel| {
        u8::from(voxel.y == 0)
    })
    .under(uniform_sky(1.0 / 3.0));
    let above = square_camera(DVec3::new(32.0, 6.0, 32.0), 0.0, -90.0);
    let film = FilmOptions {
        size: [8, 8],
        samples: 1100,
        ..options(&above)
    };
    let truth = 0.125 / 3.0;
    for rgb in tracer.rendered(&floor, &film).rgb {
        assert!((f64::from(rgb[0]) / truth - 1.0).abs() < 1e-4, "{rgb:?}");
    }

    // Slices follow the clock, which is never the same twice.
    let (stage, camera) = room();
    let film = FilmOptions {
        size: [40, 24],
        samples: 5,
        ..options(&camera)
    };
    let first = tracer.rendered(&stage, &film);
    assert_eq!(tracer.rendered(&stage, &film), first);
    assert_ne!(
        tracer.rendered(&stage, &FilmOptions { seed: 2, ..film }),
        first
    );
}

#[test]
fn a_cancelled_picture_holds_the_mean_of_what_was_done() {
    let tracer = OnGpu::open();
    let (stage, camera) = room();
    let film = FilmOptions {
        samples: 1 << 20,
        ..options(&camera)
    };
    let cancel = AtomicBool::new(false);
    let progress = |done, total| {
        assert_eq!(total, 4 << 20, "four tiles");
        if done >= 4 * 20 {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let partial = tracer.traced(&stage, &film, &progress, &cancel);
    assert!(
        partial.spp >= 20 && partial.spp < 1 << 20,
        "{}",
        partial.spp
    );
    let whole = Cpu.rendered(
        &stage,
        &FilmOptions {
            samples: 400,
            ..film
        },
    );
    let mean = |picture: &Picture| picture.rgb.iter().map(|rgb| rgb[0]).sum::<f32>() / 256.0;
    assert!((mean(&partial.picture) / mean(&whole) - 1.0).abs() < 0.05);
    let at_once = tracer.traced(&stage, &film, &|_, _| {}, &AtomicBool::new(true));
    assert_eq!(at_once.spp, 0);
}
