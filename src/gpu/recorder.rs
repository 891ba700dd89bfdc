//! Records passes into one submission, and has them timed.

use std::{mem, ops::Range, time::Instant};

use wgpu_profiler::GpuProfilerQuery;

use super::{
    Bindings, Gpu, GpuError, Kernel, Timing,
    slices::{MOST_ROWS, SliceArguments, Slices},
    timing::{Clock, WHOLE},
};

/// Records the passes of one frame (or of one piece of work), each with its own time.
pub struct Recorder<'a> {
    pub encoder: wgpu::CommandEncoder,
    device: wgpu::Device,
    queue: wgpu::Queue,
    timing: Option<&'a mut Timing>,
    /// Open from the first pass to the last, where these are not timed one by one.
    whole: Option<GpuProfilerQuery>,
    /// The pass that those recorded [`together`](Self::together) share.
    shared: Option<wgpu::ComputePass<'static>>,
    first_groups: u32,
    arguments: SliceArguments,
}

impl<'a> Recorder<'a> {
    pub fn new(gpu: &Gpu, timing: Option<&'a mut Timing>) -> Self {
        Self {
            encoder: gpu.device.create_command_encoder(&Default::default()),
            device: gpu.device.clone(),
            queue: gpu.queue.clone(),
            timing,
            whole: None,
            shared: None,
            first_groups: gpu.first_groups,
            arguments: gpu.slice_arguments.clone(),
        }
    }

