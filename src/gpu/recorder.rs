//! Records passes into one submission and has them timed.

use std::{mem, ops::Range, sync::Arc, time::Instant};

use wgpu_profiler::GpuProfilerQuery;

use super::{
    Bindings, Gpu, GpuError, Kernel, Timing,
    dispatch_chunks::{ChunkArguments, ChunkTime, DispatchChunks, MOST_ROWS, first_groups},
    learner::Learner,
    timing::{Clock, WHOLE},
};

/// Records the passes of one frame (or of one piece of work), each with its own time.
pub struct Recorder<'a> {
    pub encoder: wgpu::CommandEncoder,
    device: wgpu::Device,
    queue: wgpu::Queue,
    timing: Option<&'a mut Timing>,
    /// Open from the first pass to the last if passes are not timed one by one.
    whole: Option<GpuProfilerQuery>,
    /// The pass that [`concurrent`](Self::concurrent) passes share.
    shared: Option<wgpu::ComputePass<'static>>,
    first_groups: u32,
    arguments: ChunkArguments,
    /// Whether a CPU does the work: it writes timestamps late, not when a pass runs.
    is_software: bool,
    /// Times the passes whose chunk time is not learned otherwise.
    learner: Option<Learner>,
    dispatches: u32,
}

/// How the chunk time of a kernel learns from a pass.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Learning {
    /// Not at all.
    Not,
    /// From the times of this recorder's [`Timing`].
    Timed,
    /// From two timestamps of the GPU.
    Stamped,
    /// By waiting for the pass.
    Waiting,
}

