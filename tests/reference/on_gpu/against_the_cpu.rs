//! Light agrees with the CPU's path tracer, channel by channel and block by block.

use glam::{DVec3, Vec3};
use grotto::measure::picture::Picture;
use grotto::reference::FilmOptions;
use grotto::world::{Camera, View};

use super::super::pictures::room;
use super::super::stage::{Cpu, Stage, Tracer, options, point_lamp, square_camera};
use super::OnGpu;
use super::scenes::{glow, outdoors, soft};
use crate::support::with_faults;

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

/// Whether two sets of runs show the same light: their means over the picture within 1 % or three
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
        ("soft", soft()),
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
        // With samples spread over the pixel, lamps are chosen at random at the first surface too.
        (View::Full, true),
        (View::Direct, true),
    ] {
        let [on_gpu, on_cpu] =
            [&tracer as &dyn Tracer, &Cpu].map(|tracer| runs(tracer, &scene, view, antialias));
        agree(&on_gpu, &on_cpu).unwrap_or_else(|difference| panic!("{view:?}: {difference}"));
    }
    // Lamps that are spheres are random at the first surface too, however samples are spread.
    let scene = soft();
    for (view, antialias) in [
        (View::Direct, false),
        (View::Direct, true),
        (View::Full, true),
    ] {
        let [on_gpu, on_cpu] =
            [&tracer as &dyn Tracer, &Cpu].map(|tracer| runs(tracer, &scene, view, antialias));
        agree(&on_gpu, &on_cpu).unwrap_or_else(|difference| panic!("{view:?}: {difference}"));
    }
    // Results without randomness agree pixel by pixel.
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

/// Faults in how spheres are sampled are found.
#[test]
fn planted_faults_of_spheres_are_found() {
    let tracer = OnGpu::open();
    let truth = runs(&Cpu, &soft(), View::Direct, false);
    for (sound, faulty) in [
        // The cone a tenth too bright.
        ("2.0 * cone.falloff /", "2.2 * cone.falloff /"),
        // Directions towards the middle alone: hard shadows.
        (
            "let below = random.x * height;",
            "let below = 0.0 * random.x * height;",
        ),
        // Shadow rays that do not end at the sphere.
        (
            "return max(middle - sqrt(",
            "return 100.0 + max(middle - sqrt(",
        ),
    ] {
        let mutant = OnGpu {
            gpu: with_faults(&tracer.gpu, &[("light/sphere.wesl", sound, faulty)]),
            world: tracer.world.clone(),
        };
        let found = agree(&runs(&mutant, &soft(), View::Direct, false), &truth);
        assert!(found.is_err(), "`{faulty}` makes no difference");
    }
}

/// Small errors of light are found: in the scene, and in each of the shaders' estimates.
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
            "math/sampling.wesl",
            "sqrt(1.0 - squared_radius);",
            "sqrt(1.0 - squared_radius * squared_radius);",
        ),
        // Emissive faces counted twice when a ray finds them.
        ("path_trace/trace.wesl", "emitted * share;", "emitted;"),
        // A weight without its π.
        (
            "light/emitters.wesl",
            "(PI * density * squared_distance",
            "(density * squared_distance",
        ),
    ] {
        let mutant = OnGpu {
            gpu: with_faults(&tracer.gpu, &[(file, sound, faulty)]),
            world: tracer.world.clone(),
        };
        let found = agree(&runs(&mutant, &glow(), View::Full, false), &truth);
        assert!(found.is_err(), "{file}: `{faulty}` makes no difference");
    }
}
