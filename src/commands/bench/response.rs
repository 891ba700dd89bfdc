//! `grotto bench response`: how fast light follows a change.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    super::{
        Failure,
        dynamics::{self, Responses, WATCHED_FRAMES},
        frame_loop::FrameLoop,
        options::RunOptions,
        output,
        settings::Setting,
        test_case::{TestCase, TestCaseOptions},
    },
    light_suite::LightSuite,
};
use crate::{frame::Stage, gpu::Gpu};

/// Frames until bounced light has followed a change of a lamp or a wall
///
/// A lamp is switched on and off, and moved; a wall is opened and closed. A world file names the lamp and the
/// wall under `response`. Without that entry, the defaults are: the first lamp (or the sun, where there is
/// none); half of the free distance towards the camera, at most eight voxels; a sphere of radius 3 where the
/// camera's central ray hits. After each change, frames are counted until the indirect light has made 90 % and
/// 99 % of its change for good. The settled value is the mean of the last quarter of the frames that are
/// watched. Without WORLD the Cornell box is measured.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    subjects: TestCaseOptions,
    /// Frames to watch after each change
    #[arg(long, value_name = "N", default_value_t = WATCHED_FRAMES, value_parser = clap::value_parser!(u32).range(16..=100_000))]
    response_frames: u32,
    /// Also write response.json into this folder, created if it does not exist
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
    /// Frames before each change.
    frames: u32,
    response: Responses,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.subjects;
    let suite = LightSuite {
        name: "response",
        subjects: options,
        run: &arguments.run,
        out: arguments.out.as_deref(),
        otherwise: "worlds/cornell.ron",
        size: None,
    };
    suite.run(
        |gpu, case| measure(gpu, case, arguments),
        |adapter, rows| {
            let rows: String = rows.iter().map(lines).collect();
            format!("{adapter}, frames to 90 % · 99 %\n{rows}")
        },
    )
}

fn measure(gpu: &Gpu, case: &TestCase, arguments: &Arguments) -> Result<Vec<Row>, Failure> {
    let (options, run) = (&arguments.subjects, &arguments.run);
    let world = &case.world;
    let stage = Stage::build(gpu, world)?;
    let shot = case.shot(&case.cameras[0]);
    let mut frame_loop = FrameLoop::new(gpu, stage, &case.layouts[0], &case.parameters, shot)?;
    let mut rows = Vec::new();
    for camera in &case.cameras {
        for layout in &case.layouts {
            for setting in &case.settings {
                let probes = setting.of(&case.parameters).probes;
                frame_loop.replace_probes(layout, &probes)?;
                let frames = [options.frames, arguments.response_frames];
                let length = Responses::frames(frames[0], frames[1]);
                let bar = output::progress(run, "frames", length);
                let after = || bar.inc(1);
                let response = dynamics::responses(&mut frame_loop, case, camera, frames, &after)?;
                bar.finish_and_clear();
                rows.push(Row {
                    world: world.name.clone(),
                    camera: camera.name.clone(),
                    layout: layout.name.clone(),
                    settings: setting.clone(),
                    rays: probes.rays,
                    hysteresis: probes.hysteresis,
                    frames: options.frames,
                    response,
                });
            }
        }
    }
    Ok(rows)
}

fn lines(row: &Row) -> String {
    let mut text = format!(
        "{} · {} · {}, {} rays, hysteresis {}{}\n",
        row.world,
        row.camera,
        row.layout,
        row.rays,
        row.hysteresis,
        row.settings.note()
    );
    for (name, response) in Responses::NAMES.iter().zip(row.response.all()) {
        let name = name.replace('_', " ");
        let figures = match response {
            None => "nothing to follow".to_owned(),
            Some(response) => {
                let frames = |count: Option<u32>| match count {
                    Some(count) => count.to_string(),
                    None => format!("more than {}", response.watched),
                };
                format!("{} · {}", frames(response.to_90), frames(response.to_99))
            }
        };
        text += &format!("  {name:<12}  {figures}\n");
    }
    text
}
