//! Storms: changes that come faster than any player makes them, and the conditions that must hold afterwards.
//! `docs/storms.md` describes each storm and its checks.

mod aftermath;
mod changes;
mod judge;
mod kinds;
mod report;
mod rig;
mod run;
mod soak;

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use clap::Args;

pub use self::{
    judge::Check,
    kinds::{Kind, Kinds},
    report::{FILE, StormRecord, table},
    rig::{Now, Scene},
    run::{Found, Length, Plan, Planted, run as run_plan},
    soak::{Footprint, Process, steady_growth},
};
use super::super::{
    Failure,
    options::{PictureOptions, RunOptions, Setup, picture_size},
    out_file::OutFile,
    output,
};
use crate::{gpu::Gpu, world::View};

/// The storms of a run, and their length.
#[derive(Args)]
pub struct StormOptions {
    /// Worlds of the storms [default: worlds/cave.ron]
    #[arg(value_name = "WORLD")]
    worlds: Vec<PathBuf>,
    /// Storm: 10 000 voxels a second are dug and filled. Storms that are named together run at the same time
    #[arg(long)]
    edit_storm: bool,
    /// Storm: probe layouts and parameters that rebuild the probes change
    #[arg(long)]
    layout_storm: bool,
    /// Storm: pictures of all sizes, down to one pixel
    #[arg(long)]
    resize_storm: bool,
    /// Storm: world time jumps
    #[arg(long)]
    time_storm: bool,
    /// Storm: the device is destroyed between frames, and drawing continues with a new one
    #[arg(long)]
    device_loss: bool,
    /// Mixed changes for N minutes, watching for memory that grows and frames that slow down
    #[arg(long, value_name = "MINUTES", value_parser = minutes, allow_negative_numbers = true)]
    soak: Option<f64>,
    /// Minutes of each storm [default: 1; with --soak, its minutes]
    #[arg(long, value_name = "M", value_parser = minutes, allow_negative_numbers = true, conflicts_with = "soak")]
    storm_minutes: Option<f64>,
    /// Frames of each storm, in place of minutes: the same seed then does exactly the same
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000),
          allow_negative_numbers = true, conflicts_with = "storm_minutes")]
    storm_frames: Option<u32>,
    /// Frames without a change after a storm, also of the pictures that it is compared with
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=100_000),
          allow_negative_numbers = true)]
    storm_settling: u32,
    /// Width and height in pixels of a storm's pictures
    #[arg(long, value_name = "WxH", default_value = "320x180", value_parser = picture_size, allow_hyphen_values = true)]
    storm_size: [u32; 2],
}

fn minutes(text: &str) -> Result<f64, String> {
    let value = text.parse().ok();
    let value = value.filter(|value: &f64| *value > 0.0 && *value <= 1e5);
    value.ok_or_else(|| "write minutes as a number above 0, at most 1e5".to_owned())
}

impl StormOptions {
    /// Whether any storm was requested.
    pub fn any(&self) -> bool {
        !self.kinds().is_empty()
    }

    fn kinds(&self) -> Kinds {
        let requested = [
            (self.edit_storm, Kind::Edit),
            (self.layout_storm, Kind::Layout),
            (self.resize_storm, Kind::Resize),
            (self.time_storm, Kind::Time),
            (self.device_loss, Kind::Loss),
            (self.soak.is_some(), Kind::Soak),
        ];
        let requested = requested.into_iter().filter(|(requested, _)| *requested);
        Kinds::new(&requested.map(|(_, kind)| kind).collect::<Vec<_>>())
    }

    fn length(&self) -> Length {
        match (self.storm_frames, self.storm_minutes.or(self.soak)) {
            (Some(frames), _) => Length::Frames(frames),
            (None, minutes) => Length::Minutes(minutes.unwrap_or(1.0)),
        }
    }

