//! A path-traced picture of a stage, without the probes of a [`Frame`](super::Frame).

use std::{ops::Range, sync::atomic::AtomicBool};

use super::{Stage, scene};
use crate::{
    gpu::{Gpu, GpuError, Recorder},
    lights::{Lights, table::LightsOfFrame},
    measure::picture::Picture,
    passes::{
        path_trace::{
            Blocks, Sampled,
            trace::{PathTrace, Resolve},
        },
        scene::{GpuBodies, GpuLights},
        view::{Display, GpuShot, Shot, tonemap::Tonemap},
    },
    world::{Camera, View},
};

/// What to trace.
pub struct TraceRequest<'a> {
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// A traceable view.
    pub view: View,
    /// Samples (paths) per pixel: 1 to [`PathTrace::MOST_SAMPLES`].
    pub spp: u32,
    pub seed: u32,
    /// World time in seconds, which says where bodies are. The lights are given apart.
    pub time_s: f64,
    /// Whether faces show their textures; else each face shows the mean of its texture.
    pub textures: bool,
    /// Whether samples are spread over the pixel; else all go through its centre.
    pub antialias: bool,
}

/// The result of a [`TraceRequest`].
pub struct Traced {
    /// Linear Rec. 709 radiance, or the view's data; depth in voxels, 0 where there is no surface.
    pub picture: Picture,
    /// Samples that every pixel holds: fewer than requested if tracing was cancelled. Views without randomness need
    /// no samples, and report the requested number.
    pub spp: u32,
}

/// The path tracer of a stage, for pictures of one size. An edit of the stage needs a new path tracer.
pub struct TracedFrame {
    view: wgpu::Buffer,
    lights: GpuLights,
    pass: PathTrace,
    bodies: GpuBodies,
    /// What the samples so far show, and how often bodies had moved.
    shown: Option<(GpuShot, Lights, u64)>,
}

/// Path-traces a picture on the GPU.
///
/// The picture depends only on the arguments and the adapter. `progress` receives (samples done,
/// samples in all), counted in tiles. Once `cancel` is set, the rest is left out; pixels without a
/// sample then show the light that is not random.
///
/// # Errors
/// [`GpuError`] when the adapter cannot hold the picture, or fails while tracing.
pub fn trace(
    gpu: &Gpu,
    stage: &Stage,
    lights: &Lights,
    request: &TraceRequest<'_>,
    progress: &dyn Fn(u64, u64),
    cancel: &AtomicBool,
) -> Result<Traced, GpuError> {
    let blocks = request.blocks(lights);
    let all = 0..blocks.count();
    let sampled = trace_blocks(gpu, stage, lights, request, &all, progress, cancel)?;
    Ok(Traced {
        picture: sampled.picture(blocks),
        spp: if all.is_empty() {
            request.spp
        } else {
            sampled.samples
        },
    })
}

/// Path-traces some blocks of a picture, as [`trace`] does for all blocks.
///
/// # Errors
/// As [`trace`].
pub fn trace_blocks(
    gpu: &Gpu,
    stage: &Stage,
    lights: &Lights,
    request: &TraceRequest<'_>,
    wanted: &Range<u32>,
    progress: &dyn Fn(u64, u64),
    cancel: &AtomicBool,
) -> Result<Sampled, GpuError> {
    let mut frame = TracedFrame::new(gpu, stage, request.size, request.antialias)?;
    frame.look(gpu, &request.shot(), lights);
    let blocks = request.blocks(lights);
    frame
        .pass
        .trace_blocks(gpu, blocks, wanted, progress, cancel)
}

impl TraceRequest<'_> {
    /// The blocks of the picture: none where nothing about the picture is random.
    pub fn blocks(&self, lights: &Lights) -> Blocks {
        let is_random = self.antialias || self.view.is_random(lights.has_spheres());
        Blocks::of(if is_random { self.spp } else { 0 })
    }

    fn shot(&self) -> Shot {
        Shot {
            camera: self.camera.clone(),
            size: self.size,
            frame: 0,
            seed: self.seed,
            exposure_ev: 0.0,
            view: self.view,
            time_s: self.time_s,
            textures: self.textures,
            soft_rays: 1,
            shadows: Default::default(),
        }
    }
}

impl TracedFrame {
    /// `antialias` spreads the samples over each pixel; else all go through the pixel's centre.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold the picture, and when a shader does not compile.
    pub fn new(
        gpu: &Gpu,
        stage: &Stage,
        size: [u32; 2],
        antialias: bool,
    ) -> Result<Self, GpuError> {
        let (view, lights) = (Shot::buffer(gpu), GpuLights::new(gpu, None)?);
        let pass = PathTrace::new(gpu, size, antialias, &scene(stage, &view, &lights))?;
        Ok(Self {
            view,
            lights,
            pass,
            bodies: stage.voxels.bodies.clone(),
            shown: None,
        })
    }

    /// Makes the passes that show the picture so far, as linear HDR and on `display`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn display(
        &self,
        gpu: &Gpu,
        stage: &Stage,
        display: &Display,
    ) -> Result<(Resolve, Tonemap), GpuError> {
        let resources = scene(stage, &self.view, &self.lights).resources;
        let resolve = self.pass.resolve(gpu, &resources)?;
        let tonemap = Tonemap::new(gpu, display, &resolve.hdr, &resources)?;
        Ok((resolve, tonemap))
    }

    /// Records as many samples of a shot as a frame has time for. Restarts first when the shot or its lights have
    /// changed. The shot's size must be the frame's, and its view must be traceable.
    ///
    /// # Errors
    /// [`GpuError`] when the device does not take the work.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        shot: &Shot,
        lights: &Lights,
    ) -> Result<(), GpuError> {
        if self.look(gpu, shot, lights) {
            self.pass.restart(gpu)?;
        }
        if shot.view.is_random(lights.has_spheres()) {
            self.pass.step(gpu, recorder);
        }
        Ok(())
    }

    /// Learns the milliseconds that the samples of a recorded frame took. Must be called for each frame in order.
    pub fn took(&mut self, ms: f64) {
        self.pass.took(ms);
    }

    /// Samples that every pixel has.
    pub fn samples(&self) -> u32 {
        self.pass.samples()
    }

    /// Tells the GPU what to trace, and returns whether the samples so far show something else.
    fn look(&mut self, gpu: &Gpu, shot: &Shot, lights: &Lights) -> bool {
        assert!(
            shot.view.is_traceable(),
            "path tracing has no view {:?}",
            shot.view
        );
        let uniform = shot.to_gpu();
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        // Neither the time nor the exposure is part of the light.
        let now = GpuShot {
            frame: 0,
            time_s: 0.0,
            exposure: 0.0,
            ..uniform
        };
        self.bodies.set_time(gpu, shot.time_s);
        let moved = self.bodies.version();
        let is_same = self.shown.as_ref().is_some_and(|(shot, before, version)| {
            *shot == now && before == lights && *version == moved
        });
        if !is_same {
            self.lights.set(gpu, lights, &LightsOfFrame::default());
            self.shown = Some((now, lights.clone(), moved));
        }
        !is_same
    }
}
