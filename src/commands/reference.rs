//! `grotto reference`: path-traced ground truth on the GPU, as far as there is patience for it.

use std::{
    path::PathBuf,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use clap::Args;
use serde::Serialize;

use super::{
    Failure, memory,
    options::{PictureOptions, RunOptions, Scene},
    output, render, stop,
};
use crate::{
    frame::{self, Stage},
    gpu::{AdapterSummary, Gpu, GpuError, Recorder},
    lights::Lights,
    measure::{
        picture::Picture,
        picture_file::{self, PictureFormat},
    },
    passes::{GpuLights, Schedule, Slice, ViewMode, path_trace::PathTrace},
    reference::View,
    world::Camera,
};

/// Path-trace a picture on the GPU, as ground truth; Ctrl-C writes what there is
#[derive(Args)]
pub struct Arguments {
    /// World file (worlds/*.ron)
    world: PathBuf,
    /// The picture to write: .png (tone-mapped) or .exr (linear)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Samples (paths) per pixel: noise falls with the root, time grows with it
    #[arg(long, value_name = "N", default_value_t = 256, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=i64::from(PathTrace::MOST_SAMPLES)))]
    spp: u32,
    /// Spread the samples over each pixel; else all look through its centre, as `render` does
    #[arg(long)]
    antialias: bool,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    run: RunOptions,
}

/// What to trace.
pub struct TraceRequest<'a> {
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    pub view: View,
    /// Samples (paths) per pixel: 1 to [`PathTrace::MOST_SAMPLES`].
    pub spp: u32,
    pub seed: u32,
    /// Whether textures are seen; else every texture is its mean.
    pub textures: bool,
    /// Spreads the samples over the pixel; else all look through its centre.
    pub antialias: bool,
}

/// What came of a [`TraceRequest`].
pub struct Traced {
    /// Linear Rec. 709 radiance, or the view's data; depth in voxels, 0 where there is no surface.
    pub picture: Picture,
    /// Samples that every pixel holds: fewer than were asked for when it was cancelled. Views
    /// without randomness need none, and say what was asked for.
    pub spp: u32,
    /// Exposed faces of emissive voxels.
    pub emitters: usize,
}

/// Path-traces a picture on the GPU.
///
/// The picture depends on the arguments and the adapter alone. `progress` is told (samples done,
/// samples in all), counted in tiles. Once `cancel` is set the rest is left out; pixels without a
/// sample then show the light that is not random.
///
/// # Errors
/// When the adapter cannot hold the picture, and when it fails on the way.
pub fn trace(
    gpu: &Gpu,
    stage: &Stage,
    lights: &Lights,
    request: &TraceRequest<'_>,
    progress: &dyn Fn(u64, u64),
    cancel: &AtomicBool,
) -> Result<Traced, Failure> {
    let gpu_lights = GpuLights::new(gpu);
    gpu_lights.set(gpu, lights);
    let view = crate::passes::View {
        camera: request.camera.clone(),
        size: request.size,
        frame: 0,
        seed: request.seed,
        exposure_ev: 0.0,
        mode: view_mode(request.view),
        time_s: 0.0,
        textures: request.textures,
    };
    let uniform = gpu.uniform_buffer("view", &view.to_gpu());
    let resources = frame::resources(stage, &uniform, &gpu_lights);
    let pass = PathTrace::new(gpu, request.size, &resources)?;

    let run = |schedule: &mut Schedule, record: &dyn Fn(&mut Recorder<'_>, &Slice), stop: bool| {
        while !(stop && cancel.load(Ordering::Relaxed)) {
            let Some(slice) = schedule.next_slice() else {
                break;
            };
            let start = Instant::now();
            let mut recorder = Recorder::new(gpu, None);
            record(&mut recorder, &slice);
            recorder.submit(gpu)?;
            gpu.wait()?;
            schedule.took(slice.work, start.elapsed().as_secs_f64() * 1e3);
            if stop {
                progress(schedule.done(), schedule.total());
            }
        }
        Ok::<(), GpuError>(())
    };
    let antialias = request.antialias;
    let begin = |recorder: &mut Recorder<'_>, slice: &Slice| {
        pass.begin(gpu, recorder, slice, antialias);
    };
    run(&mut Schedule::new(pass.tiles(), 1), &begin, false)?;
    let random =
        antialias || matches!(request.view, View::Full | View::Indirect | View::Irradiance);
    let mut schedule = Schedule::new(pass.tiles(), if random { request.spp } else { 0 });
    let add = |recorder: &mut Recorder<'_>, slice: &Slice| {
        pass.trace(gpu, recorder, slice, antialias);
    };
    run(&mut schedule, &add, true)?;
    Ok(Traced {
        picture: pass.read(gpu)?,
        spp: if random {
            schedule.complete()
        } else {
            request.spp
        },
        emitters: stage.emitters.known.faces.len(),
    })
}

