//! `grotto reference`: path-traced ground truth on the GPU, with as many samples as the user waits for.

mod identity;
mod part;

use std::{path::PathBuf, sync::atomic::AtomicBool, time::Instant};

use clap::Args;
use serde::Serialize;

pub(super) use self::{
    identity::{content, sources},
    part::{COMMAND, merge},
};
use super::{
    Failure, memory,
    options::{PictureOptions, RunOptions, Setup, world_file},
    output, render,
    shard::Shard,
    stop,
};
use crate::{
    frame::{Stage, TraceRequest, trace},
    gpu::{AdapterSummary, Gpu},
    lights::Lights,
    measure::picture_file::{self, PictureFormat},
    passes::path_trace::trace::PathTrace,
    world::View,
};

/// Path-trace a picture on the GPU, as ground truth; Ctrl-C writes the picture so far and exits with 130
#[derive(Args)]
pub struct Arguments {
    /// World file (worlds/*.ron)
    #[arg(value_parser = world_file())]
    world: PathBuf,
    /// The picture to write: .png (tone-mapped) or .exr (linear)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Samples (paths) per pixel: noise falls with the square root, time grows in proportion
    #[arg(long, value_name = "N", default_value_t = 256, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=i64::from(PathTrace::MOST_SAMPLES)))]
    spp: u32,
    /// Spread the samples over each pixel; else all pass through its centre, as in `render`
    #[arg(long)]
    antialias: bool,
    /// Only part I of N of the samples, written beside the picture; `grotto merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    run: RunOptions,
}

/// The `--json` of a picture.
#[derive(Serialize)]
struct Record {
    world: String,
    camera: String,
    view: String,
    /// Width and height in pixels.
    size: [u32; 2],
    /// Samples that every pixel has, and the number that was requested.
    spp: u32,
    spp_wanted: u32,
    /// Which part of the samples, if not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<Shard>,
    antialias: bool,
    adapter: AdapterSummary,
    /// From the voxels to the picture.
    seconds: f64,
    /// Millions of paths a second.
    mpaths_per_s: f64,
    /// Exposed faces of emissive voxels.
    emitters: usize,
}

/// A scene on its adapter, ready for tracing.
struct Job<'a> {
    arguments: &'a Arguments,
    scene: &'a Setup,
    gpu: &'a Gpu,
    stage: Stage,
    lights: Lights,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (options, run) = (&arguments.picture, &arguments.run);
    let format = match arguments.shard {
        None => picture_file::check_writable(&arguments.output)?,
        Some(_) => PictureFormat::of(&arguments.output)?,
    };
    let pixels = options.size.map(u64::from).iter().product::<u64>();
    let (scene, gpu) = output::load_and_open(run, || {
        let scene = Setup::load(&arguments.world, run, options)?;
        render::check_traceable(options.view)?;
        render::note_without_probes(options, run, "`reference`");
        // Memory: sums that are read back, at most eight sums of many blocks, and the picture with its bytes.
        memory::check(
            "a picture of this size",
            pixels * (3 * PathTrace::BYTES_PER_PIXEL + 8 * 12 + 24),
        )?;
        Ok(scene)
    })?;
    let cancel = stop::at_ctrl_c(run);
    gpu.check_buffer(
        "a picture of this size",
        pixels * PathTrace::BYTES_PER_PIXEL,
    )?;
    let lights = Lights::at(&scene.world, &scene.lamps, scene.lamp_time_s);
    let part = arguments.shard.map(|shard| {
        let head = part::head(arguments, &scene, &lights, &gpu, shard)?;
        part::file(&arguments.output, head)
    });
    let part = part.transpose()?;
    let spinner = output::spinner(run, render::VOXELISING);
    let stage = Stage::build(&gpu, &scene.world)?;
    spinner.finish_and_clear();
    let job = Job {
        arguments,
        scene: &scene,
        gpu: &gpu,
        stage,
        lights,
    };
    match part {
        None => job.whole(format, &cancel),
        Some(file) => part::run(&job, file, &cancel),
    }
}

impl Job<'_> {
    fn request(&self) -> TraceRequest<'_> {
        let options = &self.arguments.picture;
        TraceRequest {
            camera: &self.scene.camera,
            size: options.size,
            view: options.view,
            spp: self.arguments.spp,
            seed: options.seed,
            time_s: self.scene.time_s,
            textures: self.scene.parameters.textures.enabled,
            antialias: self.arguments.antialias,
        }
    }

    fn whole(&self, format: PictureFormat, cancel: &AtomicBool) -> Result<(), Failure> {
        let (arguments, run) = (self.arguments, &self.arguments.run);
        let start = Instant::now();
        let bar = output::progress(run, "tiles × samples", 1);
        let progress = |done, total| {
            bar.set_length(total);
            bar.set_position(done);
        };
        let request = self.request();
        let traced = trace(
            self.gpu,
            &self.stage,
            &self.lights,
            &request,
            &progress,
            cancel,
        )?;
        let seconds = start.elapsed().as_secs_f64();
        bar.finish_and_clear();
        if traced.spp == 0 {
            return Err(Failure::interrupted(format!(
                "stopped before every pixel had its first sample: {} is not written",
                arguments.output.display()
            )));
        }
        let mut picture = traced.picture;
        if arguments.picture.view == View::Depth {
            render::show_depth(&mut picture);
        }
        let exposure_ev = self.scene.parameters.picture.exposure_ev;
        render::store(
            &arguments.output,
            &picture,
            arguments.picture.view,
            exposure_ev,
        )?;
        let record = self.record(traced.spp, None, seconds);
        if run.json {
            output::print_json(&record)?;
        } else {
            self.tell(&record, format);
        }
        if record.spp < record.spp_wanted {
            return Err(Failure::interrupted(format!(
                "stopped: {} holds {} of {} samples a pixel",
                arguments.output.display(),
                record.spp,
                record.spp_wanted
            )));
        }
        Ok(())
    }

    fn tell(&self, record: &Record, format: PictureFormat) {
        let linear = match format {
            PictureFormat::Png => "tone-mapped",
            PictureFormat::Exr => "linear",
        };
        output::note(
            &self.arguments.run,
            &format!(
                "{} ({linear}): {} samples a pixel, {}",
                self.arguments.output.display(),
                record.spp,
                record.speed()
            ),
        );
    }

    /// `spp`: the number of samples that were traced.
    fn record(&self, spp: u32, shard: Option<Shard>, seconds: f64) -> Record {
        let (arguments, options) = (self.arguments, &self.arguments.picture);
        let pixels = options.size.map(u64::from).iter().product::<u64>();
        Record {
            world: self.scene.world.name.clone(),
            camera: self.scene.camera.name.clone(),
            view: render::view_name(options.view),
            size: options.size,
            spp,
            spp_wanted: arguments.spp,
            shard,
            antialias: arguments.antialias,
            adapter: self.gpu.summary.clone(),
            seconds,
            mpaths_per_s: pixels as f64 * f64::from(spp) / seconds / 1e6,
            emitters: self.stage.emitters.known.faces.len(),
        }
    }
}

impl Record {
    fn speed(&self) -> String {
        format!(
            "{:.1} s, {:.2} million paths a second on {}",
            self.seconds, self.mpaths_per_s, self.adapter.name
        )
    }
}
