//! Pass `scene/voxelise`: turns the world's shape, rules and features into the brick map, on the GPU.
//!
//! `classify` evaluates the shape at the centre of every cell: the shape's bound decides most cells, and the others
//! become candidates. `solid` finds the solid voxels of the candidates. `survey` gives buried cells their material
//! and lists the cells beside air. `exposed` finishes the listed cells of a single material. `fill` makes the bricks
//! of all remaining cells, and `place` enters the bricks into the grid. Counts are read back between these steps,
//! so that every buffer has the size that it needs. The work is dispatched in chunks: no dispatch holds the GPU for
//! long.
//!
//! `world::generate`, the CPU's reference, defines which voxels result.

use std::time::{Duration, Instant};

use glam::UVec3;

use super::voxels::{GpuGridInfo, MASK_BYTES, MATERIAL_BYTES, with_spare_bricks};
use super::{GpuBodies, GpuVoxels};
use crate::gpu::{Bindings, EarlyShaders, Gpu, GpuError, Kernel, KernelSpec, Recorder, Timing};
use crate::world::World;
use crate::world::generate::FeatureBins;
use crate::world::noise::NoiseBank;
use crate::world::sdf::shape_module;
use crate::world::voxels::{CELL, grid_cells};

crate::shared! {
    in scene;

    /// The input of the kernels.
    pub struct GpuVoxeliseJob as Job {
        /// Extent of the world in voxels.
        pub size: [u32; 3],
        /// First item of this dispatch. An item belongs to a thread or a workgroup, depending on the entry point.
        pub first: u32,
        /// Extent in cells that the world touches.
        pub cells: [u32; 3],
        /// One past the last item.
        pub end: u32,
        /// Offsets of the rows and of the parts in `features` (words); without features, `part_count` is 0.
        pub rows_at: u32,
        pub parts_at: u32,
        pub part_count: u32,
        /// `fill`: entries are cells that are solid throughout, not indices of solid records.
        pub all_solid: u32,
        /// Entries of `fill`, for `place`.
        pub entry_count: u32,
        pub _pad: [u32; 3],
    }

    /// What the kernels count.
    pub struct GpuVoxeliseCounters as Counters {
        pub candidates: u32 => "atomic<u32>",
        /// Entries of `fill` among the candidates.
        pub mixed: u32 => "atomic<u32>",
        pub exposed: u32 => "atomic<u32>",
        /// Entries of `fill` among the exposed.
        pub varied: u32 => "atomic<u32>",
        pub bricks: u32 => "atomic<u32>",
    }

    /// Words of a solid record: its cell and sixteen words of its mask.
    const RECORD_WORDS: u32 = 17;
}

const RECORD_BYTES: u64 = 4 * RECORD_WORDS as u64;

/// Bytes of an entry of `fill`.
const ENTRY_BYTES: u64 = 8;

const SHADER: &str = "scene/voxelise";

/// The entry points, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Classify,
    Solid,
    Survey,
    Exposed,
    Fill,
    Place,
}

/// What a voxelisation produced, and its time and memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoxeliseReport {
    /// Sum of the dispatches; none where the adapter cannot time them.
    pub gpu_ms: Option<f64>,
    /// Its parts: classify, solid, survey, exposed, fill, place.
    pub stages_ms: [f64; 6],
    /// From start to end, without compilation, with the read-backs of counts.
    pub wall_ms: f64,
    /// Cells that the shape's bound left undecided, or that hold features.
    pub candidates: u32,
    /// Bricks in use.
    pub bricks: u32,
    /// Greatest sum of the buffers held at a time.
    pub peak_bytes: u64,
}

/// The kernels for one world.
pub struct Voxelise {
    classify: Kernel,
    solid: Kernel,
    survey: Kernel,
    exposed: Kernel,
    fill: Kernel,
    place: Kernel,
}

