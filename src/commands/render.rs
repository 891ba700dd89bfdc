//! `grotto render`: one picture, on the GPU or path-traced on the CPU.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::Instant,
};

use clap::{Args, ValueEnum as _};

use super::{
    Failure,
    frame_loop::smooth,
    memory,
    options::{
        DEFAULT_FRAMES, InspectionOptions, PictureOptions, RunOptions, Setup, check_view,
        world_file,
    },
    output,
    record::{FrameTimes, ProbeCounts, Rays, Record, frame_spans, median_passes, mrays_per_s},
};
use crate::{
    frame::{Frame, Stage},
    gpu::{AdapterSummary, Gpu, Recorder, Timing},
    lights::Lights,
    measure::{
        picture::Picture,
        picture_file::{self, PictureFormat},
        tonemap,
    },
    passes::{
        scene::MemoryUse,
        view::{Shot, camera_rays::CameraRays},
    },
    reference,
    world::{View, generate, voxels::grid_cells},
};

/// Render a picture of a world
#[derive(Args)]
pub struct Arguments {
    /// World file (worlds/*.ron)
    #[arg(value_parser = world_file())]
    world: PathBuf,
    /// The picture to write: .png (tone-mapped) or .exr (linear)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    inspection: InspectionOptions,
    #[command(flatten)]
    run: RunOptions,
    /// Path-trace on the CPU: needs no GPU, uses no probes
    #[arg(long, conflicts_with_all = ["adapter", "probes", "atlas"])]
    cpu: bool,
    /// With --cpu: samples per pixel; noise falls with the square root, time grows in proportion
    #[arg(long, value_name = "N", requires = "cpu", default_value_t = 64,
          value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: u32,
}

pub(super) const VOXELISING: &str = "building the voxels";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    picture_file::check_writable(&arguments.output)?;
    let load = || Setup::load(&arguments.world, &arguments.run, &arguments.picture);
    let (setup, (picture, record)) = if arguments.cpu {
        let setup = load()?;
        let made = on_the_cpu(arguments, &setup)?;
        (setup, made)
    } else {
        let (setup, gpu) = output::load_and_open(&arguments.run, || {
            let setup = load()?;
            check_view(arguments.picture.view, &setup.parameters)?;
            Ok(setup)
        })?;
        let made = on_the_gpu(arguments, &setup, &gpu)?;
        (setup, made)
    };
    if shows_as_displayed(arguments)? {
        picture_file::write_png(&arguments.output, &picture)?;
    } else {
        let exposure_ev = setup.parameters.picture.exposure_ev;
        let view = arguments.picture.view;
        store(&arguments.output, &picture, view, exposure_ev)?;
    }
    if arguments.run.json {
        output::print_json(&record)?;
    } else {
        output::note(
            &arguments.run,
            &format!(
                "{}: {:.1} ms a frame on {}",
                arguments.output.display(),
                record.frame_ms.median,
                record.adapter.name
            ),
        );
    }
    Ok(())
}