/// How the start and end of a pass are timed.
enum Stamps<'a> {
    None,
    Query(&'a GpuProfilerQuery),
    Own(wgpu::ComputePassTimestampWrites<'a>),
}

impl<'a> Recorder<'a> {
    pub fn new(gpu: &Gpu, timing: Option<&'a mut Timing>) -> Self {
        let timing = timing.map(Timing::begun);
        Self {
            encoder: gpu.device.create_command_encoder(&Default::default()),
            device: gpu.device.clone(),
            queue: gpu.queue.clone(),
            timing,
            whole: None,
            shared: None,
            first_groups: gpu.first_groups,
            arguments: gpu.chunk_arguments.clone(),
            is_software: gpu.summary.is_software(),
            learner: None,
            dispatches: 0,
        }
    }

    /// Times the frame as a whole if the adapter's clock can: timestamps between the passes take time
    /// themselves.
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

    /// A compute pass under the kernel's label: columns and rows of workgroups, in enough dispatches
    /// that none of them holds the GPU for long (one, on a fast GPU). The shader adds `first_row` of
    /// `shaders/frame/chunk.wesl` to its row; its output must not depend on the order of its
    /// workgroups.
    ///
    /// # Panics
    /// With more than 4096 rows.
    pub fn run(&mut self, kernel: &Kernel, bindings: &Bindings, groups: [u32; 2]) {
        self.run_rows(kernel, bindings, groups, None);
    }

    /// The same for work whose size the GPU knows: columns and rows in three u32 at `offset` of
    /// `buffer`, with exactly the rows of `most` and at most its columns.
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
        let (label, chunk_time) = (&*kernel.label, &bindings.chunk_time);
        let learning = self.learning(chunk_time);
        if matches!(learning, Learning::Stamped | Learning::Waiting) {
            // Concurrent passes have no times of their own.
            self.shared = None;
        }
        let first = first_groups(self.first_groups, kernel.workgroup_size);
        let dispatch_chunks = DispatchChunks::new(chunk_time, [width, rows], first);
        let one_by_one = indirect.is_some() || self.waits() || learning == Learning::Waiting;
        if one_by_one {
            for chunk in dispatch_chunks {
                self.dispatches += 1;
                let groups = (chunk.end - chunk.start) * width;
                let learner = (learning, chunk_time, groups);
                let elapsed_ms = match indirect {
                    Some(arguments) => {
                        self.run_some_rows(kernel, bindings, chunk, rows, arguments, learner)
                    }
                    None => self.compute_timed(label, learner, |pass| {
                        kernel.dispatch_rows(pass, bindings, width, chunk);
                    }),
                };
                if let Some(elapsed_ms) = elapsed_ms {
                    tracing::trace!("{label}: {groups} workgroups in {elapsed_ms:.1} ms");
                    chunk_time.learn(groups, elapsed_ms);
                }
            }
        } else {
            let dispatch_chunks: Vec<_> = dispatch_chunks.collect();
            self.dispatches += dispatch_chunks.len() as u32;
            self.compute_timed(label, (learning, chunk_time, rows * width), |pass| {
                for chunk in dispatch_chunks {
                    kernel.dispatch_rows(pass, bindings, width, chunk);
                }
            });
        }
        if let (Some(timing), Learning::Timed) = (&mut self.timing, learning) {
            timing.teach(label, chunk_time, rows * width);
        }
    }

    /// Whether passes are timed by waiting for each.
    fn waits(&self) -> bool {
        let clock = self.timing.as_ref().map(|timing| &timing.clock);
        matches!(clock, Some(Clock::Wall { .. }))
    }

    /// How the next pass teaches its kernel's chunk time.
    fn learning(&mut self, chunk_time: &ChunkTime) -> Learning {
        match self.timing.as_ref().map(|timing| &timing.clock) {
            Some(Clock::Wall { .. }) => Learning::Waiting,
            Some(Clock::Gpu { .. }) if self.whole.is_none() => Learning::Timed,
            _ if !chunk_time.is_due() => Learning::Not,
            _ if self.is_software => Learning::Waiting,
            _ => {
                self.learner = self.learner.take().or_else(|| Learner::new(&self.device));
                match self.learner {
                    Some(_) => Learning::Stamped,
                    None => Learning::Waiting,
                }
            }
        }
    }

    /// Number of dispatches that [`run`](Self::run) and [`run_indirect`](Self::run_indirect) have made
    /// so far.
    pub fn dispatches(&self) -> u32 {
        self.dispatches
    }

    /// Passes that the GPU may run concurrently if passes are not timed one by one. A pass that writes
    /// a resource bound by another still waits for it.
    pub fn concurrent<T>(&mut self, record: impl FnOnce(&mut Self) -> T) -> T {
        let one_by_one = match self.timing.as_ref().map(|timing| &timing.clock) {
            Some(Clock::Gpu { .. }) => self.whole.is_none(),
            Some(Clock::Wall { .. }) => true,
            Some(Clock::None) | None => false,
        };
        if !one_by_one {
            let pass = self.encoder.begin_compute_pass(&Default::default());
            self.shared = Some(pass.forget_lifetime());
        }
        let written = record(self);
        self.shared = None;
        written
    }

    /// One chunk of work whose number of columns the GPU knows. Returns its milliseconds if they are
    /// known at once.
    fn run_some_rows(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        chunk: Range<u32>,
        rows: u32,
        (buffer, offset): (&wgpu::Buffer, u64),
        learner: (Learning, &Arc<ChunkTime>, u32),
    ) -> Option<f64> {
        let arguments = self.arguments.clone();
        let is_whole = chunk == (0..rows);
        if let (Some(pass), true) = (&mut self.shared, is_whole) {
            kernel.dispatch_indirect(pass, bindings, chunk.start, buffer, offset);
            return None;
        }
        // A copy between passes ends the shared one.
        self.shared = None;
        self.pass(&kernel.label, Some(learner), |encoder, stamps| {
            if !is_whole {
                arguments.write(encoder, (buffer, offset), chunk.end - chunk.start);
            }
            let pass = &mut begin_compute_pass(encoder, &kernel.label, stamps);
            let (buffer, offset) = if is_whole {
                (buffer, offset)
            } else {
                (arguments.buffer(), 0)
            };
            kernel.dispatch_indirect(pass, bindings, chunk.start, buffer, offset);
        })
    }

    /// A compute pass under this label.
    pub fn compute(&mut self, label: &str, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        if let Some(pass) = &mut self.shared {
            record(pass);
            return;
        }
        self.pass(label, None, |encoder, stamps| {
            record(&mut begin_compute_pass(encoder, label, stamps));
        });
    }

    /// Returns the milliseconds if they are known at once.
    fn compute_timed(
        &mut self,
        label: &str,
        learner: (Learning, &Arc<ChunkTime>, u32),
        record: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) -> Option<f64> {
        if let Some(pass) = &mut self.shared {
            record(pass);
            return None;
        }
        self.pass(label, Some(learner), |encoder, stamps| {
            record(&mut begin_compute_pass(encoder, label, stamps));
        })
    }

    /// A render pass under this label that clears all of `target` to black and draws on it.
    pub fn render(
        &mut self,
        label: &str,
        target: &wgpu::TextureView,
        record: impl FnOnce(&mut wgpu::RenderPass<'static>),
    ) {
        self.pass(label, None, |encoder, stamps| {
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
                timestamp_writes: match stamps {
                    Stamps::Query(query) => query.render_pass_timestamp_writes(),
                    Stamps::None | Stamps::Own(_) => None,
                },
                ..Default::default()
            });
            // It ends with this closure, before the encoder is used again.
            record(&mut pass.forget_lifetime());
        });
    }

    /// Times the commands that `record` adds to the encoder; if the time is found by waiting, returns
    /// the milliseconds at once. Otherwise the chunk time in `learner` learns later, with its number of
    /// workgroups.
    fn pass(
        &mut self,
        label: &str,
        learner: Option<(Learning, &Arc<ChunkTime>, u32)>,
        record: impl FnOnce(&mut wgpu::CommandEncoder, Stamps<'_>),
    ) -> Option<f64> {
        let whole = self.whole.is_some();
        match self.timing.as_mut().map(|timing| &mut timing.clock) {
            Some(Clock::Gpu { profiler, .. }) if !whole => {
                let query = profiler.begin_pass_query(label, &mut self.encoder);
                record(&mut self.encoder, Stamps::Query(&query));
                profiler.end_query(&mut self.encoder, query);
                None
            }
            Some(Clock::Wall { .. }) => {
                let elapsed_ms = self.wait_for(record);
                if let Some(Clock::Wall { current, .. }) =
                    self.timing.as_mut().map(|timing| &mut timing.clock)
                {
                    *current.passes_ms.entry(label.to_owned()).or_default() += elapsed_ms;
                    current.frame_ms += elapsed_ms;
                }
                Some(elapsed_ms)
            }
            _ => match (learner, &mut self.learner) {
                (Some((Learning::Waiting, ..)), _) => Some(self.wait_for(record)),
                (Some((Learning::Stamped, chunk_time, groups)), Some(learner)) => {
                    let stamps = learner.stamps(chunk_time, groups);
                    record(&mut self.encoder, stamps.map_or(Stamps::None, Stamps::Own));
                    None
                }
                _ => {
                    record(&mut self.encoder, Stamps::None);
                    None
                }
            },
        }
    }

    /// Milliseconds from the submission of the commands of `record` to their end. Earlier work is
    /// submitted and waited for first.
    fn wait_for(&mut self, record: impl FnOnce(&mut wgpu::CommandEncoder, Stamps<'_>)) -> f64 {
        self.flush();
        let start = Instant::now();
        record(&mut self.encoder, Stamps::None);
        self.flush();
        start.elapsed().as_secs_f64() * 1e3
    }

    /// Submits everything recorded so far, and waits. A device that is lost here is reported at the
    /// next wait that returns a result.
    fn flush(&mut self) {
        let next = self.device.create_command_encoder(&Default::default());
        let before = mem::replace(&mut self.encoder, next);
        self.queue.submit([before.finish()]);
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// Submits the work; its times come from [`Timing::next_frame`] when it is done.
    ///
    /// # Errors
    /// [`GpuError::Device`] if timestamps were left open.
    pub fn submit(mut self, gpu: &Gpu) -> Result<wgpu::SubmissionIndex, GpuError> {
        let mut clock = self.timing.map(|timing| &mut timing.clock);
        match &mut clock {
            Some(Clock::Gpu { profiler, .. }) => {
                if let Some(query) = self.whole.take() {
                    profiler.end_query(&mut self.encoder, query);
                }
                profiler.resolve_queries(&mut self.encoder);
            }
            Some(Clock::Wall { current, finished }) => finished.push_back(mem::take(current)),
            Some(Clock::None) | None => {}
        }
        let index = match self.learner {
            Some(learner) => learner.submit(gpu, self.encoder),
            None => gpu.queue.submit([self.encoder.finish()]),
        };
        if let Some(Clock::Gpu { profiler, .. }) = clock {
            profiler
                .end_frame()
                .map_err(|error| GpuError::Device(error.to_string()))?;
        }
        Ok(index)
    }
}

fn begin_compute_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    stamps: Stamps<'_>,
) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: match stamps {
            Stamps::None => None,
            Stamps::Query(query) => query.compute_pass_timestamp_writes(),
            Stamps::Own(writes) => Some(writes),
        },
    })
}
