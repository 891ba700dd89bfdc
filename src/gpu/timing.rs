//! GPU timestamps by pass label.

use std::collections::BTreeMap;

use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

use super::{Gpu, GpuError};

/// Milliseconds of each pass in one frame, by label, in the order of the alphabet, and the span
/// from the first pass's start to the last one's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassTimes {
    pub passes_ms: BTreeMap<String, f64>,
    pub frame_ms: f64,
}

/// Collects timestamps over frames without stalling them.
pub struct Timing {
    profiler: GpuProfiler,
    period: f32,
    supported: bool,
}

impl Timing {
    /// # Errors
    /// [`GpuError::Device`] when the profiler refuses its settings.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let settings = GpuProfilerSettings {
            max_num_pending_frames: 64,
            enable_debug_groups: false,
            ..Default::default()
        };
        Ok(Self {
            profiler: GpuProfiler::new(&gpu.device, settings)
                .map_err(|error| GpuError::Device(error.to_string()))?,
            period: gpu.queue.get_timestamp_period(),
            supported: gpu.features.contains(wgpu::Features::TIMESTAMP_QUERY),
        })
    }

    /// Whether the adapter can time its passes at all.
    pub fn supported(&self) -> bool {
        self.supported
    }

    /// The oldest frame whose times have arrived.
    pub fn next_frame(&mut self) -> Option<PassTimes> {
        let results = self.profiler.process_finished_frame(self.period)?;
        Some(PassTimes::of(&results))
    }
}

impl PassTimes {
    fn of(results: &[GpuTimerQueryResult]) -> Self {
        let mut times = Self::default();
        let (mut start, mut end) = (f64::MAX, f64::MIN);
        for result in results {
            if let Some(range) = &result.time {
                *times.passes_ms.entry(result.label.clone()).or_default() +=
                    (range.end - range.start) * 1e3;
                start = start.min(range.start);
                end = end.max(range.end);
            }
        }
        if end > start {
            times.frame_ms = (end - start) * 1e3;
        }
        times
    }
}

/// Records the passes of one frame (or of one piece of work), each with its own timestamps.
pub struct Recorder<'a> {
    pub encoder: wgpu::CommandEncoder,
    timing: Option<&'a mut Timing>,
}

impl<'a> Recorder<'a> {
    pub fn new(gpu: &Gpu, timing: Option<&'a mut Timing>) -> Self {
        Self {
            encoder: gpu.device.create_command_encoder(&Default::default()),
            timing,
        }
    }

    /// A compute pass under this label.
    pub fn compute(&mut self, label: &str, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        let query = self
            .timing
            .as_ref()
            .map(|timing| timing.profiler.begin_pass_query(label, &mut self.encoder));
        {
            let timestamp_writes = query
                .as_ref()
                .and_then(|query| query.compute_pass_timestamp_writes());
            let mut pass = self
                .encoder
                .begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(label),
                    timestamp_writes,
                });
            record(&mut pass);
        }
        if let (Some(timing), Some(query)) = (&self.timing, query) {
            timing.profiler.end_query(&mut self.encoder, query);
        }
    }

    /// A render pass under this label that draws on black over all of `target`.
    pub fn render(
        &mut self,
        label: &str,
        target: &wgpu::TextureView,
        record: impl FnOnce(&mut wgpu::RenderPass<'static>),
    ) {
        let query = self
            .timing
            .as_ref()
            .map(|timing| timing.profiler.begin_pass_query(label, &mut self.encoder));
        {
            let timestamp_writes = query
                .as_ref()
                .and_then(|query| query.render_pass_timestamp_writes());
            let pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(label),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                timestamp_writes,
                ..Default::default()
            });
            // It ends with this block, before the encoder is used again.
            record(&mut pass.forget_lifetime());
        }
        if let (Some(timing), Some(query)) = (&self.timing, query) {
            timing.profiler.end_query(&mut self.encoder, query);
        }
    }

    /// Submits the work; its times come from [`Timing::next_frame`] when it is done.
    ///
    /// # Errors
    /// [`GpuError::Device`] when timestamps were left open.
    pub fn submit(mut self, gpu: &Gpu) -> Result<wgpu::SubmissionIndex, GpuError> {
        if let Some(timing) = &mut self.timing {
            timing.profiler.resolve_queries(&mut self.encoder);
        }
        let index = gpu.queue.submit([self.encoder.finish()]);
        if let Some(timing) = self.timing {
            timing
                .profiler
                .end_frame()
                .map_err(|error| GpuError::Device(error.to_string()))?;
        }
        Ok(index)
    }
}
