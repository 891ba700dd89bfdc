//! Rays choose among the lamps that their cell is known to see: nothing is lost or counted twice, whatever is known.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    lights::{LampShape, LampState, Lights, table::LightsOfFrame},
    passes::scene::{GpuLights, GpuSeenLampsHeader, GpuVoxels},
    world::{
        Sky,
        voxels::{NewCell, Voxels, brick_index},
    },
};

use crate::support::{gpu, with_faults};

/// One choice and its shadow ray for each thread, from the same point.
const SAMPLES: u32 = 1 << 20;
const KERNEL: &str = "
import package::light::listed_lamps::list_at;
import package::light::seen_lamps::one_seen_lamp;
import package::math::hash::{hash, unit};
import package::march::ray::start_in;
@group(3) @binding(0) var<storage, read_write> found: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let voxel = vec3u(4u);
    let random = unit(hash(id.x));
    let light = one_seen_lamp(
        list_at(voxel), vec3f(4.5, 4.0, 4.5), start_in(voxel), vec3f(0.0, 1.0, 0.0), random, false, hash(id.x / 64u),
    );
    found[id.x] = vec4f(light.irradiance, 0.0);
}
";

/// The bit of the first word that says that a ray has looked at all lamps.
const LOOKED: u32 = 1 << 31;

fn lamp(position: [f64; 3], watts: f64) -> LampState {
    LampState {
        shape: LampShape::Point,
        position_ws: position.into(),
        direction_ws: DVec3::ZERO,
        intensity: DVec3::splat(watts / (4.0 * std::f64::consts::PI)),
        radius: 0.5,
        soft_radius: 0.0,
        rhythm: None,
    }
}

/// The even lamps hang above a floor, the odd ones behind a wall.
fn lamps() -> Vec<LampState> {
    let of = |number: usize| {
        let (x, z) = ((2 + number % 3) as f64 + 0.3, (2 + number / 3) as f64 + 0.4);
        match number % 2 {
            0 => lamp([x, 9.5, z], 20.0 + 10.0 * number as f64),
            _ => lamp([x + 10.0, 9.5, z], 900.0),
        }
    };
    (0..10).map(of).collect()
}

/// A wall at x = 8.
fn voxels() -> Voxels {
    Voxels::from_cells(UVec3::splat(16), |cell| {
        if cell.x == 0 {
            return NewCell::Empty;
        }
        let mut content = Box::new([0; 512]);
        for y in 0..8 {
            for z in 0..8 {
                content[brick_index(UVec3::new(0, y, z))] = 1;
            }
        }
        NewCell::Voxels(content)
    })
}

struct Outcome {
    mean: f64,
    /// Of a single choice.
    variance: f64,
    written: [u32; 2],
}

/// `first` and `second`: the words of the two thirds that are read.
fn choose(gpu: &Gpu, first: [u32; 2], second: [u32; 2], fresh: u32) -> Outcome {
    let voxels = GpuVoxels::upload(gpu, &voxels(), IVec3::ZERO).expect("fits");
    let lights = GpuLights::new(gpu, None).expect("fits");
    let all = Lights {
        lamps: lamps(),
        sky: Sky {
            zenith: Vec3::ZERO,
            horizon: Vec3::ZERO,
            ground: Vec3::ZERO,
        },
    };
    // All lamps stand still.
    let of_frame = LightsOfFrame {
        still_since: vec![0; all.lamps.len()],
        ..Default::default()
    };
    lights.set(gpu, &all, &of_frame);
    let header = GpuSeenLampsHeader {
        read_first: 2,
        read_second: 4,
        written: 0,
        _pad: 0,
        fresh: [fresh, 0],
    };
    let words = [[0; 2], first, second];
    let bytes = [bytemuck::bytes_of(&header), bytemuck::bytes_of(&words)].concat();
    let seen = gpu.storage_buffer_of("seen_lamps", &bytes).expect("fits");
    let spec = KernelSpec {
        shader: "generated/choose",
        generated: &[("choose", KERNEL)],
        ..Default::default()
    };
    let kernel = Kernel::new(gpu, &spec).unwrap_or_else(|error| panic!("{error}"));
    let found = gpu
        .storage_buffer("found", u64::from(SAMPLES) * 16)
        .expect("fits");
    let mut resources = voxels.resources().to_vec();
    resources.extend(
        lights
            .resources()
            .into_iter()
            .filter(|(name, _)| *name != "seen_lamps"),
    );
    resources.push(("seen_lamps", seen.as_entire_binding()));
    resources.push(("found", found.as_entire_binding()));
    let bindings = kernel.bind(gpu, &resources);
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("choose", |pass| {
        kernel.dispatch_threads(pass, &bindings, [SAMPLES, 1, 1])
    });
    recorder.submit(gpu).expect("submits");
    let light: Vec<[f32; 4]> = gpu.read_buffer(&found).expect("reads back");
    let after: Vec<u32> = gpu.read_buffer(&seen).expect("reads back");
    let start = size_of::<GpuSeenLampsHeader>() / 4;
    let mean_of = |value: &dyn Fn(f64) -> f64| {
        light
            .iter()
            .map(|rgb| value(f64::from(rgb[0])))
            .sum::<f64>()
            / f64::from(SAMPLES)
    };
    let mean = mean_of(&|light| light);
    Outcome {
        mean,
        variance: mean_of(&|light| (light - mean).powi(2)),
        written: [after[start], after[start + 1]],
    }
}

