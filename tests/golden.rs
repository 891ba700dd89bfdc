//! The source's three worlds, drawn small, against golden pictures by FLIP (Andersson et al. 2020).
//!
//! `GROTTO_UPDATE_GOLDEN=1 cargo test --test golden` writes the pictures anew: look at them before
//! committing. The threshold allows for another driver's rounding, not for another picture.

use std::path::{Path, PathBuf};

use grotto::{
    frame::{Frame, Stage},
    gpu::{Gpu, Recorder, ShaderChecks},
    lights::Lights,
    measure::{picture::Picture, picture_file},
    parameters::Parameters,
    passes::view::{View, ViewMode},
    world::file,
};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

const SIZE: [u32; 2] = [192, 108];
const FRAMES: u32 = 48;
/// Mean FLIP that a picture may differ by.
const MOST_FLIP: f32 = 0.02;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn draw(world: &str) -> Picture {
    let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need a Vulkan device");
    let path = root().join(format!("worlds/{world}.ron"));
    let world = file::load(&path, &file::Overrides::default()).expect("a shipped world loads");
    let stage = Stage::build(&gpu, &world).expect("a shipped world fits");
    let mut parameters = Parameters::default();
    parameters.probes.rays = 64;
    let layout = world.layouts.iter().find(|layout| layout.name == "layout1");
    let layout = layout.unwrap_or(&world.layouts[0]);
    let mut frame = Frame::new(&gpu, stage, layout, &parameters.probes, SIZE).expect("fits");
    let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
    for index in 0..FRAMES {
        let view = View {
            camera: world.cameras[0].clone(),
            size: SIZE,
            frame: index,
            seed: 0,
            exposure_ev: 0.0,
            mode: ViewMode::Full,
            time_s: 0.0,
            textures: true,
        };
        let mut recorder = Recorder::new(&gpu, None);
        frame.record(&gpu, &mut recorder, &view, &lights, &parameters.probes);
        recorder.submit(&gpu).expect("submits");
        gpu.wait().expect("the device lives");
    }
    frame.read_display(&gpu).expect("reads back")
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