fn on_the_cpu(arguments: &Arguments, setup: &Setup) -> Result<(Picture, Record), Failure> {
    let (picture_options, run) = (&arguments.picture, &arguments.run);
    check_traceable(picture_options.view)?;
    note_without_probes(picture_options, run, "--cpu");
    let [width, height] = picture_options.size;
    // Memory: sums in f64, the picture in f32, and its bytes.
    memory::check(
        "a picture of this size",
        u64::from(width) * u64::from(height) * 40,
    )?;
    let grid_bytes = grid_cells(setup.world.size).as_u64vec3().element_product() * 4;
    memory::check("a world of this size", grid_bytes)?;

    let spinner = output::spinner(run, VOXELISING);
    let voxels = generate::generate(&setup.world);
    spinner.finish_and_clear();
    let samples = u64::from(width) * u64::from(height) * u64::from(arguments.spp);
    let bar = output::progress(run, "samples", samples);
    let start = Instant::now();
    let options = reference::RenderOptions {
        lamps: &setup.lamps,
        time_s: setup.time_s,
        lamp_time_s: setup.lamp_time_s,
        textures: setup.parameters.textures.enabled,
        film: reference::FilmOptions {
            camera: &setup.camera,
            size: picture_options.size,
            samples: arguments.spp,
            seed: u64::from(picture_options.seed),
            view: picture_options.view,
            antialias: false,
            max_bounces: u32::MAX,
        },
    };
    let progress = |done, total| {
        bar.set_length(total);
        bar.set_position(done);
    };
    let mut picture = reference::render(
        &setup.world,
        &voxels,
        &options,
        &progress,
        &AtomicBool::new(false),
    );
    let elapsed_ms = start.elapsed().as_secs_f64() * 1e3;
    bar.finish_and_clear();
    if picture_options.view == View::Depth {
        show_depth(&mut picture);
    }

    let frame_ms = FrameTimes::of(&[elapsed_ms]).expect("one frame was rendered");
    let camera_rays = Some(u64::from(width) * u64::from(height));
    let record = Record {
        world: setup.world.name.clone(),
        camera: setup.camera.name.clone(),
        layout: None,
        view: view_name(picture_options.view),
        size: picture_options.size,
        frames: 0,
        adapter: AdapterSummary {
            name: "CPU path tracer".to_owned(),
            kind: "software",
            driver: format!("grotto {}", env!("CARGO_PKG_VERSION")),
            backend: "cpu".to_owned(),
        },
        fps: frame_ms.fps(),
        frame_ms,
        passes: [("path_trace/trace".to_owned(), elapsed_ms)].into(),
        rays: Rays {
            camera: camera_rays,
            ..Default::default()
        },
        mrays_per_s: Rays {
            camera: mrays_per_s(camera_rays, Some(elapsed_ms)),
            ..Default::default()
        },
        probes: ProbeCounts::default(),
        memory_bytes: MemoryUse::default(),
        build: None,
    };
    Ok((picture, record))
}