/// Irradiance of the lamps that hang above the floor, in closed form.
fn expected() -> f64 {
    let point = DVec3::new(4.5, 4.0, 4.5);
    let of = |lamp: LampState| {
        let offset = lamp.position_ws - point;
        lamp.intensity.x * offset.y / offset.length().powi(3)
    };
    lamps().into_iter().step_by(2).map(of).sum()
}

const EVEN: u32 = 0b01_0101_0101;
const EVERY: u32 = 0b11_1111_1111;

#[test]
fn no_light_is_lost_whatever_is_known() {
    let gpu = gpu();
    for (first, second, fresh) in [
        // Nothing, also because nobody has looked at all lamps.
        ([0, 0], [0, 0], 0),
        ([EVEN, 0], [0, 0], 0),
        // All that there is to see.
        ([EVEN | LOOKED, 0], [0, 0], 0),
        ([0b0101, 0], [EVEN & !0b0101 | LOOKED, 0], 0),
        // Only two of five, and those that nobody sees.
        ([0b0101 | LOOKED, 0], [0, 0], 0),
        ([0b10_1010_1010 | LOOKED, 0], [0b1 | LOOKED, 0], 0),
        ([0b0101 | LOOKED, 0], [0, 0], EVERY),
        ([0b0101 | LOOKED, 0], [0, 0], 0b1_1000),
    ] {
        let outcome = choose(&gpu, first, second, fresh);
        let error = outcome.mean / expected() - 1.0;
        assert!(error.abs() < 0.03, "{first:?} {second:?}: {error}");
        // What rays find is what there is, and is kept for later turns.
        assert_eq!(outcome.written, [EVEN | LOOKED, 0], "{first:?} {second:?}");
    }
}

#[test]
fn what_is_known_spares_noise() {
    let gpu = gpu();
    let plain = choose(&gpu, [EVEN | LOOKED, 0], [0, 0], EVERY);
    let known = choose(&gpu, [EVEN | LOOKED, 0], [0, 0], 0);
    // One workgroup in sixteen looks at all lamps; the others take no ray to a lamp that is hidden.
    assert!(
        known.variance < 0.25 * plain.variance,
        "{} of {}",
        known.variance,
        plain.variance
    );
    assert!(
        plain.variance > 0.1 * plain.mean.powi(2),
        "{}",
        plain.variance
    );
}

#[test]
fn fresh_lamps_are_looked_for_without_noise() {
    let gpu = gpu();
    // Nobody has seen any of them yet.
    let unknown = choose(&gpu, [LOOKED, 0], [0, 0], 0);
    let looked_for = choose(&gpu, [LOOKED, 0], [0, 0], EVEN);
    assert!(
        looked_for.variance < 0.05 * unknown.variance,
        "{} of {}",
        looked_for.variance,
        unknown.variance
    );
}

#[test]
fn a_lamp_that_nobody_knew_counts_for_all_who_did_not_look() {
    let gpu = gpu();
    let faulty = with_faults(
        &gpu,
        &[(
            "light/seen_lamps.wesl",
            "counts = select(f32(GROUPS_A_LOOK), 1.0, has_slot(likely, chosen.slot));",
            "",
        )],
    );
    let outcome = choose(&faulty, [0b0101 | LOOKED, 0], [0, 0], 0);
    let error = outcome.mean / expected() - 1.0;
    assert!(error < -0.3, "{error}");
}
