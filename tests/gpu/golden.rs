//! The source's three worlds, drawn small, against golden pictures by FLIP (Andersson et al. 2020).
//!
//! `GROTTO_UPDATE_GOLDEN=1 cargo test --test gpu golden` makes the pictures again, in some minutes: look at them before
//! committing.
//!
//! Adapters round differently and light faces in another order, so the noise of their indirect light differs as that of
//! different seeds does. Three choices keep noise well below the threshold, which is for wrong pictures:
//! - The light has settled: the noise of faces falls with the rays of all frames. To average the pictures of the last
//!   frames would not help, because they share most of these rays.
//! - A golden picture is the mean of many seeds, so that only the noise of the tested picture counts.
//! - The seed of the tested picture is none of them: its difference is that of foreign noise, as on another adapter.

use std::path::Path;

use grotto::{
    gpu::Gpu,
    lights::Lights,
    measure::{picture::Picture, picture_file, tonemap::tone_mapped},
    parameters::ProbeParameters,
};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

use crate::support::{self, frames::Drawn, root};

/// Largest mean FLIP error of a picture.
const MOST_FLIP: f32 = 0.02;
/// Largest mean FLIP error that noise alone may cause: when the golden pictures are made, that of each seed.
const MOST_NOISE: f32 = 0.01;
/// Seeds whose mean a golden picture is; the next one is tested.
const SEEDS: u32 = 4;

/// A picture of a world, and what it takes to settle it.
struct Shown {
    world: &'static str,
    /// The name of the lamps.
    lamps: &'static str,
    size: [u32; 2],
    /// Rays per probe and frame.
    rays: u32,
    frames: u32,
}

impl Shown {
    /// Its last frame.
    fn drawn(&self, gpu: &Gpu, seed: u32) -> Drawn {
        let world = support::shipped(self.world);
        let probes = ProbeParameters {
            rays: self.rays,
            ..Default::default()
        };
        let layout = world.layouts.iter().find(|layout| layout.name == "layout1");
        let layout = layout.unwrap_or(&world.layouts[0]).clone();
        let lamps = world.lamp_presets.iter().find(|of| of.name == self.lamps);
        let lights = Lights::at(&world, lamps.expect("the world has these lamps"), 0.0);
        let mut drawn = Drawn::new(gpu.clone(), world, &layout, probes, self.size);
        drawn.lights = lights;
        drawn.shot.seed = seed;
        drawn.draw(self.frames);
        drawn
    }

    /// The golden picture: what light is on average over seeds.
    fn mean_of_seeds(&self, gpu: &Gpu) -> Picture {
        let drawn: Vec<Drawn> = (0..SEEDS).map(|seed| self.drawn(gpu, seed)).collect();
        let mut mean = drawn[0].radiance();
        for (seed, drawn) in (0..SEEDS).zip(&drawn) {
            for (mean, rgb) in mean.rgb.iter_mut().zip(drawn.radiance().rgb) {
                *mean = std::array::from_fn(|i| mean[i] + (rgb[i] - mean[i]) / (seed + 1) as f32);
            }
        }
        let golden = tone_mapped(&mean, 0.0);
        let noise = drawn.iter().map(|of| flip_mean(&displayed(of), &golden));
        let noise: Vec<f32> = noise.collect();
        println!("{}: the seeds have noise of FLIP {noise:.4?}", self.world);
        assert!(
            noise.iter().all(|noise| *noise <= MOST_NOISE),
            "the light has not settled: {noise:?}"
        );
        golden
    }

    fn compare(&self) {
        let gpu = support::gpu();
        let world = self.world;
        let path = root().join(format!("tests/golden/{world}.png"));
        if std::env::var_os("GROTTO_UPDATE_GOLDEN").is_some() {
            picture_file::write_png(&path, &self.mean_of_seeds(&gpu)).expect("writes");
        }
        let picture = displayed(&self.drawn(&gpu, SEEDS));
        let golden = read(&path);
        let difference = flip_mean(&picture, &golden);
        println!("{world}: FLIP {difference:.4}");
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
}

fn displayed(drawn: &Drawn) -> Picture {
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

/// With eight lamps indirect light comes from many places, and settles in half the frames that it takes with one lamp.
#[test]
fn cave() {
    let shown = Shown {
        world: "cave",
        lamps: "eight",
        size: [64, 36],
        rays: 256,
        frames: 320,
    };
    shown.compare();
}

#[test]
fn cornell() {
    let shown = Shown {
        world: "cornell",
        lamps: "one",
        size: [96, 54],
        rays: 128,
        frames: 256,
    };
    shown.compare();
}

#[test]
fn house() {
    let shown = Shown {
        world: "house",
        lamps: "both",
        size: [96, 54],
        rays: 128,
        frames: 280,
    };
    shown.compare();
}
