//! Pass `bench/rays`: traces rays of one kind at a time, with either marcher, for `grotto bench traversal`
//! and for the tests that require the same hits of both marchers.

use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};

use super::super::scene::GpuVoxels;
use crate::{
    gpu::{Gpu, GpuError, Kernel, KernelSpec, Recorder, Timing, rectangle},
    world::voxels::{CELL, grid_cells},
};

/// Most rays that a workgroup of 64 threads takes from its queue: the best measured of 128 … 1024.
const MOST_RAYS_PER_GROUP: u32 = 512;
/// Runs before the timed ones, and the least time that these runs take on a GPU. A GPU lowers its clock while the
/// CPU compares hits, and raises it slowly.
const WARM_UP: u32 = 3;
const WARM_UP_TIME: Duration = Duration::from_millis(200);
/// Workgroups that keep a large GPU busy: with fewer rays, the queues are shorter.
const BUSY_GROUPS: u32 = 4096;

/// The three kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    Camera,
    /// From the camera rays' hits to the light that [`RayBench::aim`] received.
    Shadow,
    /// From voxels' centres in given directions.
    Probe,
}

/// How rays are marched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marcher {
    BrickMap,
    /// One voxel per step over one bit per voxel: the reference.
    PlainDda,
}

/// What one ray found.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct FoundHit {
    /// Index of the voxel in the grid's extent; all ones for a miss.
    pub place: u32,
    /// Face (low 16 bits; all ones for a miss), steps (high 16 bits).
    pub face_and_steps: u32,
}

impl FoundHit {
    pub const MISS: u32 = u32::MAX;

    /// Whether both rays hit the same face of the same voxel, or neither hit.
    pub fn same_hit(self, other: Self) -> bool {
        self.place == other.place && self.face_and_steps as u16 == other.face_and_steps as u16
    }

    pub fn steps(self) -> u32 {
        self.face_and_steps >> 16
    }
}

/// Some timed repeats of the same rays.
pub struct TimedRun {
    /// What the kernel wrote: [`RayKind::timed_words`] per ray.
    pub results: Vec<u32>,
    /// GPU milliseconds of each repeat; empty where the adapter cannot tell.
    pub times_ms: Vec<f64>,
}

impl RayKind {
    /// Words that a timed kernel writes for each ray, with either marcher: the voxel and the face that
    /// were hit; for a shadow ray, whether it is blocked.
    pub fn timed_words(self) -> usize {
        match self {
            Self::Camera | Self::Probe => 2,
            Self::Shadow => 1,
        }
    }
}

crate::shared! {
    in bench;

    /// What a kernel knows about its rays.
    struct GpuRayBench as RayBench {
        /// Where shadow rays go: towards a point in grid space (towards_lamp 1), or along a direction.
        target_gs: [f32; 3],
        rays_per_probe: u32,
        probe_rays: u32,
        shadow_rays: u32,
        towards_lamp: u32,
        _pad: u32,
    }
}

/// Where shadow rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShadowTarget {
    /// A point in grid space.
    Lamp(Vec3),
    /// A direction, without end.
    Sun(Vec3),
}

impl ShadowTarget {
    /// Whether the face of a voxel that a ray hit looks towards the light. Either all points of a face do, or
    /// none. False where the ray began in a solid voxel.
    fn lights(self, voxel: UVec3, face: u32) -> bool {
        let axis = face as usize / 2;
        if axis > 2 {
            return false;
        }
        let outwards = if face & 1 == 1 { 1.0 } else { -1.0 };
        let along = match self {
            Self::Lamp(at_gs) => at_gs[axis] - (voxel[axis] + (face & 1)) as f32,
            Self::Sun(towards) => towards[axis],
        };
        along * outwards > 0.0
    }
}

/// Which rays: those of a picture, and those from probes.
pub struct RaySet<'a> {
    /// The `View` uniform.
    pub view: &'a wgpu::Buffer,
    /// At most [`MAX_EDGE`] along an edge.
    pub size: [u32; 2],
    /// Camera rays along each edge of a pixel. Shadow rays are ordered in rounds with one ray per pixel, so that
    /// neighbours in the order are as far apart as pixels are.
    pub rays_per_edge: u32,
    /// Voxels (grid space). Each centre sends one ray in each of `directions`.
    pub probes: &'a [UVec3],
    pub directions: &'a [Vec3],
}

/// Longest edge of a picture of camera rays: the start of a shadow ray has 14 bits for each of x and y.
pub const MAX_EDGE: u32 = 1 << 14;

/// Kernels and buffers for one picture size and one set of probes.
pub struct RayBench<'a> {
    voxels: &'a GpuVoxels,
    view: wgpu::Buffer,
    bits: wgpu::Buffer,
    found: wgpu::Buffer,
    probes: wgpu::Buffer,
    directions: wgpu::Buffer,
    size: [u32; 2],
    rays_per_edge: u32,
    /// Content of the uniform, which is made for each run.
    rays: GpuRayBench,
    rays_per_group: u32,
    shadow_starts: Option<wgpu::Buffer>,
    /// Whether camera and shadow rays are also marched as incoherent rays, as in pass `probes/trace`.
    pub scattered: bool,
}

