//! `grotto bench stability`: how steady the picture of a scene at rest is, by rays per probe.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    super::{
        Failure,
        dynamics::{self, STILL_FRAMES},
        frame_loop::FrameLoop,
        options::RunOptions,
        output,
        settings::Setting,
        test_case::{TestCase, TestCaseOptions},
    },
    light_suite::LightSuite,
};
use crate::{frame::Stage, gpu::Gpu, measure::stability::Stability};

/// Change of a pixel between consecutive frames of a scene at rest, by rays per probe
///
/// The sum over RGB of the absolute difference of the tone-mapped picture, in [0, 3], over fifty
/// frames after the probes have settled. Pixels that show no surface never change: choose a view
/// without them. Without WORLD the Cornell box is measured.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    subjects: TestCaseOptions,
    /// Also write stability.json into this folder, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunOptions,
}

#[derive(Serialize)]
struct Row {
    world: String,
    camera: String,
    layout: String,
    settings: Setting,
    rays: u32,
    hysteresis: f32,
    /// Frames before the first picture.
    frames: u32,
    stability: Stability,
}

/// Rays where the user neither names a number nor varies anything else.
const USUAL_RAYS: [u32; 6] = [8, 16, 32, 64, 128, 256];

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut options = arguments.subjects.clone();
    let sets_rays = |assignment: &String| assignment.starts_with("probes.rays=");
    if options.varied()?.is_empty() && !arguments.run.set.iter().any(sets_rays) {
        options.rays = USUAL_RAYS.to_vec();
    }
    let options = &options;
    let suite = LightSuite {
        name: "stability",
        subjects: options,
        run: &arguments.run,
        out: arguments.out.as_deref(),
        otherwise: "worlds/cornell.ron",
        size: Some(options.size),
    };
    suite.run(
        |gpu, case| measure(gpu, case, options, &arguments.run),
        |adapter, rows| {
            let [width, height] = options.size;
            let mut text = format!(
                "{adapter}, {width} × {height}, {STILL_FRAMES} frames; change of a pixel, sum over RGB\n"
            );
            for row in rows {
                let Stability { mean, p99, max, .. } = row.stability;
                text += &format!(
                    "{} · {} · {}  {:>4} rays, hysteresis {}{}:  mean {mean:.5}  p99 {p99:.4}  max {max:.4}\n",
                    row.world,
                    row.camera,
                    row.layout,
                    row.rays,
                    row.hysteresis,
                    row.settings.note()
                );
            }
            text
        },
    )
}

fn measure(
    gpu: &Gpu,
    case: &TestCase,
    options: &TestCaseOptions,
    run: &RunOptions,
) -> Result<Vec<Row>, Failure> {
    let shot = case.shot(&case.cameras[0]);
    let (world, layout) = (&case.world, &case.layouts[0]);
    let stage = Stage::build(gpu, world)?;
    let mut frame_loop = FrameLoop::new(gpu, stage, layout, &case.parameters, shot.clone())?;
    let each = u64::from(options.frames + STILL_FRAMES);
    let count = case.cameras.len() * case.layouts.len() * case.settings.len();
    let bar = output::progress(run, "frames", each * count as u64);
    let mut rows = Vec::new();
    for camera in &case.cameras {
        frame_loop.look(camera, shot.view);
        for layout in &case.layouts {
            for setting in &case.settings {
                let probes = setting.of(&case.parameters).probes;
                frame_loop.replace_probes(layout, &probes)?;
                let after = || bar.inc(1);
                frame_loop.advance(&case.lights, options.frames, &after)?;
                rows.push(Row {
                    world: world.name.clone(),
                    camera: camera.name.clone(),
                    layout: layout.name.clone(),
                    settings: setting.clone(),
                    rays: probes.rays,
                    hysteresis: probes.hysteresis,
                    frames: options.frames,
                    stability: dynamics::stability(&mut frame_loop, &case.lights, &after)?,
                });
            }
        }
    }
    bar.finish_and_clear();
    Ok(rows)
}