impl Voxelise {
    /// Compiles the world's shape.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, world: &World) -> Result<Self, GpuError> {
        let spec = KernelSpec {
            shader: SHADER,
            generated: &[("shape", &shape_module(world))],
            ..Default::default()
        };
        let entries = ["classify", "solid", "survey", "exposed", "fill", "place"];
        let [classify, solid, survey, exposed, fill, place] =
            Kernel::of_entries(gpu, &spec, entries)?;
        Ok(Self {
            classify,
            solid,
            survey,
            exposed,
            fill,
            place,
        })
    }

    /// Begins to compose the kernels for a world: most of what [`Voxelise::new`] does without a device.
    pub fn compose(shaders: &EarlyShaders, world: &World) {
        shaders.compose(SHADER, &[("shape", &shape_module(world))]);
    }

    /// Builds the brick map of the world that the kernels were compiled for. Its distances are left
    /// to the pass `scene/distances`.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] before anything too large is allocated, [`GpuError::Device`].
    pub fn run(&self, gpu: &Gpu, world: &World) -> Result<(GpuVoxels, VoxeliseReport), GpuError> {
        let start = Instant::now();
        let cells = grid_cells(world.size).to_array().map(u64::from);
        let grid_bytes = cells.iter().product::<u64>().saturating_mul(4);
        gpu.check_buffer("grid", grid_bytes)?;
        let mut work = Work::new(gpu, world)?;
        let mut held = Memory::default();
        // Fits, because the grid does.
        let touched = work.cells.element_product();
        let list_bytes = u64::from(touched) * 4;
        let grid = held.take(gpu, "grid", grid_bytes)?;
        let tables = NoiseBank::new(&world.noises).packed_tables();
        let tables = gpu.storage_buffer_of("noise_tables", &tables)?;
        let features = gpu.storage_buffer_of("features", &work.features)?;
        held.note(tables.size() + features.size());
        let info = gpu.uniform_buffer("grid_info", &GpuGridInfo::new(world.size, world.origin));
        let candidates = held.take(gpu, "candidates", list_bytes)?;
        let (job, counters) = (work.job_buffer.clone(), work.counters.clone());
        let common = [
            ("grid_info", info.as_entire_binding()),
            ("job", job.as_entire_binding()),
            ("counters", counters.as_entire_binding()),
            ("cell_words", grid.as_entire_binding()),
            ("noise_tables", tables.as_entire_binding()),
            ("features", features.as_entire_binding()),
        ];
        let bind = |kernel: &Kernel, more: &[(&'static str, &wgpu::Buffer)]| {
            let more = more
                .iter()
                .map(|(name, buffer)| (*name, buffer.as_entire_binding()));
            kernel.bind(gpu, &common.iter().cloned().chain(more).collect::<Vec<_>>())
        };

        let bindings = bind(&self.classify, &[("candidates", &candidates)]);
        work.dispatch(
            Stage::Classify,
            &self.classify,
            &bindings,
            touched.div_ceil(64),
        )?;
        let counted = work.counted()?;

        let candidate_count = u64::from(counted.candidates);
        let solid_records = held.take(gpu, "solid records", candidate_count * RECORD_BYTES)?;
        let mixed = held.take(gpu, "mixed cells", candidate_count * ENTRY_BYTES)?;
        let lists = [
            ("candidates", &candidates),
            ("solid_records", &solid_records),
            ("entries", &mixed),
        ];
        let bindings = bind(&self.solid, &lists);
        work.dispatch(Stage::Solid, &self.solid, &bindings, counted.candidates)?;
        held.release(candidates);

        let exposed_cells = held.take(gpu, "exposed cells", list_bytes)?;
        let lists = [
            ("solid_records", &solid_records),
            ("exposed_cells", &exposed_cells),
        ];
        let bindings = bind(&self.survey, &lists);
        work.dispatch(Stage::Survey, &self.survey, &bindings, touched.div_ceil(64))?;
        let counted = work.counted()?;

        let varied = held.take(
            gpu,
            "varied cells",
            u64::from(counted.exposed) * ENTRY_BYTES,
        )?;
        let [records, cells] = lists;
        let bindings = bind(&self.exposed, &[records, cells, ("entries", &varied)]);
        work.dispatch(Stage::Exposed, &self.exposed, &bindings, counted.exposed)?;
        held.release(exposed_cells);
        let counted = work.counted()?;

        let bricks = u64::from(counted.mixed) + u64::from(counted.varied);
        let room = with_spare_bricks(gpu, world.size, bricks);
        let masks = held.take(gpu, "masks", room * MASK_BYTES)?;
        let materials = held.take(gpu, "voxel_materials", room * MATERIAL_BYTES)?;
        let parts = [(&mixed, counted.mixed, 0), (&varied, counted.varied, 1)];
        // All bricks are filled before any is placed: until then the grid tells which cells are solid.
        for stage in [Stage::Fill, Stage::Place] {
            for (entries, count, all_solid) in parts {
                work.job.all_solid = all_solid;
                work.job.entry_count = count;
                let records = ("solid_records", &solid_records);
                if stage == Stage::Fill {
                    let bricks = [("masks_out", &masks), ("materials_out", &materials)];
                    let lists = [records, ("entries", entries), bricks[0], bricks[1]];
                    work.dispatch(stage, &self.fill, &bind(&self.fill, &lists), count)?;
                } else {
                    let bindings = bind(&self.place, &[records, ("entries", entries)]);
                    work.dispatch(stage, &self.place, &bindings, count.div_ceil(64))?;
                }
            }
        }
        let counted = work.counted()?;

        let report = VoxeliseReport {
            gpu_ms: work.timing.supported().then(|| work.stages_ms.iter().sum()),
            stages_ms: work.stages_ms,
            wall_ms: start.elapsed().as_secs_f64() * 1e3,
            candidates: counted.candidates,
            bricks: counted.bricks,
            peak_bytes: held.peak,
        };
        let voxels = GpuVoxels {
            size: world.size,
            origin: world.origin,
            info,
            grid,
            masks,
            materials,
            bodies: GpuBodies::upload(gpu, &world.bodies, &world.materials, world.size)?,
        };
        Ok((voxels, report))
    }
}