impl<'a> RayBench<'a> {
    /// Builds the bit grid of the plain DDA, and the buffers.
    ///
    /// # Errors
    /// [`GpuError`] when a buffer is too large or a shader does not compile.
    pub fn new(gpu: &Gpu, voxels: &'a GpuVoxels, rays: &RaySet<'_>) -> Result<Self, GpuError> {
        let probe_rays = (rays.probes.len() * rays.directions.len()) as u32;
        let pixels = rays.size[0] * rays.size[1];
        let probes: Vec<[u32; 4]> = rays.probes.iter().map(|p| [p.x, p.y, p.z, 0]).collect();
        let directions: Vec<[f32; 4]> = rays
            .directions
            .iter()
            .map(|d| d.extend(0.0).to_array())
            .collect();
        Ok(Self {
            voxels,
            view: rays.view.clone(),
            bits: build_bits(gpu, voxels)?,
            found: gpu.storage_buffer("found", u64::from(pixels.max(probe_rays)) * 8)?,
            probes: gpu.storage_buffer_of("bench_probes", &probes)?,
            directions: gpu.storage_buffer_of("bench_directions", &directions)?,
            size: rays.size,
            rays_per_edge: rays.rays_per_edge,
            rays: GpuRayBench {
                rays_per_probe: rays.directions.len() as u32,
                probe_rays,
                ..Default::default()
            },
            rays_per_group: (probe_rays / BUSY_GROUPS)
                .next_multiple_of(64)
                .clamp(64, MOST_RAYS_PER_GROUP),
            shadow_starts: None,
            scattered: false,
        })
    }

    /// Marches the camera rays and lists the hits that face the light: the [`RayKind::Shadow`] rays start there. The list
    /// is in Morton order of the pixels, so that the threads of a subgroup start from a block of the picture.
    ///
    /// # Errors
    /// As [`RayBench::hits`].
    pub fn aim(&mut self, gpu: &Gpu, light: ShadowTarget) -> Result<(), GpuError> {
        let seen = self.hits(gpu, RayKind::Camera, Marcher::BrickMap)?;
        let extent = extent_of(self.voxels);
        let per_edge = self.rays_per_edge;
        let order = |x: u32, y: u32| {
            let within = x % per_edge + per_edge * (y % per_edge);
            (within, morton(x / per_edge) | (morton(y / per_edge) << 1))
        };
        let mut starts: Vec<((u32, u32), [u32; 2])> = (0..)
            .zip(&seen)
            .filter(|(_, hit)| hit.place != FoundHit::MISS)
            .filter_map(|(pixel, hit)| {
                let (x, y) = (pixel % self.size[0], pixel / self.size[0]);
                let face = hit.face_and_steps & 0xffff;
                let voxel = UVec3::new(
                    hit.place % extent.x,
                    hit.place / extent.x % extent.y,
                    hit.place / extent.x / extent.y,
                );
                let start = [x | (y << 14) | (face << 28), hit.place];
                light.lights(voxel, face).then_some((order(x, y), start))
            })
            .collect();
        starts.sort_unstable_by_key(|(order, _)| *order);
        let starts: Vec<[u32; 2]> = starts.into_iter().map(|(_, start)| start).collect();
        let (target, towards_lamp) = match light {
            ShadowTarget::Lamp(at_gs) => (at_gs, 1),
            ShadowTarget::Sun(towards) => (towards, 0),
        };
        self.rays.target_gs = target.to_array();
        self.rays.towards_lamp = towards_lamp;
        self.rays.shadow_rays = starts.len() as u32;
        self.shadow_starts = Some(gpu.storage_buffer_of("shadow_starts", &starts)?);
        Ok(())
    }

    /// How many rays a kind has; no shadow rays before [`RayBench::aim`].
    pub fn rays(&self, kind: RayKind) -> u32 {
        match kind {
            RayKind::Camera => self.size[0] * self.size[1],
            RayKind::Shadow => self.rays.shadow_rays,
            RayKind::Probe => self.rays.probe_rays,
        }
    }

    /// What every ray of a kind hits, and in how many steps.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost, [`GpuError::Shader`].
    pub fn hits(
        &self,
        gpu: &Gpu,
        kind: RayKind,
        marcher: Marcher,
    ) -> Result<Vec<FoundHit>, GpuError> {
        let (found, _) = self.run(gpu, kind, marcher, None)?;
        gpu.read_buffer_range(&found, 0, u64::from(self.rays(kind)) * 8)
    }

    /// Marches all rays of a kind `repeats` times, after some runs that warm up the GPU.
    ///
    /// # Errors
    /// As [`RayBench::hits`].
    pub fn time(
        &self,
        gpu: &Gpu,
        kind: RayKind,
        marcher: Marcher,
        repeats: u32,
    ) -> Result<TimedRun, GpuError> {
        let (written, times_ms) = self.run(gpu, kind, marcher, Some(repeats))?;
        let bytes = self.rays(kind) as usize * kind.timed_words() * 4;
        Ok(TimedRun {
            results: gpu.read_buffer_range(&written, 0, bytes as u64)?,
            times_ms,
        })
    }

