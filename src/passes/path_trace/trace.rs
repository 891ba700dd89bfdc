//! Pass `path_trace/trace`: an unbiased picture of the world, sample by sample. Knows no probes.

use super::Chunk;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    measure::picture::Picture,
};

crate::shared! {
    in path_trace;

    /// What a dispatch is to do.
    pub struct GpuTraceJob as TraceJob {
        /// Tiles of this dispatch, in the order of `tile_of`.
        pub first_tile: u32,
        pub end_tile: u32,
        /// Tiles along a row of the picture, and in all.
        pub tiles_across: u32,
        pub tiles: u32,
        /// Samples of this dispatch.
        pub first_sample: u32,
        pub end_sample: u32,
        /// log2 of the places that scattered tiles are counted in; 0: they are counted row by row.
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

/// The kernels, and what they add up.
pub struct PathTrace {
    begin: (Kernel, Bindings),
    trace: (Kernel, Bindings),
    job: wgpu::Buffer,
    /// RGB: what is not random; RGB: sum, A: number of samples, twice.
    certain: wgpu::Buffer,
    sums: wgpu::Buffer,
    totals: wgpu::Buffer,
    size: [u32; 2],
}

/// The last step of [`PathTrace`] where its pictures are shown: the mean so far, as linear HDR.
pub struct Resolve {
    kernel: Kernel,
    bindings: Bindings,
    size: [u32; 2],
    /// `rgba16float`, rows from the top, as pass `view/shade` writes it.
    pub hdr: wgpu::Texture,
}

impl PathTrace {
    /// Bytes of each of the three buffers.
    pub const BYTES_PER_PIXEL: u64 = 16;
    /// Most samples that a pixel's sums hold with a relative error far below 1e-5.
    pub const MOST_SAMPLES: u32 = 1 << 20;

    /// For pictures of `size` pixels. `resources` are those of the voxels, the view, the lights, the
    /// materials and what shines.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let bytes = u64::from(size[0]) * u64::from(size[1]) * Self::BYTES_PER_PIXEL;
        let buffer = |label| gpu.storage_buffer(label, bytes);
        let (certain, sums, totals) = (buffer("certain")?, buffer("sums")?, buffer("totals")?);
        let job = gpu.uniform_buffer("job", &GpuTraceJob::default());
        let mut all = resources.to_vec();
        all.push(("job", job.as_entire_binding()));
        all.push(("certain", certain.as_entire_binding()));
        all.push(("sums", sums.as_entire_binding()));
        all.push(("totals", totals.as_entire_binding()));
        let entry = |entry| -> Result<(Kernel, Bindings), GpuError> {
            let kernel = Kernel::new(
                gpu,
                &KernelSpec {
                    shader: "path_trace/trace",
                    entry,
                    // Paths scatter.
                    overrides: &[("COHERENT", 0.0)],
                    ..Default::default()
                },
            )?;
            let bindings = kernel.bind(gpu, &all);
            Ok((kernel, bindings))
        };
        Ok(Self {
            begin: entry("begin")?,
            trace: entry("trace")?,
            job,
            certain,
            sums,
            totals,
            size,
        })
    }

    /// Tiles of the picture, as a [`Schedule`](super::Schedule) counts them.
    pub fn tiles(&self) -> u32 {
        let [across, down] = self.size.map(|edge| edge.div_ceil(TILE));
        across * down
    }

    /// Forgets all samples of these tiles, and finds what is not random about them. One slice a
    /// submission, as for [`trace`](Self::trace).
    pub fn begin(&self, gpu: &Gpu, recorder: &mut Recorder<'_>, chunk: &Chunk, antialias: bool) {
        self.record(gpu, recorder, &self.begin, chunk, antialias);
    }

    /// Adds these samples. One slice a submission: its numbers lie in one uniform.
    pub fn trace(&self, gpu: &Gpu, recorder: &mut Recorder<'_>, chunk: &Chunk, antialias: bool) {
        self.record(gpu, recorder, &self.trace, chunk, antialias);
    }

    fn record(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        (kernel, bindings): &(Kernel, Bindings),
        chunk: &Chunk,
        antialias: bool,
    ) {
        let job = GpuTraceJob {
            first_tile: chunk.places.start,
            end_tile: chunk.places.end,
            tiles_across: self.size[0].div_ceil(TILE),
            tiles: self.tiles(),
            first_sample: chunk.samples.start,
            end_sample: chunk.samples.end,
            scatter_bits: chunk.scatter_bits,
            antialias: u32::from(antialias),
        };
        gpu.queue
            .write_buffer(&self.job, 0, bytemuck::bytes_of(&job));
        let groups = chunk.places.len() as u32;
        recorder.compute("path_trace/trace", |pass| {
            let [width, rows] = rectangle(groups);
            kernel.dispatch(pass, bindings, [width, rows, 1]);
        });
    }

    /// What shows the picture so far; `resources` are those of the view.
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
        all.push(("certain", self.certain.as_entire_binding()));
        all.push(("sums", self.sums.as_entire_binding()));
        all.push(("totals", self.totals.as_entire_binding()));
        all.push(("traced_hdr", wgpu::BindingResource::TextureView(&view)));
        Ok(Resolve {
            bindings: kernel.bind(gpu, &all),
            kernel,
            size: self.size,
            hdr,
        })
    }

    /// Forgets all samples, and keeps what is not random.
    pub fn clear(&self, recorder: &mut Recorder<'_>) {
        for buffer in [&self.sums, &self.totals] {
            recorder.encoder.clear_buffer(buffer, 0, None);
        }
    }

    /// What is not random: linear radiance, or the view's data (depth in voxels).
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_certain(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let [width, height] = self.size;
        let certain = self.read(gpu, &self.certain)?;
        Ok(Picture {
            width,
            height,
            rgb: certain.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        })
    }

    /// Of each pixel the sum of the samples since [`clear`](Self::clear), and how many they are. `samples`: how
    /// many they are expected to be.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_sums(&self, gpu: &Gpu, samples: u32) -> Result<Vec<[f32; 4]>, GpuError> {
        let mut sums = self.read(gpu, &self.sums)?;
        if sums.iter().any(|sum| sum[3] != samples as f32) {
            // Others have moved on.
            for (sum, total) in sums.iter_mut().zip(self.read(gpu, &self.totals)?) {
                *sum = std::array::from_fn(|channel| total[channel] + sum[channel]);
            }
        }
        Ok(sums)
    }

    fn read(&self, gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<[f32; 4]>, GpuError> {
        let bytes = u64::from(self.size[0]) * u64::from(self.size[1]) * Self::BYTES_PER_PIXEL;
        gpu.read_buffer_range(buffer, 0, bytes)
    }
}

impl Resolve {
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("path_trace/trace", |pass| {
            let size = [self.size[0], self.size[1], 1];
            self.kernel.dispatch_threads(pass, &self.bindings, size);
        });
    }
}
