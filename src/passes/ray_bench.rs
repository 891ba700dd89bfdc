//! Pass `ray_bench`: rays of one kind at a time, by either marcher, for `grotto bench traversal`
//! and for the tests that hold the two equal.

use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};

use super::GpuVoxels;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, Timing, rectangle};

/// Most rays that a workgroup of 64 threads takes from its queue: measured best of 128 … 1024.
const MOST_RAYS_PER_GROUP: u32 = 512;
/// Workgroups that keep a large GPU busy: with fewer rays, the queues are shorter.
const BUSY_GROUPS: u32 = 4096;

/// The three kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    Camera,
    /// From the camera rays' hits to a light; needs a camera run before.
    Shadow,
    /// From voxels' centres in given directions.
    Probe,
}

/// Who marches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marcher {
    BrickMap,
    /// One voxel a step over one bit a voxel: the judge.
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

/// Results of some repeats of the same rays.
pub struct RayRun {
    pub found: Vec<FoundHit>,
    /// GPU milliseconds of each repeat; empty where the adapter cannot tell.
    pub times_ms: Vec<f64>,
}

#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
struct GpuRayBench {
    target_gs: [f32; 3],
    rays_per_probe: u32,
    ray_count: u32,
    towards_lamp: u32,
    _pad: [u32; 2],
}

struct Runner {
    kernel: Kernel,
    bindings: Bindings,
}

/// Kernels and buffers for one picture size, one set of probes and one lamp.
pub struct RayBench {
    runners: Vec<(RayKind, Marcher, Runner)>,
    size: [u32; 2],
    probe_rays: u32,
    rays_per_group: u32,
    camera_found: wgpu::Buffer,
    found: wgpu::Buffer,
}

/// Where shadow rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShadowTarget {
    /// A point in grid space.
    Lamp(Vec3),
    /// A direction, without end.
    Sun(Vec3),
}

/// Which rays: a picture's, towards a lamp, and from probes.
pub struct RaySet<'a> {
    /// The `View` uniform.
    pub view: &'a wgpu::Buffer,
    pub size: [u32; 2],
    pub shadow: ShadowTarget,
    /// Voxels (grid space) whose centres send `directions` each.
    pub probes: &'a [UVec3],
    pub directions: &'a [Vec3],
}

impl RayBench {
    /// Builds the bit grid of the plain DDA and both marchers' kernels.
    ///
    /// # Errors
    /// [`GpuError`] when a buffer is too large or a shader does not compile.
    pub fn new(gpu: &Gpu, voxels: &GpuVoxels, rays: &RaySet<'_>) -> Result<Self, GpuError> {
        let probe_rays = (rays.probes.len() * rays.directions.len()) as u32;
        let pixels = rays.size[0] * rays.size[1];
        let (target, towards_lamp) = match rays.shadow {
            ShadowTarget::Lamp(at_gs) => (at_gs, 1),
            ShadowTarget::Sun(towards) => (towards, 0),
        };
        let uniform = gpu.uniform_buffer(
            "ray_bench",
            &GpuRayBench {
                target_gs: target.to_array(),
                rays_per_probe: rays.directions.len() as u32,
                ray_count: probe_rays,
                towards_lamp,
                _pad: [0; 2],
            },
        );
        let probes: Vec<[u32; 4]> = rays.probes.iter().map(|p| [p.x, p.y, p.z, 0]).collect();
        let directions: Vec<[f32; 4]> = rays
            .directions
            .iter()
            .map(|d| d.extend(0.0).to_array())
            .collect();
        let probes = gpu.storage_buffer_of("bench_probes", &probes)?;
        let directions = gpu.storage_buffer_of("bench_directions", &directions)?;
        let camera_found = gpu.storage_buffer("camera_found", u64::from(pixels) * 8)?;
        let found = gpu.storage_buffer("found", u64::from(pixels.max(probe_rays)) * 8)?;
        let rays_per_group = (probe_rays / BUSY_GROUPS)
            .next_multiple_of(64)
            .clamp(64, MOST_RAYS_PER_GROUP);
        let bits = build_bits(gpu, voxels)?;
        let mut runners = Vec::new();
        for marcher in [Marcher::BrickMap, Marcher::PlainDda] {
            let probe = match marcher {
                Marcher::BrickMap => "probe",
                Marcher::PlainDda => "probe_plain",
            };
            for (kind, entry) in [
                (RayKind::Camera, "camera"),
                (RayKind::Shadow, "shadow"),
                (RayKind::Probe, probe),
            ] {
                let kernel = Kernel::new(
                    gpu,
                    &KernelSpec {
                        shader: "passes/ray_bench",
                        entry,
                        overrides: &[
                            ("PLAIN", f64::from(marcher == Marcher::PlainDda)),
                            ("COHERENT", f64::from(kind != RayKind::Probe)),
                            ("RAYS_PER_GROUP", f64::from(rays_per_group)),
                        ],
                        ..Default::default()
                    },
                )?;
                let mut resources = voxels.resources().to_vec();
                resources.extend([
                    ("view", rays.view.as_entire_binding()),
                    ("voxel_bits", bits.as_entire_binding()),
                    ("found", found.as_entire_binding()),
                    ("camera_found", camera_found.as_entire_binding()),
                    ("bench_probes", probes.as_entire_binding()),
                    ("bench_directions", directions.as_entire_binding()),
                    ("ray_bench", uniform.as_entire_binding()),
                ]);
                let bindings = kernel.bind(gpu, &resources);
                runners.push((kind, marcher, Runner { kernel, bindings }));
            }
        }
        Ok(Self {
            runners,
            size: rays.size,
            probe_rays,
            rays_per_group,
            camera_found,
            found,
        })
    }