/// Sums of the buffers in use.
#[derive(Default)]
struct Memory {
    now: u64,
    peak: u64,
}

impl Memory {
    fn take(&mut self, gpu: &Gpu, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let buffer = gpu.storage_buffer(label, bytes)?;
        self.note(buffer.size());
        Ok(buffer)
    }

    fn note(&mut self, bytes: u64) {
        self.now += bytes;
        self.peak = self.peak.max(self.now);
    }

    fn release(&mut self, buffer: wgpu::Buffer) {
        self.now -= buffer.size();
        buffer.destroy();
    }
}

/// Dispatches a kernel's workgroups in chunks and sums the times of the chunks.
struct Work<'a> {
    gpu: &'a Gpu,
    timing: Timing,
    stages_ms: [f64; 6],
    job: GpuVoxeliseJob,
    job_buffer: wgpu::Buffer,
    counters: wgpu::Buffer,
    cells: UVec3,
    /// The bins' offsets, their rows and the parts, as the shader reads them.
    features: Vec<u32>,
}

/// Chunks grow while they take less than half of this time, and halve above it. It is well below the 50 ms that a
/// dispatch may hold a slow device, because cells differ in cost.
const CHUNK_TIME: Duration = Duration::from_millis(30);
/// Chunks have at least this many workgroups, because software devices take about 5 ms to begin a chunk.
const SMALLEST_CHUNK: u32 = 8;
/// Workgroups of a kernel's first chunk.
const FIRST_CHUNK: u32 = 64;
/// Workgroups along x; further workgroups fill more rows.
const ROW: u32 = 32_768;

impl<'a> Work<'a> {
    fn new(gpu: &'a Gpu, world: &World) -> Result<Self, GpuError> {
        let bins = FeatureBins::new(&world.features, world.origin, world.size);
        let mut job = GpuVoxeliseJob {
            size: world.size.to_array(),
            cells: world.size.map(|n| n.div_ceil(CELL)).to_array(),
            part_count: world.features.len() as u32,
            ..Default::default()
        };
        let mut features = Vec::new();
        if !world.features.is_empty() {
            let (offsets, rows) = bins.rows();
            features.extend_from_slice(offsets);
            job.rows_at = features.len() as u32;
            features.extend_from_slice(rows);
            job.parts_at = features.len() as u32;
            for part in &world.features {
                features.extend(part.min.to_array().map(|n| n as u32));
                features.push(u32::from(part.material));
                features.extend(part.max.to_array().map(|n| n as u32));
                features.push(u32::from(part.without_corners));
            }
        }
        Ok(Self {
            timing: Timing::new(gpu)?,
            stages_ms: [0.0; 6],
            job_buffer: gpu.uniform_buffer("job", &job),
            counters: gpu.storage_buffer("counters", size_of::<GpuVoxeliseCounters>() as u64)?,
            cells: UVec3::from_array(job.cells),
            job,
            features,
            gpu,
        })
    }

    /// Runs `count` workgroups.
    fn dispatch(
        &mut self,
        stage: Stage,
        kernel: &Kernel,
        bindings: &Bindings,
        count: u32,
    ) -> Result<(), GpuError> {
        let mut chunk = FIRST_CHUNK;
        self.job.first = 0;
        while self.job.first < count {
            self.job.end = count.min(self.job.first.saturating_add(chunk));
            self.gpu
                .queue
                .write_buffer(&self.job_buffer, 0, bytemuck::bytes_of(&self.job));
            let groups = self.job.end - self.job.first;
            let start = Instant::now();
            let mut recorder = Recorder::new(self.gpu, Some(&mut self.timing));
            recorder.compute(SHADER, |pass| {
                kernel.dispatch(pass, bindings, [groups.min(ROW), groups.div_ceil(ROW), 1]);
            });
            recorder.submit(self.gpu)?;
            self.gpu.wait()?;
            while let Some(times) = self.timing.next_frame() {
                self.stages_ms[stage as usize] += times.passes_ms.values().sum::<f64>();
            }
            let elapsed = start.elapsed();
            if elapsed < CHUNK_TIME / 16 {
                chunk = chunk.saturating_mul(8);
            } else if elapsed < CHUNK_TIME / 2 {
                chunk = chunk.saturating_mul(2);
            } else if elapsed > CHUNK_TIME {
                chunk = (chunk / 2).max(SMALLEST_CHUNK);
            }
            self.job.first = self.job.end;
        }
        Ok(())
    }

    fn counted(&self) -> Result<GpuVoxeliseCounters, GpuError> {
        let words = size_of::<GpuVoxeliseCounters>() as u64;
        let read = self.gpu.read_buffer_range(&self.counters, 0, words)?;
        Ok(read[0])
    }
}
