//! Upscaling by the history of anti-aliasing: at rest against a box filter of the shown pixels, in motion and after edits
//! against pictures without history.

use glam::Vec3;
use grotto::{
    frame::Smoothing,
    gpu::{Gpu, Recorder},
    measure::{flip::flip, picture::Picture, tonemap::tone_mapped},
    parameters::Antialias,
    passes::view::bits::GpuBit,
    world::View,
};

use crate::{
    antialias::{SIZE, apart, box_filter, box_filtered, dig, drawn_of, fine, plain},
    support::{frames::Drawn, gpu, with_faults},
};

/// Edges that no scale divides.
const ODD: [u32; 2] = [47, 31];

fn upscaled(gpu: Gpu, size: [u32; 2], scale: f32) -> Drawn {
    let antialias = Antialias::Temporal;
    drawn_of(gpu, size, Smoothing { antialias, scale })
}

/// Mean FLIP of two pictures of linear light.
fn visibly_apart(a: &Picture, b: &Picture) -> f64 {
    let [a, b] = [a, b].map(|linear| tone_mapped(linear, 0.0));
    let map = flip(&a, &b, 67.0).expect("of one size");
    map.iter().map(|value| f64::from(*value)).sum::<f64>() / map.len() as f64
}

/// A picture stretched to another size: each pixel is a copy of the nearest one.
fn stretched(picture: &Picture, [width, height]: [u32; 2]) -> Picture {
    let mut large = Picture::new(width, height);
    for (index, rgb) in large.rgb.iter_mut().enumerate() {
        let (x, y) = (index as u32 % width, index as u32 / width);
        let column = x * picture.width / width;
        let row = y * picture.height / height;
        *rgb = picture.rgb[(row * picture.width + column) as usize];
    }
    large
}

#[test]
fn at_rest_pictures_converge_to_the_reference_of_the_shown_size() {
    let gpu = gpu();
    for (size, scale) in [(SIZE, 0.5), (ODD, 0.5), (SIZE, 0.67), (ODD, 0.77)] {
        let mut drawn = upscaled(gpu.clone(), size, scale);
        let truth = box_filtered(&drawn);
        let steps = apart(&plain(&drawn), &truth);
        drawn.draw(320);
        let shown = drawn.radiance();
        assert_eq!([shown.width, shown.height], size);
        let error = apart(&shown, &truth);
        assert!(error < 0.2 * steps, "{error} of {steps} at {scale}");
        let seen = visibly_apart(&shown, &truth);
        assert!(seen < 0.01, "{seen} at {scale}");

        // The comparators see what plain stretching lacks, however smooth the small picture is.
        let mut small = drawn_of(
            gpu.clone(),
            drawn.frame.rendered_size(),
            Antialias::Temporal,
        );
        small.draw(80);
        let stretched = stretched(&small.radiance(), size);
        let error = apart(&stretched, &truth);
        assert!(error > 0.5 * steps, "{error} of {steps} at {scale}");
        let seen = visibly_apart(&stretched, &truth);
        assert!(seen > 0.02, "{seen} at {scale}");
    }
}

#[test]
fn a_plain_mean_needs_no_settling() {
    let mut drawn = upscaled(gpu(), ODD, 0.5);
    let truth = box_filtered(&drawn);
    let steps = apart(&plain(&drawn), &truth);
    drawn.draw(2);
    drawn.frame.restart_antialiasing();
    for _ in 0..128 {
        let mut recorder = Recorder::new(&drawn.gpu, None);
        let shot = &drawn.shot;
        assert!(drawn.frame.smooth(&drawn.gpu, &mut recorder, shot));
        recorder.submit(&drawn.gpu).expect("submits");
    }
    let error = apart(&drawn.radiance(), &truth);
    assert!(error < 0.25 * steps, "{error} of {steps}");
}

#[test]
fn scale_one_is_anti_aliasing_alone() {
    let mut never = drawn_of(gpu(), SIZE, Antialias::Temporal);
    let mut switched = upscaled(never.gpu.clone(), SIZE, 0.5);
    never.draw(3);
    switched.draw(3);
    assert_eq!(switched.frame.rendered_size(), SIZE.map(|edge| edge / 2));
    assert!(never.radiance() != switched.radiance());
    let whole = Antialias::Temporal;
    switched
        .frame
        .antialias(&switched.gpu, whole)
        .expect("fits");
    never.frame.restart_antialiasing();
    for turned_deg in [0.0, 0.0, 0.7, 0.7] {
        for drawn in [&mut never, &mut switched] {
            drawn.shot.camera.yaw_deg += turned_deg;
            drawn.draw(2);
        }
        assert!(never.radiance() == switched.radiance());
    }
    let shown = [&never, &switched].map(|drawn| drawn.frame.read_display(&drawn.gpu));
    let [never, switched] = shown.map(|picture| picture.expect("reads back"));
    assert!(never == switched);
}

