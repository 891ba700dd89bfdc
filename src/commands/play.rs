//! `grotto play`: the window.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    Failure,
    options::{
        InspectionOptions, OutputOptions, PictureOptions, RunOptions, Setup, assignment,
        picture_size,
    },
    output,
};
use crate::{
    app::{self, AppError},
    world::View,
};

/// The `--json` of a window that was closed.
#[derive(Serialize)]
struct Record {
    world: String,
    /// Frames that the window has shown.
    frames: u32,
}

/// Fly through a world in a window
#[derive(Args)]
pub struct Arguments {
    /// World file; read again whenever it is edited
    #[arg(default_value = "worlds/cave.ron")]
    world: PathBuf,
    /// Width and height of the window in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = picture_size)]
    size: [u32; 2],
    /// One of the world's cameras to start at [default: its first]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// One of the world's probe layouts [default: its first]
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// What the picture shows
    #[arg(long, value_name = "VIEW", value_enum, default_value_t)]
    view: View,
    #[command(flatten)]
    inspection: InspectionOptions,
    /// Start with the path-traced reference (F6), and with time paused
    #[arg(long)]
    reference: bool,
    /// Start with the benchmark (F4)
    #[arg(long, conflicts_with = "reference")]
    benchmark: bool,
    /// Set a parameter (repeatable); `grotto info --keys` lists them
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    set: Vec<String>,
    /// Use the adapter whose name contains this [default: the fastest]; NAME#2 is the second of several with
    /// the same name
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Seed of the random rays; the world's own is `--set world.seed=N`
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Read the shaders from this folder, and again whenever they are edited
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
    /// Close the window after this many frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Destroy the device after this many frames, as a failing driver does
    #[arg(long, value_name = "N", hide = true)]
    lose_device_at: Option<u32>,
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.shaders
        && !folder.join("view/shade.wesl").is_file()
    {
        return Err(Failure::bad_input(format!(
            "{} is no folder of shaders: it has no view/shade.wesl. \
             A checkout of grotto has them in shaders/.",
            folder.display()
        )));
    }
    let run = RunOptions {
        adapter: arguments.adapter,
        set: arguments.set,
        json: arguments.output.json,
        quiet: arguments.output.quiet,
    };
    let picture = PictureOptions {
        size: arguments.size,
        camera: arguments.camera,
        layout: arguments.layout,
        frames: None,
        time: 0.0,
        seed: arguments.seed,
        view: arguments.view,
    };
    let setup = Setup::load(&arguments.world, &run, &picture)?;
    let world = setup.world.name.clone();
    let frames = app::run(app::Options {
        world_path: arguments.world,
        world: setup.world,
        parameters: setup.parameters,
        camera: setup.camera,
        layout: setup.layout.name,
        inspection: arguments.inspection.with(arguments.view),
        traced: arguments.reference,
        size: arguments.size,
        adapter: run.adapter,
        seed: arguments.seed,
        shaders: arguments.shaders,
        benchmark: arguments.benchmark,
        frames: arguments.frames,
        lose_device_at: arguments.lose_device_at,
    })?;
    match run.json {
        true => output::print_json(&Record { world, frames }),
        false => Ok(()),
    }
}

impl From<AppError> for Failure {
    fn from(error: AppError) -> Self {
        match error {
            AppError::NoWindow(_) => Self::fault(error),
            AppError::Gpu(error) => error.into(),
            AppError::Frame(error) => error.into(),
        }
    }
}
