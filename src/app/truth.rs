//! The path-traced picture in the window: it gathers samples as long as nothing changes, and starts again when
//! anything does.

use std::collections::VecDeque;

use crate::{
    frame::{self, Stage},
    gpu::{Gpu, GpuError, PassTimes, Recorder},
    lights::Lights,
    measure::picture::Picture,
    passes::{
        path_trace::{
            Schedule,
            trace::{PathTrace, Resolve},
        },
        scene::GpuLights,
        view::{GpuView, View, ViewMode, tonemap::Tonemap},
    },
};

/// A path-traced picture of one size of a stage.
pub struct Truth {
    view: wgpu::Buffer,
    lights: GpuLights,
    pass: PathTrace,
    resolve: Resolve,
    tonemap: Tonemap,
    schedule: Schedule,
    size: [u32; 2],
    /// The view and the lights of the samples so far.
    shown: Option<(GpuView, Lights)>,
    /// Work of dispatch chunks whose times have not arrived yet.
    pending: VecDeque<u64>,
}

impl Truth {
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold the picture, and when a shader does not compile.
    pub fn new(gpu: &Gpu, stage: &Stage, size: [u32; 2]) -> Result<Self, GpuError> {
        let (view, lights) = (View::buffer(gpu), GpuLights::new(gpu));
        let resources = frame::resources(stage, &view, &lights);
        let pass = PathTrace::new(gpu, size, &resources)?;
        let resolve = pass.resolve(gpu, &resources)?;
        let hdr = resolve.hdr.create_view(&Default::default());
        let tonemap = Tonemap::new(gpu, size, &hdr, &resources)?;
        Ok(Self {
            schedule: Schedule::new(pass.tiles(), PathTrace::MOST_SAMPLES),
            view,
            lights,
            pass,
            resolve,
            tonemap,
            size,
            shown: None,
            pending: VecDeque::new(),
        })
    }

    /// Adds samples for about as long as a frame may take, and shows the mean of all samples.
    ///
    /// # Errors
    /// [`GpuError`] when the device does not take the work.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        view: &View,
        lights: &Lights,
    ) -> Result<(), GpuError> {
        let mut uniform = view.to_gpu();
        let mode = match view.mode {
            // These modes show how probes light a picture.
            ViewMode::Steps | ViewMode::Cage | ViewMode::States => ViewMode::Full,
            mode => mode,
        };
        uniform.mode = mode as u32;
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        // Neither the time nor the exposure is part of the light.
        let now = GpuView {
            frame: 0,
            time_s: 0.0,
            exposure: 0.0,
            ..uniform
        };
        let unchanged = self
            .shown
            .as_ref()
            .is_some_and(|(view, before)| *view == now && before == lights);
        if !unchanged {
            self.lights.set(gpu, lights);
            self.schedule.restart(PathTrace::MOST_SAMPLES);
            // Uses a submission of its own: both chunks of this frame write the same uniform.
            let whole = Schedule::whole(self.pass.tiles());
            let mut first = Recorder::new(gpu, None);
            self.pass.begin(gpu, &mut first, &whole, false);
            first.submit(gpu)?;
            self.shown = Some((now, lights.clone()));
        }
        let random = matches!(
            mode,
            ViewMode::Full | ViewMode::Indirect | ViewMode::Irradiance | ViewMode::TexturesOff
        );
        if random && let Some(chunk) = self.schedule.next_chunk() {
            self.pass.trace(gpu, recorder, &chunk, false);
            self.pending.push_back(chunk.work);
        }
        self.resolve.record(recorder);
        self.tonemap.record(recorder);
        Ok(())
    }

    /// Learns from the times of a recorded frame. `None` where the adapter has no timestamps: then only the
    /// milliseconds of the whole frame are known.
    pub fn took(&mut self, times: Option<&PassTimes>, frame_ms: f64) {
        let ms = match times {
            None => Some(frame_ms),
            Some(times) => times.passes_ms.get("path_trace/trace").copied(),
        };
        if let Some(ms) = ms
            && let Some(work) = self.pending.pop_front()
        {
            self.schedule.took(work, ms);
        }
    }

    /// Samples that every pixel has.
    pub fn samples(&self) -> u32 {
        self.schedule.complete()
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// See [`crate::frame::Frame::display`].
    pub fn display(&self) -> &wgpu::Texture {
        &self.tonemap.display
    }

    /// See [`crate::frame::Frame::read_display`].
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_display(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        self.tonemap.read_back(gpu)
    }
}
