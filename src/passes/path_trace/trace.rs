//! Pass `path_trace/trace`: an unbiased picture of the world, sample by sample. It uses no probes.
//!
//! The loop over the samples, which the window, `grotto reference` and `grotto judge` share, is here too.

use std::{
    collections::VecDeque,
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use super::{
    Blocks, Sampled,
    schedule::{Chunk, Schedule},
    sums::Sums,
};
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    measure::block_sums::BlockSums,
};

crate::shared! {
    in path_trace;

    /// The work of one dispatch.
    pub struct GpuTraceJob as TraceJob {
        /// Tiles of this dispatch, in the order of `tile_of`.
        pub first_tile: u32,
        pub end_tile: u32,
        /// Tiles along a row of the picture, and tiles in all.
        pub tiles_across: u32,
        pub tiles: u32,
        /// Samples of this dispatch.
        pub first_sample: u32,
        pub end_sample: u32,
        /// log2 of the number of places among which tiles are scattered; 0: tiles are counted row by row.
        pub scatter_bits: u32,
        /// 1: samples spread over the pixel; 0: all of them look through its centre.
        pub antialias: u32,
    }
}

crate::shared! {
    in path_trace;

    /// Edge of a tile in pixels, and of a workgroup in threads.
    const TILE: u32 = 8;
}

/// A picture of one size that gains samples step by step.
pub struct PathTrace {
    begin: (Kernel, Bindings),
    trace: (Kernel, Bindings),
    job: wgpu::Buffer,
    sums: Sums,
    size: [u32; 2],
    /// Whether samples are spread over each pixel; else all go through the pixel's centre.
    antialias: bool,
    schedule: Schedule,
    /// Number of the sample that the schedule counts as 0.
    first_sample: u32,
    /// Work of each step whose time is not known yet, the oldest first.
    pending: VecDeque<u64>,
}

/// Shows the pictures of [`PathTrace`]: the mean so far, as linear HDR.
pub struct Resolve {
    kernel: Kernel,
    bindings: Bindings,
    size: [u32; 2],
    /// `rgba16float`, rows from the top, as pass `view/shade` writes it.
    pub hdr: wgpu::Texture,
}

impl PathTrace {
    /// Bytes of each of the three buffers.
    pub const BYTES_PER_PIXEL: u64 = Sums::BYTES_PER_PIXEL;
    /// Largest number of samples that a pixel's sums hold with a relative error far below 1e-5.
    pub const MOST_SAMPLES: u32 = 1 << 20;

