//! Probe maps and gather on the GPU against closed forms and the CPU's mathematics.

mod cascades;
mod gather;
mod history;
mod lattice;
mod maps;
mod placement;
mod repeats;
mod states;
mod visibility_bits;
mod visible_light;

use glam::{DVec3, IVec2, IVec3, UVec2, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    parameters::{ProbeParameters, ProbeStates, Visibility},
    passes::{
        probes::{
            ProbeField, blend::ProbeBlend, blend_distances::ProbeBlendDistances,
            schedule::ProbeSchedule,
        },
        scene::GpuVoxels,
    },
    probes::{Volume, octahedral, packed::distances_of, repeats::SETS_AT_A_TIME, sampling},
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

/// `MOST_REPEATED` of `shaders/probes/repeated_rays.wesl`.
const MOST_REPEATED: f32 = 0.7;

/// How many frames older than its rays the set of their directions is: `set_of` in `shaders/probes/schedule.wesl`.
fn set_offset(slot: u32, frame: u64) -> u64 {
    if frame < u64::from(SETS_AT_A_TIME) {
        return 0;
    }
    u64::from(((slot.wrapping_mul(0x9e37_79b9) >> 16) * SETS_AT_A_TIME) >> 16)
}

/// Radiance with nine bits for each channel and five for the exponent: `shaders/probes/repeated_rays.wesl`.
fn packed_radiance(radiance: [f32; 3]) -> u32 {
    let most = radiance.into_iter().fold(0.0, f32::max);
    let exponent = (-15..16).find(|&e| most < 2f32.powi(e)).unwrap_or(16);
    let steps = radiance.map(|value| (value * 2f32.powi(9 - exponent) + 0.5).min(511.0) as u32);
    steps[0] | steps[1] << 9 | steps[2] << 18 | ((exponent + 15) as u32) << 27
}

/// The passes that average the rays of probes.
pub struct Blends {
    light: ProbeBlend,
    distances: Option<ProbeBlendDistances>,
}

impl Blends {
    /// `scene`: constants of the scene.
    pub fn new(gpu: &Gpu, field: &ProbeField, scene: &[(&str, f64)]) -> Self {
        Self {
            light: ProbeBlend::new(gpu, field, scene).expect("compiles"),
            distances: ProbeBlendDistances::new(gpu, field, scene).expect("compiles"),
        }
    }

    pub fn record(&self, recorder: &mut Recorder<'_>) {
        if let Some(distances) = &self.distances {
            distances.record(recorder);
        }
        self.light.record(recorder);
    }
}

/// Probes whose rays the test makes up.
struct Rig {
    gpu: Gpu,
    field: ProbeField,
    schedule: ProbeSchedule,
    blend: Blends,
    voxels: GpuVoxels,
    parameters: ProbeParameters,
    frame: u64,
    sent: Vec<Sent>,
}

/// The rays of a probe.
#[derive(Clone, Default)]
struct Sent {
    /// The first frame that sent them.
    first: u64,
    /// What they found last.
    radiance: Vec<[f32; 3]>,
}

const SEED: u64 = 11;

impl Rig {
    /// Without voxels exact visibility would see nothing, so Chebyshev's bound takes its place. Every probe
    /// is active in every update.
    fn new(volume: Volume, parameters: ProbeParameters) -> Self {
        Self::on(&gpu(), volume, parameters)
    }

    /// The same on this device.
    fn on(gpu: &Gpu, volume: Volume, parameters: ProbeParameters) -> Self {
        let visibility = match parameters.visibility {
            Visibility::Exact | Visibility::Auto => Visibility::Chebyshev,
            other => other,
        };
        Self::seeing_on(
            gpu,
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
        Self::seeing_on(&gpu(), volume, parameters, voxels, origin)
    }

    fn seeing_on(
        gpu: &Gpu,
        volume: Volume,
        parameters: ProbeParameters,
        voxels: &Voxels,
        origin: IVec3,
    ) -> Self {
        let parameters = ProbeParameters {
            states: ProbeStates::Off,
            ..parameters
        };
        let gpu = gpu.clone();
        let field = ProbeField::new(&gpu, volume, &parameters).expect("fits");
        let schedule = ProbeSchedule::new(&gpu, &field, &[]).expect("compiles");
        let blend = Blends::new(&gpu, &field, &[]);
        let voxels = GpuVoxels::upload(&gpu, voxels, origin).expect("fits");
        Self {
            gpu,
            field,
            schedule,
            blend,
            voxels,
            parameters,
            frame: 0,
            sent: Vec::new(),
        }
    }

    /// One update of all probes with these rays: (slot, direction) → radiance and length.
    fn update(&mut self, ray: impl Fn(u32, DVec3) -> [f32; 4]) {
        self.field
            .begin_frame(&self.gpu, &self.parameters, SEED, self.frame);
        let slots = self.field.atlas().slots;
        self.sent.resize(slots as usize, Sent::default());
        let states = self.field.states(&self.gpu).expect("reads back");
        let rays: Vec<[u32; 2]> = (0..slots)
            .flat_map(|slot| {
                let varies = (states.get(slot as usize)).map_or(0.0, |state| state.variability);
                self.rays_of(slot, varies <= MOST_REPEATED, &ray)
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

    /// The rays of a probe as pass `probes/trace` stores them: new ones, or those of its last update again.
    fn rays_of(
        &mut self,
        slot: u32,
        may_repeat: bool,
        ray: impl Fn(u32, DVec3) -> [f32; 4],
    ) -> Vec<[u32; 2]> {
        let sent = &mut self.sent[slot as usize];
        let within = u64::from(self.field.changes.repeats().within());
        let settled = self.frame >= u64::from(self.parameters.warmup_frames).max(1);
        let repeats = may_repeat && settled && self.frame - sent.first <= within;
        if !repeats {
            sent.first = self.frame;
        }
        let before = sent.radiance.clone();
        let set = sent.first - set_offset(slot, sent.first);
        let found: Vec<[f32; 4]> = sampling::directions(self.parameters.rays, SEED, set)
            .map(|direction| ray(slot, direction))
            .collect();
        sent.radiance = found.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        if repeats {
            let pairs = sent.radiance.iter().zip(before);
            return pairs
                .map(|(now, then)| [*now, then].map(packed_radiance))
                .collect();
        }
        let halves = |a: f32, b: f32| {
            u32::from(f16::from_f32(a).to_bits()) | u32::from(f16::from_f32(b).to_bits()) << 16
        };
        (found
            .iter()
            .map(|&[r, g, b, length]| [halves(r, g), halves(b, length)]))
        .collect()
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