#[test]
fn a_change_of_scale_keeps_the_history() {
    let mut drawn = upscaled(gpu(), SIZE, 0.6);
    drawn.draw(160);
    let before = drawn.radiance();
    let smoothing = Smoothing {
        antialias: Antialias::Temporal,
        scale: 0.55,
    };
    drawn.frame.antialias(&drawn.gpu, smoothing).expect("fits");
    drawn.draw(1);
    let kept = apart(&drawn.radiance(), &before);
    drawn.frame.restart_antialiasing();
    drawn.draw(1);
    let forgotten = apart(&drawn.radiance(), &before);
    assert!(kept < 0.2 * forgotten, "{kept} {forgotten}");
}

#[test]
fn views_of_data_have_all_pixels() {
    let mut whole = drawn_of(gpu(), ODD, Antialias::Off);
    let mut scaled = upscaled(whole.gpu.clone(), ODD, 0.5);
    for drawn in [&mut whole, &mut scaled] {
        drawn.shot.view = View::Normal;
        drawn.draw(2);
    }
    assert!(whole.radiance() == scaled.radiance());
    assert_eq!(scaled.frame.rendered_size(), ODD);
}

#[test]
fn without_anti_aliasing_neighbours_fill_the_picture() {
    let smoothing = Smoothing {
        antialias: Antialias::Off,
        scale: 0.5,
    };
    let mut drawn = drawn_of(gpu(), ODD, smoothing);
    let truth = box_filtered(&drawn);
    drawn.draw(3);
    let first = drawn.radiance();
    drawn.draw(2);
    assert!(drawn.radiance() == first, "it does not tremble");
    let mut small = drawn_of(
        drawn.gpu.clone(),
        drawn.frame.rendered_size(),
        Antialias::Off,
    );
    small.draw(2);
    let copied = visibly_apart(&stretched(&small.radiance(), ODD), &truth);
    let filled = visibly_apart(&first, &truth);
    assert!(filled < copied, "{filled} {copied}");
}

/// Turns for some frames, and returns the error of the last picture over that of a picture of as many rays as pixels.
fn turned(gpu: Gpu) -> f64 {
    let mut drawn = upscaled(gpu, SIZE, 0.5);
    drawn.draw(60);
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
    let moves = "at += motion_of(place, nearest);";
    let wrong_place = "at += 0.0 * motion_of(place, nearest);";
    let wrong = turned(with_faults(
        &gpu,
        &[("view/antialias.wesl", moves, wrong_place)],
    ));
    let known = "if !is_known {";
    let forgotten = turned(with_faults(
        &gpu,
        &[("view/antialias.wesl", known, "if true {")],
    ));
    assert!(right < 1.4, "{right} {wrong} {forgotten}");
    assert!(wrong > 1.3 * right, "{wrong} {right}");
    assert!(forgotten > 1.1 * right, "{forgotten} {right}");
}

/// Jumps, and returns the error some frames later over that of a picture that began with the jump.
fn jumped(gpu: &Gpu) -> f64 {
    let mut jumped = upscaled(gpu.clone(), SIZE, 0.5);
    let mut fresh = upscaled(gpu.clone(), SIZE, 0.5);
    for drawn in [&mut jumped, &mut fresh] {
        drawn.draw(60);
        drawn.shot.camera.yaw_deg += 40.0;
        drawn.shot.camera.position.x += 3.0;
    }
    fresh.frame.restart_antialiasing();
    let truth = box_filtered(&jumped);
    for drawn in [&mut jumped, &mut fresh] {
        drawn.draw(8);
    }
    let [jumped, fresh] = [jumped, fresh].map(|drawn| apart(&drawn.radiance(), &truth));
    jumped / fresh
}

#[test]
fn a_camera_that_jumps_leaves_no_ghost() {
    let gpu = gpu();
    let right = jumped(&gpu);
    let moves = "at += motion_of(place, nearest);";
    let faults = [
        (
            "view/antialias.wesl",
            moves,
            "at += 0.0 * motion_of(place, nearest);",
        ),
        ("view/antialias.wesl", "if !is_known {", "if false {"),
        (
            "view/antialias.wesl",
            "if per_thread(history.clips, surface.y) == 1u {",
            "if per_thread(history.clips, surface.y) == 2u {",
        ),
    ];
    let wrong = jumped(&with_faults(&gpu, &faults));
    assert!(right < 1.3 && wrong > 2.0, "{right} {wrong}");
}

