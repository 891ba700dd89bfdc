//! More samples make less noise, and no sample is lost in long sums or when rendering stops early.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, UVec3};
use grotto::gpu::ShaderChecks;
use grotto::measure::picture::Picture;
use grotto::reference::FilmOptions;
use grotto::world::View;

use super::super::pictures::room;
use super::super::stage::{Cpu, Stage, Tracer, options, square_camera, uniform_sky};
use super::OnGpu;

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
fn long_sums_lose_nothing_and_chunks_change_nothing() {
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

    // Dispatch chunks depend on the clock and so differ between runs; the picture does not.
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