fn view_mode(view: View) -> ViewMode {
    match view {
        View::Full => ViewMode::Full,
        View::Direct => ViewMode::Direct,
        View::Indirect => ViewMode::Indirect,
        View::Irradiance => ViewMode::Irradiance,
        View::Albedo => ViewMode::Albedo,
        View::Normal => ViewMode::Normal,
        View::Depth => ViewMode::Depth,
    }
}

/// The `--json` of a picture.
#[derive(Serialize)]
struct Record {
    world: String,
    camera: String,
    view: String,
    /// Width and height in pixels.
    size: [u32; 2],
    /// Samples that every pixel holds, and how many were asked for.
    spp: u32,
    spp_wanted: u32,
    antialias: bool,
    adapter: AdapterSummary,
    /// From the voxels to the picture.
    seconds: f64,
    /// Millions of paths a second.
    mpaths_per_s: f64,
    /// Exposed faces of emissive voxels.
    emitters: usize,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (options, run) = (&arguments.picture, &arguments.run);
    let format = picture_file::check_writable(&arguments.output)?;
    let scene = Scene::load(&arguments.world, run, options)?;
    let view = render::traced_view(options.view)?;
    render::note_without_probes(options, run, "`reference`");
    let pixels = options.size.map(u64::from).iter().product::<u64>();
    // Three buffers read back, and the picture with its bytes.
    memory::check(
        "a picture of this size",
        pixels * (3 * PathTrace::BYTES_PER_PIXEL + 24),
    )?;
    let cancel = stop::at_ctrl_c(run);
    let gpu = output::open_gpu(run)?;
    gpu.check_buffer(
        "a picture of this size",
        pixels * PathTrace::BYTES_PER_PIXEL,
    )?;
    let spinner = output::spinner(run, render::VOXELISING);
    let stage = Stage::build(&gpu, &scene.world)?;
    spinner.finish_and_clear();

    let bar = output::progress(run, "tiles × samples", 1);
    let progress = |done, total| {
        bar.set_length(total);
        bar.set_position(done);
    };
    let lights = Lights::at(&scene.world, &scene.lamps, scene.lamp_time_s);
    let start = Instant::now();
    let request = TraceRequest {
        camera: &scene.camera,
        size: options.size,
        view,
        spp: arguments.spp,
        seed: options.seed,
        textures: scene.parameters.textures.enabled && options.view != ViewMode::TexturesOff,
        antialias: arguments.antialias,
    };
    let traced = trace(&gpu, &stage, &lights, &request, &progress, &cancel)?;
    let seconds = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    if traced.spp == 0 {
        return Err(Failure::interrupted(format!(
            "stopped before every pixel had its first sample: {} is not written",
            arguments.output.display()
        )));
    }
    let mut picture = traced.picture;
    if view == View::Depth {
        render::show_depth(&mut picture);
    }
    let exposure_ev = scene.parameters.picture.exposure_ev;
    render::store(&arguments.output, &picture, options.view, exposure_ev)?;
    let paths = pixels as f64 * f64::from(traced.spp);
    let record = Record {
        world: scene.world.name.clone(),
        camera: scene.camera.name.clone(),
        view: render::view_name(options.view),
        size: options.size,
        spp: traced.spp,
        spp_wanted: arguments.spp,
        antialias: arguments.antialias,
        adapter: gpu.summary.clone(),
        seconds,
        mpaths_per_s: paths / seconds / 1e6,
        emitters: traced.emitters,
    };
    if run.json {
        return output::print_json(&record);
    }
    let stopped = if record.spp < record.spp_wanted {
        format!(", stopped of {} wanted", record.spp_wanted)
    } else {
        String::new()
    };
    let linear = match format {
        PictureFormat::Png => "tone-mapped",
        PictureFormat::Exr => "linear",
    };
    output::note(
        run,
        &format!(
            "{} ({linear}): {} samples a pixel{stopped}, {seconds:.1} s, {:.2} million paths a second \
             on {}",
            arguments.output.display(),
            record.spp,
            record.mpaths_per_s,
            record.adapter.name
        ),
    );
    Ok(())
}
