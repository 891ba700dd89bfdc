//! Probe maps and gather on the GPU against closed forms and the CPU's mathematics.

mod cascades;
mod gather;
mod history;
mod lattice;
mod maps;
mod placement;
mod states;
mod visibility_bits;
mod visible_light;

use glam::{DVec3, IVec2, IVec3, UVec2, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    parameters::{ProbeParameters, ProbeStates, Visibility},
    passes::{
        probes::{ProbeField, blend::ProbeBlend, schedule::ProbeSchedule},
        scene::GpuVoxels,
    },
    probes::{Volume, octahedral, packed::distances_of, sampling},
    world::voxels::Voxels,
};
use half::f16;

use crate::support::{
    gpu,
    scenes::{lattice, volume_of},
};

fn volume(counts: [u32; 3], spacing: f32) -> Volume {
    volume_of(&lattice(
        counts.into(),
        Vec3::splat(spacing),
        Vec3::splat(0.5),
    ))
}

/// Probes whose rays the test makes up.
struct Rig {
    gpu: Gpu,
    field: ProbeField,
    schedule: ProbeSchedule,
    blend: ProbeBlend,
    voxels: GpuVoxels,
    parameters: ProbeParameters,
    frame: u64,
}

const SEED: u64 = 11;

impl Rig {
    /// Without voxels exact visibility would see nothing, so Chebyshev's bound takes its place. Every probe
    /// is active in every update.
    fn new(volume: Volume, parameters: ProbeParameters) -> Self {
        let visibility = match parameters.visibility {
            Visibility::Exact | Visibility::Auto => Visibility::Chebyshev,
            other => other,
        };
        Self::seeing(
            volume,
            ProbeParameters {
                visibility,
                ..parameters
            },
            &Voxels::empty(UVec3::splat(16)),
            IVec3::ZERO,
        )
    }

    /// Keeps exact visibility: the test runs the visibility pass.
    fn seeing(volume: Volume, parameters: ProbeParameters, voxels: &Voxels, origin: IVec3) -> Self {
        let parameters = ProbeParameters {
            states: ProbeStates::Off,
            ..parameters
        };
        let gpu = gpu();
        let field = ProbeField::new(&gpu, volume, &parameters).expect("fits");
        let schedule = ProbeSchedule::new(&gpu, &field).expect("compiles");
        let blend = ProbeBlend::new(&gpu, &field, &[]).expect("compiles");
        let voxels = GpuVoxels::upload(&gpu, voxels, origin).expect("fits");
        Self {
            gpu,
            field,
            schedule,
            blend,
            voxels,
            parameters,
            frame: 0,
        }
    }

    /// One update of all probes with these rays: (slot, direction) → radiance and length.
    fn update(&mut self, ray: impl Fn(u32, DVec3) -> [f32; 4]) {
        self.field
            .begin_frame(&self.gpu, &self.parameters, SEED, self.frame);
        let rays: Vec<[f16; 4]> = (0..self.field.atlas().slots)
            .flat_map(|slot| {
                let directions = sampling::directions(self.parameters.rays, SEED, self.frame);
                let rays = directions.map(|d| ray(slot, d).map(f16::from_f32));
                rays.collect::<Vec<_>>()
            })
            .collect();
        self.gpu
            .queue
            .write_buffer(self.field.rays(), 0, bytemuck::cast_slice(&rays));
        let mut recorder = Recorder::new(&self.gpu, None);
        self.schedule.record(&mut recorder);
        self.blend.record(&mut recorder);
        recorder.submit(&self.gpu).expect("submits");
        self.frame += 1;
    }

    /// Irradiance over π of a slot: texels by their coordinates, with the border at −1 and n.
    fn irradiance(&self, slot: u32) -> impl Fn(IVec2) -> [f64; 3] + use<> {
        let n = self.parameters.irradiance_texels;
        let all = self.field.irradiance(&self.gpu).expect("reads back");
        move |place: IVec2| {
            let source = octahedral::border_source(place, n);
            let texel = (slot * n + source.y) * n + source.x;
            all[texel as usize].map(f64::from)
        }
    }

    /// Mean distance and mean of squares, like [`Self::irradiance`].
    fn distance(&self, slot: u32) -> impl Fn(IVec2) -> [f64; 2] + use<> {
        let texture = self.field.distance_atlas();
        let all: Vec<u32> = self.gpu.read_texture(texture).expect("reads back");
        let [column, row, layer] = self.field.atlas().tile(slot);
        assert_eq!(layer, 0, "read_texture reads the first layer");
        let width = texture.width() as usize;
        let corner = UVec2::new(column, row) * (self.parameters.distance_texels + 2);
        move |place: IVec2| {
            let at = (corner.as_ivec2() + place + 1).as_uvec2();
            distances_of(all[at.y as usize * width + at.x as usize]).map(f64::from)
        }
    }

    /// Gathers at (point, normal), seen along the normal.
    fn gather(&self, at: &[(Vec3, Vec3)]) -> Vec<[f32; 4]> {
        let kernel = Kernel::new(
            &self.gpu,
            &KernelSpec {
                shader: "generated/gather",
                overrides: &self.field.gather_constants(),
                generated: &[("gather", GATHER)],
                ..Default::default()
            },
        )
        .expect("compiles");
        let points: Vec<[[f32; 4]; 2]> = at
            .iter()
            .map(|(p, n)| [p.extend(0.0).to_array(), n.extend(0.0).to_array()])
            .collect();
        let points = self.gpu.storage_buffer_of("points", &points).expect("fits");
        let out = self
            .gpu
            .storage_buffer("gathered", at.len() as u64 * 16)
            .expect("fits");
        let mut resources = self.voxels.resources().to_vec();
        resources.extend(self.field.resources());
        resources.push(("points", points.as_entire_binding()));
        resources.push(("gathered", out.as_entire_binding()));
        let bindings = kernel.bind(&self.gpu, &resources);
        let mut recorder = Recorder::new(&self.gpu, None);
        recorder.compute("gather", |pass| {
            kernel.dispatch_threads(pass, &bindings, [at.len() as u32, 1, 1]);
        });
        recorder.submit(&self.gpu).expect("submits");
        let mut gathered = self.gpu.read_buffer::<[f32; 4]>(&out).expect("reads back");
        gathered.truncate(at.len());
        gathered
    }
}

const GATHER: &str = "
import package::probes::gather::gather;
import package::probes::requests::NOBODY;
struct Place { point: vec4f, normal: vec4f }
@group(3) @binding(0) var<storage, read> points: array<Place>;
@group(3) @binding(1) var<storage, read_write> gathered: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&points) { return; }
    let place = points[id.x];
    gathered[id.x] = vec4f(gather(place.point.xyz, place.normal.xyz, NOBODY), 0.0);
}
";

fn texels(n: u32) -> impl Iterator<Item = IVec2> {
    (0..n * n).map(move |i| UVec2::new(i % n, i / n).as_ivec2())
}
