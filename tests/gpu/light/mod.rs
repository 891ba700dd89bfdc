//! Lamps, sky, materials and tone mapping: the GPU against the CPU, value for value.

use glam::{DVec3, IVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    lights::{LampShape, LampState, Lights, sky, table::LightsOfFrame},
    measure::tonemap,
    passes::scene::{GpuLights, GpuMaterials},
    world::{Colour, Material, MaterialSound, Pattern, Sky, materials::MaterialSet},
};

use crate::support::gpu;

/// Runs `body`, the statements of `fn evaluate(at: array<vec4f, N>) -> vec4f`, for each input.
fn evaluate<const N: usize>(
    gpu: &Gpu,
    imports: &str,
    body: &str,
    inputs: &[[[f32; 4]; N]],
    resources: &[(&str, wgpu::BindingResource<'_>)],
) -> Vec<[f32; 4]> {
    let source = format!(
        "{imports}
        @group(3) @binding(0) var<storage, read> inputs: array<array<vec4f, {N}>>;
        @group(3) @binding(1) var<storage, read_write> outputs: array<vec4f>;
        fn evaluate(at: array<vec4f, {N}>) -> vec4f {{ {body} }}
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x < {count}u {{ outputs[id.x] = evaluate(inputs[id.x]); }}
        }}",
        count = inputs.len(),
    );
    let spec = KernelSpec {
        shader: "generated/evaluate",
        generated: &[("evaluate", &source)],
        ..Default::default()
    };
    let kernel = Kernel::new(gpu, &spec).unwrap_or_else(|error| panic!("{error}"));
    let given = gpu
        .storage_buffer_of("inputs", inputs.as_flattened())
        .expect("fits");
    let results = gpu
        .storage_buffer("outputs", inputs.len() as u64 * 16)
        .expect("fits");
    let mut all = resources.to_vec();
    all.push(("inputs", given.as_entire_binding()));
    all.push(("outputs", results.as_entire_binding()));
    let bindings = kernel.bind(gpu, &all);
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("evaluate", |pass| {
        kernel.dispatch_threads(pass, &bindings, [inputs.len() as u32, 1, 1]);
    });
    recorder.submit(gpu).expect("submits");
    gpu.read_buffer(&results).expect("reads back")
}

fn vec4(v: DVec3) -> [f32; 4] {
    v.as_vec3().extend(0.0).to_array()
}

/// Largest difference, relative to the size of the values above `floor`.
fn worst(gpu: &[[f32; 4]], cpu: &[DVec3], floor: f64) -> f64 {
    assert_eq!(gpu.len(), cpu.len());
    let error = |(gpu, cpu): (&[f32; 4], &DVec3)| {
        let gpu = Vec3::from_slice(gpu).as_dvec3();
        assert!(gpu.is_finite(), "{gpu}");
        (gpu - *cpu).length() / cpu.length().max(floor)
    };
    gpu.iter().zip(cpu).map(error).fold(0.0, f64::max)
}

/// Scattered points and unit vectors, the same in every run.
fn scattered(index: u32) -> (DVec3, DVec3) {
    let turn = f64::from(index);
    let point = DVec3::new(
        (turn * 0.7548).fract(),
        (turn * 0.5698).fract(),
        (turn * 0.3247).fract(),
    );
    let direction = DVec3::new(
        (turn * 1.3).sin(),
        (turn * 2.1).cos(),
        (turn * 0.9 + 1.0).sin(),
    );
    (point * 24.0 - 12.0, direction.normalize())
}

fn lamps() -> Vec<LampState> {
    let lamp = |shape, position_ws, direction_ws: DVec3, intensity| LampState {
        shape,
        position_ws,
        direction_ws: direction_ws.normalize_or_zero(),
        intensity,
        radius: 0.5,
        soft_radius: 0.0,
        rhythm: None,
    };
    let spot = LampShape::Spot {
        cos_inner: 0.9,
        cos_outer: 0.4,
    };
    let sphere = |soft_radius, lamp| LampState {
        soft_radius,
        ..lamp
    };
    vec![
        sphere(
            4.0,
            lamp(
                spot,
                DVec3::new(3.0, 5.0, -4.0),
                DVec3::new(-0.2, -1.0, 0.3),
                DVec3::new(6.0, 2.0, 9.0),
            ),
        ),
        sphere(
            2.0,
            lamp(
                LampShape::Point,
                DVec3::new(-5.0, 1.0, 2.0),
                DVec3::ZERO,
                DVec3::new(2.0, 7.0, 3.0),
            ),
        ),
        lamp(
            LampShape::Point,
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::ZERO,
            DVec3::new(9.0, 4.0, 1.0),
        ),
        lamp(
            spot,
            DVec3::new(-2.0, 9.0, 1.0),
            DVec3::new(0.2, -1.0, 0.1),
            DVec3::new(1.0, 30.0, 8.0),
        ),
        lamp(
            LampShape::Directional,
            DVec3::ZERO,
            DVec3::new(1.0, -2.0, 0.5),
            DVec3::new(0.1, 0.2, 0.3),
        ),
    ]
}

