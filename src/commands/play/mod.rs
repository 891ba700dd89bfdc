//! `grotto play`: the window, and its records.

mod replay;

use std::{
    cell::Cell,
    path::{Path, PathBuf},
    sync::atomic::Ordering,
};

use clap::{Args, Parser as _};
use serde::Serialize;

use super::{
    Cli, Command, Failure,
    options::{
        InspectionOptions, OutputOptions, PictureOptions, RunOptions, Setup, assignment,
        check_view, picture_size, world_file,
    },
    output, stop,
};
use crate::{
    app::{
        self, AppError,
        quality::{Auto, Quality},
        record::{self, Record as Run},
        replay::ReplayOptions,
        saving::SaveOptions,
    },
    frame::begin_world,
    measure::whole_file,
    world::{
        View,
        save::{self, Folder, Save},
    },
};

/// The `--json` of a window that was closed.
#[derive(Serialize)]
struct Record {
    world: String,
    /// Frames that the window has shown.
    frames: u32,
}

const SIZE: [u32; 2] = [1280, 720];

/// Walk through a world in a window
#[derive(Args)]
pub struct Arguments {
    /// World file, read again whenever it is edited, or a save to go on from [default: the title screen, or the record's
    /// world]
    #[arg(value_parser = world_file())]
    world: Option<PathBuf>,
    /// Width and height of the window in pixels [default: 1280x720]; with --out of the pictures [default: those
    /// of the record]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    size: Option<[u32; 2]>,
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
    /// Work of a picture: low, medium, high, ultra; auto holds a frame time, and low+auto does so from low downwards
    /// [default: auto, from high downwards, or from low on a software adapter]
    #[arg(long, value_name = "NAME|auto", conflicts_with = "replay")]
    quality: Option<Quality>,
    /// The frame time that auto holds, in milliseconds [default: 16.7, or 150 on a software adapter]
    #[arg(long, value_name = "MS", value_parser = frame_time, conflicts_with = "replay")]
    frame_time: Option<f64>,
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
    /// Record all input into this file, so that the run can be played again
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Play a record: the same run, to the voxel
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["record", "camera", "layout", "set", "seed", "benchmark", "reference"])]
    replay: Option<PathBuf>,
    /// With --replay: no window; write the frames as pictures into this folder, and print figures
    #[arg(long, value_name = "DIR", requires = "replay", conflicts_with_all = ["frames", "shaders", "lose_device_at"])]
    out: Option<PathBuf>,
    /// With --out: frames per second of the record's time
    #[arg(long, value_name = "N", requires = "out", default_value_t = 60,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    fps: u32,
    /// With --out: write every N-th frame only; 0 for none
    #[arg(long, value_name = "N", requires = "out", default_value_t = 1)]
    every: u64,
    /// With --out: write what is heard into this file
    #[arg(long, value_name = "FILE.wav", requires = "out")]
    sound: Option<PathBuf>,
    /// Close the window after this many frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Destroy the device after this many frames, as a failing driver does
    #[arg(long, value_name = "N", hide = true)]
    lose_device_at: Option<u32>,
}

/// The window as a call without any argument opens it. Returns false where no window can be opened.
///
/// # Errors
/// Those of [`run`].
pub fn open() -> Result<bool, Failure> {
    let cli = Cli::try_parse_from(["grotto", "play"]).map_err(Failure::fault)?;
    let Some(Command::Play(arguments)) = cli.command else {
        return Ok(false);
    };
    if !app::has_display() {
        return Ok(false);
    }
    run(arguments).map(|()| true)
}

/// Accepts a time that a frame may take.
fn frame_time(text: &str) -> Result<f64, String> {
    let ms: f64 = text
        .parse()
        .map_err(|_| format!("`{text}` is no number of milliseconds"))?;
    if Auto::TARGETS_MS.contains(&ms) {
        Ok(ms)
    } else {
        Err(format!("a frame takes 1 to 1000 milliseconds, not {ms}"))
    }
}

impl Arguments {
    /// Whether the user is to choose a world: nothing was asked of a certain one.
    fn is_open(&self) -> bool {
        let asked = self.camera.is_some()
            || self.layout.is_some()
            || self.record.is_some()
            || self.replay.is_some()
            || self.benchmark
            || self.reference;
        self.world.is_none() && !asked
    }
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    check_files(&arguments)?;
    let mut run = RunOptions {
        adapter: arguments.adapter.clone(),
        set: arguments.set.clone(),
        json: arguments.output.json,
        quiet: arguments.output.quiet,
    };
    let (beginning, opened) = output::open_while(arguments.adapter.as_deref(), |shaders| {
        let beginning = beginning(&arguments, &mut run)?;
        check_view(arguments.view, &beginning.setup.parameters)?;
        begin_world(shaders, &beginning.setup.world);
        Ok(beginning)
    })?;
    let Beginning {
        setup,
        world_path,
        named_path,
        replay,
        seed,
    } = beginning;
    let inspection = arguments.inspection.with(arguments.view);
    if let (Some(replay), Some(folder)) = (replay.clone(), &arguments.out) {
        let options = ReplayOptions {
            world: setup.world,
            world_path: &world_path,
            parameters: setup.parameters,
            inspection,
            frames_per_s: arguments.fps,
            size: arguments.size,
            sound: arguments.sound.is_some(),
        };
        let film = replay::Film {
            folder: folder.clone(),
            every: arguments.every,
            sound: arguments.sound,
        };
        return replay::run(replay, options, &film, &run, opened.gpu);
    }
    let world = setup.world.name.clone();
    let camera = match &replay {
        Some(replay) => replay.header.camera(),
        None => setup.camera,
    };
    let recorded_world = match (&setup.save, &arguments.record) {
        (Some(save), Some(record)) => start_of(record, save, &world_path)?,
        _ => world_path.clone(),
    };
    let title = arguments.is_open();
    let stop = stop::at_ctrl_c(&run);
    let frames = app::run(app::Options {
        world_path,
        world: setup.world,
        parameters: setup.parameters,
        quality: arguments.quality,
        target_ms: arguments.frame_time,
        camera,
        layout: setup.layout.name,
        inspection,
        traced: arguments.reference,
        size: arguments.size,
        set: run.set,
        adapter: run.adapter,
        seed,
        shaders: arguments.shaders,
        title,
        benchmark: arguments.benchmark,
        frames: arguments.frames,
        recorded_world,
        saves: SaveOptions {
            folder: Folder::of_user(),
            automatic: replay.is_none(),
            continued: setup
                .save
                .filter(|_| replay.is_none())
                .map(|save| (named_path, save)),
        },
        record: arguments.record,
        replay,
        stop: stop.clone(),
        lose_device_at: arguments.lose_device_at,
        // Errors wait until there is a window that an adapter could show.
        opened: Cell::new(opened.gpu.ok()),
    })?;
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::interrupted("stopped"));
    }
    match run.json {
        true => output::print_json(&Record { world, frames }),
        false => Ok(()),
    }
}

