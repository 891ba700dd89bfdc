//! Upscaling by the history of anti-aliasing: at rest against a box filter of the shown pixels, in motion and after edits
//! against pictures without history.

use glam::Vec3;
use grotto::{
    frame::Smoothing,
    gpu::{Gpu, Recorder},
    measure::{flip::flip, picture::Picture, tonemap::tone_mapped},
    parameters::Antialias,
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
        drawn.draw(400);
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
        small.draw(160);
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
    assert!(right < 1.5, "{right} {wrong} {forgotten}");
    assert!(wrong > 1.3 * right, "{wrong} {right}");
    assert!(forgotten > 1.1 * right, "{forgotten} {right}");
}

/// Digs into the sphere, and returns how far the pixels that change are from a fresh picture some frames later, relative
/// to the change.
fn ghosts(gpu: Gpu, frames: u32) -> f64 {
    let mut drawn = upscaled(gpu, SIZE, 0.5);
    drawn.draw(120);
    let before = drawn.radiance();
    // World (6, 7, 2).
    let centre = Vec3::new(30.0, 15.0, 26.0);
    dig(&mut drawn, centre);
    drawn.draw(frames);
    let after = drawn.radiance();
    let fresh = box_filter(&fine(&drawn, Some(centre)));
    let change = |a: [f32; 3], b: [f32; 3]| {
        let each = a.into_iter().zip(b).map(|(a, b)| f64::from((a - b).abs()));
        each.sum::<f64>()
    };
    let [mut dug, mut left] = [0.0, 0.0];
    for (index, now) in after.rgb.iter().enumerate() {
        let changed = change(before.rgb[index], fresh.rgb[index]);
        if changed > 0.1 {
            dug += changed;
            left += change(*now, fresh.rgb[index]);
        }
    }
    assert!(dug > 2.0, "{dug}");
    left / dug
}

#[test]
fn what_is_dug_leaves_no_ghost() {
    let gpu = gpu();
    let right = [1, 16].map(|frames| ghosts(gpu.clone(), frames));
    let found = "return surface.found && all(";
    let edited = "return history.clips == 2u && all(";
    let clips = "if history.clips == 1u {";
    let faults = [
        ("view/antialias.wesl", found, edited),
        ("view/antialias.wesl", clips, "if history.clips == 2u {"),
    ];
    let wrong = [1, 16].map(|frames| ghosts(with_faults(&gpu, &faults), frames));
    assert!(right[0] < 0.6 && right[1] < 0.15, "{right:?} {wrong:?}");
    assert!(
        wrong[0] > 0.8 && wrong[1] > 2.0 * right[1],
        "{right:?} {wrong:?}"
    );
}