const SKY: Sky = Sky {
    zenith: Vec3::new(0.1, 0.3, 0.9),
    horizon: Vec3::new(0.9, 0.8, 0.7),
    ground: Vec3::new(0.05, 0.04, 0.03),
};

/// Light of lamps on the GPU at scattered places, and the largest relative error of it as light of `expected`.
fn error_of(gpu: &Gpu, lamps: &[LampState], expected: &[LampState]) -> f64 {
    let uniform = GpuLights::new(gpu, None).expect("it fits");
    let lights = Lights {
        lamps: lamps.to_vec(),
        sky: SKY,
    };
    uniform.set(gpu, &lights, &LightsOfFrame::default());
    let places: Vec<(DVec3, DVec3)> = (0..2000).map(scattered).collect();
    let inputs: Vec<[[f32; 4]; 2]> = places.iter().map(|&(p, n)| [vec4(p), vec4(n)]).collect();
    let imports = "import package::scene::lights::lights;
        import package::light::lamps::lamp_irradiance;";
    let body = "var sum = vec3f(0.0);
        for (var i = 0u; i < lights.lamp_count; i += 1u) {
            sum += lamp_irradiance(lights.lamps[i], at[0].xyz, at[1].xyz);
        }
        return vec4f(sum, 0.0);";
    let on_gpu = evaluate(gpu, imports, body, &inputs, &uniform.resources());
    let sum = |&(p, n): &(DVec3, DVec3)| expected.iter().map(|lamp| lamp.irradiance(p, n)).sum();
    let on_cpu: Vec<DVec3> = places.iter().map(sum).collect();
    worst(&on_gpu, &on_cpu, 1e-2)
}

#[test]
fn lamps_light_the_same_on_both_sides() {
    let gpu = gpu();
    let (spheres, others): (Vec<_>, Vec<_>) = lamps().into_iter().partition(LampState::is_soft);
    let error = error_of(&gpu, &others, &others);
    assert!(error < 1e-4, "{error}");
    // WGSL lets acos and atan2, which spheres at the horizon need, be off by 4096 units in the last place.
    let error = error_of(&gpu, &spheres, &spheres);
    assert!(error < 1e-3, "{error}");
    // The comparison must notice a lamp that the GPU lacks.
    for lamps in [spheres, others] {
        let error = error_of(&gpu, &lamps[1..], &lamps);
        assert!(error > 0.01, "{error}");
    }
}

#[test]
fn the_sky_is_the_same_on_both_sides() {
    let gpu = gpu();
    let uniform = GpuLights::new(&gpu, None).expect("it fits");
    uniform.set(
        &gpu,
        &Lights {
            lamps: Vec::new(),
            sky: SKY,
        },
        &LightsOfFrame::default(),
    );
    let directions: Vec<DVec3> = (0..2000).map(|index| scattered(index).1).collect();
    let inputs: Vec<[[f32; 4]; 1]> = directions.iter().map(|&d| [vec4(d)]).collect();
    let imports = "import package::scene::lights::lights;
        import package::light::sky::sky_radiance;";
    let body = "return vec4f(sky_radiance(lights.sky, at[0].xyz), 0.0);";
    let on_gpu = evaluate(&gpu, imports, body, &inputs, &uniform.resources());
    let on_cpu: Vec<DVec3> = directions.iter().map(|&d| sky::radiance(&SKY, d)).collect();
    let error = worst(&on_gpu, &on_cpu, 1e-2);
    assert!(error < 1e-4, "{error}");
}

fn materials() -> Vec<Material> {
    let material = |a: Colour, pattern: Pattern| Material {
        name: "m".into(),
        a,
        b: Colour::Flat(Vec3::new(0.0, 0.7, 0.9)),
        pattern,
        emission: Vec3::ZERO,
        sound: MaterialSound::Stone,
    };
    let (low, high) = (Vec3::new(0.9, 0.1, 0.2), Vec3::new(0.3, 0.8, 0.1));
    vec![
        material(Colour::Flat(low), Pattern::Plain),
        material(
            Colour::Hash(low, high),
            Pattern::Dots {
                radius: 0.1,
                pitch: 0.36,
                angle_deg: 45.0,
            },
        ),
        material(
            Colour::DitherX {
                from: -7.0,
                to: 5.0,
                low,
                high,
            },
            Pattern::Fbm {
                cells: 2,
                octaves: 3,
            },
        ),
        material(
            Colour::Bands {
                below: vec![(-6.0, Vec3::X), (0.0, Vec3::Y), (4.0, Vec3::Z)],
                above: low,
            },
            Pattern::Bricks {
                rows: 4,
                joint: 0.06,
            },
        ),
        material(
            Colour::Bands {
                below: vec![(2.0, high)],
                above: low,
            },
            Pattern::Plain,
        ),
    ]
}

/// A material, a voxel with a point on one of its faces, and a footprint.
struct Seen {
    material: u8,
    voxel: IVec3,
    face: u8,
    point_ws: DVec3,
    footprint: f64,
}

