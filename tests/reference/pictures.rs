//! Pictures as a whole: views, determinism, progress, cancelling.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::measure::metrics::absolute_sum;
use grotto::measure::picture::Picture;
use grotto::measure::statistics::MeanEstimate;
use grotto::reference::{FilmOptions, RenderOptions, render, render_scene};
use grotto::world::file::{self, Overrides};
use grotto::world::generate::generate;
use grotto::world::{Camera, View};

use super::stage::{Cpu, Stage, Tracer as _, options, point_lamp, square_camera, uniform_sky};

/// A lit room with a hole in its roof, a pillar, and three lamps.
pub fn room() -> (Stage, Camera) {
    let stage = Stage::new(UVec3::splat(18), &[(0.7, 0.0), (0.3, 1.5)], |voxel| {
        let wall = voxel.cmpeq(IVec3::ZERO).any() || voxel.cmpeq(IVec3::splat(17)).any();
        let hole = voxel.y == 17 && voxel.x > 12;
        let pillar = voxel.x == 6 && voxel.z == 7;
        if pillar { 2 } else { u8::from(wall && !hole) }
    })
    .under(uniform_sky(2.0))
    .lit_by(
        &[
            point_lamp(Vec3::new(4.0, 12.0, 4.0), 300.0),
            point_lamp(Vec3::new(12.0, 3.0, 13.0), 90.0),
            point_lamp(Vec3::new(14.0, 30.0, 9.0), 800.0),
        ],
        None,
    );
    (stage, square_camera(DVec3::new(9.0, 8.0, 15.5), 10.0, 10.0))
}

fn with_view(stage: &Stage, camera: &Camera, view: View) -> Picture {
    stage.rendered(&FilmOptions {
        view,
        ..options(camera)
    })
}

#[test]
fn direct_and_indirect_add_up_to_full() {
    let (stage, camera) = room();
    let [full, direct, indirect] =
        [View::Full, View::Direct, View::Indirect].map(|view| with_view(&stage, &camera, view));
    for ((full, direct), indirect) in full.rgb.iter().zip(&direct.rgb).zip(&indirect.rgb) {
        assert!((full[0] - direct[0] - indirect[0]).abs() <= 1e-5 * full[0].max(1.0));
    }
    assert!(indirect.rgb.iter().all(|rgb| rgb[0] >= 0.0));
    assert!(
        direct.rgb.iter().any(|rgb| rgb[0] >= 1.5),
        "the pillar glows"
    );
}

#[test]
fn indirect_is_albedo_times_irradiance() {
    let (stage, camera) = room();
    let [indirect, irradiance, albedo] = [View::Indirect, View::Irradiance, View::Albedo]
        .map(|view| with_view(&stage, &camera, view));
    for ((indirect, irradiance), albedo) in
        indirect.rgb.iter().zip(&irradiance.rgb).zip(&albedo.rgb)
    {
        assert!((indirect[1] - irradiance[1] * albedo[1]).abs() < 1e-5);
    }
}

#[test]
fn views_of_data_show_the_surface_and_nothing_beyond_it() {
    let stage = Stage::new(UVec3::new(9, 9, 9), &[(0.25, 0.0)], |voxel| {
        u8::from(voxel.z == 0 && voxel.x < 4)
    })
    .under(uniform_sky(1.0));
    let camera = square_camera(DVec3::new(4.0, 4.5, 5.0), 0.0, 0.0);
    let picture = |view| with_view(&stage, &camera, view).rgb;
    // The left half of the picture is the wall four voxels ahead, the right half the sky.
    assert_eq!(picture(View::Albedo)[8 * 16 + 7], [0.25; 3]);
    assert_eq!(picture(View::Normal)[8 * 16 + 7], [0.5, 0.5, 1.0]);
    let off_axis = 0.5f32 / 8.0;
    let distance = 4.0 * (1.0 + 2.0 * off_axis * off_axis).sqrt();
    assert!((picture(View::Depth)[8 * 16 + 7][0] - distance).abs() < 1e-5);
    for view in [View::Albedo, View::Normal, View::Depth, View::Indirect] {
        assert_eq!(picture(view)[8 * 16 + 8], [0.0; 3], "{view:?}");
    }
    assert_eq!(picture(View::Direct)[8 * 16 + 8], [1.0; 3]);
}

#[test]
fn a_camera_in_a_solid_voxel_sees_its_emission() {
    let stage = Stage::new(UVec3::splat(9), &[(0.5, 3.0)], |_| 1).under(uniform_sky(1.0));
    let camera = square_camera(DVec3::splat(4.5), 0.0, 0.0);
    for (view, radiance) in [
        (View::Full, 3.0),
        (View::Indirect, 0.0),
        (View::Albedo, 0.0),
    ] {
        let picture = with_view(&stage, &camera, view);
        assert!(
            picture.rgb.iter().all(|rgb| *rgb == [radiance; 3]),
            "{view:?}"
        );
    }
}