    /// For pictures of `size` pixels. `antialias` spreads the samples over each pixel; else all go through the pixel's
    /// centre. `scene` is the offer of the voxels, the bodies, the view, the lights, the materials and the emitters.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        antialias: bool,
        scene: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let sums = Sums::new(gpu, size)?;
        let job = gpu.uniform_buffer("job", &GpuTraceJob::default());
        let mut all = scene.resources.clone();
        all.push(("job", job.as_entire_binding()));
        all.extend(sums.resources());
        let entry = |entry| -> Result<(Kernel, Bindings), GpuError> {
            let kernel = Kernel::new(
                gpu,
                &KernelSpec {
                    shader: "path_trace/trace",
                    entry,
                    // Paths scatter.
                    overrides: &[("COHERENT", 0.0)],
                    offered: &scene.constants,
                    ..Default::default()
                },
            )?;
            let bindings = kernel.bind(gpu, &all);
            Ok((kernel, bindings))
        };
        let [across, down] = size.map(|edge| edge.div_ceil(TILE));
        Ok(Self {
            begin: entry("begin")?,
            trace: entry("trace")?,
            job,
            sums,
            size,
            antialias,
            schedule: Schedule::new(across * down, 0),
            first_sample: 0,
            pending: VecDeque::new(),
        })
    }

    /// Starts again after the view or the lights have changed: forgets all samples, and finds the light that is not
    /// random.
    ///
    /// The restart is a submission of its own, so the next frame shows no earlier samples.
    ///
    /// # Errors
    /// [`GpuError`] when the device does not take the work.
    pub fn restart(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        self.first_sample = 0;
        self.schedule.restart(Self::MOST_SAMPLES);
        let mut recorder = Recorder::new(gpu, None);
        self.record(gpu, &mut recorder, &self.begin, &self.schedule.all_tiles());
        recorder.submit(gpu)?;
        Ok(())
    }

    /// Records the next samples, as many as measured times allow. A submission may hold only one step, because all
    /// steps write the same uniform.
    pub fn step(&mut self, gpu: &Gpu, recorder: &mut Recorder<'_>) {
        let Some(mut chunk) = self.schedule.next_chunk() else {
            return;
        };
        self.pending.push_back(chunk.work);
        let Range { start, end } = chunk.samples;
        chunk.samples = start + self.first_sample..end + self.first_sample;
        self.record(gpu, recorder, &self.trace, &chunk);
    }

    /// Learns the time (milliseconds) of the oldest step whose time was not known yet.
    pub fn took(&mut self, ms: f64) {
        if let Some(work) = self.pending.pop_front() {
            self.schedule.took(work, ms);
        }
    }

    /// Samples that every pixel has since the last restart.
    pub fn samples(&self) -> u32 {
        self.schedule.complete()
    }

    /// Finds the light that is not random, then traces the blocks `wanted` of `blocks`, and reads and adds their
    /// sums.
    ///
    /// `progress` receives (samples done, samples in all), counted in tiles. Once `cancel` is set, the rest is left out.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn trace_blocks(
        &mut self,
        gpu: &Gpu,
        blocks: Blocks,
        wanted: &Range<u32>,
        progress: &dyn Fn(u64, u64),
        cancel: &AtomicBool,
    ) -> Result<Sampled, GpuError> {
        let tiles = self.schedule.tiles();
        let mut schedule = Schedule::new(tiles, 1);
        while let Some(chunk) = schedule.next_chunk() {
            let ms = timed(gpu, |recorder| {
                self.record(gpu, recorder, &self.begin, &chunk);
            })?;
            schedule.took(chunk.work, ms);
        }
        let mut sampled = Sampled {
            certain: self.sums.read_certain(gpu)?,
            sums: BlockSums::new(wanted.start),
            unfinished: None,
            samples: 0,
        };

        let in_all = u64::from(tiles) * blocks.samples(wanted).len() as u64;
        for block in wanted.clone() {
            let samples = blocks.samples(&(block..block + 1));
            self.first_sample = samples.start;
            self.schedule.restart(samples.len() as u32);
            timed(gpu, |recorder| self.sums.clear(recorder))?;
            while !self.schedule.is_done() && !cancel.load(Ordering::Relaxed) {
                let ms = timed(gpu, |recorder| self.step(gpu, recorder))?;
                self.took(ms);
                let before = u64::from(tiles) * u64::from(sampled.samples);
                progress(before + self.schedule.done(), in_all);
            }
            let complete = self.samples();
            sampled.samples += complete;
            let read = self.sums.read(gpu, complete)?;
            if complete < samples.len() as u32 {
                sampled.unfinished = Some(read);
                break;
            }
            let rgb = read.iter().map(|[r, g, b, _]| [*r, *g, *b]);
            sampled.sums.push(rgb.collect());
        }
        Ok(sampled)
    }

    fn record(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        (kernel, bindings): &(Kernel, Bindings),
        chunk: &Chunk,
    ) {
        let job = GpuTraceJob {
            first_tile: chunk.places.start,
            end_tile: chunk.places.end,
            tiles_across: self.size[0].div_ceil(TILE),
            tiles: self.schedule.tiles(),
            first_sample: chunk.samples.start,
            end_sample: chunk.samples.end,
            scatter_bits: chunk.scatter_bits,
            antialias: u32::from(self.antialias),
        };
        gpu.queue
            .write_buffer(&self.job, 0, bytemuck::bytes_of(&job));
        let groups = chunk.places.len() as u32;
        recorder.compute("path_trace/trace", |pass| {
            let [width, rows] = rectangle(groups);
            kernel.dispatch(pass, bindings, [width, rows, 1]);
        });
    }

    /// Makes the kernel that shows the picture so far; `resources` are those of the view.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn resolve(
        &self,
        gpu: &Gpu,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Resolve, GpuError> {
        let [width, height] = self.size;
        let format = wgpu::TextureFormat::Rgba16Float;
        let hdr = gpu.texture("traced_hdr", [width, height, 1], format)?;
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "path_trace/trace",
                entry: "resolve",
                ..Default::default()
            },
        )?;
        let view = hdr.create_view(&Default::default());
        let mut all = resources.to_vec();
        all.extend(self.sums.resources());
        all.push(("traced_hdr", wgpu::BindingResource::TextureView(&view)));
        Ok(Resolve {
            bindings: kernel.bind(gpu, &all),
            kernel,
            size: self.size,
            hdr,
        })
    }
}

/// Submits what `record` records, waits for it, and returns the milliseconds of all three steps.
fn timed(gpu: &Gpu, record: impl FnOnce(&mut Recorder<'_>)) -> Result<f64, GpuError> {
    let start = Instant::now();
    let mut recorder = Recorder::new(gpu, None);
    record(&mut recorder);
    recorder.submit(gpu)?;
    gpu.wait()?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

impl Resolve {
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("path_trace/trace", |pass| {
            let size = [self.size[0], self.size[1], 1];
            self.kernel.dispatch_threads(pass, &self.bindings, size);
        });
    }
}