    /// The buffer that was written, and the times of `timed` repeats.
    fn run(
        &self,
        gpu: &Gpu,
        kind: RayKind,
        marcher: Marcher,
        timed: Option<u32>,
    ) -> Result<(wgpu::Buffer, Vec<f64>), GpuError> {
        let entry = match (kind, marcher) {
            (RayKind::Camera, _) => "camera",
            (RayKind::Shadow, _) => "shadow",
            (RayKind::Probe, Marcher::BrickMap) => "probe",
            (RayKind::Probe, Marcher::PlainDda) => "probe_plain",
        };
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "bench/rays",
                entry,
                overrides: &[
                    ("PLAIN", f64::from(marcher == Marcher::PlainDda)),
                    (
                        "COHERENT",
                        f64::from(kind != RayKind::Probe && !self.scattered),
                    ),
                    ("TIMED", f64::from(timed.is_some())),
                    ("RAYS_PER_GROUP", f64::from(self.rays_per_group)),
                ],
                ..Default::default()
            },
        )?;
        let uniform = gpu.uniform_buffer("ray_bench", &self.rays);
        let rays = self.rays(kind);
        let blocked = gpu.storage_buffer("blocked", u64::from(self.rays.shadow_rays) * 4)?;
        let mut resources = self.voxels.resources().to_vec();
        resources.extend([
            ("view", self.view.as_entire_binding()),
            ("voxel_bits", self.bits.as_entire_binding()),
            ("found", self.found.as_entire_binding()),
            ("blocked", blocked.as_entire_binding()),
            ("bench_probes", self.probes.as_entire_binding()),
            ("bench_directions", self.directions.as_entire_binding()),
            ("ray_bench", uniform.as_entire_binding()),
        ]);
        if let Some(starts) = &self.shadow_starts {
            resources.push(("shadow_starts", starts.as_entire_binding()));
        }
        let bindings = kernel.bind(gpu, &resources);
        let groups = match (kind, marcher) {
            (RayKind::Camera, _) => kernel.groups_of(self.size),
            (RayKind::Probe, Marcher::BrickMap) => rectangle(rays.div_ceil(self.rays_per_group)),
            _ => rectangle(rays.div_ceil(64)),
        };
        let mut timing = Timing::new(gpu)?;
        let mut times_ms = Vec::new();
        let march = |timing: &mut Timing| {
            let mut recorder = Recorder::new(gpu, timed.is_some().then_some(&mut *timing));
            recorder.run(&kernel, &bindings, groups);
            recorder.submit(gpu)?;
            gpu.wait()?;
            Ok::<_, GpuError>(timing.next_frame().map(|times| times.frame_ms))
        };
        let start = Instant::now();
        let cold =
            |runs| runs < WARM_UP || !gpu.summary.is_software() && start.elapsed() < WARM_UP_TIME;
        let mut warm_up = 0;
        while timed.is_some() && cold(warm_up) {
            march(&mut timing)?;
            warm_up += 1;
        }
        for _ in 0..timed.unwrap_or(1) {
            times_ms.extend(march(&mut timing)?);
        }
        let written = match (kind, timed) {
            (RayKind::Shadow, Some(_)) => blocked,
            _ => self.found.clone(),
        };
        Ok((written, times_ms))
    }
}

/// Spreads the bits of a number below 2¹⁶ to every second place.
fn morton(number: u32) -> u32 {
    let spread = [
        (8, 0x00ff_00ff),
        (4, 0x0f0f_0f0f),
        (2, 0x3333_3333),
        (1, 0x5555_5555),
    ];
    spread
        .iter()
        .fold(number, |bits, (by, mask)| (bits | (bits << by)) & mask)
}

/// Voxels along each axis of the grid, powers of two.
fn extent_of(voxels: &GpuVoxels) -> UVec3 {
    grid_cells(voxels.size) * CELL
}

/// One bit per voxel over the whole extent.
fn build_bits(gpu: &Gpu, voxels: &GpuVoxels) -> Result<wgpu::Buffer, GpuError> {
    let words = (extent_of(voxels).as_u64vec3().element_product() / 32).max(4);
    let bits = gpu.storage_buffer("voxel_bits", words * 4)?;
    let kernel = Kernel::new(
        gpu,
        &KernelSpec {
            shader: "bench/rays",
            entry: "bits",
            ..Default::default()
        },
    )?;
    let mut resources = voxels.resources().to_vec();
    resources.push(("bits_out", bits.as_entire_binding()));
    let bindings = kernel.bind(gpu, &resources);
    let mut recorder = Recorder::new(gpu, None);
    recorder.run(&kernel, &bindings, rectangle(words.div_ceil(64) as u32));
    recorder.submit(gpu)?;
    Ok(bits)
}