/// Refuses what cannot work before any work is done.
fn check_files(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.shaders
        && !folder.join("view/shade.wesl").is_file()
    {
        return Err(Failure::bad_input(format!(
            "{} is no folder of shaders: it has no view/shade.wesl. \
             A checkout of grotto has them in shaders/.",
            folder.display()
        )));
    }
    if let Some(path) = &arguments.record {
        let file = whole_file::open(path)?;
        file.discard()
            .map_err(|reason| Failure::unwritten(path, reason))?;
    }
    Ok(())
}

/// What a run begins with.
struct Beginning {
    setup: Setup,
    /// The world file, which the window follows.
    world_path: PathBuf,
    /// The file that was named: the world's, or a save's.
    named_path: PathBuf,
    replay: Option<Run>,
    seed: u32,
}

/// Reads the record, and the world or the save. A record brings its own parameters into `run`.
fn beginning(arguments: &Arguments, run: &mut RunOptions) -> Result<Beginning, Failure> {
    let replay = arguments.replay.as_deref().map(Run::read).transpose()?;
    let (named_path, layout, seed) = match &replay {
        Some(replay) => {
            run.set.clone_from(&replay.header.set);
            let path = arguments.world.clone();
            (
                path.unwrap_or_else(|| replay.header.world.clone()),
                Some(replay.header.layout.clone()),
                replay.header.seed,
            )
        }
        None => (
            arguments.world.clone().map_or_else(app::title_world, Ok)?,
            arguments.layout.clone(),
            arguments.seed,
        ),
    };
    if let (Some(replay), Some(path)) = (&replay, &arguments.replay) {
        check_world(replay, path, &named_path)?;
        if let Some(cut) = &replay.cut {
            output::note(run, &format!("note: {cut}"));
        }
    }
    let picture = PictureOptions {
        size: arguments.size.unwrap_or(SIZE),
        camera: arguments.camera.clone(),
        layout,
        frames: None,
        time: None,
        seed,
        view: arguments.view,
    };
    let mut setup = Setup::load(&named_path, run, &picture)?;
    // What the save changed about the world file is in the world by now.
    let world_path = match &setup.save {
        Some(save) => save::world_file(&named_path, &save.head)?,
        None => named_path.clone(),
    };
    if replay.is_some() {
        // The record knows what was set, and its first moment sets the clock.
        setup.parameters = run.parameters()?;
    }
    if setup.save.is_some() {
        // Keys jump to the world's own cameras.
        setup
            .world
            .cameras
            .retain(|camera| camera.name != save::VIEW);
    }
    Ok(Beginning {
        setup,
        world_path,
        named_path,
        replay,
        seed,
    })
}

/// Keeps the save with which a recorded run begins, beside the record: the run goes on to write another.
fn start_of(record: &Path, save: &Save, world_file: &Path) -> Result<PathBuf, Failure> {
    let mut name = record.as_os_str().to_owned();
    name.push(".start.");
    name.push(save::EXTENSION);
    let path = PathBuf::from(name);
    let mut start = save.clone();
    start.belongs_to(world_file, &path);
    save::write(&path, &start)?;
    Ok(path)
}

/// A record plays in the very world that it was made in: in another, the player would walk into walls.
fn check_world(replay: &Run, path: &Path, world: &Path) -> Result<(), Failure> {
    if record::crc32_of(world)? == replay.header.world_crc32 {
        return Ok(());
    }
    Err(Failure::bad_input(format!(
        "{}:1: the record was made in another version of {}. Name the file that it was made with: \
         grotto play WORLD --replay {}",
        path.display(),
        world.display(),
        path.display()
    )))
}

impl From<AppError> for Failure {
    fn from(error: AppError) -> Self {
        match error {
            AppError::NoWindow(_) => Self::fault(error),
            AppError::Gpu(error) => error.into(),
            AppError::Frame(error) => error.into(),
            AppError::Record(error) => error.into(),
            AppError::Save(error) => error.into(),
        }
    }
}