    /// The command that repeats the storm in one world, frame for frame.
    fn repeat(&self, world: &Path, seed: u32, frames: u32, run: &RunOptions) -> String {
        let mut words = vec!["grotto stress".to_owned()];
        for kind in self.kinds().iter() {
            words.push(match self.soak {
                Some(minutes) if kind == Kind::Soak => format!("--soak {minutes}"),
                _ => format!("--{}", kind.flag()),
            });
        }
        let [width, height] = self.storm_size;
        words.push(format!(
            "--storm-frames {frames} --storm-settling {} --storm-size {width}x{height} --seed {seed}",
            self.storm_settling
        ));
        words.extend(
            run.set
                .iter()
                .map(|assignment| format!("--set {assignment}")),
        );
        words.extend(run.adapter.iter().map(|name| format!("--adapter '{name}'")));
        words.push(format!("--out again {}", world.display()));
        words.join(" ")
    }
}

/// Runs the requested storms, all kinds at the same time, in one world after another, and writes [`FILE`] into
/// `out` after each world. Does nothing where no storm was requested. `stop` ends them early: then the last
/// record is not complete.
///
/// # Errors
/// For a world that cannot be read, and when the adapter fails. Failed checks are in the records: see
/// [`verdict`].
pub fn run(
    options: &StormOptions,
    seed: u32,
    out: &Path,
    run: &RunOptions,
    stop: &AtomicBool,
) -> Result<Vec<StormRecord>, Failure> {
    let kinds = options.kinds();
    if kinds.is_empty() {
        return Ok(Vec::new());
    }
    let earlier = out.join(report::FILE);
    if earlier.exists() {
        return Err(Failure::bad_input(format!(
            "{} holds the storms of another run: name another folder, or delete it",
            earlier.display()
        )));
    }
    let otherwise = [PathBuf::from("worlds/cave.ron")];
    let paths = if options.worlds.is_empty() {
        &otherwise[..]
    } else {
        &options.worlds
    };
    let picture = PictureOptions {
        size: options.storm_size,
        camera: None,
        layout: None,
        frames: None,
        time: None,
        seed,
        view: View::Full,
    };
    let scenes = paths
        .iter()
        .map(|path| Ok((path, Setup::load(path, run, &picture)?)))
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut file = OutFile::new(out, FILE)?;
    let mut records = Vec::new();
    for (path, picture) in scenes {
        let start = Now {
            layout: picture.layout,
            parameters: picture.parameters,
            size: options.storm_size,
            time_s: 0.0,
            camera: picture.camera,
            seed,
        };
        let scene = Scene {
            world: picture.world,
            lamps: picture.lamps,
        };
        let plan = Plan {
            scene: &scene,
            start,
            kinds: kinds.clone(),
            length: options.length(),
            settling: options.storm_settling,
            seed,
            planted: Planted::Nothing,
        };
        // Each world has a device of its own: what one world leaves behind must not count for the next.
        let gpu = open(run, records.is_empty())?;
        let bar = match plan.length {
            Length::Frames(frames) => output::progress(
                run,
                "frames",
                u64::from(frames) + 4 * u64::from(plan.settling),
            ),
            Length::Minutes(_) => output::spinner(run, "storm"),
        };
        let found = run_plan(gpu, &plan, stop, &bar)?;
        bar.finish_and_clear();
        let complete = found.complete;
        records.push(StormRecord {
            storm: kinds.to_string(),
            world: scene.world.name.clone(),
            seed,
            frames: found.frames,
            settling: plan.settling,
            size: options.storm_size,
            complete,
            changes: found.changes,
            checks: found.checks,
            repeat: options.repeat(path, seed, found.frames, run),
            measured: found.measured,
        });
        file.write_json(&records)?;
        if !complete {
            break;
        }
        file = OutFile::new(out, FILE)?;
    }
    Ok(records)
}

/// Opens the adapter; prints only once that it is a CPU.
fn open(run: &RunOptions, first: bool) -> Result<Gpu, Failure> {
    if first {
        return output::open_gpu(run);
    }
    Ok(Gpu::open(run.adapter.as_deref(), Default::default())?)
}

/// # Errors
/// When a check has failed, with the command that repeats it; and when a storm was stopped before its end.
pub fn verdict(records: &[StormRecord]) -> Result<(), Failure> {
    if let Some(failed) = report::verdict(records) {
        return Err(Failure::gate(failed));
    }
    if records.iter().any(|record| !record.complete) {
        return Err(Failure::interrupted(
            "stopped before the storm's end: the record says complete: false",
        ));
    }
    Ok(())
}