/// From a world's file to its picture, with its lamps, materials and origin.
#[test]
fn a_world_renders_from_its_file() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/furnace.ron");
    let world = file::load(&path, &Overrides::default()).expect("a world of ours");
    let voxels = generate(&world);
    for camera in &world.cameras {
        let film = FilmOptions {
            samples: 64,
            ..options(camera)
        };
        let lamps = &world.lamp_presets[0];
        let options = RenderOptions {
            lamps,
            time_s: 0.0,
            lamp_time_s: 0.0,
            textures: true,
            film,
        };
        let cancel = AtomicBool::new(false);
        let picture = render(&world, &voxels, &options, &|_, _| {}, &cancel);
        let values = picture.rgb.iter().map(|rgb| f64::from(rgb[2]));
        let mean = MeanEstimate::of(values).expect("a picture with pixels");
        assert!(
            mean.agrees_with(2.0, 3.0, 0.01),
            "{}: {mean:?}",
            camera.name
        );
    }
}

/// The position of a world in space does not affect its light.
#[test]
fn moving_the_world_moves_the_picture_with_it() {
    let (stage, camera) = room();
    let by = IVec3::new(-64, 32, 128);
    let mut moved = Stage {
        origin: by,
        ..room().0
    };
    for lamp in &mut moved.lights.lamps {
        lamp.position_ws += by.as_dvec3();
    }
    let mut moved_camera = camera.clone();
    moved_camera.position += by.as_vec3();
    let here = with_view(&stage, &camera, View::Full);
    let there = with_view(&moved, &moved_camera, View::Full);
    assert!(absolute_sum(&here, &there).expect("comparable").max < 1e-4);
}

#[test]
fn the_same_arguments_give_the_same_bytes_on_any_number_of_threads() {
    let (stage, camera) = room();
    let mut options = options(&camera);
    options.samples = 11;
    options.antialias = true;
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a thread pool")
            .install(|| stage.rendered(&options))
    };
    assert_eq!(on(1), on(3));
    let first = on(2);
    options.seed = 2;
    assert_ne!(stage.rendered(&options), first);
}

/// One lamp chosen at random at every bounce gives, on average, the sum over all lamps.
#[test]
fn the_choice_of_lamps_is_fair() {
    let (stage, camera) = room();
    let all = Cpu.mean(&stage, &camera, View::Indirect, 16, 256);
    // The same light, lamp by lamp: with a single lamp there is nothing to choose.
    let dark = Stage {
        lights: stage.lights.clone(),
        ..room().0
    };
    let mut sum = 0.0;
    let mut variance = all.standard_error.powi(2);
    for lamp in 0..=stage.lights.lamps.len() {
        let mut one = Stage {
            lights: dark.lights.clone(),
            ..room().0
        };
        one.lights.lamps = stage.lights.lamps.get(lamp).copied().into_iter().collect();
        // Every picture holds sky and emission; the weight of the last, which has no lamp, makes them count once.
        let share = Cpu.mean(&one, &camera, View::Indirect, 16, 256);
        let weight = if lamp == stage.lights.lamps.len() {
            1.0 - stage.lights.lamps.len() as f64
        } else {
            1.0
        };
        sum += weight * share.mean;
        variance += (weight * share.standard_error).powi(2);
    }
    assert!(
        (all.mean - sum).abs() < (3.0 * variance.sqrt()).max(0.01 * sum),
        "{all:?} {sum}"
    );
}

#[test]
fn progress_ends_at_its_total_and_only_random_views_take_samples() {
    let (stage, camera) = room();
    for (view, samples) in [(View::Full, 19), (View::Albedo, 1)] {
        let (most, calls) = (AtomicU64::new(0), AtomicU64::new(0));
        let options = FilmOptions {
            view,
            samples: 19,
            ..options(&camera)
        };
        let progress = |done, total| {
            assert_eq!(total, 16 * 16 * samples);
            most.fetch_max(done, Ordering::Relaxed);
            calls.fetch_add(1, Ordering::Relaxed);
        };
        render_scene(&stage.scene(), &options, &progress, &AtomicBool::new(false));
        assert_eq!(most.into_inner(), 16 * 16 * samples);
        assert!(calls.into_inner() >= 16);
    }
}

#[test]
fn a_cancelled_picture_holds_the_mean_of_what_was_done() {
    let (stage, camera) = room();
    let options = FilmOptions {
        samples: 100_000_000,
        ..options(&camera)
    };
    let cancel = AtomicBool::new(false);
    // Cancelled after every row has had its first samples.
    let progress = |done, _| {
        if done >= 16 * 16 * 8 {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let partial = render_scene(&stage.scene(), &options, &progress, &cancel);
    let whole = stage.rendered(&FilmOptions {
        samples: 1000,
        ..options
    });
    let mean = |picture: &Picture| picture.rgb.iter().map(|rgb| rgb[0]).sum::<f32>() / 256.0;
    assert!((mean(&partial) / mean(&whole) - 1.0).abs() < 0.1);
    let at_once = render_scene(&stage.scene(), &options, &|_, _| {}, &AtomicBool::new(true));
    assert!(at_once.rgb.iter().all(|rgb| *rgb == [0.0; 3]));
}
