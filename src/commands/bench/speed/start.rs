//! How long a player waits: from the start of a process to its first frame, its first picture, and settled
//! light.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
    time::{SystemTime, UNIX_EPOCH},
};

use clap::Args;
use serde::{Deserialize, Serialize};

use super::{
    super::{
        super::{
            Failure,
            options::{PictureOptions, RunOptions, Setup},
            output,
        },
        model::Figure,
    },
    spec::{RowSpec, changed},
};
use crate::{
    frame::{Frame, Stage, begin_world},
    gpu::{Recorder, Timing},
    lights::Lights,
    measure::frame_times::Interval,
    passes::view::Shot,
    world::View,
};

/// Frames after which light is settled.
const SETTLED: u32 = 400;

/// One start, measured by the process that starts: what `grotto bench start` runs again and again
#[derive(Args)]
pub struct Arguments {
    /// World file
    world: PathBuf,
    /// When the process was started, in nanoseconds since 1970
    #[arg(long, value_name = "NS")]
    since: u64,
    /// Frames until light counts as settled
    #[arg(long, value_name = "N", default_value_t = SETTLED)]
    settled: u32,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    run: RunOptions,
}

/// Milliseconds since the process was started.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Milestones {
    /// The world is read; beside it the adapter opens.
    loaded_ms: f64,
    /// The adapter is open.
    opened_ms: f64,
    /// The world's voxels are on the adapter.
    built_ms: f64,
    /// The passes are compiled, and their buffers made.
    made_ms: f64,
    /// The first frame is done.
    first_frame_ms: f64,
    /// The first frame's picture has been read back.
    first_picture_ms: f64,
    /// The light has settled.
    settled_ms: f64,
}

fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_nanos() as u64)
}

/// Runs in the started process.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let elapsed_ms = || now_ns().saturating_sub(arguments.since) as f64 / 1e6;
    let picture = &arguments.picture;
    let run = &arguments.run;
    let ((scene, loaded_ms), opened) = output::open_while(run.adapter.as_deref(), |shaders| {
        let scene = Setup::load(&arguments.world, run, picture)?;
        begin_world(shaders, &scene.world);
        Ok((scene, elapsed_ms()))
    })?;
    let opened_ms = elapsed_ms() - opened.at.elapsed().as_secs_f64() * 1e3;
    let gpu = output::usable(run, opened.gpu)?;
    let stage = Stage::build(&gpu, &scene.world)?;
    let built_ms = elapsed_ms();
    let probes = &scene.parameters.probes;
    let mut frame = Frame::new(&gpu, stage, &scene.layout, probes, picture.size)?;
    let made_ms = elapsed_ms();
    let lights = Lights::at(&scene.world, &scene.lamps, scene.lamp_time_s);
    // As in the window: without timings, the frame's dispatches would stay cut into chunks.
    let mut timing = Timing::new(&gpu)?;
    let mut step = |frame: &mut Frame| {
        let shot = Shot {
            camera: scene.camera.clone(),
            size: picture.size,
            frame: frame.frames(),
            seed: picture.seed,
            exposure_ev: scene.parameters.picture.exposure_ev,
            view: View::Full,
            time_s: scene.time_s,
            textures: scene.parameters.textures.enabled,
            soft_rays: scene.parameters.lights.soft_rays,
            shadows: scene.parameters.lights.shadows,
        };
        let mut recorder = Recorder::new(&gpu, Some(&mut timing));
        frame.record(&gpu, &mut recorder, &shot, &lights, probes);
        recorder.submit(&gpu)?;
        gpu.wait()?;
        while timing.next_frame().is_some() {}
        Ok::<(), Failure>(())
    };
    step(&mut frame)?;
    let first_frame_ms = elapsed_ms();
    frame.read_display(&gpu)?;
    let first_picture_ms = elapsed_ms();
    for _ in 1..arguments.settled {
        step(&mut frame)?;
    }
    let settled_ms = elapsed_ms();
    output::print_json(&Milestones {
        loaded_ms,
        opened_ms,
        built_ms,
        made_ms,
        first_frame_ms,
        first_picture_ms,
        settled_ms,
    })
}

/// Starts this program several times for a row, and returns the mean of each milestone with its interval. An
/// earlier start does not count: it fills the driver's shader cache.
///
/// # Errors
/// When a start fails, with its error output.
pub fn measure(
    spec: &RowSpec,
    path: &Path,
    adapter: &str,
    (starts, settled): (u32, u32),
) -> Result<BTreeMap<String, Figure>, Failure> {
    let own = std::env::current_exe().map_err(Failure::fault)?;
    let mut all: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for index in 0..=starts {
        let mut command = Command::new(&own);
        command.args(["bench", "one-start"]).arg(path);
        command.args(["--adapter", adapter, "--json", "--quiet"]);
        command.args(["--camera", &spec.camera.name, "--layout", &spec.layout.name]);
        let [width, height] = spec.size;
        command.args(["--size", &format!("{width}x{height}")]);
        command.args(["--settled", &settled.to_string()]);
        for set in changed(&spec.parameters) {
            command.args(["--set", &set]);
        }
        command.args(["--since", &now_ns().to_string()]);
        let output = command.output().map_err(Failure::fault)?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(Failure::fault(format!("a start fails: {}", text.trim())));
        }
        let milestones: Milestones =
            serde_json::from_slice(&output.stdout).map_err(Failure::fault)?;
        for (name, ms) in [
            ("world_loaded_ms", milestones.loaded_ms),
            ("adapter_open_ms", milestones.opened_ms),
            ("world_built_ms", milestones.built_ms),
            ("passes_made_ms", milestones.made_ms),
            ("first_frame_ms", milestones.first_frame_ms),
            ("first_picture_ms", milestones.first_picture_ms),
            ("settled_ms", milestones.settled_ms),
        ] {
            if index > 0 {
                all.entry(name).or_default().push(ms);
            }
        }
    }
    let figures = all.into_iter().filter_map(|(name, values)| {
        let interval = Interval::of(&values)?;
        let figure = Figure {
            value: interval.mean,
            half_width: interval.half_width,
        };
        Some((name.to_owned(), figure))
    });
    Ok(figures.collect())
}