/// Digs into the sphere, and returns for these numbers of frames how much of the picture before is left where it changes: 0
/// is none, 1 all. Noise and edges do not count, unless they look like the picture before.
///
/// `restarts`: the history begins again with the edit.
fn ghosts(gpu: Gpu, frames: &[u32], restarts: bool) -> Vec<f64> {
    let mut drawn = upscaled(gpu, SIZE, 0.5);
    drawn.draw(120);
    let before = drawn.radiance();
    // World (6, 7, 2).
    let centre = Vec3::new(30.0, 15.0, 26.0);
    dig(&mut drawn, centre);
    if restarts {
        drawn.frame.restart_antialiasing();
    }
    let fresh = box_filter(&fine(&drawn, Some(centre)));
    let apart = |a: [f32; 3], b: [f32; 3]| Vec3::from(a) - Vec3::from(b);
    let mut drawn_since = 0;
    let mut left = |frame: u32| {
        drawn.draw(frame - drawn_since);
        drawn_since = frame;
        let now = drawn.radiance();
        let [mut change, mut alike] = [0.0, 0.0];
        for (index, now) in now.rgb.iter().enumerate() {
            let changed = apart(before.rgb[index], fresh.rgb[index]);
            if changed.abs().max_element() > 0.1 {
                change += changed.length_squared();
                alike += changed.dot(apart(*now, fresh.rgb[index]));
            }
        }
        assert!(change > 0.5, "{change}");
        f64::from(alike / change)
    };
    frames.iter().map(|&frame| left(frame)).collect()
}

#[test]
fn what_is_dug_leaves_no_ghost() {
    let gpu = gpu();
    let frames = [1, 4, 16];
    let right = ghosts(gpu.clone(), &frames, false);
    // Its pixels are filled from their neighbours, which look like the picture before.
    let fresh = ghosts(gpu.clone(), &frames, true);
    let found = "return surface.found && all(";
    let edited = "return history.clips == 2u && all(";
    let clips = "if per_thread(history.clips, surface.y) == 1u {";
    let faults = [
        ("view/history.wesl", found, edited),
        (
            "view/antialias.wesl",
            clips,
            "if per_thread(history.clips, surface.y) == 2u {",
        ),
    ];
    let wrong = ghosts(with_faults(&gpu, &faults), &frames, false);
    let told = format!("{right:?} {fresh:?} {wrong:?}");
    for (right, fresh) in right.iter().zip(&fresh) {
        assert!(right - fresh < 0.1, "{told}");
    }
    assert!(wrong[0] - fresh[0] > 0.4, "{told}");
}

/// Columns and rows of the middle of what a bit changes, and how many pixels that are.
fn middle_of_bit(mut drawn: Drawn) -> ([f64; 2], f64) {
    drawn.shot.view = View::Full;
    drawn.draw(40);
    let without = drawn.radiance();
    let bit = GpuBit {
        centre_ws: [0.0, 7.0, 8.0],
        half_size: 1.5,
        emission: [8.0; 3],
        flies: 1,
        ..Default::default()
    };
    drawn.frame.set_bits(&drawn.gpu, &[bit]).expect("fits");
    drawn.draw(3);
    let with = drawn.radiance();
    let mut sums = [0.0; 3];
    for (index, (a, b)) in without.rgb.iter().zip(&with.rgb).enumerate() {
        if b[1] > a[1] + 4.0 {
            let (x, y) = (index as u32 % with.width, index as u32 / with.width);
            for (sum, value) in sums.iter_mut().zip([f64::from(x), f64::from(y), 1.0]) {
                *sum += value;
            }
        }
    }
    drawn.frame.set_bits(&drawn.gpu, &[]).expect("fits");
    drawn.draw(1);
    let gone = drawn.radiance();
    assert!(
        gone.rgb.iter().all(|rgb| rgb[1] < 4.0),
        "a bit leaves no trace"
    );
    let [x, y, count] = sums;
    ([x / count, y / count], count)
}

#[test]
fn bits_are_where_they_are_at_full_scale() {
    let gpu = gpu();
    let (whole, whole_count) = middle_of_bit(drawn_of(gpu.clone(), SIZE, Antialias::Temporal));
    let (half, half_count) = middle_of_bit(upscaled(gpu, SIZE, 0.5));
    assert!(whole_count > 20.0, "{whole_count}");
    let told = format!("{whole:?} {whole_count}, {half:?} {half_count}");
    assert!((half_count / whole_count - 1.0).abs() < 0.3, "{told}");
    for axis in 0..2 {
        // Half of a rendered pixel.
        assert!((whole[axis] - half[axis]).abs() < 1.0, "{told}");
    }
}
