//! Path tracing on the GPU, block by block, so that the sum does not depend on which part traces which block.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use super::super::Failure;
use crate::{
    frame::{self, Stage},
    gpu::{Gpu, Recorder, ShaderLibrary},
    lights::Lights,
    measure::{block_sums::BlockSums, picture::Picture},
    passes::{
        path_trace::{Chunk, Schedule, trace::PathTrace},
        scene::GpuLights,
        view::ViewMode,
    },
    reference::View,
    world::{Camera, ResponseSpec, World},
};

/// What to trace.
pub struct TraceRequest<'a> {
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    pub view: View,
    /// Samples (paths) per pixel: 1 to [`PathTrace::MOST_SAMPLES`].
    pub spp: u32,
    pub seed: u32,
    /// Whether textures are visible; else every texture is replaced by its mean.
    pub textures: bool,
    /// Spreads the samples over the pixel; else all pass through its centre.
    pub antialias: bool,
}

/// The result of a [`TraceRequest`].
pub struct Traced {
    /// Linear Rec. 709 radiance, or the view's data; depth in voxels, 0 where there is no surface.
    pub picture: Picture,
    /// Samples that every pixel has: fewer than requested after a cancellation. Views without randomness need
    /// none, and report the requested number.
    pub spp: u32,
    /// Exposed faces of emissive voxels.
    pub emitters: usize,
}

/// Most blocks of a picture.
const MOST_BLOCKS: u32 = 64;
/// Fewest samples of a block, except the last: reading a block back must cost less than tracing it.
const LEAST_SAMPLES: u32 = 8;

/// The samples of a picture in blocks. Each block is summed, and the sums are added as [`BlockSums`] says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    samples: u32,
    /// Samples of each block, except the last.
    size: u32,
}

impl Blocks {
    /// No blocks where nothing about the picture is random.
    pub fn of(request: &TraceRequest<'_>) -> Self {
        let random = request.antialias
            || matches!(request.view, View::Full | View::Indirect | View::Irradiance);
        Self::of_samples(if random { request.spp } else { 0 })
    }

    fn of_samples(samples: u32) -> Self {
        let size = samples.div_ceil(MOST_BLOCKS).next_power_of_two();
        Self {
            samples,
            size: size.max(LEAST_SAMPLES),
        }
    }

    /// The number of blocks.
    pub fn count(self) -> u32 {
        self.samples.div_ceil(self.size)
    }

    /// The samples of these blocks.
    pub fn samples(self, blocks: &Range<u32>) -> Range<u32> {
        let edge = |block: u32| (block * self.size).min(self.samples);
        edge(blocks.start)..edge(blocks.end)
    }
}

/// The traced samples of some blocks of a picture.
pub struct Sampled {
    /// The part that is not random: linear Rec. 709 radiance, or the view's data.
    pub certain: Picture,
    pub sums: BlockSums,
    /// For each pixel, the sum and the number of samples of the block that was cancelled.
    unfinished: Option<Vec<[f32; 4]>>,
    /// Samples that every pixel has.
    pub samples: u32,
}

/// Path-traces a picture on the GPU.
///
/// The picture depends only on the arguments and the adapter. `progress` receives (samples done, samples in
/// all), counted in tiles. Once `cancel` is set, the remaining samples are left out; pixels without a sample
/// then show the light that is not random.
///
/// # Errors
/// When the adapter cannot hold the picture, and when it fails later.
pub fn trace(
    gpu: &Gpu,
    stage: &Stage,
    lights: &Lights,
    request: &TraceRequest<'_>,
    progress: &dyn Fn(u64, u64),
    cancel: &AtomicBool,
) -> Result<Traced, Failure> {
    let blocks = Blocks::of(request);
    let all = 0..blocks.count();
    let sampled = trace_blocks(gpu, stage, lights, request, &all, progress, cancel)?;
    Ok(Traced {
        picture: sampled.picture(blocks),
        spp: if blocks.samples == 0 {
            request.spp
        } else {
            sampled.samples
        },
        emitters: stage.emitters.known.faces.len(),
    })
}

