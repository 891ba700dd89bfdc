//! Temporal anti-aliasing of whole frames: at rest against a box filter, in motion and after edits against pictures that
//! have no history. The view of direct light shows flat colours, so that a pixel depends on its camera ray alone.

use glam::{UVec3, Vec3};
use grotto::{
    frame::Smoothing,
    gpu::{Gpu, Recorder},
    measure::picture::Picture,
    parameters::{Antialias, ProbeParameters},
    world::{View, World},
};

use crate::support::{frames::Drawn, gpu, parsed, scenes::lattice, with_faults};

pub const SIZE: [u32; 2] = [48, 32];
/// Rays along each edge of a pixel of the box filter.
pub const FINE: u32 = 8;

/// A sphere and a pillar in the sun: edges and shadows in every direction.
fn world() -> World {
    parsed(
        "(title: \"Edges.\", size: (48, 32, 48), origin: (-24, -8, -24),
          shape: Union([
            Plane(normal: (0, 1, 0), offset: 0),
            Translate(by: (6, 5, -4), of: Sphere(radius: 6)),
            Translate(by: (-6, 6, 2), of: Box(half: (2, 6, 2))),
          ]),
          materials: {\"stone\": (a: Flat(0.5, 0.4, 0.3))},
          sun: (towards: (2, 3, 1), irradiance: (3, 2.7, 2.3)),
          sky: (zenith: (0.3, 0.5, 1)),
          cameras: [(name: \"front\", position: (4, 7, 20), look_at: (0, 4, 0))])",
    )
}

pub fn drawn_of(gpu: Gpu, size: [u32; 2], wanted: impl Into<Smoothing>) -> Drawn {
    let layout = lattice(UVec3::splat(2), Vec3::splat(12.0), Vec3::new(0.0, 8.0, 0.0));
    let probes = ProbeParameters {
        rays: 8,
        ..Default::default()
    };
    let mut drawn = Drawn::new(gpu, world(), &layout, probes, size);
    drawn.shot.view = View::Direct;
    drawn.frame.antialias(&drawn.gpu, wanted).expect("fits");
    drawn
}

fn smoothed(gpu: Gpu) -> Drawn {
    drawn_of(gpu, SIZE, Antialias::Temporal)
}

/// What `like` shows, with FINE × FINE rays per pixel.
pub fn fine(like: &Drawn, dug: Option<Vec3>) -> Picture {
    let size = like.shot.size.map(|edge| edge * FINE);
    let mut drawn = drawn_of(like.gpu.clone(), size, Antialias::Off);
    drawn.shot.camera = like.shot.camera.clone();
    if let Some(centre) = dug {
        dig(&mut drawn, centre);
    }
    drawn.draw(2);
    drawn.radiance()
}

/// The picture that the frame of `like` should converge to.
pub fn box_filtered(like: &Drawn) -> Picture {
    box_filter(&fine(like, None))
}

pub fn box_filter(picture: &Picture) -> Picture {
    let mut mean = Picture::new(picture.width / FINE, picture.height / FINE);
    let width = mean.width;
    for (index, rgb) in picture.rgb.iter().enumerate() {
        let (x, y) = (
            index as u32 % picture.width / FINE,
            index as u32 / picture.width / FINE,
        );
        let sum = &mut mean.rgb[(y * width + x) as usize];
        for (sum, value) in sum.iter_mut().zip(rgb) {
            *sum += value / (FINE * FINE) as f32;
        }
    }
    mean
}

/// The picture without anti-aliasing of what `like` shows.
pub fn plain(like: &Drawn) -> Picture {
    let mut drawn = drawn_of(like.gpu.clone(), like.shot.size, Antialias::Off);
    drawn.shot.camera = like.shot.camera.clone();
    drawn.draw(2);
    drawn.radiance()
}

/// Mean over the pixels of the absolute difference, sum over RGB.
pub fn apart(a: &Picture, b: &Picture) -> f64 {
    let all = a.rgb.as_flattened().iter().zip(b.rgb.as_flattened());
    let sum: f64 = all.map(|(a, b)| f64::from((a - b).abs())).sum();
    sum / a.rgb.len() as f64
}

/// Removes a ball of voxels (grid space).
pub fn dig(drawn: &mut Drawn, centre: Vec3) {
    let mut voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let edit = voxels.fill_sphere(centre, 3.0, 0);
    let applied = drawn.frame.apply(&drawn.gpu, &voxels, &edit);
    applied.expect("fits");
}

#[test]
fn off_is_the_picture_without_the_pass() {
    let mut never = drawn_of(gpu(), SIZE, Antialias::Off);
    let mut switched = smoothed(never.gpu.clone());
    never.draw(3);
    switched.draw(3);
    assert!(
        never.radiance() != switched.radiance(),
        "edges are smoothed"
    );
    let off = Antialias::Off;
    switched.frame.antialias(&switched.gpu, off).expect("fits");
    never.draw(1);
    switched.draw(1);
    assert!(never.radiance() == switched.radiance());
    let shown = [&never, &switched].map(|drawn| drawn.frame.read_display(&drawn.gpu));
    let [never, switched] = shown.map(|picture| picture.expect("reads back"));
    assert!(never == switched);
}

#[test]
fn views_of_data_stay_at_the_centres_of_pixels() {
    let mut off = drawn_of(gpu(), SIZE, Antialias::Off);
    let mut on = smoothed(off.gpu.clone());
    for drawn in [&mut off, &mut on] {
        drawn.shot.view = View::Normal;
        drawn.draw(2);
    }
    assert!(off.radiance() == on.radiance());
}

#[test]
fn at_rest_pictures_converge_to_the_box_filter() {
    let mut drawn = smoothed(gpu());
    let truth = box_filtered(&drawn);
    let steps = apart(&plain(&drawn), &truth);
    drawn.draw(160);
    let error = apart(&drawn.radiance(), &truth);
    assert!(error < 0.15 * steps, "{error} of {steps}");
}

#[test]
fn a_plain_mean_needs_no_settling() {
    let mut drawn = smoothed(gpu());
    let truth = box_filtered(&drawn);
    let steps = apart(&plain(&drawn), &truth);
    drawn.draw(2);
    drawn.frame.restart_antialiasing();
    for _ in 0..32 {
        let mut recorder = Recorder::new(&drawn.gpu, None);
        let shot = &drawn.shot;
        assert!(drawn.frame.smooth(&drawn.gpu, &mut recorder, shot));
        recorder.submit(&drawn.gpu).expect("submits");
    }
    let error = apart(&drawn.radiance(), &truth);
    assert!(error < 0.2 * steps, "{error} of {steps}");
}

/// Turns for some frames, and returns the error of the last picture over that of a picture without anti-aliasing.
fn turned(gpu: Gpu) -> f64 {
    let mut drawn = smoothed(gpu);
    drawn.draw(40);
    for _ in 0..8 {
        drawn.shot.camera.yaw_deg += 0.7;
        drawn.draw(1);
    }
    let truth = box_filtered(&drawn);
    let steps = apart(&plain(&drawn), &truth);
    apart(&drawn.radiance(), &truth) / steps
}

#[test]
fn a_camera_that_turns_keeps_its_history() {
    let gpu = gpu();
    let right = turned(gpu.clone());
    assert!(right < 0.8, "{right}");
    // Planted: history is taken from where the pixel is now.
    let moves = "at += motion_of(place, nearest);";
    let faults = [(
        "view/antialias.wesl",
        moves,
        "at += 0.0 * motion_of(place, nearest);",
    )];
    let wrong = turned(with_faults(&gpu, &faults));
    assert!(wrong > 1.5 * right, "{wrong} {right}");
    // Planted: nothing is kept.
    let known = "if !is_known {";
    let faults = [("view/antialias.wesl", known, "if true {")];
    let forgotten = turned(with_faults(&gpu, &faults));
    assert!(forgotten > 1.25 * right, "{forgotten} {right}");
}

/// Energy of the picture over that of the truth after many frames that each read history half way between pixels.
fn energy_after_a_long_turn(gpu: Gpu) -> f64 {
    let mut drawn = smoothed(gpu);
    drawn.draw(40);
    let degrees_a_pixel = drawn.shot.camera.fov_deg / SIZE[1] as f32;
    for _ in 0..40 {
        drawn.shot.camera.yaw_deg += 0.5 * degrees_a_pixel;
        drawn.shot.camera.pitch_deg += 0.5 * degrees_a_pixel;
        drawn.draw(1);
        drawn.shot.camera.yaw_deg -= 0.5 * degrees_a_pixel;
        drawn.shot.camera.pitch_deg -= 0.5 * degrees_a_pixel;
        drawn.draw(1);
    }
    let light = |picture: &Picture| picture.rgb.as_flattened().iter().sum::<f32>();
    f64::from(light(&drawn.radiance()) / light(&box_filtered(&drawn)))
}

#[test]
fn history_between_pixels_neither_fades_nor_grows() {
    let gpu = gpu();
    let right = energy_after_a_long_turn(gpu.clone());
    assert!((right - 1.0).abs() < 0.01, "{right}");
    // Planted: a cubic that amplifies waves by more than new rays replace, and no box that holds them.
    let faults = [
        (
            "view/history.wesl",
            "const SHARPNESS: f32 = 0.6;",
            "const SHARPNESS: f32 = 1.2;",
        ),
        (
            "view/antialias.wesl",
            "if per_thread(history.clips, surface.y) == 1u {",
            "if per_thread(history.clips, surface.y) == 2u {",
        ),
    ];
    let wrong = energy_after_a_long_turn(with_faults(&gpu, &faults));
    assert!((wrong - 1.0).abs() > 0.1, "{wrong}");
}

/// Digs into the sphere, and returns the share of the dug pixels that the next frame shows as they were.
fn ghosts(gpu: Gpu) -> f64 {
    let mut drawn = smoothed(gpu);
    // History is clipped in the 40 frames of warm-up and in 16 more.
    drawn.draw(80);
    let before = drawn.radiance();
    // World (6, 7, 2).
    let centre = Vec3::new(30.0, 15.0, 26.0);
    dig(&mut drawn, centre);
    drawn.draw(1);
    let after = drawn.radiance();
    let rays = fine(&drawn, Some(centre));
    let fresh = box_filter(&rays);
    let change = |a: [f32; 3], b: [f32; 3]| {
        let each = a.into_iter().zip(b).map(|(a, b)| (a - b).abs());
        each.fold(0.0, f32::max)
    };
    let [mut dug, mut ghosts] = [0, 0];
    for (index, now) in after.rgb.iter().enumerate() {
        if change(before.rgb[index], fresh.rgb[index]) < 0.1 {
            continue;
        }
        dug += 1;
        // Without history a pixel shows what one of its rays hits.
        let corner = [index as u32 % SIZE[0] * FINE, index as u32 / SIZE[0] * FINE];
        let ray = |n: u32| (corner[1] + n / FINE) * rays.width + corner[0] + n % FINE;
        let its_rays = (0..FINE * FINE).map(|n| rays.rgb[ray(n) as usize]);
        let nearest = its_rays.map(|one| change(one, *now));
        ghosts += u32::from(nearest.fold(f32::MAX, f32::min) > 0.02);
    }
    assert!(dug > 20, "{dug}");
    f64::from(ghosts) / f64::from(dug)
}

#[test]
fn what_is_dug_leaves_no_ghost() {
    let gpu = gpu();
    let right = ghosts(gpu.clone());
    assert!(right < 0.1, "{right}");
    let found = "return surface.found && all(";
    let faults = [
        (
            "view/history.wesl",
            found,
            "return history.clips == 2u && all(",
        ),
        (
            "view/antialias.wesl",
            "if per_thread(history.clips, surface.y) == 1u {",
            "if per_thread(history.clips, surface.y) == 2u {",
        ),
    ];
    let wrong = ghosts(with_faults(&gpu, &faults));
    assert!(wrong > 0.5, "{wrong}");
}

/// Doubles the sun, and returns the share of the change that the second frame still lacks.
fn lag(gpu: Gpu) -> f64 {
    let mut drawn = smoothed(gpu);
    drawn.draw(40);
    let before = drawn.radiance();
    for lamp in &mut drawn.lights.lamps {
        lamp.intensity *= 2.0;
    }
    drawn.draw(2);
    let then = drawn.radiance();
    drawn.draw(160);
    let settled = drawn.radiance();
    apart(&then, &settled) / apart(&before, &settled)
}

#[test]
fn light_that_changes_is_followed() {
    let gpu = gpu();
    let right = lag(gpu.clone());
    assert!(right < 0.3, "{right}");
    let faults = [(
        "view/antialias.wesl",
        "if per_thread(history.clips, surface.y) == 1u {",
        "if per_thread(history.clips, surface.y) == 2u {",
    )];
    let wrong = lag(with_faults(&gpu, &faults));
    assert!(wrong > 0.6, "{wrong}");
}