fn seen(index: u32) -> Seen {
    let (mut point, _) = scattered(index);
    let face = (index % 6) as u8;
    let voxel = point.floor().as_ivec3();
    let axis = usize::from(face / 2);
    point[axis] = f64::from(voxel[axis]) + f64::from(face % 2);
    // From well inside a texel to many blocks at once.
    let footprint = 0.002 * 1.02f64.powi((index % 400) as i32);
    let material = (index % materials().len() as u32) as u8 + 1;
    Seen {
        material,
        voxel,
        face,
        point_ws: point.as_vec3().as_dvec3(),
        footprint,
    }
}

const MATERIALS: &str = "import package::scene::albedo::{albedo, mean_albedo};";

#[test]
fn textures_look_the_same_on_both_sides() {
    let gpu = gpu();
    let set = MaterialSet::bake(&materials(), 5);
    let table = GpuMaterials::upload(&gpu, &set).expect("fits");
    let places: Vec<Seen> = (0..6000).map(seen).collect();
    let inputs: Vec<[[f32; 4]; 2]> = places
        .iter()
        .map(|at| {
            let codes = at
                .voxel
                .as_vec3()
                .extend(f32::from(at.material) * 8.0 + f32::from(at.face));
            [
                at.point_ws.as_vec3().extend(at.footprint as f32).to_array(),
                codes.to_array(),
            ]
        })
        .collect();
    let body = "let codes = u32(at[1].w);
        return vec4f(albedo(codes >> 3u, vec3i(at[1].xyz), codes & 7u, at[0].xyz, at[0].w), 0.0);";
    let on_gpu = evaluate(&gpu, MATERIALS, body, &inputs, &table.resources());
    let on_cpu = |scale: f64| -> Vec<DVec3> {
        let look = |at: &Seen| {
            set.albedo(
                at.material,
                at.voxel,
                at.face,
                at.point_ws,
                at.footprint * scale,
            )
        };
        places.iter().map(|at| look(at).as_dvec3()).collect()
    };
    // Texture units weight texels with 8 bits.
    let error = worst(&on_gpu, &on_cpu(1.0), 1.0);
    assert!(error < 0.012, "{error}");
    // The comparison must notice a difference of one mip level.
    assert!(worst(&on_gpu, &on_cpu(2.0), 1.0) > 0.1);
}

#[test]
fn mean_colours_are_the_same_on_both_sides() {
    let gpu = gpu();
    let set = MaterialSet::bake(&materials(), 5);
    let table = GpuMaterials::upload(&gpu, &set).expect("fits");
    let places: Vec<Seen> = (0..3000).map(seen).collect();
    let inputs: Vec<[[f32; 4]; 1]> = places
        .iter()
        .map(|at| [at.voxel.as_vec3().extend(f32::from(at.material)).to_array()])
        .collect();
    let body = "return vec4f(mean_albedo(u32(at[0].w), vec3i(at[0].xyz)), 0.0);";
    let on_gpu = evaluate(&gpu, MATERIALS, body, &inputs, &table.resources());
    let on_cpu: Vec<DVec3> = places
        .iter()
        .map(|at| set.mean_albedo(at.material, at.voxel).as_dvec3())
        .collect();
    let error = worst(&on_gpu, &on_cpu, 0.1);
    assert!(error < 1e-5, "{error}");
    // The comparison must notice the dither of a neighbour.
    let beside: Vec<DVec3> = places
        .iter()
        .map(|at| set.mean_albedo(at.material, at.voxel + 1).as_dvec3())
        .collect();
    assert!(worst(&on_gpu, &beside, 0.1) > 0.1);
}

#[test]
fn the_tone_mapper_is_the_same_on_both_sides() {
    let gpu = gpu();
    let mut lights: Vec<DVec3> = (0..4000)
        .map(|index| {
            let (point, direction) = scattered(index);
            direction.abs() * point.x.exp2()
        })
        .collect();
    lights.extend([DVec3::ZERO, DVec3::splat(1e9), DVec3::new(-1.0, 0.5, 2.0)]);
    let mut inputs: Vec<[[f32; 4]; 1]> = lights.iter().map(|&light| [vec4(light)]).collect();
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    inputs.extend(bad.map(|value| [[value; 4]]));
    lights.extend(bad.map(|value| DVec3::splat(f64::from(value))));
    let imports = "import package::color::tonemap::tone_map;";
    let curves = gpu.storage_buffer_of("tone_curves", &tonemap::curves());
    let curves = curves.expect("fits");
    let on_gpu = evaluate(
        &gpu,
        imports,
        "return vec4f(tone_map(at[0].xyz), 0.0);",
        &inputs,
        &[("tone_curves", curves.as_entire_binding())],
    );
    let on_cpu = |gain: f64| -> Vec<DVec3> {
        lights
            .iter()
            .map(|&light| tonemap::tone_map(light * gain))
            .collect()
    };
    let error = worst(&on_gpu, &on_cpu(1.0), 1.0);
    assert!(error < 0.25 / 255.0, "{error}");
    // The comparison must notice a twentieth of a stop.
    assert!(worst(&on_gpu, &on_cpu(1.035), 1.0) > 0.5 / 255.0);
}