    /// How many rays a kind has.
    pub fn rays(&self, kind: RayKind) -> u32 {
        match kind {
            RayKind::Camera | RayKind::Shadow => self.size[0] * self.size[1],
            RayKind::Probe => self.probe_rays,
        }
    }

    /// Marches all rays of a kind `repeats` times.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn run(
        &self,
        gpu: &Gpu,
        kind: RayKind,
        marcher: Marcher,
        repeats: u32,
    ) -> Result<RayRun, GpuError> {
        let (.., runner) = self
            .runners
            .iter()
            .find(|(k, m, _)| (*k, *m) == (kind, marcher))
            .expect("every pair has a runner");
        let mut timing = Timing::new(gpu)?;
        let mut times_ms = Vec::new();
        for _ in 0..repeats {
            let mut recorder = Recorder::new(gpu, Some(&mut timing));
            let groups = match (kind, marcher) {
                (RayKind::Camera | RayKind::Shadow, _) => runner.kernel.groups_of(self.size),
                (RayKind::Probe, Marcher::BrickMap) => {
                    rectangle(self.probe_rays.div_ceil(self.rays_per_group))
                }
                (RayKind::Probe, Marcher::PlainDda) => rectangle(self.probe_rays.div_ceil(64)),
            };
            recorder.run(&runner.kernel, &runner.bindings, groups);
            recorder.submit(gpu)?;
            gpu.wait()?;
            times_ms.extend(timing.next_frame().map(|times| times.frame_ms));
        }
        let bytes = u64::from(self.rays(kind)) * 8;
        if kind == RayKind::Camera {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.found, 0, &self.camera_found, 0, bytes);
            gpu.queue.submit([encoder.finish()]);
        }
        Ok(RayRun {
            found: gpu.read_buffer_range(&self.found, 0, bytes)?,
            times_ms,
        })
    }
}

/// One bit a voxel over the whole extent.
fn build_bits(gpu: &Gpu, voxels: &GpuVoxels) -> Result<wgpu::Buffer, GpuError> {
    let extent = crate::world::voxels::grid_cells(voxels.size) * crate::world::voxels::CELL;
    let words = (extent.as_u64vec3().element_product() / 32).max(4);
    let bits = gpu.storage_buffer("voxel_bits", words * 4)?;
    let kernel = Kernel::new(
        gpu,
        &KernelSpec {
            shader: "passes/ray_bench",
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
