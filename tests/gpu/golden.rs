//! The source's three worlds, drawn small, against golden pictures by FLIP (Andersson et al. 2020).
//!
//! `GROTTO_UPDATE_GOLDEN=1 cargo test --test gpu golden` writes the pictures again: look at them before
//! committing. The threshold allows for another driver's rounding, not for another picture.

use std::path::Path;

use grotto::{
    measure::{picture::Picture, picture_file},
    parameters::ProbeParameters,
};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

use crate::support::{self, frames::Drawn, root};

const SIZE: [u32; 2] = [192, 108];
const FRAMES: u32 = 48;
/// Largest mean FLIP error of a picture.
const MOST_FLIP: f32 = 0.02;

fn draw(world: &str) -> Picture {
    let world = support::shipped(world);
    let probes = ProbeParameters {
        rays: 64,
        ..Default::default()
    };
    let layout = world.layouts.iter().find(|layout| layout.name == "layout1");
    let layout = layout.unwrap_or(&world.layouts[0]).clone();
    let mut drawn = Drawn::new(support::gpu(), world, &layout, probes, SIZE);
    drawn.draw(FRAMES);
    drawn.frame.read_display(&drawn.gpu).expect("reads back")
}

fn flip_mean(picture: &Picture, golden: &Picture) -> f32 {
    let image = |picture: &Picture| {
        let bytes: Vec<u8> = picture
            .rgb
            .iter()
            .flat_map(|rgb| rgb.map(|value| (value * 255.0).round() as u8))
            .collect();
        FlipImageRgb8::with_data(picture.width, picture.height, &bytes)
    };
    let map = flip(image(golden), image(picture), DEFAULT_PIXELS_PER_DEGREE);
    FlipPool::from_image(&map).mean()
}

fn compare(world: &str) {
    let picture = draw(world);
    let path = root().join(format!("tests/golden/{world}.png"));
    if std::env::var_os("GROTTO_UPDATE_GOLDEN").is_some() {
        picture_file::write_png(&path, &picture).expect("writes");
    }
    let golden = read(&path);
    let difference = flip_mean(&picture, &golden);
    assert!(
        difference <= MOST_FLIP,
        "{world} differs from {} by FLIP {difference}",
        path.display()
    );
    // The gate is worth something only if it catches what a broken renderer would show.
    let darkened = changed(&picture, |picture, i| {
        picture.rgb[i].map(|value| value * 0.85)
    });
    let shifted = changed(&picture, |picture, i| picture.rgb[i.saturating_sub(2)]);
    let swapped = changed(&picture, |picture, i| {
        let [r, g, b] = picture.rgb[i];
        [b, g, r]
    });
    for (fault, wrong) in [
        ("darkened", darkened),
        ("shifted", shifted),
        ("swapped", swapped),
    ] {
        let difference = flip_mean(&wrong, &golden);
        assert!(
            difference > MOST_FLIP,
            "{world} {fault} passes with {difference}"
        );
    }
}

fn read(path: &Path) -> Picture {
    let (picture, _) = picture_file::read(path).unwrap_or_else(|error| panic!("{error}"));
    picture
}

fn changed(picture: &Picture, change: impl Fn(&Picture, usize) -> [f32; 3]) -> Picture {
    let mut wrong = picture.clone();
    for i in 0..wrong.rgb.len() {
        wrong.rgb[i] = change(picture, i);
    }
    wrong
}

#[test]
fn cave() {
    compare("cave");
}

#[test]
fn cornell() {
    compare("cornell");
}

#[test]
fn house() {
    compare("house");
}