/// Path-traces some blocks of a picture; [`trace`] traces all of them.
///
/// # Errors
/// See [`trace`].
pub fn trace_blocks(
    gpu: &Gpu,
    stage: &Stage,
    lights: &Lights,
    request: &TraceRequest<'_>,
    wanted: &Range<u32>,
    progress: &dyn Fn(u64, u64),
    cancel: &AtomicBool,
) -> Result<Sampled, Failure> {
    let gpu_lights = GpuLights::new(gpu);
    gpu_lights.set(gpu, lights);
    let view = crate::passes::view::View {
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
    let record = |record: &dyn Fn(&mut Recorder<'_>)| -> Result<f64, Failure> {
        let start = Instant::now();
        let mut recorder = Recorder::new(gpu, None);
        record(&mut recorder);
        recorder.submit(gpu)?;
        gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    };
    let mut schedule = Schedule::new(pass.tiles(), 1);
    while let Some(chunk) = schedule.next_chunk() {
        let ms = record(&|recorder| pass.begin(gpu, recorder, &chunk, request.antialias))?;
        schedule.took(chunk.work, ms);
    }
    let certain = pass.read_certain(gpu)?;

    let blocks = Blocks::of(request);
    let first = blocks.samples(wanted).start;
    let tiles = u64::from(pass.tiles());
    let in_all = tiles * blocks.samples(wanted).len() as u64;
    let mut sums = BlockSums::new(wanted.start);
    let mut schedule = Schedule::new(pass.tiles(), 0);
    for block in wanted.clone() {
        let samples = blocks.samples(&(block..block + 1));
        schedule.restart(samples.len() as u32);
        record(&|recorder| pass.clear(recorder))?;
        let stopped = || cancel.load(Ordering::Relaxed);
        while !stopped()
            && let Some(chunk) = schedule.next_chunk()
        {
            let chunk = Chunk {
                samples: chunk.samples.start + samples.start..chunk.samples.end + samples.start,
                ..chunk
            };
            let ms = record(&|recorder| pass.trace(gpu, recorder, &chunk, request.antialias))?;
            schedule.took(chunk.work, ms);
            let before = u64::from(samples.start - first) * tiles;
            progress(before + schedule.done(), in_all);
        }
        let complete = schedule.complete();
        let read = pass.read_sums(gpu, complete)?;
        if complete < samples.len() as u32 {
            return Ok(Sampled {
                certain,
                sums,
                unfinished: Some(read),
                samples: samples.start - first + complete,
            });
        }
        sums.push(read.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect());
    }
    Ok(Sampled {
        certain,
        sums,
        unfinished: None,
        samples: blocks.samples(wanted).len() as u32,
    })
}

impl Sampled {
    /// Whether all blocks were traced without a cancellation.
    pub fn is_complete(&self) -> bool {
        self.unfinished.is_none()
    }

    /// The picture of which these are the first blocks.
    fn picture(&self, blocks: Blocks) -> Picture {
        let samples = blocks.samples(&self.sums.blocks()).end;
        let Some(unfinished) = &self.unfinished else {
            return self.sums.mean(&self.certain, samples);
        };
        // Each pixel is the mean of its own samples.
        let total = self.sums.total(self.certain.rgb.len());
        let pixel = |((sure, sum), more): ((&[f32; 3], &[f64; 3]), &[f32; 4])| {
            let count = (f64::from(samples) + f64::from(more[3])).max(1.0);
            std::array::from_fn(|channel| {
                let sum = sum[channel] + f64::from(more[channel]);
                (f64::from(sure[channel]) + sum / count) as f32
            })
        };
        let pixels = self.certain.rgb.iter().zip(&total).zip(unfinished);
        Picture {
            rgb: pixels.map(pixel).collect(),
            ..self.certain
        }
    }
}

/// Everything that the tracer sees of a world, as a text. Names, cameras, layouts and possible changes are left
/// out: they do not affect the world as it is.
pub fn content(world: &World, lights: &Lights) -> String {
    let mut world = world.clone();
    world.name.clear();
    world.title.clear();
    world.cameras.clear();
    world.layouts.clear();
    world.lamp_presets.clear();
    world.response = ResponseSpec::default();
    format!("{world:?} {lights:?}")
}

/// The sources of the tracer: as long as they are unchanged, its results are unchanged.
const SOURCES: [&str; 5] = [
    include_str!("trace.rs"),
    include_str!("../../lights/emitters.rs"),
    include_str!("../../lights/table.rs"),
    include_str!("../../measure/block_sums.rs"),
    include_str!("../../passes/path_trace/trace.rs"),
];

/// The text of all sources of the tracer, including those of its shader.
///
/// # Errors
/// When the shader cannot be composed.
pub fn sources(library: &ShaderLibrary) -> Result<String, Failure> {
    let shader = library.compose("path_trace/trace", &[])?;
    let mut text = SOURCES.concat();
    for name in &shader.sources {
        text += &format!("\n{name}\n{}", library.text(name).unwrap_or_default());
    }
    Ok(text)
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

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs, path::Path};

    use super::*;

    #[test]
    fn blocks_share_all_samples_and_are_few() {
        for samples in (0..300).chain([4096, 5000, PathTrace::MOST_SAMPLES]) {
            let blocks = Blocks::of_samples(samples);
            let count = blocks.count();
            assert!(count <= MOST_BLOCKS);
            assert_eq!(blocks.samples(&(0..count)), 0..samples);
            for block in 0..count {
                let one = blocks.samples(&(block..block + 1));
                assert!(!one.is_empty());
                let next = blocks.samples(&(block + 1..block + 1)).start;
                assert_eq!(one.end, next);
            }
        }
        assert_eq!(Blocks::of_samples(32).count(), 4);
        assert_eq!(Blocks::of_samples(256).count(), 32);
    }

    #[test]
    fn the_sources_are_the_same_in_every_run_and_an_edit_changes_them() {
        let embedded = ShaderLibrary::embedded();
        let texts: BTreeSet<String> = (0..20)
            .map(|_| sources(&embedded).expect("our own shaders"))
            .collect();
        assert_eq!(texts.len(), 1);

        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in embedded.names() {
            let path = folder.path().join(format!("{name}.wesl"));
            fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
            fs::write(path, embedded.text(name).expect("it has that name")).expect("writable");
        }
        let read = |folder: &Path| {
            let library = ShaderLibrary::from_folder(folder).expect("shaders");
            sources(&library).expect("they compose")
        };
        assert!(texts.contains(&read(folder.path())));
        let append = |name: &str| {
            let path = folder.path().join(name);
            let text = fs::read_to_string(&path).expect("it is there");
            fs::write(&path, text + "// edited\n").expect("writable");
        };
        append("probes/gather.wesl");
        assert!(
            texts.contains(&read(folder.path())),
            "the tracer does not use probes"
        );
        append("march/march.wesl");
        assert!(!texts.contains(&read(folder.path())), "it marches");
    }
}