fn on_the_gpu(
    arguments: &Arguments,
    setup: &Setup,
    gpu: &Gpu,
) -> Result<(Picture, Record), Failure> {
    let (options, run) = (&arguments.picture, &arguments.run);
    check_size(gpu, options.size)?;
    let spinner = output::spinner(run, VOXELISING);
    let stage = Stage::build(gpu, &setup.world)?;
    spinner.finish_and_clear();
    let probes = &setup.parameters.probes;
    let mut frame = Frame::new(gpu, stage, &setup.layout, probes, options.size)?;
    frame.antialias(gpu, &setup.parameters.picture)?;
    frame.inspect(gpu, arguments.inspection.with(options.view))?;
    let mut timing = Timing::new(gpu)?;
    let lights = Lights::at(&setup.world, &setup.lamps, setup.lamp_time_s);
    let settling = options.frames.unwrap_or(DEFAULT_FRAMES);
    let bar = output::progress(run, "frames", u64::from(settling) + 1);
    let mut wall_ms = Vec::new();
    let mut times = Vec::new();
    let mut shot = Shot {
        camera: setup.camera.clone(),
        size: options.size,
        frame: 0,
        seed: options.seed,
        exposure_ev: setup.parameters.picture.exposure_ev,
        view: options.view,
        time_s: setup.time_s,
        textures: setup.parameters.textures.enabled,
        soft_rays: setup.parameters.lights.soft_rays,
        shadows: setup.parameters.lights.shadows,
    };
    for index in 0..=settling {
        let start = Instant::now();
        shot.frame = index;
        let mut recorder = if index / 2 % 2 == 1 {
            Recorder::new_whole(gpu, &mut timing)
        } else {
            Recorder::new(gpu, Some(&mut timing))
        };
        frame.record(gpu, &mut recorder, &shot, &lights, probes);
        recorder.submit(gpu)?;
        gpu.wait()?;
        wall_ms.push(start.elapsed().as_secs_f64() * 1e3);
        times.extend(std::iter::from_fn(|| timing.next_frame()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    smooth(gpu, &mut frame, &shot)?;
    let picture = if shows_as_displayed(arguments)? {
        frame.read_display(gpu)?
    } else {
        frame.read_radiance(gpu)?
    };

    // The times of the passes do not include the waits between them.
    let frames_ms = if timing.supported() && !times.is_empty() {
        frame_spans(&times)
    } else {
        wall_ms
    };
    let frame_ms = FrameTimes::of(&frames_ms).expect("one frame was rendered");
    let passes = median_passes(&times);
    let probe_counts = ProbeCounts::read(gpu, frame.field())?;
    let [width, height] = frame.rendered_size().map(u64::from);
    let direct = matches!(options.view, View::Full | View::Direct | View::TexturesOff);
    let faces = frame.faces();
    let rays = Rays {
        camera: Some(width * height),
        shadow: Some(frame.count_shadow_rays(gpu, direct)?),
        probe: Some(u64::from(probe_counts.updated) * u64::from(probes.rays_per_update())),
        face: faces.is_used().then(|| faces.rays_sent(gpu)).transpose()?,
    };
    let rate = |rays, pass: &str| mrays_per_s(rays, passes.get(pass).copied());
    let record = Record {
        world: setup.world.name.clone(),
        camera: setup.camera.name.clone(),
        layout: Some(setup.layout.name.clone()),
        view: match arguments.inspection.atlas {
            Some(_) => "atlas".to_owned(),
            None => view_name(options.view),
        },
        size: options.size,
        frames: settling,
        adapter: gpu.summary.clone(),
        fps: frame_ms.fps(),
        frame_ms,
        rays,
        mrays_per_s: Rays {
            camera: rate(rays.camera, "view/camera_rays"),
            shadow: None,
            probe: rate(rays.probe, "probes/trace"),
            face: rate(rays.face, "surface_cache/trace"),
        },
        passes,
        probes: probe_counts,
        memory_bytes: frame.memory(),
        build: frame.stage.built.map(Into::into),
    };
    Ok((picture, record))
}

/// Whether to store the displayed picture (PNG only). With probes drawn over it, light and data are side by
/// side, and only the GPU knows which pixel has which.
fn shows_as_displayed(arguments: &Arguments) -> Result<bool, Failure> {
    let plain = arguments.inspection.with(arguments.picture.view).is_plain();
    Ok(!plain && PictureFormat::of(&arguments.output)? == PictureFormat::Png)
}

/// Refuses pictures that the adapter cannot hold, before the voxels are built.
fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), Failure> {
    let longest = gpu.limits.max_texture_dimension_2d;
    if width.max(height) > longest {
        return Err(Failure::bad_input(format!(
            "--size {width}x{height}: pictures on adapter `{}` have edges of at most {longest} pixels",
            gpu.summary.name
        )));
    }
    let pixels = u64::from(width) * u64::from(height);
    gpu.check_buffer(
        "a picture of this size",
        pixels * CameraRays::BYTES_PER_PIXEL,
    )?;
    Ok(())
}

/// Notes which of the given options have no effect where light is path-traced.
pub(super) fn note_without_probes(picture: &PictureOptions, run: &RunOptions, tracer: &str) {
    let sets_probes = run.set.iter().any(|set| set.starts_with("probes."));
    for (given, flag) in [
        (picture.layout.is_some(), "--layout"),
        (picture.frames.is_some(), "--frames"),
        (sets_probes, "--set probes.…"),
    ] {
        if given {
            output::note(
                run,
                &format!("note: {flag} changes nothing with {tracer}, which uses no probes"),
            );
        }
    }
}

/// Converts distances (voxels) to the values of the depth view.
pub(super) fn show_depth(picture: &mut Picture) {
    // Distance 0 means that no surface was hit.
    for rgb in picture.rgb.iter_mut().filter(|rgb| rgb[0] > 0.0) {
        *rgb = rgb.map(View::depth_shown);
    }
}

/// Writes light unchanged (EXR) or tone-mapped (PNG), and data without exposure and tone curve.
pub(super) fn store(
    path: &Path,
    picture: &Picture,
    view: View,
    exposure_ev: f32,
) -> Result<(), Failure> {
    if view.is_data() && PictureFormat::of(path)? == PictureFormat::Png {
        let mut shown = picture.clone();
        for rgb in &mut shown.rgb {
            *rgb = rgb.map(|value| tonemap::srgb_from_linear(value.into()) as f32);
        }
        picture_file::write_png(path, &shown)?;
    } else {
        picture_file::write(path, picture, exposure_ev)?;
    }
    Ok(())
}

/// The view for the path tracers, or an error where they have none.
pub(super) fn check_traceable(view: View) -> Result<(), Failure> {
    if view.is_traceable() {
        return Ok(());
    }
    Err(Failure::bad_input(format!(
        "--view {} shows how probes light a picture; path tracing has full, direct, indirect, \
         irradiance, albedo, normal, depth and textures-off",
        view_name(view)
    )))
}

/// A view as `--view` spells it.
pub(super) fn view_name(view: View) -> String {
    let value = view.to_possible_value().expect("no view is hidden");
    value.get_name().to_owned()
}