    /// Times the frame as a whole, where the adapter's clock can: stamps between the passes take time of
    /// their own.
    pub fn new_whole(gpu: &Gpu, timing: &'a mut Timing) -> Self {
        let mut recorder = Self::new(gpu, Some(timing));
        if gpu
            .features
            .contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS)
            && let Some(Clock::Gpu { profiler, .. }) =
                recorder.timing.as_mut().map(|timing| &mut timing.clock)
        {
            recorder.whole = Some(profiler.begin_query(WHOLE, &mut recorder.encoder));
        }
        recorder
    }

    /// A compute pass under the kernel's label: columns and rows of workgroups, in as many dispatches
    /// as it takes that none of them holds the GPU for long (one, on a GPU that is fast enough). The
    /// shader adds `first_row` of `shaders/frame/chunk.wesl` to its row; what it writes must not depend
    /// on the order of its workgroups.
    ///
    /// # Panics
    /// With more than 4096 rows.
    pub fn run(&mut self, kernel: &Kernel, bindings: &Bindings, groups: [u32; 2]) {
        self.run_rows(kernel, bindings, groups, None);
    }

    /// The same for work of which the GPU says how much there is: columns and rows in three u32 at
    /// `offset` of `buffer`, with as many rows as `most` and at most its columns.
    ///
    /// # Panics
    /// With more than 4096 rows.
    pub fn run_indirect(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        most: [u32; 2],
        (buffer, offset): (&wgpu::Buffer, u64),
    ) {
        self.run_rows(kernel, bindings, most, Some((buffer, offset)));
    }

    fn run_rows(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        [width, rows]: [u32; 2],
        indirect: Option<(&wgpu::Buffer, u64)>,
    ) {
        assert!(rows <= MOST_ROWS, "`{}` has {rows} rows", kernel.label);
        let (label, pace) = (&*kernel.label, &bindings.pace);
        let slices = Slices::new(pace, [width, rows], self.first_groups);
        let by_the_wall = matches!(
            self.timing.as_ref().map(|timing| &timing.clock),
            Some(Clock::Wall { .. })
        );
        match indirect {
            None if !by_the_wall => self.compute(label, |pass| {
                for slice in slices {
                    kernel.dispatch_rows(pass, bindings, width, slice);
                }
            }),
            _ => {
                for slice in slices {
                    let count = slice.end - slice.start;
                    let elapsed_ms = match indirect {
                        Some(arguments) => {
                            self.run_some_rows(kernel, bindings, slice, rows, arguments)
                        }
                        None => self.compute_timed(label, |pass| {
                            kernel.dispatch_rows(pass, bindings, width, slice);
                        }),
                    };
                    if by_the_wall {
                        let elapsed_ms = elapsed_ms.unwrap_or_default();
                        tracing::trace!("{label}: {count} of {rows} rows in {elapsed_ms:.1} ms");
                        pace.learn(count, elapsed_ms);
                    }
                }
            }
        }
        if let (Some(timing), false) = (&mut self.timing, by_the_wall) {
            let learning = (pace.clone(), rows);
            timing.learning.insert(label.to_owned(), learning);
        }
    }

    /// Passes that the GPU may run side by side, where they are not timed one by one. One that writes what
    /// another binds waits for it as ever.
    pub fn together(&mut self, record: impl FnOnce(&mut Self)) {
        let one_by_one = match self.timing.as_ref().map(|timing| &timing.clock) {
            Some(Clock::Gpu { .. }) => self.whole.is_none(),
            Some(Clock::Wall { .. }) => true,
            Some(Clock::None) | None => false,
        };
        if !one_by_one {
            let pass = self.encoder.begin_compute_pass(&Default::default());
            self.shared = Some(pass.forget_lifetime());
        }
        record(self);
        self.shared = None;
    }

    /// A slice of work of which the GPU says how many columns it has; milliseconds, where they are known
    /// at once.
    fn run_some_rows(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        slice: Range<u32>,
        rows: u32,
        (buffer, offset): (&wgpu::Buffer, u64),
    ) -> Option<f64> {
        let arguments = self.arguments.clone();
        let is_whole = slice == (0..rows);
        if let (Some(pass), true) = (&mut self.shared, is_whole) {
            kernel.dispatch_indirect(pass, bindings, slice.start, buffer, offset);
            return None;
        }
        // A copy between passes ends the shared one.
        self.shared = None;
        self.pass(&kernel.label, |encoder, query| {
            if !is_whole {
                arguments.write(encoder, (buffer, offset), slice.end - slice.start);
            }
            let pass = &mut begin_compute_pass(encoder, &kernel.label, query);
            let (buffer, offset) = if is_whole {
                (buffer, offset)
            } else {
                (arguments.buffer(), 0)
            };
            kernel.dispatch_indirect(pass, bindings, slice.start, buffer, offset);
        })
    }

    /// A compute pass under this label.
    pub fn compute(&mut self, label: &str, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        self.compute_timed(label, record);
    }

    /// Milliseconds, where they are known at once.
    fn compute_timed(
        &mut self,
        label: &str,
        record: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) -> Option<f64> {
        if let Some(pass) = &mut self.shared {
            record(pass);
            return None;
        }
        self.pass(label, |encoder, query| {
            record(&mut begin_compute_pass(encoder, label, query));
        })
    }

    /// A render pass under this label that draws on black over all of `target`.
    pub fn render(
        &mut self,
        label: &str,
        target: &wgpu::TextureView,
        record: impl FnOnce(&mut wgpu::RenderPass<'static>),
    ) {
        self.pass(label, |encoder, query| {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
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
                timestamp_writes: query.and_then(|query| query.render_pass_timestamp_writes()),
                ..Default::default()
            });
            // It ends with this closure, before the encoder is used again.
            record(&mut pass.forget_lifetime());
        });
    }

    /// Times what `record` records into the encoder; by the wall's clock the milliseconds are known
    /// at once.
    fn pass(
        &mut self,
        label: &str,
        record: impl FnOnce(&mut wgpu::CommandEncoder, Option<&GpuProfilerQuery>),
    ) -> Option<f64> {
        match self.timing.as_mut().map(|timing| &mut timing.clock) {
            Some(Clock::Gpu { .. }) if self.whole.is_some() => {
                record(&mut self.encoder, None);
                None
            }
            Some(Clock::Gpu { profiler, .. }) => {
                let query = profiler.begin_pass_query(label, &mut self.encoder);
                record(&mut self.encoder, Some(&query));
                profiler.end_query(&mut self.encoder, query);
                None
            }
            Some(Clock::Wall { current, .. }) => {
                let next = self.device.create_command_encoder(&Default::default());
                let before = mem::replace(&mut self.encoder, next);
                finish(&self.device, &self.queue, before);
                let start = Instant::now();
                record(&mut self.encoder, None);
                let next = self.device.create_command_encoder(&Default::default());
                let pass = mem::replace(&mut self.encoder, next);
                finish(&self.device, &self.queue, pass);
                let elapsed_ms = start.elapsed().as_secs_f64() * 1e3;
                *current.passes_ms.entry(label.to_owned()).or_default() += elapsed_ms;
                current.frame_ms += elapsed_ms;
                Some(elapsed_ms)
            }
            Some(Clock::None) | None => {
                record(&mut self.encoder, None);
                None
            }
        }
    }

    /// Submits the work; its times come from [`Timing::next_frame`] when it is done.
    ///
    /// # Errors
    /// [`GpuError::Device`] when timestamps were left open.
    pub fn submit(mut self, gpu: &Gpu) -> Result<wgpu::SubmissionIndex, GpuError> {
        let clock = self.timing.map(|timing| &mut timing.clock);
        let Some(Clock::Gpu { profiler, .. }) = clock else {
            if let Some(Clock::Wall { current, finished }) = clock {
                finished.push_back(mem::take(current));
            }
            return Ok(gpu.queue.submit([self.encoder.finish()]));
        };
        if let Some(query) = self.whole.take() {
            profiler.end_query(&mut self.encoder, query);
        }
        profiler.resolve_queries(&mut self.encoder);
        let index = gpu.queue.submit([self.encoder.finish()]);
        profiler
            .end_frame()
            .map_err(|error| GpuError::Device(error.to_string()))?;
        Ok(index)
    }
}

fn begin_compute_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    query: Option<&'a GpuProfilerQuery>,
) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: query.and_then(|query| query.compute_pass_timestamp_writes()),
    })
}

/// Submits and waits. A device that is lost here is still lost, and said to be, at the next wait
/// that returns a result.
fn finish(device: &wgpu::Device, queue: &wgpu::Queue, encoder: wgpu::CommandEncoder) {
    queue.submit([encoder.finish()]);
    let _ = device.poll(wgpu::PollType::wait_indefinitely());
}
