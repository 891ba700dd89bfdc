//! The path-traced picture in the window: it gathers samples as long as nothing changes, and begins
//! again when anything does.

use crate::{
    frame::{Stage, TracedFrame},
    gpu::{Gpu, GpuError, PassTimes, Recorder},
    lights::Lights,
    measure::picture::Picture,
    passes::{
        path_trace::trace::Resolve,
        view::{Display, Shot, tonemap::Tonemap},
    },
    world::View,
};

/// A picture of one size of a stage.
pub struct ReferenceView {
    traced: TracedFrame,
    resolve: Resolve,
    tonemap: Tonemap,
    display: Display,
    size: [u32; 2],
}

impl ReferenceView {
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold the picture, and when a shader does not compile.
    pub fn new(gpu: &Gpu, stage: &Stage, size: [u32; 2]) -> Result<Self, GpuError> {
        let traced = TracedFrame::new(gpu, stage, size, false)?;
        let display = Display::new(gpu, size)?;
        let (resolve, tonemap) = traced.display(gpu, stage, &display)?;
        Ok(Self {
            traced,
            resolve,
            tonemap,
            display,
            size,
        })
    }

    /// Adds samples for about as long as a frame may take, and shows their mean.
    ///
    /// # Errors
    /// [`GpuError`] when the device does not take the work.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        mut shot: Shot,
        lights: &Lights,
    ) -> Result<(), GpuError> {
        if !shot.view.is_traceable() {
            // It would show how probes light the picture.
            shot.view = View::Full;
        }
        self.traced.record(gpu, recorder, &shot, lights)?;
        self.resolve.record(recorder);
        self.tonemap.record(recorder);
        Ok(())
    }

    /// Learns from the times of a frame that this recorded; `None` where the adapter has no clock, and
    /// only the whole frame's milliseconds are known.
    pub fn took(&mut self, times: Option<&PassTimes>, frame_ms: f64) {
        let ms = match times {
            None => Some(frame_ms),
            Some(times) => times.passes_ms.get("path_trace/trace").copied(),
        };
        if let Some(ms) = ms {
            self.traced.took(ms);
        }
    }

    /// Samples that every pixel has.
    pub fn samples(&self) -> u32 {
        self.traced.samples()
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// As [`crate::frame::Frame::display`].
    pub fn display(&self) -> &wgpu::Texture {
        &self.display.picture
    }

    /// As [`crate::frame::Frame::read_display`].
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_display(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        self.display.read_back(gpu)
    }
}
